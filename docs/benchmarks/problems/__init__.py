"""
The benchmarks of the book: each function of CASES computes the numbers of one page from the scene beside it and returns
them with their references. ``docs/measure.py`` writes them to ``docs/measured.json``;
``tests/python/test_benchmarks.py`` compares them.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2]
# Programs that some cases share with the rest of the book: a rigid sphere on a block, an elastic ball on a plane,
# theory of balls that strike each other, Euler's equations.
for folder in ("figures", "benchmarks", "../accuracy", "../bench"):
    sys.path.append(str((DOCS / folder).resolve()))

from . import balls, bending, blocks, rings, rods  # noqa: E402
from .runs import Numbers  # noqa: E402

CASES: dict[str, Callable[[], Numbers]] = {
    case.__name__: case
    for case in (
        rods.rod_at_wall,
        rods.bouncing_bar,
        balls.hertz_pressed,
        balls.hertz_impact,
        balls.hertz_small,
        balls.oblique_impact,
        balls.oblique_small,
        balls.balls_theory,
        blocks.tumbling_box,
        blocks.sliding_block,
        bending.bent_plate,
        blocks.settlement,
        blocks.unlike_pulse,
        bending.crushed_ring,
        rings.nested_shells,
        blocks.discs,
        rings.rings_in_impact,
    )
}
CASES |= {name: lambda n=name, e=exact: rods.rods_of(n, e) for name, exact in rods.RODS.items()}
# Computed by ``make measured`` alone.
SLOW = {"hertz_small", "oblique_small", "rings_in_impact"}
