"""Answers of the exercises of the chapter on enforcement."""

import warnings

import numpy as np

import libcontact as ct


def test_enforcement_overlap(says):
    says(*(f"{v / 6020 / 40 * 10**p:.2f}·10{t}" for v, p, t in ((1, 6, "⁻⁶"), (100, 4, "⁻⁴"))))


def test_enforcement_mode(says):
    """The last mode of a bar of 60 elements on a spring."""
    for beta in (4, 40):
        n = 60
        K = 2 * np.eye(n + 1) - np.eye(n + 1, k=1) - np.eye(n + 1, k=-1)
        K[0, 0], K[n, n] = 1 + beta, 1
        root = np.r_[2**0.5, np.ones(n - 1), 2**0.5]
        values, vectors = np.linalg.eigh(root[:, None] * K * root)
        mode = vectors[:, -1] * root
        r = -mode[1] / mode[0]
        says(f"{1 / r:.2f}", f"{np.sqrt(values[-1]) / 2:.2f}", f"{r:.3g}")


def test_enforcement_ratio(says):
    for zeta in (0.15, 0.5):
        factor = (1 - zeta) / (1 + zeta)
        says(f"{factor:.3f}", str(int(np.ceil(np.log(0.01) / np.log(factor)))))


def bar_on_wall(fraction, **law):
    scene = ct.Scene(title="bar", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("elastic", young=1.0, poisson=0.0, density=1.0)
    box = {"origin": [2e-4, 0, 0], "size": [1, 0.05, 0.05], "cells": [10, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, velocity=[-0.01, 0, 0])
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, **law)
    scene.set_output(every=1, fields=[]).set_time(end=2.6, fraction=fraction)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return scene.run(progress=False, output=False).energy


def test_enforcement_laws(says):
    def gain(energy):
        return 100 * (energy["total"][-1] / energy["total"][0] - 1)

    lossy = [-gain(bar_on_wall(f, restitution=0.0)) for f in (0.9, 0.1)]
    says(*(f"{value:.1f} %" for value in lossy))
    default = [bar_on_wall(f) for f in (0.9, 0.1)]
    says(*(f"{-gain(energy):.3f} %" for energy in default))
    held = default[0]["reserve"].max() / default[0]["total"][0]
    assert abs(held - 0.05) < 0.005 and default[0]["reserve"][-1] == 0
    explicit = [gain(bar_on_wall(f, enforcement="penalty")) for f in (0.9, 0.1)]
    says(f"{explicit[0]:.1f} %", f"{explicit[1]:.3f} %")
