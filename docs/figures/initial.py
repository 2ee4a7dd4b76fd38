"""Picture of the chapter on the initial state."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, ORANGE
from shared.scenes import bar, done, scene_of

STRETCH = 0.01


def released():
    """The stress of a bar that was stretched, at three times after its release."""
    figure = Figure(figsize=(7.5, 2.8))
    ax = figure.subplots()
    for time, colour in ((0.2, BLUE), (0.4, ORANGE), (0.7, GREEN)):
        gradient = [[STRETCH, 0, 0], [0, 0, 0], [0, 0, 0]]
        scene = bar(scene_of(), cells=40, initial={"gradient": gradient})
        run = done(scene.set_time(end=time, courant=1))
        body = run.state["bar"]
        x = body.nodes[body.elements].mean(axis=1)[:, 0]
        ax.plot(x, body.stress[:, 0] / STRETCH, "o", ms=3, color=colour)
        fine = np.linspace(0, 1, 801)
        front = np.minimum(fine, 1 - fine)
        exact = np.where(front > time, 1.0, np.where(1 - front > time, 0.0, -1.0))
        ax.plot(fine, exact, color=colour, lw=1, label=f"c t / L = {time:g}")
    ax.set(xlabel="x / L", ylabel="stress / E s")
    ax.legend(loc="center right")
    return figure
