"""Pictures of the chapter on contact between many faces."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE, RED, bare, line

import libcontact as ct


def nearest():
    """Points over a ridge of two faces: the face and the closest point that the library names."""
    nodes = np.array(
        [[-1, 0, 0], [-1, 1, 0], [0, 1, 0.5], [0, 0, 0.5], [1, 0, 0], [1, 1, 0]], float
    )
    faces = [[0, 3, 2, 1], [3, 4, 5, 2]]
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.uniform(-1, 1, 60), np.full(60, 0.5), rng.uniform(0.4, 1.5, 60)])
    keep = points[:, 2] > 0.58 - 0.5 * np.abs(points[:, 0])
    points = points[keep]
    found = [ct.project("Q4", nodes[face], points) for face in faces]
    distance = np.array([f.distance for f in found])
    face = distance.argmin(axis=0)
    figure = Figure(figsize=(6.4, 3.0))
    ax = figure.subplots()
    for y, f in zip(points, range(len(points))):
        at = found[face[f]].point[f]
        colour = BLUE if face[f] == 0 else ORANGE
        line(ax, y[[0, 2]], at[[0, 2]], color=colour, lw=0.6, ls="--")
        ax.plot(*y[[0, 2]], "o", color=colour, ms=4)
    ax.plot([-1, 0, 1], [0, 0.5, 0], color="black", lw=2)
    ax.text(-0.72, 0.02, "face 0", color=BLUE)
    ax.text(0.5, 0.02, "face 1", color=ORANGE)
    bare(ax, (-1.1, 1.1), (-0.05, 1.55))
    return figure


def unseen():
    """What Gauss points of a square face leave out, and the points of Lobatto's rule."""
    figure = Figure(figsize=(7.5, 2.9))
    gauss, corner, lobatto = figure.subplots(1, 3)
    at = 0.5 / np.sqrt(3)
    for ax in (gauss, lobatto):
        ax.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color="black", lw=1.5)
    for x in (-at, at):
        for y in (-at, at):
            gauss.plot(x, y, "s", color=BLUE, ms=6)
            circle = np.linspace(0, 2 * np.pi, 100)
            r = (0.5 - at) * np.sqrt(2)
            gauss.plot(x + r * np.cos(circle), y + r * np.sin(circle), color=BLUE, lw=0.7)
    line(gauss, (at, at), (0.5, 0.5), color=RED, lw=1.8)
    gauss.text(0.4, 0.6, "0.299 h", color=RED, ha="center")
    for x in (-0.5, 0, 0.5):
        for y in (-0.5, 0, 0.5):
            lobatto.plot(x, y, "s", color=ORANGE, ms=6)
    side = np.array([1.0, 1.0]) / np.sqrt(2)
    tip = np.array([0.0, -0.13])
    for way in (1, -1):
        edge = side * [way, 1]
        line(corner, tip, tip + 0.95 * edge, color="black", lw=1.8)
        for s in (0.5 - at, 0.5 + at):
            corner.plot(*(tip + 0.95 * s * edge), "s", color=BLUE, ms=6)
    corner.fill_between([-0.7, 0.7], [-0.6, -0.6], [0, 0], color=GREY, alpha=0.25, lw=0)
    line(corner, (-0.7, 0), (0.7, 0), color=GREY, lw=1.5)
    corner.plot(*tip, "o", color=RED, ms=6)
    gauss.set_title("Gauss points")
    corner.set_title("a corner comes in unseen")
    lobatto.set_title("Lobatto points")
    for ax in (gauss, corner, lobatto):
        bare(ax, (-0.75, 0.75), (-0.7, 0.75))
    return figure
