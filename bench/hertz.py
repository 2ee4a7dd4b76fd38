"""
Hertz's contact on finer and finer meshes: a rigid sphere is pressed into a quarter of a large block.
Force and contact radius are compared with the closed form, at the approach measured on the surface of
the block, and the observed order is computed. Prints the table of the chapter "Obstacle" in about a
minute.
"""

from __future__ import annotations

import math

import numpy as np
from libcontact.mesh import Mesh

import libcontact as ct

BETA = 40.0
YOUNG, POISSON, RADIUS, CONTACT = 1000.0, 0.3, 160.0, 1.0
SIZE, RIM = (
    20.0,
    3.0,
)  # half the width of the block and place where its surface is measured, in contact radii
MESHES = (2, 3, 4, 6)  # elements over the contact radius
MODULUS = YOUNG / (1.0 - POISSON**2)
GAUSS = np.array([-1.0, 1.0]) / math.sqrt(3.0)


def coordinates(n: int, contact: float = CONTACT, size: float = SIZE) -> np.ndarray:
    """Equal elements over two contact radii, then growing ones; all sizes halve when n doubles."""
    x = list(np.arange(2 * n + 1) * contact / n)
    while x[-1] < size * contact:
        x.append(x[-1] + (x[-1] - x[-2]) * 2.0 ** (1.0 / n))
    return np.array(x)


def scene(n: int) -> tuple[ct.Scene, np.ndarray]:
    x = coordinates(n)
    cells = len(x) - 1
    mesh = Mesh.box("hex8", [0, 0, -cells], [cells] * 3, [cells] * 3)
    place = np.rint(np.abs(mesh.nodes)).astype(int)
    nodes = x[place] * [1.0, 1.0, -1.0]
    made = ct.Scene(title="Hertz", units={"length": "mm", "mass": "t", "time": "s"})
    made.add_material("rubber", young=YOUNG, poisson=POISSON, density=1e-9)
    made.add_body("block", material="rubber", nodes=nodes, elements=mesh.elements)
    for axis in "xyz":
        made.add_support(f"block.{axis}_min", fix=axis)
    depth = CONTACT**2 / RADIUS
    ramp = 4.0 * SIZE / math.sqrt(YOUNG / 1e-9)
    made.add(
        "obstacle",
        surface="block.z_max",
        sphere={"centre": [0, 0, RADIUS], "radius": RADIUS},
        beta=BETA,
        travel=[0, 0, -depth],
        history={"time": [0, ramp], "value": [0, 1]},
    )
    made.add("damping", relaxation=True)
    data = made.set_time(end=60.0 * ramp, fraction=0.9).set_output(every=100000).data
    data["time"]["until_static"] = 1e-6
    return ct.Scene(data), x


def solve(n: int) -> dict:
    made, x = scene(n)
    run = made.run(progress=False)
    block, m = run.state["block"], len(x)
    top = np.flatnonzero(block.nodes[:, 2] == 0.0)
    u = np.zeros((m, m, 3))
    i, j = (np.searchsorted(x, block.nodes[top, k]) for k in range(2))
    u[i, j] = block.displacement[top]
    force, moment = pressed(u, x, BETA * YOUNG / np.diff(x).min())
    return {
        "n": n,
        "elements": (m - 1) ** 3,
        "steps": int(run.steps[-1]),
        "force": 4.0 * force,
        "radius": math.sqrt(2.5 * moment / force),
        "approach": -u[0, 0, 2] + np.interp(RIM * CONTACT, x, u[:, 0, 2]),
    }


def pressed(u: np.ndarray, x: np.ndarray, epsilon: float) -> tuple[float, float]:
    """
    Force on the surface, and the integral of pressure times the squared distance from the axis, from the
    library's Gauss points.
    """
    centre = np.array([0.0, 0.0, RADIUS - CONTACT**2 / RADIUS])
    X = np.zeros_like(u)
    X[..., 0], X[..., 1] = np.meshgrid(x, x, indexing="ij")
    weight = 0.25 * np.outer(np.diff(x), np.diff(x))
    force = moment = 0.0
    for s in GAUSS:
        for t in GAUSS:
            end = {-1: slice(-1), 1: slice(1, None)}
            shape = [
                (0.25 * (1 + a * s) * (1 + b * t), end[a], end[b]) for a in (-1, 1) for b in (-1, 1)
            ]
            at, way = (sum(N * field[i, j] for N, i, j in shape) for field in (X, u))
            gap = np.linalg.norm(at + way - centre, axis=2) - RADIUS
            p = epsilon * np.maximum(-gap, 0.0) * weight
            force += p.sum()
            moment += (p * (at[..., 0] ** 2 + at[..., 1] ** 2)).sum()
    return force, moment


def exact(force: float) -> tuple[float, float]:
    """Contact radius, and depth of the surface's middle below its rim, at a force."""
    a = (0.75 * force * RADIUS / MODULUS) ** (1 / 3)  # (eq:hertz)
    r = RIM * CONTACT
    rim = ((2 * a**2 - r**2) * math.asin(a / r) + r * a * math.sqrt(1 - (a / r) ** 2)) / (
        math.pi * RADIUS
    )
    return a, a**2 / RADIUS - rim


def main() -> None:
    rows = [solve(n) for n in MESHES]
    columns = "".join(
        f"{name:>10}{'error':>9}{'order':>7}" for name in ("force", "radius", "approach")
    )
    print(f"{'elements over a':>16}{'elements':>10}{'steps':>7}" + columns)
    before = None
    for row in rows:
        a, deep = exact(row["force"])
        whole = 4.0 / 3.0 * MODULUS * math.sqrt(RADIUS) * (CONTACT**2 / RADIUS) ** 1.5
        pairs = [(row["force"], whole), (row["radius"], a), (row["approach"], deep)]
        errors = [value / true - 1.0 for value, true in pairs]
        line = f"{row['n']:>16}{row['elements']:>10}{row['steps']:>7}"
        for k, (value, _) in enumerate(pairs):
            order = (
                ""
                if before is None
                else f"{math.log(abs(before[1][k] / errors[k])) / math.log(row['n'] / before[0]):.1f}"
            )
            line += f"{value:>10.5g}{errors[k]:>9.2%}{order:>7}"
        print(line)
        before = row["n"], errors


if __name__ == "__main__":
    main()
