"""Lasting contact: a load presses a bar on a wall, at first smoothly, then with a jump. Its energy loss, and the mode
at its surface (chapter "Enforcement")."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import METRES, box_of

import libcontact as ct

LOAD = 1e-4


def pressed(
    cells: int, element: str, jolt: float, periods: float, fraction: float, **law
) -> ct.Run:
    """A bar of unit elements (E = ρ = 1, ν = 0) on a wall. The load rises smoothly over 20 periods; then it jumps by a
    fraction of itself."""
    rise = 80.0 * cells
    s = np.linspace(0.0, 1.0, 300)
    history = {
        "time": [*(rise * s), rise * (1 + 1e-6), 2 * rise],
        "value": [*(s**3 * (10 - 15 * s + 6 * s * s)), 1 + jolt, 1 + jolt],
    }
    scene = ct.Scene(title="bar", units=METRES)
    scene.add_material("m", young=1.0, poisson=0.0, density=1.0)
    box = box_of([0, 0, 0], [cells, 1, 1], [cells, 1, 1])
    scene.add_body("bar", material="m", box=box, element=element)
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, **law)
    scene.add("load", surface="bar.x_max", traction=[-LOAD, 0, 0], history=history)
    scene.set_time(end=rise + 4 * cells * periods, fraction=fraction)
    return scene.set_output(every=1, fields=[]).run(progress=False, output=False)


def lost(run: ct.Run, cells: int, jolt: float, beta: float, periods: float) -> float:
    """Fraction of the energy of the oscillation after the jump that is lost per period."""
    start = int(np.searchsorted(run.time, 80.0 * cells + 0.2 * cells))
    swing = 0.5 * (jolt * LOAD) ** 2 * (cells + 1 / beta)
    total = run.energy["total"]
    return 1 - (1 - (total[start] - total[-1]) / swing) ** (1 / periods)


@pytest.mark.parametrize("element", ["hex8", "hex20"])
@pytest.mark.parametrize("beta", [0.5, 4.0, 100.0])
@pytest.mark.parametrize("fraction", [0.1, 0.98])
def test_without_dissipation_nothing_is_lost_and_nothing_made(element, beta, fraction):
    run = pressed(4, element, 0.05, 3.0, fraction, beta=beta, dissipation=0.0)
    assert abs(lost(run, 4, 0.05, beta, 3.0)) < 1e-10


def test_the_default_loses_little():
    for element in ("hex8", "hex20"):
        run = pressed(10, element, 0.5, 5.0, 0.5)
        assert 0 < lost(run, 10, 0.5, 40.0, 5.0) < 0.005, element


def test_a_soft_law_with_full_damping_loses_more():
    run = pressed(10, "hex8", 0.5, 2.0, 0.5, beta=1.0, dissipation=1.0)
    assert lost(run, 10, 0.5, 1.0, 2.0) > 0.1


@pytest.mark.parametrize("beta", [0.5, 1.0, 2.0])
def test_the_mode_at_the_surface_has_the_frequency_of_the_book(beta):
    # The eigenvalue of a long bar with the spring is the closed form (eq:surface-mode).
    n = 60
    stiff = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    stiff[0, 0] = 1 + beta
    half = np.ones(n)
    half[0] = np.sqrt(0.5)
    highest = np.linalg.eigvalsh(stiff / np.outer(half, half))[-1]
    r = 1 / (beta + np.sqrt(1 + beta**2))
    assert np.sqrt(highest) / 2 == pytest.approx(0.5 * np.sqrt(2 + r + 1 / r), rel=1e-12)


@pytest.mark.parametrize("beta", [1.0, 100.0])
def test_a_wall_that_gathers_speed_makes_nothing(beta):
    scene = ct.Scene(title="push", units=METRES)
    scene.add_material("m", young=1.0, poisson=0.0, density=1.0)
    box = box_of([0, 0, 0], [10, 1, 1], [10, 1, 1])
    scene.add_body("bar", material="m", box=box)
    s = np.linspace(0.0, 1.0, 100)
    scene.add(
        "obstacle",
        surface="bar.x_min",
        plane={"point": [0, 0, 0], "normal": [1, 0, 0]},
        travel=[0.1, 0, 0],
        history={"time": [*(40 * s)], "value": [*(s * s * (3 - 2 * s))]},
        beta=beta,
    )
    scene.set_time(end=60.0, fraction=0.9).set_output(every=1, fields=[])
    energy = scene.run(progress=False, output=False).energy
    assert np.diff(energy["total"]).max() < 1e-12 * energy["external"][-1]
