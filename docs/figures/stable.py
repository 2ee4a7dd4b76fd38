"""Pictures of the chapter on the stable step."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
from shared.scenes import scene_of


def radii():
    """Moduli of the two roots of the leapfrog, and how much too fast it vibrates, over ωΔt."""
    figure = Figure(figsize=(7.5, 2.8))
    left, right = figure.subplots(1, 2)
    x = np.linspace(0.01, 2.6, 521)
    for damping, colour in ((0.0, BLUE), (0.1, ORANGE), (0.3, GREEN)):
        d = 2 * damping * x
        roots = np.array([np.roots([1, -(2 - a - b), 1 - a]) for a, b in zip(d, x**2)])
        left.plot(x, np.abs(roots).max(axis=1), color=colour, label=f"damping {damping:.0%}")
        limit = 4 / (2 * damping + np.sqrt(4 * damping**2 + 4))
        left.plot(limit, 1, "o", color=colour, ms=5)
    left.axhline(1, color="black", lw=0.7)
    left.set(xlabel="ω Δt", ylabel="largest |λ|", ylim=(0.5, 2.2))
    left.legend(fontsize=9)
    x = x[x <= 2]
    right.plot(x, 2 * np.arcsin(x / 2) / x, color=BLUE, label="leapfrog")
    right.plot(x, 1 + x**2 / 24, "--", color=GREY, label="1 + (ωΔt)²/24")
    right.set(xlabel="ω Δt", ylabel="computed / true frequency")
    right.legend(fontsize=9)
    return figure


def cube_scene(cells, poisson, assembled=False):
    """A cube of equal bricks with edges 1."""
    scene = scene_of(poisson=poisson)
    box = {"origin": [0, 0, 0], "size": [cells] * 3, "cells": [cells] * 3}
    scene.add_body("cube", material="elastic", box=box, velocity=[1, 0, 0])
    extra = {"stable_step": "assembled"} if assembled else {}
    return scene.set_time(end=1.0, fraction=0.9, **extra)


def bounds():
    """c₁Δt/h of cubes of n³ equal bricks: by single bricks, by blocks, and the limit of the assembled matrix."""
    figure = Figure(figsize=(6.4, 3.0))
    ax = figure.subplots()
    counts = np.array([1, 2, 3, 4, 5, 6, 8])
    for poisson, colour in ((0.0, BLUE), (0.3, ORANGE)):
        c1 = ((1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))) ** 0.5
        step = lambda n, **extra: (
            c1 * cube_scene(int(n), poisson, **extra).explain().data["time"]["stable"]
        )
        one = step(1)
        ax.plot(
            counts, np.full(len(counts), one), ":", color=colour, label=f"ν = {poisson}: one brick"
        )
        ax.plot(
            counts, [step(n) for n in counts], "s", color=colour, ms=6, label="blocks of bricks"
        )
        ax.plot(
            counts,
            [step(n, assembled=True) for n in counts],
            "-",
            color=colour,
            lw=1,
            label="assembled matrix",
        )
    ax.set(xlabel="bricks per edge of the cube", ylabel="$c_1 \\Delta t / h$", ylim=(0.65, 1.04))
    ax.legend(fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure
