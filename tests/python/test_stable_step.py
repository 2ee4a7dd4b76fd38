"""Reported over true stable step on regular meshes, for the integrators that the price list compares. The true step
comes from all eigenvalues of the assembled matrices and from runs just below and above it."""

import numpy as np
import pytest
import steps
from scenes import box_of, scene_with

# A cube, one layer as in the plates, and flat bricks; edges that are not powers of two.
SHAPES = {
    "cube": ((3, 3, 3), (3.0, 3.0, 3.0)),
    "layer": ((5, 1, 5), (5.0, 1.0, 5.0)),
    "flat": ((3, 3, 3), (3.0, 3.0, 0.6)),
}
ELEMENTS = {
    "hex8": {},
    "one-point": {"integration": "reduced"},
    "one-point, stiff": {"integration": "reduced", "hourglass": 3.2308},
    "hex20": {"element": "hex20"},
}
LIMITS = {"tchamwa_wielgosz": 2 / np.sqrt(4 / 1.9 - 1)}
BLOWN = 1e3


def built(shape, element, nu, integrator="central_difference"):
    cells, size = SHAPES[shape]
    made = scene_with("elastic", young=1.0, poisson=nu, density=1.0)
    box = {"size": list(size), "cells": list(cells)}
    made.add_body("block", material="elastic", box=box, **ELEMENTS[element])
    return made.set_time(end=1.0, fraction=0.5, integrator=integrator)._built(None)


def check(problem, true):
    """Sharp, never above the true step; runs of 1000 steps agree."""
    reported = problem.stable.dt
    assert 0.95 <= reported / true <= 1 + 1e-9
    assert steps.growth(problem, 0.999 * reported, 1000) < BLOWN
    assert steps.growth(problem, 1.02 * true, 2000) > BLOWN


@pytest.mark.parametrize("nu", [0.2, 0.3, 0.45])
@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("shape", SHAPES)
def test_integrators(shape, element, nu):
    omega = steps.largest_omega(built(shape, element, nu))
    for integrator, limit in LIMITS.items():
        problem = built(shape, element, nu, integrator)
        check(problem, limit / omega)


def thrown(n, friction, fraction=0.9):
    """A block of n³ bricks and of size 0.6 is thrown obliquely on one of size 1 and equally many."""
    made = scene_with("steel", young=2.1e11, poisson=0.3, density=7800.0)
    for name, low, edge, velocity in (
        ("slab", [0, 0, 0], 1.0, [0, 0, 0]),
        ("block", [0.2, 0.2, 1.0], 0.6, [2.0, 0, -1.0]),
    ):
        box = box_of(low, [edge] * 3, [n] * 3)
        made.add_body(name, material="steel", element="hex8", box=box, velocity=velocity)
    rub = {"friction": friction} if friction else {}
    # Stored impact, restitution 1, is paid back in other steps at a tiny step; here friction is compared.
    made.add_contact("slab.outer", "block.outer", restitution=0.0, **rub)
    made.add_support("slab.z_min", fix=["x", "y", "z"])
    return made.set_time(end=1.2e-3, fraction=fraction)


@pytest.mark.parametrize("n", [4, 12])
def test_friction_leaves_the_step(n):
    """eq:slip-work: the proof holds for every step."""
    rough, free = (thrown(n, friction)._built(None).stable.dt for friction in (0.3, 0.0))
    assert rough == free


def test_a_thrown_block_slides_as_with_a_tiny_step():
    """Slip and rebound at the default step and at one 18 times smaller, and no energy appears."""
    found = []
    for fraction in 0.9, 0.05:
        run = thrown(4, 0.3, fraction).run(output=False)
        energy = run.energy["total"]
        assert energy.max() <= energy[0] * (1.0 + 1e-9)
        momentum = run.body_momentum("block")["p"][-1]
        found.append((run.state["block"].displacement[:, 0].mean(), momentum[0], momentum[2]))
    assert found[0] == pytest.approx(found[1], rel=1e-2)
