"""Pictures of the chapter on large strain."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
from shared.scenes import done, scene_of


def stress_at(law, gradient, poisson=0.3):
    """Cauchy's stress over E of a cube with this displacement gradient: one step of forces m u / (Δt²/2) leads there
    from rest."""
    gradient = np.asarray(gradient, dtype=float)
    scene = scene_of(poisson=poisson, **law)
    box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
    scene.add_body("cube", material="elastic", box=box)
    dt = 1e-3

    def force(view):
        return (view.time == 0.0) * (view.reference @ gradient.T) / 8 * 2 / dt**2

    scene.add_effect("there", "cube", np.arange(8), force)
    return done(scene.set_time(end=dt, dt=dt, energy_limit=1e12)).state["cube"].stress[0]


LAWS = {
    "Hooke, small strain": ({}, GREY),
    "St. Venant-Kirchhoff": ({"law": "st_venant_kirchhoff"}, BLUE),
    "neo-Hookean": ({"law": "neo_hookean"}, ORANGE),
}


def turning():
    """Stress of a cube that only turns, and strains of a bar that is stretched."""
    figure = Figure(figsize=(7.5, 4.0))
    turn, strain = figure.subplots(1, 2)
    angle = np.linspace(0, 180, 181)
    lame, shear = 0.3 / (1.3 * 0.4), 1 / 2.6
    swell = 1 - np.cos(np.radians(angle))
    turn.plot(
        angle, -(2 * lame + 2 * shear) * swell, color=GREY, lw=1, label="Hooke: −2(Λ+μ)(1−cos φ)"
    )
    for name, (law, colour) in LAWS.items():
        at = np.arange(15, 181, 30.0)
        found = []
        for a in np.radians(at):
            gradient = [[np.cos(a) - 1, -np.sin(a), 0], [np.sin(a), np.cos(a) - 1, 0], [0, 0, 0]]
            found.append(stress_at(law, gradient)[0])
        turn.plot(at, found, "o", color=colour, ms=7 if "St" in name else 4, label=name)
    turn.set(xlabel="angle of rotation, degrees", ylabel="σxx / E", xlim=(0, 180))
    turn.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), fontsize=9)
    a = np.linspace(0.05, 2, 200)
    for label, value, colour in (
        ("small strain, a − 1", a - 1, GREY),
        ("Green–Lagrange, (a² − 1)/2", (a**2 - 1) / 2, BLUE),
        ("logarithm, ln a", np.log(a), GREEN),
    ):
        strain.plot(a, value, color=colour, label=label)
    strain.set(xlabel="stretch a", ylabel="strain", xlim=(0, 2), ylim=(-2, 1.6))
    strain.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), fontsize=9)
    return figure


def stretching():
    """Force per undeformed area of a bar whose sides are held, over its stretch."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    a = np.linspace(0.12, 1.8, 300)
    lame, shear = 0.3 / (1.3 * 0.4), 1 / 2.6
    stiff = lame + 2 * shear
    closed = (stiff * (a - 1), stiff / 2 * a * (a**2 - 1), shear * (a - 1 / a) + lame * (a - 1))
    for (name, (law, colour)), force in zip(LAWS.items(), closed, strict=True):
        ax.plot(a, force, color=colour, label=name)
        at = (0.25, 0.4, 0.577, 0.8, 1.0, 1.3, 1.6)
        found = [stress_at(law, np.diag([stretch - 1, 0, 0]))[0] for stretch in at]
        ax.plot(at, found, "o", color=colour, ms=4)
    ax.axvline(1 / np.sqrt(3), color=BLUE, lw=0.8, ls="--")
    ax.text(1 / np.sqrt(3) + 0.01, 1.2, "1/√3", color=BLUE)
    ax.set(xlabel="stretch a", ylabel="P / E", ylim=(-3, 2), xlim=(0, 1.8))
    ax.legend(loc="lower right")
    return figure
