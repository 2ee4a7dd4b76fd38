"""Two rings that strike each other, and nested shells."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .runs import Numbers, done, load, updates

# -- Rings in impact -------------------------------------------------------------------------------


RING_THICKNESS = 0.1  # over the radius of its axis


def ring_modes(count: int, shear: float) -> tuple[Any, Any]:
    """Frequencies and radial amplitudes at the point of contact, of unit modal mass, of the plane vibrations of a
    Timoshenko ring (E = ρ = r = 1, ν = 0, width 1) with up to ``count`` waves around."""
    h, found = RING_THICKNESS, []
    for n in range(count + 1):
        # Of the radial, tangential and angular amplitudes: stretch of the axis, shear and change of curvature.
        rows = np.array([[1, n, 0], [-n, -1, 1], [0, 0, n]]) * [[1], [n > 0], [1]]
        stiffness = rows.T @ np.diag([h, 0.5 * shear * h, h**3 / 12]) @ rows
        root = np.sqrt((math.pi if n else 2 * math.pi) * np.array([h, h, h**3 / 12]))
        square, modes = np.linalg.eigh(
            stiffness * (math.pi if n else 2 * math.pi) / np.outer(root, root)
        )
        omega = np.sqrt(np.maximum(square, 0.0))
        omega[0] *= n != 1  # the ring moves as a rigid body
        found += [(w, a) for w, a in zip(omega, modes[0] / root[0]) if n or abs(a) * root[0] > 0.5]
    return tuple(np.array(found).T)


def rings_exact(count: int, dt: float, shear: float = 5 / 6) -> tuple[Any, Any]:
    """Time and velocity of the centre of a ring that comes with 1 and meets a rigid plane at one point. In each step
    the force is constant; it is 0 or such that the point ends the step at the plane."""
    omega, a = ring_modes(count, shear)
    rigid, some = omega == 0, np.where(omega == 0, 1.0, omega)
    cosine, sine = np.cos(omega * dt), np.where(rigid, dt, np.sin(omega * dt) / some)
    shift = np.where(rigid, 0.5 * dt**2, (1 - cosine) / some**2) * a
    q, v = np.zeros_like(a), rigid / a
    time = dt * np.arange(int(RINGS_END / dt))
    speed = np.empty(len(time))
    for i in range(len(time)):
        speed[i] = v[rigid][0] * a[rigid][0]
        q, v = cosine * q + sine * v, cosine * v - omega**2 * sine * q
        force = max(0.0, a @ q / (a @ shift))
        q, v = q - shift * force, v - sine * a * force
    return time, speed


RINGS_END = 80.0


def rings(element: str, layers: int, around: int, fraction: float = 0.9) -> tuple[Any, Any, float]:
    """Two rings: time and velocity of the centre of the left one over that of the impact, and the cost."""
    data = load("rings")
    data["time"]["fraction"] = fraction
    for body in data["body"]:
        body |= {"element": element}
        body["ring"] |= {"cells": [layers, around, 1], "width": 2 * math.pi / around}
    run = done(data)
    p = run.body_momentum("left")
    return p["time"], p["p"][:, 0] / p["p"][0, 0], updates(run)


RINGS = {"48": ("hex20", 1, 48), "96": ("hex20", 1, 96), "hex8": ("hex8", 4, 192)}


def rings_in_impact() -> Numbers:
    """Restitution by modes and by three meshes, and the mean difference of the velocity from that of the modes. The
    last contacts of the coarsest mesh depend on the step, so it has the means of four steps."""
    found = {}
    for count in (40, 80, 160):
        time, speed = rings_exact(count, 0.005)
        found[f"modes_{count}"] = -speed[-1]
    for name, shear in (("stiffer", 1.0), ("softer", 0.7)):
        found[name] = -rings_exact(160, 0.005, shear)[1][-1]
    for name, case in RINGS.items():
        steps = (0.8, 0.85, 0.9, 0.95) if name == "48" else (0.9,)
        runs = [rings(*case, fraction=fraction) for fraction in steps]
        last = [-v[-1] for _, v, _ in runs]
        found[f"restitution_{name}"] = np.mean(last)
        found[f"apart_{name}"] = np.mean(
            [abs(v - np.interp(t, time, speed)).mean() for t, v, _ in runs]
        )
        found[f"cost_{name}"] = np.mean([cost for *_, cost in runs])
        if name == "48":
            found["spread_48"] = np.ptp(last)
    return found


# -- Shells ----------------------------------------------------------------------------------------


def shells_exact(young: float, nu: float, stress: float) -> tuple[float, float]:
    """Pressure and radial displacement at the interface of the scene's shells, by Lamé's solution. The inner one would
    expand by the strain stress/3K."""
    a, b, c = 0.6, 0.8, 1.0

    def soft(near: float, far: float) -> float:
        """Displacement of the face at ``near`` for a pressure 1 on it."""
        stiff = young * abs(far**3 - near**3)
        return near * ((1 - 2 * nu) * near**3 + 0.5 * (1 + nu) * far**3) / stiff

    pressure = b * stress * (1 - 2 * nu) / young / (soft(b, a) + soft(b, c))
    return pressure, pressure * soft(b, c)


def shells_displacement(young: float, nu: float, stress: float, r: Any, inner: bool) -> Any:
    """Lamé's radial displacement u = A r + C/r² of the inner or the outer shell at ``r``, for the pressure at the
    interface on one of its faces and none on the other."""
    pressure, _ = shells_exact(young, nu, stress)
    near, far, sign = (0.8, 0.6, -1) if inner else (0.8, 1.0, 1)
    scale = sign * pressure * near**3 / (young * abs(far**3 - near**3))
    free = stress * (1 - 2 * nu) / young * r if inner else 0.0
    return free + scale * ((1 - 2 * nu) * r + 0.5 * (1 + nu) * far**3 / r**2)


def nested(element: str, inner: list[int], outer: list[int]) -> tuple[float, float, float]:
    """Relative errors of the mean pressure on the outer shell and of its mean displacement, and cost."""
    data = load("nested_shells")
    for body, cells in zip(data["body"], (inner, outer)):
        body["element"], body["shell"]["cells"] = element, cells
    run, exact = done(data), shells_exact(1.0, 0.25, 1e-3)
    rows = run.pressure["contact"][0]
    rows = rows[(rows["side"] == 1) & (rows["pressure"] > 0)]
    shell = run.state["outer"]
    radius = np.linalg.norm(shell.nodes, axis=1)
    within = radius < 0.8 + 1e-9
    moved = (shell.displacement * shell.nodes).sum(axis=1)[within] / radius[within]
    pressure = np.average(rows["pressure"], weights=rows["area"])
    return pressure / exact[0] - 1, float(moved.mean()) / exact[1] - 1, updates(run)


SHELLS = (("hex8", 16, 16), ("hex8", 32, 32), ("hex20", 16, 12))


def nested_shells() -> Numbers:
    """Like meshes of hex8, and unlike ones of hex20."""
    found = dict(zip(("pressure", "displacement"), shells_exact(1.0, 0.25, 1e-3)))
    for element, inner, outer in SHELLS:
        layers = 4 if inner == 32 else 2
        values = nested(element, [layers, inner], [layers, outer])
        names = ("pressure", "displacement", "cost")
        found |= {f"{element}_{inner}_{key}": value for key, value in zip(names, values)}
    return found
