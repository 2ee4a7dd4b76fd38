"""Picture of the chapter on rigid bodies."""

import mpmath
import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY
from shared.scenes import done, scene_of

SIZE, CELLS = np.array([3.0, 2.0, 1.0]), np.array([3, 2, 2])
SPIN = np.array([0.02, 1.0, 0.0])


def inertia(factor):
    """Moments of inertia per mass about the axes of the box; a second moment gets its factor."""
    second = SIZE**2 / 12 * factor
    return second.sum() - second


def euler(moments, t):
    """Angular velocity about the middle axis, by Jacobi's functions, of a box that begins near this axis."""
    a, b, c = moments[::-1]  # A > B > C, with the box's z, y, x
    energy, square = moments @ SPIN**2, moments**2 @ SPIN**2
    # Twice the energy T and the square of the angular momentum: L² < 2 T B here.
    m = (square - c * energy) * (a - b) / ((a * energy - square) * (b - c))
    rate = np.sqrt((b - c) * (a * energy - square) / (a * b * c))
    top = np.sqrt((square - c * energy) / (b * (b - c)))
    if m > 1.0:
        m, rate = 1.0 / m, np.sqrt((a - b) * (square - c * energy) / (a * b * c))
        top = np.sqrt((a * energy - square) / (b * (a - b)))
    start = float(mpmath.ellipf(np.arcsin(min(1.0, SPIN[1] / top)), m))
    return np.array([float(top * mpmath.ellipfun("sn", start + rate * x, m=m)) for x in t])


def rates(run):
    """Angular velocity in the axes of the body, from displacements and velocities of three edges."""
    out = []
    for state in run.states:
        body = state["box"]
        X, u, v = body.nodes, body.displacement, body.velocity
        R = np.linalg.lstsq(X - X.mean(0), X + u - (X + u).mean(0), rcond=None)[0].T
        W = np.linalg.lstsq(X + u - (X + u).mean(0), v - v.mean(0), rcond=None)[0].T
        out.append(R.T @ [W[2, 1], W[0, 2], W[1, 0]])
    return np.array([state.time for state in run.states]), np.array(out)


def flips():
    """Angular velocity of a box about its middle axis."""
    scene = scene_of(young=100.0)
    box = {"size": list(SIZE), "cells": [int(n) for n in CELLS]}
    spin = {"axis": list(SPIN), "rate": float(np.linalg.norm(SPIN))}
    scene.add_body("box", material="elastic", box=box, spin=spin).add("rigid", body="box")
    run = done(scene.set_time(end=40.0, dt=0.1).set_output(every=4))
    t, omega = rates(run)
    figure = Figure(figsize=(7.5, 3.0), layout="constrained")
    axes = figure.subplots()
    fine = np.linspace(0, 40, 401)
    lumped, solid = inertia(1 + 2 / CELLS**2), inertia(1.0)
    axes.plot(fine, euler(lumped, fine), color="black", lw=1, label="Euler, lumped inertia")
    axes.plot(fine, euler(solid, fine), color=GREY, lw=1, ls="--", label="Euler, solid box")
    axes.plot(t, omega[:, 1], ".", color=BLUE, label="library, Δt = 0.1")
    axes.set(xlabel="time", ylabel="rate about the middle axis")
    axes.legend(loc="upper center")
    return figure
