"""Equations of materials, masses, elements and loads, written again from the pages and compared with the forces of the
library."""

import numpy as np
import pytest
from executes import executes
from libcontact._core import ffi, lib
from libcontact.model import LAWS
from libcontact.problem import new_state
from test_equations_faces import BRICK, close, gauss, shape_hex8, shape_q4

import libcontact as ct

RNG = np.random.default_rng(18)
E, NU, RHO = 3.0, 0.3, 2.0
LAMBDA = E * NU / ((1 + NU) * (1 - 2 * NU))
MU = E / (2 * (1 + NU))
ONE = np.eye(3)
BOX = (BRICK + 1) / 2 * [1.2, 0.8, 0.9]
BENT = BOX + RNG.uniform(-0.1, 0.1, (8, 3))
U = RNG.uniform(-0.05, 0.05, (8, 3))
V = RNG.uniform(-1, 1, (8, 3))


def scene(nodes=BENT, law="linear", elements=(tuple(range(8)),), **body):
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=E, poisson=NU, density=RHO, law=law)
    made.add_body("body", material="elastic", nodes=nodes, elements=np.array(elements), **body)
    return made.set_time(end=1.0, fraction=0.5)


class Model:
    """The effects of a scene, with force and energy of each at a displacement and a velocity."""

    def __init__(self, made):
        self.problem = made._built(1)
        self.state = new_state(self.problem)
        self.count = self.problem.pointer.node_count

    @property
    def mass(self):
        return np.array([self.problem.pointer.mass[i] for i in range(self.count)])

    def rate(self, name):
        """The damping rate that an effect gives to the bound of the step."""
        effect, out = self.problem.made[self.problem.effects.index(name)], ffi.new("double *")
        assert (
            effect.calls.bounds.rate(effect, ffi.new("ct_view *"), out, ffi.new("ct_error *"))
            == lib.CT_OK
        )
        return out[0]

    def ask(self, name, u, v=None, time=0.0):
        """Force on all nodes, and the energy if the effect stores any."""
        effect = self.problem.made[self.problem.effects.index(name)]
        keep = {
            "displacement": np.ascontiguousarray(u, float),
            "velocity": np.zeros((self.count, 3)) if v is None else np.ascontiguousarray(v, float),
            "total": np.zeros((self.count, 3)),
            "memory": np.zeros(effect.memory_count + 1),
            "next_memory": np.zeros(effect.memory_count + 1),
        }
        view = ffi.new("ct_view *", {"time": time, "dt": 0.01, "c_dt": 0.01, "r_dt": 0.01})
        view.reference = self.problem.pointer.reference
        for key, array in keep.items():
            setattr(view, key, ffi.cast("double *", array.ctypes.data))
        scratch, error = ffi.new("void **"), ffi.new("ct_error *")
        if effect.calls.create_scratch != ffi.NULL:
            assert effect.calls.create_scratch(effect, scratch, error) == lib.CT_OK
            view.scratch = scratch[0]
        rows = effect.node_count
        force, energy = np.zeros((rows, 3)), ffi.new("double *")
        assert (
            effect.calls.force(effect, view, ffi.cast("double *", force.ctypes.data), error)
            == lib.CT_OK
        )
        if effect.calls.energy != ffi.NULL:
            assert effect.calls.energy(effect, view, energy, error) == lib.CT_OK
        if scratch[0] != ffi.NULL:
            effect.calls.free_scratch(scratch[0])
        out = np.zeros((self.count, 3))
        at = range(rows) if effect.nodes == ffi.NULL else [effect.nodes[i] for i in range(rows)]
        out[at] = force
        return out, energy[0]


def slopes(xi):
    """∂N_a/∂ξ_j of hex8 by differences, which are exact for a line."""
    steps = 0.5 * ONE
    return np.array([shape_hex8(xi + s, BRICK) - shape_hex8(xi - s, BRICK) for s in steps]).T


def points(nodes, n=2):
    """At the Gauss points of a brick: shape functions, their gradients in space, weight times det J."""
    x, w = gauss(n)
    for i in range(n):
        for j in range(n):
            for k in range(n):
                xi = np.array([x[i], x[j], x[k]])
                J = nodes.T @ slopes(xi)
                yield (
                    shape_hex8(xi, BRICK),
                    slopes(xi) @ np.linalg.inv(J),
                    w[i] * w[j] * w[k] * np.linalg.det(J),
                )


def hooke(G):
    strain = (G + G.T) / 2
    return LAMBDA * np.trace(strain) * ONE + 2 * MU * strain


# -- Material and mass


@executes("lame", "wave-speeds")
def test_wave_speeds():
    material = ffi.new("ct_material *", {"young": E, "poisson": NU, "density": RHO})
    c1, c2 = ffi.new("double *"), ffi.new("double *")
    lib.ct_material_speeds(material, c1, c2)
    close(c1[0], np.sqrt((LAMBDA + 2 * MU) / RHO))
    close(c2[0], np.sqrt(MU / RHO))


@executes("jacobian", "mass-consistent", "row-sum", "hrz")
def test_lumped_masses_of_a_bent_brick():
    M = sum(RHO * weight * np.outer(N, N) for N, _, weight in points(BENT))
    close(Model(scene(lumping="row_sum")).mass, M.sum(axis=1))
    close(Model(scene(lumping="hrz")).mass, M.sum() / np.trace(M) * np.diag(M))


@executes("mass-hex20")
def test_masses_of_a_box_of_20_nodes():
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=E, poisson=NU, density=RHO)
    made.add_body(
        "body", material="elastic", element="hex20", box={"size": [1, 2, 3], "cells": [1, 1, 1]}
    )
    mass, whole = Model(made.set_time(end=1.0)).mass, 6 * RHO
    close(np.sort(mass), np.repeat([7 / 248, 2 / 31], [8, 12]) * whole)


# -- Elements


def internal_force(nodes, u, stress):
    """-∫ σ_ij ∂N_a/∂x_j dV with the stress of a displacement gradient."""
    return -sum(
        weight * gradient @ stress(u.T @ gradient).T for _, gradient, weight in points(nodes)
    )


@executes(
    "hooke", "material-law", "internal-force", "solid-energy", "stiffness", "reference-stress"
)
def test_force_and_energy_of_a_brick():
    force, energy = Model(scene()).ask("solid", U)
    close(force, internal_force(BENT, U, hooke))
    close(energy, -np.sum(force * U) / 2)
    K = 0
    for _, g, weight in points(BENT):
        K = K + weight * (
            LAMBDA * np.einsum("ai,bj->aibj", g, g)
            + MU * np.einsum("aj,bi->aibj", g, g)
            + MU * np.einsum("ij,ak,bk->aibj", ONE, g, g)
        )
    close(force, -np.einsum("aibj,bj->ai", K, U))


@executes("box-gradient", "box-moments", "box-stress", "box-force", "brick-modes")
def test_force_of_a_box_by_its_modes():
    """The forces of the eight modes of u, written with their moments, in place of Gauss points."""
    V, k = np.prod(BOX[6]), 1 / (4 * BOX[6])
    m = {"1": (0, 0, 0), "x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1)}
    m |= {"xy": (1, 1, 0), "yz": (0, 1, 1), "zx": (1, 0, 1), "xyz": (1, 1, 1)}
    signs = {name: np.prod(BRICK ** np.array(power), axis=1) for name, power in m.items()}
    modes = {name: sign @ U for name, sign in signs.items()}
    # ∂u/∂x_j is a sum over modes: (mode in the gradient, mode of u).
    parts = [
        [("1", "x"), ("y", "xy"), ("z", "zx"), ("yz", "xyz")],
        [("1", "y"), ("x", "xy"), ("z", "yz"), ("zx", "xyz")],
        [("1", "z"), ("x", "zx"), ("y", "yz"), ("xy", "xyz")],
    ]
    moment = {"1": 1, "x": 1 / 3, "y": 1 / 3, "z": 1 / 3, "xy": 1 / 9, "yz": 1 / 9, "zx": 1 / 9}
    F = {name: np.zeros(3) for name in m}
    for place in moment:
        D = np.zeros((3, 3))
        for j, part in enumerate(parts):
            D[:, j] = sum(k[j] * modes[name] for at, name in part if at == place)
        s = hooke(D)
        for j, part in enumerate(parts):
            for at, name in part:
                if at == place:
                    F[name] += V * moment[place] * k[j] * s[:, j]
    expected = -sum(np.outer(signs[name], F[name]) for name in m)
    close(expected, internal_force(BOX, U, hooke))
    close(Model(scene(BOX, kernel="box")).ask("solid", U)[0], expected)


# S and W of each law from E, C and J.
STRESS = {
    "st_venant_kirchhoff": lambda E, C, J: LAMBDA * np.trace(E) * ONE + 2 * MU * E,
    "neo_hookean": lambda E, C, J: (
        MU * (ONE - np.linalg.inv(C)) + LAMBDA * (J - 1) * J * np.linalg.inv(C)
    ),
}
ENERGY = {
    "st_venant_kirchhoff": lambda E, C, J: LAMBDA * np.trace(E) ** 2 / 2 + MU * np.sum(E * E),
    "neo_hookean": lambda E, C, J: (
        MU * (np.trace(C) - 3) / 2 - MU * np.log(J) + LAMBDA * (J - 1) ** 2 / 2
    ),
}


def strain(G):
    F = ONE + G
    return (G + G.T + G.T @ G) / 2, F.T @ F, np.linalg.det(F)


def piola(law):
    return lambda G: (ONE + G) @ STRESS[law](*strain(G))


def stored(law, G):
    return ENERGY[law](*strain(G))


@pytest.mark.parametrize("law", [law for law in LAWS if law != "linear"])
@executes(
    "large-gradient",
    "green-lagrange",
    "st-venant-kirchhoff",
    "neo-hookean",
    "neo-hookean-stress",
    "piola",
    "large-force",
    "large-energy",
    "large-reference-stress",
)
def test_force_and_energy_at_large_deformation(law):
    u = 4 * U
    force, energy = Model(scene(law=law)).ask("solid", u)
    close(force, internal_force(BENT, u, piola(law)), 1e-12)
    close(energy, sum(w * stored(law, u.T @ g) for _, g, w in points(BENT)), 1e-12)


@pytest.mark.parametrize("law", LAWS)
@executes("cauchy", "hooke")
def test_stress_at_the_centre(law):
    """Cauchy's stress at large deformation."""
    u = np.ascontiguousarray(4 * U)
    out, error = np.zeros((1, 6)), ffi.new("ct_error *")
    given = ffi.cast("double *", u.ctypes.data)
    cast = ffi.cast("double *", out.ctypes.data)
    mesh = mesh_of(BENT)
    material = ffi.new("ct_material *", {"young": E, "poisson": NU, "density": RHO})
    material.law = LAWS[law]
    assert lib.ct_solid_stress(mesh[0], material, given, cast, error) == lib.CT_OK
    gradient = slopes(np.zeros(3)) @ np.linalg.inv(BENT.T @ slopes(np.zeros(3)))
    G = u.T @ gradient
    F = ONE + G
    sigma = hooke(G) if law == "linear" else piola(law)(G) @ F.T / np.linalg.det(F)
    close(out[0], sigma[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]], 1e-12)


def mesh_of(nodes):
    """A mesh of one brick for C, and the arrays that it points into."""
    x = ffi.new("double[]", list(np.ravel(nodes)))
    elements = ffi.new("int32_t[]", list(range(8)))
    given = {
        "kind": lib.CT_HEX8,
        "node_count": 8,
        "element_count": 1,
        "nodes": x,
        "elements": elements,
    }
    return ffi.new("ct_mesh *", given), x, elements


@executes(
    "mean-gradient",
    "hourglass-vector",
    "hourglass-amplitude",
    "hourglass-stiffness",
    "reduced-energy",
    "reduced-force",
)
def test_reduced_integration_with_hourglass_control():
    kappa = 0.3
    volume = sum(weight for _, _, weight in points(BENT))
    B = sum(weight * g for _, g, weight in points(BENT)) / volume
    G = U.T @ B
    patterns = [BRICK[:, 1] * BRICK[:, 2], BRICK[:, 2] * BRICK[:, 0], BRICK[:, 0] * BRICK[:, 1]]
    h = np.array([*patterns, np.prod(BRICK, axis=1)])
    gamma = h - (h @ BENT) @ B.T
    q = gamma @ U
    c = kappa * E * volume * np.sum(B * B) / 72
    force = -volume * B @ hooke(G) - c * gamma.T @ q
    model = Model(scene(integration="reduced", hourglass=kappa))
    found, _ = model.ask("solid", U)
    close(found, force, 1e-12)
    energy = volume * np.sum(hooke(G) * G) / 2 + c * np.sum(q * q) / 2
    close(-np.sum(found * U) / 2, energy, 1e-12)


# -- Forces


@executes("gravity-force", "damping-force")
def test_weight_and_dampers():
    made = scene().add("gravity", acceleration=[1, 2, -9.81]).add("damping", rate=0.7)
    model = Model(made)
    close(model.ask("gravity", U)[0], np.outer(model.mass, [1, 2, -9.81]))
    close(model.ask("damping", U, V)[0], -0.7 * model.mass[:, None] * V)


@pytest.mark.parametrize("speed", [0.05, 8.0, -1.0])
@executes("volume-rate", "element-length", "bulk-viscosity", "viscous-force")
def test_bulk_viscosity(speed):
    """In slow and in fast compression, where the quadratic part continues as a line, and none in expansion."""
    Q1, Q2, S = 0.1, 1.2, 0.06
    v = -speed * (BENT - BENT.mean(axis=0)) + 0.1 * speed * V
    volume = sum(weight for _, _, weight in points(BENT))
    B = sum(weight * g for _, g, weight in points(BENT)) / volume
    D = np.sum(B * v)
    length = np.sqrt(3 / (2 * np.sum(B * B)))
    c1 = np.sqrt((LAMBDA + 2 * MU) / RHO)
    x, most = length * abs(D), S * c1 / (2 * Q2**2)
    p = Q2**2 * x * x if x <= most else Q2**2 * most * (2 * x - most)
    q = RHO * (Q1 * c1 * x + p) if D < 0 else 0
    made = scene().add("viscosity", linear=Q1, quadratic=Q2)
    close(Model(made).ask("viscosity", 0 * U, v)[0], q * volume * B, 1e-12)


def cube():
    """A scene of one box, and the nodes of its face at x = max, around it."""
    made = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=E, poisson=NU, density=RHO)
    made.add_body("body", material="elastic", box={"size": list(BOX[6]), "cells": [1, 1, 1]})
    return made.set_time(end=1.0, fraction=0.5)


def around(model):
    """Coordinates of the nodes, and the four of x = max, counter-clockwise from outside."""
    X = model.problem.rows(model.problem.pointer.reference)
    side = np.flatnonzero(X[:, 0] > X[:, 0].max() - 1e-9)
    angle = np.arctan2(*(X[side] - X[side].mean(axis=0))[:, [2, 1]].T)
    return X, side[np.argsort(angle)]


def face_points(x):
    """At the Gauss points of a Q4: shape functions, their slopes, weight, and the vector y,1 × y,2."""
    s, w = gauss(2)
    for i in range(2):
        for j in range(2):
            xi, h = np.array([s[i], s[j]]), 0.5 * np.eye(2)
            slope = np.array([shape_q4(xi + d) - shape_q4(xi - d) for d in h])
            yield shape_q4(xi), w[i] * w[j], np.cross(*(slope @ x))


@executes("absorb-traction", "absorb-force", "absorb-share", "absorb-rate")
@pytest.mark.parametrize("turn", range(3))
def test_absorbing_faces(turn):
    """All six sides of a bent brick, whose normals have three components."""
    bent = np.roll(BENT, turn, axis=1)
    model = Model(scene(bent).add("absorb", surface="body.outer"))
    v = RNG.uniform(-1, 1, bent.shape)
    c1, c2 = np.sqrt((LAMBDA + 2 * MU) / RHO), np.sqrt(MU / RHO)
    dashpots = np.zeros((len(v), 3, 3))
    for axis, sign in ((axis, sign) for axis in range(3) for sign in (-1, 1)):
        side = np.flatnonzero(BRICK[:, axis] == sign)
        across = np.delete(BRICK[side], axis, axis=1)
        side = side[np.argsort(np.arctan2(across[:, 0], across[:, 1]))]
        area = [(N, w * np.linalg.norm(a), a) for N, w, a in face_points(bent[side])]
        share = sum(A * N**2 for N, A, _ in area)
        for phi, a in zip(share / share.sum(), side):
            for _, A, n in area:
                along = np.outer(n, n) / (n @ n)
                dashpots[a] += phi * A * RHO * (c1 * along + c2 * (ONE - along))
    close(model.ask("absorb", 0 * v, v)[0], -np.einsum("aij,aj->ai", dashpots, v))
    rates = np.abs(dashpots).sum(axis=2).max(axis=1) / model.mass
    close(model.rate("absorb"), rates.max())


@executes("load-force", "amplitude")
def test_traction_and_pressure_that_follows():
    traction, pressure, time = np.array([0.3, -0.2, 0.1]), 0.7, 0.6
    history = {"time": [0.0, 0.5, 1.0], "value": [0.0, 1.0, 4.0]}
    made = cube().add(
        "load",
        surface="body.x_max",
        traction=list(traction),
        pressure=pressure,
        following=True,
        history=history,
    )
    model = Model(made)
    X, side = around(model)
    u = RNG.uniform(-0.1, 0.1, X.shape)
    s = (time - 0.5) / (1.0 - 0.5)
    h = (1 - s) * 1.0 + s * 4.0
    expected, x = np.zeros_like(u), X + u
    for (N, w, reference), (_, _, now) in zip(face_points(X[side]), face_points(x[side])):
        expected[side] += h * w * np.outer(N, traction * np.linalg.norm(reference) - pressure * now)
    close(model.ask("load", u, time=time)[0], expected)
