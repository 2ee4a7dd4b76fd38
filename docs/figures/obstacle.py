"""Pictures of the chapter on obstacles."""

import numpy as np
from libcontact.pictures.plot import draw_faces
from matplotlib.figure import Figure
from shared.drawing import BLUE, DARK, GREY, ORANGE, arrow, bare, line

import libcontact as ct


def shapes():
    """The three obstacles with their normals, and their gaps as contours."""
    figure = Figure(figsize=(7.5, 2.9))
    grid = np.linspace(-2, 2, 121)
    x, z = np.meshgrid(grid, grid)
    slope = np.array([0.35, 1.0]) / np.hypot(0.35, 1.0)
    axis = np.array([1.0, 0.25]) / np.hypot(1.0, 0.25)
    across = np.array([-axis[1], axis[0]])
    distances = (
        ("plane", slope[0] * x + slope[1] * z),
        ("sphere", np.hypot(x, z) - 1.0),
        ("cylinder, from the side", np.abs(across[0] * x + across[1] * z) - 0.7),
    )
    starts = (
        [
            -1.3 * np.array([slope[1], -slope[0]]),
            np.zeros(2),
            1.3 * np.array([slope[1], -slope[0]]),
        ],
        [np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.4, 2.6, 4.4)],
        [s * axis + side * 0.7 * across for s in (-1, 0.2) for side in (-1, 1)],
    )
    for ax, (name, gap), places in zip(figure.subplots(1, 3), distances, starts):
        ax.contourf(x, z, gap, [-9, 0], colors=[GREY], alpha=0.3)
        ax.contour(x, z, gap, [-0.8, -0.4, 0.4, 0.8], colors=GREY, linewidths=0.6, linestyles=":")
        ax.contour(x, z, gap, [0], colors=BLUE, linewidths=1.8)
        for place in places:
            normal = slope if name == "plane" else place / np.hypot(*place)
            if name.startswith("cylinder"):
                normal = across * np.sign(place @ across)
            arrow(ax, place, 0.55 * normal, r"$\mathbf{n}$", ORANGE)
        if name == "sphere":
            ax.plot(0, 0, "+", color="black", ms=8)
        if name.startswith("cylinder"):
            line(ax, -2 * axis, 2 * axis, color="black", lw=0.8, ls="-.")
        ax.set_title(name)
        bare(ax, (-2, 2), (-2, 2))
    return figure


def hertz():
    """A section of the block under a sphere with its stress, and the recovered pressure beside Hertz's."""
    data = ct.Scene.load(ct.example("hertz")).data
    box = {"origin": [0, 0, -3], "size": [3, 3, 3], "cells": [20, 20, 20]}
    data["body"][0] |= {"box": box}
    data["obstacle"][0]["beta"] = 10
    data["time"] |= {"end": 4e-3, "until_static": 1e-4}
    data |= {"damping": {"relaxation": True}, "output": {"every": 10**6, "fields": []}}
    run = ct.Scene(data).run(progress=False, output=False)
    (nodes,) = run.pressure["obstacle"]
    r = np.hypot(*nodes["position"][:, :2].T)
    force = 4 * -(nodes["area"] * nodes["traction"][:, 2]).sum()
    modulus, radius = 1000 / 0.91, 4.0
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    peak = 1.5 * force / (np.pi * a**2)
    figure = Figure(figsize=(7.5, 3.4))
    section, ax = figure.subplots(1, 2)
    body = run.state["block"]
    for side in (1, -1):  # the block is a quarter of the whole: mirrored
        turn, look = np.diag([side, 1]) / a, {"lw": 0.3, "edgecolors": DARK}
        down = body.stress[:, 2] / peak
        image = draw_faces(section, body, "y_min", down, (-1, 1), turn=turn, **look)
    at = np.linspace(-0.6, 0.6, 200)
    ball = data["obstacle"][0]
    centre = (ball["sphere"]["centre"][2] + ball["travel"][2]) / a
    section.plot(radius / a * np.sin(at), centre - radius / a * np.cos(at), color=ORANGE)
    section.set(xlabel="x / a", ylabel="z / a", xlim=(-2.2, 2.2), ylim=(-2.6, 0.6))
    section.grid(False)
    figure.colorbar(image, ax=section, label=r"$\sigma_z$ / peak", location="bottom", shrink=0.8)
    fine = np.linspace(0, a, 300)
    ax.plot(fine / a, np.sqrt(1 - (fine / a) ** 2), color="black", lw=1.4, label="Hertz")
    near = r < 1.5 * a
    ax.plot(r[near] / a, nodes["pressure"][near] / peak, "o", ms=4, label="pressure at the nodes")
    ax.set(xlabel="distance from the middle r / a", ylabel="pressure / peak", xlim=(0, 1.5))
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0))
    return figure
