"""Pictures of the chapter on loads."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE, RED
from shared.scenes import bar, done, scene_of

AMPLITUDES = {
    "step": ([0.0], [1.0]),
    "ramp": ([0.0, 1.0], [0.0, 1.0]),
    "pulse": ([0.0, 0.5, 1.0], [0.0, 1.0, 0.0]),
    "jump": ([1.0, 1.0], [0.0, 1.0]),
}


def amplitudes():
    """Four amplitudes of a load at the end of a long bar, and the velocity of this end in runs of the library."""
    figure = Figure(figsize=(7.5, 3.6))
    axes = figure.subplots(2, 4, sharex=True, sharey="row")
    t = np.linspace(-0.5, 2, 501)
    for column, (name, (time, value)) in enumerate(AMPLITUDES.items()):
        axes[0, column].plot(t, np.interp(t, time, value) if name != "jump" else 1.0 * (t >= 1))
        axes[0, column].plot(time, value, "o", ms=5)
        axes[0, column].set_title(name)
        scene = bar(scene_of(), cells=150, length=3.0)
        scene.add(
            "load",
            surface="bar.x_max",
            traction=[1.0, 0, 0],
            history={"time": time, "value": value},
        )
        scene.add_probe("end", body="bar", point=[3, 0, 0], quantities=["velocity"])
        run = done(scene.set_time(end=2.0, fraction=0.9))
        axes[1, column].plot(
            run.probes["end"]["time"], run.probes["end"]["velocity"][:, 0], color=ORANGE, lw=1.2
        )
        axes[1, column].set_xlabel("time")
    axes[0, 0].set(ylabel="amplitude φ", ylim=(-0.1, 1.3), xlim=(-0.5, 2))
    axes[1, 0].set(ylabel="velocity of the end", ylim=(-0.2, 1.5))
    return figure


def nodal_forces():
    """Share of the nodes in a uniform traction on the two faces of bricks, from the library: masses times first
    accelerations."""
    figure = Figure(figsize=(7.5, 2.9))
    for ax, element in zip(figure.subplots(1, 2), ("hex8", "hex20"), strict=True):
        scene = scene_of()
        box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
        scene.add_body("cube", material="elastic", element=element, box=box)
        scene.add("load", surface="cube.z_max", traction=[0, 0, 1.0])
        run = done(scene.set_time(end=1e-3, dt=1e-3))
        body = run.state["cube"]
        place = body.mesh.nodes
        corners = np.isin(place, (0.0, 1.0)).all(axis=1)
        mass = np.full(len(place), 1 / 8)
        if element == "hex20":
            mass = np.where(corners, 7 / 248, 2 / 31)
        # From rest, one step gives the velocity f Δt / m half a step later.
        force = mass * body.displacement[:, 2] / (0.5 * run.dt**2)
        top = np.flatnonzero(np.abs(place[:, 2] - 1) < 1e-9)
        ax.fill([0, 1, 1, 0], [0, 0, 1, 1], color=GREY, alpha=0.15)
        for n in top:
            up = force[n] > 0
            colour = BLUE if up else RED
            ax.plot(*place[n, :2], "o", ms=6, color=colour)
            inwards = np.array([0.34, 0.2]) * (np.array([0.5, 0.5]) - place[n, :2])
            ax.text(
                *(place[n, :2] + inwards),
                f"{force[n]:+.3f}".replace("-", "−"),
                ha="center",
                va="center",
            )
        ax.set(title={"hex8": "Q4", "hex20": "Q8"}[element], aspect="equal")
        ax.set(xlim=(-0.1, 1.1), ylim=(-0.1, 1.1))
        ax.set_axis_off()
    return figure
