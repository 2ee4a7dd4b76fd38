"""
``make zoo``: everyday scenes with all options, judged by oracles that need no stored answer.
It runs what FOLDER/zoo.jsonl does not have yet, so Ctrl-C keeps the completed rows and the same command continues.
``--book`` writes the table of the chapter "Hard cases" into ``docs/stability``. A row is

- ok: no oracle disagrees;
- told: the leapfrog gains energy at large strain, the run warns of it, and half the step is the cure;
- refused: the library gave a reason before the run or in it, and the options exceed a limit that it names;
- FAIL: anything else, with the first oracle that disagrees.
"""

from __future__ import annotations

import json
import math
import os
import re
import sys
import time
import warnings
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import inside  # noqa: E402
import numpy as np  # noqa: E402
import program  # noqa: E402
import stage as stages  # noqa: E402
from animals import ANIMALS, ONE_AT_A_TIME, Animal, Options, runs  # noqa: E402
from lab import GROWTH, booked, is_told, kinds, rise  # noqa: E402
from stage import Stage  # noqa: E402

import libcontact as ct  # noqa: E402

BOOK = Path(__file__).resolve().parents[1] / "docs" / "stability"
RECORDS = 150
# Every how many of them bodies are searched for elements of others.
LOOK = 25
# Largest difference of bounce (of the speed), of place (of the way at that speed) and of peak force (of
# itself) between a scene and the same one with held bodies for obstacles, with whole skins for faces, and with
# the explicit law at a tenth of the step. An impact stops the layer of nodes at the surface, which has 1 / 2n
# of the mass of n layers of elements: the last one comes on top where laws are compared.
TOLERANCE = {"held": (0.15, 0.15, 0.3), "outer": (0.02, 0.02, 0.1), "tiny": (0.05, 0.05, 0.5)}
# An impact loses nothing, so what it leaves in vibrations depends on when a layer meets the surface within a step,
# and the next impact on that: one run of a block between six walls says little. Scenes that differ are run with
# these shares of the step, too, and their means are compared to the same tolerance and three standard errors. Six runs
# know their own spread badly, so those that still differ are run with all shares: more samples leave less open.
SHARES, ERRORS = tuple(round(0.97 - 0.03 * i, 2) for i in range(16)), 3.0
FEW = 5
# Largest difference of a scene that was mirrored, turned or put in another order, in h. Names and the order of
# the surfaces of a contact do not change a bit.
SAME, BITS = 1e-9, ("renamed", "swapped")
# Forces of friction are solved to this part, whatever the tolerance is (chapter "Friction"): so much of the
# displacements they may change.
FRICTION = 1e-4
# Least fraction of the step without friction that a friction of so much leaves.
FRICTION_STEP, LITTLE_FRICTION = 0.25, 0.1
# The explicit law may need many steps.
MOST_STEPS, MOST_EXPLICIT = 4000, 20_000


class Refused(Exception):
    """The library refuses the scene, with its reason."""


@dataclass
class Row:
    """One scene with one set of options. Growth, differences: over the scales of the scene; depth in h."""

    scene: str
    options: str
    verdict: str = "ok"
    reason: str = ""
    growth: float = 0.0
    depth: float = 0.0
    held: float = -1.0
    outer: float = -1.0
    tiny: float = -1.0
    same: float = -1.0
    sensitive: str = ""
    steps: int = 0
    fraction: float = 0.0
    warned: str = ""
    seconds: float = 0.0

    def fail(self, reason: str) -> None:
        if self.verdict != "FAIL":
            self.verdict, self.reason = "FAIL", reason


@dataclass
class Answer:
    """What two runs of the same physics have in common."""

    run: ct.Run
    steps: int
    fraction: float  # of the step without contact
    depth: float
    inside: int
    warned: str
    beside: bool  # whether other faces touched than the named ones
    aside: float  # impulse of points of named faces on other faces
    made: float  # rise of the books of contacts and obstacles

    def bounce(self, names: list[str]) -> np.ndarray:
        return np.array([self.run.state[name].velocity.mean(0) for name in names])

    def place(self, names: list[str]) -> np.ndarray:
        return np.array([self.run.state[name].displacement.mean(0) for name in names])

    def peak(self, names: list[str], layer: float) -> float:
        """Largest force on a body, as a mean over a tenth of the run and the vibration of a layer at least, if the
        run takes longer than that."""
        times = self.run.time
        at = np.linspace(times[0], times[-1], 40)
        most, over = 0.0, min(max(4, math.ceil(layer / (at[1] - at[0]))), len(at) - 1)
        for name in names:
            p = self.run.body_momentum(name)["p"]
            own = np.stack([np.interp(at, times, p[:, c]) for c in range(3)], -1)
            most = max(most, float(np.linalg.norm(own[over:] - own[:-over], axis=1).max()))
        return most / (at[over] - at[0])


def play(stage: Stage, title: str, named: tuple[stages.Touch, ...] = ()) -> Answer:
    """Run a scene, and measure how deep its bodies are in obstacles and in each other, and whether other faces
    than the ``named`` ones touch."""
    made = stage.scene(title)
    try:
        problem = made._built(None)
    except (ct.SceneError, ct.Error) as error:
        raise Refused(str(error)) from error
    if problem.step_count > (MOST_EXPLICIT if "enforcement" in stage.law else MOST_STEPS):
        raise TooSlow(problem.step_count, problem.dt / problem.stable.dt_without_contact)
    made.set_output(every=max(1, problem.step_count // RECORDS), fields=[])
    depth = Depth(stage, named)
    with booked() as books, warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        run = made.run(progress=False, output=False, watch=depth)
    fraction = problem.dt / problem.stable.dt_without_contact
    found = depth.deepest, depth.inside, kinds(told), depth.beside, depth.aside
    return Answer(run, problem.step_count, fraction, *found, rise(np.array(books)[:, 0]))


class TooSlow(Exception):
    """A scene that needs too many steps."""

    def __init__(self, steps: int, fraction: float):
        super().__init__(f"{steps} steps: {fraction:.2g} of the step without contact")


class Depth:
    """The deepest node of a body in an obstacle, or the deepest point of a small obstacle in a body, in h;
    the number of elements whose centre is in another body; whether faces touch that are not named, as those of
    a body that bulges; and the impulse of points of the named ones that meet such faces, over a border."""

    def __init__(self, stage: Stage, named: tuple[stages.Touch, ...]):
        self.stage, self.deepest, self.inside, self.records = stage, 0.0, 0, 0
        self.h, self.named, self.beside, self.aside, self.last = stage.h, named, False, 0.0, 0.0
        self.others: list[list[np.ndarray]] = []

    def __call__(self, run: ct.Run) -> None:
        now = float(run.state.time)
        for wall in self.stage.walls:
            body = run.state[wall.body]
            deep = wall.depth(body.positions, now)
            if wall.shape == "sphere":
                deep = max(deep, self.of_sphere(wall, body, now))
            self.deepest = max(self.deepest, deep / self.h)
        if self.records == 0:
            self.others = [
                [others(run.state[body].mesh, face) for body, face in (touch.one, touch.two)]
                for touch in self.named
            ]
        for sides, points in zip(self.others, run.contact):
            pressed = points[points["raw_pressure"] > 0]
            for side, other in enumerate(sides):
                own = pressed[pressed["side"] == side]
                met = own[sides[1 - side][own["other"]]]
                self.beside |= bool(other[own["face"]].any())
                self.aside += float(met["raw_pressure"] @ met["weight"]) * (now - self.last)
        self.last = now
        if self.records % LOOK == 0:
            self.look(run)
        self.records += 1

    def of_sphere(self, wall: stages.Wall, body: ct.BodyState, now: float) -> float:
        """Depth of the sphere below the skin, at the point of the skin next to its centre."""
        centre = np.array([wall.point]) + now * np.array([wall.velocity])
        faces, _ = body.mesh.faces("outer")
        near = ct.nearest(
            "Q4" if body.mesh.element == "hex8" else "Q8", body.positions, faces, centre
        )
        return float(wall.radius - near.signed_distance[0])

    def look(self, run: ct.Run) -> None:
        for touch in self.stage.touches:
            one, two = touch.one[0], touch.two[0]
            for a, b in ((one, two), (two, one)) if one != two else ():
                x, y = run.state[a], run.state[b]
                centres = x.positions[x.elements[:, :8]].mean(1)
                near = ((centres > y.positions.min(0)) & (centres < y.positions.max(0))).all(1)
                if near.any():
                    found = inside.within(centres[near], y.positions, y.elements)
                    self.inside = max(self.inside, int(found.sum()))


def others(mesh: ct.Mesh, face: str) -> np.ndarray:
    """Which faces of the whole skin are not those with a name."""
    named = {frozenset(nodes) for nodes in mesh.faces(face)[0]}
    return np.array([frozenset(nodes) not in named for nodes in mesh.faces("outer")[0]])


def growth(o: Options, animal: Animal, run: ct.Run) -> float:
    """The most by which kinetic and strain energy, with that of the weight, exceed the start and the
    external work. An overlap that is pushed out gives its energy, too. In a step with a large force the product of
    the velocities before and after is no energy of the bodies alone; the contact's is negative then
    (eq:controlled-energy)."""
    energy = run.energy
    own = energy["kinetic"] + energy["strain"]
    touching = [energy[name] for name in ("contact", "obstacle") if name in energy.dtype.names]
    own = own + np.minimum(sum(touching), 0.0)
    if "gravity" in energy.dtype.names:
        own = own + energy["gravity"]
    start = energy["total"][0] if o.initial_penetration == "force" else own[0]
    unit = max(abs(start), float(np.abs(energy["external"]).max()), animal.scale)
    return float((own - energy["external"] - start).max() / unit)


def free(stage: Stage) -> list[str]:
    return [name for name, part in stage.parts.items() if not part.held] or list(stage.parts)


def difference(
    kind: str, animal: Animal, *forms: list[Answer], aside: float = 0.0
) -> tuple[float, str]:
    """The largest distance of the mean of the first form from the range of those of the others over its tolerance, with
    what comes on top, and what differs. Of several runs, the means are known to ``ERRORS`` standard errors, which do
    not count."""
    names = free(animal.stage)
    end = animal.stage.time["end"]
    way = max(animal.length, animal.speed * end)
    peaks = [[run.peak(names, animal.stage.layer) for run in runs] for runs in forms]
    # A force that stops the scene within the run is the least that counts.
    force = max(*(np.mean(p) for p in peaks), 2 * animal.scale / animal.speed / end)
    v, x, f = (
        apart(*values) / unit
        for values, unit in (
            ([[run.bounce(names) for run in runs] for runs in forms], animal.speed),
            ([[run.place(names) for run in runs] for runs in forms], way),
            (peaks, force),
        )
    )
    more = aside + (0.5 / animal.layers if kind == "tiny" else 0.0)
    parts = [
        (value / (limit + more), f"{word} differs by {100 * value:.3g} %")
        for value, limit, word in zip((v, x, f), TOLERANCE[kind], ("bounce", "place", "peak force"))
    ]
    return max(parts)


def apart(one: list[Any], *others: list[Any]) -> float:
    """The largest distance of a mean from the range of others, less what their samples leave open."""
    a, beyond = np.array(one), []
    for two in others:
        b = np.array(two)
        few = min(len(a), len(b)) < 2
        error = 0.0 if few else np.sqrt(a.var(0, ddof=1) / len(a) + b.var(0, ddof=1) / len(b))
        way = a.mean(0) - b.mean(0)
        beyond.append((way - ERRORS * error, -way - ERRORS * error))
    return float(np.maximum(np.min(beyond, axis=0), 0.0).max())


# The other forms of a scene.


def same(stage: Stage) -> Stage:
    return stage


def tiny(stage: Stage, **law: float) -> Stage:
    """The explicit law with a soft penalty at a tenth of its step."""
    law = {k: v for k, v in stage.law.items() if k not in ("dissipation", "beta")} | law
    law |= {"enforcement": "penalty"}
    time_ = {k: v for k, v in stage.time.items() if k != "integrator"} | {"fraction": 0.1}
    return replace(stage, law=law, time=time_)


def softer(stage: Stage) -> Stage:
    """The same with a fourth of the penalty. Explicit penalties differ from each other, too."""
    return tiny(stage, beta=1.0)


def stiffer(stage: Stage) -> Stage:
    """The same with the penalty of the default law."""
    return tiny(stage, beta=40.0)


# The other forms that a scene is compared with; it is within the range of those of each kind.
TWINS: dict[str, tuple[Callable[[Stage], Stage], ...]] = {
    "held": (stages.held_bodies,),
    "outer": (stages.outer,),
    "tiny": (tiny, softer, stiffer),
}
FORMS: dict[str, Callable[[Stage], Stage]] = {
    "renamed": stages.renamed,
    "reordered": stages.reordered,
    "swapped": stages.swapped,
    "mirrored": stages.mirrored,
    "turned": lambda stage: stages.turned(stage, np.eye(3)[[1, 2, 0]]),
}


def compare_twins(row: Row, animal: Animal, own: Answer, o: Options) -> None:
    for kind, forms in TWINS.items():
        if kind not in animal.twins or not suits(kind, o):
            continue
        try:
            named = animal.stage.touches if kind == "outer" else ()
            other = play(forms[0](animal.stage), f"{row.scene}, {kind}", named)
            if other.beside:
                continue
            value, what = difference(kind, animal, [own], [other])
            if value > 1:
                row.sensitive = f"{row.sensitive} {kind}".strip()
                runs = [[own], [other], *([] for _ in forms[1:])]
                value, what = compare_means(kind, animal, runs, SHARES[:FEW])
                if value > 1:
                    with suppress(TooSlow):
                        value, what = compare_means(kind, animal, runs, SHARES[FEW:])
            if value > 1 and kind == "held":
                pair = [[play(tiny(form(animal.stage)), row.scene)] for form in (same, *forms)]
                value -= difference(kind, animal, *pair)[0]
        except (Refused, TooSlow):
            continue
        except ct.Error as error:
            row.fail(f"{kind}: {type(error).__name__}: {error}")
            continue
        setattr(row, kind, value)
        if value > 1:
            row.fail(f"{kind}: {what}")


def compare_means(
    kind: str, animal: Animal, runs: list[list[Answer]], shares: tuple[float, ...]
) -> tuple[float, str]:
    """Add these landings to the runs of the scene and of its other forms, and compare their means. The momentum that
    other faces exchange is no difference of the law."""
    for form, found in zip((same, *TWINS[kind]), runs):
        found += landings(animal.stage, form, shares)
    aside = 0.5 * runs[1][0].aside * animal.speed / animal.scale
    return difference(kind, animal, *runs, aside=aside)


def landings(
    stage: Stage, form: Callable[[Stage], Stage], shares: tuple[float, ...]
) -> list[Answer]:
    """A form of a scene with shorter steps, which meets the surface in other phases of a step."""
    runs = []
    for share in shares:
        again = form(stage)
        fraction = share * again.fraction
        runs.append(play(replace(again, time=again.time | {"fraction": fraction}), "landing"))
    return runs


def suits(kind: str, o: Options) -> bool:
    """Whether a twin says something about the options."""
    if o.enforcement is not None:
        return False
    if kind == "held" and o.points is not None:
        return False  # obstacles have Gauss points
    if kind == "outer":
        return not (o.skin or o.way)
    if kind == "tiny":
        return (o.beta is None or o.beta >= 1) and o.integrator is None and o.fraction is None
    return True


def has_forms(o: Options) -> bool:
    """Whether the other forms are run: they take as long as five scenes."""
    return o in (
        Options(),
        Options(element="hex20"),
        Options(element="reduced"),
        Options(points="lobatto"),
        Options(friction=0.5),
        Options(beta=3e3),
        Options(integrator="noh_bathe"),
        Options(ratio=2),
        Options(way=1),
        Options(skin=True),
    )


def compare_forms(row: Row, animal: Animal) -> None:
    """Other forms of the scene, with forces to 1e-12: each form has its own rounding and stops at another loose
    solution."""
    stage = replace(animal.stage, time=animal.stage.time | {"force_tolerance": 1e-12})
    names, own = list(stage.parts), play(stage, row.scene)
    x = {name: own.run.state[name].displacement for name in names}
    size = max(float(np.abs(u).max()) for u in x.values()) / stage.h
    for kind, form in FORMS.items():
        if kind == "swapped" and not stage.touches:
            continue
        changed = form(stage)
        try:
            other = play(changed, f"{row.scene}, {kind}")
        except (Refused, TooSlow, ct.Error) as error:
            row.fail(f"{kind}: {type(error).__name__}: {error}")
            continue
        R = {"mirrored": np.diag([-1.0, 1, 1]), "turned": np.eye(3)[[1, 2, 0]]}.get(kind, np.eye(3))
        back = dict(zip(sorted(names), sorted(changed.parts, key=lambda n: n.split("_", 1)[-1])))
        back = back if kind == "renamed" else {name: name for name in names}
        worst = max(
            float(np.abs(other.run.state[back[name]].displacement @ R - x[name]).max())
            for name in names
        )
        row.same = max(row.same, worst / stage.h)
        alike = SAME + FRICTION * size * (animal.stage.law.get("friction", 0.0) > 0)
        if worst / stage.h > (0.0 if kind in BITS else alike):
            row.fail(f"{kind}: differs by {worst / stage.h:.1e} h")


def judge(make: Callable[[Options], Animal], o: Options, whole: bool) -> Row:
    """Run a scene and all that is compared with it."""
    begin = time.perf_counter()
    row = Row(make.__name__, str(o))
    animal = make(o)
    try:
        own = play(animal.stage, row.scene)
        weigh(row, animal, own, o)
        if whole:
            compare_twins(row, animal, own, o)
            if has_forms(o):
                compare_forms(row, animal)
    except Refused as error:
        refuse(row, animal, o, str(error))
    except TooSlow as error:
        row.fail(str(error))
    except (ct.StepTooLarge, ct.InvertedElement) as error:
        refuse(row, animal, o, f"{type(error).__name__}: {error}")
    except ct.Error as error:
        row.fail(f"{type(error).__name__}: {error}")
    row.seconds = time.perf_counter() - begin
    return row


def weigh(row: Row, animal: Animal, own: Answer, o: Options) -> None:
    """The oracles that need one run."""
    row.steps, row.fraction, row.warned = own.steps, own.fraction, own.warned
    row.growth = growth(o, animal, own.run)
    row.depth = own.depth - animal.overlap / animal.stage.h
    if not np.isfinite(row.growth):
        row.fail("not finite")
    if row.growth > GROWTH and o.enforcement is None:
        weigh_growth(row, animal, own, o)
    if row.depth > animal.deep and (o.beta is None or o.beta >= 1) and not yields(row, animal, o):
        row.fail(f"{row.depth:.2g} h deep")
    least = FRICTION_STEP * animal.stage.fraction
    if 0 < o.friction <= LITTLE_FRICTION and own.fraction < least:
        row.fail(f"friction leaves {own.fraction:.2g} of the step")
    if own.inside:
        row.fail(f"{own.inside} elements are inside another body")
    for a, b, way in animal.apart:
        x, y = (own.run.state[name].positions.mean(0) for name in (a, b))
        if (y - x) @ np.array(way) <= 0:
            row.fail(f"{b} has passed through {a}")


def yields(row: Row, animal: Animal, o: Options) -> bool:
    """Whether a scene with a limit of its own for the depth keeps that of all others, and goes no deeper than with the
    explicit law at a tiny step: then it is the penalty that yields."""
    try:
        other = play(tiny(animal.stage, beta=o.beta or 40.0), row.scene)
    except (Refused, TooSlow, ct.Error):
        return False
    return row.depth <= min(Animal.deep, other.depth - animal.overlap / animal.stage.h)


def weigh_growth(row: Row, animal: Animal, own: Answer, o: Options) -> None:
    """Growth that the leapfrog makes is told; other growth is a failure."""
    row.fail(f"the bodies' energy grows by {100 * row.growth:.3g} %")
    half = animal.stage.time | {"fraction": 0.5 * animal.stage.fraction}
    told = is_told(
        own.warned,
        own.made / animal.scale,
        lambda: growth(o, animal, play(replace(animal.stage, time=half), row.scene).run),
    )
    if told:
        row.verdict, row.reason = "told", f"the leapfrog gains {100 * row.growth:.3g} %{told}"


# What the library may refuse before a run, by a part of its reason.
TRUE_REASONS = (
    "initial_penetration",
    "inside at the start",
    "hex8 only",
    "reduced",
    "thin",
    "is for linear bodies",
)


def refuse(row: Row, animal: Animal, o: Options, reason: str) -> None:
    """Refused if the options exceed a limit; else the refusal is a failure. A run that ends before its time
    needs a limit of the scene, or a speed above its usual one."""
    row.reason = reason
    before = ": at t = " not in reason and any(word in reason for word in TRUE_REASONS)
    row.verdict = "refused" if before or animal.limit or o.size > 1 else "FAIL"


# The table.


def collect(path: Path, draws: int, names: list[str], alone: bool = False) -> list[Row]:
    """Run what the file does not have, and print each row as it comes. Scenes with options at random, and
    ``alone`` all but the defaults, are compared with no other run."""
    rows = {(row.scene, row.options): row for row in read(path)}
    todo = [
        (make, o)
        for make, o in runs(draws)
        if (not names or make.__name__ in names) and (make.__name__, str(o)) not in rows
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        with path.open("a", encoding="utf-8") as file:
            for i, (make, o) in enumerate(todo):
                row = judge(make, o, whole=o == Options() if alone else o in ONE_AT_A_TIME)
                rows[row.scene, row.options] = row
                file.write(json.dumps(asdict(row)) + "\n")
                file.flush()
                print(f"{i + 1:4d}/{len(todo)} {line(row)}", flush=True)
    except KeyboardInterrupt:
        print("interrupted: the rows so far are kept; the same command continues", flush=True)
    return list(rows.values())


def read(path: Path) -> Iterator[Row]:
    if path.exists():
        for text in path.read_text(encoding="utf-8").splitlines():
            yield Row(**json.loads(text))


def line(row: Row) -> str:
    return (
        f"{row.verdict:<8} {row.scene:<22} {row.options:<40.40} {100 * row.growth:8.3g} % {row.depth:6.2f} h"
        f" {row.steps:6d} steps {row.seconds:6.1f} s  {row.reason}"
    )


def summarise(rows: list[Row]) -> list[dict[str, str]]:
    """A line for each scene with its worst values."""
    out = []
    for name in dict.fromkeys(row.scene for row in rows):
        own = [row for row in rows if row.scene == name]
        ended = [row for row in own if row.steps]
        usual = [row for row in ended if "enforcement=" not in row.options]

        def most(key: str, form: str = ".2g", ended: list[Row] = ended) -> str:
            values = [getattr(row, key) for row in ended if getattr(row, key) >= 0]
            return format(max(values), form) if values else ""

        verdicts = [row.verdict for row in own]
        out.append(
            {
                "scene": name.replace("_", " "),
                "runs": str(len(own)),
                "ok": str(verdicts.count("ok")),
                "told": str(verdicts.count("told")),
                "refused": str(verdicts.count("refused")),
                "fail": str(verdicts.count("FAIL")),
                "bodies' energy grows by": most("growth", ended=usual),
                "depth / h": most("depth"),
                "held body": most("held"),
                "whole skin": most("outer"),
                "tiny step": most("tiny"),
                "other form / h": most("same", ".0e"),
                "least step": format(min((row.fraction for row in ended), default=0.0), ".2g"),
            }
        )
    return out


def reasons(rows: list[Row]) -> list[dict[str, str]]:
    """What was told, refused or failed, counted by scene and by the words of the reason."""
    groups: dict[tuple[str, str, str], list[Row]] = {}
    for row in rows:
        if row.verdict != "ok":
            words = re.sub(r"[-+]?\d[\d.e+-]*", "…", row.reason.split("[docs")[0].split(";")[0])
            groups.setdefault((row.verdict, row.scene, words), []).append(row)
    return [
        {
            "": verdict,
            "scene": name.replace("_", " "),
            "runs": str(len(own)),
            "one of them": own[0].options,
            "reason": own[0].reason.split("[docs")[0].strip(),
        }
        for (verdict, name, _), own in sorted(groups.items())
    ]


def write(rows: list[Row], folder: Path) -> None:
    """The tables of the book: the worst of each scene, what did not end, and where it was computed."""
    sys.path.append(str(Path(__file__).resolve().parents[1] / "accuracy"))
    from table import where

    here = where()
    origin = {
        "date": time.strftime("%Y-%m-%d"),
        "machine": here["machine"],
        "compiler": here["compiler"],
        "revision": here["commit"],
        "runs": str(len(rows)),
    }
    for name, table in (
        ("zoo", summarise(rows)),
        ("zoo_reasons", reasons(rows)),
        ("zoo_where", [origin]),
    ):
        program.write_table(folder / f"{name}.csv", table)


def main() -> int:
    parser = program.parser(
        __doc__, [make.__name__ for make in ANIMALS], "for zoo.jsonl and tables"
    )
    parser.add_argument("--draws", type=int, default=8, help="options at random for each scene")
    alone = "compare only scenes at their defaults with other runs, in a fifth of the time"
    parser.add_argument("--alone", action="store_true", help=alone)
    given = parser.parse_args()
    rows = collect(given.folder / "zoo.jsonl", given.draws, given.cases, given.alone)
    if not rows:
        return 1
    for place in (given.folder, BOOK) if given.book else (given.folder,):
        write(rows, place)
    counts = {
        word: sum(row.verdict == word for row in rows) for word in ("ok", "told", "refused", "FAIL")
    }
    print(f"\n{len(rows)} runs: " + ", ".join(f"{n} {word}" for word, n in counts.items()))
    for row in rows:
        if row.verdict == "FAIL":
            print("  " + line(row))
    return 1 if counts["FAIL"] else 0


if __name__ == "__main__":
    sys.exit(main())
