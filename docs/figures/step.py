"""Pictures of the chapter on central differences."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE, RED


def leapfrog():
    """Where the leapfrog stores what."""
    figure = Figure(figsize=(7.5, 2.2))
    ax = figure.subplots()
    for n in range(4):
        ax.plot(n, 0, "o", color=BLUE, ms=11)
        ax.text(n, -0.42, ["$t_{n-1}$", "$t_n$", "$t_{n+1}$", "$t_{n+2}$"][n], ha="center")
        ax.text(n, 0.28, r"$\mathbf{u},\ \mathbf{f}(\mathbf{u})$", ha="center", color=BLUE)
    for n in range(3):
        ax.plot(n + 0.5, 1, "s", color=ORANGE, ms=10)
        ax.text(n + 0.5, 1.28, r"$\mathbf{v}$", ha="center", color=ORANGE)
        curve = {"arrowstyle": "->", "lw": 1.4, "shrinkA": 10, "shrinkB": 10}
        ax.annotate(
            "",
            (n + 1, 0),
            (n, 0),
            arrowprops=curve | {"connectionstyle": "arc3,rad=0.35", "color": BLUE},
        )
    for n in range(2):
        ax.annotate(
            "",
            (n + 1.5, 1),
            (n + 0.5, 1),
            arrowprops=curve | {"connectionstyle": "arc3,rad=-0.35", "color": ORANGE},
        )
    ax.set(xlim=(-0.3, 3.3), ylim=(-0.75, 1.75))
    ax.set_axis_off()
    return figure


def oscillator():
    """The leapfrog on one oscillator for four steps."""
    figure = Figure(figsize=(7.5, 3.6))
    t = np.linspace(0, 20, 401)
    for ax, step in zip(figure.subplots(2, 2, sharex=True).flat, (0.5, 1.2, 1.9, 2.05)):
        v, u = 0.5 * step, [1.0]
        for _ in range(int(20 / step)):
            v -= step * u[-1]
            u.append(u[-1] + step * v)
        ax.plot(t, np.cos(t), color=GREY, lw=1)
        ax.plot(step * np.arange(len(u)), u, "o-", ms=3, lw=0.9, color=BLUE if step <= 2 else RED)
        ax.set_title(f"ω Δt = {step}")
    figure.supxlabel("ω t", fontsize=10)
    figure.supylabel("displacement", fontsize=10)
    return figure
