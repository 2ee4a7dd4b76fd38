"""A strip over a cylinder and a ring between plates, both large bending."""

from __future__ import annotations

import math

import numpy as np

from .runs import Numbers, done, load, updates

# -- A plate bent over a cylinder ------------------------------------------------------------------


def elastica(force: float, bending: float, radius: float, length: float) -> tuple[float, float]:
    """Angle of contact and depth of the end of an inextensible beam whose axis is wrapped round a circle and whose end
    carries a dead weight. Beyond the contact ½ B κ² = F (sin θ_end − sin θ), with κ = 1/radius at its begin."""
    x, weight = np.polynomial.legendre.leggauss(40)

    def beam_of(angle: float) -> tuple[float, float]:
        top = math.sin(angle) + bending / (2 * radius**2 * force)
        if top >= 1:
            return math.inf, math.inf
        last = math.asin(top)
        # θ = θ_end − u² removes the root from the integrand.
        half = 0.5 * math.sqrt(last - angle)
        u = half * (x + 1)
        theta = last - u**2
        ds = 2 * u * half * weight / np.sqrt(2 * force / bending * (top - np.sin(theta)))
        depth = radius * (1 - math.cos(angle)) + float((ds * np.sin(theta)).sum())
        return radius * angle + float(ds.sum()), depth

    low, high = 1e-6, 0.5 * math.pi
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if beam_of(middle)[0] < length else (low, middle)
    return math.degrees(low), beam_of(low)[1]


def plate_exact() -> tuple[float, float]:
    """Angle [degrees] and depth of the end's middle of the scene's plate."""
    thick = 0.1
    return elastica(1920 * thick, 1e6 * thick**3 / 12, 1 + thick / 2, 1.5)


def plate(element: str, along: int, layers: int) -> tuple[float, float, float]:
    """Angle of contact [degrees], of which the sine is horizontal over vertical force on the cylinder, depth of the
    end's middle, and cost."""
    data = load("bent_plate")
    body = data["body"][0]
    body["element"], body["box"]["cells"] = element, [along, 1, layers]
    run = done(data)
    force, state = run.probes["cylinder"]["force"][-1], run.state["plate"]
    end = state.positions[np.isclose(state.nodes[:, 0], 1.5)].mean(axis=0)
    angle = math.degrees(math.asin(abs(force[0] / force[2])))
    return angle, 0.05 - float(end[2]), updates(run)


PLATES = (("hex20", 8, 1), ("hex20", 15, 1), ("hex8", 30, 2), ("hex8", 60, 4))


def bent_plate() -> Numbers:
    """The elastica, two meshes of hex20 and two of hex8."""
    found = dict(zip(("angle", "depth"), plate_exact()))
    for element, along, layers in PLATES:
        name, values = f"{element}_{along}", plate(element, along, layers)
        found |= {f"{name}_{key}": value for key, value in zip(("angle", "depth", "cost"), values)}
    return found


# -- A crushed ring ---------------------------------------------------------------------------------


def crushed_exact(height: float) -> float:
    """Force F r²/B on an inextensible ring of radius r = 1 whose axis is ``height`` high between two plates. From the
    top on the slope obeys θ'' = a cos θ with a = F/2B, so θ'² = κ² + 2 a sin θ; the curvature κ at the top is 0 from
    the height on at which the ring begins to lie flat."""
    x, weight = np.polynomial.legendre.leggauss(60)
    u = 0.5 * (x + 1)
    sine, dtheta = np.sin(0.5 * math.pi * u**2), 0.5 * math.pi * u * weight  # θ = π u²/2

    def integrals(m: float) -> tuple[float, float]:
        """Length and height of a quarter times √(2a), for κ² = 2 a m."""
        root = np.sqrt(m + sine)
        return float((dtheta / root).sum()), float((dtheta * sine / root).sum())

    low, high = 0.0, 1e6
    for _ in range(200):  # more curvature at the top, less load, a higher ring
        m = 0.5 * (low + high)
        length, rise = integrals(m)
        low, high = (m, high) if math.pi * rise / length < height else (low, m)
    length, rise = integrals(low)
    return (2 * rise / height) ** 2 if low < 1e-12 else (2 * length / math.pi) ** 2


def crushed(travel: float, around: int) -> tuple[float, float]:
    """Force F r²/B when each plate has moved by ``travel``, and cost."""
    data = load("crushed_ring")
    data["body"][0]["ring"]["cells"][1] = around
    for obstacle in data["obstacle"]:
        obstacle["travel"][1] *= travel / 0.4
    run = done(data)
    return abs(run.probes["plate"]["force"][-1, 1]) * 12 / (1e6 * 0.1**4), updates(run)


def crushed_ring() -> Numbers:
    """Two depths in closed form; relative errors of the force on three meshes."""
    found = {"exact_2": crushed_exact(1.6), "exact_4": crushed_exact(1.2)}
    for around in (24, 40, 48):
        for name, travel in (("2", 0.2), ("4", 0.4)):
            force, cost = crushed(travel, around)
            found[f"force_{name}_{around}"] = force / found[f"exact_{name}"] - 1
        found[f"cost_{around}"] = cost
    return found
