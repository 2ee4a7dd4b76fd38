"""The row of masses of the chapter on dispersion, its pictures, and the run beside them. Lengths in elements, speeds in
c₁."""

import numpy as np
from matplotlib.figure import Figure

import libcontact as ct

NU, TRAVEL, SPEED = 0.3, 56.0, 0.01


def row(k, courant=0.0, consistent=False):
    """Frequency and group velocity of waves k in a row of masses, lumped or consistent."""
    omega = 2 * np.sin(0.5 * k)
    if consistent:
        return omega / np.sqrt((2 + np.cos(k)) / 3), None  # (eq:dispersion-axis)
    if courant > 0:
        omega = 2 / courant * np.arcsin(courant * np.sin(0.5 * k))  # (eq:dispersion-leapfrog)
    # (eq:dispersion-axis-group)
    group = np.cos(0.5 * k) / np.sqrt(1 - (courant * np.sin(0.5 * k)) ** 2)
    return omega, group


def row_front(distance, steps, courant, shortest=2.0):
    """The stress of a row that has hit a wall, as the sum of its waves down to a wavelength."""
    travel = courant * steps
    planes = 4 * int(travel + np.max(distance) + 16)  # in a period; the neighbours stay away
    k = 2 * np.pi / planes * np.arange(1, planes // 2, 2)
    k = k[2 * np.pi / k >= shortest]
    omega, _ = row(k, courant)
    b = 4 / planes / np.tan(0.5 * k)  # (eq:front-row-start)
    height = b * np.sin(omega * travel) / np.cos(0.5 * omega * courant)
    return np.cos(np.multiply.outer(distance, k)) @ height  # (eq:front-row)


def column(element="hex8", integrator="central_difference", courant=0.125, travel=TRAVEL):
    """Stress of a row of unit cubes that flies against a wall, over the exact one, when c₁t is `travel` cubes."""
    cells = int(travel) + 24
    scene = ct.Scene(title="column", units={"length": "m", "mass": "kg", "time": "s"})
    young = (1 + NU) * (1 - 2 * NU) / (1 - NU)
    scene.add_material("elastic", young=young, poisson=NU, density=1.0)
    box = {"origin": [0, 0, 0], "size": [cells, 1, 1], "cells": [cells, 1, 1]}
    scene.add_body("row", material="elastic", element=element, box=box, velocity=[-SPEED, 0, 0])
    scene.add_support("row.x_min", fix="x")
    for face in ("y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"row.{face}", fix=face[0])
    scene.set_time(end=travel, courant=courant, integrator=integrator)
    stress = scene.run(progress=False, output=False).state["row"].stress[:, 0]
    return ct.Front(np.arange(cells) + 0.5, -stress / SPEED)


def long_front(distance, courant, travel=TRAVEL):
    """The front of long waves, c k (1 - C k²h²): an integral of Airy's function."""
    coefficient = (1 - courant**2) / 24  # (eq:dispersion-long)
    width = np.cbrt(3 * coefficient * travel)  # (eq:front-width)
    # Ai from its integral: the mean of cos(q³/3 + ηq) over q, with the path turned so that it decays.
    eta = np.linspace(-60.0 / width, 12.0, 1501)
    q = np.linspace(0.0, 10.0, 4001) * np.exp(1j * np.pi / 6)
    ai = np.array([np.trapezoid(np.exp(1j * (q**3 / 3 + x * q)), q).real for x in eta]) / np.pi
    tail = np.append(np.cumsum((ai[1:] + ai[:-1])[::-1])[::-1], 0.0) * 0.5 * (eta[1] - eta[0])
    return np.interp((distance - travel) / width, eta, tail)  # (eq:front-airy)


def front():
    """Fig. 4 of the paper near its front, from a run, from the sum of waves, and from long waves alone."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = figure.subplots()
    ax.set(xlabel="x / h", ylabel=r"$\sigma_x$ over the exact value", xlim=(20, 62))
    fine = np.linspace(20.0, 62.0, 841)
    predicted, run = row_front(fine, 448, 0.125), column()
    ax.plot([20, TRAVEL, TRAVEL, 62], [1, 1, 0, 0], "k", lw=1, label="exact")
    ax.plot(fine, predicted, label="sum of the waves")
    ax.plot(fine, long_front(fine, 0.125), "--", lw=1.2, label="long waves: Airy")
    ax.plot(run.distance, run.stress, "o", ms=4, label="run")
    ax.legend(loc="lower left")
    return figure


def speeds():
    """Phase and group velocity of P waves along an axis."""
    figure = Figure(figsize=(7.5, 4.0))
    phase, group = figure.subplots(1, 2)
    part = np.linspace(0.005, 0.5, 200)
    wave = 2 * np.pi * part[:, None] * [1.0, 0.0, 0.0]
    for label, options in {
        "hex8": {},
        "hex8, consistent mass": {"mass": "consistent"},
        "hex8, steps at Co = 0.7": {"courant": 0.7},
        "hex20": {"element": "hex20"},
        "hex20, consistent mass": {"element": "hex20", "mass": "consistent"},
    }.items():
        waves = ct.dispersion(wave, poisson=NU, **options)
        # The P wave is the third branch; that of hex20 with consistent mass crosses the waves above at 0.37.
        shown = part < (0.36 if label == "hex20, consistent mass" else 1.0)
        phase.plot(part[shown], waves.phase[shown, 2], label=label)
        group.plot(part[shown], waves.group[shown, 2, 0])
    phase.set(xlabel="edges per wavelength, h/ℓ", ylabel="phase velocity over c₁", ylim=(0.5, 1.3))
    group.set(xlabel="edges per wavelength, h/ℓ", ylabel="group velocity over c₁", ylim=(-0.1, 1.6))
    figure.legend(*phase.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def polar():
    """Phase and group velocity of P waves of three lengths in all directions of a plane of cubes."""
    figure = Figure(figsize=(7.5, 4.3))
    angle = np.linspace(0.0, 2 * np.pi, 241)
    normal = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    phase = figure.add_subplot(1, 2, 1, projection="polar")
    group = figure.add_subplot(1, 2, 2, projection="polar")
    for length in (10, 5, 3):
        waves = ct.dispersion(2 * np.pi / length * normal, poisson=NU)
        phase.plot(angle, waves.phase[:, 2], label=f"ℓ = {length} h")
        x, y = waves.group[:, 2, 0], waves.group[:, 2, 1]
        group.plot(np.arctan2(y, x), np.hypot(x, y))
    for ax, name in ((phase, "phase velocity over c₁"), (group, "group velocity over c₁")):
        ax.plot(
            angle, np.ones_like(angle), color="black", lw=1, label="exact" if ax is phase else None
        )
        ax.set_title(name, pad=14)
        ax.set(
            ylim=(0, 1.08),
            yticks=[0.5, 1.0],
            xticks=np.radians([0, 45, 90, 135, 180, 225, 270, 315]),
        )
    figure.legend(*phase.get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def modes():
    """The front of Fig. 4 as a sum: three of its waves where they are and where they should be, and sums down to a
    wavelength."""
    figure = Figure(figsize=(7.5, 3.8))
    single, sums = figure.subplots(1, 2)
    x, t = np.linspace(20.0, 62.0, 841), 448 * 0.125
    for row_of, length in enumerate((24.0, 12.0, 6.0)):
        i = 1.2 * row_of
        k = 2 * np.pi / length
        omega = row(k, 0.125)[0]
        # The half of each wave that moves to the right.
        single.plot(x, np.sin(omega * t - k * x) * 0.4 - i, label=f"ℓ = {length:g} h")
        single.plot(x, np.sin(t * k - k * x) * 0.4 - i, "--", color="black", lw=0.9)
        single.text(20.5, 0.5 - i, f"ℓ = {length:g} h")
    single.axvline(TRAVEL, color="black", lw=0.8, ls=":")
    single.set(xlabel="x / h", yticks=[], ylim=(-3.0, 0.8))
    for shortest, label in ((24.0, "ℓ ≥ 24 h"), (12.0, "ℓ ≥ 12 h"), (2.0, "all, ℓ ≥ 2 h")):
        sums.plot(x, row_front(x, 448, 0.125, shortest), label=label)
    sums.plot([20, TRAVEL, TRAVEL, 62], [1, 1, 0, 0], color="black", lw=1)
    sums.set(xlabel="x / h", ylabel=r"$\sigma_x$ over the exact value")
    sums.legend(loc="lower left")
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
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
