"""Lasting contact: a load presses a bar on a wall, at first smoothly, then with a jump. Its energy loss, and the mode
at its surface (chapter "Enforcement")."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import box_of, scene_with

import libcontact as ct

LOAD = 1e-4


def pressed(
    cells: int,
    element: str,
    jolt: float,
    periods: float,
    fraction: float,
    tolerance: float = 1e-10,
    **law,
) -> ct.Run:
    """A bar of unit elements (E = ρ = 1, ν = 0) on a wall. The load rises smoothly over 20 periods; then it jumps by a
    fraction of itself."""
    rise = 80.0 * cells
    s = np.linspace(0.0, 1.0, 300)
    history = {
        "time": [*(rise * s), rise * (1 + 1e-6), 2 * rise],
        "value": [*(s**3 * (10 - 15 * s + 6 * s * s)), 1 + jolt, 1 + jolt],
    }
    scene = scene_with("m", young=1.0, poisson=0.0, density=1.0, title="bar")
    box = box_of([0, 0, 0], [cells, 1, 1], [cells, 1, 1])
    scene.add_body("bar", material="m", box=box, element=element)
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, **law)
    scene.add("load", surface="bar.x_max", traction=[-LOAD, 0, 0], history=history)
    scene.set_time(end=rise + 4 * cells * periods, fraction=fraction, force_tolerance=tolerance)
    return scene.set_output(every=1, fields=[]).run(output=False)


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


@pytest.mark.parametrize("element", ["hex8", "hex20"])
@pytest.mark.parametrize("fraction", [0.1, 0.98])
def test_without_dissipation_a_loose_solution_loses_little(element, fraction):
    """With the default tolerance the energy falls, by less than 0.05 % of the oscillation per period
    (:eq:`energy-stop`)."""
    run = pressed(4, element, 0.05, 3.0, fraction, 1e-4, beta=100.0, dissipation=0.0)
    assert -1e-10 < lost(run, 4, 0.05, 100.0, 3.0) < 5e-4
    swing = run.energy["total"][run.time > 80.0 * 4 * 1.01]
    assert np.diff(swing).max() < 1e-12 * np.abs(run.energy["external"]).max()


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
    scene = scene_with("m", young=1.0, poisson=0.0, density=1.0, title="push")
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
    energy = scene.run(output=False).energy
    assert np.diff(energy["total"]).max() < 1e-12 * energy["external"][-1]


@pytest.mark.parametrize("beta", [1.0, 40.0, 1e3])
@pytest.mark.parametrize("fraction", [0.2, 0.95])
def test_restitution_0_is_the_law_of_the_gaps_alone(beta, fraction):
    """A bar of four unit elements bounces off a wall and is pressed on it again; by hand, in one dimension, with
    (eq:energy-controlled) and (eq:surface-damping)."""
    cells, g, v0, dt, zeta = 4, 0.3, -0.1, fraction, 0.15
    scene = scene_with("m", young=1.0, poisson=0.0, density=1.0, title="bar")
    scene.add_body(
        "bar",
        material="m",
        box=box_of([g, 0, 0], [cells, 1, 1], [cells, 1, 1]),
        velocity=[v0, 0, 0],
    )
    scene.add("gravity", acceleration=[-0.02, 0, 0])
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, beta=beta, restitution=0.0)
    scene.set_time(end=80.0, dt=dt, force_tolerance=1e-10).set_output(every=1, fields=[])
    run = scene.run(output=False)
    dt = run.time[1]  # whole steps to the end
    m, u, v = np.array([0.5, 1.0, 1.0, 1.0, 0.5]), np.zeros(5), np.full(5, v0)
    a = zeta * np.sqrt(1 + 4 * m[0] / (beta * dt**2))
    last, forces = g, []
    for n in range(run.steps[-1] + 1):
        tau = dt if n else dt / 2
        pull = np.diff(u)
        v += tau * (np.append(pull, 0) - np.append(0, pull) - 0.02 * m) / m
        free, now = g + u[0] + dt * v[0], g + u[0]
        push = -0.5 * beta * ((1 + a) * free + (1 - a) * min(last, 0))
        push = max(push, 0) / (1 + 0.5 * beta * (1 + a) * dt * tau / m[0])
        v[0] += tau * push / m[0]
        forces.append(push)
        last, here, u = now, u.copy(), u + dt * v
    start = np.flatnonzero(np.diff(np.array(forces) > 0)).size
    assert start > 3  # it closes and opens again and again
    x = run.state["bar"].displacement[:, 0]
    places = run.state["bar"].nodes[:, 0] - g
    assert np.abs(x - here[np.rint(places).astype(int)]).max() < 1e-12


def test_an_elastic_cube_comes_to_rest_by_damping_alone():
    """The example of the chapter "Enforcement": the force on the floor after 1000 time units, over the weight."""
    off = {}
    for rate in (None, 0.02):
        scene = scene_with("m", young=1.0, poisson=0.3, density=1.0, title="cube")
        scene.add_body("cube", material="m", box=box_of([0, 0, 0.02], [4, 4, 4], [4, 4, 4]))
        scene.add("gravity", acceleration=[0, 0, -1e-4])
        plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        scene.add("obstacle", surface="cube.z_min", plane=plane)
        if rate:
            scene.add("damping", rate=rate)
        scene.set_time(end=1500.0, fraction=0.9).set_output(every=4, fields=[])
        run = scene.run(output=False)
        impulse = run.body_momentum("cube")["obstacle_impulse"][:, 2]
        force = np.diff(impulse) / np.diff(run.time) / (64 * 1e-4)
        off[rate] = np.abs(force[run.time[1:] > 1000.0] - 1.0).max()
    assert off[0.02] < 1e-3 and off[None] > 0.5
