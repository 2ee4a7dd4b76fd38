"""Picture of the chapter on averaged masses."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE
from shared.scenes import bar, done, scene_of

import libcontact as ct


def masses():
    """Phase velocity of P waves with three masses at a Courant number of 0.5, along an axis and across, and two fronts."""
    figure = Figure(figsize=(7.5, 5.4))
    grid = figure.add_gridspec(2, 2, height_ratios=[1, 0.9])
    axis, across = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    part = np.linspace(0.005, 0.5, 150)
    for ax, way, title in (
        (axis, [1.0, 0.0, 0.0], "along an axis"),
        (across, [0.5**0.5, 0.0, 0.5**0.5], "at 45°"),
    ):
        wave = 2 * np.pi * part[:, None] * way
        for mass, colour in (("lumped", GREY), ("consistent", ORANGE), ("averaged", BLUE)):
            courant = 0.0 if mass == "consistent" else 0.5
            speed = ct.dispersion(wave, mass=mass, courant=courant).phase[:, 2]
            ax.plot(part, speed, color=colour, label=mass)
        ax.axhline(1.0, color="black", lw=0.8)
        ax.set(title=title, xlabel="edges in a wave length, h/λ", ylim=(0.5, 1.35), xlim=(0, 0.5))
    axis.set_ylabel("phase velocity / c₁")
    across.legend(loc="upper left")
    front = figure.add_subplot(grid[1, :])
    for averaged, colour, label in ((False, GREY, "lumped"), (True, BLUE, "averaged")):
        scene = bar(scene_of(), cells=100, length=100.0, velocity=[-1, 0, 0])
        scene.add_support("bar.x_min", fix="x")
        if averaged:
            scene.add("averaging")
        body = done(scene.set_time(end=56.0, courant=0.5)).state["bar"]
        order = np.argsort(body.centres[:, 0])
        front.plot(
            body.centres[order, 0],
            -body.stress[order, 0],
            ".-",
            ms=4,
            lw=1,
            color=colour,
            label=label,
        )
    front.plot([0, 56, 56, 80], [1, 1, 0, 0], color="black", lw=0.8)
    front.set(
        xlabel="distance from the wall, elements",
        ylabel="stress / exact",
        xlim=(20, 66),
        ylim=(-0.1, 1.4),
    )
    front.legend(loc="lower left")
    return figure
