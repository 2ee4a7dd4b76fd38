"""Picture of the chapter on materials."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, ORANGE


def waves():
    """Particles of a body in the two kinds of plane wave."""
    figure = Figure(figsize=(7.5, 3.0))
    x, y = np.meshgrid(np.linspace(0, 6, 61), np.linspace(0, 1, 9))
    pulse = lambda s: 0.32 * np.exp(-((s - 3) ** 2) / 0.35)
    for ax, (name, dx, dy) in zip(
        figure.subplots(2, 1, sharex=True),
        (("dilatation wave, $c_1$", pulse(x), 0 * x), ("shear wave, $c_2$", 0 * x, pulse(x))),
    ):
        ax.plot((x + dx).ravel(), (y + dy).ravel(), ".", ms=3.2, color=BLUE)
        ax.annotate("", (5.4, 1.55), (4.4, 1.55), arrowprops={"arrowstyle": "-|>", "lw": 1.5})
        ax.annotate(
            "",
            (3.0 + (0.35 if dx.any() else 0), 1.38 + (0 if dx.any() else 0.42)),
            (3.0 - (0.35 if dx.any() else 0), 1.38),
            arrowprops={"arrowstyle": "<|-|>", "lw": 1.5, "color": ORANGE},
        )
        ax.text(0, 1.45, name)
        ax.text(5.5, 1.55, "runs", va="center")
        ax.text(3.5, 1.55, "moves", va="center", color=ORANGE)
        ax.set(ylim=(-0.1, 1.9), aspect="equal")
        ax.set_axis_off()
    return figure
