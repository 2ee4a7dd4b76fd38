"""Two elastic plates hit each other: what all hosts and the scene have in common, and the loop of two of them."""

from __future__ import annotations

import time

import numpy as np
from scipy.sparse.linalg import LinearOperator, eigsh

import libcontact as ct

YOUNG, POISSON, DENSITY = 2.1e5, 0.3, 7.8e-9  # MPa, 1, t / mm³
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))
MODULUS = LAMBDA + 2 * MU
C1 = np.sqrt(MODULUS / DENSITY)
SIDE, SPEED, CELLS = 2.5, 1000.0, 40  # mm, mm / s
H = SIDE / CELLS
SIZE, COUNTS = [SIDE, H, SIDE], [CELLS, 1, CELLS]
# Behind the front the stress is constant; after twice the way the plates part.
PLATEAU, END = 0.56 * SIDE / C1, 3.0 * SIDE / C1
# Of the step that the host's own stiffness and masses allow.
FRACTION = 0.9
FACTORS = (10.0, 100.0)
# Of the forces of a step, in hosts and scene.
TOLERANCE = 1e-8


def origin(side):
    """Corner of the left plate, whose name is 0, or of the right one, 1."""
    return [(side - 1) * SIDE, 0.0, 0.0]


def lines(side):
    """Coordinates of the planes of nodes along x, y and z: one layer of cubes."""
    x, _, _ = origin(side)
    return [np.linspace(x, x + SIDE, CELLS + 1), [0.0, H], np.linspace(0.0, SIDE, CELLS + 1)]


def velocity(side):
    """The plates approach each other."""
    return [(1 - 2 * side) * SPEED, 0.0, 0.0]


def fixed(X):
    """The components that don't move, shape (n, 3): plane strain, and the plane of symmetry z = 0."""
    out = np.zeros(X.shape, bool)
    out[:, 1], out[:, 2] = True, np.isclose(X[:, 2], 0.0)
    return out


class Timed(ct.Contact):
    """A contact that adds the processor's seconds of its steps."""

    seconds = 0.0

    def step(self, *values, **names):
        start = time.process_time()
        super().step(*values, **names)
        self.seconds += time.process_time() - start

    def add_force(self, force):
        start = time.process_time()
        super().add_force(force)
        self.seconds += time.process_time() - start


def largest_step(force, inverse_mass):
    """2 / ω of the host's forces ``force(u)``, linear in u, by Lanczos."""
    root = np.sqrt(inverse_mass).ravel()

    def apply(x):
        return -root * force((root * x.ravel()).reshape(inverse_mass.shape)).ravel()

    operator = LinearOperator((root.size, root.size), matvec=apply, dtype=float)
    start = np.random.default_rng(1).normal(size=root.size)
    omega_squared = eigsh(operator, 1, v0=start, return_eigenvectors=False, tol=1e-6)[0]
    return 2 / np.sqrt(omega_squared)


class Result:
    """Displacements of both plates at two times, energies at all times t_n, and the fraction of the loop's time
    that the contact takes."""

    def __init__(self, dt):
        self.dt, self.steps, self.energy, self.shots = dt, int(np.ceil(END / dt)), [], []

    def shoot(self, n, plates):
        """Keep coordinates X and displacements x - X of both plates if the step n ends one of the two times."""
        if n + 1 in (int(np.ceil(PLATEAU / self.dt)), self.steps):
            self.shots.append(([p.X for p in plates], [p.x - p.X for p in plates]))

    @property
    def rise(self):
        """Largest rise of the total energy over any earlier value, as a fraction of the first one."""
        energy = np.array(self.energy)
        return (energy - np.minimum.accumulate(energy)).max() / energy[0]


def run_host(plates, beta):
    """The leapfrog, for hosts without a loop of their own: plates have X, m, force(u) and surface()."""
    result = Result(FRACTION * min(largest_step(p.force, inverse(p)) for p in plates))
    dt = result.dt
    for side, p in enumerate(plates):
        p.x, p.v, p.inverse = p.X.copy(), np.tile(velocity(side), (len(p.X), 1)), inverse(p)
    start = time.process_time()
    # -- glue
    first, second = (p.surface() for p in plates)
    keys = {"travel_time": H / C1, "force_tolerance": TOLERANCE}
    contact = Timed(first, second, epsilon=ct.Contact.penalty(beta, YOUNG, H), **keys)
    # -- end
    for n in range(result.steps):
        f = [p.force(p.x - p.X) for p in plates]
        strain = -0.5 * sum(np.vdot(p.x - p.X, force) for p, force in zip(plates, f))
        tau = dt if n else dt / 2
        # -- glue
        x, v, w = ([getattr(p, name) for p in plates] for name in ("x", "v", "inverse"))
        contact.step(dt, x, v, w, f, force_time=tau)
        contact.add_force(f)
        # -- end
        kinetic = 0.0
        for p, force in zip(plates, f):
            old = p.v
            p.v = old + tau * p.inverse * force
            p.x = p.x + dt * p.v
            kinetic += 0.5 * (p.m * old * (p.v if n else old)).sum()
        result.energy.append(strain + kinetic + contact.energy)
        result.shoot(n, plates)
    result.share = contact.seconds / (time.process_time() - start)
    return result


def inverse(plate):
    """Inverse masses, 0 where the motion is prescribed, shape (n, 3)."""
    return np.where(fixed(plate.X), 0.0, 1.0 / plate.m)


def run_scene(result, beta):
    """The same plates, step and contact as a scene: the same shots."""
    scene = ct.Scene(units={"length": "mm", "mass": "t", "time": "s"})
    scene.add_material("steel", young=YOUNG, poisson=POISSON, density=DENSITY)
    for side, name in enumerate(("left", "right")):
        box = {"origin": origin(side), "size": SIZE, "cells": COUNTS}
        scene.add_body(name, box=box, element="hex8", material="steel", velocity=velocity(side))
        scene.add_support(f"{name}.z_min", fix="z")
        scene.add_support(f"{name}.y_min", fix="y")
        scene.add_support(f"{name}.y_max", fix="y")
    scene.add_contact("left.x_max", "right.x_min", beta=beta)
    times = [n * result.dt for n in (np.ceil(PLATEAU / result.dt), result.steps)]
    keys = {"stable_step": "assembled", "force_tolerance": TOLERANCE}
    scene.set_time(end=times[-1], dt=result.dt, **keys).set_output(times=times)
    shots = []

    def keep(run):
        bodies = run.state.values()
        shots.append(([b.mesh.nodes for b in bodies], [b.displacement.copy() for b in bodies]))

    scene.run(progress=False, output=False, watch=keep)
    return shots[-2:]


def in_order(X):
    """The order of nodes along z, y and x, the same in all programs."""
    return np.lexsort(np.round(X / H).astype(int).T)


def difference(one, other):
    """Largest difference of the displacements of two runs, as a fraction of the largest displacement."""
    pairs = zip(*one, *other)
    apart, size = 0.0, 0.0
    for X, u, Y, v in pairs:
        first, second = in_order(X), in_order(Y)
        assert np.allclose(X[first], Y[second], atol=1e-9 * H)
        apart = max(apart, np.abs(u[first] - v[second]).max())
        size = max(size, np.abs(v).max())
    return apart / size


def stress(X, u):
    """Mean σ_x of the right plate behind the plane front, 0.1 < x / d < 0.4 and z / d < 0.15, in units of Λ v0 / c1;
    in the exact solution -7/3."""
    order = in_order(X)
    grid = u[order].reshape(CELLS + 1, 2, CELLS + 1, 3)[:, 0]
    mean_x = 0.5 * np.diff(grid[..., 0], axis=1) / H
    mean_z = 0.5 * np.diff(grid[..., 2], axis=0) / H
    sigma = MODULUS * (mean_x[1:] + mean_x[:-1]) + LAMBDA * (mean_z[:, 1:] + mean_z[:, :-1])
    x, z = (np.arange(CELLS) + 0.5) / CELLS, (np.arange(CELLS) + 0.5) / CELLS
    behind = (x > 0.1) & (x < 0.4), z < 0.15
    return sigma[np.ix_(behind[1], behind[0])].mean() / (LAMBDA * SPEED / C1)
