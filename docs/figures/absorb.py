"""Picture of the chapter on absorbing boundaries."""

import numpy as np
from libcontact.mesh import Mesh
from matplotlib.figure import Figure
from shared.drawing import BLUE, ORANGE, RED
from shared.scenes import done, scene_of


def reflected(angle, poisson):
    """Amplitudes of the P and S waves that :eq:`absorb-traction` sends back, for a P wave of amplitude 1."""
    ratio = np.sqrt((1 - 2 * poisson) / (2 - 2 * poisson))  # c₂ / c₁
    p, s = angle, np.arcsin(ratio * np.sin(angle))
    found = []
    for a, b in zip(np.atleast_1d(p), np.atleast_1d(s), strict=True):
        # Waves exp i(k·x - ωt) with c₁ = ω = ρ = 1; the boundary x = 0 has the normal (1, 0).
        kz = np.sin(a)
        waves = (
            ((np.cos(a), kz), (np.cos(a), np.sin(a))),
            ((-np.cos(a), kz), (-np.cos(a), np.sin(a))),
            ((-np.cos(b) / ratio, kz), (np.sin(b), np.cos(b))),
        )
        rows = []
        for (kx, _), (ux, uz) in waves:
            normal = kx * ux + (1 - 2 * ratio**2) * kz * uz  # σxx / i
            shear = ratio**2 * (kz * ux + kx * uz)  # σxz / i
            rows.append((normal - ux, shear - ratio * uz))  # σ + ρ c v, v = -iu
        come, *back = np.array(rows)
        found.append(np.linalg.solve(np.array(back).T, -come))
    found = np.array(found)
    energy = found[:, 0] ** 2 + found[:, 1] ** 2 * ratio * np.cos(s) / np.cos(p)
    return found, energy


def oblique(half, wave, length=300, poisson=0.25):
    """
    Energy that an absorbing end of a plane strip sends back. The strip lies between two planes of symmetry at the
    distance `half`, so that its P waves of the length `wave` run at the angle arcsin(wave / 2 half) to its axis; all in
    elements.
    """
    young = (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)
    scene = scene_of(young, poisson)
    box = {"origin": [0, 0, 0], "size": [length, 1, half], "cells": [length, 1, half]}
    scene.add_body("strip", material="elastic", box=box)
    for face in ("x_min", "y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"strip.{face}", fix=face[0])
    scene.add("absorb", surface="strip.x_max")
    angle = np.arcsin(wave / (2 * half))
    omega, turn, wide = 2 * np.pi / wave, np.pi / half, wave / 4
    pulse = 12 * wave

    def push(view):
        # Forces without curl, the gradient of ψ = g(x) cos(kz), send P waves only.
        x, _, z = view.reference.T
        g = np.exp(-((x / wide) ** 2))
        shape = np.sin(np.pi * view.time / pulse) ** 2 if view.time < pulse else 0.0
        edge = np.where((z == 0) | (z == half), 0.5, 1.0) * 0.5  # mass of the nodes
        force = np.zeros_like(view.reference)
        force[:, 0] = -2 * x / wide**2 * g * np.cos(turn * z)
        force[:, 2] = -turn * g * np.sin(turn * z)
        return 1e-6 * np.sin(omega * view.time) * shape * edge[:, None] * force

    cells = (length, 1, half)
    near = np.flatnonzero(Mesh.box("hex8", [0, 0, 0], cells, cells).nodes[:, 0] < 3 * wide)
    scene.add_effect("source", "strip", near, push)
    there = length / np.cos(angle)
    scene.set_output(times=[pulse, pulse + 2.6 * there], fields=[])
    run = done(scene.set_time(end=pulse + 2.6 * there, fraction=0.9))
    held = run.energy["kinetic"] + run.energy["strain"]
    share = held[-1] / held[np.searchsorted(run.energy["time"], 0.999 * pulse)]
    # The pulse is a sum of waves of many frequencies, each with its own angle.
    w = np.linspace(1.001 * turn, 2 * omega, 800)
    t = np.linspace(0, pulse, 801)
    signal = np.sin(omega * t) * np.sin(np.pi * t / pulse) ** 2
    spectrum = np.abs(np.exp(1j * np.outer(w, t)) @ signal) ** 2
    along = np.sqrt(w**2 - turn**2)
    weight = w**3 * spectrum * np.exp(-((along * wide) ** 2) / 2) / along
    expected = (weight * reflected(np.arcsin(turn / w), poisson)[1]).sum() / weight.sum()
    return angle, share, expected


def reflection():
    """What an absorbing boundary sends back of a P wave, against the angle."""
    figure = Figure(figsize=(7.5, 3.4))
    amplitude, energy = figure.subplots(1, 2)
    angle = np.linspace(0, np.radians(89.5), 180)
    for poisson, style in ((0.25, "-"), (0.4, "--")):
        back, share = reflected(angle, poisson)
        amplitude.plot(
            np.degrees(angle), np.abs(back[:, 0]), style, color=BLUE, label=f"P, ν = {poisson}"
        )
        amplitude.plot(
            np.degrees(angle), np.abs(back[:, 1]), style, color=ORANGE, label=f"S, ν = {poisson}"
        )
        energy.plot(np.degrees(angle), share, style, color="black", label=f"formula, ν = {poisson}")
    runs = np.array([oblique(*strip) for strip in ((24, 24), (17, 24), (15, 25), (14, 25.5))])
    at = np.degrees(runs[:, 0])
    energy.plot(at, runs[:, 1], "o", color=RED, label="runs of pulses, ν = 0.25")
    energy.plot(at, runs[:, 2], "s", mfc="none", color=BLUE, ms=9, label="formula for the pulses")
    amplitude.set(
        xlabel="angle of incidence, degrees", ylabel="amplitude", xlim=(0, 90), ylim=(0, 1.05)
    )
    energy.set(
        xlabel="angle of incidence, degrees",
        ylabel="reflected energy",
        xlim=(0, 90),
        ylim=(0, 1.05),
    )
    amplitude.legend(loc="upper left")
    energy.legend(loc="upper left")
    return figure
