"""
Two thick plates collide
========================

Two plates, 5 mm thick and 2.5 mm long, meet at 1 m/s each. The paper :cite:p:`Gabriel2012` computes
this impact to show that its contact algorithm is accurate and preserves symmetry. We compute the
same impact, draw the paper's Figs. 3, 4 and 5, and compare each curve with the exact solution
(:doc:`/theory/exact`).

The program computes for about 14 s of one core. Each claim is followed by an ``assert``, so it
fails where a claim is wrong.
"""

# %%
# The scene
# ---------
# The plane z = 0 is a plane of symmetry, so we compute one half of each plate: one layer of 100 x
# 100 bricks per plate, held in y (plane strain). The scene file says all of this; ``explain``
# lists what will be computed.

import os
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from libcontact.pictures.plot import draw_curves, draw_faces, draw_fronts

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)
# Whether to print how long each run takes, and what else depends on this machine.
TIMES = os.environ.get("LIBCONTACT_TIMES", "yes") != "no"

scene = ct.Scene.load(ct.example("plates"))
results = folder / "plates.vtkhdf" if ct.has("hdf5") else False
contact = scene.run(output=results)
contact.plot()

# %%
# The picture shows the stress along the impact at four instants, and the energy balance. The waves
# start from the contact, and the free edges send waves after them.

if not results:
    print("plates.vtkhdf is left out: this build has no HDF5")
explanation = scene.explain()
print(
    explanation
    if TIMES
    else explanation[explanation.index("Bodies") : explanation.index("Cost")].rstrip()
)

# %%
# Three runs
# ----------
# The *contact* run has both plates. In the *reference* run the right plate alone meets a wall. By
# symmetry this is the same problem, without contact. The difference between the two runs is the
# error that the contact adds.
#
# The *damped* run has an integrator that damps the highest frequencies of the mesh, half as many
# elements along each edge, 0.98 of the stable step, and the default contact law. It is the best buy
# of :doc:`/theory/accuracy` on a finer mesh: that chapter takes means over nine times, for which
# d/25 is enough. At the one instant of the figures the paper's error on Fig. 5's line happens to
# be three times smaller than its mean.

reference = ct.Scene.load(ct.example("plates_reference")).run(output=False)

d = 2.5  # mm, half the thickness


def refined(name, n):
    """The scene with n x n bricks a plate."""
    data = ct.Scene.load(ct.example(name)).data
    for body in data["body"]:
        body["box"]["cells"] = [n, 1, n]
        body["box"]["size"][1] = d / n
    data["output"]["every"] = 10**9
    return ct.Scene(data)


data = refined("plates", 50).data
del data["time"]["courant"]
data["time"] |= {"fraction": 0.98, "integrator": "tchamwa_wielgosz"}
data["contact"] = [{"surfaces": data["contact"][0]["surfaces"]}]
best = ct.Scene(data).run(output=False, progress=False)

NU = 0.3
T = 0.56  # c1 t / d

# %%
# We divide by the units of the problem: :math:`\sigma^* = \sigma c_1 / (\Lambda v_0)`. The plane
# wave then has :math:`\sigma_z^* = -1` and :math:`\sigma_x^* = -(1 - \nu)/\nu = -7/3`.

E, RHO, V0 = 2.1e5, 7.8e-9, 1000.0  # MPa, t/mm³, mm/s
LAMBDA = E * NU / ((1 + NU) * (1 - 2 * NU))
C1 = np.sqrt((LAMBDA + E / (1 + NU)) / RHO)
PLATEAU = (1 - NU) / NU


def fields(body):
    """Element centres x/d and z/d and the stresses σ* of one body."""
    return body.centres[:, 0] / d, body.centres[:, 2] / d, body.stress * C1 / (LAMBDA * V0)


# %%
# The cost of a run is the number of computed element forces per plate, divided by the :math:`448
# \cdot 100^2` of the paper. Its error is the mean of \|computed - exact\| on the line of the
# figure.


CURVES = {
    "reference": "the paper's setting, reference (symmetry)",
    "contact": "the paper's setting, contact",
    "best": "damped, d/50, contact",
}


def cost(result, n):
    """Computed element forces a plate over those of the paper."""
    return result.computed * result.steps[-1] * n**2 / (448 * 100**2)


def named(name, result, n, off):
    """What a curve is called: its run, its error and its cost."""
    error = np.mean(np.abs(off[name]))
    return f"{CURVES[name]}: error {error:.4f}, cost {cost(result, n):.2g}"


# %%
# Fig. 4: the longitudinal stress along x at z = 0
# ------------------------------------------------
# We take the row of elements next to z = 0. Waves from the free faces have not reached it yet, so
# the exact solution is a single jump. Elements cannot represent a jump: the stress oscillates
# behind the front. This is dispersion (:doc:`/theory/dispersion`), and the reference without
# contact shows it too. Contact adds the peak in the two elements at x = 0: there the nodes vibrate
# on the penalty, faster than any wave of the mesh, so no wave takes this away (:eq:`surface-mode`).


def fig4_line(body):
    """x/d and σ_x* in the row of elements next to z = 0."""
    x, z, stress = fields(body)
    row = z < z.min() * 1.5
    order = np.argsort(x[row])
    return x[row][order], stress[row][order, 0]


def exact_fig4(x):
    return ct.exact.plates(np.abs(x), np.zeros_like(x), T, NU)[0].sigma_x


x_left, sx_left = fig4_line(contact.state["left"])
x_right, sx_right = fig4_line(contact.state["right"])
x_reference, sx_reference = fig4_line(reference.state["right"])
fig4 = {
    "x_over_d": np.concatenate([x_left, x_right]),
    "contact": np.concatenate([sx_left, sx_right]),
    "reference": np.concatenate([sx_reference[::-1], sx_reference]),
}
fig4["exact"] = exact_fig4(fig4["x_over_d"])
x_best, sx_best = (
    np.concatenate(parts)
    for parts in zip(*(fig4_line(best.state[name]) for name in ("left", "right")))
)
fig4_best = {"x_over_d": x_best, "best": sx_best, "exact": exact_fig4(x_best)}
off4 = {
    "contact": fig4["contact"] - fig4["exact"],
    "reference": fig4["reference"] - fig4["exact"],
    "best": sx_best - fig4_best["exact"],
}

fine = np.linspace(-1, 1, 2001)
x4 = fig4["x_over_d"]
curves = {
    "exact": (fine, exact_fig4(fine), "k"),
    named("reference", reference, 100, off4): (x4, fig4["reference"], "C0"),
    named("contact", contact, 100, off4): (x4, fig4["contact"], "C3--"),
    named("best", best, 50, off4): (x_best, sx_best, "C1"),
}
fig, ax = plt.subplots(figsize=(8, 5.2), layout="constrained")
draw_curves(ax, curves, "below", xlabel="x/d", ylabel=r"$\sigma_x^*$", xlim=(-1, 1))
ax.set_title("Fig. 4: longitudinal stress along x at z/d = 0, c$_1$t/d = 0.56")
fig.savefig(folder / "fig4.png", dpi=150)

# %%
# Fig. 5: the transversal stress along z at x/d = 0.4
# ---------------------------------------------------
# We take the mean of the two columns of elements beside x/d = 0.4. Here the waves from the free
# faces are visible: the circular dilatational wave at z/d = 0.608 and the head wave at 0.899. The
# paper used the series of 300 Rayleigh-Lamb branches as its exact solution.


def fig5_line(body):
    """z/d and σ_z*, the mean of the two columns of elements beside x/d = 0.4."""
    x, z, stress = fields(body)
    h = 2 * z.min()
    near = np.flatnonzero(np.abs(x - 0.4) < 0.75 * h)
    near = near[np.lexsort((x[near], z[near]))].reshape(-1, 2)
    return z[near].mean(axis=1), stress[near, 2].mean(axis=1)


def exact_fig5(z):
    return ct.exact.plates(np.full_like(z, 0.4), z, T, NU)[0].sigma_z


z, sz_contact = fig5_line(contact.state["right"])
fig5 = {
    "z_over_d": z,
    "contact": sz_contact,
    "reference": fig5_line(reference.state["right"])[1],
    "exact": exact_fig5(z),
}
z_best, sz_best = fig5_line(best.state["right"])
fig5_best = {"z_over_d": z_best, "best": sz_best, "exact": exact_fig5(z_best)}
off5 = {name: fig5[name] - fig5["exact"] for name in ("contact", "reference")}
off5["best"] = sz_best - fig5_best["exact"]
try:
    fig5["series"] = ct.exact.plates_series(np.full_like(z, 0.4), z, T, NU, branches=300)[0].sigma_z
except ct.NotBuiltIn:
    fig5["series"] = np.full_like(z, np.nan)
    print("the series is left out: this build has no GSL")

fine = np.linspace(0, 1, 2001)
curves = {
    "exact (closed form)": (fine, exact_fig5(fine), "k"),
    "series, 300 branches": (z, fig5["series"], "C2"),
    named("reference", reference, 100, off5): (z, fig5["reference"], "C0"),
    named("contact", contact, 100, off5): (z, fig5["contact"], "C3--"),
    named("best", best, 50, off5): (z_best, fig5_best["best"], "C1"),
}
fig, ax = plt.subplots(figsize=(8, 5.4), layout="constrained")
draw_curves(ax, curves, "below", xlabel="z/d", ylabel=r"$\sigma_z^*$", xlim=(0, 1))
ax.set_title("Fig. 5: transversal stress along z at x/d = 0.4, c$_1$t/d = 0.56")
fig.savefig(folder / "fig5.png", dpi=150)

# %%
# Fig. 3: the waves
# -----------------
# The computed :math:`\sigma_z^*` of both plates, mirrored at z = 0, with the wave fronts of the
# theory. Behind the plane front the state is uniform. The waves from the corners of the contact
# plane release it.

fig, ax = plt.subplots(figsize=(8, 7), layout="constrained")
for body in (contact.state["left"], contact.state["right"]):
    stress = fields(body)[2][:, 2]
    for mirror in (1, -1):
        turn, look = np.diag([1, mirror]) / d, {"lw": 0, "rasterized": True}
        image = draw_faces(ax, body, "y_min", stress, (-1.5, 1.5), scale=0, turn=turn, **look)
draw_fronts(ax, T, NU)
fig.colorbar(image, ax=ax, label=r"$\sigma_z^*$", shrink=0.8)
ax.set(xlabel="x/d", ylabel="z/d", xlim=(-1, 1), ylim=(-1, 1))
ax.set_title("Fig. 3: wave fronts at c$_1$t/d = 0.56")
ax.legend(loc="upper center", ncols=5, fontsize=9, bbox_to_anchor=(0.5, -0.08), frameon=False)
fig.savefig(folder / "fig3.png", dpi=150)

# %%
# We write the curves as tables, to compare numbers. The damped run has tables of its own, because
# its mesh differs.

tables = {"fig4": fig4, "fig5": fig5, "fig4_best": fig4_best, "fig5_best": fig5_best}
for name, columns in tables.items():
    np.savetxt(
        folder / f"{name}.csv",
        np.column_stack(list(columns.values())),
        fmt="%.17g",
        delimiter=",",
        header=",".join(columns),
        comments="",
    )

# %%
# How good is it?
# ---------------
# We measure three things. First, the contact is compared with the reference: the mean difference
# on Fig. 4's line, relative to the plateau 7/3. Second, the paper claims symmetry; here the two
# plates agree to the last bit. Third, the energy.

difference = np.mean(np.abs(sx_right - sx_reference)) / PLATEAU
left, right = contact.state["left"], contact.state["right"]


def by_place(points):
    """The order of points along z, then y, then x; it does not depend on their numbers."""
    return np.lexsort(np.round(points / (1e-6 * d)).T)


def pairs(left, right):
    """Displacement, velocity and stress: of the mirrored left plate, and of the right plate."""
    flip, middle = [-1, 1, 1], [body.nodes[body.elements].mean(axis=1) for body in (left, right)]
    ours, theirs = by_place(left.nodes * flip), by_place(right.nodes)
    own_elements, their_elements = by_place(middle[0] * flip), by_place(middle[1])
    return {
        "displacement": (left.displacement[ours] * flip, right.displacement[theirs]),
        "velocity": (left.velocity[ours] * flip, right.velocity[theirs]),
        "stress": (left.stress[own_elements] * [1, 1, 1, -1, 1, -1], right.stress[their_elements]),
    }


same = all(np.array_equal(*pair) for pair in pairs(left, right).values())
total = contact.energy["total"]
drift = np.max(np.abs(total / total[0] - 1))
reference_total = reference.energy["total"]
reference_drift = np.max(np.abs(reference_total / reference_total[0] - 1))
balance = np.max(np.abs(contact.energy["balance"])) / total[0]

updates = 20000 * int(contact.steps[-1])
percent = 100 * difference
print(f"contact against reference on Fig. 4's line: mean |difference| {percent:.3f} % of 7/3")
print(f"left plate is the mirror image of the right one, bit for bit: {same}")
print(f"energy: contact within {drift:.1e}, reference within {reference_drift:.1e}")
print(f"work balance within {balance:.1e}")
if TIMES:
    rate = updates / contact.seconds / 1e6
    print(f"time: contact {contact.seconds:.2f} s ({rate:.1f} million element updates per second)")
    print(f"time: reference {reference.seconds:.2f} s, recording included")

assert difference < 0.01
for off in (off4, off5):
    assert np.mean(np.abs(off["best"])) <= np.mean(np.abs(off["reference"]))
assert cost(best, 50) < 1 / 80
assert same
assert drift < 1e-3 and reference_drift < 1e-12 and balance < 1e-12

# %%
# The paper found its closest points with the simplex search. The search starts from a triangle
# that is not its own mirror image, and stops at the rounding error of f. So two mirrored points
# get slightly different closest points. The same run with this search:

data = scene.data
data["contact"][0]["method"] = "simplex"
simplex = ct.Scene(data).run(output=False)
right = simplex.state["right"]
moved = pairs(simplex.state["left"], right)
own, mirrored = (stress[:, 0] for stress in moved["stress"])
asymmetry = {
    "σx": np.max(np.abs(own - mirrored)) / np.max(np.abs(right.stress[:, 0])),
    "displacement": np.max(np.abs(np.subtract(*moved["displacement"])))
    / np.max(np.abs(right.displacement)),
}
off = right.stress[:, 0] - contact.state["right"].stress[:, 0]
change = np.max(np.abs(off)) / np.max(np.abs(right.stress[:, 0]))
if TIMES:
    print(f"simplex search: {simplex.seconds:.2f} s")
found = ", ".join(f"{name} {value:.1e}" for name, value in asymmetry.items())
print(f"simplex search, over the peak: largest difference between the plates: {found}")
print(f"and of σx from the run above: {change:.1e}")
assert asymmetry["σx"] < 1e-9 and asymmetry["displacement"] < 1e-7 and change < 1e-9

# %%
# Finally the meshes are compared with the exact solution, from coarse to fine. On Fig. 4's line
# the error falls with the order 1/2, because no fixed mesh follows a jump. On Fig. 5's line the
# oscillation behind the plane front shifts the whole curve up or down. We subtract from each curve
# its own value near z = 0, so that only the lateral waves remain.


def errors(body):
    """Mean errors on Fig. 4's line and, without the value near z = 0, on Fig. 5's."""
    x, sx = fig4_line(body)
    z, sz = fig5_line(body)
    exact = exact_fig5(z)
    return np.mean(np.abs(sx - exact_fig4(x))), np.mean(np.abs((sz - sz[0]) - (exact - exact[0])))


meshes = [25, 50, 100, 200]
table = {}
print(
    f"\n{'h':>7} {'run':>10} {'Fig. 4':>8} {'order':>6} {'Fig. 5':>8} {'order':>6}"
    + (f" {'seconds':>8}" if TIMES else "")
)
for name, example in (("reference", "plates_reference"), ("contact", "plates")):
    table[name] = []
    for n in meshes:
        result = refined(example, n).run(output=False, progress=False)
        table[name].append(errors(result.state["right"]))
        orders = (
            np.log2(np.divide(table[name][-2], table[name][-1]))
            if n > meshes[0]
            else (np.nan, np.nan)
        )
        e4, e5 = table[name][-1]
        print(
            f"{'d/' + str(n):>7} {name:>10} {e4:8.4f} {orders[0]:6.2f} {e5:8.4f} {orders[1]:6.2f}"
            + (f" {result.seconds:8.2f}" if TIMES else "")
        )

for name, rows in table.items():
    slope4, slope5 = (
        -np.polyfit(np.log2(meshes), np.log2(np.array(rows)[:, i]), 1)[0] for i in (0, 1)
    )
    print(f"{name}: order {slope4:.2f} on Fig. 4's line, {slope5:.2f} on Fig. 5's line")
    assert 0.4 < slope4 < 0.65
    assert slope5 > 0.5

if ct.has("gsl"):
    off = np.mean(np.abs(fig5["series"] - fig5["exact"]))
    print(
        f"series of 300 branches on Fig. 5's line: mean difference from the closed form {off:.4f}"
    )

# %%
# Predict, then unfold
# --------------------
# Write down each prediction before you unfold the answer; the lines below run the changes.
#
# 1. Why does Fig. 4 ring? Take 0.98 of the stable step in place of the Courant number 0.125, and
#    the default contact law. Does the ringing grow or fall, and by how much the error?
#
#    .. answer::
#
#       It falls: near the stability limit the errors of space and time nearly cancel. The error
#       falls by more than 30 %, with a seventh of the steps. Only the first peak behind the front
#       stays.
#
# 2. Add the integrator ``"tchamwa_wielgosz"``. What becomes of the overshoot?
#
#    .. answer::
#
#       It is less than 2 % of the plateau: this integrator damps the highest frequencies of the
#       mesh. The paper's setting overshoots by more than 10 %.
#
# 3. Take the large step with the paper's contact law. Does the run end as it should?
#
#    .. answer::
#
#       A warning comes before the first step, and then an error: the explicit penalty adds energy
#       at large steps (:doc:`03_explicit_penalty`).


def changed(paper_law=False, **step):
    """The plates with another step and perhaps another contact law."""
    data = ct.Scene.load(ct.example("plates")).data
    if not paper_law:
        data["contact"] = [{"surfaces": data["contact"][0]["surfaces"]}]
    if step:
        del data["time"]["courant"]
        data["time"] |= step
    data["output"] = {"every": 10**9}
    result = ct.Scene(data).run(progress=False, output=False)
    x, stress = fig4_line(result.state["right"])
    error, overshoot = np.mean(np.abs(stress - exact_fig4(x))), -stress.min() / PLATEAU - 1
    steps = int(result.steps[-1])
    print(f"{steps} steps, error {error:.4f}, overshoot {100 * overshoot:.1f} % of the plateau")
    return steps, error, overshoot


paper = changed(paper_law=True)
larger = changed(fraction=0.98)
damped = changed(fraction=0.98, integrator="tchamwa_wielgosz")
assert larger[0] < paper[0] / 7 and larger[1] < 0.7 * paper[1]
assert paper[2] > 0.1 and damped[2] < 0.02
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    try:
        changed(paper_law=True, fraction=0.98)
    except ct.EnergyBlowup as error:
        print("the last change stops, as expected:", error)
        stopped = True
assert stopped and caught[0].message.kind == "chatter"
