"""
Hertz's pressure between two equal elastic balls, on unlike meshes too, with the default contact: pressed until they
rest, and in an impact at its largest force. Root mean square of the difference from Hertz's ellipse for the computed
force, over the nodes within 0.85 of its radius, for the recovered pressure and for the points. Prints the table of the
chapter on the pressure in about five minutes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from hertz import coordinates
from libcontact.mesh import Mesh

import libcontact as ct

YOUNG, POISSON, DENSITY, RADIUS, APPROACH = 20000.0, 0.3, 1e-9, 50.0, 0.25  # MPa, t/mm³, mm
MODULUS = 0.5 * YOUNG / (1.0 - POISSON**2)
CONTACT = math.sqrt(0.5 * RADIUS * APPROACH)
FORCE = 4.0 / 3.0 * MODULUS * math.sqrt(0.5 * RADIUS) * APPROACH**1.5
PEAK = 1.5 * FORCE / (math.pi * CONTACT**2)
SIZE = 5.0  # width and height of the quarter of a ball, in contact radii
# Elements over the contact radius on both balls.
MESHES = [("hex8", n, m) for n, m in ((2, 2), (3, 3), (4, 4), (3, 4))]
MESHES += [("hex20", n, m) for n, m in ((2, 2), (3, 3), (3, 4))]
TURNED = {8: [4, 5, 6, 7, 0, 1, 2, 3]}
TURNED[20] = [*TURNED[8], *range(12, 16), *range(8, 12), *range(16, 20)]


def ball(element: str, n: int, up: bool) -> dict[str, Any]:
    """A quarter of a ball below the origin, or of one above: a graded block with a round end."""
    at = coordinates(n, CONTACT, SIZE)
    cells = len(at) - 1
    mesh = Mesh.box(element, [0, 0, -cells], [cells] * 3, [cells] * 3)
    x = np.interp(np.abs(mesh.nodes), np.arange(cells + 1), at) * [1, 1, -1]
    x[:, 2] -= sag(x) * (1 + x[:, 2] / at[-1])
    if not up:
        return {"nodes": x, "elements": mesh.elements}
    return {"nodes": x * [1, 1, -1], "elements": mesh.elements[:, TURNED[mesh.elements.shape[1]]]}


def sag(x: np.ndarray) -> np.ndarray:
    """How far a ball lies off the plane that touches it."""
    return RADIUS - np.sqrt(RADIUS**2 - x[:, 0] ** 2 - x[:, 1] ** 2)


def round_faces(body: Any) -> np.ndarray:
    """The faces of a ball's round end."""
    faces, x = body.mesh.faces("outer")[0], body.nodes
    on: np.ndarray = faces[is_round(x)[faces].all(axis=1)]
    return on


def is_round(x: np.ndarray) -> np.ndarray:
    return np.abs(np.abs(x[:, 2]) - sag(x)) < 1e-9 * RADIUS


def scene(element: str, n: int, m: int, impact: bool = False, **contact: Any) -> ct.Scene:
    """Balls of which the upper one is pressed down by FORCE, or which meet such that about this force arises."""
    made = ct.Scene(title="balls", units={"length": "mm", "mass": "t", "time": "s"})
    made.add_material("elastic", young=YOUNG, poisson=POISSON, density=DENSITY)
    size = coordinates(m, CONTACT, SIZE)[-1]
    # Hertz's largest approach and time of contact, for the mass of the blocks.
    speed = math.sqrt(0.8 * FORCE * APPROACH / (0.5 * 4.0 * size**3 * DENSITY)) if impact else 0.0
    for name, cells, way in (("lower", n, 0.5), ("upper", m, -0.5)):
        block, velocity = ball(element, cells, name == "upper"), [0, 0, way * speed]
        made.add_body(name, material="elastic", element=element, velocity=velocity, **block)
        made.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    made.add_contact("lower.outer", "upper.outer", **contact).set_output(every=10**6)
    if impact:
        return made.set_time(end=0.47 * 2.94 * APPROACH / speed, fraction=0.9)
    made.add_support("lower.z_min", fix="z").add("damping", relaxation=True)
    made.add("load", surface="upper.z_max", pressure=FORCE / (4.0 * size**2))
    crossing = SIZE * CONTACT / math.sqrt(YOUNG / DENSITY)
    return made.set_time(end=1000.0 * crossing, fraction=0.9, until_static=1e-4)


def ellipse(r: np.ndarray) -> np.ndarray:
    """Hertz's pressure over its peak, at distances over the contact radius. (eq:hertz)"""
    pressure: np.ndarray = np.sqrt(np.maximum(1.0 - r**2, 0.0))
    return pressure


def profile(run: ct.Run, nodes: np.ndarray, side: int) -> tuple[Any, ...]:
    """Hertz's contact radius for the force on one ball; of its nodes and of its points the distances from the middle,
    and the pressures over Hertz's peak."""
    (points,) = run.contact
    nodes, points = nodes[nodes["side"] == side], points[points["side"] == side]
    x = run.state[run.bodies[side]].nodes[nodes["node"]]
    force = 4.0 * abs(nodes["area"] @ nodes["traction"][:, 2])
    a, on = (0.75 * force * 0.5 * RADIUS / MODULUS) ** (1 / 3), is_round(x)
    peak = 1.5 * force / (np.pi * a**2)
    # "outer" has the cuts of the balls, too.
    place = np.abs(points["position"])
    points = points[(place[:, 2] < 0.1 * RADIUS) & (place[:, :2].min(axis=1) > 1e-6 * a)]
    r, far = np.hypot(*x[on, :2].T), np.hypot(*points["position"][:, :2].T)
    return a, r, nodes["pressure"][on] / peak, far, points["raw_pressure"] / peak


def errors(run: ct.Run, nodes: np.ndarray, side: int) -> dict[str, float]:
    """
    Of the pressure at the nodes of one ball and of its points, over Hertz's peak: rms within 0.85 of the radius, its
    mean, the spread about the mean and the value in the middle; rms to twice the radius, with the rim.
    """
    a, r, p, far, raw = profile(run, nodes, side)
    off, within = p - ellipse(r / a), r < 0.85 * a
    found = {"rms": rms(off[within]), "mean": off[within].mean(), "spread": off[within].std()}
    found |= {"middle": off[r.argmin()], "rim": rms(off[r < 2.0 * a])}
    near = far < 0.85 * a
    found["points"] = rms(raw[near] - ellipse(far[near] / a))
    return found | {"force": 4.0 / 3.0 * MODULUS * a**3 / (0.5 * RADIUS)}


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def main() -> None:
    print(f"{'elements over a':>21}{'':10}" + "".join(f"{k:>9}" for k in COLUMNS))
    for element, n, m in MESHES:
        for impact in (False, True):
            run = scene(element, n, m, impact).run(progress=False)
            for side in range(1 if n == m else 2):
                found = errors(run, run.pressure["contact"][0], side)
                line = f"{element:>8} {(n, m)[side]} at {(m, n)[side]:<7}{('rest', 'impact')[impact]:<10}"
                print(line + "".join(f"{found[k]:>9.2%}" for k in COLUMNS), flush=True)


COLUMNS = ("rms", "mean", "spread", "middle", "rim", "points")

if __name__ == "__main__":
    main()
