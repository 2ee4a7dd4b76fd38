"""Pictures of the chapter on bricks with one point."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import CORNERS, draw_edges
from shared.drawing import BLUE, GREEN, ORANGE, axes_in_space
from shared.scenes import done, found_roots, scene_of

PATTERNS = {"ηζ": (1, 2), "ζξ": (2, 0), "ξη": (0, 1), "ξηζ": (0, 1, 2)}


def hourglasses():
    """The four patterns of hourglass modes of a brick, here as displacements along x."""
    figure = Figure(figsize=(7.5, 2.2), layout="none")
    for column, (name, axes) in enumerate(PATTERNS.items()):
        ax = axes_in_space(figure, 141 + column, elev=20, azim=-68)
        moved = CORNERS.copy()
        moved[:, 0] += 0.45 * CORNERS[:, axes].prod(axis=1)
        draw_edges(ax, CORNERS, lw=0.6)
        draw_edges(ax, moved, color=ORANGE, lw=1.6)
        ax.plot(*moved.T, "o", color="black", ms=3)
        ax.set_title(f"$u_x$ = a {name}", fontsize=10)
        ax.set_box_aspect((1, 1, 1), zoom=1.25)
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.9, wspace=0)
    return figure


def frequency(pattern, integration, kappa=1.0):
    """ω² h² ρ / E of a free cube that swings in an hourglass mode along x, from a run."""
    scene = scene_of()
    box = {"origin": [-1, -1, -1], "size": [2, 2, 2], "cells": [1, 1, 1]}
    keys = {"integration": integration}
    if integration == "reduced":
        keys["hourglass"] = kappa
    scene.add_body("bar", material="elastic", box=box, **keys)

    def kick(view):
        force = np.zeros_like(view.reference)
        if view.time == 0.0:
            force[:, 0] = 1e-6 * view.reference[:, PATTERNS[pattern]].prod(axis=1)
        return force

    scene.add_effect("kick", "bar", np.arange(8), kick)
    scene.add_probe("corner", body="bar", point=[1, 1, 1], quantities=["displacement"])
    run = done(scene.set_time(end=20.0, dt=0.25))
    root = found_roots(run.probes["corner"]["displacement"][2:, 0], 2)
    return 4 * (2 * np.sin(np.abs(np.angle(root[0])) / 2) / run.dt) ** 2


def stiffness():
    """The stiffness of the hourglass modes over Q, as frequencies of a cube, beside full integration."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    kappa = np.linspace(0, 1.6, 50)
    ax.plot(kappa, 4 / 3 * kappa, color="black", lw=1, label="closed form, 4Q/3")
    at = (0.1, 0.3, 0.6, 1.0, 1.5)
    for name, mark, colour in (("ηζ", "o", ORANGE), ("ξη", "s", BLUE), ("ξηζ", "^", GREEN)):
        runs = [frequency(name, "reduced", k) for k in at]
        ax.plot(
            at,
            runs,
            mark,
            color=colour,
            mfc="none",
            ms=5 + 3 * (mark == "s"),
            label=f"{name}, one point",
        )
        if name != "ηζ":  # with full integration this one is part of a mode along x, y and z
            full = frequency(name, "full")
            ax.axhline(full, color=colour, lw=1, ls="--", label=f"{name}, full: {full:.2f}")
    ax.set(
        xlabel="hourglass coefficient Q", ylabel="ω² ρ h² / E of the mode along x", xlim=(0, 1.6)
    )
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def deflection(cells, kappa, poisson=0.0, along=None):
    """End deflection of a cantilever of length 10 and height 1, over Timoshenko's; full integration if Q is None, and
    cubes if it is not told how many elements lie along it."""
    scene = scene_of(poisson=poisson)
    size = [10.0, 1 / cells, 1.0]
    box = {"origin": [0, 0, 0], "size": size, "cells": [along or 10 * cells, 1, cells]}
    keys = {} if kappa is None else {"integration": "reduced", "hourglass": kappa}
    scene.add_body("beam", material="elastic", box=box, **keys)
    scene.add_support("beam.x_min", fix="xz").add_support("beam.y_min", fix="y")
    scene.add("load", surface="beam.x_max", traction=[0, 0, 1e-6]).add("damping", relaxation=True)
    scene.add_probe("end", surface="beam.x_max", quantities=["displacement"])
    run = done(scene.set_time(end=3e4, fraction=0.9, until_static=1e-4))
    exact = 1e-6 * (10**3 / 3 * 12 + 10 * 2 * (1 + poisson) * 6 / 5)
    return run.probes["end"]["displacement"][-1, 2] / exact


def bending():
    """Deflection of cantilevers with one, two and four cubes through the height, over Q."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    kappa = np.linspace(0.05, 1.5, 100)
    for cells, colour in ((1, ORANGE), (2, BLUE), (4, GREEN)):
        ax.plot(
            kappa,
            1 / (1 - (1 - kappa) / cells**2),
            color=colour,
            label=f"{cells} through the height",
        )
        ax.plot((0.3, 1.0), [deflection(cells, k) for k in (0.3, 1.0)], "o", color=colour, ms=5)
        ax.plot(1.45, deflection(cells, None), "D", color=colour, ms=6)
    ax.text(1.4, 1.2, "full integration", ha="center")
    ax.axhline(1.0, color="black", lw=0.8)
    ax.set(
        xlabel="hourglass coefficient Q",
        ylabel="deflection / beam theory",
        ylim=(0, 4),
        xlim=(0, 1.55),
    )
    ax.legend(loc="upper right")
    return figure
