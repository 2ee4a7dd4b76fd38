"""
A sphere on a block: Hertz's contact
====================================

A rigid sphere is pressed into a block. How large is the force, how wide is the contact, and where
is the pressure largest? Hertz :cite:p:`Hertz1882` answered these questions for a half-space. We
compute the answer, compare it with his, and see what the mesh changes.

The program computes for about 3 s of one core. Each claim is followed by an ``assert``, so it
fails where a claim is wrong.
"""

# %%
# From a scene to a picture
# -------------------------
# ``hertz.toml`` has the sphere of radius 4 mm, which goes 0.1 mm into a quarter of a block of 8 x 8
# x 4 mm. The run takes some seconds. The picture is the vertical stress under the sphere.

import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from libcontact.pictures.plot import draw_curves, draw_faces

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)

run = ct.Scene.load(ct.example("hertz")).run(progress=False, output=False)
block = run.state["block"]

fig, ax = plt.subplots(figsize=(7, 5), layout="constrained")
image = draw_faces(ax, block, "y_min", block.stress[:, 2], (-150, 0), cmap="magma")
ax.set(xlabel="x [mm]", ylabel="z [mm]")
fig.colorbar(image, ax=ax, label=r"$\sigma_z$ [MPa]")
fig.savefig(folder / "hertz_stress.png", dpi=150)

# %%
# Hertz's answer
# --------------
# With :math:`E^* = E/(1 - \nu^2)`, the radius :math:`R` and the approach :math:`d`, the force is
# :math:`P = \tfrac43 E^* \sqrt R\, d^{3/2}`. The contact has the radius :math:`a = \sqrt{R d}`, and
# the pressure is half an ellipse, :math:`p = p_0 \sqrt{1 - r^2/a^2}` with
# :math:`p_0 = 3P/2\pi a^2`.

E, NU, R, D = 1000.0, 0.3, 4.0, 0.1  # MPa, 1, mm, mm
STAR = E / (1 - NU**2)


def hertz(depth):
    """Force, radius of the contact and largest pressure."""
    force, a = 4 / 3 * STAR * np.sqrt(R) * depth**1.5, np.sqrt(R * depth)
    return force, a, 1.5 * force / (np.pi * a**2)


def measured(run):
    """The same of a run, from the pressures at the nodes of a quarter of the surface. The second
    moment of Hertz's pressure is 2/5 of force times a², whatever the mesh does at the rim."""
    nodes = run.pressure["obstacle"][0]
    push, r = nodes["pressure"] * nodes["area"], np.hypot(*nodes["position"][:, :2].T)
    return 4 * push.sum(), np.sqrt(2.5 * (push @ r**2) / push.sum()), nodes["pressure"].max()


for name, computed, exact in zip(("force", "radius", "pressure"), measured(run), hertz(D)):
    print(f"{name}: computed {computed:.4g}, Hertz {exact:.4g}, off by {computed / exact - 1:+.1%}")
    assert abs(computed / exact - 1) < 0.25

# %%
# The block is only six radii of contact wide and deep, and its bottom is held. So it is stiffer
# than a half-space, and the same approach needs a larger force. Hertz's formulas also hold from
# the force to the radius and to the pressure. We take the computed force and look at the profile.

force, _, _ = measured(run)
deep = (0.75 * force / (STAR * np.sqrt(R))) ** (2 / 3)  # Hertz's approach for this force


def profile(run):
    """Distances from the middle, and pressures at the nodes."""
    nodes = run.pressure["obstacle"][0]
    return np.hypot(*nodes["position"][:, :2].T), nodes["pressure"]


def finer(cells):
    """The scene with so many elements along each edge, in a block of half the size."""
    data = ct.Scene.load(ct.example("hertz")).data
    data["body"][0]["box"] = {"origin": [0, 0, -2], "size": [2, 2, 2], "cells": [cells] * 3}
    del data["obstacle"][0]["beta"]
    return ct.Scene(data).run(progress=False, output=False)


# %%
# The penalty
# -----------
# The scene has ``beta = 2``, a soft penalty: the sphere sinks into the surface before it is pushed
# back, so the contact is too wide and the largest pressure too small. Without ``beta`` the penalty
# is 40 times the stiffness of an element, and both are right within 3 % at the same force. The
# block is smaller here, to have finer elements in the same time.

runs = {"elements of 0.2": finer(10), "elements of 0.125": finer(16)}
errors = []
for name, each in runs.items():
    force, a, p0 = measured(each)
    same = hertz((0.75 * force / (STAR * np.sqrt(R))) ** (2 / 3))
    errors.append((a / same[1] - 1, p0 / same[2] - 1))
    print(f"{name}: radius {errors[-1][0]:+.1%}, pressure {errors[-1][1]:+.1%} at the same force")

fig, ax = plt.subplots(figsize=(7, 4.2), layout="constrained")
curves = {name: (*profile(each), mark) for (name, each), mark in zip(runs.items(), ("C0s", "C3o"))}
fine = np.linspace(0, same[1], 200)
curves["Hertz"] = (fine, same[2] * np.sqrt(1 - (fine / same[1]) ** 2), "k--")
draw_curves(ax, curves, xlabel="radius [mm]", ylabel="pressure [MPa]", xlim=(0, 1.2))
fig.savefig(folder / "hertz_pressure.png", dpi=150)

assert np.abs(errors).max() < 0.03

# %%
# :doc:`/benchmarks/hertz_pressed` has graded meshes in a larger block, and
# :doc:`/benchmarks/hertz_impact` the same contact in an impact.
#
# Predict, then unfold
# --------------------
# Write down each prediction before you unfold the answer; the lines below run the changes.
#
# 1. Let the sphere go half as deep. What part of the force is left?
#
#    .. answer::
#
#       About :math:`2^{-3/2} = 0.354`; the soft penalty makes it less.
#
# 2. Take a material that is twice as stiff. What are force and radius?
#
#    .. answer::
#
#       Twice the force and the same radius.

data = ct.Scene.load(ct.example("hertz")).data
data["obstacle"][0]["travel"] = [0, 0, -D / 2]
half = measured(ct.Scene(data).run(progress=False, output=False))
data = ct.Scene.load(ct.example("hertz")).data
data["material"][0]["young"] *= 2
data["obstacle"][0]["history"]["time"][1] /= np.sqrt(2)
data["time"]["end"] /= np.sqrt(2)
stiff = measured(ct.Scene(data).run(progress=False, output=False))
whole = measured(run)
print(f"half as deep: {half[0] / whole[0]:.3f} of the force")
force, radius = stiff[0] / whole[0], stiff[1] / whole[1]
print(f"twice as stiff: {force:.3f} of the force, {radius:.4f} of the radius")
assert abs(half[0] / whole[0] / 0.5**1.5 - 1) < 0.1
assert abs(force - 2) < 1e-3 and abs(radius - 1) < 1e-3
