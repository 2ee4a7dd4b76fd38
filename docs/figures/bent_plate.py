"""Picture of the benchmark of a strip on a cylinder."""

import numpy as np
from libcontact.pictures.plot import draw_faces
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from problems import bending, runs


def strips():
    """The strip at rest, and the end of the contact by the elastica."""
    strip = runs.done(runs.load("bent_plate")).state["plate"]
    figure = Figure(figsize=(6.0, 4.2), layout="constrained")
    axes = figure.subplots()
    colours = np.zeros(len(strip.elements))
    draw_faces(axes, strip, "y_min", colours, (-1, 1), linewidths=0.6)
    axes.add_patch(Circle((0, -1), 1, color="0.8"))
    angle, depth = bending.plate_exact()
    sine, cosine = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    axes.plot([0, 1.15 * sine], [-1, 1.15 * cosine - 1], "k--", lw=1, label="end of the contact")
    axes.axhline(0.05 - depth, color="k", ls=":", lw=1, label="depth of the end")
    axes.set(xlim=(-0.1, 1.5), ylim=(-1.0, 0.2), xlabel="x", ylabel="z", aspect="equal")
    axes.legend(loc="upper right")
    return figure
