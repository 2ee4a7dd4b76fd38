"""Pictures of the chapter on the impact of two plates."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, DARK, GREEN, GREY, ORANGE, RED, VIOLET

import libcontact as ct


def setup():
    """Fig. 2 of the paper: the two plates before the impact, and the half that is computed."""
    figure = Figure(figsize=(6.4, 3.2))
    ax = figure.subplots()
    for x, colour, way, name in ((-1, BLUE, 1, "left"), (0, ORANGE, -1, "right")):
        for z, alpha in ((-1, 0.25), (0, 0.6)):
            ax.fill([x, x + 1, x + 1, x], [z, z, z + 1, z + 1], color=colour, alpha=alpha, lw=0)
        middle = x + 0.5
        ax.annotate(
            "",
            (middle + 0.2 * way, 0.5),
            (middle - 0.2 * way, 0.5),
            arrowprops={"arrowstyle": "-|>", "lw": 2},
        )
        ax.text(middle, 0.62, "$v_0$", ha="center")
        ax.text(middle, -0.55, name, ha="center")
    ax.plot([-1.15, 1.15], [0, 0], "-.", color="black", lw=0.9)
    ax.text(1.18, 0, "symmetry", va="center")
    ax.plot([0, 0], [-1, 1], color="black", lw=1.4)
    ax.text(0.02, 1.05, "plane of contact")
    ax.text(-0.95, 1.05, "free")
    ax.annotate("", (-1.1, 0), (-1.1, 1), arrowprops={"arrowstyle": "<->", "lw": 1})
    ax.text(-1.17, 0.5, "$d$", ha="center", va="center")
    ax.set(xlim=(-1.3, 1.6), ylim=(-1.05, 1.2), aspect="equal")
    ax.set_axis_off()
    return figure


FRONTS = {
    "plane_p": ("plane P", BLUE),
    "circular_p": ("P from the edge", ORANGE),
    "circular_s": ("S from the edge", GREEN),
    "head": ("head wave", VIOLET),
    "rayleigh": ("Rayleigh wave", RED),
}


def snapshots():
    """The exact transversal stress at four times, with its fronts."""
    figure = Figure(figsize=(7.5, 5.4))
    x = np.linspace(0.0025, 0.9975, 200)
    for ax, t in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, (0.28, 0.56, 0.84, 1.4)):
        stress = ct.exact.plates(x[None, :], x[:, None], t).stress.sigma_z
        image = ax.imshow(stress, origin="lower", extent=(0, 1, 0, 1), vmin=-1.5, vmax=1.5)
        for name, curves in ct.exact.fronts(t).items():
            label, colour = FRONTS[name]
            for i, curve in enumerate(curves):
                if len(curve) > 1:
                    ax.plot(*curve.T, color=DARK, lw=1.3)
                elif i == 0:
                    ax.plot(*curve.T, "o", color=colour, ms=6, clip_on=False, label=label)
        ax.set(title=f"$c_1t/d = {t}$", xlim=(0, 1), ylim=(0, 1), aspect="equal")
        ax.grid(False)
    for ax in figure.axes[2:4]:
        ax.set_xlabel("x / d")
    for ax in (figure.axes[0], figure.axes[2]):
        ax.set_ylabel("z / d")
    figure.axes[0].legend(loc="lower right", fontsize=9, labelcolor=DARK)
    figure.colorbar(image, ax=figure.axes, label=r"$\sigma_z^*$", shrink=0.8)
    return figure


def waves():
    """Which wave is where at one time, with names; and how the head wave comes about."""
    figure = Figure(figsize=(7.5, 4.0))
    names, head = figure.subplots(1, 2, width_ratios=(1, 1.15))
    t = 0.75
    c2, c_r = ct.exact.speeds(0.3)
    for name, curves in ct.exact.fronts(t).items():
        curve, (_, colour) = curves[0], FRONTS[name]
        curve = np.maximum(curve, 0)
        names.plot(*curve.T, "o" if len(curve) == 1 else "-", color=colour, clip_on=False)
    for place, text, key in (
        ((t + 0.02, 0.3), "plane P", "plane_p"),
        ((0.1, 0.16), "P from the edge", "circular_p"),
        ((0.02, 0.52), "S from the edge", "circular_s"),
        ((0.43, 0.685), "head wave", "head"),
        ((c_r * t - 0.12, 1.05), "Rayleigh", "rayleigh"),
    ):
        names.text(*place, text, color=FRONTS[key][1])
    names.text(0.05, 0.05, "as in a half-space", fontsize=9)
    names.text(0.8, 0.75, "flies\nfreely", fontsize=9)
    names.set(xlim=(0, 1), ylim=(0, 1.1), aspect="equal", xlabel="x / d", ylabel="z / d")
    names.grid(False)
    # The P wave runs along the face and sends S waves down from each place that it passes.
    for start in np.linspace(0.1, 0.9, 5):
        radius = (1 - start) * c2
        angle = np.linspace(np.pi, 2 * np.pi, 100)
        head.plot(start + radius * np.cos(angle), radius * np.sin(angle), color=GREEN, lw=1)
        head.plot(start, 0, "o", color=ORANGE, ms=4)
    angle = np.linspace(1.5 * np.pi, 2 * np.pi, 100)
    head.plot(c2 * np.cos(angle), c2 * np.sin(angle), color=GREEN)
    touch = np.array([c2, -np.sqrt(1 - c2**2)]) * c2
    head.plot([1, touch[0]], [0, touch[1]], color=VIOLET)
    head.plot([0, touch[0]], [0, touch[1]], ":", color="black", lw=1)
    head.text(0.02, -0.3, r"$c_2t$")
    arc = np.linspace(np.pi, np.pi + np.arcsin(c2), 30)
    head.plot(1 + 0.32 * np.cos(arc), 0.32 * np.sin(arc), color="black", lw=0.8)
    head.text(0.72, -0.09, r"$\theta$")
    head.annotate("", (1.12, 0.06), (0.8, 0.06), arrowprops={"arrowstyle": "->", "color": ORANGE})
    head.text(0.5, 0.045, r"P wave, $c_1$", color=ORANGE)
    head.axhline(0, color="black", lw=1)
    head.set(xlim=(-0.05, 1.15), ylim=(-0.6, 0.15), aspect="equal")
    head.set_axis_off()
    return figure


def lines():
    """Figs. 4 and 5 of the paper: exact, and computed with 100 elements and two steps."""
    figure = Figure(figsize=(7.5, 3.4))
    along, across = figure.subplots(1, 2)
    fine = np.linspace(0, 1, 1001)
    exact = ct.exact.plates(fine, 0.0, 0.56).stress.sigma_x
    along.plot(fine, exact, color="black", lw=1.2, label="exact")
    across.plot(fine, ct.exact.plates(0.4, fine, 0.56).stress.sigma_z, color="black", lw=1.2)
    run = ct.Scene.load(ct.example("plates")).run(progress=False, output=False)
    state = run.state["right"]
    poisson, young, density = 0.3, 2.1e5, 7.8e-9
    lame = young * poisson / (1 + poisson) / (1 - 2 * poisson)
    c1 = np.sqrt(young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson) * density))
    unit = lame * 1e3 / c1
    x, z = state.centres[:, 0] / 2.5, state.centres[:, 2] / 2.5
    row = np.flatnonzero(z < 0.01)
    row = row[np.argsort(x[row])]
    along.plot(x[row], state.stress[row, 0] / unit, color=BLUE, label="computed")
    column = np.flatnonzero(np.abs(x - 0.395) < 0.006)
    other = np.flatnonzero(np.abs(x - 0.405) < 0.006)
    column, other = column[np.argsort(z[column])], other[np.argsort(z[other])]
    mean = 0.5 * (state.stress[column, 2] + state.stress[other, 2]) / unit
    across.plot(z[column], mean, color=BLUE)
    along.set(xlabel="x / d, at z = 0", ylabel=r"$\sigma_x^*$")
    across.set(xlabel="z / d, at x = 0.4 d", ylabel=r"$\sigma_z^*$")
    for place, text in ((1 - np.sqrt(0.56**2 - 0.16), "P"), (1 - 0.16 / np.sqrt(2.5), "head")):
        across.axvline(place, color=GREY, ls=":", lw=1)
        across.text(place - 0.015, -0.02, text, ha="right", va="top")
    along.legend(loc="center right")
    return figure
