"""Picture of the benchmark of a crushed ring."""

import numpy as np
from libcontact.pictures.plot import draw_faces
from matplotlib.figure import Figure
from problems import bending, runs


def forces():
    """The ring of the scene at rest between its plates, and the force over the travel of a plate."""
    figure = Figure(figsize=(7.5, 3.2), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[1, 1.2])
    ring = runs.done(runs.load("crushed_ring")).state["ring"]
    draw_faces(left, ring, "z_min", np.zeros(len(ring.elements)), (-1, 1), linewidths=0.6)
    for y in (-0.65, 0.65):
        left.axhline(y, color="0.4", lw=2)
    left.set(xlim=(-1.5, 1.5), ylim=(-1.1, 1.1), xlabel="x", ylabel="y", aspect="equal")
    travel = np.linspace(0.005, 0.45, 80)
    right.plot(travel, [bending.crushed_exact(2 - 2 * t) for t in travel], label="elastica")
    some = np.array([0.1, 0.2, 0.3, 0.4])
    forces = [bending.crushed(t, 40)[0] for t in some]
    right.plot(some, forces, "o", label="40 bricks")
    right.plot(travel, 2 * travel / (np.pi / 4 - 2 / np.pi), ":", label="small displacements")
    right.set(xlabel="travel of each plate / r", ylabel="force F r² / B", ylim=(0, 5))
    right.legend(loc="lower right")
    return figure
