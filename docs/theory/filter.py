"""The pictures of the chapter on the filter of what is shown."""

import numpy as np
from matplotlib.figure import Figure

import libcontact as ct

NU = 0.3
CELLS = 40
HOURGLASS = 3.231  # H' = 0.8


def plate(cells=CELLS, passes=2):
    """The scene of the reference plate of Figs. 4 and 5 at c₁t = 0.56 d, in units d = ρ = v₀ = c₁ = 1."""
    young, h = (1 + NU) * (1 - 2 * NU) / (1 - NU), 1 / cells
    scene = ct.Scene(title="plate", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("steel", young=young, poisson=NU, density=1.0)
    box = {"origin": [0, 0, 0], "size": [1, h, 1], "cells": [cells, 1, cells]}
    control = {"integration": "reduced", "hourglass": HOURGLASS}
    scene.add_body("plate", material="steel", box=box, velocity=[-1e-3, 0, 0], **control)
    for face in ("x_min", "z_min", "y_min", "y_max"):
        scene.add_support(f"plate.{face}", fix=face[0])
    scene.set_output(filter=passes)
    return scene.set_time(end=0.56, fraction=0.98)


def transfer():
    """The factor of P waves along an axis against the wave number."""
    figure = Figure(figsize=(7.5, 3.6))
    sharp, weak = figure.subplots(1, 2, sharey=True)
    part = np.linspace(0.0, 0.5, 201)
    s = np.sin(np.pi * part) ** 2
    for ax, q, title in ((sharp, 1.0, "q = 1"), (weak, 0.54, "q = 0.54")):
        for passes in (1, 2, 3, 8):
            ax.plot(part, (1 - q * s) ** passes, label=f"b = {passes}")
        ax.set(xlabel="edges in a wave length, h/λ", title=title, xlim=(0, 0.5))
        ax.grid(alpha=0.3)
    sharp.set_ylabel("factor of a wave")
    sharp.legend()
    return figure


def lines():
    """The lines of Fig. 4 and Fig. 5, as computed and filtered twice."""
    figure = Figure(figsize=(7.5, 3.6))
    body = plate().run(progress=False, output=False).state["plate"]
    x, _, z = body.centres.T
    row, place = np.flatnonzero(z < 0.6 / CELLS), np.linspace(0.0, 1.0, 1001)
    beside = np.abs(x - 0.4) < 0.6 / CELLS
    column = np.unique(z.round(9))
    scale = (1 - NU) / NU / 1e-3
    for ax, at, axis, name in zip(
        figure.subplots(1, 2), (x[row], column), (0, 2), ("x/d", "z/d"), strict=True
    ):
        for label, shown in (("as computed", body), ("filtered twice", body.filtered)):
            stress = shown.stress[:, axis] * scale
            if axis == 0:
                order = np.argsort(at)
                ax.plot(at[order], stress[row][order], ".-", ms=3, lw=0.8, label=label)
            else:
                mean = [stress[beside & (np.abs(z - own) < 1e-6)].mean() for own in column]
                ax.plot(column, mean, ".-", ms=3, lw=0.8, label=label)
        points = (place, 0 * place) if axis == 0 else (0 * place + 0.4, place)
        exact = ct.exact.plates(*points, 0.56, NU).stress
        ax.plot(place, exact.sigma_x if axis == 0 else exact.sigma_z, "k", lw=0.8, label="exact")
        ax.set(xlabel=name)
        ax.grid(alpha=0.3)
    figure.axes[0].set_ylabel("σx*, σz* (right)")
    figure.axes[0].legend()
    return figure
