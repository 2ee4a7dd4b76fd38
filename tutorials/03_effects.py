"""
A scene pays only for what it calls for
=======================================

We drop a steel rod on a concrete pad and add one effect at a time: weight, contact, an absorbing
boundary, damping, and a force of our own. We predict how each effect changes the motion. Each
effect also costs time, which ``explain`` predicts and the run measures. An effect that the scene
does not name costs no time and no memory, and does not change the result.
"""

# %%
# Two bodies and nothing else
# ---------------------------
# The rod is 400 mm long and starts 1 mm above the pad. Without further effects it keeps its
# velocity.

import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from libcontact.pictures.plot import draw_costs, draw_curves

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)

G = 9810.0  # mm/s^2
V = 1000.0  # mm/s, downwards
GAP = 1.0  # mm
END = 1.4e-3  # s


def base():
    """The rod above the pad: the start of each scene."""
    scene = ct.Scene(title="A rod falls on a pad", units={"length": "mm", "mass": "t", "time": "s"})
    scene.add_material("steel", young=2.1e5, poisson=0.3, density=7.8e-9)
    scene.add_material("concrete", young=3e4, poisson=0.2, density=2.4e-9)
    rod = {"origin": [-10, -10, GAP], "size": [20, 20, 400], "cells": [2, 2, 40]}
    pad = {"origin": [-50, -50, -100], "size": [100, 100, 100], "cells": [10, 10, 10]}
    scene.add_body("rod", material="steel", velocity=[0, 0, -V], box=rod)
    scene.add_body("pad", material="concrete", box=pad)
    return scene.set_time(end=END, fraction=0.5).set_output(every=25)


def tip(run):
    """Height of the rod's lower end at the end of the run [mm]."""
    state = run.state["rod"]
    return state.positions[state.nodes[:, 2] == GAP, 2].mean()


runs, plans = {}, {}


def compute(name, scene):
    """The faster of two runs with the same bits; other programs may have slowed one of them."""
    runs[name] = min((scene.run(progress=False) for _ in range(2)), key=lambda run: run.seconds)
    plans[name] = scene.costs(runs[name])
    return runs[name]


run = compute("bodies", base())
# It flies through the pad: no contact is declared.
assert abs(tip(run) - (GAP - V * END)) < 1e-12
assert run.energy["strain"].max() < 1e-20

# %%
# Weight
# ------
# In free fall the leapfrog gives :math:`v t + \frac12 g t^2` without error
# (:doc:`/theory/gravity`).

run = compute("+ gravity", base().add("gravity", acceleration=[0, 0, -G], bodies=["rod"]))
assert abs(tip(run) - (GAP - V * END - 0.5 * G * END**2)) < 1e-12

# %%
# Contact
# -------
# Now the rod lands on the pad. It starts within the size of a face from the pad, so each of its
# points searches the nearest face in every step. From the first touch on, contact forces are
# computed, too. Bodies that are farther apart are not searched (:doc:`/theory/savings`).


def with_contact():
    scene = base().add("gravity", acceleration=[0, 0, -G], bodies=["rod"])
    return scene.add_contact("rod.z_min", "pad.z_max", beta=1).add_support("pad.z_min", fix="xyz")


run = compute("+ contact", with_contact())
assert tip(run) > -0.2  # it does not fall through
start = run.energy["total"][0]
assert np.max(np.abs(run.energy["total"] - start)) < 0.01 * start

# %%
# An absorbing boundary
# ---------------------
# The pad is a part of a larger ground. A fixed bottom would reflect every wave; an absorbing
# boundary (:doc:`/theory/absorb`) lets waves leave. The energy balance shows how much energy
# leaves.


open_ground = with_contact().data
open_ground["absorb"] = [
    {"surface": f"pad.{face}"} for face in ("z_min", "x_min", "x_max", "y_min", "y_max")
]
del open_ground["support"]
run = compute("+ absorb", ct.Scene(open_ground))
left = -run.energy["absorb"][-1]
assert 0 < left < start
print(f"{left:.3g} mJ, {100 * left / start:.2g} % of the energy, have left through the boundary")

# %%
# Damping
# -------
# The rod vibrates after the impact. Damping takes this energy away.

damped = ct.Scene(open_ground).add("damping", rate=200.0, bodies=["rod"])
run = compute("+ damping", damped)
assert run.energy["damping"][-1] < 0

# %%
# A force of our own
# ------------------
# A spring holds the upper end; we write it here. It is an effect like the others: it has a column
# in the energy balance, a part in the bound on the step, and a row in the plan. It slows the rod,
# which lands more softly.


K = 30.0  # N/mm on each node of the upper end
data = damped.data
held = ct.Scene(data).add_effect(
    "spring",
    "rod",
    "z_max",
    lambda view: -K * view.displacement,
    energy=lambda view: 0.5 * K * np.sum(view.displacement**2),
    omega_squared=K / (7.8e-9 * 1000 / 4),
)
run = compute("+ a spring", held)
assert run.energy["spring"][-1] > 0
assert run.energy["contact"].max() > 0

# %%
# In every step the work of all effects equals the change of the kinetic energy, to round-off.

for name, run in runs.items():
    scale = max(run.energy["kinetic"].max(), 1e-30)
    assert np.max(np.abs(run.energy["balance"])) < 1e-12 * scale, name

# %%
# What each adds
# --------------
# The velocity of the rod shows what an effect does; the bars show its cost: above what was
# measured, below, pale, what was predicted before the run. The absorbing boundary costs more than
# its own force: it damps the small masses of edges and corners so strongly that the stable step
# falls to a third. All effects are then computed three times as often. The column "of the bound"
# in the table at the end shows this. The times are those of the machine that ran this script, and
# the prediction assumes that no other program runs.

curves = {}
for name, run in runs.items():
    rod = run.body_momentum("rod")
    curves[name] = (1e3 * rod["time"], rod["p"][:, 2] / (7.8e-9 * 20 * 20 * 400) / 1000, "-")
curves["+ gravity"] = (*curves["+ gravity"][:2], "k--")
notes = [f"{run.steps[-1]} steps" for run in runs.values()]

fig, (left, right) = plt.subplots(1, 2, figsize=(8, 4.4), layout="constrained")
labels = {"xlabel": "time [ms]", "ylabel": "mean velocity of the rod [m/s]"}
draw_curves(left, curves, title="What each effect does", **labels)
draw_costs(right, plans, notes)
right.set_title("What it costs")
fig.savefig(folder / "effects.png", dpi=150)

# %%
# The plan of the last scene, beside the measured times. *Work* is the fraction of the elements
# that the waves have reached, and of the steps in which the surfaces are in contact. The chapter
# :doc:`/theory/plan` explains the prediction.

print(held.cost_table(runs["+ a spring"]))

# %%
# Change this, expect that
# ------------------------
# 1. Let gravity act on both bodies (leave out ``bodies``). Expect no visible change: the weight of
#    the pad moves the tip by less than 0.001 mm.
# 2. Double the length of the rod, with twice as many cells. Expect that contact, which begins at
#    1 ms, lasts nearly twice as long: it ends when the wave returns from the upper end.
# 3. Take half the step, ``fraction = 0.25``. Expect twice as many steps, and the same tip to within
#    0.001 mm: this error is not the time step's.


def varied(length=400, fraction=0.5, gravity=None):
    """The scene with contact; the number of steps, the tip's height, and when contact ends."""
    data = with_contact().data
    data["body"][0]["box"] |= {"size": [20, 20, length], "cells": [2, 2, length // 10]}
    data["time"] |= {"fraction": fraction, "end": 1.4e-3}
    data["gravity"] = gravity or data["gravity"]
    run = ct.Scene(data).run(progress=False, output=False)
    touching = run.time[run.energy["contact"] > 1e-6 * run.energy["contact"].max()]
    print(
        f"{run.steps[-1]} steps, tip {tip(run):.4f} mm, contact until {1e3 * touching[-1]:.2f} ms"
    )
    return run.steps[-1], tip(run), touching[-1]


first = varied()
heavy = varied(gravity={"acceleration": [0, 0, -G]})
long = varied(length=800)
small = varied(fraction=0.25)
assert abs(heavy[1] - first[1]) < 1e-3
assert 1.7 < (long[2] - 1e-3) / (first[2] - 1e-3) < 2.0
assert abs(small[0] - 2 * first[0]) <= 1 and abs(small[1] - first[1]) < 1e-3
