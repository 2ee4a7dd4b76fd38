"""Pictures of the benchmarks of rings, shells and discs."""

import sys
from pathlib import Path

import numpy as np
from libcontact.pictures.plot import draw_faces
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "benchmarks"))
import problems  # noqa: E402


def crushed_ring():
    """The ring of the scene at rest between its plates, and the force over the travel of a plate."""
    figure = Figure(figsize=(7.5, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.2])
    ring = problems.done(problems.load("crushed_ring")).state["ring"]
    draw_faces(left, ring, "z_min", np.zeros(len(ring.elements)), (-1, 1), linewidths=0.6)
    for y in (-0.65, 0.65):
        left.axhline(y, color="0.4", lw=2)
    left.set(xlim=(-1.5, 1.5), ylim=(-1.1, 1.1), xlabel="x", ylabel="y", aspect="equal")
    travel = np.linspace(0.005, 0.45, 80)
    right.plot(travel, [problems.crushed_exact(2 - 2 * t) for t in travel], label="elastica")
    some = np.array([0.1, 0.2, 0.3, 0.4])
    forces = [problems.crushed(t, 40)[0] for t in some]
    right.plot(some, forces, "o", label="40 bricks")
    right.plot(travel, 2 * travel / (np.pi / 4 - 2 / np.pi), ":", label="small displacements")
    right.set(xlabel="travel of each plate / r", ylabel="force F r² / B", ylim=(0, 5))
    right.legend(loc="lower right")
    return figure


def discs():
    """Mean velocities of both discs over time, and those of plane waves."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.subplots()
    data = problems.load("discs")
    data["output"]["every"] = 1
    run = problems.done(data)
    mass = run.body_momentum("small")["p"][0, 2] / -100
    for name, own, after in (("small", mass, 0), ("large", mass / 0.9**2, -81)):
        rows = run.body_momentum(name)
        (line,) = axes.plot(1e6 * run.time, rows["p"][:, 2] / own, label=f"{name} disc")
        axes.axhline(after, color=line.get_color(), ls="--", lw=1)
    axes.set(xlabel="time [µs]", ylabel="mean velocity [m/s]", xlim=(0, 100))
    axes.legend(loc="center right")
    return figure


def nested_shells():
    """Radial displacement of the nodes over the radius, and Lamé's solution."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.subplots()
    run = problems.done(problems.load("nested_shells"))
    for name in run.bodies:
        shell = run.state[name]
        radius = np.linalg.norm(shell.nodes, axis=1)
        moved = (shell.displacement * shell.nodes).sum(axis=1) / radius
        axes.plot(radius, 1e3 * moved, ".", ms=3, label=f"{name} shell, nodes")
    for inner in (True, False):
        r = np.linspace(*((0.6, 0.8) if inner else (0.8, 1.0)), 50)
        exact = problems.shells_displacement(1.0, 0.25, 1e-3, r, inner)
        axes.plot(r, 1e3 * exact, "k-", lw=1, label="Lamé" if inner else None)
    axes.set(xlabel="radius", ylabel="radial displacement / 10⁻³")
    axes.legend()
    return figure
