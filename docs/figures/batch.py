"""Picture of the chapter on eight points at a time."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE
from shared.faces import SQUARE

import libcontact as ct


def lanes():
    """Evaluations in three blocks of eight lanes."""
    figure = Figure(figsize=(7.5, 2.6))
    random = np.random.default_rng(11)
    flat = np.column_stack([SQUARE, np.zeros(8)])
    for ax, title in zip(
        figure.subplots(1, 3, sharey=True, sharex=True), ("block 1", "block 2", "block 3")
    ):
        looks = []
        for _ in range(8):
            nodes = flat + random.uniform(-0.2, 0.2, (8, 3))
            point = [*random.uniform(-0.9, 0.9, 2), random.uniform(-0.3, 0.3)]
            looks.append(ct.project("Q8", nodes, [point]).evaluations[0])
        ax.barh(range(1, 9), looks, color=BLUE)
        ax.plot([0, max(looks), max(looks), 0, 0], [0.4, 0.4, 8.6, 8.6, 0.4], color="black", lw=1)
        ax.set(title=title, xlabel="evaluations", yticks=[1, 4, 8])
        ax.grid(False)
    figure.axes[0].set_ylabel("lane")
    return figure
