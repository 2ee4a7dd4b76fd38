"""Two nested quarter shells with different meshes, whose facets overlap or leave gaps."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import shapes
from lab import ELASTIC, Row, classify, material, scene

import libcontact as ct

YOUNG, RADIUS, THICK, WIDTH = 1e4, 1.0, 0.2, 0.2
PRESSURE = 1e-3 * YOUNG
# Starting energy over E V; the mean pressure of the contact against that of matching meshes.
NO_ENERGY, PRESSURES = 1e-24, 0.01


def shell(inner: float, around: int, element: str) -> shapes.Bricks:
    """A quarter of a ring about y between two radii, its nodes on circles."""

    def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # From z to x, so that the strip's normal points outwards.
        out = np.stack([np.sin(0.5 * np.pi * s), np.cos(0.5 * np.pi * s)], -1)
        return (inner + 0.5 * THICK) * out, out

    def onto(middle: np.ndarray) -> np.ndarray:
        flat = np.hypot(middle[:, 0], middle[:, 2])
        true = inner + THICK * np.round(2 * (flat - inner) / THICK) / 2
        return middle * np.stack([true / flat, np.ones(len(flat)), true / flat], -1)

    bricks = shapes.bent((around, 1, 1), WIDTH, THICK, curve)
    return bricks if element == "hex8" else shapes.with_edges(bricks, onto)


def pressed_from_inside(bricks: shapes.Bricks) -> tuple[np.ndarray, np.ndarray]:
    """The nodes on the inner side and the forces of a uniform pressure on them, radial and distributed with
    the faces' shape functions."""
    nodes, elements = bricks
    inner = np.flatnonzero(np.abs(np.hypot(nodes[:, 0], nodes[:, 2]) - RADIUS) < 1e-9)
    share = np.zeros(len(nodes))
    for cell in elements:
        face = cell[np.isin(cell, inner)]
        corners, middles = face[np.isin(face, cell[:8])], face[~np.isin(face, cell[:8])]
        share[corners] += 1 / 4 if not len(middles) else -1 / 12
        share[middles] += 1 / 3
    area = 0.5 * np.pi * RADIUS * WIDTH / len(elements)
    radial = nodes[inner] * [1, 0, 1] / RADIUS
    return inner, PRESSURE * area * share[inner, None] * radial


def shells(inner: int, outer: int, element: str, adjust: float) -> ct.Scene:
    """Two shells with these numbers of elements, on planes of symmetry."""
    made = scene("shells")
    material(made, young=YOUNG)
    meshes = shell(RADIUS, inner, element), shell(RADIUS + THICK, outer, element)
    for name, bricks in zip(("inner", "outer"), meshes):
        made.add_body(name, nodes=bricks[0], elements=bricks[1], element=element, material="soft")
        made.add_support(f"{name}.x_min", fix="x").add_support(
            f"{name}.z_min", fix="z"
        ).add_support(f"{name}.y_min", fix="y").add_support(f"{name}.y_max", fix="y")
    return made.add_contact(
        "inner.outer", "outer.outer", **ELASTIC, **({"adjust": adjust} if adjust else {})
    )


def mean_pressure(run: ct.Run) -> float:
    """Sum of the forces on both shells over twice the area between them."""
    points = run.contact[0]
    # The ends and sides of the shells touch nothing.
    middle = (
        np.abs(np.hypot(points["position"][:, 0], points["position"][:, 2]) - RADIUS - THICK)
        < 0.3 * THICK
    )
    return float(
        (points["raw_pressure"] * points["weight"])[middle].sum()
        / (np.pi * (RADIUS + THICK) * WIDTH)
    )


def at_rest_under_pressure(inner: int, outer: int, element: str, adjust: float) -> ct.Scene:
    """A scene that comes to rest under a slowly increasing pressure."""
    made = shells(inner, outer, element, adjust)
    nodes, force = pressed_from_inside(shell(RADIUS, inner, element))
    # Four times as long as a wave of speed 100 takes for the length 1.
    rise = 0.04
    made.add_effect("pressure", "inner", nodes, lambda view: force * min(view.time / rise, 1.0))
    return (
        made.add("damping", relaxation=True)
        .set_time(end=3.0, fraction=0.9, until_static=1e-5)
        .set_output(every=20, fields=[])
    )


def nested_shells(short: bool) -> Iterator[Row]:
    """Shells with 4:5, 8:11 and 3:4 (hex20) elements per quarter. With ``adjust`` they start without energy
    and have the mean pressure of matching meshes."""
    for inner, outer, element in (
        ((4, 5, "hex8"),)
        if short
        else ((4, 5, "hex8"), (8, 11, "hex8"), (3, 4, "hex20"), (5, 4, "hex8"), (4, 3, "hex20"))
    ):
        coarse = min(inner, outer)
        # A little more than the sag of a facet of the coarser mesh.
        adjust = 1.2 * (RADIUS + THICK) * (1 - math.cos(math.pi / (4 * coarse)))
        matching: dict[str, float] = {}
        for a, b, distance in ((coarse, coarse, 0.0), (inner, outer, adjust)):
            yield shell_row(
                f"nested shells, {a}:{b} {element}",
                at_rest_under_pressure(a, b, element, distance),
                matching,
            )


def shell_row(case: str, made: ct.Scene, matching: dict[str, float]) -> Row:
    """Run shells to rest; the first run is the reference for the next ones."""
    volume = 0.25 * np.pi * ((RADIUS + 2 * THICK) ** 2 - RADIUS**2) * WIDTH
    first: list[float] = []

    def measure(run: ct.Run) -> dict[str, float]:
        row = run.energy[-1]
        first.append(max(abs(row["strain"]), abs(row["contact"]), abs(row["kinetic"])))
        return {"pressure": mean_pressure(run)}

    def whole(run: ct.Run, watch) -> str:
        pressure = watch.curve["pressure"][-1]
        wanted = matching.setdefault("pressure", pressure)
        if first[0] > NO_ENERGY * YOUNG * volume:
            return f"starts with {first[0] / (YOUNG * volume):.1e} E V"
        return (
            ""
            if abs(pressure / wanted - 1) < PRESSURES
            else f"mean pressure {pressure / wanted:.4f} of that of matching meshes"
        )

    row = classify(
        case,
        made,
        measure=measure,
        whole=whole,
        scale=YOUNG * volume,
        scale_name="E V",
        momentum=np.inf,
    )
    if row.curve:
        row.remark(
            f"starts with {first[0] / (YOUNG * volume):.0e} E V, mean pressure {row.curve['pressure'][-1] / PRESSURE:.5f} of that inside"
        )
    row.curve = {}
    return row


CASES = [nested_shells]
