"""Pictures of the impact of two thick plates and of its exact solution."""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "theory"))
import face  # noqa: E402

import libcontact as ct  # noqa: E402

BLUE, ORANGE, GREEN, RED, PURPLE, GREY = (
    "#3b8bd4",
    "#e8762b",
    "#3fa34d",
    "#d64550",
    "#9b6fd0",
    "#8a8a8a",
)
FRONTS = {
    "plane_p": ("plane P", BLUE),
    "circular_p": ("P from the edge", ORANGE),
    "circular_s": ("S from the edge", GREEN),
    "head": ("head wave", PURPLE),
    "rayleigh": ("Rayleigh wave", RED),
}
KAPPA = np.sqrt(3.5)  # c1 / c2 for Poisson's ratio 0.3


def snapshots():
    """The exact transversal stress at four times, with its fronts."""
    figure = Figure(figsize=(7.5, 5.4))
    x = np.linspace(0.0025, 0.9975, 200)
    for ax, t in zip(figure.subplots(2, 2, sharex=True, sharey=True).flat, (0.28, 0.56, 0.84, 1.4)):
        stress = ct.exact.plates(x[None, :], x[:, None], t).stress.sigma_z
        image = ax.imshow(
            stress, origin="lower", extent=(0, 1, 0, 1), vmin=-1.5, vmax=1.5, alpha=0.75
        )
        for name, curves in ct.exact.fronts(t).items():
            label, colour = FRONTS[name]
            for i, curve in enumerate(curves):
                if len(curve) > 1:
                    ax.plot(*curve.T, color="black", lw=1.3)
                elif i == 0:
                    ax.plot(*curve.T, "o", color=colour, ms=6, clip_on=False, label=label)
        ax.set(title=f"$c_1t/d = {t}$", xlim=(0, 1), ylim=(0, 1), aspect="equal")
        ax.grid(False)
    for ax in figure.axes[2:4]:
        ax.set_xlabel("x / d")
    for ax in (figure.axes[0], figure.axes[2]):
        ax.set_ylabel("z / d")
    figure.axes[0].legend(loc="lower right", fontsize=9, labelcolor="#303030")
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
    head.plot([1, touch[0]], [0, touch[1]], color=PURPLE)
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


def p_plane():
    """The upper half of the plane of the slowness p: poles, cuts and Cagniard's paths for two directions."""
    figure = Figure(figsize=(7.5, 3.9))
    p_r = 1 / ct.exact.speeds(0.3).c_r
    for ax, angle, title in zip(
        figure.subplots(1, 2, sharey=True), (60, 25), ("steep: x / r = 0.50", "flat: x / r = 0.91")
    ):
        x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        ax.plot([1, 3.2], [0.0, 0.0], color=GREY, lw=5, alpha=0.5, solid_capstyle="butt")
        ax.plot([KAPPA, 3.2], [0.0, 0.0], color="black", lw=2, alpha=0.7, solid_capstyle="butt")
        ax.plot([0, 0], [0, 2.2], "--", color="black", lw=1.2)
        ax.text(0.05, 1.5, "inverse\ntransform", va="top", fontsize=9)
        for c, colour, name in ((1.0, ORANGE, "P"), (KAPPA, GREEN, "S")):
            t = c + np.linspace(0, 1.7, 200) ** 2
            path = np.array([face.path_point(x, y, one, c) for one in t])
            ax.plot(path.real, path.imag, color=colour, label=name)
            for one in (1.2, 2.2, 2.7):
                if one > c:
                    p = face.path_point(x, y, one, c)
                    ax.plot(p.real, p.imag, "o", color=colour, ms=4.5)
                    if p.real < 2.75 and p.imag < 2.15:
                        side = {"ha": "right"} if c == 1 else {"ha": "left"}
                        off = -0.07 if c == 1 else 0.07
                        ax.text(p.real + off, p.imag - 0.03, f"{one:g}", color=colour, **side)
            if c > 1 and c * x > 1:
                ax.plot([1, c * x], [0.05, 0.05], color=PURPLE, lw=2.5)
                ax.text(1.25, 0.1, "head", color=PURPLE, fontsize=9)
        ax.plot(p_r, 0, "X", color=RED, ms=8, clip_on=False, zorder=5)
        ax.plot(1, 0, "X", color=BLUE, ms=8, clip_on=False, zorder=5)
        ax.set(title=title, xlabel="Re p", xlim=(-0.1, 3.2), ylim=(-0.05, 2.2))
        ax.set_xticks([0, 1, KAPPA - 0.05, p_r + 0.07, 3], ["0", "1", "κ", "$p_R$", "3"])
        ax.legend(loc="upper right")
    figure.axes[0].set_ylabel("Im p")
    return figure


def contributions():
    """The stress s_y that one face sends to two points over time, wave by wave."""
    figure = Figure(figsize=(7.5, 3.5))
    c2, c_r = ct.exact.speeds(0.3)
    for ax, (x, y) in zip(figure.subplots(1, 2, sharey=True), ((0.15, 0.3), (0.4, 0.1))):
        t = np.linspace(0.02, 1.3, 500)
        parts = np.array([face.face(x, y, one)[:, 1] for one in t])
        ax.plot(t, parts[:, 0], color=ORANGE, label="P wave")
        ax.plot(t, parts[:, 1], color=GREEN, label="S wave")
        ax.plot(t, parts.sum(axis=1), color="black", lw=1.2, label="sum")
        r = np.hypot(x, y)
        marks = [(r, "P"), (r / c2, "S")]
        if x / r > c2:
            marks.append((x + y * np.sqrt(KAPPA**2 - 1), "head"))
        for place, name in marks:
            ax.axvline(place, color=GREY, ls=":", lw=1)
            ax.text(place + 0.01, 1.45, name)
        ax.set(xlabel=r"$c_1t/d$", title=f"x = {x} d, y = {y} d", ylim=(-0.85, 1.6))
    figure.axes[0].set_ylabel(r"$s_y$")
    figure.axes[0].legend(loc="lower left")
    return figure


def branches():
    """Sums of Rayleigh-Lamb modes and the closed form on the line of Fig. 5, and the branches themselves."""
    figure = Figure(figsize=(7.5, 3.5))
    lamb, sums = figure.subplots(1, 2)
    xi = np.linspace(0.02, 14, 300)
    omega = np.linspace(0.02, 14, 500)
    X, W = np.meshgrid(xi, omega)
    alpha2, beta2 = W**2 - X**2 + 0j, 3.5 * W**2 - X**2 + 0j
    alpha, beta = np.sqrt(alpha2), np.sqrt(beta2)
    scale = np.cosh(alpha.imag) * np.cosh(beta.imag)
    value = (beta2 - X**2) ** 2 * np.cos(alpha) * np.sin(beta) / beta
    value = (value + 4 * X**2 * alpha * np.sin(alpha) * np.cos(beta)).real / scale
    lamb.contour(X, W, value, levels=[0.0], colors=[BLUE], linewidths=1.2)
    lamb.plot(xi, xi, "--", color="black", lw=1)
    lamb.plot(xi, xi / KAPPA, ":", color="black", lw=1.4)
    lamb.text(7.6, 8.7, r"$\omega = \xi$", rotation=45)
    lamb.text(11, 4.6, r"$\omega = \xi/\kappa$", rotation=28)
    lamb.set(xlabel=r"wave number $\xi$", ylabel=r"frequency $\omega$")
    z = np.linspace(0, 1, 401)
    try:
        for count, colour in ((10, ORANGE), (50, GREEN)):
            stress = ct.exact.plates_series(0.4, z, 0.56, branches=count).stress.sigma_z
            sums.plot(z, stress, color=colour, lw=1.1, label=f"{count} branches")
    except ct.NotBuiltIn:
        pass  # without GSL only the closed form is shown
    closed = ct.exact.plates(0.4, z, 0.56).stress.sigma_z
    sums.plot(z, closed, color="black", lw=1.2, label="closed form")
    sums.set(xlabel="z / d", ylabel=r"$\sigma_z^*$", ylim=(-1.3, 0.6))
    sums.legend(loc="upper left")
    return figure
