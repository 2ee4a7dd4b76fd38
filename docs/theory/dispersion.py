"""The pictures of the chapter on dispersion, and the run beside them."""

import numpy as np
from matplotlib.figure import Figure

import libcontact as ct

NU, TRAVEL = 0.3, 56.0


def column(element="hex8", integrator="central_difference", courant=0.125, travel=TRAVEL):
    """Stress of a row of unit cubes that flies against a wall, over the exact one, when c₁t is `travel` cubes."""
    cells = int(travel) + 24
    scene = ct.Scene(title="column", units={"length": "m", "mass": "kg", "time": "s"})
    young = (1 + NU) * (1 - 2 * NU) / (1 - NU)
    scene.add_material("elastic", young=young, poisson=NU, density=1.0)
    box = {"origin": [0, 0, 0], "size": [cells, 1, 1], "cells": [cells, 1, 1]}
    scene.add_body("row", material="elastic", element=element, box=box, velocity=[-1, 0, 0])
    scene.add_support("row.x_min", fix="x")
    for face in ("y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"row.{face}", fix=face[0])
    scene.set_time(end=travel, courant=courant, integrator=integrator)
    stress = scene.run(progress=False, output=False).state["row"].stress[:, 0]
    return ct.Front(np.arange(cells) + 0.5, -stress)


def long_front(distance, coefficient, travel=TRAVEL):
    """1 less the integral of Airy's function: the front of waves c k (1 - C k²h²)."""
    width = np.cbrt(3 * coefficient * travel)
    # Ai from its integral: the mean of cos(q³/3 + ξq) over q, with the path turned so that it decays.
    xi = np.linspace(-60.0 / width, 12.0, 1501)
    q = np.linspace(0.0, 25.0, 2001) * np.exp(1j * np.pi / 6)
    ai = np.array([np.trapezoid(np.exp(1j * (q**3 / 3 + x * q)), q).real for x in xi]) / np.pi
    tail = np.append(np.cumsum((ai[1:] + ai[:-1])[::-1])[::-1], 0.0) * 0.5 * (xi[1] - xi[0])
    return np.interp((distance - travel) / width, xi, tail)


def axes(figure, **labels):
    ax = figure.subplots()
    ax.set(**labels)
    ax.grid(alpha=0.3)
    return ax


def front():
    """Fig. 4 of the paper near its front, from a run, from the sum of waves, and from long waves alone."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = axes(figure, xlabel="x / h", ylabel="σx over the exact value", xlim=(20, 62))
    fine = np.linspace(20.0, 62.0, 841)
    predicted, run = ct.dispersion_front(TRAVEL, distance=fine, courant=0.125), column()
    ax.plot([20, TRAVEL, TRAVEL, 62], [1, 1, 0, 0], "k", lw=1, label="exact")
    ax.plot(fine, predicted.stress, label="sum of the waves")
    ax.plot(fine, long_front(fine, (1 - 0.125**2) / 24), "--", lw=1, label="long waves: Airy")
    ax.plot(run.distance, run.stress, "o", ms=4, label="run")
    ax.legend()
    return figure


def speeds():
    """Phase and group velocity of P waves along an axis."""
    figure = Figure(figsize=(7.5, 3.6))
    phase, group = figure.subplots(1, 2)
    part = np.linspace(0.005, 0.5, 200)
    wave = 2 * np.pi * part[:, None] * [1.0, 0.0, 0.0]
    for label, options in {
        "hex8": {},
        "hex8, consistent mass": {"mass": "consistent"},
        "hex8, leapfrog at Courant 0.7": {"courant": 0.7},
        "hex20": {"element": "hex20"},
        "hex20, consistent mass": {"element": "hex20", "mass": "consistent"},
    }.items():
        waves = ct.dispersion(wave, poisson=NU, **options)
        # The P wave is the third branch; that of hex20 with consistent mass crosses the waves above at 0.37.
        shown = part < (0.36 if label == "hex20, consistent mass" else 1.0)
        phase.plot(part[shown], waves.phase[shown, 2], label=label)
        group.plot(part[shown], waves.group[shown, 2, 0])
    phase.set(
        xlabel="edges in a wave length, h/λ", ylabel="phase velocity over c₁", ylim=(0.5, 1.3)
    )
    group.set(
        xlabel="edges in a wave length, h/λ", ylabel="group velocity over c₁", ylim=(-0.1, 1.6)
    )
    phase.legend(fontsize=8)
    for ax in (phase, group):
        ax.grid(alpha=0.3)
    return figure


def directions():
    """By how much waves of eight cubes are too slow in the directions of the plane x, y."""
    figure = Figure(figsize=(7.5, 4))
    angle = np.linspace(0.0, 2 * np.pi, 181)
    wave = 2 * np.pi / 8 * np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    for i, (element, name) in enumerate((("hex8", "hex8"), ("hex20", "hex20"))):
        ax = figure.add_subplot(1, 2, i + 1, projection="polar")
        waves = ct.dispersion(wave, element, poisson=NU)
        speed = waves.phase[:, :3] / [ct.exact.speeds(NU).c2, ct.exact.speeds(NU).c2, 1.0]
        # The S waves by the direction in which they move.
        out = np.abs(waves.shape[:, :2, 0, 2]) > 0.5
        ax.plot(angle, 100 * (1 - speed[:, 2]), label="P")
        ax.plot(
            angle, 100 * (1 - np.where(out[:, 0], speed[:, 1], speed[:, 0])), label="S in the plane"
        )
        ax.plot(angle, 100 * (1 - np.where(out[:, 0], speed[:, 0], speed[:, 1])), label="S along z")
        ax.set_title(f"{name}: too slow by … %")
        ax.set_rticks([2.0, 4.0] if element == "hex8" else [3.0, 6.0])
        ax.legend(loc="lower right", fontsize=7)
    return figure
