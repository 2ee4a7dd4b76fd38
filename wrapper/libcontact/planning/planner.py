"""The planner: the cheapest mesh, step, integrator and contact law for a given error, or the most
accurate ones for a given run time (chapter :doc:`/theory/planner`)."""

from __future__ import annotations

import csv
import math
import time as clock
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import numpy.typing as npt

from .. import html
from ..errors import EnergyGrowth, Error
from ..loop import record_count
from ..model import SHAPES, Contact, Time
from ..progress import bar, table_text
from ..schema import Place, SceneError, is_number
from ..timing import OUTPUT
from .answer import NUMERICAL, Functional, Plates, functional, plates
from .plan import predict, shown_seconds

if TYPE_CHECKING:
    from ..scene import Scene

Keys = dict[str, Any]
Array = npt.NDArray[np.float64]

PRICES = Path(__file__).with_name("prices.csv")
# Keys that the planner may set, with their words in the table of a plan. Settings of the list with
# other keys, such as those of the search, are left out.
WORDS = {
    "time.fraction": "{:.3g} of the stable step",
    "time.integrator": "{}",
    "time.integrator_parameter": "parameter {:g}",
    "viscosity.linear": "bulk viscosity {:g}",
    "viscosity.quadratic": "quadratic {:g}",
    "contact.enforcement": "{}",
    "contact.beta": "beta {:g}",
}
# A setting is tried if it costs at most WORTH times as much as the cheapest one of the same
# accuracy. LAWS contact laws are tried beside the default; their energy may grow by MOST_GROWTH.
WORTH, LAWS, MOST_GROWTH = 2.0, 2, 1e-3
# Elements along the longest side of the coarsest mesh; ratio of the sizes of successive meshes; and
# the number of meshes that an error estimate needs.
COARSEST, FINER, FEWEST = 8, 2.0**0.5, 4
# Smallest order of convergence that is assumed beyond the trials.
SLOWEST = 0.25
# Two meshes count as equal if the logarithms of their scales differ by less.
NEAR = 0.1
# A setting stays in the trials while its merit is at most BEHIND times the best one. Runs that take
# less than SHORT_SECONDS in all are repeated, up to PASSES times, because short times are uncertain.
BEHIND, SHORT_SECONDS, PASSES = 2.5, 0.06, 4
# All settings stay while one mesh takes less than this fraction of the time for trials, because
# errors on coarse meshes say little about fine ones.
CHEAP = 0.05
# Largest ratio of the chosen mesh's scale to the finest one that was tried.
FARTHEST = 16.0
# Orders of convergence that a fit may find; number of finest meshes that it uses; and the fraction of
# the extrapolated difference that is added to the uncertainty.
ORDERS, LAST, SAFETY = np.linspace(0.5, 3.0, 101), 5, 0.25
# Number of best settings that get a price. Their last trials may take the fraction SETTLE of the time
# for trials, even if that time is over.
FINALISTS, SETTLE = 2, 0.2
# A plan is "sure" if the uncertainty is at most this fraction of the requested error.
SURE = 0.2


# The list.


def settings(contact: bool) -> list[Keys]:
    """The settings of the price list that are worth a trial, each with its keys, ``{"time.fraction": 0.98,
    "contact.beta": 4.0}``; with ``contact`` contact laws are part of the choice."""
    with PRICES.open(encoding="utf-8") as file:
        rows = [_Row.read(row) for row in csv.DictReader(file)]
    rows = [row for row in rows if row.keys.keys() <= WORDS.keys() and "time.fraction" in row.keys]
    wall, methods = [row for row in rows if row.scene == "reference"], list[Keys]()
    for row in wall:
        cheapest = min(each.cost for each in wall if each.error <= row.error)
        if row.cost <= WORTH * cheapest and row.keys not in methods:
            methods.append(row.keys)
    largest = max(row.keys["time.fraction"] for row in rows if "contact.beta" in row.keys)
    laws = list[Keys]()
    for row in sorted(rows, key=lambda row: row.error):
        law = {name: value for name, value in row.keys.items() if name != "time.fraction"}
        good = row.growth < MOST_GROWTH and row.keys["time.fraction"] == largest
        if row.scene == "contact" and good and law.keys() >= {"contact.beta"} and law not in laws:
            laws.append(law)
    return [method | law for method in methods for law in ({}, *laws[: LAWS * contact])]


class _Row(NamedTuple):
    """A row of the price list."""

    scene: str
    keys: Keys
    cost: float
    error: float
    growth: float

    @classmethod
    def read(cls, row: dict[str, str]) -> _Row:
        numbers = (float(row[name]) for name in ("cost", "error", "growth"))
        return cls(row["scene"], _keys(row["setting"]), *numbers)


def _keys(setting: str) -> Keys:
    """A setting of the list as keys and values."""
    pairs = (part.split("=") for part in setting.split("; "))
    keys = {name: float(value) if value[0].isdigit() else value for name, value in pairs}
    # The default enforcement is left out.
    usual = keys.get("contact.enforcement") == Contact.keys()["enforcement"].default
    return {
        name: value for name, value in keys.items() if not (usual and name == "contact.enforcement")
    }


# Extrapolation.


@dataclass(frozen=True)
class Limit:
    """Limit of the values on finer and finer meshes, its uncertainty, and the observed order with its
    bounds, :eq:`planner-fit`."""

    value: float
    uncertainty: float
    order: float
    orders: tuple[float, float]


def extrapolate(sizes: Any, values: Any) -> Limit:
    """Fit :math:`F + C h^q` to values on at least four meshes with elements of sizes h, from coarse to fine,
    :eq:`planner-fit`, and return the limit F."""
    h, f = np.asarray(sizes, float)[-LAST:], np.asarray(values, float)[-LAST:]
    h, rows = h / h[0], []
    for q in ORDERS:
        # (eq:planner-power)
        matrix = np.column_stack([np.ones(len(h)), h**q])
        (limit, slope), *_ = np.linalg.lstsq(matrix, f, rcond=None)
        misfit = f - limit - slope * h**q
        rows.append((misfit @ misfit, limit, np.linalg.inv(matrix.T @ matrix)[0, 0]))
    squares, limits, spread = np.array(rows).T
    # (eq:planner-fit)
    best, variance = int(squares.argmin()), float(squares.min() / (len(h) - 3))
    near = squares <= squares[best] + 4.0 * variance + (1e-12 * np.ptp(f)) ** 2
    wide = 2.0 * np.sqrt(variance * spread)
    low, high = (limits - wide)[near].min(), (limits + wide)[near].max()
    bounds = float(ORDERS[near].min()), float(ORDERS[near].max())
    limit, width = float(limits[best]), float(high - low) / 2.0
    return Limit(limit, width + SAFETY * abs(limit - f[-1]), float(ORDERS[best]), bounds)


def together(limits: list[Limit]) -> tuple[float, float]:
    """Combine the limits of several methods into one value with its uncertainty, :eq:`planner-mean`."""
    values, widths = np.array([(each.value, each.uncertainty) for each in limits]).T
    # Few meshes may lie on a curve by chance: the lower quartile bounds each uncertainty from below.
    widths = np.maximum(widths, np.sort(widths)[len(widths) // 4])
    weights = 1.0 / np.maximum(widths, 1e-9 * np.abs(values).max() + 1e-150) ** 2
    weights /= weights.sum()
    # (eq:planner-mean)
    mean = float(weights @ values)
    return mean, math.sqrt(weights @ (widths**2 + (values - mean) ** 2))


# Trials.


@dataclass(eq=False)
class Tried:
    """A setting, the power of the scale with which its time grows, and its trials from coarse to fine:
    refinement of the scene's mesh, value, error, and time [s]."""

    keys: Keys
    growth: float
    scales: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    errors: Array = field(default_factory=lambda: np.empty(0))

    def next_seconds(self) -> float:
        """Estimated time of the trial on the next mesh [s]."""
        return self.seconds_at(self.scales[-1] * FINER)

    def add(self, scale: float, value: float, seconds: float) -> None:
        """Insert a trial in the order of the scales. Of several runs on one mesh the shortest time
        counts, because other programs can only make a run slower."""
        at = int(np.searchsorted(self.scales, scale))
        if scale in self.scales:
            self.seconds[at] = min(seconds, self.seconds[at])
            return
        for kept, new in ((self.scales, scale), (self.values, value), (self.seconds, seconds)):
            kept.insert(at, new)

    def limit(self) -> Limit:
        """The extrapolated limit of the values."""
        return extrapolate(1.0 / np.array(self.scales), self.values)

    def line(self, values: Any, last: int = LAST) -> tuple[float, float]:
        """Slope of the values' logarithm over that of the scale, fitted to the finest meshes, and its
        standard deviation."""
        x, y = np.log(self.scales[-last:]), np.log(np.maximum(values[-last:], 1e-300))
        x, mean = x - x.mean(), y.mean()
        slope = float(x @ (y - mean) / (x @ x))
        misfit = y - mean - slope * x
        return slope, math.sqrt(misfit @ misfit / max(1, len(x) - 2) / (x @ x))

    def order(self) -> float:
        """Order with which errors are assumed to fall beyond the trials: the observed one less its
        standard deviation."""
        slope, spread = self.line(self.errors)
        return max(SLOWEST, -slope - spread)

    def error_at(self, scale: float) -> float:
        """Expected error on a mesh, interpolated between trials or extrapolated beyond them."""
        return self._at(scale, self.errors, -self.order())

    def seconds_at(self, scale: float) -> float:
        """Expected time on a mesh [s]; beyond the trials it grows with the number of elements and of
        steps."""
        return self._at(scale, self.seconds, self.growth)

    def _at(self, scale: float, values: Any, slope: float) -> float:
        """A value whose logarithm is linear in that of the scale between trials, and has this slope
        beyond them."""
        if scale > self.scales[-1]:
            return float(values[-1] * (scale / self.scales[-1]) ** slope)
        logs = np.log(np.maximum(values, 1e-300))
        return float(np.exp(np.interp(math.log(scale), np.log(self.scales), logs)))

    def scale_for(self, error: float) -> float:
        """Scale of the coarsest mesh such that it and all finer ones have at most this error,
        extrapolated beyond the trials."""
        bad = np.flatnonzero(self.errors > error)
        if not bad.size:
            return self.scales[0]
        i = int(bad[-1])
        if i + 1 == len(self.scales):
            return float(self.scales[-1] * (self.errors[-1] / error) ** (1.0 / self.order()))
        x, y = np.log(self.scales[i : i + 2]), np.log(np.maximum(self.errors[i : i + 2], 1e-300))
        if x[1] - x[0] < NEAR:
            return self.scales[i + 1]
        return math.exp(x[0] + (x[1] - x[0]) * (y[0] - math.log(error)) / (y[0] - y[1]))

    def scale_in(self, seconds: float) -> float:
        """Scale of the finest mesh whose run takes at most this time."""
        scales = self.scales[0] * 1.01 ** np.arange(3000)
        times = np.array([self.seconds_at(scale) for scale in scales])
        return float(
            scales[max(0, int(np.searchsorted(np.maximum.accumulate(times), seconds)) - 1)]
        )


@dataclass(frozen=True)
class Goal:
    """The request: an error, or a time [s]."""

    error: float | None
    seconds: float | None

    def scale(self, tried: Tried) -> float:
        """Scale of the mesh on which a setting meets the requested error or time."""
        return tried.scale_in(self.seconds) if self.seconds else tried.scale_for(self.error or 1.0)

    def merit(self, tried: Tried) -> float:
        """The quantity that the best setting minimises: its time if an error was requested, its error
        if a time was."""
        scale = self.scale(tried)
        return tried.error_at(scale) if self.seconds else tried.seconds_at(scale)

    def error_of(self, tried: Tried) -> float:
        """The requested error, or the expected error of a setting in the requested time."""
        return self.error or tried.error_at(self.scale(tried))


@dataclass(frozen=True)
class Offer:
    """Expected cost and error of one setting on one mesh.

    Attributes
    ----------
    scene : Scene
        The scene with this setting and mesh.
    mesh, setting : str
        Both in words.
    error : float
        Expected error.
    seconds : float
        Predicted time of the run [s], as ``explain`` predicts it.
    why : str
        The reason for or against it.
    """

    scene: Scene
    mesh: str
    setting: str
    error: float
    seconds: float
    why: str


HEADS = ("", "mesh", "setting", "error", "time")


@dataclass(frozen=True)
class Plan:
    """
    A choice with its neighbours.

    Attributes
    ----------
    choice : Offer
        The choice.
    cheaper, dearer : Offer or None
        The next offers below and above it; None where none was tried.
    scene : Scene
        The scene of the choice.
    measure : str
        Definition of the error, in words.
    sure : str
        How certain the expected error is, in a sentence.
    value, uncertainty : float or None
        The estimated value of the functional and its uncertainty.
    interrupted : bool
        Whether Ctrl-C ended the trials.
    """

    choice: Offer
    cheaper: Offer | None
    dearer: Offer | None
    measure: str
    sure: str
    value: float | None = None
    uncertainty: float | None = None
    interrupted: bool = False

    @property
    def scene(self) -> Scene:
        """The scene of the choice."""
        return self.choice.scene

    def _rows(self) -> tuple[list[list[str]], list[str]]:
        """The rows of the table, and the reasons."""
        offers = {"cheaper": self.cheaper, "choice": self.choice, "dearer": self.dearer}
        rows, reasons = [], []
        for name, offer in offers.items():
            if offer is not None:
                words = [name, offer.mesh, offer.setting, percent(offer.error)]
                rows.append([*words, shown_seconds(offer.seconds)])
                reasons.append(f"{name}: {offer.why}")
        return rows, reasons

    def _repr_html_(self) -> str:
        """The plan in a notebook."""
        rows, reasons = self._rows()
        return html.titled(
            f"error {self.measure}",
            html.table(HEADS, rows),
            html.lines("\n".join([*reasons, self.sure])),
        )

    def __str__(self) -> str:
        from rich.table import Table

        table = Table(*HEADS, box=None, pad_edge=False)
        rows, reasons = self._rows()
        for row in rows:
            table.add_row(*row)
        return "\n".join([f"error {self.measure}", table_text(table), *reasons, self.sure])


class Planner:
    """
    The trials of one plan.

    Parameters
    ----------
    scene : Scene
        The scene.
    named : str or None
        The functional.
    trials : float
        Seconds that trials may take.
    """

    def __init__(self, scene: Scene, named: str | None, trials: float):
        self.scene, self.trials, self.spent = scene, trials, 0.0
        if scene._own:
            reason = "is a Python function; only what a scene file can hold is planned"
            raise SceneError(reason, scene._own[0].name, scene.file)
        problem = scene._built(None)
        self.plates: Plates | None = None if named else plates(problem)
        self.functional: Functional | None = functional(problem, named) if named else None
        if not (self.plates or self.functional):
            reason = "is missing; the scene has no known closed form, so name the number whose error is meant"
            raise SceneError(f'{reason}, such as "energy.kinetic.end"', "functional", scene.file)
        parts = problem.parts
        self.laws = (*parts.contact, *parts.obstacle)
        self.lattices = [body.lattice for body in parts.body]
        self.own_mesh = not all(self.lattices)
        several = (
            0 if self.own_mesh else max(sum(n > 1 for n in each.cells) for each in self.lattices)
        )
        listed = settings(bool(parts.contact or parts.obstacle))
        if self.own_mesh:  # small steps have one limit; another mass or contact law has another one
            listed = [keys for keys in listed if all(name.startswith("time.") for name in keys)]
        self.tried = [Tried(keys, 1.0 + several) for keys in listed]
        self.value, self.uncertainty, self.interrupted = 0.0, 0.0, False
        # Of each scale that results from whole numbers of cells the one that was asked for: another one may make
        # other numbers.
        self.asked: dict[float, float] = {}

    # The scene with another setting on another mesh.

    def changed(self, keys: Keys, scale: float) -> Scene:
        """The scene with the keys of a setting, and with elements that are ``scale`` times smaller. A
        scene with meshes of its own gets smaller steps instead."""
        data = self.scene.data
        time, tables = data["time"], [*data.get("contact", []), *data.get("obstacle", [])]
        for name in (*Time.rivals[0], "integrator", "integrator_parameter"):
            time.pop(name, None)
        for table, law in zip(tables, self.laws):
            if self.own_mesh:  # its default depends on the integrator
                table["restitution"] = law.restitution
                continue
            for name in ("beta", "epsilon", "enforcement", "dissipation"):
                table.pop(name, None)
        for name in () if self.own_mesh else NUMERICAL:
            data.pop(name, None)
        for name, value in keys.items():
            where, _, key = name.partition(".")
            for table in tables if where == "contact" else [data.setdefault(where, {})]:
                table[key] = value
        if self.own_mesh:
            time["fraction"] /= scale
        else:
            self._refine(data["body"], scale)
        return type(self.scene)(data, file=self.scene.file)

    def _refine(self, bodies: list[Keys], scale: float) -> None:
        """Change the numbers of cells; a single cell across stays one. In plane strain the single layer
        gets the thickness of the shortest other edge."""
        for body, lattice in zip(bodies, self._scaled(scale)):
            shape = next(name for name in SHAPES if name in body)
            body[shape]["cells"] = list(lattice.cells)
        across = self.plates.axes[1] if self.plates else 0
        if self.plates and all(body["box"]["cells"][across] == 1 for body in bodies):
            edges = [np.divide(body["box"]["size"], body["box"]["cells"]) for body in bodies]
            for body in bodies:
                body["box"]["size"][across] = float(np.delete(edges, across, axis=1).min())

    def _scaled(self, scale: float) -> list[Any]:
        """The shapes of the bodies with elements that are ``scale`` times smaller, in whole numbers."""
        asked = self.asked.get(scale, scale)
        return [each.scaled(asked) for each in self.lattices]

    def true_scale(self, scale: float) -> float:
        """The scale that results from whole numbers of elements. It has the same numbers."""
        if self.own_mesh:
            return max(1.0, scale)
        ratios = [
            np.divide(made.cells, each.cells)[np.array(each.cells) > 1]
            for made, each in zip(self._scaled(scale), self.lattices)
        ]
        logs = np.log(np.concatenate(ratios))
        true = math.exp(logs.mean()) if logs.size else 1.0
        self.asked.setdefault(true, self.asked.get(scale, scale))
        return true

    # Trials.

    def _try(self, tried: Tried, scale: float, short: float = 0.0) -> bool:
        """Run a setting on a mesh and store the trial. Short runs are repeated until they take
        ``short`` seconds in all; without ``short`` a mesh that was tried is skipped. False if the
        scene rejects the setting, the run fails, or energy grows."""
        true, seconds = self.true_scale(scale), list[float]()
        if true in tried.scales and not short:
            return True
        data = self.changed(tried.keys, scale).data
        # Tables of momentum and energy have a row per record.
        ledger = self.functional and self.functional.table not in {
            each["name"] for each in data.get("probe", [])
        }
        data["output"] = {} if ledger else {"every": 10**9}
        begin = clock.perf_counter()
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                scene = type(self.scene)(data, file=self.scene.file)
                while len(seconds) < PASSES and sum(seconds) < (short or SHORT_SECONDS):
                    run = scene.run(progress=False, output=False)
                    if run.interrupted:
                        raise KeyboardInterrupt
                    seconds.append(sum(run.costs.values()) - run.costs[OUTPUT])
        except Error as error:
            self.reason = error
            return False
        finally:
            self.spent += clock.perf_counter() - begin
        if any(isinstance(each.message, EnergyGrowth) for each in caught):
            self.reason = SceneError("energy grows with every setting", "", self.scene.file)
            return False
        exact = self.plates.error(scene._built(None), run) if self.plates else 0.0
        tried.add(true, self.functional.value(run) if self.functional else exact, min(seconds))
        return True

    def set_errors(self, goal: Goal) -> None:
        """Set the errors of all trials: measured ones for the plates, otherwise the distance from the
        common limit of all settings plus half the limit's uncertainty."""
        if self.functional:
            self.value, width = together([each.limit() for each in self.finest()])
            self.uncertainty = width / max(abs(self.value), 1e-300)
        for each in self.tried:
            each.errors = np.array(each.values)
            if self.functional:
                distance = np.abs(each.errors - self.value) / max(abs(self.value), 1e-300)
                each.errors = distance + 0.5 * min(self.uncertainty, goal.error or 1.0)

    def finest(self) -> list[Tried]:
        """The settings that were tried on the finest meshes."""
        enough = [each for each in self.tried if len(each.scales) >= FEWEST]
        finest = max(each.scales[-1] for each in enough)
        return [each for each in enough if each.scales[-1] > 0.6 * finest]

    def climb(self, goal: Goal, bar: Any) -> None:
        """Try all settings on finer and finer meshes and drop expensive ones, until the trials include
        the choice or their time is over."""
        scale, live = 1.0, [*self.tried]
        if not self.own_mesh:
            scale = COARSEST / max(max(each.cells) for each in self.lattices)
        while live:
            for each in live:
                if not self._try(each, scale):
                    self.tried.remove(each)
                bar.set_description(f"trials, elements {1.0 / scale:.3g} times as large")
                bar.update()
            live = [each for each in live if each in self.tried]
            if not self.tried:
                raise self.reason
            if len(live[0].scales) < FEWEST:
                live = live if self.spent < self.trials else live[:FINALISTS]
            else:
                self.set_errors(goal)
                live.sort(key=goal.merit)
                sure = self.uncertainty <= SURE * goal.error_of(live[0])
                beyond = goal.scale(live[0]) * (FINER if self.functional else 1.0)
                if sure and beyond <= 1.001 * scale:
                    return
                if sum(each.next_seconds() for each in live) > CHEAP * self.trials:
                    live = [
                        each for each in live if goal.merit(each) <= BEHIND * goal.merit(live[0])
                    ]
                while live and sum(each.next_seconds() for each in live) > self.trials - self.spent:
                    live.pop()
            scale *= FINER

    def mesh(self, tried: Tried, goal: Goal) -> float:
        """Scale of the mesh that a setting needs, with whole numbers of elements."""
        far = FARTHEST * tried.scales[-1]
        scale = self.true_scale(min(goal.scale(tried), 2.0 * far))
        if goal.seconds:
            return min(scale, far)
        asked = scale
        while goal.error and scale <= far and tried.error_at(scale) > goal.error:
            most = 100 if self.own_mesh else max(max(each.cells) for each in self.lattices) * asked
            # Where one edge rounds up and another down, the mesh is as before.
            asked *= 1.0 + 1.0 / most
            scale = self.true_scale(asked)
        return scale

    def settle(self, tried: Tried, goal: Goal) -> None:
        """Run further trials of a setting on exactly the mesh that it needs, while time is left."""
        scale = 0.0
        for _ in range(4):
            before, scale = scale, self.mesh(tried, goal)
            late = tried.seconds_at(scale) > max(SETTLE * self.trials, self.trials - self.spent)
            if scale == before or late or not self._try(tried, scale, SETTLE * self.trials):
                return
            self.set_errors(goal)

    def price(self, tried: Tried, scale: float) -> float:
        """Time of a setting on a mesh with the scene's output [s]: measured if this mesh was tried,
        otherwise predicted."""
        problem = self.changed(tried.keys, scale)._built(None)
        prediction = predict(problem, record_count(problem))
        if prediction.seconds is not None and scale not in tried.scales:
            return prediction.seconds
        output = [each.predicted or 0.0 for each in prediction.costs if each.name == OUTPUT]
        return tried.seconds_at(scale) + sum(output)

    def offer(self, tried: Tried, scale: float, seconds: float) -> Offer:
        """Describe a setting on a mesh, with its time."""
        cells = (
            ["mesh of its own"]
            if self.own_mesh
            else [" x ".join(map(str, each.cells)) for each in self._scaled(scale)]
        )
        keys = {"time.integrator": "central_difference", **tried.keys}
        scene, mesh = self.changed(tried.keys, scale), ", ".join(dict.fromkeys(cells))
        keys["time.fraction"] = scene.data["time"]["fraction"]
        words = ", ".join(WORDS[name].format(value) for name, value in keys.items())
        return Offer(scene, mesh, words, tried.error_at(scale), seconds, "")

    def ranked(self, goal: Goal) -> list[Tried]:
        """The settings with enough trials, best first."""
        enough = [each for each in self.tried if len(each.scales) >= FEWEST]
        return sorted(enough, key=goal.merit)

    def plan(self, goal: Goal, bar: Any) -> Plan:
        """Run the trials, choose, and compute the prices of the choice and its neighbours."""
        try:
            self.climb(goal, bar)
            settled = list[Tried]()
            # Settling a finalist may make another setting the best one.
            while new := [t for t in self.ranked(goal)[:FINALISTS] if t not in settled]:
                self.settle(new[0], goal)
                settled.append(new[0])
        except KeyboardInterrupt:
            if all(len(each.scales) < FEWEST for each in self.tried):
                raise
            self.interrupted = True
        self.set_errors(goal)
        if self.functional and not (self.value and self.uncertainty < 1.0):
            much = f"{self.value:.3g}, uncertain by {self.uncertainty * abs(self.value):.2g}"
            raise SceneError(
                f"converges to {much}; a relative error of it has no meaning",
                "functional",
                self.scene.file,
            )
        (choice, tried, scale), *others = self.priced(goal)
        count = len(self.tried)
        if goal.seconds:
            why = f"the least error of {count} settings within {shown_seconds(goal.seconds)}"
        else:
            why = f"the cheapest of {count} settings whose error is at most {percent(goal.error or 0.0)}"
        for offer, *_ in others[:1]:
            many = f"{offer.seconds / choice.seconds:.2g} times as long, with an error of {percent(offer.error)}"
            why += f"; the runner-up ({offer.setting}) takes {many}"
        plan = Plan(
            replace(choice, why=why),
            *self._neighbours(choice, tried, scale, goal),
            measure=Plates.words,
            sure=self._certainty(goal, tried, scale),
            interrupted=self.interrupted,
        )
        if self.functional is None:
            return plan
        width = self.uncertainty * abs(self.value)
        measure = f"of {self.functional}, over its value"
        return replace(plan, measure=measure, value=self.value, uncertainty=width)

    def priced(self, goal: Goal) -> list[tuple[Offer, Tried, float]]:
        """The best settings with meshes and prices, best first. A SceneError if no feasible mesh meets
        the request."""
        found, far = list[tuple[Offer, Tried, float]](), 0.0
        for each in self.ranked(goal)[:FINALISTS]:
            scale = self.mesh(each, goal)
            far = scale / each.scales[-1]
            if far <= FARTHEST:
                offer = self.offer(each, scale, self.price(each, scale))
                while goal.seconds and offer.seconds > goal.seconds and scale > each.scales[0]:
                    less = max(0.7, min(0.96, goal.seconds / offer.seconds))
                    scale = self.true_scale(max(scale * less, each.scales[0]))
                    offer = self.offer(each, scale, self.price(each, scale))
                found += [(offer, each, scale)] * (offer.seconds <= (goal.seconds or math.inf))
        if found and goal.error:
            found += self._lucky(goal.error, min(offer.seconds for offer, *_ in found))
        if found:
            return sorted(found, key=lambda one: one[0].error if goal.seconds else one[0].seconds)
        reason = "are not enough for the coarsest mesh that was tried"
        if goal.error:
            reason = f"needs a mesh {far:.3g} times finer than the finest that was tried; allow a larger error, or more time for trials"
        asked = f"{goal.seconds:.3g} s" if goal.seconds else percent(goal.error or 0.0)
        raise SceneError(
            f"{asked} {reason}", "seconds" if goal.seconds else "error", self.scene.file
        )

    def _lucky(self, error: float, seconds: float) -> list[tuple[Offer, Tried, float]]:
        """The cheapest trial that met an error in less time, although a finer mesh of its setting did not."""
        met = [
            (each.seconds[i], each.scales[i], each)
            for each in self.ranked(Goal(error, None))
            for i in np.flatnonzero(each.errors <= error)
        ]
        took, scale, each = min(met, key=lambda one: one[0], default=(math.inf, 0.0, self.tried[0]))
        if took >= 0.95 * seconds:
            return []
        price = self.price(each, scale)
        return [(self.offer(each, scale, price), each, scale)] if price < seconds else []

    def _neighbours(
        self, choice: Offer, tried: Tried, scale: float, goal: Goal
    ) -> tuple[Offer | None, Offer | None]:
        """The most accurate offer that costs less than the choice, and the cheapest one that is more
        accurate. Both have meshes from the sequence of the trials."""
        ratio = choice.seconds / tried.seconds_at(scale)
        grid = [
            (each, each.scales[-1] * FINER**k) for each in self.ranked(goal) for k in range(-12, 3)
        ]
        points = [
            (each.error_at(at), ratio * each.seconds_at(at), at, each)
            for each, at in grid
            if at >= each.scales[0]
        ]
        # What meets the request and costs less would have been chosen, were it not a guess between trials.
        least = max(choice.error, goal.error or 0.0)
        less = [one for one in points if one[1] < 0.95 * choice.seconds and one[0] > least]
        more = [one for one in points if one[0] < 0.95 * choice.error and one[1] > choice.seconds]

        def told(point: tuple[float, float, float, Tried] | None) -> Offer | None:
            if point is None:
                return None
            error, seconds, at, each = point
            many = f"{error / max(choice.error, 1e-9):.2g} times the error"
            why = f"{seconds / choice.seconds:.2g} times the time for {many}"
            return replace(self.offer(each, at, seconds), why=why)

        cheaper = min(less, key=lambda one: one[0], default=None)
        return told(cheaper), told(min(more, key=lambda one: one[1], default=None))

    def _certainty(self, goal: Goal, tried: Tried, scale: float) -> str:
        """How certain the expected error is, in a sentence."""
        slope, spread = tried.line(tried.errors, 0)
        order = f"observed order {-slope:.2f} +- {2.0 * spread:.2f}"
        if self.functional:
            limit = tried.limit()
            order = f"observed order {limit.order:.2g} ({limit.orders[0]:.2g} ... {limit.orders[1]:.2g})"
        text = f"extrapolated from meshes up to {tried.scales[-1] / scale:.2g} of this one, {order}"
        if scale <= 1.001 * tried.scales[-1]:
            text = f"from trials around this mesh, {order}"
        if self.functional:
            text += f"; {self.functional} = {self.value:.6g} +- {percent(self.uncertainty)}, the limit of {len(self.finest())} settings"
            asked = goal.error or tried.error_at(scale)
            words = (
                "sure"
                if self.uncertainty <= SURE * asked
                else "fairly sure"
                if self.uncertainty <= asked
                else "not sure"
            )
            text = f"{words}: {text}"
        if self.own_mesh:
            text += "; the mesh stays as it is, so its own error is not included"
        return text + ("; the trials were interrupted" if self.interrupted else "")


def percent(fraction: float) -> str:
    """A fraction in per cent."""
    return f"{100.0 * fraction:.3g} %"


def plan(
    scene: Scene,
    error: float | None,
    seconds: float | None,
    named: str | None,
    trials: float,
    progress: bool,
) -> Plan:
    """Plan a scene; :meth:`libcontact.scene.Scene.plan` is the call for users. ``named`` is the functional;
    exactly one of ``error`` and ``seconds`` is given."""
    at = Place("", scene.file)
    if (error is None) == (seconds is None):
        raise (at / "error").error("or seconds: exactly one of the two is needed")
    for key, number, most in (
        ("error", error, 1.0),
        ("seconds", seconds, math.inf),
        ("trials", trials, math.inf),
    ):
        right = number is None or (is_number(number) and 0.0 < number < most)
        (at / key).need(
            right, number, "a number above 0" + (" and below 1 (100 %)" if most == 1.0 else "")
        )
    with bar(progress, desc="trials", unit=" runs", leave=False) as shown:
        return Planner(scene, named, trials).plan(Goal(error, seconds), shown)
