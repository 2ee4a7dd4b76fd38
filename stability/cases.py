"""
The cases of the stability laboratory. Each is a generator of rows; with ``short`` it takes seconds. A
comment at the case gives the expected failures and their reasons. An unexpected failure is a defect.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from typing import Any

import folding
import nested
import numpy as np
import pairs
import rest
from dissipation import bar as measured_bar
from lab import DEFAULT, Row, classify, enforced, material, scene
from libcontact.mesh import Mesh
from libcontact.model import INTEGRATORS
from shapes import random_rotation

import libcontact as ct

FLOOR = {"point": [0, 0, 0], "normal": [0, 0, 1]}


def lowest(body: str, axis: int = 2):
    """Depth of the lowest node of a body below the plane at 0."""
    return lambda run: float(-run.state[body].positions[:, axis].min())


def overlap(a: str, b: str, face_a: str, face_b: str):
    """Largest depth of nodes of either surface inside the other one, without the far sides of a body."""

    def depth(run: ct.Run) -> float:
        most = 0.0
        for (one, face), (two, other) in (((a, face_a), (b, face_b)), ((b, face_b), (a, face_a))):
            mesh = run.state[two].mesh
            faces, _ = mesh.faces(other)
            points = run.state[one].positions[run.state[one].mesh.face_nodes(face)]
            near = ct.nearest(
                "Q4" if mesh.element == "hex8" else "Q8", run.state[two].positions, faces, points
            )
            inside = np.asarray(near.signed_distance)
            # A point beyond the border of a surface is not inside: the line to its closest point is not normal.
            along = np.abs(((points - near.point) * near.normal).sum(1)) > 0.999 * near.distance
            most = max(
                [most, *(-inside[along & (inside < 0) & (inside > -0.9 * mesh.shortest_edge)])]
            )
        return float(most)

    return depth


# Bars.


def wall(
    enforcement: str,
    beta: float | None,
    fraction: float,
    n: int,
    integrator: str | None = None,
    **more: Any,
) -> Row:
    """A bar of n elements that hits a wall."""
    made = scene("bar on a wall")
    material(made, young=900, poisson=0)
    made.add_body(
        "bar",
        box={"origin": [0, 0, 5], "size": [10 / n, 10 / n, 10], "cells": [1, 1, n]},
        material="soft",
        velocity=[0, 0, -10],
    )
    made.add("obstacle", surface="bar.z_min", plane=FLOOR, **enforced(enforcement, beta))
    made.set_time(end=1.4, fraction=fraction, integrator=integrator).set_output(every=1, fields=[])
    name = "bar on a wall" if integrator is None else "bar on a wall, other integrators"
    return classify(name, made, enforcement=enforcement, beta=beta, depth=lowest("bar"), **more)


def bar_on_a_wall(short: bool) -> Iterator[Row]:
    """Doyen, Ern, Piperno 2011; the default passes, the explicit penalty fails where it is
    stiff."""
    n = 50 if short else 100
    for beta in (4.0,) if short else (1e-1, 1.0, 4.0, 100.0, 1e4):
        for fraction in (0.9,) if short else (0.1, 0.5, 0.9, 0.99):
            row = wall(DEFAULT, beta, fraction, n, bound=math.inf if beta < 1 else 0.5)
            if beta == 4.0 and fraction == 0.9 and not short:
                force, impulse, release, lost = measured_bar(DEFAULT, None, beta, 0.0)
                row.note = f"restitution 0: force {100 * force:.3f} % rms, impulse {100 * impulse:.2f} %, release {release:.1f} steps, energy lost {100 * lost:.2f} %"
                if row.good and not (
                    force < 1e-3 and impulse < 5e-3 and release <= 2 and lost <= 1 / (2 * n) + 1e-3
                ):
                    row.verdict = "less accurate than asked"
            yield row
    for beta in (1.0, 10.0):
        yield wall("penalty", beta, 0.9, n, expected="energy" if beta > 1 else "passes")


def bar_with_each_integrator(short: bool) -> Iterator[Row]:
    """The same bar with the dissipative integrators: then the explicit penalty does not chatter either."""
    n = 50 if short else 100
    for integrator in tuple(INTEGRATORS)[1:]:
        few = ((DEFAULT, None), ("penalty", 1.0))
        for enforcement, beta in (
            few if short else (*few, (DEFAULT, 1.0), (DEFAULT, 1e4), ("penalty", 10.0))
        ):
            for fraction in (0.9,) if short or enforcement != DEFAULT else (0.5, 0.9, 0.99):
                yield wall(
                    enforcement,
                    beta,
                    fraction,
                    n,
                    integrator,
                    bound=math.inf if enforcement == "penalty" else 0.5,
                )


def bouncing(
    n: int, impacts: int, enforcement: str, beta: float | None, fraction: float = 0.9
) -> tuple[Row, np.ndarray]:
    """A bar that bounces on a floor, and the delay of each impact in periods of 16 L / c."""
    length, c, g = 10.0, 30.0, 10.0
    made = scene("bouncing bar")
    material(made, young=900, poisson=0)
    h = length / n
    made.add_body(
        "bar",
        box={"origin": [0, 0, 5], "size": [h, h, length], "cells": [1, 1, n]},
        material="soft",
    )
    made.add("obstacle", surface="bar.z_min", plane=FLOOR, **enforced(enforcement, beta)).add(
        "gravity", acceleration=[0, 0, -g]
    )
    between, contact = 8 * length / c, 2 * length / c
    made.set_time(
        end=1 + impacts * between - 0.5 * (between - contact), fraction=fraction
    ).set_output(every=2, fields=[])
    weight = length * h * h
    push: list[float] = []
    times: list[float] = []

    def look(run: ct.Run) -> dict[str, float]:
        push.append(run.impulse["obstacle"][2])
        times.append(run.state.time)
        return {}

    row = classify(
        "bouncing bar, 30 impacts" if impacts == 30 else f"bouncing bar, {impacts} impacts",
        made,
        enforcement=enforcement,
        beta=beta,
        depth=lowest("bar"),
        measure=look,
        scale=weight * g * 5,
        scale_name="m g 5",
        bound=math.inf if beta is not None and beta < 1 else 1.5,
        may_lose=2e-3 * impacts,  # the dashpot, in contacts longer than that of twenty layers
        note=f"{n} elements",
    )
    time, pushed = np.array(times), np.diff(push, prepend=0.0) > 1e-6 * weight * g * (1 / c)
    starts = time[pushed & ~_before(pushed, time, contact)]
    exact = 1 + between * np.arange(impacts)
    late = np.array(
        [
            (starts[np.abs(starts - t).argmin()] - t) / (16 * length / c) if len(starts) else np.nan
            for t in exact
        ]
    )
    return row, late


def _before(pushed: np.ndarray, time: np.ndarray, contact: float) -> np.ndarray:
    """Whether there was a contact force within the duration of one contact before."""
    out = np.zeros(len(pushed), bool)
    last = -math.inf
    for i, (now, has_force) in enumerate(zip(time, pushed)):
        out[i] = now - last < contact
        last = now if has_force else last
    return out


def bouncing_bar(short: bool) -> Iterator[Row]:
    """
    Each impact leaves a vibration that changes the next one, so errors of phase grow. The energy that an
    impact takes from the nodes at the floor makes the next flight shorter.
    """
    impacts = 4 if short else 30
    usual = (DEFAULT, None, 0.99)
    for n in (40,) if short else (50, 100, 200, 400):
        for enforcement, beta, fraction in (
            [usual] if n < 400 else [usual, (DEFAULT, None, 0.9), ("penalty", 0.5, 0.9)]
        ):
            row, late = bouncing(n, impacts, enforcement, beta, fraction)
            shown = [i for i in (0, 1, 3, 9, 29) if i < impacts]
            row.note += "; late by " + ", ".join(f"{100 * late[i]:+.2f} % ({i + 1})" for i in shown)
            row.curve = {
                "impact": list(range(1, impacts + 1)),
                "late": [float(value) for value in late],
            }
            if row.good and n == 400 and not np.abs(late[:4]).max() < 5e-3:
                row.verdict = "later than asked"
            yield row


def two_bars(short: bool) -> Iterator[Row]:
    """Equal bars (contact lasts 2 L / c, pressure 0.1), and bars with ratios of the impedance 1:100 and of
    the stiffness 1:1e4."""
    for name, stiff in (("equal", 1.0), ("impedance 1:100", 1e4)):
        for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
            made = scene("two bars")
            for k, young in enumerate((1.0, stiff)):
                material(made, f"m{k}", young, 0.0)
                made.add_body(
                    "ab"[k],
                    material=f"m{k}",
                    velocity=[0.1 - 0.2 * k, 0, 0],
                    box={
                        "origin": [-10 + 10 * k, 0, 0],
                        "size": [10, 0.2, 0.2],
                        "cells": [50, 1, 1],
                    },
                )
            made.add_contact("a.x_max", "b.x_min", **enforced(enforcement, beta))
            made.set_time(end=24 if stiff == 1 else 3, fraction=0.9).set_output(every=4, fields=[])
            yield classify(
                f"two bars, {name}",
                made,
                enforcement=enforcement,
                beta=beta,
                depth=overlap("a", "b", "x_max", "x_min"),
            )


# Plates.


def plates(
    cells: int,
    enforcement: str,
    beta: float | None,
    fraction: float | None,
    courant: float | None = None,
    right: tuple[int, int] | None = None,
    integrator: str | None = None,
    **more: Any,
) -> Row:
    made = scene("plates")
    material(made, young=2.1e11, poisson=0.3, density=7800)
    size, h = 2.5e-3, 2.5e-3 / cells
    for k, name in enumerate(("left", "right")):
        nx, nz = (cells, cells) if k == 0 or right is None else right
        made.add_body(
            name,
            material="soft",
            velocity=[1 - 2 * k, 0, 0],
            box={"origin": [-size + size * k, 0, 0], "size": [size, h, size], "cells": [nx, 1, nz]},
        )
        made.add_support(f"{name}.z_min", fix="z").add_support(
            f"{name}.y_min", fix="y"
        ).add_support(f"{name}.y_max", fix="y")
    made.add_contact("left.x_max", "right.x_min", **enforced(enforcement, beta))
    made.set_time(
        end_c1t_over={"length": size, "value": 2.6 if cells < 80 else 0.56},
        integrator=integrator,
        **({"courant": courant} if courant else {"fraction": fraction}),
    )
    made.set_output(every=5, fields=[])
    name = "plates" if right is None else f"plates, {cells} to {right[1]} faces"
    if integrator:
        name = "plates, other integrators"
    return classify(
        name,
        made,
        enforcement=enforcement,
        beta=beta,
        depth=overlap("left", "right", "x_max", "x_min"),
        **more,
    )


def plate_impact(short: bool) -> Iterator[Row]:
    """Penalties over six decades, steps up to the largest that the library accepts."""
    cells = 12 if short else 24
    for beta in (4.0, 1e4) if short else (1e-2, 1e-1, 1.0, 4.0, 10.0, 1e2, 1e3, 1e4):
        for fraction in (0.9,) if short else (0.1, 0.3, 0.5, 0.7, 0.9, 0.99):
            # With a penalty below the stiffness of the elements the overlap is large by definition, and the
            # dashpot takes more.
            soft = {"bound": math.inf, "may_lose": 0.03} if beta < 1 else {}
            yield plates(cells, DEFAULT, beta, fraction, **soft)
    for beta, expected in ((1.0, "passes"), (100.0, "energy")):
        yield plates(cells, "penalty", beta, 0.9, expected=expected)


def plates_with_each_method(short: bool) -> Iterator[Row]:
    """The plates with each dissipative integrator, over the penalties of the default law."""
    cells = 12 if short else 24
    for integrator in tuple(INTEGRATORS)[1:]:
        for beta in (None,) if short else (None, 4.0, 1e2, 1e4):
            for fraction in (0.5, 0.9) if short else (0.3, 0.5, 0.7, 0.9, 0.99):
                yield plates(cells, DEFAULT, beta, fraction, integrator=integrator)


def contact_and_reference(short: bool) -> Iterator[Row]:
    """
    Plate impact compared with the same impact on a wall in place of the contact: the default at 0.94 of the
    limit (slightly less, for a whole number of steps), and the penalty at Courant number 0.125. The default
    must be within 0.3 %.
    """
    from pathlib import Path

    scenes = Path(__file__).resolve().parents[1] / "tutorials" / "scenes"

    def run(name: str, time: dict[str, Any], **contact: Any) -> tuple[ct.Scene, np.ndarray]:
        import tomllib

        data = tomllib.loads((scenes / name).read_text(encoding="utf-8"))
        data["time"] = {"end_c1t_over": data["time"]["end_c1t_over"], **time}
        if contact:
            data["contact"][0] = {"surfaces": data["contact"][0]["surfaces"], **contact}
        data["output"] = {"every": 1000}
        made = ct.Scene(data)
        return made, made.run(progress=False, output=False).line(
            "stress_xx", [0.0125, 0, 0.0125], [2.4875, 0, 0.0125], 100
        )[1]

    if short:
        return
    found = {}
    for enforcement, beta, time in (
        ("penalty", 4.0, {"courant": 0.125}),
        (DEFAULT, None, {"fraction": 0.94}),
    ):
        _, reference = run("plates_reference.toml", time)
        made, stress = run("plates.toml", time, **enforced(enforcement, beta))
        found[enforcement] = float(np.abs(stress - reference).mean() / np.abs(reference).max())
        row = classify("plates, contact and reference", made, enforcement=enforcement, beta=beta)
        row.note = f"mean difference of stress {100 * found[enforcement]:.2g} % of its largest"
        if (
            row.good
            and enforcement == DEFAULT
            and found[enforcement] > min(0.003, found["penalty"])
        ):
            row.verdict = "farther from the reference than 0.3 %"
        yield row


def unlike_meshes(short: bool) -> Iterator[Row]:
    for right in ((12, 18),) if short else ((12, 18), (12, 15), (12, 88), (5, 88)):
        yield plates(12, DEFAULT, None, 0.9, right=right)


# Corners, edges, rings.


def turned_cube(
    rotation: np.ndarray, cells: int = 3, gap: float = 0.02
) -> tuple[np.ndarray, np.ndarray]:
    mesh = Mesh.box("hex8", (-0.5, -0.5, -0.5), (1, 1, 1), (cells, cells, cells))
    nodes = np.asarray(mesh.nodes) @ rotation.T
    return nodes + [0, 0, gap - nodes[:, 2].min()], np.array(mesh.elements)


def from_to(direction: np.ndarray) -> np.ndarray:
    """A rotation that maps a direction to -z."""
    a = direction / np.linalg.norm(direction)
    b = np.array([0.0, 0.0, -1.0])
    v, c = np.cross(a, b), a @ b
    if c < -0.999999:
        return np.diag([1.0, -1.0, -1.0])
    K = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return np.eye(3) + K + K @ K / (1 + c)


def dropped_cube(short: bool) -> Iterator[Row]:
    """A soft cube dropped on its face, edge, corner, and in random orientations."""
    random = np.random.default_rng(5)
    ways = [
        ("face", from_to(np.array([0, 0, -1.0]))),
        ("edge", from_to(np.array([1.0, 0, -1]))),
        ("corner", from_to(np.array([1.0, 1, 1]))),
    ]
    ways += [(f"way {i + 1}", random_rotation(random)) for i in range(2 if short else 50)]
    for name, rotation in ways:
        nodes, elements = turned_cube(rotation)
        made = scene("cube")
        material(made, young=1e4, poisson=0.3, law="neo_hookean")
        made.add_body("cube", nodes=nodes, elements=elements, material="soft", velocity=[0, 0, -5])
        made.add("obstacle", surface="cube.outer", plane=FLOOR, **enforced(DEFAULT, None))
        made.set_time(end=0.08, fraction=0.7).set_output(every=2, fields=[])
        # Gauss points sit 0.21 h inside their face: a corner enters by up to that before any of them does.
        yield classify(
            f"cube dropped on its {name}"
            if not name.startswith("way")
            else f"cube dropped, {name}",
            made,
            depth=lowest("cube"),
        )


def ring(
    made: ct.Scene,
    name: str,
    centre: list[float],
    cells: list[int],
    velocity: list[float],
    spin: float = 0.0,
) -> None:
    made.add_body(
        name,
        ring={"centre": centre, "radius": [0.9, 1.0], "width": 0.2, "cells": cells},
        material="soft",
        velocity=velocity,
        **({"spin": {"axis": [0, 0, 1], "rate": spin}} if spin else {}),
    )


def spinning_ring(short: bool) -> Iterator[Row]:
    cells = [1, 32, 1] if short else [2, 64, 1]
    for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
        made = scene("ring")
        material(made, young=1e4, poisson=0.3, law="neo_hookean")
        ring(made, "ring", [1.1, 0, 0], cells, [-10, 0, 0], 10.0)
        made.add(
            "obstacle",
            surface="ring.outer",
            plane={"point": [0, 0, 0], "normal": [1, 0, 0]},
            **enforced(enforcement, beta),
        )
        made.set_time(end=0.1 if short else 0.3, fraction=0.7).set_output(every=4, fields=[])
        yield classify(
            "spinning ring against a wall",
            made,
            enforcement=enforcement,
            beta=beta,
            depth=lowest("ring", 0),
        )


def crossing_rings(short: bool) -> Iterator[Row]:
    """Two rings hit each other at a fifth of the wave speed."""
    cells = [1, 32, 1] if short else [2, 64, 1]
    for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
        made = scene("rings")
        material(made, young=1e4, poisson=0.3, law="neo_hookean")
        ring(made, "a", [-1.05, 0, 0], cells, [10, 0, 0])
        ring(made, "b", [1.05, 0.3, 0], cells, [-10, 0, 0])
        made.add_contact("a.outer", "b.outer", **enforced(enforcement, beta))
        made.set_time(end=0.08 if short else 0.2, fraction=0.6).set_output(every=4, fields=[])
        yield classify(
            "two rings that cross",
            made,
            enforcement=enforcement,
            beta=beta,
            depth=overlap("a", "b", "outer", "outer"),
        )


# Surfaces that slide, and thin ones.


def sliding_block(short: bool) -> Iterator[Row]:
    """A block slides over the borders of 20 faces under its weight; the force must not jump there."""
    borders = 5 if short else 20
    for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
        made = scene("sliding block")
        material(made, young=1e3, poisson=0.3)
        length = 0.1 * (borders + 8)
        made.add_body(
            "slab",
            material="soft",
            box={
                "origin": [0, -0.25, -0.2],
                "size": [length, 0.5, 0.2],
                "cells": [borders + 8, 5, 2],
            },
        )
        made.add_body(
            "block",
            material="soft",
            box={"origin": [0.13, -0.14, 0], "size": [0.3, 0.28, 0.2], "cells": [4, 4, 2]},
            velocity=[1, 0, 0],
        )
        made.add_support("slab.z_min", fix="xyz").add("gravity", acceleration=[0, 0, -10])
        made.add_contact("slab.z_max", "block.z_min", **enforced(enforcement, beta))
        made.set_time(end=0.1 * borders, fraction=0.8).set_output(every=5, fields=[])
        weight = 0.3 * 0.28 * 0.2 * 10

        def far(run: ct.Run, watch: Any) -> str:
            way = run.state["block"].displacement[:, 0].mean()
            return (
                ""
                if abs(way - 0.1 * borders) < 0.02 * borders * 0.1
                else f"slid {way:.3f} of {0.1 * borders:.1f}"
            )

        yield classify(
            f"block slides over {borders} borders",
            made,
            enforcement=enforcement,
            beta=beta,
            depth=overlap("slab", "block", "z_max", "z_min"),
            whole=far,
            scale=weight * 0.2,
            scale_name="m g 0.2",
        )


def thin_plates(short: bool) -> Iterator[Row]:
    """A plate of one element's thickness falls on another one: each must be in contact with the near side
    of the other."""
    for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
        made = scene("thin plates")
        material(made, young=1e5, poisson=0.3)
        for k, name in enumerate("ab"):
            made.add_body(
                name,
                material="soft",
                velocity=[0, 0, 3 - 6 * k],
                box={
                    "origin": [0.03 * k, 0.02 * k, 0.021 * k],
                    "size": [1, 1, 0.02],
                    "cells": [10, 10, 1],
                },
            )
        made.add_contact("a.outer", "b.outer", **enforced(enforcement, beta))
        made.set_time(end=0.006 if short else 0.02, fraction=0.8).set_output(every=5, fields=[])

        def apart(run: ct.Run, watch: Any) -> str:
            a, b = (run.state[name].positions[:, 2].mean() for name in "ab")
            return (
                ""
                if b - a > 0.015
                else f"the plates are {b - a:.3g} apart: one has passed through the other"
            )

        yield classify(
            "thin plate on thin plate",
            made,
            enforcement=enforcement,
            beta=beta,
            depth=overlap("a", "b", "z_max", "z_min"),
            whole=apart,
        )


# Meshes, materials, sizes.


def two_blocks(
    nodes: list[np.ndarray],
    elements: list[np.ndarray],
    enforcement: str,
    beta: float | None,
    length: float = 1.0,
) -> ct.Scene:
    """Two blocks that meet. Speeds are proportional to ``length`` and stiffness to its square, so that all
    times are the same."""
    made = scene("blocks")
    material(made, young=1e4 * length**2)
    for k in range(2):
        made.add_body(
            "ab"[k],
            nodes=nodes[k] * length,
            elements=elements[k],
            material="soft",
            velocity=[3 * length - 6 * length * k, 0, 0],
        )
    made.add_contact("a.x_max", "b.x_min", **enforced(enforcement, beta))
    made.set_time(end=0.06, fraction=0.9).set_output(every=5, fields=[])
    return made


def block_pair(cells: int = 4, stretch: float = 1.0) -> tuple[list[np.ndarray], list[np.ndarray]]:
    meshes = [
        Mesh.box("hex8", (-1.0005 + 1.001 * k, 0, 0), (1, 1, stretch), (cells, cells, cells))
        for k in range(2)
    ]
    return [np.array(mesh.nodes) for mesh in meshes], [np.array(mesh.elements) for mesh in meshes]


def distorted_mesh(short: bool) -> Iterator[Row]:
    """Inner nodes moved at random: by 0.2 h the scene runs; by 0.45 h some elements are inverted, and the
    error names one."""
    random = np.random.default_rng(3)
    for amount, wanted in ((0.2, "passes"), (0.45, "GeometryError")):
        nodes, elements = block_pair(6)
        for x in nodes:
            inner = ((x > x.min(0) + 1e-9) & (x < x.max(0) - 1e-9)).all(1)
            x[inner] += random.uniform(-amount / 6, amount / 6, (inner.sum(), 3))
        try:
            row = classify(
                f"mesh distorted by {amount} h",
                two_blocks(nodes, elements, DEFAULT, None),
                depth=overlap("a", "b", "x_max", "x_min"),
            )
        except (ct.Error, ct.SceneError) as error:
            refused = wanted != "passes" and "element" in str(error)
            row = Row(
                f"mesh distorted by {amount} h",
                DEFAULT,
                None,
                math.nan,
                math.nan,
                0,
                verdict="passes" if refused else type(error).__name__,
                note="refused: " + str(error),
            )
        else:
            if wanted != "passes":
                row.verdict = "an inverted element was not refused"
        yield row


def aspect_ratio(short: bool) -> Iterator[Row]:
    nodes, elements = block_pair(3, 1e3)
    yield classify(
        "aspect ratio 1000",
        two_blocks(nodes, elements, DEFAULT, None),
        depth=overlap("a", "b", "x_max", "x_min"),
    )


def sizes(short: bool) -> Iterator[Row]:
    """The same impact from a nanometre to a thousand kilometres, with the same result."""
    nodes, elements = block_pair()
    first = None
    for length in (1.0, 1e-9, 1e6) if short else (1.0, 1e-9, 1e-6, 1e-3, 1e3, 1e6):
        row = classify(
            f"length {length:g} m",
            two_blocks(nodes, elements, DEFAULT, None, length),
            depth=overlap("a", "b", "x_max", "x_min"),
            measure=lambda run, length=length: {
                "v": float(run.state["b"].velocity[:, 0].mean() / length)
            },
        )
        velocity = row.curve["v"][-1] if row.curve else math.nan
        first = velocity if first is None else first
        row.note = f"rebound differs by {abs(velocity / first - 1):.1e}"
        if row.good and not abs(velocity / first - 1) < 1e-8:
            row.verdict = "another answer than at 1 m"
        yield row


def last_bit(short: bool) -> Iterator[Row]:
    """The last bit of each coordinate is changed at random: the result of a short impact must not change."""
    random = np.random.default_rng(8)
    nodes, elements = block_pair()
    answers = []
    for k in range(2 if short else 5):
        changed = [
            x
            if k == 0
            else np.nextafter(x, np.where(random.random(x.shape) < 0.5, -np.inf, np.inf))
            for x in nodes
        ]
        row = classify(
            "last bit of the input changed" if k else "last bit as given",
            two_blocks(changed, elements, DEFAULT, None),
            depth=overlap("a", "b", "x_max", "x_min"),
            measure=lambda run: {"v": float(np.abs(run.state["b"].velocity).mean())},
        )
        answers.append(row.curve["v"][-1] if row.curve else math.nan)
        row.note = f"answer differs by {abs(answers[-1] / answers[0] - 1):.1e}"
        if row.good and not abs(answers[-1] / answers[0] - 1) < 1e-9:
            row.verdict = "another answer"
        yield row


def rounding_modes(short: bool) -> Iterator[Row]:
    """All four rounding modes of the processor."""
    libm = ctypes.CDLL(None)
    nodes, elements = block_pair()
    for name, mode in (("to nearest", 0x000), ("down", 0x400), ("up", 0x800), ("to zero", 0xC00)):
        made = two_blocks(nodes, elements, DEFAULT, None)
        steps = made.explain().data["time"]["steps"]
        old = libm.fegetround()
        if libm.fesetround(mode) != 0:
            return
        try:
            row = classify(
                f"rounding {name}", made, momentum=1e-12 if mode == 0 else 4 * steps * 2.0**-53
            )
        finally:
            libm.fesetround(old)
        yield row


# Long runs.


def vibration(short: bool) -> Iterator[Row]:
    """One body that vibrates for a million steps."""
    steps = 10**4 if short else 10**6
    made = scene("vibration")
    material(made)
    mesh = Mesh.box("hex8", (0, 0, 0), (1, 1, 1), (1, 1, 1))
    made.add_body(
        "block", nodes=np.array(mesh.nodes), elements=np.array(mesh.elements), material="soft"
    )
    made.add("load", surface="block.x_max", traction=[10.0, 3.0, 1.0]).add_support(
        "block.x_min", fix="xyz"
    )
    dt = 0.9 * made.set_time(end=1.0, fraction=0.9).explain().data["time"]["stable"]
    made.set_time(end=steps * dt, dt=dt).set_output(every=steps // 100, fields=[])
    yield classify(f"{steps} steps of one vibrating body", made, enforcement="none", beta=None)


def resting(short: bool) -> Iterator[Row]:
    """A block that lies on a floor for a hundred thousand steps."""
    steps = 5000 if short else 10**5
    for enforcement, beta in ((DEFAULT, None), ("penalty", 1.0)):
        made = scene("rest")
        material(made)
        made.add_body(
            "block",
            box={"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [2, 2, 2]},
            material="soft",
        )
        made.add("gravity", acceleration=[0, 0, -10]).add(
            "obstacle", surface="block.z_min", plane=FLOOR, **enforced(enforcement, beta)
        )
        made.set_time(end=1.0, fraction=0.9)
        dt = made.explain().data["time"]["dt"]
        made.set_time(end=steps * dt, dt=dt).set_output(every=steps // 100, fields=[])
        yield classify(
            f"{steps} steps of resting contact",
            made,
            enforcement=enforcement,
            beta=beta,
            depth=lowest("block"),
            scale=10 * 0.005,
            scale_name="m g u",
            may_lose=None,  # the dashpot takes the vibration while contact lasts
            whole=lambda run, watch: (
                ""
                if abs(run.state["block"].displacement[:, 2].max()) < 0.02
                else "the block has left"
            ),
        )


CASES = [
    bar_on_a_wall,
    bar_with_each_integrator,
    bouncing_bar,
    two_bars,
    plate_impact,
    plates_with_each_method,
    contact_and_reference,
    unlike_meshes,
    dropped_cube,
    spinning_ring,
    crossing_rings,
    sliding_block,
    thin_plates,
    distorted_mesh,
    aspect_ratio,
    sizes,
    last_bit,
    rounding_modes,
    vibration,
    resting,
    *rest.CASES,
    *folding.CASES,
    *pairs.CASES,
    *nested.CASES,
]
