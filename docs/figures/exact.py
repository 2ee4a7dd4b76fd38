"""Pictures of the chapter on the exact solution."""

import face
import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, VIOLET

import libcontact as ct

KAPPA = np.sqrt(3.5)  # c1 / c2 for Poisson's ratio 0.3


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
                ax.plot([1, c * x], [0.05, 0.05], color=VIOLET, lw=2.5)
                ax.text(1.25, 0.1, "head", color=VIOLET, fontsize=9)
        ax.plot(p_r, 0, "X", color=RED, ms=8, clip_on=False, zorder=5)
        ax.plot(1, 0, "X", color=BLUE, ms=8, clip_on=False, zorder=5)
        ax.set(title=title, xlabel="Re p", xlim=(-0.1, 3.2), ylim=(-0.05, 2.2))
        ax.set_xticks([0, 1, KAPPA - 0.05, p_r + 0.07, 3], ["0", "1", "κ", "$p_R$", "3"])
        ax.legend(loc="upper right")
    figure.axes[0].set_ylabel("Im p")
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
    page = {"facecolor": "#fefefe", "edgecolor": "none", "pad": 1.0}
    lamb.text(7.6, 8.9, r"$\omega = \xi$", bbox=page)
    lamb.text(9.6, 3.6, r"$\omega = \xi/\kappa$", bbox=page)
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
