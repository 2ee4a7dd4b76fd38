"""Pressure of the contact, of points and of nodes."""

from __future__ import annotations

import itertools

import balls
import numpy as np

import libcontact as ct

from .shared import ROOT, Numbers, hat, measurement, scene_of

# -- Unlike meshes ---------------------------------------------------------------------------------


def pressed(n: int, m: int, beta: float) -> tuple[float, float, float]:
    """
    Two elastic blocks with ν = 0, their faces cut into n x n and m x m elements, pressed together evenly and relaxed.
    The largest and smallest pressure of a point over the true one, and the largest error of the stress of an element.
    """
    scene = scene_of(young=1000.0)
    for name, z, cells in (("lower", -0.5, n), ("upper", 0.0, m)):
        scene.add_body(
            name,
            material="elastic",
            box={
                "origin": [0, 0, z],
                "size": [1, 1, 0.5],
                "cells": [cells, cells, max(cells // 2, 1)],
            },
        )
        scene.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    scene.add_support("lower.z_min", fix="z").add_contact("lower.z_max", "upper.z_min", beta=beta)
    scene.add("load", surface="upper.z_max", pressure=1.0).add("damping", relaxation=True)
    run = (
        scene.set_time(end=20.0, fraction=0.9, until_static=1e-6)
        .set_output(every=10**6)
        .run(progress=False)
    )
    pressure = run.contact[0]["raw_pressure"]
    stress = np.concatenate([run.state[name].stress[:, 2] for name in ("lower", "upper")])
    return pressure.max(), pressure.min(), np.abs(stress + 1).max()


@measurement
def unlike_meshes() -> Numbers:
    """Blocks of 8 and 11, and of 2 and 14 elements along an edge, at β = 4 and 100: errors of the pressure of points
    and of the stress of elements."""
    found = {}
    for name, n, m in (("8_11", 8, 11), ("2_14", 2, 14)):
        for beta in (4, 100):
            high, low, stress = pressed(n, m, beta)
            found |= {
                f"{name}_{beta}_point": max(high - 1, 1 - low),
                f"{name}_{beta}_stress": stress,
            }
    return found


# -- Pressure from forces --------------------------------------------------------------------------


def blocks(n: int, m: int, element: str) -> ct.Run:
    """Two elastic blocks with ν = 0, their faces cut into n x n and m x m elements, pressed together by the pressure 1
    and relaxed, with the default contact."""
    scene = scene_of(young=1000.0)
    for name, z, cells in (("lower", -0.5, n), ("upper", 0.0, m)):
        box = {
            "origin": [0, 0, z],
            "size": [1, 1, 0.5],
            "cells": [cells, cells, max(cells // 2, 1)],
        }
        scene.add_body(name, material="elastic", element=element, box=box)
        scene.add_support(f"{name}.x_min", fix="x").add_support(f"{name}.y_min", fix="y")
    scene.add_support("lower.z_min", fix="z").add_contact("lower.z_max", "upper.z_min")
    scene.add("load", surface="upper.z_max", pressure=1.0).add("damping", relaxation=True)
    scene.set_time(end=20.0, fraction=0.9, until_static=1e-5).set_output(every=10**6)
    return scene.run(progress=False)


def projected(nodes: np.ndarray, n: int) -> np.ndarray:
    """Pressures (n + 1, n + 1) on a face of n x n linear elements from the forces of its nodes, by the consistent
    matrix of the surface."""
    force, matrix = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    i, j = np.rint(n * nodes["position"][:, :2]).astype(int).T
    force[i, j] = nodes["area"] * np.abs(nodes["traction"][:, 2])
    for e in range(n):
        matrix[e : e + 2, e : e + 2] += np.array([[2, 1], [1, 2]]) / (6 * n)
    return np.linalg.solve(matrix, np.linalg.solve(matrix, force).T).T


def by_points(run: ct.Run, side: int, n: int) -> np.ndarray:
    """Pressures (n + 1, n + 1) on a face of n x n linear elements from the forces of its nodes, over the area that the
    points of both surfaces have there."""
    (nodes,), (points,) = run.pressure["contact"], run.contact
    nodes, force = nodes[nodes["side"] == side], np.zeros((n + 1, n + 1))
    i, j = np.rint(n * nodes["position"][:, :2]).astype(int).T
    force[i, j] = nodes["area"] * np.abs(nodes["traction"][:, 2])
    place = np.where((points["side"] == side)[:, None], points["position"], points["closest"])
    weight = 0.5 * points["weight"] * (points["raw_pressure"] > 0)
    return force / ((hat(place[:, 0], n) * weight) @ hat(place[:, 1], n).T)


@measurement
def recovered_blocks() -> Numbers:
    """Blocks of 8 and 11, and of 2 and 14 elements along an edge: largest errors of the traction of a point, of the
    recovered pressure and of the stress of an element; of the sharper pressure."""
    found = {}
    for n, m in ((8, 11), (2, 14)):
        for element in ("hex8", "hex20"):
            run, name = blocks(n, m, element), f"{n}_{m}_{element}"
            nodes = run.pressure["contact"][0]
            stress = np.concatenate([run.state[body].stress[:, 2] for body in run.bodies])
            found |= {
                f"{name}_point": np.abs(run.contact[0]["raw_pressure"] - 1).max(),
                f"{name}_node": np.abs(nodes["pressure"] - 1).max(),
                f"{name}_stress": np.abs(stress + 1).max(),
            }
            sharp = [
                sharper(run, s, run.state[body].mesh.faces(face)[0])["pressure"]
                for s, body, face in ((0, "lower", "z_max"), (1, "upper", "z_min"))
            ]
            found[f"{name}_sharper"] = max(np.abs(side - 1).max() for side in sharp)
            if element == "hex8":
                sides = [
                    projected(nodes[nodes["side"] == s], cells) for s, cells in ((0, n), (1, m))
                ]
                found[f"{name}_consistent"] = max(np.abs(side - 1).max() for side in sides)
                found[f"{name}_by_points"] = max(
                    np.abs(by_points(run, s, cells) - 1).max() for s, cells in ((0, n), (1, m))
                )
    return found


@measurement
def recovered_rim() -> Numbers:
    """tutorials/scenes/hertz.toml with the default penalty on 10³ elements: pressure at the corner of the only face in
    contact, with the area of this face alone, and Hertz's; and in the middle with hex20."""
    found = {}
    for element in ("hex8", "hex20"):
        data = ct.Scene.load(ROOT / "tutorials" / "scenes" / "hertz.toml").data
        data["body"][0] |= {"element": element}
        data["body"][0]["box"]["cells"] = [10, 10, 10]
        del data["obstacle"][0]["beta"]
        nodes = ct.Scene(data).run(progress=False, output=False).pressure["obstacle"][0]
        middle, corner = (
            np.argmin(((nodes["position"][:, :2] - x) ** 2).sum(axis=1)) for x in (0.0, 0.4)
        )
        if element == "hex20":
            found["hex20"] = nodes["pressure"][middle]
            continue
        assert np.count_nonzero(nodes["pressure"]) == 4
        found |= {
            "corner": nodes["pressure"][corner],
            "by_faces": nodes["pressure"][corner] * nodes["area"][corner] / (0.4**2 / 4),
            "corner_hertz": 2000 / 0.91 / np.pi * np.sqrt((0.1 - 2 * 0.4**2 / 4) / 4),
        }
    return found


@measurement
def recovered_hertz() -> Numbers:
    """tutorials/scenes/hertz.toml on a block of half the size with the same elements, relaxed: rms of the recovered
    pressure about Hertz's profile, fitted within 0.85 a, over its peak; and about that of the computed force with the
    default penalty, also if mid-sides had the means of bilinear corners."""
    found = {}
    for element, default in itertools.product(("hex8", "hex20"), (False, True)):
        data = ct.Scene.load(ROOT / "tutorials" / "scenes" / "hertz.toml").data
        if default:
            del data["obstacle"][0]["beta"]
        data["body"][0] |= {
            "element": element,
            "box": {"origin": [0, 0, -2], "size": [2, 2, 2], "cells": [10, 10, 10]},
        }
        data["time"] |= {"end": 4e-3, "until_static": 1e-5}
        data |= {"damping": {"relaxation": True}, "output": {"every": 10**6}}
        run = ct.Scene(data).run(progress=False)
        nodes = run.pressure["obstacle"][0]
        r = np.hypot(*nodes["position"][:, :2].T)
        if default:
            block = run.state["block"]
            r = np.hypot(*block.nodes[nodes["node"], :2].T)
            force = 4.0 * abs(nodes["area"] @ nodes["traction"][:, 2])
            radius = (0.75 * force * 4.0 / (1000.0 / 0.91)) ** (1 / 3)
            peak, within = 1.5 * force / (np.pi * radius**2), r < 0.85 * radius
            exact = peak * np.sqrt(1.0 - (r[within] / radius) ** 2)
            found[f"{element}_default"] = rms(nodes["pressure"][within] - exact) / peak
            if element == "hex20":
                corners = at_corners(block.mesh.faces("z_max")[0], nodes, 0.2**2)
                found["hex20_corners"] = rms(corners[within] - exact) / peak
            continue
        within = r < 0.85 * np.sqrt(4.0 * 0.1)
        # Hertz's profile: p² is a straight line over r².
        slope, peak = np.polyfit(r[within] ** 2, nodes["pressure"][within] ** 2, 1)
        error = nodes["pressure"][within] - np.sqrt(peak + slope * r[within] ** 2)
        found[element] = rms(error) / np.sqrt(peak)
    return found


def rms(values: np.ndarray) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(values**2)))


def at_corners(faces: np.ndarray, nodes: np.ndarray, size: float) -> np.ndarray:
    """Pressures of the nodes of Q8 faces (n, 8), squares of area `size`, if corners took half of the forces of
    mid-sides, and mid-sides had the means of their corners; from the recovered forces, of which a mid-side has kept a
    quarter."""
    row = {node: i for i, node in enumerate(nodes["node"])}
    place = np.array([[row[node] for node in face] for face in faces])
    traction, area = nodes["area"][:, None] * nodes["traction"], np.zeros(len(nodes))
    ends = {f[4 + k]: [f[k], f[(k + 1) % 4]] for f in place for k in range(4)}
    for middle, corners in ends.items():
        traction[corners] += 0.5 * traction[middle]
    np.add.at(area, place[:, :4], 0.25 * size)
    corner = area > 0.0
    traction[corner] /= area[corner, None]
    for middle, corners in ends.items():
        traction[middle] = traction[corners].mean(axis=0)
    return np.linalg.norm(traction, axis=1)


@measurement
def recovered_balls() -> Numbers:
    """Two equal balls with the default contact, at rest and at the largest force of an impact, with these numbers of
    elements over the radius (``bench/balls.py``): rms of the recovered pressure about Hertz's profile for the force,
    its mean and its error in the middle, over the peak; rms of the points; rms of the sharper pressure, and
    the largest tension that it has."""
    found = {}
    for element, n, m, impact in (
        ("hex8", 3, 3, False),
        ("hex20", 3, 3, False),
        ("hex8", 3, 3, True),
        ("hex20", 2, 2, True),
        ("hex20", 3, 3, True),
        ("hex20", 4, 4, True),
        ("hex20", 3, 4, True),
        ("hex20", 4, 5, True),
    ):
        run = balls.scene(element, n, m, impact).run(progress=False)
        name = f"{element}_{n}_{m}" + ("_impact" if impact else "")
        off = balls.errors(run, run.pressure["contact"][0], 0)
        found |= {f"{name}_{key}": off[key] for key in ("rms", "mean", "middle", "points")}
        sharp = sharper(run, 0, balls.round_faces(run.state["lower"]))
        found[f"{name}_sharper"] = balls.errors(run, sharp, 0)["rms"]
        tension = sharp["traction"][:, 2].max() / balls.PEAK
        found["tension"] = max(found.get("tension", 0.0), tension)
        if n != m:
            found[f"{name}_fine"] = balls.errors(run, run.pressure["contact"][0], 1)["rms"]
    return found


def sharper(run: ct.Run, side: int, faces: np.ndarray) -> np.ndarray:
    """Rows of one surface with the recovered tractions plus half of what a second mean under their weights would take
    from them; its faces (n, 4 or 8) are nearly parallelograms."""
    (nodes,) = run.pressure["contact"]
    nodes = nodes[nodes["side"] == side].copy()
    x, weights = run.state[run.bodies[side]].nodes, weights_of(faces.shape[1])
    area = [x[faces[:, k]] - x[faces[:, 0]] for k in (1, 3)]
    area = np.linalg.norm(np.cross(*area), axis=1)
    traction, force, whole = np.zeros((len(x), 3)), np.zeros((len(x), 3)), np.zeros(len(x))
    traction[nodes["node"]] = nodes["traction"]
    np.add.at(force, faces, area[:, None, None] * (weights @ traction[faces]))
    np.add.at(whole, faces, area[:, None] * weights.sum(axis=1))
    on = whole > 0.0
    traction[on] += 0.5 * (traction[on] - force[on] / whole[on, None])
    nodes["traction"], nodes["area"] = traction[nodes["node"]], whole[nodes["node"]]
    nodes["pressure"] = np.linalg.norm(nodes["traction"], axis=1)
    return nodes


def weights_of(count: int) -> np.ndarray:
    """Integrals of the products of the weights :eq:`recovered-weights` over a square of area 1 with 4 or 8 nodes."""
    place, weight = np.polynomial.legendre.leggauss(4)
    x, y = np.meshgrid(0.5 + 0.5 * place, 0.5 + 0.5 * place)
    apart = [(abs(x - i), abs(y - j)) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    cut = 0.5 if count == 8 else 0.0
    chi = [(1 - u) * (1 - v) * (1 - cut * (u + v)) for u, v in apart]
    if count == 8:
        across, along = x * (1 - x), y * (1 - y)
        chi += [across * (1 - y), x * along, across * y, (1 - x) * along]
    return np.einsum("aij,bij,i,j->ab", chi, chi, 0.5 * weight, 0.5 * weight)
