"""
Two thick plates collide
========================

Two plates, 5 mm thick and 2.5 mm long, meet at 1 m/s each. The paper :cite:p:`Gabriel2012` computes this impact to show
that its contact algorithm is accurate and keeps symmetry. We compute the same impact, draw the paper's Figs. 3, 4 and 5, and say
how far each curve is from the exact solution (:doc:`/theory/exact`).

What you see here is tested: each claim ends in an ``assert``.
"""

# %%
# The scene
# ---------
# One half of each plate is enough, as z = 0 is a plane of symmetry: 100 x 100 bricks a plate, one layer of them, held in y (plane
# strain). The scene file says all of this; ``explain`` tells what will be computed, and what will not.

import os
import time
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)
TIMES = (
    os.environ.get("LIBCONTACT_TIMES", "yes") != "no"
)  # print also how long each run takes, and what else belongs to this machine

scene = ct.Scene.load(ct.example("plates"))
explanation = scene.explain()
print(
    explanation
    if TIMES
    else explanation[explanation.index("Bodies") : explanation.index("Cost")].rstrip()
)

# %%
# Three runs
# ----------
# The *contact* run has both plates. In the *reference* run the right plate alone meets a wall, which by symmetry is
# the same thing without any contact in it. What the two curves differ by is what the contact costs in accuracy.
#
# The *best buy* is the cheapest setting in :doc:`/theory/accuracy` that is as good as the paper's on both lines: half as many elements along each edge, an integrator that
# damps what single elements do, 0.98 of the stable step, and the library's own contact law.


def run(scene, **options):
    """Run a scene; returns the run and the seconds that it took."""
    start = time.perf_counter()
    result = scene.run(**options)
    return result, time.perf_counter() - start


results = folder / "plates.vtkhdf" if ct.has("hdf5") else False
contact, contact_seconds = run(scene, output=results)
reference, reference_seconds = run(ct.Scene.load(ct.example("plates_reference")), output=False)
if not results:
    print("plates.vtkhdf is left out: this build has no HDF5")

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
best, best_seconds = run(ct.Scene(data), output=False, progress=False)

NU = 0.3
T = 0.56  # c1 t / d

# %%
# Numbers without units: the stress :math:`\sigma^* = \sigma c_1 / (\Lambda v_0)`, so that the plane wave has :math:`\sigma_z^* = -1` and
# :math:`\sigma_x^* = -(1 - \nu)/\nu = -7/3`.

E, RHO, V0 = 2.1e5, 7.8e-9, 1000.0  # MPa, t/mm³, mm/s
LAMBDA = E * NU / ((1 + NU) * (1 - 2 * NU))
C1 = np.sqrt((LAMBDA + E / (1 + NU)) / RHO)
PLATEAU = (1 - NU) / NU


def fields(body):
    """Element centres x/d and z/d and the stresses σ* of one body."""
    return body.centres[:, 0] / d, body.centres[:, 2] / d, body.stress * C1 / (LAMBDA * V0)


# %%
# The cost of a run is the number of element forces that it has computed a plate, over the :math:`448 \cdot 100^2` of the paper. Its error is the mean of
# \|computed - exact\| on the line of the figure.


CURVES = {
    "reference": "the paper's setting, reference (symmetry)",
    "contact": "the paper's setting, contact",
    "best": "best buy, contact",
}


def cost(result, n):
    """Computed element forces a plate over those of the paper."""
    return result.computed * result.steps[-1] * n**2 / (448 * 100**2)


def named(name, result, n, off):
    """What a curve is called: its run, its error and its cost."""
    return f"{name}: error {np.mean(np.abs(off)):.4f}, cost {cost(result, n):.2g}"


# %%
# Fig. 4: the longitudinal stress along x at z = 0
# ------------------------------------------------
# The row of elements next to z = 0. Waves from the free faces have not come here yet, so the exact solution is a bare step. Elements
# can't jump: they ring behind the front, and the more, the finer one looks. That is dispersion, not contact. What the contact adds is the
# bump in the two elements at x = 0: under a stiff penalty the contact points swing at the frequency of the last elements.


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

fig, ax = plt.subplots(figsize=(8, 5.2), layout="constrained")
fine = np.linspace(-1, 1, 2001)
ax.plot(fine, exact_fig4(fine), "k", lw=1.2, label="exact")
for x, y, result, n, colour, style, name in (
    (fig4["x_over_d"], fig4["reference"], reference, 100, "tab:blue", "-", "reference"),
    (fig4["x_over_d"], fig4["contact"], contact, 100, "tab:red", "--", "contact"),
    (x_best, sx_best, best, 50, "tab:orange", "-", "best"),
):
    ax.plot(x, y, color=colour, lw=1.2, ls=style, label=named(CURVES[name], result, n, off4[name]))
ax.set(
    xlabel="x/d",
    ylabel=r"$\sigma_x^* = \sigma_x c_1 / \Lambda v_0$",
    xlim=(-1, 1),
    title="Fig. 4: longitudinal stress along x at z/d = 0, c$_1$t/d = 0.56",
)
fig.legend(loc="outside lower center", fontsize=9, frameon=False)
ax.grid(alpha=0.3)
fig.savefig(folder / "fig4.png", dpi=150)

# %%
# Fig. 5: the transversal stress along z at x/d = 0.4
# ---------------------------------------------------
# The mean of the two columns of elements beside x/d = 0.4. Here the waves from the free faces show: the circular dilatational wave at
# z/d = 0.608, the head wave at 0.899. The series of 300 Rayleigh-Lamb branches is what the paper had for the exact solution.


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

fig, ax = plt.subplots(figsize=(8, 5.4), layout="constrained")
fine = np.linspace(0, 1, 2001)
ax.plot(fine, exact_fig5(fine), "k", lw=1.2, label="exact (closed form)")
if ct.has("gsl"):
    ax.plot(z, fig5["series"], color="tab:green", lw=1, label="series, 300 branches")
for places, y, result, n, colour, style, name in (
    (z, fig5["reference"], reference, 100, "tab:blue", "-", "reference"),
    (z, fig5["contact"], contact, 100, "tab:red", "--", "contact"),
    (z_best, fig5_best["best"], best, 50, "tab:orange", "-", "best"),
):
    ax.plot(
        places, y, color=colour, lw=1.2, ls=style, label=named(CURVES[name], result, n, off5[name])
    )
ax.set(
    xlabel="z/d",
    ylabel=r"$\sigma_z^* = \sigma_z c_1 / \Lambda v_0$",
    xlim=(0, 1),
    title="Fig. 5: transversal stress along z at x/d = 0.4, c$_1$t/d = 0.56",
)
fig.legend(loc="outside lower center", fontsize=9, frameon=False)
ax.grid(alpha=0.3)
fig.savefig(folder / "fig5.png", dpi=150)

# %%
# Fig. 3: the waves
# -----------------
# The computed :math:`\sigma_z^*` of both plates and both halves, with the fronts of the theory. The colour shows
# what the lines say: behind the plane front a uniform state, and from the corners of the contact plane the waves that release it.

fig, ax = plt.subplots(figsize=(8, 7), layout="constrained")
for name in ("left", "right"):
    x, zc, stress = fields(contact.state[name])
    shape = (len(np.unique(zc.round(9))), len(np.unique(x.round(9))))
    X, Z, S = (a.reshape(shape) for a in (x, zc, stress[:, 2]))
    for mirror in (1, -1):
        image = ax.pcolormesh(
            X, mirror * Z, S, cmap="RdBu_r", vmin=-1.5, vmax=1.5, shading="nearest", rasterized=True
        )
fig.colorbar(image, ax=ax, label=r"$\sigma_z^* = \sigma_z c_1 / \Lambda v_0$", shrink=0.8)
styles = {
    "plane_p": ("k", "-", "plane P"),
    "circular_p": ("k", "--", "circular P"),
    "circular_s": ("tab:purple", "--", "circular S"),
    "head": ("tab:green", "-", "head waves"),
    "rayleigh": ("tab:orange", "o", "Rayleigh"),
}
for kind, curves in ct.exact.fronts(T, NU).items():
    colour, style, label = styles[kind]
    for i, curve in enumerate(curves):
        for side in (1, -1):
            first = i == 0 and side == 1
            if kind == "rayleigh":
                ax.plot(
                    side * curve[:, 0],
                    curve[:, 1],
                    style,
                    color=colour,
                    ms=7,
                    mec="k",
                    clip_on=False,
                    label=label if first else None,
                )
            else:
                ax.plot(
                    side * curve[:, 0],
                    curve[:, 1],
                    style,
                    color=colour,
                    lw=1.2,
                    label=label if first else None,
                )
ax.set(
    xlabel="x/d",
    ylabel="z/d",
    xlim=(-1, 1),
    ylim=(-1, 1),
    aspect="equal",
    title="Fig. 3: wave fronts at c$_1$t/d = 0.56",
)
ax.legend(loc="upper center", ncols=5, fontsize=8, bbox_to_anchor=(0.5, -0.08), frameon=False)
fig.savefig(folder / "fig3.png", dpi=150)

# %%
# The curves as tables, for those who would rather compare numbers than pictures; the best buy has its own, as its mesh is another one.

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
# First the contact against the reference: the mean difference on Fig. 4's line, as a part of the plateau 7/3. Then the symmetry that the paper
# claims: here it holds to the last bit. Then the energy.

difference = np.mean(np.abs(sx_right - sx_reference)) / PLATEAU
left, right = contact.state["left"], contact.state["right"]


def by_place(points):
    """The order of points along z, then y, then x, whatever the order of their numbers is."""
    return np.lexsort(np.round(points / (1e-6 * d)).T)


def pairs(left, right):
    """
    What the left plate does as its mirror image would do it, and what the right one does, in one
    order: displacement, velocity, stress.
    """
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
print(
    f"contact against reference, mean |difference| on Fig. 4's line: {100 * difference:.3f} % of the "
    "plateau 7/3"
)
print(f"left plate is the mirror image of the right one, bit for bit: {same}")
print(
    f"energy: contact run within {drift:.1e}, reference run within {reference_drift:.1e}; work balance "
    f"within {balance:.1e}"
)
if TIMES:
    print(
        f"time: contact {contact_seconds:.2f} s ({updates / contact_seconds / 1e6:.1f} million element "
        "updates per second), "
        f"reference {reference_seconds:.2f} s, one core, recording included"
    )

assert difference < 0.01
for off in (off4, off5):
    assert np.mean(np.abs(off["best"])) <= np.mean(np.abs(off["reference"]))
assert cost(best, 50) < 1 / 80
assert same
assert drift < 1e-3 and reference_drift < 1e-12 and balance < 1e-12

# %%
# The paper found its closest points with the simplex search. That search starts from a triangle that is not its own mirror image and stops at the
# rounding of f, so two mirrored points end in slightly different places. The same run with it:

data = scene.data
data["contact"][0]["method"] = "simplex"
simplex, simplex_seconds = run(ct.Scene(data), output=False)
right = simplex.state["right"]
moved = pairs(simplex.state["left"], right)
asymmetry = {
    "σx": np.max(np.abs(moved["stress"][0][:, 0] - moved["stress"][1][:, 0]))
    / np.max(np.abs(right.stress[:, 0])),
    "displacement": np.max(np.abs(moved["displacement"][0] - moved["displacement"][1]))
    / np.max(np.abs(right.displacement)),
}
change = np.max(np.abs(right.stress[:, 0] - contact.state["right"].stress[:, 0])) / np.max(
    np.abs(right.stress[:, 0])
)
print(
    "simplex search: "
    + (f"{simplex_seconds:.2f} s; " if TIMES else "")
    + "largest difference between the plates: "
    + ", ".join(f"{name} {value:.1e}" for name, value in asymmetry.items())
    + f"; of σx from the run above {change:.1e} (all over the peak)"
)
assert asymmetry["σx"] < 1e-9 and asymmetry["displacement"] < 1e-7 and change < 1e-9

# %%
# Then the elements against the exact solution, from coarse to fine. The error is the mean of \|computed - exact\| on the line. On Fig. 4's line it falls
# with the order 1/2: no fixed mesh follows a jump. On Fig. 5's line the ringing behind the plane front shifts the whole curve up and down; we
# subtract each curve's own value near z = 0 to see the lateral waves alone.


def errors(body):
    """Mean errors on the lines of Fig. 4 and, after removing the value near z = 0, of Fig. 5."""
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
        result, seconds = run(refined(example, n), output=False, progress=False)
        table[name].append(errors(result.state["right"]))
        orders = (
            np.log2(np.divide(table[name][-2], table[name][-1]))
            if n > meshes[0]
            else (np.nan, np.nan)
        )
        e4, e5 = table[name][-1]
        print(
            f"{'d/' + str(n):>7} {name:>10} {e4:8.4f} {orders[0]:6.2f} {e5:8.4f} {orders[1]:6.2f}"
            + (f" {seconds:8.2f}" if TIMES else "")
        )

for name, rows in table.items():
    slope4, slope5 = (
        -np.polyfit(np.log2(meshes), np.log2(np.array(rows)[:, i]), 1)[0] for i in (0, 1)
    )
    print(f"{name}: order {slope4:.2f} on Fig. 4's line, {slope5:.2f} on Fig. 5's line")
    assert 0.4 < slope4 < 0.65
    assert slope5 > 0.5

if ct.has("gsl"):
    print(
        "series with 300 branches against the closed form on Fig. 5's line: mean difference "
        f"{np.mean(np.abs(fig5['series'] - fig5['exact'])):.4f}"
    )
