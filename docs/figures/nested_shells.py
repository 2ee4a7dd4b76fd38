"""Picture of the benchmark of nested shells."""

import numpy as np
from matplotlib.figure import Figure
from problems import rings, runs


def displacements():
    """Radial displacement of the nodes over the radius, and Lamé's solution."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.subplots()
    run = runs.done(runs.load("nested_shells"))
    for name in run.bodies:
        shell = run.state[name]
        radius = np.linalg.norm(shell.nodes, axis=1)
        moved = (shell.displacement * shell.nodes).sum(axis=1) / radius
        axes.plot(radius, 1e3 * moved, ".", ms=3, label=f"{name} shell, nodes")
    for inner in (True, False):
        r = np.linspace(*((0.6, 0.8) if inner else (0.8, 1.0)), 50)
        exact = rings.shells_displacement(1.0, 0.25, 1e-3, r, inner)
        axes.plot(r, 1e3 * exact, "k-", lw=1, label="Lamé" if inner else None)
    axes.set(xlabel="radius", ylabel="radial displacement / 10⁻³")
    axes.legend()
    return figure
