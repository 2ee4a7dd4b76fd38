"""Equations of contact, its laws, obstacles and friction, written again from the pages and compared with the
library."""

import numpy as np
import pytest
from executes import executes
from libcontact._core import ffi, lib
from test_equations_bodies import Model
from test_equations_faces import close, rule, shape_q4

import libcontact as ct

RNG = np.random.default_rng(20)
EPSILON = 50.0
# Two bent faces, the upper one turned over and slightly inside the lower one.
LOWER = np.array([[-2.0, -2, 0], [2, -2, 0.1], [2, 2, 0], [-2, 2, 0.15]])
UPPER = np.array([[-1.0, -1, -0.05], [-1.1, 1, 0.02], [1, 1.2, 0.2], [1.2, -1, 0.03]])
REFERENCE = (UPPER + [0, 0, 0.5], LOWER)


def touching(x):
    """The contact of both faces with the explicit penalty at the coordinates x, and its forces."""
    surfaces = [ct.Surface("Q4", nodes, [[0, 1, 2, 3]]) for nodes in REFERENCE]
    contact = ct.Contact(
        *surfaces, epsilon=EPSILON, enforcement="penalty", initial_penetration="force", depth=1.0
    )
    still, free = np.zeros((4, 3)), np.ones((4, 3))
    contact.step(1e-3, x, (still, still), (free, free))
    forces = np.zeros((4, 3)), np.zeros((4, 3))
    contact.add_force(forces)
    return contact, forces


@executes("gap", "contact-penalty", "contact-potential", "contact-force")
def test_gaps_potential_and_forces():
    x = UPPER, LOWER
    contact, forces = touching(x)
    xi, weight = rule(lib.CT_Q4)
    expected, potential = [np.zeros((4, 3)), np.zeros((4, 3))], 0.0
    for point in contact.points:
        side = point["side"]
        N = shape_q4(xi[point["point"]])
        y = N @ x[side]
        if point["other"] < 0:
            continue
        found = ct.project("Q4", x[1 - side], [y], method="certified")
        closest = found.point[0]
        a = shape_q4(found.xi[0] + [0.5, 0]) - shape_q4(found.xi[0] - [0.5, 0])
        b = shape_q4(found.xi[0] + [0, 0.5]) - shape_q4(found.xi[0] - [0, 0.5])
        d, n = closest - y, np.cross(a @ x[1 - side], b @ x[1 - side])
        g = -np.linalg.norm(d) if d @ n > 0 else np.linalg.norm(d)
        close(point["gap"], g, 1e-9)
        close(point["raw_pressure"], EPSILON * max(-g, 0), 1e-9)
        potential += 1 / 2 * 1 / 2 * EPSILON * max(-g, 0) ** 2 * point["weight"]
        if g < 0:
            F = EPSILON * point["weight"] * d / 2
            expected[side] += np.outer(N, F)
            expected[1 - side] -= np.outer(shape_q4(found.xi[0]), F)
    assert potential > 0
    close(contact.energy, potential, 1e-10)
    for found, wanted in zip(forces, expected):
        close(found, wanted, 1e-9)


@executes("contact-force", "gap-variation")
def test_forces_are_the_gradient_of_the_potential():
    _, forces = touching((UPPER, LOWER))
    for side, a, c in [(0, 0, 2), (0, 1, 0), (0, 1, 2), (1, 0, 2), (1, 3, 1)]:
        energies = []
        for step in (1e-5, -1e-5):
            x = [UPPER.copy(), LOWER.copy()]
            x[side][a, c] += step
            energies.append(touching(x)[0].energy)
        close(forces[side][a, c], -(energies[0] - energies[1]) / 2e-5, 1e-7)


# -- Laws: a flat plate of mass 2 falls on a fixed one

SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], float)
MASS, DT, ZETA = 2.0, 0.02, 0.15
STIFFNESS = EPSILON * 2.0  # of the whole face, the area is 2


def fall(enforcement, steps=40):
    """Gaps g_n, total force, energy and work of the contact at all steps."""
    turned = [[0, 3, 2, 1]]
    contact = ct.Contact(
        ct.Surface("Q4", SQUARE + [0, 0, 0.1], turned),
        ct.Surface("Q4", SQUARE, [[0, 1, 2, 3]]),
        epsilon=EPSILON,
        enforcement=enforcement,
        dissipation=ZETA,
        restitution=0.0,
    )
    x, v, rows = SQUARE + [0, 0, 0.05], np.zeros((4, 3)), []
    v[:, 2] = -1.0
    for n in range(steps):
        kick = DT if n else DT / 2
        held, force = np.zeros((4, 3)), np.zeros((4, 3))
        contact.step(DT, (x, SQUARE), (v, held), (np.full((4, 3), 4 / MASS), held), force_time=kick)
        contact.add_force((force, held))
        before = v.copy()
        v = v + kick * force * 4 / MASS
        rows.append(
            (
                x[0, 2],
                force[:, 2].sum(),
                contact.energy,
                contact.balance.work,
                before[0, 2],
                v[0, 2],
            )
        )
        x = x + DT * v
    return np.array(rows).T


@pytest.mark.parametrize("enforcement", ["penalty", "energy_controlled"])
@executes("contact-penalty", "energy-controlled", "surface-damping")
def test_law(enforcement):
    g, force, *_ = fall(enforcement)
    before, now, after = g[:-2], g[1:-1], g[2:]
    a = ZETA * np.sqrt(1 + 4 / (STIFFNESS / MASS * DT**2))
    p = np.minimum(before, 0)
    expected = {
        "penalty": STIFFNESS * np.maximum(-now, 0),
        "energy_controlled": STIFFNESS * np.maximum(-((1 + a) * after + (1 - a) * p) / 2, 0),
    }[enforcement]
    assert np.count_nonzero(expected) > 5
    close(force[1:-1], expected, 1e-9)


@executes(
    "host-step",
    "host-work",
    "contact-step-work",
    "controlled-store",
    "controlled-energy",
    "controlled-loss",
)
def test_energy_of_the_controlled_law():
    g, force, energy, work, before, after = fall("energy_controlled")
    potential = STIFFNESS * np.maximum(-g, 0) ** 2 / 2
    store = (potential[:-1] + potential[1:]) / 2
    inner = slice(1, -1)
    expected = (store[:-1] + store[1:]) / 2 + force[inner] * (g[2:] - 2 * g[1:-1] + g[:-2]) / 4
    close(energy[inner], expected, 1e-10)
    # Work up to t_n: whole steps, the first of them half, and the half of this one.
    kick = np.full(len(g), DT)
    kick[0] = DT / 2
    whole = np.cumsum(kick * force * (before + after) / 2) - kick * force * (before + after) / 2
    close(work, whole + kick * force * before / 2, 1e-10)
    # In one step λ (g_{n+1} - g_{n-1}) / 2, at most the decrease of the stored energy minus the dashpot's part.
    a = ZETA * np.sqrt(1 + 4 / (STIFFNESS / MASS * DT**2))
    done = force[inner] * (g[2:] - g[:-2]) / 2
    close(done, (DT * force * (before + after) / 2)[inner], 1e-10)
    p = np.minimum(g[:-2], 0)
    lost = a * STIFFNESS * (g[2:] - p) ** 2 / 4 * (force[inner] > 0)
    assert (done <= store[:-1] - store[1:] - lost + 1e-12).all()


@executes("penalty-default", "penalty-factor")
def test_penalties():
    close(ct.Contact.penalty_default(3.0, 0.5), 40 * 3.0 / 0.5)
    close(lib.ct_contact_penalty(4.0, 3.0, 0.5), 4.0 * 3.0 / 0.5)


@executes("contact-bound", "contact-stiffness")
def test_bound_of_the_contact():
    """The plate's nodes in contact with a floor that is too heavy to move."""
    contact = ct.Contact(
        ct.Surface("Q4", SQUARE + [0, 0, 0.1], [[0, 3, 2, 1]]),
        ct.Surface("Q4", SQUARE, [[0, 1, 2, 3]]),
        epsilon=EPSILON,
        enforcement="penalty",
    )
    mass = np.array([0.5, 0.4, 0.7, 0.6])
    xi, weight = rule(lib.CT_Q4)
    k, N = EPSILON * weight * 0.5 / 2, np.array([shape_q4(each) for each in xi])
    # b has the plate's N and minus the floor's, so that Σ|b| is 2; and both passes have such points.
    both = 2 * (sum(k[p] * np.abs(N[p]) * 2 for p in range(len(k))) / mass).max()
    heavy = np.full(4, 1e30)
    close(contact.stable_step((mass, heavy)), 2 / np.sqrt(both), 1e-9)


# -- Obstacles


def resting(**obstacle):
    """A cube of hex8 that has a large obstacle inside its lower face at t = 0 and is pushed: force and energy at the
    start."""
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=1.0, poisson=0.3, density=1.0)
    made.add_body("body", material="elastic", box={"size": [1, 1, 1], "cells": [1, 1, 1]})
    given = {"epsilon": EPSILON, "enforcement": "penalty", "initial_penetration": "force"}
    made.add("obstacle", surface="body.z_min", **given, **obstacle)
    model = Model(made.set_time(end=1.0, fraction=0.1))
    which, error = model.problem.effects.index("obstacle"), ffi.new("ct_error *")
    force, energy = np.zeros((8, 3)), ffi.new("double *")
    cast, pointer = ffi.cast("double *", force.ctypes.data), model.problem.pointer
    assert lib.ct_state_force(pointer, model.state, which, cast, error) == lib.CT_OK
    assert lib.ct_energy_stored(pointer, model.state, which, energy, error) == lib.CT_OK
    return model.problem.rows(pointer.reference).copy(), force, energy[0]


SHAPES = {
    "plane": {"point": [0, 0, 0.1], "normal": [0.1, 0.2, 1]},
    "sphere": {"centre": [0.4, 0.5, -1.9], "radius": 2.0},
    "cylinder": {"centre": [0, 0.5, -1.9], "radius": 2.0, "axis": [1, 0.1, 0]},
}


@pytest.mark.parametrize("shape", SHAPES)
@executes("obstacle-gap", "obstacle-potential", "obstacle-force")
def test_obstacles(shape):
    given = SHAPES[shape]
    X, force, energy = resting(**{shape: given})
    a = np.array(given.get("normal", given.get("axis", [0, 0, 1])), float)
    a /= np.linalg.norm(a)
    centre, R = np.array(given.get("point", given.get("centre"))), given.get("radius", 0)
    xi, weight = rule(lib.CT_Q4)
    side = np.array(
        [
            np.flatnonzero(np.all(X == [x, y, 0], axis=1))[0]
            for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
        ]
    )
    expected, potential = np.zeros_like(force), 0.0
    for each, w in zip(xi, weight / 4):
        N = shape_q4(each)
        r = N @ X[side] - centre
        if shape == "plane":
            g, n = r @ a, a
        else:
            across = r - (r @ a) * a if shape == "cylinder" else r
            g, n = np.linalg.norm(across) - R, across / np.linalg.norm(across)
        if g < 0:
            expected[side] += np.outer(N, EPSILON * w * -g * n)
            potential += EPSILON * g**2 * w / 2
    assert potential > 0
    close(force, expected, 1e-11)
    close(energy, potential, 1e-11)


# -- Friction


@executes(
    "slip-residual",
    "slip-set",
    "slip-projection",
    "slip-store",
    "slip-work",
    "slip-stick",
    "slip-row",
    "friction-dissipation",
)
def test_friction_of_a_plate_that_is_moved():
    """A plate is pressed on another by 0.01 and moved back and forth, ever deeper: force, slips and dissipation."""
    mu, rho, dt = 0.3, 0.6, 0.01
    wide = SQUARE * [20, 20, 1] - [20, 10, 0]
    contact = ct.Contact(
        ct.Surface("Q4", SQUARE + [0, 0, 0.1], [[0, 3, 2, 1]]),
        ct.Surface("Q4", wide, [[0, 1, 2, 3]]),
        epsilon=EPSILON,
        enforcement="penalty",
        friction=mu,
        tangent=rho,
        initial_penetration="force",
    )
    x, held = SQUARE - [0, 0, 0.01], np.zeros((4, 3))
    e, before, c, reserve, store, lost = np.zeros(2), np.zeros(2), np.zeros(2), 0.0, 0.0, 0.0
    seen = {"slip": 0, "stick": 0, "cut": 0}
    for n in range(60):
        v = np.zeros((4, 3))
        v[:, 0], v[:, 1], v[:, 2] = (0.12, 0.05, -0.05) if n < 30 else (-0.12, 0.02, -0.05)
        force = np.zeros((4, 3))
        contact.step(dt, (x, wide), (v, held), (held, held))
        contact.add_force((force, np.zeros((4, 3))))
        points = contact.points[contact.points["side"] == 0]
        k = rho * EPSILON * points["weight"].sum() / 2
        limit = mu * force[:, 2].sum()
        # Prescribed motion, without a mass: a = 0.
        D = last = dt * v[0, :2]
        C = 2.0 / k
        c = np.zeros(2) if c is None else last - (e - before)
        given = -(D + e + before) / C
        T = given * min(1.0, limit / np.linalg.norm(given))
        if c @ c > 0.0 and T @ c > 2.0 * reserve * (1 + 1e-12):
            foot, along = 2.0 * reserve / (c @ c) * c, given - (given @ c) / (c @ c) * c
            half = np.sqrt(limit**2 - foot @ foot)
            T = foot + along * min(1.0, half / np.linalg.norm(along))
            seen["cut"] += 1
        found = force[:, :2].sum(axis=0)
        assert np.abs(found - T).max() < 5e-4 * limit  # the tolerance of the solver
        T = found
        slip = D + C * T + e + before
        # Within the disc, but for rounding, or not opposite to the slip.
        may = np.linalg.norm(T) < limit * (1 - 1e-9) or T @ slip >= 0.0
        sticks = may and np.linalg.norm(slip) <= 1e-3 * C * np.abs(T).max()
        seen["stick" if sticks else "slip"] += 1
        e, before = (e + D if sticks else -C * T - before), e
        reserve, c = (0.0, None) if sticks else (-0.5 * T @ slip, slip)
        after = 0.25 * k * (e @ e + before @ before) + reserve
        step = store - after - 0.5 * T @ (D + last)
        assert step > -1e-3 * store
        told, lost, store = lost + 0.5 * step, lost + step, after
        x = x + dt * v
    assert seen["slip"] > 10 and seen["stick"] > 3 and seen["cut"] > 0, seen
    close(contact.balance.friction, told, 1e-9)
