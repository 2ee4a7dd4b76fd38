"""
A gallery of scenes
===================

The folder ``tutorials/scenes`` has ten scenes, which also come with the package
(``ct.example("hertz")``). Each is a text of at most 40 lines, and for each there is a result that
can be computed by hand. Here we run all but those of :doc:`08_bending_over_a_cylinder` and
:doc:`09_your_own_mesh` and compare each with its closed form. Start from them for scenes of your
own (:doc:`/theory/scene`).

The program computes for about 34 s of one core. Each claim is followed by an ``assert``, so it
fails where a claim is wrong.
"""

# %%
# All at once
# -----------
# Load, run, draw: what ``run.plot()`` shows of each scene, without a word of ours.

import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from libcontact.pictures.plot import draw_bar_in_time, draw_curves, draw_faces

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)


def load(name):
    return ct.Scene.load(ct.example(name))


def run(scene, **options):
    return scene.run(progress=False, output=False, **options)


NAMES = "plates bar_on_a_wall bouncing_bar block_on_an_incline hertz spinning_ring cantilever"
for name in NAMES.split():
    run(load(name)).plot()

# %%
# Two helpers
# -----------
# ``states`` returns the states at some times: the scene is run up to each of them. ``often``
# records more often. :func:`libcontact.pictures.plot.draw_faces` draws deformed faces, coloured by
# values of elements.


def states(scene, times):
    """The states at some times, and after the first step for the time 0."""
    end = scene.data["time"]["end"]
    return [run(scene, until=max(time, 1e-9 * end)).state for time in times]


def often(scene, every):
    """The same scene with a record after so many steps."""
    data = scene.data
    data.setdefault("output", {})["every"] = every
    return ct.Scene(data)


# %%
# Two plates collide
# ------------------
# ``plates.toml``, the impact of :doc:`01_plate_impact`: two plates of steel meet at 1 m/s each.
# The picture shows the end, with displacements 1500 times as large. Between the two plane fronts
# steel is at rest under the pressure :math:`\rho c_1 v_0`; near the free edges it bulges.
# (``plates_reference.toml`` is the right plate alone on a wall: its picture is the right half.)

plates = run(load("plates"))
E, NU, RHO, V0, D = 2.1e5, 0.3, 7.8e-9, 1000.0, 2.5  # MPa, 1, t/mm³, mm/s, mm
C1 = np.sqrt(E * (1 - NU) / ((1 + NU) * (1 - 2 * NU) * RHO))
pressed = RHO * C1 * V0  # MPa
front = 0.56 * D

fig, ax = plt.subplots(figsize=(7.5, 7), layout="constrained")
for body in plates.state.values():
    for up in (1, -1):
        limits = (-1.15 * pressed, 1.15 * pressed)
        look = {"scale": 1500, "turn": np.diag([1, up]), "linewidths": 0.05}
        image = draw_faces(ax, body, "y_min", body.stress[:, 0], limits, **look)
place, ends = front - 1500 * V0 * plates.time[-1], np.array([-1.1 * D, 1.1 * D])
curves = {name: ([x, x], ends, "k--") for name, x in (("front, $c_1 t$", place), ("_", -place))}
draw_curves(ax, curves, "upper right", xlabel="x [mm]", ylabel="z [mm]")
fig.colorbar(image, ax=ax, label=r"$\sigma_x$ [MPa]", shrink=0.8)
ax.set_title(f"Plates after {1e6 * plates.time[-1]:.2f} µs, displacements x 1500")
fig.savefig(folder / "scene_plates.png", dpi=150)

right = plates.state["right"]
inside = (right.centres[:, 0] < 0.5 * front) & (right.centres[:, 2] < 0.2 * D)
behind = -right.stress[inside, 0].mean()
print(f"plates: pressure behind the front {behind:.2f} MPa, rho c1 v0 = {pressed:.2f} MPa")
assert abs(-right.stress[inside, 0].mean() / pressed - 1) < 0.01

# %%
# A bar meets a wall
# ------------------
# ``bar_on_a_wall.toml``: a bar of 10 m flies at 10 m/s against a rigid wall :cite:p:`Doyen2011`.
# The wave of pressure :math:`\rho c v = 300` runs to the free end at :math:`c = 30` m/s and comes
# back as a release; then, after :math:`2L/c`, the bar flies off as it came, and no wave is left in
# it. Left: where the cross-sections of the bar are at each time, in the colour of their stress.
# Right: the force of the wall over the area, at every step by a probe (:doc:`/theory/probe`), and
# its mean between two records, which is the change of momentum.

wall = load("bar_on_a_wall")
L, C, V, P = 10.0, 30.0, 10.0, 300.0
times = np.linspace(0, 1.5, 121)[1:]
film = states(wall, times)
records = run(often(wall, 10).add_probe("wall", resultant="obstacle"))


def along(film, axis):
    """Places (times, nodes) of the cross-sections and stresses (times, elements) between them."""
    nodes, elements = film[0]["bar"].nodes, film[0]["bar"].centres
    order = np.argsort(elements[:, axis])
    starts = [np.flatnonzero(nodes[:, axis] == value)[0] for value in np.unique(nodes[:, axis])]
    bars = [state["bar"] for state in film]
    return np.array([bar.positions[starts, axis] for bar in bars]), np.array(
        [bar.stress[order, axis] for bar in bars]
    )


def times_of(film):
    return np.array([state.time for state in film])


def force(run, body, area, axis):
    """Middles of the times between records, and the mean pressure of the obstacle between them."""
    impulse, t = run.body_momentum(body)["obstacle_impulse"][:, axis], run.time
    return (t[1:] + t[:-1]) / 2, np.diff(impulse) / np.diff(t) / area


def exact_end(t):
    """Place of the near end of the bar."""
    return np.where(t < 0.5, 5 - V * t, np.where(t < 0.5 + 2 * L / C, 0, V * (t - 0.5 - 2 * L / C)))


def exact_far_end(t):
    """Place of the far end: the wave reaches it after L / c, and it turns round at once."""
    turn = 0.5 + L / C
    return np.where(t < turn, 15 - V * t, 15 - V * turn + V * (t - turn))


places, stress = along(film, 0)
t = times_of(film)
fine = np.linspace(0, 1.5, 601)
fig, (left, right) = plt.subplots(1, 2, figsize=(8, 4.2), layout="constrained")
image = draw_bar_in_time(left, t, places, stress, 360)
fig.colorbar(image, ax=left, label="stress [Pa]")
curves = {
    "closed form: ends": (exact_end(fine), fine, "k--"),
    "_far": (exact_far_end(fine), fine, "k--"),
}
draw_curves(left, curves, "center right", xlabel="x [m]", ylabel="t [s]", ylim=(0, 1.5))
middle, pressure = force(records, "bar", 0.01, 0)
history = records.probes["wall"]
off = 0.5 + 2 * L / C
curves = {
    "every step": (history["time"], history["force"][:, 0] / 0.01, "C7"),
    "mean of ten steps": (middle, pressure, "C3"),
    r"closed form, $\rho c v$": ([0, 0.5, 0.5, off, off, 1.5], [0, 0, P, P, 0, 0], "k--"),
}
labels = {"xlabel": "t [s]", "ylabel": "pressure on the wall [Pa]", "ylim": (-15, 420)}
draw_curves(right, curves, "upper center", xlim=(0, 1.5), **labels)
fig.savefig(folder / "scene_bar_on_a_wall.png", dpi=150)

steady = (middle > 0.6) & (middle < 1.1)
off = max(np.abs(places[:, 0] - exact_end(t)).max(), np.abs(places[:, -1] - exact_far_end(t)).max())
print(f"bar: mean pressure {pressure[steady].mean():.2f} Pa (300)")
print(f"ends within {100 * off / L:.2f} % of the length")
assert abs(pressure[steady].mean() / P - 1) < 0.01 and off < 0.02 * L

# The trapezoidal sum of the force equals the change of momentum, to round-off.
momentum = records.body_momentum("bar")["p"][:, 0]
push, t_push = history["force"][:, 0], history["time"]
impulse = (0.5 * (push[1:] + push[:-1]) * np.diff(t_push)).sum()
assert abs(impulse - (momentum[-1] - momentum[0])) < 1e-12 * abs(momentum[0])

# %%
# A bar bounces
# -------------
# ``bouncing_bar.toml``: the same bar falls on the floor. It leaves the floor with a wave in it, so
# the second bounce is not like the first: at :math:`16 L / c` the bar is at rest where it began
# :cite:p:`Doyen2011`. What it is compared with comes from characteristics: :math:`\ddot u = c^2
# u'' - g` in flight is solved without error by :math:`u_i^{n+1} = u_{i-1}^n + u_{i+1}^n -
# u_i^{n-1} - g \Delta t^2` if :math:`c \Delta t = \Delta x`, and the lower end stays on the floor
# as long as it would go below. Odd and even steps of this scheme do not know of each other, and
# differ by up to a cell, 11 mm, once the floor has been met.


def characteristics(n, end):
    """Times and places of the lower and the upper end, for n cells."""
    dt = L / n / C
    free = lambda u: np.concatenate([[2 * u[1]], u[:-2] + u[2:], [2 * u[-2]]]) - 10 * dt**2
    before, now = np.zeros(n + 1), np.full(n + 1, -5 * dt**2)
    ends = [(5.0, 5.0 + L), (5.0 + now[0], 5.0 + L + now[-1])]
    while len(ends) * dt <= end * (1 + 1e-9):
        after = free(now) - before
        after[0] = max(after[0], -5.0)
        before, now = now, after
        ends.append((5 + now[0], 5 + L + now[-1]))
    return dt * np.arange(len(ends)), np.array(ends)


bouncing = load("bouncing_bar")
period = bouncing.data["time"]["end"]  # 16 L / c
t_exact, ends = characteristics(900, period)
film = states(bouncing, np.linspace(0, period, 161)[1:])
records = run(bouncing)
places, stress = along(film, 2)
t = times_of(film)
shape = {"figsize": (8, 7), "height_ratios": [2, 1], "sharex": True, "layout": "constrained"}
fig, (above, below) = plt.subplots(2, 1, **shape)
image = draw_bar_in_time(above, t, places, stress, 500, upright=True)
fig.colorbar(image, ax=[above, below], label="stress [Pa]", shrink=0.6)
curves = {
    "characteristics: ends": (t_exact, ends[:, 0], "k--"),
    "_upper": (t_exact, ends[:, 1], "k--"),
}
draw_curves(above, curves, "upper right", ylabel="z [m]", ylim=(0, 17), title="A bar bounces")
middle, pressure = force(records, "bar", 0.01, 2)
landing, touching = np.array([1, 11 / 3]), {}
for i, start in enumerate(landing):
    times = [start, start, start + 2 * L / C, start + 2 * L / C]
    touching["_second" if i else "contact by hand: from, to"] = (times, [0, 550, 550, 0], "k:")
curves = {"_computed": (middle, pressure, "C3"), **touching}
draw_curves(below, curves, "upper center", xlabel="t [s]", ylabel="pressure [Pa]", xlim=(0, period))
fig.savefig(folder / "scene_bouncing_bar.png", dpi=150)

exact = np.array([np.interp(t, t_exact, ends[:, i]) for i in (0, 1)]).T
off = np.abs(places[:, [0, -1]] - exact).max()
print(
    f"bouncing bar: characteristics end at {ends[-1, 0]:.3f} m (5), the run at "
    f"{places[-1, 0]:.3f} m; ends within {100 * off / L:.2f} % of the length"
)
assert abs(ends[-1, 0] - 5) < 1.01 * L / 900 and off < 0.05 * L

# %%
# A block slides down a slope
# ---------------------------
# ``block_on_an_incline.toml``: the slope falls by 3 on 4, friction is 0.3. The scene turns gravity
# and leaves the slope along x; the picture turns it back. The block goes down with the
# acceleration :math:`g (\sin\alpha - 0.3 \cos\alpha) = 3.6` m/s², instead of 6 without friction.

incline = often(load("block_on_an_incline"), 2)
slope = np.arctan2(3, 4)
turn = np.array([[np.cos(slope), -np.sin(slope)], [np.sin(slope), np.cos(slope)]])
film = states(incline, [0.0, 1.0])
records = run(incline)
fig, (left, right) = plt.subplots(1, 2, figsize=(8, 4), width_ratios=[1.3, 1], layout="constrained")
for state in film:
    body = state["block"]
    look = {"turn": turn, "cmap": "viridis"}
    image = draw_faces(left, body, "y_min", body.stress[:, 2], (-3000, 0), **look)
ground = turn.T @ np.array([[-0.3, 3.4], [0, 0]])
draw_curves(left, {"_ground": (*ground, "k")}, None, xlabel="[m]", ylabel="[m]", aspect="equal")
fig.colorbar(image, ax=left, label=r"$\sigma_z$ across the slope [Pa]")
mass = 300.0
v = records.body_momentum("block")["p"][:, 0] / mass
curves = {
    "without friction, 6 t": (records.time, 6 * records.time, "C7:"),
    "closed form, 3.6 t": (records.time, 3.6 * records.time, "k--"),
    "computed": (records.time, v, "C3"),
}
draw_curves(right, curves, xlabel="t [s]", ylabel="velocity down the slope [m/s]", xlim=(0, 1))
fig.savefig(folder / "scene_block_on_an_incline.png", dpi=150)

# %%
# The computed velocity oscillates about the closed form: gravity starts at once, so the block
# bounces and rocks on its soft ground, and friction follows the normal force, also that with which
# the block bounces. Friction is 0.3 of the normal force, so :math:`p_x + 0.3 p_z = 3.6\,m t`.

p = records.body_momentum("block")["p"][-1]
down = (p[0] + 0.3 * p[2]) / mass
print(f"block: velocity after 1 s {v[-1]:.3f} m/s (3.6); (p_x + 0.3 p_z) / m {down:.3f} m/s")
assert abs((p[0] + 0.3 * p[2]) / (3.6 * mass) - 1) < 5e-3

# %%
# A sphere is pressed into a plane
# --------------------------------
# ``hertz.toml``: a rigid sphere with the radius R = 4 goes 0.1 into an elastic block, a quarter of
# which is computed. Hertz: the force is :math:`\tfrac43 E^* \sqrt R\, d^{3/2}`, the radius of
# contact :math:`\sqrt{R d} = 0.63`, and under its middle the stress fades as :math:`\sigma_z =
# -p_0 / (1 + z^2/a^2)`. Elements of 0.2 are three to the radius, so the picture is coarse; it is a
# start for finer ones (:doc:`/theory/obstacle`). The pressure at the nodes is recovered from the
# forces there (:ref:`recovered-pressure`).

hertz = run(load("hertz"))
R, DEPTH, STAR = 4.0, 0.1, 1000 / (1 - 0.09)
a = np.sqrt(R * DEPTH)
p0 = 2 * STAR / np.pi * np.sqrt(DEPTH / R)
block = hertz.state["block"]
layout = [["cut", "force"], ["cut", "pressure"], ["cut", "stress"]]
shape = {"figsize": (8, 7.2), "width_ratios": [1.25, 1], "layout": "constrained"}
fig, axes = plt.subplot_mosaic(layout, **shape)
left = axes["cut"]
for side in (1, -1):
    look = {"turn": np.diag([side, 1]), "cmap": "magma"}
    image = draw_faces(left, block, "y_min", block.stress[:, 2], (-p0, 0), **look)
angle = np.linspace(-0.75, 0.75, 200)
left.fill_between(R * np.sin(angle), R - DEPTH - R * np.cos(angle), 0.9, color="0.75", lw=0)
left.set(xlim=(-2.5, 2.5), ylim=(-3, 0.9), xlabel="x [mm]", ylabel="z [mm]")
fig.colorbar(image, ax=left, label=r"$\sigma_z$ [MPa]", location="bottom", shrink=0.8)
middle, push = force(hertz, "block", -1, 2)
depth = DEPTH * np.minimum(middle / 4e-5, 1)
pressing = middle < 4e-5
fine = np.linspace(0, DEPTH, 200)
curves = {
    "computed": (depth[pressing], 4 * push[pressing], "C3"),
    "Hertz": (fine, 4 / 3 * STAR * np.sqrt(R) * fine**1.5, "k--"),
}
draw_curves(axes["force"], curves, xlabel="depth [mm]", ylabel="force [N]", xlim=(0, DEPTH))
nodes = hertz.pressure["obstacle"][0]
r, fine = np.hypot(*nodes["position"][:, :2].T), np.linspace(0, a, 200)
curves = {
    "computed, at nodes": (r, nodes["pressure"], "C3o"),
    "Hertz": (fine, p0 * np.sqrt(1 - (fine / a) ** 2), "k--"),
}
labels = {"xlabel": "radius [mm]", "ylabel": "pressure [MPa]"}
draw_curves(axes["pressure"], curves, xlim=(0, 1.2), **labels)
column = np.flatnonzero((block.centres[:, 0] < 0.2) & (block.centres[:, 1] < 0.2))
column = column[np.argsort(block.centres[column, 2])]
z = np.linspace(-4, 0, 400)
curves = {
    "computed": (-block.centres[column, 2], block.stress[column, 2], "C3o-"),
    "Hertz, half-space": (-z, -p0 / (1 + (z / a) ** 2), "k--"),
}
labels = {"xlabel": "depth below the middle [mm]", "ylabel": r"$\sigma_z$ [MPa]"}
draw_curves(axes["stress"], curves, xlim=(0, 4), **labels)
fig.savefig(folder / "scene_hertz.png", dpi=150)

work, hand = 4 * hertz.energy["external"][-1], 0.4 * 4 / 3 * STAR * np.sqrt(R) * DEPTH**2.5
print(f"Hertz: work of the sphere {work:.3f} mJ ({hand:.3f} on a half-space)")
assert abs(work / hand - 1) < 0.15

# %%
# A ring spins and breathes
# -------------------------
# ``spinning_ring.toml``: a ring of rubber is released while it turns with 1000 rad/s. Only its own
# tension holds it together, so it expands, turns more slowly, and contracts again. A thin ring has
# one unknown, its stretch s: :math:`\rho R^2 (\ddot s - \omega^2 / s^3) = -W'(s)`. The dot marks
# the same node in each picture.

ring = load("spinning_ring")
RADIUS, RATE, YOUNG, POISSON, DENSITY = 0.1, 1000.0, 1e8, 0.4, 1000.0
MU, LAM = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))


def tension(s):
    """W'(s) of a neo-Hookean bar with free sides; b2 is its squared lateral stretch."""
    p = MU - LAM * s
    b2 = 2 * MU / (p + np.sqrt(p * p + 4 * LAM * s**2 * MU))
    return (MU * (s**2 - 1) + LAM * s * b2 * (s * b2 - 1)) / s


def thin_ring(end, n):
    """Times and stretches of a thin ring, by Runge and Kutta's method."""
    rate = lambda y: np.array([y[1], RATE**2 / y[0] ** 3 - tension(y[0]) / (DENSITY * RADIUS**2)])
    y, h, out = np.array([1.0, 0.0]), end / n, [1.0]
    for _ in range(n):
        k1 = rate(y)
        k2 = rate(y + h / 2 * k1)
        k3 = rate(y + h / 2 * k2)
        k4 = rate(y + h * k3)
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        out.append(y[0])
    return np.linspace(0, end, n + 1), np.array(out)


film = states(ring, np.linspace(0, 6.3e-3, 64))
t = np.array([state.time for state in film])
nodes = film[0]["ring"].nodes
radius = np.hypot(*nodes[:, :2].T)
core = np.abs(radius - RADIUS) < 1e-9
stretch = (
    np.array([np.hypot(*state["ring"].positions[core, :2].T).mean() for state in film]) / RADIUS
)
t_thin, s_thin = thin_ring(6.3e-3, 2000)


def hoop(body):
    """Stress around the ring at the centres of its elements."""
    x, y = body.mesh.centres(body.positions)[:, :2].T
    c, s = -y / np.hypot(x, y), x / np.hypot(x, y)
    return c * c * body.stress[:, 0] + s * s * body.stress[:, 1] + 2 * c * s * body.stress[:, 3]


shown = [0, 10, 20, 31]
shape = {"figsize": (8, 5.6), "height_ratios": [1.1, 1], "layout": "constrained"}
fig, axes = plt.subplot_mosaic([shown, 4 * ["radius"]], **shape)
for k in shown:
    body, ax = film[k]["ring"], axes[k]
    image = draw_faces(ax, body, "z_max", hoop(body) / 1e6, (0, 20), cmap="viridis")
    dot = body.positions[np.argmin(np.abs(nodes - [0.105, 0, 0.005]).sum(axis=1))]
    ax.plot(*dot[:2], "o", color="tab:red", ms=6)
    ax.set(xlim=(-0.14, 0.14), ylim=(-0.14, 0.14), xticks=[], yticks=[])
    ax.set_title(f"t = {1e3 * t[k]:.1f} ms")
fig.colorbar(image, ax=[axes[k] for k in shown], label="hoop stress [MPa]", shrink=0.8)
curves = {
    "thin ring": (1e3 * t_thin, s_thin, "k--"),
    "computed": (1e3 * t, stretch, "C3.-"),
    "pictures above": (1e3 * t[shown], stretch[shown], "ko"),
}
labels = {"xlabel": "t [ms]", "ylabel": "radius / radius at the start", "xlim": (0, 6.3)}
labels["ylim"] = (0.99, 1.25)  # with room for the legend
draw_curves(axes["radius"], curves, "upper right", **labels)
fig.savefig(folder / "scene_spinning_ring.png", dpi=150)

print(f"ring: largest stretch {stretch.max():.4f}, thin ring {s_thin.max():.4f}")
assert abs(stretch.max() - s_thin.max()) < 0.01 * (s_thin.max() - 1) + 2e-3

# %%
# A cantilever at rest
# --------------------
# ``cantilever.toml``: a beam of steel with a load on its end, relaxed until it is at rest. Bending
# and shear give :math:`w(x) = F x^2 (3L - x) / 6EI + F x / \kappa G A`, and the stress in the
# outer row of elements is :math:`M z / I` at their centres. At the wall the computed stress
# departs from beam theory: the wall prevents lateral contraction.

beam_run = run(often(load("cantilever"), 100))
beam = beam_run.state["beam"]
LONG, SIDE, LOAD = 100.0, 10.0, 1000.0  # mm, mm, N
INERTIA, AREA, SHEAR = SIDE**4 / 12, SIDE**2, 2.1e5 / 2.6
KAPPA = 10 * (1 + NU) / (12 + 11 * NU)


def bending(x):
    """Deflection of Timoshenko's beam."""
    return LOAD * x**2 * (3 * LONG - x) / (6 * E * INERTIA) + LOAD * x / (KAPPA * SHEAR * AREA)


shape = {"figsize": (8, 5.6), "layout": "constrained"}
fig, axes = plt.subplot_mosaic([["beam", "beam"], ["stress", "energy"]], **shape)
ax, x = axes["beam"], np.linspace(0, LONG, 200)
look = {"scale": 5, "linewidths": 0.5}
image = draw_faces(ax, beam, "y_min", beam.stress[:, 0], (-500, 500), **look)
curves = {"beam theory: the axis": (x, SIDE / 2 - 5 * bending(x), "k--")}
draw_curves(ax, curves, "upper right", xlabel="x [mm]", ylabel="z [mm]")
fig.colorbar(image, ax=ax, label=r"$\sigma_x$ [MPa], displacements x 5")
upper_row = np.flatnonzero((beam.centres[:, 2] > SIDE / 2) & (beam.centres[:, 1] < SIDE / 2))
upper_row = upper_row[np.argsort(beam.centres[upper_row, 0])]
centres = beam.centres[upper_row]
by_hand = LOAD * (LONG - centres[:, 0]) * (centres[:, 2] - SIDE / 2) / INERTIA
curves = {
    "computed": (centres[:, 0], beam.stress[upper_row, 0], "C3o"),
    "beam theory, $Mz/I$": (centres[:, 0], by_hand, "k--"),
}
draw_curves(axes["stress"], curves, xlabel="x [mm]", ylabel=r"$\sigma_x$, upper row [MPa]")
energy = beam_run.energy
times, final = 1e3 * energy["time"], LOAD * bending(LONG) / 2
curves = {name: (times, np.maximum(energy[name], 1e-12)) for name in ("kinetic", "strain")}
curves["half the load times deflection"] = (times, final + 0 * times, "k--")
draw_curves(
    axes["energy"], curves, "lower center", xlabel="t [ms]", ylabel="energy [mJ]", yscale="log"
)
fig.savefig(folder / "scene_cantilever.png", dpi=150)

tip = -beam.displacement[np.isclose(beam.nodes[:, 0], LONG), 2].mean()
print(f"cantilever: deflection {tip:.4f} mm, beam theory {bending(LONG):.4f} mm")
assert abs(tip / bending(LONG) - 1) < 0.02
assert np.allclose(beam.stress[upper_row[3:-1], 0], by_hand[3:-1], rtol=0.02)

# %%
# Predict, then unfold
# --------------------
# Write down each prediction before you unfold the answer; the lines below run the changes.
#
# 1. Remove the friction of the block: ``data["obstacle"][0]["friction"] = 0``. How fast is it after
#    1 s?
#
#    .. answer::
#
#       6 m/s, instead of 3.6.
#
# 2. Double the load of the cantilever. What becomes of the deflection?
#
#    .. answer::
#
#       It doubles: the scene is linear.

data = load("block_on_an_incline").data
data["obstacle"][0].pop("friction")
smooth = run(ct.Scene(data)).body_momentum("block")["p"][-1, 0] / mass

data = load("cantilever").data
data["load"][0]["traction"] = [0, 0, -20]
heavy = run(ct.Scene(data)).state["beam"]
twice = -heavy.displacement[np.isclose(heavy.nodes[:, 0], LONG), 2].mean()
print(f"block without friction {smooth:.3f} m/s; deflection under twice the load {twice:.4f} mm")
assert abs(smooth / 6 - 1) < 1e-2
assert abs(twice / tip / 2 - 1) < 1e-2
