"""Bodies that must stay at rest: concave shapes in contact with themselves, and touching blocks in
any orientation."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np
import shapes
from lab import DEFAULT, ELASTIC, Row, Watch, classify, material, scene, set_steps, shortest_edge

import libcontact as ct

# Density 1.
YOUNG, C = 1e4, 1e2
# Values that count as zero: energy over E V, and displacement over the shortest edge.
NO_ENERGY, NO_MOTION = 1e-24, 1e-10


def still(run: ct.Run) -> dict[str, float]:
    """Values that must be zero in a body at rest: its energies, and the displacement of its nodes."""
    row = run.energy[-1]
    moved = max(float(np.abs(body.displacement).max()) for body in run.state.values())
    return {
        "energy": float(
            max(abs(row["kinetic"]), abs(row["strain"]), abs(row["contact"]), abs(row["total"]))
        ),
        "moved": moved,
    }


def at_rest(made: ct.Scene, case: str, volume: float, steps: int, **more: str) -> Row:
    """Run a scene for some steps in which all bodies must stay at rest."""
    h = shortest_edge(set_steps(made, steps, 0.9, 50))

    def nothing(run: ct.Run, watch) -> str:
        if found := sum(contact["points"]["inside"] for contact in run.penetration):
            return f"{found} points are reported inside"
        energy, moved = max(watch.curve["energy"]) / (YOUNG * volume), max(watch.curve["moved"]) / h
        return (
            ""
            if energy <= NO_ENERGY and moved <= NO_MOTION
            else f"energy {energy:.1e} E V at rest, nodes move by {moved:.1e} h"
        )

    row = classify(
        case,
        made,
        measure=still,
        whole=nothing,
        scale=YOUNG * volume,
        scale_name="E V",
        momentum_scale=volume * C,
        **more,
    )
    if row.curve:
        row.remark(
            f"energy {max(row.curve['energy']) / (YOUNG * volume):.0e} E V, moved {max(row.curve['moved']) / h:.0e} h"
        )
    row.curve = {}
    return row


def concave(bricks: shapes.Bricks, points: str) -> ct.Scene:
    """One body in contact with itself."""
    made = scene("at rest")
    material(made, young=YOUNG)
    made.add_body(
        "body",
        nodes=bricks[0],
        elements=bricks[1],
        element="hex8" if bricks[1].shape[1] == 8 else "hex20",
        material="soft",
    )
    # "force", so that a false overlap shows in the energy.
    return made.add_contact(
        "body.outer", "body.outer", points=points, initial_penetration="force", **ELASTIC
    )


def concave_meshes(
    name: str, parts: int, element: str, amount: float, count: int
) -> list[shapes.Bricks]:
    """One regular mesh of a shape, or ``count`` meshes with nodes moved by ``amount`` of an edge, in random
    orientations."""
    out = []
    for seed in range(count if amount else 1):
        random = np.random.default_rng([seed, parts, int(10 * amount), *name.encode()])
        bricks = shapes.cubes(shapes.CONCAVE[name], parts)
        if amount:
            bricks = shapes.turned(
                shapes.moved(bricks, amount / parts, random), shapes.random_rotation(random)
            )
        out.append(bricks if element == "hex8" else shapes.with_edges(bricks))
    return out


def accepted(made: ct.Scene) -> bool:
    """Whether the library accepts the mesh of a scene."""
    try:
        made.set_time(end=1.0, fraction=0.9)._built(None)
    except ct.SceneError as error:
        if "element" not in str(error):
            raise
        return False
    return True


def concave_at_rest(short: bool) -> Iterator[Row]:
    """
    Eight concave shapes of cubes, undeformed. For each mesh and rule no point is inside the body, so there is
    no energy and nothing moves. Meshes that the library rejects, because moved nodes invert elements, are
    counted.
    """
    for name in shapes.CONCAVE:
        sizes = [("hex8", 1, 3), ("hex8", 2, 1), ("hex8", 3, 1), ("hex20", 1, 1)]
        for element, parts, count in (
            ([sizes[0], sizes[3]] if name in ("L", "corner") else sizes[:1]) if short else sizes
        ):
            for amount in (0.0, 0.1, 0.2, 0.3):
                for points in ("gauss", "lobatto"):
                    yield from concave_rows(
                        name,
                        element,
                        parts,
                        amount,
                        points,
                        20 if short else 1000 if parts == 1 else 200,
                        1 if short else count,
                    )


def concave_rows(
    name: str, element: str, parts: int, amount: float, points: str, steps: int, count: int
) -> Iterator[Row]:
    """A row for each accepted mesh of a shape; the last one has the number of rejected meshes."""
    scenes = [
        concave(bricks, points) for bricks in concave_meshes(name, parts, element, amount, count)
    ]
    taken = [made for made in scenes if accepted(made)]
    refused = len(scenes) - len(taken)
    case = f"concave, {name} {element}/{parts} {amount:g} h {points}"
    for made in taken:
        yield at_rest(
            made,
            case,
            len(shapes.CONCAVE[name]),
            steps,
            note=f"{refused} of {len(scenes)} meshes refused" if refused else "",
        )
    if not taken:
        yield Row(
            case,
            DEFAULT,
            4.0,
            math.nan,
            math.nan,
            0,
            verdict="passes",
            note=f"all {refused} meshes refused",
            scale="E V",
        )


def later(end: float) -> dict[str, list[float]]:
    """A history that is zero for the first half of a run."""
    return {"time": [0.0, 0.5 * end, end], "value": [0.0, 0.0, 1.0]}


def turned_box(
    random: np.random.Generator, scale: float, rotation: np.ndarray, place: np.ndarray
) -> tuple[shapes.Bricks, np.ndarray]:
    """A box of random size on the plane through ``place`` normal to the third column of ``rotation``, and
    its size."""
    size = random.uniform(0.5, 1.5, 3) * scale
    nodes, elements = shapes.box(size, random.integers(1, 4, 3))
    return ((nodes + [0, 0, 0.5 * size[2]]) @ rotation.T + place, elements), size


def rest_scene(seed: int) -> tuple[str, ct.Scene, float]:
    """
    Two blocks with coincident faces and a load that begins later, or a block on an inclined plane under
    gravity, with random orientation, size and stiffness; and an energy of the problem.
    """
    random = np.random.default_rng([7, seed])
    made, rotation, scale, young = (
        scene("at rest"),
        shapes.random_rotation(random),
        10 ** random.uniform(-3, 3),
        10 ** random.uniform(3, 11),
    )
    place = random.uniform(-3, 3, 3) * scale
    material(made, young=young, density=1000.0)
    bricks, size = turned_box(random, scale, rotation, place)
    element = "hex8" if random.random() < 0.7 else "hex20"
    bodies = {"b": bricks}
    if seed % 2:
        below, depth = turned_box(random, scale, rotation, place)
        bodies["a"] = below[0] - depth[2] * rotation[:, 2], below[1]
    for name, body in bodies.items():
        nodes, elements = body if element == "hex8" else shapes.with_edges(body)
        made.add_body(name, nodes=nodes, elements=elements, element=element, material="soft")
    end, energy = 4 * scale / np.sqrt(young / 1000), young * float(np.prod(size))
    if seed % 2:
        made.add_contact("a.outer", "b.outer", **ELASTIC)
    else:
        made.add(
            "obstacle",
            surface="b.outer",
            plane={"point": list(place), "normal": list(rotation[:, 2])},
            **ELASTIC,
            **({"friction": 0.5} if random.random() < 0.5 else {}),
        )
    if seed % 4 == 2:
        gravity = 10 ** random.uniform(-12, -3) * young / (1000 * scale)
        made.add("gravity", acceleration=[0, 0, -gravity * np.sign(rotation[2, 2])])
    else:
        made.add(
            "load",
            surface="b.outer",
            traction=list(-1e-3 * young * rotation[:, 2]),
            history=later(end),
        )
    return (
        f"{'blocks on each other' if seed % 2 else 'block on an inclined plane'}, {element}",
        made.set_time(end=end, fraction=0.9),
        energy,
    )


def gains(scale: float, run: ct.Run, _: Watch) -> str:
    """What is wrong if the total rises, beside the work of a load, which is small beside ``scale``."""
    total, work = run.energy["total"], np.abs(run.energy["external"]).max()
    rises = float(total.max() - total[0])
    return f"gains {rises:.1e}" if rises > max(1e-12 * work, NO_ENERGY * scale) else ""


def anyhow_at_rest(short: bool) -> Iterator[Row]:
    """200 scenes that begin at rest, in random orientations: round-off must not raise an error, nor the energy."""
    for seed in range(12 if short else 200):
        case, made, scale = rest_scene(seed)
        mass = sum(
            1000 * np.prod(np.ptp(body.mesh.nodes, axis=0))
            for body in made._built(None).bodies.values()
        )
        speed = math.sqrt(made._data["material"][0]["young"] / 1000)
        yield classify(
            f"at rest, {case}",
            made.set_output(every=1, fields=[]),
            scale=scale,
            scale_name="E V",
            momentum_scale=mass * speed,
            whole=partial(gains, scale),
        )


CASES = [concave_at_rest, anyhow_at_rest]
