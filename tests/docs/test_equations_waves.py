"""Equations of time steps, waves in a mesh and the exact plates, written again from the pages and compared with the
library."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from executes import executes
from libcontact._core import ffi, lib
from test_equations_bodies import LAMBDA, MU, RHO, Model, hooke, internal_force, scene
from test_equations_faces import c_array, close

import libcontact as ct

RNG = np.random.default_rng(19)
C1 = np.sqrt((LAMBDA + 2 * MU) / RHO)


# -- Integrators


def stages(scheme, parameter):
    """(τ, c, r, l) of each stage, from the pages."""
    if scheme == "central_difference":
        return [(1, 1, 1, 0)]
    if scheme == "chung_lee":
        return [(1, 1, parameter, 1 - parameter)]
    if scheme == "tchamwa_wielgosz":
        return [(1, 1, 2 / (1 + parameter), 0)]
    p = parameter
    s = 1 - p
    return [(p, 1 - s / (2 * p), p, 0), (s, s / (2 * p), 1 / 2, -(2 * p - 1) * s / (2 * p))]


SCHEMES = [
    ("central_difference", 0.0),
    ("chung_lee", 1.02),
    ("noh_bathe", 0.54),
    ("noh_bathe", 0.58),
    ("tchamwa_wielgosz", 0.8),
]


def integrator(scheme, parameter):
    out = ffi.new(
        "ct_integrator *", lib.ct_integrator_default(getattr(lib, f"CT_{scheme.upper()}"))
    )
    out.parameter = parameter
    return out


@pytest.mark.parametrize("scheme, parameter", SCHEMES)
@executes("chung-lee-drift", "noh-bathe-stages", "tchamwa-wielgosz-drift", "integrator-limits")
def test_stages_and_limits_of_integrators(scheme, parameter):
    made, out = integrator(scheme, parameter), ffi.new("ct_stage[2]")
    count = lib.ct_integrator_stages(made, out)
    found = [(out[i].tau, out[i].c, out[i].r, out[i].l) for i in range(count)]
    close(found, stages(scheme, parameter))
    p, phi = parameter, 2 / (1 + parameter)
    sigma = {
        "central_difference": 1,
        "chung_lee": 4 * p - 3,
        "noh_bathe": (1 - p) * (3 * p - 1),
        "tchamwa_wielgosz": 2 * phi - 1,
    }[scheme]
    close(lib.ct_integrator_limit(made), 2 / np.sqrt(sigma), 1e-12)


@pytest.mark.parametrize("scheme, parameter", SCHEMES)
@executes("dispersion-stage", "dispersion-root")
def test_frequency_and_damping_of_the_steps(scheme, parameter):
    """Roots of the product of the stages, for the frequencies of the mesh that the library reports."""
    waves = RNG.uniform(-2, 2, (5, 3))
    courant = 0.4
    found = ct.dispersion(waves, integrator=scheme, parameter=parameter or None, courant=courant)
    for omega_mesh, omega, decay in zip(
        *map(np.ravel, (found.omega_mesh, found.omega, found.decay))
    ):
        x, A = (omega_mesh * courant) ** 2, np.eye(3)
        for tau, c, r, l in stages(scheme, parameter):
            A = [[1 - tau * r * x, tau, tau * l], [-c * x, 1, 0], [-x, 0, 0]] @ A
        roots = np.linalg.eigvals(A)
        root = roots[np.argmax(roots.imag)]
        close(omega, abs(np.angle(root)) / courant, 1e-9)
        close(decay, -np.log(abs(root)) / courant, 1e-9)


class Steps:
    """A bent brick that flies and turns: its masses and stiffness here, its steps in the library."""

    def __init__(self, **time):
        made = scene(velocity=[0.3, -0.2, 0.1])
        made.set_time(end=1.0, fraction=0.5, **time)
        self.model = Model(made)
        self.pointer, self.state = self.model.problem.pointer, self.model.state
        self.mass = self.model.mass[:, None]
        self.X = self.model.problem.rows(self.pointer.reference).copy()
        self.dt = self.pointer.dt
        self.error = ffi.new("ct_error *")

    def force(self, u):
        return internal_force(self.X, u, hooke)

    def step(self):
        assert lib.ct_step(self.pointer, self.state, self.error) == lib.CT_OK

    def rows(self, name):
        return self.model.problem.rows(getattr(self.state, name)).copy()

    def start(self, u, v):
        """Set the state to a displacement and a velocity half a step earlier."""
        self.model.problem.rows(self.state.displacement)[:] = u
        self.model.problem.rows(self.state.velocity)[:] = v


@executes("leapfrog", "leapfrog-start", "discrete-energy", "work-balance", "energy-start")
def test_leapfrog_and_its_energy():
    run = Steps()
    v0 = RNG.uniform(-0.1, 0.1, (8, 3))
    # At the start nothing is deformed, so that v_{-1/2} = v_0 - ½ Δt M⁻¹ f_0 = v_0.
    u, v = np.zeros((8, 3)), v0 - run.dt / 2 * run.force(np.zeros((8, 3))) / run.mass
    run.start(u, v)
    totals = []
    for _ in range(20):
        run.step()
        before, f = v, run.force(u)
        v = v + run.dt * f / run.mass
        kinetic = np.sum(before * run.mass * v) / 2
        totals.append(kinetic - np.sum(u * f) / 2)
        moved = u + run.dt * v
        after = v + run.dt * run.force(moved) / run.mass
        gain = np.sum(v * run.mass * after) / 2 - kinetic
        close(gain, np.sum((f + run.force(moved)) * (moved - u)) / 2, 1e-12)
        u = moved
        close(run.rows("displacement"), u, 1e-12)
        close(run.rows("velocity"), v, 1e-12)
    close(totals, np.full(20, np.sum(v0 * run.mass * v0) / 2), 1e-12)
    energy = ffi.new("ct_energy *")
    assert lib.ct_energy_of(run.pointer, run.state, energy, run.error) == lib.CT_OK
    last = v + run.dt * run.force(u) / run.mass
    close(energy.kinetic, np.sum(v * run.mass * last) / 2, 1e-12)
    close(energy.strain, -np.sum(u * run.force(u)) / 2, 1e-12)
    # With v_n, the mean of both half steps, and a_n.
    mean, a = (v + last) / 2, run.force(u) / run.mass
    shifted = np.sum(mean * run.mass * mean) / 2 - run.dt**2 / 8 * np.sum(a * run.mass * a)
    close(energy.kinetic, shifted, 1e-12)


def stiffness(X):
    """K of a brick: minus the forces of unit displacements."""
    unit = np.eye(24).reshape(24, 8, 3)
    return -np.array([internal_force(X, u, hooke).ravel() for u in unit])


def stable_step(model):
    out = ffi.new("ct_stable_step *")
    assert (
        lib.ct_stable(model.problem.pointer, model.state, out, ffi.new("ct_error *")) == lib.CT_OK
    )
    return out.dt


@executes(
    "stability-limit", "element-bound", "step-bound", "damped-step-bound", "integrator-damped-bound"
)
def test_stable_step_of_one_brick():
    """One element alone, so that the bound of the elements is the limit; then with dampers, and with another
    integrator."""
    X = Steps().X
    model = Model(scene(X))
    mass = np.repeat(model.mass, 3)
    omega2 = np.linalg.eigvals(stiffness(X) / mass[:, None]).real.max()
    close(stable_step(model), 2 / np.sqrt(omega2), 1e-9)
    rate = 2.5
    damped = scene(X).add("damping", rate=rate)
    close(stable_step(Model(damped)), 4 / (rate + np.sqrt(rate**2 + 4 * omega2)), 1e-9)
    phi = 2 / 1.8
    made = scene(X).add("damping", rate=rate)
    made.set_time(end=1.0, fraction=0.5, integrator="tchamwa_wielgosz", integrator_parameter=0.8)
    close(
        stable_step(Model(made)), 4 / (rate + np.sqrt(rate**2 + 4 * (2 * phi - 1) * omega2)), 1e-9
    )


# -- Waves in a mesh of cubes


def p_wave(k, **options):
    found = ct.dispersion([[k, 0, 0]], poisson=0.3, **options)
    along = np.argmax(np.abs(found.shape[0, :, 0, 0]))
    return found.omega_mesh[0, along], found.omega[0, along], found.group[0, along, 0]


@pytest.mark.parametrize("k", [0.3, 1.1, 2.4])
@executes("dispersion-axis", "dispersion-leapfrog", "step-oscillator", "dispersion-axis-group")
def test_waves_along_an_axis(k):
    lumped = 2 * np.sin(k / 2)
    close(p_wave(k)[0], lumped, 1e-12)
    close(p_wave(k, mass="consistent")[0], lumped * ((2 + np.cos(k)) / 3) ** -0.5, 1e-12)
    Co, s = 0.7, np.sin(k / 2) ** 2
    _, omega, group = p_wave(k, courant=Co)
    close(np.sin(omega * Co / 2), Co * np.sin(k / 2), 1e-12)
    close(2 - 2 * np.cos(omega * Co), (lumped * Co) ** 2, 1e-12)
    close(group, np.cos(k / 2) / np.sqrt(1 - Co**2 * s), 1e-12)


@executes("dispersion-long", "dispersion-diagonal")
def test_long_waves():
    """The difference from c k, over k³h²: C of the pages, up to terms in k²."""
    nu, k = 0.3, 0.02
    c2 = (1 - 2 * nu) / (2 * (1 - nu))  # (c2 / c1)²
    for Co in (0.0, 0.6):
        _, omega, _ = p_wave(k, courant=Co)
        close((1 - omega / k) / k**2, (1 - Co**2) / 24, 1e-4)
        wave = np.array([k, k, 0]) / np.sqrt(2)
        omega = ct.dispersion([wave], poisson=nu, courant=Co).omega[0].max()
        close((1 - omega / k) / k**2, (7 - c2 - 4 * Co**2) / 96, 1e-4)


@executes("dispersion-symbols", "bloch-problem", "bloch-matrices", "group-velocity")
def test_waves_in_any_direction():
    """K(k) as products of rows of springs, masses and differences; the group velocity by a difference quotient."""
    nu, h = 0.3, np.array([1.0, 0.7, 1.3])
    mu = (1 - 2 * nu) / (2 * (1 - nu))
    lam = 1 - 2 * mu

    def omegas(k):
        s = (2 - 2 * np.cos(k * h)) / h
        m = h * (2 + np.cos(k * h)) / 3
        g = np.sin(k * h)
        K = np.zeros((3, 3))
        for x, y, z in itertools.permutations(range(3)):
            K[x, x] = (lam + 2 * mu) * s[x] * m[y] * m[z] + mu * m[x] * (s[y] * m[z] + m[y] * s[z])
            K[x, y] = (lam + mu) * g[x] * g[y] * m[z]
        return np.sqrt(np.linalg.eigvalsh(K / np.prod(h)))

    for wave in RNG.uniform(-2, 2, (6, 3)):
        found = ct.dispersion([wave], size=h, poisson=nu)
        close(found.omega_mesh[0], omegas(wave), 1e-12)
        for a, step in enumerate(1e-5 * np.eye(3)):
            quotient = (omegas(wave + step) - omegas(wave - step)) / 2e-5
            close(found.group[0, :, a], quotient, 1e-8)


# -- The exact plates


@pytest.mark.parametrize("nu", [0.2, 0.3, 0.45])
@executes("exact-kappa", "exact-rayleigh", "exact-rayleigh-cubic")
def test_speeds_of_waves(nu):
    speeds = ct.exact.speeds(nu)
    kappa2 = 2 * (1 - nu) / (1 - 2 * nu)
    close(speeds.c2, 1 / np.sqrt(kappa2))
    # χ = (c_R / c2)², and R vanishes at the slowness 1 / c_R.
    chi = speeds.c_r**2 * kappa2
    close(chi**3 - 8 * chi**2 + (24 - 16 / kappa2) * chi - 16 * (1 - 1 / kappa2), 0, 1e-12)
    p = 1 / speeds.c_r + 0j
    R = (kappa2 - 2 * p**2) ** 2 + 4 * p**2 * np.sqrt(1 - p**2) * np.sqrt(kappa2 - p**2)
    close(R / kappa2**2, 0, 1e-11)


@executes("exact-units", "exact-plane")
def test_plane_wave():
    """Far from the faces, before their waves arrive: behind the front, and ahead of it."""
    nu = 0.3
    (sx, sz, txz), (vx, vz) = ct.exact.plates([0.5, 0.7], 0.0, 0.6, nu=nu)
    close([sx[0], sz[0], txz[0], vx[0], vz[0]], [-(1 - nu) / nu, -1, 0, 0, 0])
    close([sx[1], sz[1], txz[1], vx[1], vz[1]], [0, 0, 0, -1, 0])


# -- Sums


@executes("order-free-sum")
def test_sum_of_two_grids():
    """With exact fractions: the coarse grid, the fine one, and one rounding."""
    x = RNG.normal(size=1000) * 10.0 ** RNG.integers(-20, 3, 1000)
    e = int(np.ceil(np.log2(np.abs(x).max())))
    b = int(np.ceil(np.log2(len(x))))
    G = Fraction(2) ** (e + b - 50)
    g = Fraction(2) ** (b - 50) * G
    q = [G * round(Fraction(value) / G) for value in x]
    r = [g * round((Fraction(value) - each) / g) for value, each in zip(x, q)]
    expected = float(sum(q) + sum(r))
    assert lib.ct_sum(c_array(x), len(x)) == expected
    assert lib.ct_sum(c_array(x[::-1]), len(x)) == expected


# -- The filter


@pytest.mark.parametrize("passes", [1, 3])
@executes("filter-pass", "filter-transfer")
def test_transfer_function_of_the_filter(passes):
    """A standing wave of a free bar without Poisson's effect, cos kx, is multiplied by (1 - q s)^b."""
    n, made = 8, ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
    made.add_material("elastic", young=1.0, poisson=0.0, density=1.0)
    made.add_body("body", material="elastic", box={"size": [n, 1, 1], "cells": [n, 1, 1]})
    model = Model(made.set_time(end=1.0, fraction=0.5))
    x = model.problem.rows(model.problem.pointer.reference)[:, 0]
    filtered, error = ffi.new("ct_filter **"), ffi.new("ct_error *")
    pointer = model.problem.pointer
    assert lib.ct_filter_create(pointer, passes, filtered, error) == lib.CT_OK
    q = stable_step(model) ** 2  # c1 = h = 1
    for mode in (1, 3, 6):
        k = np.pi * mode / n
        u, v = map(model.problem.rows, (model.state.displacement, model.state.velocity))
        u[:, 0], v[:, 0] = np.cos(k * x), 2 * np.cos(k * x)
        out = np.zeros((2, len(x), 3))
        casts = [ffi.cast("double *", each.ctypes.data) for each in out]
        assert lib.ct_filter_apply(filtered[0], model.state, *casts, error) == lib.CT_OK
        factor = (1 - q * np.sin(k / 2) ** 2) ** passes
        close(out[:, :, 0], [factor * u[:, 0], factor * v[:, 0]], 1e-11)
    lib.ct_filter_free(filtered[0])
