"""Bodies in contact with themselves: a folding strip, a rolled one, a coil, a crushed ring."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import inside
import numpy as np
import shapes
from lab import (
    ELASTIC,
    GROWTH,
    TOLD,
    Row,
    caused,
    classify,
    is_told,
    material,
    own_energy,
    rise,
    scene,
)

import libcontact as ct

YOUNG, DENSITY, C = 1e5, 1000.0, 10.0
# Depth of a corner inside another part of the body, as a fraction of the line to the centre of its element: 0.4 of an
# element, of which the Gauss points miss the first 0.3 (chapter "Contact").
DEEP = 0.8
# The energy of a leapfrog oscillates slightly at large strain; a larger rise after a loss is growth, too.
# It also loses some: a fold of linear elements loses less than a tenth of this.
LATE, MAY_LOSE = 0.01, 0.02
FRACTIONS = (0.3, 0.6, 0.9)


def smooth(end: float, points: int = 33) -> dict[str, list[float]]:
    """A history from 0 to 1 whose slope is 0 at both ends."""
    s = np.linspace(0.0, 1.0, points)
    return {"time": list(s * end), "value": list(s * s * (3 - 2 * s))}


@dataclass
class Fold:
    """Conditions on a body in contact with itself in every step: its energy, and no part of it
    inside another part."""

    body: str
    twice: int = 0
    records: int = 0

    def __call__(self, run: ct.Run) -> dict[str, float]:
        if self.records % 8 == 0:
            self.look(run)
        self.records += 1
        last = run.energy[-1]
        own = {"own": float(own_energy(last))}
        return own | {name: float(last[name]) for name in ("total", "external")}

    def look(self, run: ct.Run) -> None:
        """Count by solid angles, which takes much longer than a step."""
        state = run.state[self.body]
        self.twice = max(self.twice, inside.twice(state.positions, state.elements, DEEP))

    def verdict(self, run: ct.Run, watch: Any) -> str:
        self.look(run)
        return self.wrong(watch.curve)

    def wrong(self, curve: dict[str, list[float]]) -> str:
        growth, late = growths(curve)
        return "; ".join(
            [f"energy grows by {100 * growth:.3g} % of the work"] * (growth > GROWTH)
            + [f"energy grows by {100 * late:.3g} % of the work after a loss"] * (late > LATE)
            + [f"{self.twice} nodes are inside another part"] * (self.twice > 0)
        )


def growths(curve: dict[str, list[float]]) -> tuple[float, float]:
    """Rise of the energy of the body above its start, and of the total, which contains what points hold,
    above its lowest earlier value, over the work put in (over the initial energy if bodies move at the
    start)."""
    total, own, work = (np.array(curve[name]) for name in ("total", "own", "external"))
    unit = max(np.abs(work).max(), abs(total[0]), 1e-300)
    return float((own - own[0]).max() / unit), rise(total / unit)


def folded(case: str, made: ct.Scene, fraction: float, end: float) -> Row:
    """Run a scene of one body with every step recorded, and classify the run. Near the stable step the
    leapfrog may gain energy at large strain."""
    made.set_time(end=end, fraction=fraction).set_output(every=1, fields=[])
    (body,) = made._built(None).bodies.values()
    fold = Fold(body.name)
    mass = DENSITY * float(np.prod(np.ptp(body.mesh.nodes, axis=0)))
    row = classify(
        case,
        made,
        measure=fold,
        whole=fold.verdict,
        may_lose=MAY_LOSE,
        scale_name="work",
        momentum_scale=mass * C,
        expected="leapfrog" if fraction > 0.6 else "passes",
    )
    if row.verdict == "StepTooLarge" and "too stiff" in row.note:
        # The solid, not the contact, needs a smaller step: the library may reject this one.
        row.verdict = fold.wrong(row.curve) or "passes"
        row.verdict = caused(row)
    if row.curve:
        growth, late = growths(row.curve)
        row.remark(
            f"growth {100 * growth:.2g} % of the work, {100 * late:.2g} % above an earlier total, {fold.twice} nodes inside"
        )
    row.curve = {}

    def left() -> float:
        half = folded(case, made, 0.5 * fraction, end)
        return half.energy if half.good else math.inf

    if row.by_leapfrog and (told := is_told(row.warned, row.made, left)):
        row.verdict = f"{TOLD}{row.verdict}{told}"
    return row


def soft(
    title: str, bricks: shapes.Bricks, law: dict[str, Any], stuff: str = "neo_hookean"
) -> ct.Scene:
    """A soft body of a material in contact with itself, with these keys of the contact."""
    made = scene(title)
    material(made, young=YOUNG, density=DENSITY, law=stuff)
    made.add_body("body", nodes=bricks[0], elements=bricks[1], material="soft")
    return made.add_contact("body.outer", "body.outer", **law)


def between(
    bricks: shapes.Bricks,
    law: dict[str, Any],
    stuff: str,
    drive: Callable[[ct.Scene, str, float], Any],
) -> ct.Scene:
    """A strip whose sides at the smallest and the largest z are driven towards each other."""
    made = soft("folding", bricks, law, stuff)
    for side, sign in (("z_min", 1.0), ("z_max", -1.0)):
        drive(made, f"body.{side}", sign)
    return made


def led(
    bricks: shapes.Bricks,
    way: float,
    time: float,
    law: dict[str, Any] = ELASTIC,
    stuff: str = "neo_hookean",
) -> tuple[ct.Scene, float]:
    """Each side is moved by ``way``."""

    def drive(made: ct.Scene, side: str, sign: float) -> None:
        made.add_support(side, fix="z", travel=[0, 0, sign * way], history=smooth(time))

    return between(bricks, law, stuff, drive), 1.3 * time


def loaded(
    bricks: shapes.Bricks,
    traction: float,
    time: float,
    law: dict[str, Any] = ELASTIC,
    stuff: str = "neo_hookean",
) -> tuple[ct.Scene, float]:
    """Each side is loaded with ``traction`` E."""

    def drive(made: ct.Scene, side: str, sign: float) -> None:
        pull = [0, 0, sign * traction * YOUNG]
        made.add("load", surface=side, traction=pull, history=smooth(time))

    return between(bricks, law, stuff, drive), 1.5 * time


def strips() -> list[tuple[str, shapes.Bricks, Any, float, float]]:
    """Name, mesh, drive and its two numbers: a round bend, and one with corners, whose legs close from their
    ends to the root."""
    thin, middle, thick = (
        shapes.hairpin(0.6, t, gap, cells, 0.2)
        for t, gap, cells in (
            (0.05, 0.05, (24, 2, 1)),
            (0.1, 0.08, (18, 2, 2)),
            (0.2, 0.1, (16, 2, 3)),
        )
    )
    one, wide, two = (
        shapes.fork(8, 1, 1, 1, 1, 0.05),
        shapes.fork(8, 1, 2, 1, 1, 0.05),
        shapes.fork(8, 2, 2, 1, 2, 0.05),
    )
    return [
        ("corners 1", one, loaded, 0.3, 0.1),
        ("corners 2", two, loaded, 0.3, 0.1),
        ("wide gap", wide, loaded, 0.3, 0.1),
        ("corners 1 slow", one, loaded, 0.1, 0.2),
        ("corners 2 slow", two, loaded, 0.1, 0.2),
        ("wide gap slow", wide, loaded, 0.1, 0.2),
        ("corners 1 led", one, led, 0.03, 0.03),
        ("corners 2 led", two, led, 0.06, 0.06),
        ("wide gap led", wide, led, 0.055, 0.055),
        ("round 1", thin, loaded, 0.1, 0.1),
        ("round 2", middle, loaded, 0.1, 0.1),
        ("round 3", thick, loaded, 0.1, 0.1),
        ("round 1 led", thin, led, 0.04, 0.04),
        ("round 2 led", middle, led, 0.07, 0.07),
        ("round 3 led", thick, led, 0.11, 0.11),
    ]


def folding_strip(short: bool) -> Iterator[Row]:
    """A U of neo-Hookean hex8 whose legs are moved together until they are in contact over their length, and
    compressed."""
    chosen = strips()
    for name, bricks, drive, *values in (
        [chosen[0], chosen[5], chosen[6], chosen[13]] if short else chosen
    ):
        for fraction in (0.6,) if short else FRACTIONS:
            made, end = drive(bricks, *values)
            yield folded(f"folding strip, {name}", made, fraction, end)


def pressed(bricks: shapes.Bricks, way: float, time: float) -> tuple[ct.Scene, float]:
    """Two planes, above and below, move towards each other, each by ``way``."""
    made = soft("pressed", bricks, ELASTIC)
    low, high = bricks[0][:, 2].min(), bricks[0][:, 2].max()
    for height, sign in ((low, 1.0), (high, -1.0)):
        made.add(
            "obstacle",
            surface="body.outer",
            plane={"point": [0, 0, height], "normal": [0, 0, sign]},
            travel=[0, 0, sign * way],
            history=smooth(time),
            **ELASTIC,
        )
    return made, 1.3 * time


def rolled_strip(short: bool) -> Iterator[Row]:
    """A loosely wound strip of two and a half turns is pressed flat: its layers come into contact over their
    length, with sharp bends. At .9 of the step the leapfrog makes energy at the strain of the loose one, .3 % of the
    work, and the contact makes none; at .6 neither does (test_stability.py)."""
    rolls = [
        ("loose", shapes.spiral(0.25, 0.12, 2.5, 0.05, (64, 1, 1), 0.05), 0.4, 0.4),
        ("tight", shapes.spiral(0.25, 0.08, 2.5, 0.05, (80, 1, 1), 0.05), 0.25, 0.25),
        ("two through", shapes.spiral(0.3, 0.16, 1.5, 0.1, (60, 1, 2), 0.05), 0.35, 0.35),
    ]
    for name, bricks, way, time in rolls[:1] if short else rolls:
        for fraction in FRACTIONS[1:] if short else FRACTIONS:
            made, end = pressed(bricks, way, time)
            yield folded(f"rolled strip, {name}", made, fraction, end)


def crushed_ring(short: bool) -> Iterator[Row]:
    """A ring is crushed between two planes until its inner walls are in contact and compressed."""
    rings = [
        ("thin", 1, 40, 0.05, 0.1),
        ("two through", 2, 48, 0.08, 0.1),
        ("thick", 2, 32, 0.15, 0.1),
        ("fast", 1, 40, 0.05, 0.3),
    ]
    for name, through, around, thickness, speed in rings[:1] if short else rings:
        for fraction in (0.6,) if short else FRACTIONS:
            bricks = shapes.ring(0.4, thickness, (around, 1, through), 0.06)
            # The planes end at nine tenths of two thicknesses.
            way = 0.4 + 0.5 * thickness - 0.9 * thickness
            made, end = pressed(bricks, way, way / (speed * C))
            yield folded(f"crushed ring, {name}", made, fraction, end)


def coil(short: bool) -> Iterator[Row]:
    """
    A spiral strip turns about its axis while its outer end is fixed. In one direction it winds up until its
    turns are in contact, in the other it unwinds and rebounds. The reference is its initial energy.
    """
    coils = [("tightened", 1.0), ("let loose", -1.0)]
    for name, sign in coils[:1] if short else coils:
        for fraction in (0.9,) if short else FRACTIONS:
            made, end = wound(shapes.coil(0.2, 0.12, 2, 0.05, (72, 1, 1), 0.05), sign * 6.0)
            yield folded(f"coil, {name}", made, fraction, 0.4 if short else end)


def wound(bricks: shapes.Bricks, rate: float) -> tuple[ct.Scene, float]:
    """A coil with a straight outer end along x, which is fixed, and a spin about y."""
    made = scene("coil")
    material(made, young=YOUNG, density=DENSITY, law="neo_hookean")
    made.add_body(
        "body",
        nodes=bricks[0],
        elements=bricks[1],
        material="soft",
        spin={"axis": [0, 1, 0], "rate": rate, "centre": [0, 0, 0]},
    )
    made.add_contact("body.outer", "body.outer", **ELASTIC).add_support("body.x_max", fix="xyz")
    return made, 1.0


CASES = [folding_strip, rolled_strip, coil, crushed_ring]
