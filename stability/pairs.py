"""Random pairs of bodies that hit each other, classified by energy and by the largest possible
change of a gap in one step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import inside
import numpy as np
import shapes
from lab import ELASTIC, Row, classify, material, scene

import libcontact as ct

KINDS = ("box", "moved", "ball", "wedge")
# Spurious energy, as a fraction of the energy at the start.
GROWTH = 0.002
# Smallest reported depth at which the sign is checked, over the shortest edge: the triangles that replace
# curved faces deviate by less.
FALSE = 0.1
# The largest sum of |N| on a face: a point of it moves by at most this multiple of the motion of its
# nodes. Four nodes: 1. Eight nodes: 3 in the middle (-1/4 per corner, 1/2 per side).
REACH = {"hex8": 1.0, "hex20": 3.0}


@dataclass
class Gaps:
    """
    The distance of a point from a closed surface changes in a step by at most the motion of the point and of
    the surface, |x_new - x_old| + max sum|N| max |u_new - u_old| over the nodes of the other surface. This
    bounds the change of a penetration, and that of the gap from which its force follows. A point without a
    partner is outside. Larger changes of gaps that stay open are counted but allowed: such a gap belongs to
    the nearest face that may come into contact.
    """

    bodies: tuple[str, str] = ("a", "b")
    before: tuple[np.ndarray, dict[str, np.ndarray]] | None = None
    jumps: int = 0
    flips: int = 0
    open: int = 0
    farthest: float = 0.0
    inside: int = 0
    false: int = 0
    records: int = 0

    def __call__(self, run: ct.Run) -> dict[str, float]:
        points, nodes = (
            run.contact[0].copy(),
            {name: run.state[name].positions for name in self.bodies},
        )
        points["gap"] += points["start_gap"]  # the true distance
        if self.before is not None:
            self.compare(run, points, nodes)
        self.before = points, {name: x.copy() for name, x in nodes.items()}
        if self.records % 16 == 0:
            self.look(run)
            self.check_signs(run, points)
        self.records += 1
        return {}

    def compare(self, run: ct.Run, points: np.ndarray, nodes: dict[str, np.ndarray]) -> None:
        old, old_nodes = self.before
        reach = np.array(
            [
                REACH[run.state[name].mesh.element]
                * np.linalg.norm(nodes[name] - old_nodes[name], axis=1).max()
                for name in self.bodies
            ]
        )
        bound = (
            np.linalg.norm(points["position"] - old["position"], axis=1)
            + reach[1 - points["side"]]
            + 1e-9 * np.ptp(nodes["a"], axis=0).max()
        )
        for start in (0.0, 1.0):  # the distance, and the gap from which the force follows
            new_gap, old_gap = (
                found["gap"] - start * found["start_gap"] for found in (points, old)
            )
            # A point without a partner counts as at least on the surface.
            now, then = (
                np.where(np.isnan(gap) & (other < 0), 0.0, gap)
                for gap, other in ((new_gap, old_gap), (old_gap, new_gap))
            )
            with np.errstate(invalid="ignore"):
                change = np.abs(now - then)
                beyond, closed = change > bound, np.minimum(now, then) < 0
            self.open += int((beyond & ~closed).sum())
            self.jumps += int((beyond & closed).sum())
            self.flips += int((beyond & (now * then < 0)).sum())
            self.farthest = max([self.farthest, *(change / bound)[beyond & closed]])

    def look(self, run: ct.Run) -> None:
        """Count centres of elements of one body that are inside the other one."""
        for one, two in (self.bodies, self.bodies[::-1]):
            a, b = run.state[one], run.state[two]
            centres = a.positions[a.elements[:, :8]].mean(1)
            self.inside = max(
                self.inside, int(inside.within(centres, b.positions, b.elements).sum())
            )

    def check_signs(self, run: ct.Run, points: np.ndarray) -> None:
        """Count points that are reported inside by more than ``FALSE`` edges, and are outside."""
        for side, name in enumerate(self.bodies):
            other = run.state[self.bodies[1 - side]]
            told = (points["side"] == side) & (points["gap"] < -FALSE * other.mesh.shortest_edge)
            if told.any():
                self.false = max(
                    self.false,
                    int(
                        (
                            ~inside.within(
                                points["position"][told], other.positions, other.elements
                            )
                        ).sum()
                    ),
                )

    def verdict(self, run: ct.Run, watch: Any) -> str:
        self.look(run)
        return self.wrong()

    def wrong(self) -> str:
        return "; ".join(
            [
                f"{self.jumps} gaps jump, by up to {self.farthest:.3g} times what can be, {self.flips} with a change of sign"
            ]
            * (self.jumps > 0)
            + [f"{self.false} points outside are reported inside"] * (self.false > 0)
            + [f"{self.inside} elements are inside the other body"] * (self.inside > 0)
        )


def pair(seed: int) -> tuple[str, ct.Scene]:
    """Two bodies close to each other that approach and rotate."""
    random = np.random.default_rng([12, seed])
    made = scene("pair")
    ratio = 10 ** random.uniform(0, 4)
    kinds, elements = random.choice(KINDS, 2), random.choice(["hex8", "hex20"], 2)
    bricks = [shapes.any_body(kind, element, random) for kind, element in zip(kinds, elements)]
    way = random.normal(size=3)
    way /= np.linalg.norm(way)
    apart = (bricks[0][0] @ way).max() - (bricks[1][0] @ way).min() + 0.02
    bricks[1] = bricks[1][0] + apart * way, bricks[1][1]
    # The waves of the soft body travel at about 1.16.
    speed, across = random.uniform(0.02, 0.2) * 1.16, 0.3 * random.normal(size=3)
    velocity = speed * (way + across - (across @ way) * way) / np.sqrt(1 + across @ across)
    for k, name in enumerate("ab"):
        material(
            made,
            f"m{k}",
            1.0 if k else ratio,
            0.3,
            1.0 if k else max(1.0, np.sqrt(ratio / 10)),
            "neo_hookean",
        )
        axis = random.normal(size=3)
        made.add_body(
            name,
            nodes=bricks[k][0],
            elements=bricks[k][1],
            element=str(elements[k]),
            material=f"m{k}",
            velocity=list((0.5 - k) * velocity),
            spin={
                "axis": list(axis),
                "rate": random.uniform(0, 0.2),
                "centre": list(bricks[k][0].mean(0)),
            },
        )
    made.add_contact("a.outer", "b.outer", **ELASTIC).set_time(
        end=2.0 + 0.05 / speed, fraction=random.choice([0.3, 0.6, 0.9])
    )
    return (
        f"{kinds[0]} {elements[0]}, {kinds[1]} {elements[1]}, stiffness {ratio:.3g}, speed {speed / 1.16:.2g} c1",
        made.set_output(every=1, fields=[]),
    )


def body_pairs(short: bool) -> Iterator[Row]:
    """200 pairs of boxes, distorted boxes, balls and wedges of hex8 and hex20 in random orientations, with
    ratios of stiffness from 1 to 10000 and speeds up to a fifth of the wave speed."""
    for seed in (0, 1, 2, 4, 79, 125, 134, 162) if short else range(200):
        name, made = pair(seed)
        gaps = Gaps()
        row = classify(
            f"pair of bodies, {seed}", made, measure=gaps, whole=gaps.verdict, bound=np.inf
        )
        if row.verdict == "StepTooLarge" and "too stiff" in row.note:
            row.verdict = gaps.wrong() or "passes"
        if row.good and row.energy > GROWTH:
            row.verdict = f"energy grows by {100 * row.energy:.3g} %"
        row.note, row.curve = (
            name
            + f"; {gaps.jumps} jumps, {gaps.flips} flips, {gaps.open} of open gaps, {gaps.false} false"
            + (f"; {row.note}" if row.note else ""),
            {},
        )
        yield row


CASES = [body_pairs]
