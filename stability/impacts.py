"""
What elastic bodies keep of their energy in an impact, and with which speed they leave (chapter
"Enforcement"). Nothing in these scenes loses energy but the law of contact.

Every impact is run with several steps and phases of landing; the table has the worst of them. The same
mesh with explicit penalties at a tiny step tells the speeds. ``--book`` writes the tables of the chapter.
"""

from __future__ import annotations

import itertools
import math
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cases
import folding
import numpy as np
import program
import shapes
from lab import DEFAULT, ELASTIC, booked, material, rise, scene

import libcontact as ct

FRACTIONS = (0.3, 0.6, 0.9, 0.98)
PHASES = tuple(i / 7 for i in range(7))
PLASTIC: dict[str, Any] = {"restitution": 0.0}
# Explicit penalties, soft ones and that of the law. Each loses nothing at a tiny step, but how much of the
# motion becomes vibration depends on the penalty, so the speeds that they give are a range.
EXPLICIT = tuple({"enforcement": "penalty", "beta": beta} for beta in (0.5, 1.0, 4.0, 40.0))
TINY = 0.1  # fraction of the step of the explicit penalty that counts as tiny
SPEED = 0.01  # of an impact, over the wave speed


@dataclass
class Scene:
    """A scene, the energy of its relative motion (None: the work put in), the mass of each body, and the
    direction and unit of speeds."""

    made: ct.Scene
    energy: float | None
    masses: list[float]
    along: tuple[float, float, float] = (0.0, 0.0, 1.0)
    speed: float = SPEED


# A scene from the keys of its contacts, the fraction of the stable step and the phase of landing.
Maker = Callable[[dict[str, Any], float, float], Scene]


@dataclass
class Result:
    """Parts of the energy of the relative motion that the bodies keep and that contacts hold at the
    end, the largest growth of the total in a step, what contacts have lost at the end and made on the way,
    and the speed of each body."""

    kept: float
    held: float
    grown: float
    taken: float
    made: float
    speeds: np.ndarray


def run(maker: Maker, law: dict[str, Any], fraction: float, phase: float) -> Result:
    """Run one impact."""
    given = maker(law, fraction, phase)
    with booked() as books, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        done = given.made.run(progress=False, output=False)
    contact = np.array(books)[:, 0]
    total, reserve = done.energy["total"], done.energy["reserve"][-1]
    unit = given.energy or float(np.abs(done.energy["external"]).max())
    along = np.array(given.along)
    momenta = [done.body_momentum(name)["p"][-1] @ along for name in done.bodies]
    return Result(
        1 - (total[0] - total[-1] + reserve) / unit,
        reserve / unit,
        float(np.diff(total).max() / unit),
        float((contact[0] - contact[-1]) / unit),
        rise(contact / unit),
        np.array(momenta) / given.masses / given.speed,
    )


# Plates.


@dataclass(frozen=True)
class Plate:
    """A plate of n layers of elements of the height 1, with cells across a side of length 4. Its wave
    speed for ν = 0 is √E/ρ."""

    layers: int
    cells: int = 4
    velocity: float = 0.0
    young: float = 1.0
    density: float = 1.0
    element: str = "hex8"

    @property
    def mass(self) -> float:
        return self.density * 16.0 * self.layers


def stack(
    plates: list[Plate], poisson: float = 0.0, sideways: float = 0.0, time: float = 0.0
) -> Maker:
    """Plates one above the other, of which the first gap is open and the others are closed. ``sideways``
    is a velocity of the last plate along its face."""

    def make(law: dict[str, Any], fraction: float, phase: float) -> Scene:
        made, z = scene("plates"), 0.0
        closing = SPEED * (plates[0].velocity - plates[1].velocity)
        for i, plate in enumerate(plates):
            z += phase * fraction * closing if i == 1 else 0.0
            material(made, f"m{i}", plate.young, poisson, plate.density)
            box = {"origin": [0, 0, z], "size": [4, 4, plate.layers]}
            side = sideways * SPEED if i == len(plates) - 1 else 0.0
            made.add_body(
                f"p{i}",
                material=f"m{i}",
                velocity=[side, 0, SPEED * plate.velocity],
                element=plate.element,
                box={**box, "cells": [plate.cells, plate.cells, plate.layers]},
            )
            if i > 0:
                made.add_contact(f"p{i - 1}.z_max", f"p{i}.z_min", **law)
            z += plate.layers
        end = time or 2 * sum(p.layers for p in plates) / min(1, len(plates) - 1) + 14
        made.set_time(end=end, fraction=fraction, energy_limit=100).set_output(every=1, fields=[])
        mass = np.array([p.mass for p in plates])
        v = SPEED * np.array([p.velocity for p in plates])
        return Scene(made, 0.5 * (mass @ v**2 - (mass @ v) ** 2 / mass.sum()), list(mass))

    return make


def equal(n: int, poisson: float = 0.0, cells: tuple[int, int] = (4, 4), **more: Any) -> Maker:
    element = more.pop("element", "hex8")
    return stack(
        [Plate(n, cells[0], 1.0, element=element), Plate(n, cells[1], -1.0, element=element)],
        poisson,
        time=2 * n + 14,
        **more,
    )


# Bars that land flat or with an edge, at an angle.


def bar(angle: float, on_plate: bool, tilted: bool, points: str = "gauss") -> Maker:
    """A bar of 2 x 2 x 6 elements of the size 1 with ν = 0.3 that meets a wall or a plate: flat, with a
    velocity at an angle to the normal, or turned by the angle, with a velocity along the normal."""
    a, speed = math.radians(angle), 2 * SPEED
    turn = np.array([[math.cos(a), 0, math.sin(a)], [0, 1, 0], [-math.sin(a), 0, math.cos(a)]])

    def make(law: dict[str, Any], fraction: float, phase: float) -> Scene:
        made = scene("bar")
        material(made, young=1.0, poisson=0.3)
        nodes, elements = shapes.box((2, 2, 6), (2, 2, 6))
        nodes = nodes @ turn.T if tilted else nodes
        nodes = nodes - [0, 0, nodes[:, 2].min() - 1e-4 - phase * fraction * speed]
        sideways = 0.0 if tilted else speed * math.tan(a)
        made.add_body(
            "bar", material="soft", nodes=nodes, elements=elements, velocity=[sideways, 0, -speed]
        )
        masses = [24.0]
        if on_plate:
            box = {"origin": [-5, -3, -2], "size": [10, 6, 2], "cells": [10, 6, 2]}
            made.add_body("plate", material="soft", box=box)
            made.add_contact("bar.outer", "plate.z_max", points=points, **law)
            masses.append(120.0)
        else:
            plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
            made.add("obstacle", surface="bar.outer", plane=plane, **law)
        made.set_time(end=60.0, fraction=fraction, energy_limit=100).set_output(every=1, fields=[])
        moving = 24.0 if not on_plate else 20.0  # 1 / (1/24 + 1/120)
        return Scene(made, 0.5 * moving * speed**2, masses, speed=speed)

    return make


# Discs of NimbleSM's test thin_plate_contact.


def disc(radius: float, cells: int, rings: int, layers: int, thickness: float) -> shapes.Bricks:
    """A disc about z above z = 0: a square of cells, and rings around it."""
    half = np.linspace(-0.4, 0.4, cells + 1)
    x, y = np.meshgrid(half, half, indexing="ij")
    # The sides of the square are slightly round.
    square = np.stack([x * (1.12 - 0.75 * y * y), y * (1.12 - 0.75 * x * x)], -1)
    side = square[:-1, 0]
    rim = np.concatenate([side @ np.array([[c, s], [-s, c]]) for c, s in TURNS])
    angle = np.arctan2(rim[0, 1], rim[0, 0]) + 2 * np.pi * np.arange(len(rim)) / len(rim)
    out = np.stack([np.cos(angle), np.sin(angle)], -1)
    part = np.linspace(0.0, 1.0, rings + 1)[:, None, None]
    round_ = (1 - part) * rim + part * out
    beside = np.roll(round_, -1, axis=1)
    faces = [
        (square[:-1, :-1], square[1:, :-1], square[1:, 1:], square[:-1, 1:]),
        (round_[:-1], round_[1:], beside[1:], beside[:-1]),
    ]
    flat = np.concatenate([np.stack(corners, -2).reshape(-1, 4, 2) for corners in faces])
    z = np.linspace(0.0, thickness, layers + 1)
    bricks = [
        np.concatenate([np.insert(radius * flat, 2, height, axis=2) for height in pair], axis=1)
        for pair in zip(z, z[1:])
    ]
    return shapes.joined(np.round(np.concatenate(bricks), 9))


TURNS = ((1, 0), (0, 1), (-1, 0), (0, -1))


def discs(law: dict[str, Any], fraction: float, phase: float) -> Scene:
    """Two steel discs of two layers of elements, the second one smaller and with 100 m/s. Elements have
    about the size of that test, on a mesh of our own."""
    made = scene("discs")
    K, G, speed = 1.6e11, 0.8e11, 100.0
    young, poisson = 9 * K * G / (3 * K + G), (3 * K - 2 * G) / (6 * K + 2 * G)
    material(made, young=young, poisson=poisson, density=7800.0, law="neo_hookean")
    masses = []
    for i, (radius, cells) in enumerate(((0.25, 16), (0.225, 14))):
        nodes, elements = disc(radius, cells, 5, 2, 0.05)
        nodes[:, 2] += i * (0.052 + phase * fraction * speed * 1e-6)
        made.add_body(
            f"p{i}", material="soft", nodes=nodes, elements=elements, velocity=[0, 0, -speed * i]
        )
        sides = 4 * cells
        masses.append(7800 * 0.05 * 0.5 * sides * radius**2 * math.sin(2 * np.pi / sides))
    made.add_contact("p0.z_max", "p1.z_min", **law)
    made.set_time(end=1e-4, fraction=fraction, energy_limit=100).set_output(every=1, fields=[])
    moving = 1 / (1 / masses[0] + 1 / masses[1])
    return Scene(made, 0.5 * moving * speed**2, masses, speed=1.0)


# Bodies that are crushed and folded: the part of the work that is kept.


def crushed(around: int, through: int, speed: float) -> Maker:
    """A ring of neo-Hookean rubber is crushed by 70 % between two planes, which then leave twice as
    fast."""

    def make(law: dict[str, Any], fraction: float, phase: float) -> Scene:
        made = scene("ring")
        material(made, young=1e7, poisson=0.4, density=1000.0, law="neo_hookean")
        nodes, elements = shapes.ring(0.095, 0.02, (around, 1, through), 0.02)
        made.add_body("body", material="soft", nodes=nodes, elements=elements)
        way = 0.7 * 0.105
        time, gap = way / speed, 1e-4 * (1 + phase)
        history = {"time": [0.0, time, 1.5 * time], "value": [0.0, 1.0, 0.0]}
        for sign in (1.0, -1.0):
            made.add(
                "obstacle",
                surface="body.outer",
                plane={"point": [0, 0, -sign * (0.105 + gap)], "normal": [0, 0, sign]},
                travel=[0, 0, sign * way],
                history=history,
                **law,
            )
        end = 1.5 * time + 0.002
        made.set_time(end=end, fraction=fraction, energy_limit=100).set_output(every=1, fields=[])
        return Scene(made, None, [1.0])

    return make


def folded(name: str, stuff: str) -> Maker:
    """A strip of the stability laboratory that folds and comes in contact with itself, of a material."""
    found = next(strip for strip in folding.strips() if strip[0] == name)

    def make(law: dict[str, Any], fraction: float, phase: float) -> Scene:
        _, bricks, drive, *values = found
        made, end = drive(bricks, *values, law, stuff)
        end *= 1 + 0.01 * phase
        made.set_time(end=end, fraction=fraction, energy_limit=100).set_output(every=1, fields=[])
        return Scene(made, None, [1.0])

    return make


# What each case must show.


@dataclass(frozen=True)
class Case:
    """A case and what it must show: the largest part of the energy that the bodies lose, and the largest
    distance of their speeds from the range that the same mesh has at a tiny step (``far``: at .98 of the
    step)."""

    name: str
    maker: Maker
    lose: float = 0.01
    near: float = math.inf
    far: float = math.inf
    phases: tuple[float, ...] = PHASES
    closed: bool = False  # bodies touch at the end, so what points hold there is not lost
    exact: tuple[float, ...] = ()  # speeds known from elsewhere, also in the range

    def reference(self) -> list[np.ndarray]:
        """Speeds of the same mesh at a tiny step with explicit penalties, and those known from
        elsewhere."""
        if math.isinf(self.near):
            return []
        closed = [np.array(self.exact)] if self.exact else []
        return [run(self.maker, law, TINY, 0.3).speeds for law in EXPLICIT] + closed


LIMITS = {1: (0.02, 0.12, 0.12), 2: (0.01, 0.02, 0.05), 4: (0.005, 0.02, 0.05)}
LIMITS |= {8: (0.005, 0.02, 0.05), 16: (0.002, 0.02, 0.05)}


def plates() -> Iterator[Case]:
    for poisson in (0.0, 0.3):
        for cells in ((4, 4), (4, 5)):
            for n, limits in LIMITS.items():
                name = f"plates of {n}, ν {poisson:g}, {cells[0]}:{cells[1]}"
                exact = (-1.0, 1.0) if poisson == 0.0 else ()
                yield Case(name, equal(n, poisson, cells), *limits, exact=exact)
    for n in (1, 2, 4):
        yield Case(f"hex20 plates of {n}", equal(n, element="hex20"), 0.02)


def unlike() -> Iterator[Case]:
    light, two = Plate(2, velocity=1.0), LIMITS[2]
    yield Case("light on heavy", stack([light, Plate(2, young=10, density=10)]), *two)
    yield Case("light on dense", stack([light, Plate(2, density=10)]), *two)
    yield Case("soft on stiff", stack([light, Plate(2, young=100)]), *two)
    yield Case("thin on thick", stack([Plate(1, velocity=1.0), Plate(4)]), *LIMITS[1])
    for n in (1, 2, 4):
        three = [Plate(n, velocity=1.0), Plate(n), Plate(n)]
        yield Case(f"cradle of {n}", stack(three, time=4 * n + 16), *LIMITS[n])
    three = [Plate(1, 4, 1.0), Plate(1, 5), Plate(1, 4)]
    yield Case("cradle of 1, 4:5:4", stack(three, time=20), *LIMITS[1])
    yield Case("cradle 2-1-2", stack([light, Plate(1), Plate(2)], time=30), *LIMITS[1])


def bars() -> Iterator[Case]:
    for tilted in (False, True):
        for on_plate in (False, True):
            for angle in (0, 5, 20, 45):
                if angle or not tilted:
                    where = "plate" if on_plate else "wall"
                    name = f"{'tilted' if tilted else 'flat'} bar on a {where}, {angle}°"
                    yield Case(name, bar(angle, on_plate, tilted), 0.01, 0.02, 0.05, PHASES[::3])
    # Here the sides of the bar meet Gauss points of the plate beside it.
    for name, angle in (("flat", 45), ("tilted", 5)):
        maker = bar(angle, True, name == "tilted", "lobatto")
        yield Case(f"{name} bar, Lobatto points", maker, 0.01, 0.02, 0.05, PHASES[::3])
    # What that test converges to on its own mesh.
    yield Case("thin discs", discs, 0.01, 2.0, 2.0, exact=(-81.2, 0.7))
    yield Case("Saint-Venant", stack([Plate(40, 1, 1.0), Plate(80, 1)], time=190), 0.01, 0.01, 0.01)


def bent() -> Iterator[Case]:
    for around, through, speed in ((48, 2, 20.0), (48, 2, 5.0), (96, 4, 20.0)):
        name = f"ring of {around} x {through}, {speed:g} m/s"
        yield Case(name, crushed(around, through, speed), phases=(0.0, 0.5))
    for called, stuff in (("linear", "linear"), ("neo-Hookean", "neo_hookean")):
        for name, *_ in folding.strips():
            yield Case(f"{called} fold, {name}", folded(name, stuff), phases=(0.0,), closed=True)


def measured(case: Case, fraction: float, reference: list[np.ndarray]) -> dict[str, Any]:
    """The row of a case at one step."""
    own = [run(case.maker, ELASTIC, fraction, phase) for phase in case.phases]
    speeds = np.array([result.speeds for result in own])
    known = np.array(reference) if reference else speeds
    off = float(np.maximum(known.min(0) - speeds, speeds - known.max(0)).max())
    row = {
        "case": case.name,
        "step": fraction,
        "lost": max(float(1 - result.kept - result.held) for result in own),
        "held": max(float(result.held) for result in own),
        "grows": max(result.grown for result in own),
        "taken": max(result.taken for result in own),
        "made": max(result.made for result in own),
        "off": max(off, 0.0),
        "speeds": ranges(speeds) if reference else "",
        "tiny": ranges(known) if reference else "",
    }
    return {**row, "short": faults(case, row)}


def ranges(speeds: np.ndarray) -> str:
    """The smallest and the largest speed of each body."""
    return ", ".join(f"{a:.3f} ... {b:.3f}" for a, b in zip(speeds.min(0), speeds.max(0)))


def faults(case: Case, row: dict[str, Any]) -> str:
    """What a row does not show. What the leapfrog loses or makes is no fault of the law."""
    lost = row["taken"] + (0.0 if case.closed else row["held"])
    near = case.far if row["step"] > 0.95 else case.near
    wrong = [f"loses {lost:.4f} > {case.lose:g}"] if lost > case.lose else []
    wrong += [f"makes {row['made']:.4f}"] if row["made"] > 0.002 else []
    return "; ".join(wrong + ([f"speed {row['off']:.3f} off"] if row["off"] > near else []))


def impacts(groups: list[Callable[[], Iterator[Case]]]) -> list[dict[str, Any]]:
    rows = []
    for group in groups:
        for case in group():
            reference = case.reference()
            for fraction in FRACTIONS:
                rows.append(measured(case, fraction, reference))
                show(rows[-1])
    return rows


def show(row: dict[str, Any]) -> None:
    print(
        "  ".join(f"{v:.3g}" if isinstance(v, float) else str(v) for v in row.values()), flush=True
    )


# A long bar on a wall: the mode at its surface, and many impacts.


def surface_mode(law: dict[str, Any], courant: float, landing: float) -> tuple[float, float]:
    """Standard deviation of the stress beside the wall after 20 to 40 elements of travel, over its
    plateau, and the rms error of the force after 30 to 180."""
    n, gap = 100, 1e-9 + landing * courant * SPEED
    made = scene("bar on a wall")
    material(made, young=1.0, poisson=0.0)
    box = {"origin": [0, 0, gap], "size": [1, 1, n], "cells": [1, 1, n]}
    made.add_body("bar", material="soft", box=box, velocity=[0, 0, -SPEED])
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    made.add("obstacle", surface="bar.z_min", plane=plane, **law)
    made.add_probe("wall", resultant="obstacle")
    made.add_probe("first", body="bar", point=[0.5, 0.5, gap + 0.5], quantities=["stress"])
    made.set_time(end=185.0, dt=courant).set_output(every=10**6, fields=[])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        done = made.run(progress=False, output=False)
    first, wall = done.probes["first"], done.probes["wall"]
    since = first["time"] - gap / SPEED
    stress = first["stress"][(since >= 20) & (since <= 40), 2] / SPEED
    force = wall["force"][(since >= 30) & (since <= 180), 2] / SPEED
    return float(stress.std()), float(np.sqrt(np.mean((force - 1) ** 2)))


def modes() -> list[dict[str, Any]]:
    """The mode at the surface at several Courant numbers, the worst of five landings."""
    rows = []
    for courant in (0.03, 0.125, 0.25, 0.5, 0.9, 0.98):
        found = [surface_mode(ELASTIC, courant, landing / 5) for landing in range(5)]
        stress, force = np.max(found, axis=0)
        short = "" if stress <= 0.01 and force <= 0.001 else "noisy"
        row = {"case": "mode at the surface", "step": courant, "stress": float(stress)}
        rows.append({**row, "force": float(force), "short": short})
        show(rows[-1])
    return rows


def bounces() -> list[dict[str, Any]]:
    """A bar of 100 elements that falls on a floor four times: energy lost, and the largest delay of an
    impact in periods of the bar."""
    rows = []
    for fraction in FRACTIONS:
        found, late = cases.bouncing(100, 4, DEFAULT, None, fraction)
        off = float(np.abs(late).max())
        short = "" if found.lost <= 0.01 and off <= 0.01 else "late"
        row = {"case": "bouncing bar, 4 impacts", "step": fraction, "lost": found.lost}
        rows.append({**row, "held": found.held, "late": off, "short": short})
        show(rows[-1])
    return rows


# The trade: what each law keeps, over the layers, the penalty and the step.

LAWS: dict[str, dict[str, Any]] = {
    "explicit penalty": {"enforcement": "penalty"},
    "restitution 0": PLASTIC,
    "restitution 1": ELASTIC,
}
TRADE_BETAS = (1.0, 4.0, 40.0, 400.0)


def kept_of(maker: Maker, law: dict[str, Any], fraction: float, phase: float) -> float:
    """The part of the energy that the bodies keep; infinite if it has grown a hundredfold in mid-run."""
    try:
        return float(run(maker, law, fraction, phase).kept)
    except ct.Error:
        return math.inf


def trade() -> list[dict[str, Any]]:
    """The least and the largest part of their energy that two equal plates keep, of seven landings. One of layers,
    penalty and step is swept at a time, as the picture of the book shows it."""
    rows = []
    for name, law in LAWS.items():
        usual = (4, 4.0 if law.get("enforcement") == "penalty" else 40.0, 0.9)
        for at in itertools.product(LIMITS, TRADE_BETAS, FRACTIONS):
            if sum(one != other for one, other in zip(at, usual)) > 1:
                continue
            n, beta, fraction = at
            kept = [kept_of(equal(n), {**law, "beta": beta}, fraction, phase) for phase in PHASES]
            row = {"law": name, "layers": n, "beta": beta, "step": fraction}
            rows.append({**row, "least": min(kept), "most": max(kept)})
            show(rows[-1])
    return rows


GROUPS = {group.__name__: group for group in (plates, unlike, bars, bent)}
OTHERS = {other.__name__: other for other in (modes, bounces, trade)}
BOOK = Path(__file__).resolve().parent.parent / "docs" / "theory"


def summary(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One line per case, with the worst of its steps in per cent. Plates with the same number of layers,
    bars that land alike, and folds share a line."""
    lines: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        name = row["case"]
        shared = name.startswith("plates") or "fold" in name or "bar on" in name
        lines.setdefault(name.split(",")[0] if shared else name, []).append(row)
    return [
        {
            "case": name,
            "runs": str(len(own)),
            "lost, %": per_cent(max(row["lost"] for row in own)),
            "made, %": per_cent(max(-row["lost"] for row in own)),
            "held, %": per_cent(max(row["held"] for row in own)),
            "speed off": f"{max(row['off'] for row in own):.2g}" if own[0]["tiny"] else "",
            "short": str(sum(bool(row["short"]) for row in own) or ""),
        }
        for name, own in lines.items()
    ]


def per_cent(part: float) -> str:
    return f"{100 * part:.2g}" if part > 1e-8 else "0"


def main() -> int:
    given = program.parser(__doc__, [*GROUPS, *OTHERS]).parse_args()
    chosen = given.cases or [*GROUPS, *OTHERS]
    rows = impacts([GROUPS[name] for name in GROUPS if name in chosen])
    others = {name: OTHERS[name]() for name in OTHERS if name in chosen}
    if given.book:
        if rows:
            program.write_table(BOOK / "impacts.csv", summary(rows))
        if "trade" in others:
            rounded = [
                {k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()}
                for row in others["trade"]
            ]
            program.write_table(BOOK / "trade.csv", rounded)
    short = [row for row in rows + sum(others.values(), []) if row.get("short")]
    print(f"\n{len(rows)} rows of impacts; {len(short)} are short of what they must show")
    for row in short:
        show(row)
    return 1 if short else 0


if __name__ == "__main__":
    sys.exit(main())
