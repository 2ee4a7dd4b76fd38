"""
Elastic balls that strike each other, beyond the half-spaces of Hertz and of Maw, Barber and Fawcett: by how much a free
ball yields more than a half-space (a sum of vector spherical harmonics), and a bed of springs that has this in series.
Lengths over the radius of the ball, compliances over 1/E* R.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from defaults import DURATION


def stiffness_ratio(poisson: float) -> float:
    """κ, of the tangential stiffness of a contact over its normal one."""
    return 2 * (1 - poisson) / (2 - poisson)


def lame(poisson: float) -> tuple[float, float]:
    """Lamé's constants for E* = E / (1 - ν²) = 1."""
    young = 1 - poisson**2
    return young * poisson / (1 + poisson) / (1 - 2 * poisson), young / 2 / (1 + poisson)


def spheroidal(n: int, poisson: float) -> Any:
    """Displacements over tractions of degree n ≠ 1 at the surface of a ball at rest, radial Y
    and tangential ∇Y, from the solutions ∇ω and r² ∇ω + α x ω of Navier's equation with the
    solid harmonic ω = rⁿ Y."""
    Λ, μ = lame(poisson)
    α = -2 * (n * Λ + (3 * n + 1) * μ) / ((n + 3) * Λ + (n + 5) * μ)
    if n == 0:
        return np.array([[1 / (3 * Λ + 2 * μ), 0], [0, 0]])
    radial, along = Λ * (2 * n + α * (n + 3)) + μ * (2 * n + 2 * α + n * α), μ * (2 * n + α)
    u = np.array([[n, n + α], [1, 1]])
    t = np.array([[2 * μ * n * (n - 1), radial + n * along], [2 * μ * (n - 1), along]])
    return u @ np.linalg.inv(t)


def accelerated(poisson: float) -> Any:
    """The same for n = 1, relative to the centre of mass of the ball, which the tractions
    accelerate: the solution is c₁ r² b + c₂ x (b · x) with the body force b = -(t_r + 2
    t_t)."""
    Λ, μ = lame(poisson)
    c = np.linalg.inv([[2 * Λ + 8 * μ, 4 * Λ + 6 * μ], [2 * μ, μ]]) @ [[1, 2], [0, 1]]
    return np.array([[1, 1], [1, 0]]) @ c - np.outer([1, 1], [0.6, 0.2] @ c)


def excess(ratio: float, poisson: float) -> tuple[float, float]:
    """Compliances of a free ball beyond those of a half-space, under a pressure and under a
    shear over the disc of radius ``ratio`` that are distributed as Hertz's pressure: the
    work of both over the squares of their resultants. The distance of the centre of mass
    counts, and for the shear the turning of the ball."""
    _, μ = lame(poisson)
    x, weight = np.polynomial.legendre.leggauss(200)
    turn = 0.25 * np.pi * (x + 1)
    s, c = ratio * np.sin(turn), np.sqrt(1 - (ratio * np.sin(turn)) ** 2)
    load = 0.25 * np.pi * weight * ratio * np.cos(turn) ** 2 * s
    load /= 2 * np.pi * load.sum()
    work, last, p = [0.0, 0.0], np.zeros_like(c), np.ones_like(c)
    for n in range(int(20 / ratio)):
        # Legendre's polynomial and its first two derivatives with respect to the angle
        first = n * (c * p - last) / s
        second, norm, both = -c / s * first - n * (n + 1) * p, 2 / (2 * n + 1), max(n * (n + 1), 1)
        of = accelerated(poisson) if n == 1 else spheroidal(n, poisson)
        # A vertical pressure, Y = P_n
        t = np.array([load @ (-c * p), load @ (s * first) / both]) / norm
        work[0] += 2 * np.pi * norm * (t * [1, both]) @ of @ t
        # A horizontal shear, Y = P_n' cos φ; with the toroidal part, of which n = 1 turns the ball
        if n > 0:
            t = np.array([-load @ (s * first), -load @ (c * second + first / s) / both])
            spin = load @ (c * first / s + second) / both
            toroidal = 1 / (7 * μ) if n == 1 else 1 / (μ * (n - 1))
            sums = (t * [1, both]) @ of @ t + both * toroidal * spin**2
            work[1] += np.pi * sums / (norm * both)
        last, p = p, ((2 * n + 1) * c * p - n * last) / (n + 1)
    half_space, κ = 0.6 / ratio, stiffness_ratio(poisson)
    return work[0] - half_space, work[1] - half_space / κ


def strike(angle: float, poisson: float, ratio: float = 0.0, springs: int = 1000) -> dict[str, Any]:
    """Two equal balls at ψ₁ = ``angle`` that come so fast that by Hertz the radius of contact
    reaches ``ratio``; 0: half-spaces. Tangential impulse over μ times the normal one, and
    duration and largest force over those of Hertz. A bed of independent springs is exact
    for half-spaces: a sphere of radius 1 with E* = m = 1 that comes 1 deep, and 2/7 of
    whose mass resists a motion of its surface. What the balls yield beyond half-spaces is
    in series with it."""
    steps, κ = 4000, stiffness_ratio(poisson)
    more = ratio * np.array(excess(ratio, poisson)[::-1] if ratio else (0.0, 0.0))
    speed = math.sqrt(16 / 15)
    dt = DURATION / speed / steps
    along, deep, impulse = angle * speed / κ, 0.0, np.zeros(2)
    force, last = np.zeros(2), np.zeros(2)
    x = (np.arange(springs) + 0.5) / springs
    shift, top, count = np.zeros(springs), 0.0, 0
    while True:
        deep, count = deep + speed * dt, count + 1
        if deep <= 0:
            break
        pressure = np.maximum(deep - more[1] * force[1] - x**2, 0.0)
        limit = pressure / κ
        shift = np.clip(shift + along * dt - more[0] * (force[0] - last[0]), -limit, limit)
        last, force = force, 2 / springs * np.array([κ * shift.sum(), pressure.sum()])
        along, speed = along - 3.5 * force[0] * dt, speed - force[1] * dt
        impulse, top = impulse + force * dt, max(top, force[1])
    return {
        "impulse": float(impulse[0] / impulse[1]),
        "duration": (count - deep / (speed * dt)) / steps,
        "force": float(top / (4 / 3)),
    }
