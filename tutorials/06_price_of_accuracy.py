"""
The price of accuracy
=====================

Which of two methods is better? The answer depends on the accuracy that we want and on the cost that
we accept. We draw error against cost for a few methods and meshes, on the impact of two plates. Its
exact solution is known. The chapter :doc:`/theory/accuracy` does the same with every method of the
library.

The program computes for about 4 s of one core. Each claim is followed by an ``assert``, so it
fails where a claim is wrong.
"""

# %%
# One run, one point
# ------------------
# One plate meets a wall. A *setting* says what differs from the scene file: the step and the
# integrator. A run gives one point of the picture: its mean error on Fig. 4's line, and the number
# of computed element forces.

import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from libcontact.pictures.plot import draw_curves

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)

ct.Scene.load(ct.example("plates_reference")).run(progress=False, output=False).plot()

# %%
# The plate of the scene file. Other settings are runs of this function:

E, NU, RHO, V0, d = 2.1e5, 0.3, 7.8e-9, 1000.0, 2.5  # MPa, t/mm³, mm/s, mm
LAMBDA = E * NU / ((1 + NU) * (1 - 2 * NU))
C1 = np.sqrt((LAMBDA + E / (1 + NU)) / RHO)
EVALUATIONS = {"noh_bathe": 2}  # per step; the others have one


def run(n, step, integrator="central_difference", end=0.56):
    """The plate on n x n elements until c1 t / d = end."""
    data = ct.Scene.load(ct.example("plates_reference")).data
    for body in data["body"]:
        body["box"]["cells"] = [n, 1, n]
        body["box"]["size"][1] = d / n
    data["time"] = {"end_c1t_over": {"length": d, "value": end}, "integrator": integrator, **step}
    data["output"] = {"every": 10**9}
    return ct.Scene(data).run(progress=False, output=False)


def front(result):
    """x/d and σx* in the row of elements next to z = 0."""
    body = result.state["right"]
    x, z = body.centres[:, 0] / d, body.centres[:, 2]
    row = np.flatnonzero(z < 1.5 * z.min())
    row = row[np.argsort(x[row])]
    return x[row], body.stress[row, 0] * C1 / (LAMBDA * V0)


def error(result, t):
    """The mean of \\|computed - exact\\| on the line."""
    x, stress = front(result)
    return np.mean(np.abs(stress - ct.exact.plates(x, 0 * x, t, NU).stress.sigma_x))


def point(n, step, integrator="central_difference"):
    """Computed element forces until 0.56, and the mean error of five times."""
    times = (0.52, 0.54, 0.56, 0.58, 0.60)
    results = [run(n, step, integrator, t) for t in times]
    middle = results[2]
    evaluations = int(middle.steps[-1]) * EVALUATIONS.get(integrator, 1)
    updates = middle.computed * evaluations * n * n
    return updates, np.mean([error(result, t) for result, t in zip(results, times)])


# %%
# The same mesh, two steps
# ------------------------
# The paper :cite:p:`Gabriel2012` takes a small step, the Courant number 0.125. What changes with a
# step near the stability limit?

updates, paper_error = point(100, {"courant": 0.125})
fewer, step_error = point(100, {"fraction": 0.98})
print(f"Courant number 0.125:    {updates:9.0f} element updates, error {paper_error:.4f}")
print(f"0.98 of the stable step: {fewer:9.0f} element updates, error {step_error:.4f}")

assert fewer < updates / 7 and step_error < 0.7 * paper_error

fine = np.linspace(0, 1, 2001)
exact = ct.exact.plates(fine, 0 * fine, 0.56, NU).stress.sigma_x
curves = {
    "exact": (fine, exact, "k"),
    "Courant number 0.125": front(run(100, {"courant": 0.125})),
    "0.98 of the stable step": front(run(100, {"fraction": 0.98})),
    "0.98, Tchamwa–Wielgosz": front(run(100, {"fraction": 0.98}, "tchamwa_wielgosz")),
}
fig, ax = plt.subplots(figsize=(8, 4), layout="constrained")
draw_curves(ax, curves, xlabel="x/d", ylabel=r"$\sigma_x^*$", xlim=(0.3, 0.7))
ax.set_title("The front at c$_1$t/d = 0.56")
fig.savefig(folder / "price_fronts.png", dpi=150)

# %%
# Larger steps are cheaper *and* more accurate. In a regular mesh the errors of space and of time
# have opposite signs, and at the limit they nearly cancel (:eq:`dispersion-long`).
#
# One curve per method
# --------------------
# Each method on four meshes gives a curve. On doubly logarithmic axes a power law is a straight
# line. Its slope says how much one more digit costs (:eq:`price-of-a-digit`).

methods = {
    "Courant number 0.125": ({"courant": 0.125}, "central_difference"),
    "0.98 of the stable step": ({"fraction": 0.98}, "central_difference"),
    "0.98, Noh–Bathe": ({"fraction": 0.98}, "noh_bathe"),
    "0.98, Tchamwa–Wielgosz": ({"fraction": 0.98}, "tchamwa_wielgosz"),
}
meshes = (12, 25, 50, 100)
curves = {name: np.array([point(n, *setting) for n in meshes]) for name, setting in methods.items()}


# %%
# The Pareto front
# ----------------
# A setting is useful if no cheaper one is as accurate. We go through all points from the cheapest
# to the most expensive, and keep each point that is more accurate than all before it.


def pareto(points):
    kept, best = [], np.inf
    for cost, error in sorted(points):
        if error < best:
            kept.append((cost, error))
            best = error
    return np.array(kept)


edge = pareto([tuple(point) for curve in curves.values() for point in curve])

fig, ax = plt.subplots(figsize=(8, 4.5), layout="constrained")
ax.step(edge[:, 0], edge[:, 1], where="post", color="0.8", lw=7, label="Pareto front")
for (name, curve), marker in zip(curves.items(), "osv^"):
    ax.loglog(curve[:, 0], curve[:, 1], marker=marker, label=name)
ax.plot(updates, paper_error, "*", ms=18, mfc="none", mec="k", label="the paper")
ax.set(xlabel="element updates", ylabel="mean error on Fig. 4's line", title="Work and precision")
ax.legend(frameon=False)
ax.grid(alpha=0.3)
fig.savefig(folder / "price_front.png", dpi=150)

# %%
# The paper's point is far from the front. What is the cheapest point that is as accurate?

good = [
    (curve[i, 0], curve[i, 1], name, n)
    for name, curve in curves.items()
    for i, n in enumerate(meshes)
    if curve[i, 1] <= paper_error
]
cost, found, name, n = min(good)
print(f"as accurate as the paper: {name}, d/{n}, error {found:.4f}")
print(f"with 1/{updates / cost:.0f} of the element updates")
assert updates / cost > 100

# %%
# How much does one more digit cost? The measured slopes:

for name, curve in curves.items():
    p = -np.polyfit(np.log(meshes), np.log(curve[:, 1]), 1)[0]
    q = np.polyfit(np.log(meshes), np.log(curve[:, 0]), 1)[0]
    print(f"{name:<24} error ~ h^{p:.2f}, cost ~ h^-{q:.2f}: a digit costs 10^{q / p:.1f}")
    assert 0.35 < p < 0.8 and 2.3 < q < 3.2

# %%
# At a jump each further digit is expensive for every method. So a better method pays off before a
# finer mesh. This holds for jumps: the damping that helps at a front harms a long smooth vibration
# (:doc:`/theory/integrator`).
#
# Predict, then unfold
# --------------------
# Write down each prediction before you unfold the answer; the lines below run the changes.
#
# 1. Take the last setting on half as fine a mesh, ``n = 25``. What are error and cost?
#
#    .. answer::
#
#       The error is less than twice as large, as the order is about 0.7, at a sixth of the cost.
#
# 2. Take ``{"fraction": 0.5}`` with central differences. Between which two errors does its error
#    lie?
#
#    .. answer::
#
#       Between those of the steps 0.125 and 0.98: the errors of time and space cancel only near the
#       limit.

coarse, half = (point(n, *methods["0.98, Tchamwa–Wielgosz"]) for n in (25, 50))
print(
    f"n = 25: error {coarse[1]:.4f}, cost {coarse[0]:.0f}; of n = 50: {half[1]:.4f}, {half[0]:.0f}"
)
assert 1.5 < coarse[1] / half[1] < 2 and 5.5 < half[0] / coarse[0] < 6.5

medium = point(100, {"fraction": 0.5})[1]
print(f"fraction 0.5: error {medium:.4f}")
assert step_error < medium < paper_error
