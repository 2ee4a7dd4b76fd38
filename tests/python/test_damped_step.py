"""The stable step with damping, compared with the amplification matrix of small meshes: elements, masses and dashpots
are assembled here; only the step comes from the library."""

import itertools

import numpy as np
import pytest
from scenes import scene_with

CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
SIGNS = 2 * CORNERS - 1
BARS = {"bar of 1 x 1": (6, 1, 1), "bar of 2 x 2": (4, 2, 2)}
NUS = (0.0, 0.3, 0.45)
# Growth in a step above which a motion grows; rigid motions are double roots, known to 1e-8.
GROWTH = 1e-6
# Beyond its parabola the quadratic part is as steep as a linear one with this coefficient.
STEEPEST = 0.06


def mesh(cells, shaken=0.0):
    """Nodes and elements of unit cubes; ``shaken``: each node is moved by up to this."""
    grid = [np.arange(n + 1) for n in cells]
    nodes = np.stack(np.meshgrid(*grid, indexing="ij"), -1).reshape(-1, 3).astype(float)
    at = np.arange(len(nodes)).reshape([n + 1 for n in cells])
    elements = [at[tuple((np.array(c) + CORNERS).T)] for c in itertools.product(*map(range, cells))]
    nodes += np.random.default_rng(1).uniform(-shaken, shaken, nodes.shape)
    return nodes, np.array(elements, np.int32)


def shapes(x, xi):
    """Shape values, their gradients and the Jacobian of a brick."""
    factors = 1 + SIGNS * xi
    values = factors.prod(1) / 8
    slopes = SIGNS / 8 * factors[:, [1, 0, 0]] * factors[:, [2, 2, 1]]
    jacobian = x.T @ slopes
    return values, slopes @ np.linalg.inv(jacobian), np.linalg.det(jacobian)


class Body:
    """Matrices of a mesh of hex8 with Young's modulus `young` and density 1, and of its dashpots."""

    def __init__(self, nodes, elements, nu, young=1.0):
        lam, mu = young * nu / (1 + nu) / (1 - 2 * nu), young / 2 / (1 + nu)
        self.c1, self.c2 = np.sqrt(lam + 2 * mu), np.sqrt(mu)
        self.nodes, n = nodes, nodes.size
        self.stiffness, self.mass, self.viscous = np.zeros((n, n)), np.zeros(n), np.zeros((n, n))
        for element in elements:
            dofs = (3 * element[:, None] + np.arange(3)).ravel()
            volume, mean = 0.0, np.zeros(24)
            for xi in SIGNS / np.sqrt(3):
                values, g, jacobian = shapes(nodes[element], xi)
                # σ = λ tr ε 1 + 2 μ ε: the stiffness of nodes a and b is λ ga gb + μ (gb ga + ga·gb 1).
                tensor = np.einsum("ai,bj->aibj", g, g)
                local = lam * tensor + mu * np.einsum("ai,bj->ajbi", g, g)
                local += mu * np.einsum("ab,ij->aibj", g @ g.T, np.eye(3))
                self.stiffness[np.ix_(dofs, dofs)] += jacobian * local.reshape(24, 24)
                self.mass[dofs] += jacobian * np.repeat(values, 3)
                volume += jacobian
                mean += jacobian * g.ravel()
            mean /= volume
            edge = np.sqrt(1.5 / (mean @ mean))
            self.viscous[np.ix_(dofs, dofs)] += edge * self.c1 * volume * np.outer(mean, mean)
        self.damping = np.zeros((n, n))

    def absorb_at_end(self):
        """Dashpots of :eq:`absorb-force` on the unit squares of x = max."""
        x, y, z = self.nodes.T
        sides = [np.isin(one, (one.min(), one.max())).astype(int) for one in (y, z)]
        areas = np.where(x == x.max(), 0.5 ** sum(sides), 0.0)
        self.damping += np.diag(np.outer(areas, (self.c1, self.c2, self.c2)).ravel())

    def grows(self, dt, inverse=None, r=1.0):
        """Whether the largest root of a step with the velocity half a step earlier is above 1; `inverse`: of the mass;
        `r`: of the drift of :eq:`stage`."""
        inverse = np.diag(1 / self.mass) if inverse is None else inverse
        one, zero = np.eye(len(self.mass)), np.zeros_like(self.damping)
        velocity, displacement = np.hstack([one, zero]), np.hstack([zero, one])
        solid, lag = dt * inverse @ self.stiffness, dt * inverse @ self.damping
        kick = -np.hstack([lag, solid])  # Δt a
        step = np.vstack([velocity + kick, displacement + dt * (velocity + r * kick)])
        return abs(np.linalg.eigvals(step)).max() > 1 + GROWTH


def scene(nu, young=1.0, **body):
    made = scene_with("elastic", young=young, poisson=nu, density=1.0)
    return made.add_body("bar", material="elastic", **body)


def box(cells):
    return {"box": {"size": [float(n) for n in cells], "cells": list(cells)}}


def stable(made, **time):
    return made.set_time(end=1.0, fraction=0.5, **time).explain().data["time"]["stable"]


def damped(nu, cells, linear, quadratic, rate):
    """A bar with viscosity and dampers, as a scene and by its matrices."""
    made, body = scene(nu, **box(cells)), Body(*mesh(cells), nu)
    if linear:
        made.add("viscosity", linear=linear, quadratic=quadratic)
        body.damping += (linear + (STEEPEST if quadratic else 0.0)) * body.viscous
    if rate:
        made.add("damping", rate=rate)
        body.damping += rate * np.diag(body.mass)
    return made, body


@pytest.mark.parametrize("nu", NUS)
@pytest.mark.parametrize("cells", BARS.values(), ids=BARS)
def test_bars_with_dashpots_of_each_kind(cells, nu):
    """The reported step is stable (eq:damped-step-bound): viscosity weak, default with the steepest quadratic part, and
    strong, dampers, an absorbing end, and all together. A slightly larger one is not: by 5 %, and with strong viscosity
    by 7 %."""
    viscosities = [(0.0, 0.0), (0.03, 0.0), (0.06, 1.2), (0.5, 0.0)]
    for (linear, quadratic), rate, absorbs in itertools.product(viscosities, (0.0, 0.7), (0, 1)):
        made, body = damped(nu, cells, linear, quadratic, rate)
        if absorbs:
            made.add("absorb", surface="bar.x_max")
            body.absorb_at_end()
        dt, case = stable(made), (linear, quadratic, rate, absorbs)
        assert not body.grows(dt), case
        # An absorbing end is bounded apart from the elements.
        if not absorbs:
            assert body.grows(dt / (0.93 if linear > 0.12 else 0.95)), case


@pytest.mark.parametrize("nu", NUS)
@pytest.mark.parametrize("cells", BARS.values(), ids=BARS)
def test_dashpots_with_tchamwa_and_wielgosz(cells, nu):
    """Tchamwa and Wielgosz at their reported step."""
    for (linear, quadratic), rate in itertools.product(
        [(0.0, 0.0), (0.06, 1.2), (0.5, 0.0)], (0.0, 0.7)
    ):
        made, body = damped(nu, cells, linear, quadratic, rate)
        dt, r = stable(made, integrator="tchamwa_wielgosz"), 2 / 1.9
        assert not body.grows(dt, r=r), (linear, rate)
        sharp = 0.93 if linear > 0.12 else 0.95
        assert body.grows(dt / sharp, r=r), (linear, rate)


@pytest.mark.parametrize("nu", NUS)
@pytest.mark.parametrize("cells", [(5, 1, 5), (4, 4, 4), (6, 1, 6)])
def test_viscosity_in_layers_and_cubes(cells, nu):
    """:eq:`joint-bound` and :eq:`joint-step` compared with the definiteness of the assembled 4 M - 2 Δt C - Δt² K, for
    the coefficients of the price list but the strongest."""
    body = Body(*mesh(cells), nu)
    for linear in (0.03, 0.06, 0.12):

        def definite(dt):
            matrix = -2 * dt * linear * body.viscous - dt**2 * body.stiffness
            return np.linalg.eigvalsh(matrix + 4 * np.diag(body.mass))[0] > 0

        dt = stable(scene(nu, **box(cells)).add("viscosity", linear=linear, quadratic=0.0))
        assert definite((1 - 1e-9) * dt) and not definite(dt / 0.95), linear


@pytest.mark.parametrize("nu", NUS)
@pytest.mark.parametrize("cells", BARS.values(), ids=BARS)
def test_distorted_bars_and_two_materials(cells, nu):
    """The reported step is stable for both bodies."""
    nodes, elements = mesh(cells, shaken=0.2)
    for linear, quadratic in ((0.03, 0.0), (0.06, 1.2), (0.5, 0.0)):
        made = scene(nu, nodes=nodes, elements=elements)
        made.add_material("other", young=2.0, poisson=0.45 - nu, density=1.0)
        made.add_body("beside", material="other", nodes=nodes + [0, 9, 0], elements=elements)
        made.add("viscosity", linear=linear, quadratic=quadratic)
        bodies = Body(nodes, elements, nu), Body(nodes, elements, 0.45 - nu, young=2.0)
        dt = stable(made)
        for body in bodies:
            body.damping += (linear + (STEEPEST if quadratic else 0.0)) * body.viscous
            assert not body.grows(dt), (linear, quadratic)


@pytest.mark.parametrize("cells", [(50, 1, 1), (50, 2, 2)])
@pytest.mark.parametrize("speed", [0.1, 0.3])
def test_a_front_that_the_start_does_not_show(cells, speed):
    """A bar in free flight, not compressed at the start, hits a wall with the speed of a wave; quadratic viscosity at
    the whole step. Energy must not grow."""
    made = scene(0.0, **box(cells), velocity=[-speed, 0, 0]).add("viscosity", linear=0.03)
    made.add("obstacle", surface="bar.x_min", plane={"point": [0, 0, 0], "normal": [1, 0, 0]})
    run = made.set_time(end=150.0, fraction=1.0).set_output(every=1).run()
    total = run.energy["total"]
    assert total.max() < total[0] * (1 + 1e-12) and run.energy["viscosity"][-1] < -0.01 * total[0]


@pytest.mark.parametrize("nu", NUS)
def test_assembled_bound_is_the_largest_eigenvalue_and_its_margin(nu):
    """:eq:`assembled-operator` and :eq:`assembled-bound`: on a small distorted bar Lanczos' method converges, and the
    step has the margin of 6 % in ω²."""
    nodes, elements = mesh((4, 2, 1), shaken=0.2)
    body = Body(nodes, elements, nu)
    root = 1 / np.sqrt(body.mass)
    largest = np.linalg.eigvalsh(root[:, None] * body.stiffness * root)[-1]
    made = scene(nu, nodes=nodes, elements=elements)
    by_elements = stable(made)
    made.set_time(end=1.0, fraction=0.5, stable_step="assembled")
    reported = made.explain().data["time"]["stable"]
    assert reported == pytest.approx(2 * np.sqrt(0.94 / largest), rel=1e-9)
    assert reported > 1.05 * by_elements
