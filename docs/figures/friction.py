"""Pictures of the chapter on friction."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, ORANGE, RED, bare
from shared.faces import patch, patch_contact
from shared.scenes import scene_of


def rubbed():
    """Motion to and fro of a patch that is pressed on a larger one, and the friction on it, by the library."""
    low, faces = patch(0.0, True, 3, 3.0)
    high, others = patch(-0.01, False, 1)
    high = high + [1.25, 1.25, 0]  # no border of a face is crossed on the way
    mu, depth = 0.5, 0.01
    contact = patch_contact((high, others), (low, faces), friction=mu)
    way = (
        2.5
        * mu
        * depth
        * np.concatenate([np.linspace(0, 1, 60), np.linspace(1, -1, 120), np.linspace(-1, 1, 120)])
    )
    free, last, force = np.zeros_like(high), 0.0, []
    for x in way:
        v = np.zeros_like(high)
        v[:, 0] = (x - last) / 0.01
        still = np.zeros_like(low)
        contact.step(0.01, (high + [x, 0, 0], low), (v, still), (free, still), force_time=0.01)
        total = np.zeros_like(high)
        contact.add_force((total, still.copy()))
        force.append(-total[:, 0].sum() / (mu * total[:, 2].sum()))
        last = x
    return way / (mu * depth), np.array(force)


def return_map():
    """Forces before and after the return, in the plane; and the force over the motion."""
    figure = Figure(figsize=(7.5, 3.2))
    plane, loop = figure.subplots(1, 2)
    angle = np.linspace(0, 2 * np.pi, 200)
    plane.fill(np.cos(angle), np.sin(angle), color=BLUE, alpha=0.15, lw=0)
    plane.plot(np.cos(angle), np.sin(angle), color=BLUE, lw=1.4)
    plane.plot([0.55, 0.55], [-1.25, 1.25], color=RED, lw=1.2, ls="--")
    for given, back, colour in (
        ((-0.95, 1.0), (-0.69, 0.725), ORANGE),
        ((-0.5, -0.45), (-0.5, -0.45), GREEN),
        ((1.3, 0.3), (0.55, 0.3), ORANGE),
        ((1.0, 1.25), (0.55, 0.835), ORANGE),
    ):
        plane.plot(*given, "o", color=colour, ms=7)
        plane.plot(*back, "s", color=colour, ms=6)
        if given != back:
            style = {"arrowstyle": "-|>", "color": colour, "lw": 1.4}
            plane.annotate("", back, given, arrowprops=style)
    plane.text(-0.5, -0.33, r"$\mathbf{T}$", color=GREEN, ha="center")
    plane.text(-0.05, -0.78, r"$|\mathbf{T}| \leq \mu \lambda$", color=BLUE, ha="center")
    plane.text(0.62, -1.2, r"$\mathbf{T}\cdot\mathbf{c} = 2R$", color=RED)
    bare(plane, (-1.6, 1.75), (-1.4, 1.4))
    motion, force = rubbed()
    loop.plot(motion, force, color=ORANGE)
    loop.axhline(1, color=BLUE, lw=1, ls="--")
    loop.axhline(-1, color=BLUE, lw=1, ls="--")
    loop.text(0.02, 1.06, "μ N", color=BLUE)
    loop.set(xlabel="motion / (μ N / k)", ylabel="force / (μ N)", ylim=(-1.3, 1.3))
    return figure


def zones():
    """Stick and slip under a block that is pressed on a plane and pulled along it."""
    scene = scene_of(poisson=0.3)
    cells, mu = 40, 0.5
    box = {"origin": [0, 0, 0], "size": [2, 0.05, 0.5], "cells": [cells, 1, cells // 4]}
    scene.add_body("block", material="elastic", box=box)
    scene.add_support("block.y_min", fix="y")
    scene.add_support("block.y_max", fix="y")
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="block.z_min", plane=plane, friction=mu, beta=4)
    press = {"time": [0, 15, 200], "value": [0, 1, 1]}
    pull = {"time": [0, 20, 50, 200], "value": [0, 0, 1, 1]}
    scene.add("load", surface="block.z_max", traction=[0, 0, -0.01], history=press)
    scene.add("load", surface="block.z_max", traction=[0.004, 0, 0], history=pull)
    scene.add("damping", rate=0.6)
    scene.set_time(end=90.0, fraction=0.9).set_output(every=10**6, fields=[])
    state = scene.run(progress=False, output=False).state["block"]
    low = state.centres[:, 2] < 0.5 / (cells // 4)
    order = np.argsort(state.centres[low, 0])
    x, stress = state.centres[low, 0][order], state.stress[low][order]
    pressure, shear = -stress[:, 2], np.abs(stress[:, 5])
    figure = Figure(figsize=(7.5, 3.0))
    ax = figure.subplots()
    slips = shear > 0.95 * mu * pressure
    edges = np.linspace(0, 2, cells + 1)
    for a, b, slip in zip(edges, edges[1:], slips):
        ax.axvspan(a, b, ymax=0.06, color=RED if slip else GREEN, alpha=0.8, lw=0)
    ax.plot(x, mu * pressure / 0.01, color=BLUE, label="μ × pressure")
    ax.plot(x, shear / 0.01, color=ORANGE, label="shear")
    ax.set(xlabel="place x", ylabel="stress / mean pressure", xlim=(0, 2), ylim=(-0.06, None))
    ax.legend()
    return figure
