"""The rules by which every case of the stability laboratory is classified."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from libcontact._core import lib
from libcontact.bridge import copied

import libcontact as ct
from libcontact import loop

UNITS = {"length": "m", "mass": "kg", "time": "s"}
DEFAULT = "energy_controlled"
# Elastic bodies: an impact takes nothing from them.
ELASTIC: dict[str, Any] = {"restitution": 1.0}
# Largest growth of energy over the case's scale, and largest drift of momentum over its largest value.
ENERGY, MOMENTUM = 0.01, 1e-12
# Largest part of the scale that elastic bodies may lose with the default law, unless a case names what
# takes it.
LOST = 0.01
# What contacts may make over the scale where energy that grows is the leapfrog's, and what may grow at half its step.
MADE, GROWTH, LEAPFROG, TOLD = 1e-9, 0.002, "the leapfrog gains", "told: "


@dataclass
class Row:
    """One run of a case. Lengths are over the shortest edge h, energy over ``scale``; ``lost`` is neither
    in the bodies nor in springs of the contact, and ``held`` comes back when points open. ``made`` is what
    contacts and obstacles have given beyond what they took."""

    case: str
    enforcement: str
    beta: float | None
    courant: float
    fraction: float
    steps: int
    energy: float = np.nan
    lost: float = np.nan
    points: float = np.nan
    nodes: float = np.nan
    momentum: float = np.nan
    verdict: str = ""
    held: float = 0.0
    made: float = 0.0
    warned: str = ""
    may_lose: float | None = LOST
    integrator: str = "central_difference"
    scale: str = "start"
    note: str = ""
    expected: str = "passes"
    seconds: float = 0.0
    curve: dict[str, list[float]] = field(default_factory=dict)

    @property
    def good(self) -> bool:
        return self.verdict == "passes"

    @property
    def by_leapfrog(self) -> bool:
        return self.verdict.startswith(LEAPFROG)

    @property
    def told(self) -> bool:
        return self.verdict.startswith(TOLD)

    def remark(self, text: str) -> None:
        """Put a text before the note."""
        self.note = text + (f"; {self.note}" if self.note else "")

    def data(self) -> dict[str, Any]:
        return asdict(self)


@dataclass
class Watch:
    """Measurements at the records of a run: the deepest point and node so far, and those of the case."""

    h: float
    depth: Callable[[ct.Run], float] | None = None
    measure: Callable[[ct.Run], dict[str, float]] | None = None
    points: float = 0.0
    nodes: float = 0.0
    curve: dict[str, list[float]] = field(default_factory=dict)

    def __call__(self, run: ct.Run) -> None:
        gaps = [points["gap"][np.isfinite(points["gap"])] for points in run.contact]
        self.points = max([self.points, *(float(-gap.min()) / self.h for gap in gaps if gap.size)])
        if self.depth is not None:
            self.nodes = max(self.nodes, self.depth(run) / self.h)
        if self.measure is not None:
            for name, value in self.measure(run).items():
                self.curve.setdefault(name, []).append(float(value))


def scene(title: str) -> ct.Scene:
    return ct.Scene(title=title, units=UNITS)


def material(
    made: ct.Scene,
    name: str = "soft",
    young: float = 1e4,
    poisson: float = 0.3,
    density: float = 1.0,
    law: str = "linear",
) -> None:
    made.add_material(
        name,
        young=young,
        poisson=poisson,
        density=density,
        **({} if law == "linear" else {"law": law}),
    )


def enforced(enforcement: str, beta: float | None) -> dict[str, Any]:
    """Keys of a contact or an obstacle between elastic bodies."""
    law = {"enforcement": enforcement, **({} if beta is None else {"beta": beta})}
    return {**law, **(ELASTIC if enforcement == DEFAULT else {})}


@contextmanager
def booked() -> Iterator[list[tuple[float, float]]]:
    """The books of runs within, at each record: what contacts and obstacles have given to the motion and
    store, less what their own motion has put in; and the same of the solid. Both are constant in an exact
    elastic motion."""
    rows: list[tuple[float, float]] = []
    write = loop.Loop._write_record
    touching = (lib.CT_EFFECT_CONTACT, lib.CT_EFFECT_OBSTACLE)

    def record(self: loop.Loop, state: Any) -> None:
        ledger = lib.ct_monitor_ledger(self.monitor)
        done = copied("ct_effect_energy", ledger.effects, len(self.problem.effects))
        book = done["work"] + done["stored"] - done["external"]
        touches = [effect.kind in touching for effect in self.problem.made]
        rows.append((float(book[touches].sum()), float(book[0])))
        write(self, state)

    loop.Loop._write_record = record
    try:
        yield rows
    finally:
        loop.Loop._write_record = write


def rise(values: Any) -> float:
    """The largest rise above an earlier value."""
    return float((values - np.minimum.accumulate(values)).max())


def kinds(told: Iterable[warnings.WarningMessage]) -> str:
    """The kinds of some warnings."""
    return ", ".join(
        sorted({getattr(one.message, "kind", type(one.message).__name__) for one in told})
    )


def is_told(warned: str, made: float, half: Callable[[], float]) -> str:
    """Energy that the leapfrog gains at large strain (eq:step-resonance) is told if the run warns of it, contacts
    have not made it, and it hardly grows at ``half`` the step. Returns what it does there, or "" if it is not."""
    if "energy_growth" not in warned or made > MADE:
        return ""
    left = half()
    return f", and {100 * left:.2g} % at half the step" if left <= GROWTH else ""


def shortest_edge(made: ct.Scene) -> float:
    return min(body.mesh.shortest_edge for body in made._built(None).bodies.values())


def set_steps(made: ct.Scene, steps: int, fraction: float, records: int) -> ct.Scene:
    """Set the number of steps of a scene, their fraction of the stable step, and about ``records``
    records."""
    dt = made.set_time(end=1.0, fraction=fraction)._built(None).dt
    return made.set_time(end=steps * dt, dt=dt).set_output(
        every=max(steps // records, 1), fields=[]
    )


def classify(
    case: str,
    made: ct.Scene,
    *,
    enforcement: str = DEFAULT,
    beta: float | None = None,
    depth: Callable[[ct.Run], float] | None = None,
    scale: float | None = None,
    scale_name: str = "start",
    momentum: float = MOMENTUM,
    momentum_scale: float = 0.0,
    bound: float = 0.5,
    may_lose: float | None = LOST,
    whole: Callable[[ct.Run, Watch], str] | None = None,
    measure: Callable[[ct.Run], dict[str, float]] | None = None,
    expected: str = "passes",
    note: str = "",
) -> Row:
    """Run a scene and classify it by energy that appears or is lost, momentum, penetration of points and
    nodes (``bound``, in h), and the condition of the case: ``whole`` returns "" or what is wrong.
    """
    begin = time.perf_counter()
    problem = made._built(None)
    stable = problem.stable
    watch = Watch(shortest_edge(made), depth, measure)
    row = Row(
        case,
        enforcement,
        beta,
        problem.dt / stable.dt_courant if stable.dt_courant > 0 else np.inf,
        problem.dt / stable.dt_without_contact,
        problem.step_count,
        scale=scale_name,
        note=note,
        expected=expected,
        integrator=problem.parts.time.integrator,
    )
    named = enforcement == "penalty" or row.integrator != "central_difference"
    row.may_lose = None if named else may_lose
    try:
        with booked() as books, warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            run = made.run(progress=False, output=False, watch=watch)
    except ct.Error as error:
        row.verdict, row.note, row.seconds, row.curve, row.warned = (
            type(error).__name__,
            str(error).split(";")[0],
            time.perf_counter() - begin,
            watch.curve,
            kinds(told),
        )
        # The step was stable at the start, but is not for the deformed body.
        row.note += (
            "; the solid has become too stiff for the step"
            if "The stable step has decreased" in str(error)
            else ""
        )
        if getattr(error, "run", None) is not None and len(error.run.energy):
            weigh(row, error.run, scale, books)
        return row
    weigh(row, run, scale, books)
    row.warned = kinds(told)
    row.momentum = drift(run, momentum_scale)
    row.points, row.nodes, row.curve = watch.points, watch.nodes, watch.curve
    row.verdict = verdict(row, momentum, bound) or (whole(run, watch) if whole else "") or "passes"
    row.verdict = caused(row)
    row.seconds = time.perf_counter() - begin
    return row


def weigh(row: Row, run: ct.Run, scale: float | None, books: list[tuple[float, float]]) -> None:
    """Rise of the energy of the bodies above the start, loss of the total at the end, what points hold
    there, and rise of the books of contacts."""
    total = run.energy["total"]
    unit = max(abs(total[0]), np.abs(run.energy["external"]).max(), scale or 0.0, 1e-300)
    row.energy, row.lost, row.held, row.made = (
        float((own_energy(run.energy) - total[0]).max() / unit),
        float((total[0] - total[-1]) / unit),
        float(run.energy["reserve"][-1] / unit),
        rise(np.array(books)[:, 0] / unit),
    )


def caused(row: Row) -> str:
    """The verdict, which names the leapfrog if nothing but energy that grows is wrong and the contacts have
    not made it."""
    grows, parts = "energy grows by", row.verdict.split("; ")
    mine = row.integrator == "central_difference" and row.made <= MADE
    if not mine or not all(part.startswith(grows) for part in parts):
        return row.verdict
    return row.verdict.replace(grows, LEAPFROG)


def own_energy(energy: np.ndarray) -> np.ndarray:
    """Energy of the bodies, without the work that was put in and without what contacts and obstacles store and
    hold. Where points open, the energy of a contact may be negative: then it corrects that of the bodies
    (eq:controlled-energy)."""
    touching = [energy[name] for name in ("contact", "obstacle") if name in energy.dtype.names]
    return np.asarray(energy["total"] - np.maximum(sum(touching), 0.0))


def drift(run: ct.Run, scale: float) -> float:
    """Change of momentum without an impulse, over the largest momentum or impulse, or over a scale of the
    case if forces cancel each other."""
    first, last = (
        np.array([rows["p"][i] for rows in (run.body_momentum(name) for name in run.bodies)])
        for i in (0, -1)
    )
    given = sum((impulse for impulse in run.impulse.values()), np.zeros(3))
    unit = max(
        [
            scale,
            np.abs(first).max(),
            np.abs(last).max(),
            *(np.abs(impulse).max() for impulse in run.impulse.values()),
            1e-300,
        ]
    )
    return float(np.abs(last.sum(0) - first.sum(0) - given).max() / unit)


def verdict(row: Row, momentum: float, bound: float) -> str:
    """The fault of a row by the rules for all cases, or ""."""
    if not np.isfinite([row.energy, row.momentum, row.points, row.nodes]).all():
        return "not finite"
    if row.energy > ENERGY:
        return f"energy grows by {100 * row.energy:.3g} %"
    if row.may_lose is not None and row.lost > row.may_lose:
        return f"{100 * row.lost:.3g} % of the energy is lost"
    if row.momentum > momentum:
        return f"momentum drifts by {row.momentum:.1e}"
    if max(row.points, row.nodes) > bound:
        return f"penetration {max(row.points, row.nodes):.2g} h"
    return ""


HEAD = (
    "case",
    "enforcement",
    "integrator",
    "beta",
    "Courant",
    "of limit",
    "steps",
    "energy",
    "lost",
    "held",
    "made",
    "points/h",
    "nodes/h",
    "momentum",
    "s",
    "verdict",
)


def line(row: Row) -> str:
    beta = "usual" if row.beta is None and row.enforcement == DEFAULT else f"{row.beta or 0:g}"
    return (
        f"{row.case:<34.34} {row.enforcement:<17} {row.integrator:<18} {beta:>7} {row.courant:7.3f} {row.fraction:8.3f} {row.steps:8d} {row.energy:9.1e} {row.lost:9.1e} {row.held:9.1e} {row.made:9.1e} "
        f"{row.points:8.1e} {row.nodes:8.1e} {row.momentum:8.1e} {row.seconds:6.1f}  {row.verdict}"
        + (f" ({row.note})" if row.note else "")
    )


def head() -> str:
    return f"{HEAD[0]:<34} {HEAD[1]:<17} {HEAD[2]:<18} {HEAD[3]:>7} {HEAD[4]:>7} {HEAD[5]:>8} {HEAD[6]:>8} {HEAD[7]:>9} {HEAD[8]:>9} {HEAD[9]:>9} {HEAD[10]:>9} {HEAD[11]:>8} {HEAD[12]:>8} {HEAD[13]:>8} {HEAD[14]:>6}  {HEAD[15]}"
