"""
A scene, a picture
==================

The folder ``tutorials/scenes`` has eight scenes, which also come with the package (``ct.example("hertz")``). Each is a text of at most 40 lines, and for each there is something that can
be worked out by hand. Here we run them all, look at them, and put the hand's result beside the computed one. Take them as a
start for scenes of your own (:doc:`/theory/scene`).
"""

# %%
# Two helpers
# -----------
# ``states`` gives a film: the scene is run up to each of the times. ``faces`` draws the faces of a body that look at the
# viewer, deformed, in the colours of values that belong to elements.

import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)


def load(name):
    return ct.Scene.load(ct.example(name))


def run(scene, **options):
    return scene.run(progress=False, output=False, **options)


def states(scene, times):
    """The states at some times, and after the first step for the time 0."""
    end = scene.data["time"]["end"]
    return [run(scene, until=max(time, 1e-9 * end)).state for time in times]


def often(scene, every):
    """The same scene with a record after so many steps."""
    data = scene.data
    data.setdefault("output", {})["every"] = every
    return ct.Scene(data)


def face_corners(body, face, scale=1.0):
    """Corners (faces, 4, 3) of a face of a body, deformed, and the elements that they belong to."""
    faces, owners = body.mesh.faces(face)
    return (body.nodes + scale * body.displacement)[faces[:, :4]], owners


def draw(ax, body, face, values, axes, norm, scale=1.0, mirror=(1, 1), cmap="RdBu_r", lw=0.3):
    """Draw a face of a body seen along the third axis, in the colours of the values of its elements."""
    corners, owners = face_corners(body, face, scale)
    patches = PolyCollection(
        corners[:, :, axes] * mirror, array=values[owners], cmap=cmap, edgecolors="k", linewidths=lw
    )
    patches.set_clim(*norm)
    ax.add_collection(patches)
    ax.set_aspect("equal")
    return patches


# %%
# Two plates collide
# ------------------
# ``plates.toml``, the impact of :doc:`01_plate_impact`: two plates of steel meet at 1 m/s each. We see them at the end, with
# displacements 1500 times as large. Between the two plane fronts steel is at rest and pressed by :math:`\rho c_1 v_0`, near the
# free edges it is pushed out, and bulges. (``plates_reference.toml`` is the right plate alone on a wall: its picture is the
# right half.)

plates = run(load("plates"))
E, NU, RHO, V0, D = 2.1e5, 0.3, 7.8e-9, 1000.0, 2.5  # MPa, 1, t/mm³, mm/s, mm
C1 = np.sqrt(E * (1 - NU) / ((1 + NU) * (1 - 2 * NU) * RHO))
pressed = RHO * C1 * V0  # MPa
front = 0.56 * D

fig, ax = plt.subplots(figsize=(7.5, 7), layout="constrained")
for body in plates.state.values():
    for up in (1, -1):
        norm = (-1.15 * pressed, 1.15 * pressed)
        image = draw(
            ax, body, "y_min", body.stress[:, 0], [0, 2], norm, scale=1500, mirror=(1, up), lw=0.05
        )
for side in (1, -1):
    place = side * (front - 1500 * V0 * plates.time[-1])
    ax.plot(
        [place] * 2,
        [-1.1 * D, 1.1 * D],
        "k--",
        lw=1,
        label="plane front, $c_1 t$" if side == 1 else None,
    )
ax.autoscale_view()
fig.colorbar(image, ax=ax, label=r"$\sigma_x$ [MPa]", shrink=0.8)
ax.set(
    xlabel="x [mm]",
    ylabel="z [mm]",
    title=f"Plates after {1e6 * plates.time[-1]:.2f} µs, displacements x 1500",
)
ax.legend(loc="upper right")
fig.savefig(folder / "scene_plates.png", dpi=150)

right = plates.state["right"]
inside = (right.centres[:, 0] < 0.5 * front) & (right.centres[:, 2] < 0.2 * D)
print(
    f"plates: pressure behind the front {-right.stress[inside, 0].mean():.2f} MPa, rho c1 v0 = "
    f"{pressed:.2f} MPa"
)
assert abs(-right.stress[inside, 0].mean() / pressed - 1) < 0.01

# %%
# A bar meets a wall
# ------------------
# ``bar_on_a_wall.toml``: a bar of 10 m flies at 10 m/s against a rigid wall :cite:p:`Doyen2011`. The wave of pressure
# :math:`\rho c v = 300` runs to the free end at :math:`c = 30` m/s and comes back as a release; then, after :math:`2L/c`, the
# bar flies off as it came, and no wave is left in it. Left: where the cross-sections of the bar are at each time, in the colour
# of their stress. Right: the force of the wall over the area, at every step by a probe (:doc:`/theory/probe`), and its mean
# between two records, which is the change of momentum.

wall = load("bar_on_a_wall")
L, C, V, P = 10.0, 30.0, 10.0, 300.0
times = np.linspace(0, 1.5, 121)[1:]
film = states(wall, times)
records = run(often(wall, 10).add_probe("wall", resultant="obstacle"))


def along(film, axis):
    """
    Places (times, nodes) of the cross-sections of a bar along its axis and the stresses (times,
    elements) between them.
    """
    nodes, elements = film[0]["bar"].nodes, film[0]["bar"].centres
    order = np.argsort(elements[:, axis])
    starts = [np.flatnonzero(nodes[:, axis] == value)[0] for value in np.unique(nodes[:, axis])]
    bars = [state["bar"] for state in film]
    return np.array([bar.positions[starts, axis] for bar in bars]), np.array(
        [bar.stress[order, axis] for bar in bars]
    )


def rows(film):
    """Borders of the rows of an x-t picture."""
    t = np.array([state.time for state in film])
    return t, np.concatenate([[t[0] - (t[1] - t[0]) / 2], (t[1:] + t[:-1]) / 2, [t[-1]]])


def cells(places):
    """Borders (times + 1, nodes) of the cells of an x-t picture."""
    return np.vstack([places[:1], (places[1:] + places[:-1]) / 2, places[-1:]])


def force(run, body, area, axis):
    """Middles of the times between records, and the mean pressure of the obstacle between them."""
    impulse, t = run.body_momentum(body)["obstacle_impulse"][:, axis], run.time
    return (t[1:] + t[:-1]) / 2, np.diff(impulse) / np.diff(t) / area


def exact_end(t):
    """Place of the near end of the bar."""
    return np.where(t < 0.5, 5 - V * t, np.where(t < 0.5 + 2 * L / C, 0, V * (t - 0.5 - 2 * L / C)))


def exact_far_end(t):
    """
    Place of the far end: it learns of the wall after L / c, turns round at once, and the bar is
    shortest then.
    """
    turn = 0.5 + L / C
    return np.where(t < turn, 15 - V * t, 15 - V * turn + V * (t - turn))


places, stress = along(film, 0)
t, borders = rows(film)
fine = np.linspace(0, 1.5, 601)
fig, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
X = cells(places)
T = np.broadcast_to(borders[:, None], X.shape)
image = left.pcolormesh(X, T, stress, cmap="RdBu_r", vmin=-360, vmax=360, rasterized=True)
left.plot(exact_end(fine), fine, "k--", lw=1.2, label="closed form: ends")
left.plot(exact_far_end(fine), fine, "k--", lw=1.2)
left.axvline(0, color="0.4", lw=4)
fig.colorbar(image, ax=left, label="stress [Pa]")
left.set(
    xlabel="x [m]",
    ylabel="t [s]",
    xlim=(-0.5, 15.5),
    ylim=(0, 1.5),
    title="Where the bar is, and its stress",
)
left.legend(loc="lower left")
middle, pressure = force(records, "bar", 0.01, 0)
history = records.probes["wall"]
right.plot(history["time"], history["force"][:, 0] / 0.01, color="0.6", lw=0.8, label="every step")
right.plot(middle, pressure, color="tab:red", lw=1.2, label="mean of ten steps")
off = 0.5 + 2 * L / C
right.plot(
    [0, 0.5, 0.5, off, off, 1.5],
    [0, 0, P, P, 0, 0],
    "k--",
    lw=1.2,
    label=r"closed form, $\rho c v$",
)
right.set(
    xlabel="t [s]", ylabel="pressure on the wall [Pa]", xlim=(0, 1.5), title="The push of the wall"
)
right.grid(alpha=0.3)
right.legend()
fig.savefig(folder / "scene_bar_on_a_wall.png", dpi=150)

steady = (middle > 0.6) & (middle < 1.1)
off = max(np.abs(places[:, 0] - exact_end(t)).max(), np.abs(places[:, -1] - exact_far_end(t)).max())
print(
    f"bar: mean pressure {pressure[steady].mean():.2f} Pa (300), ends within {100 * off / L:.2f} % of the "
    "length"
)
assert abs(pressure[steady].mean() / P - 1) < 0.01 and off < 0.02 * L

# The history is the momentum's rate: the trapezoidal sum of the force is the change of momentum,
# to round-off.
momentum = records.body_momentum("bar")["p"][:, 0]
push, t_push = history["force"][:, 0], history["time"]
impulse = (0.5 * (push[1:] + push[:-1]) * np.diff(t_push)).sum()
assert abs(impulse - (momentum[-1] - momentum[0])) < 1e-12 * abs(momentum[0])

# %%
# A bar bounces
# -------------
# ``bouncing_bar.toml``: the same bar falls on the floor. It leaves the floor with a wave in it, so the second bounce is not
# like the first: at :math:`16 L / c` the bar is at rest where it began :cite:p:`Doyen2011`. What it is compared with comes from
# characteristics: :math:`\ddot u = c^2 u'' - g` in flight is solved without error by :math:`u_i^{n+1} = u_{i-1}^n + u_{i+1}^n -
# u_i^{n-1} - g \Delta t^2` if :math:`c \Delta t = \Delta x`, and the lower end stays on the floor as long as it would go below.
# Odd and even steps of this scheme do not know of each other, and differ by up to a cell, 11 mm, once the floor has been met.


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
t, borders = rows(film)
fig, (above, below) = plt.subplots(
    2, 1, figsize=(9, 7.5), height_ratios=[2, 1], sharex=True, layout="constrained"
)
Z = cells(places)
T = np.broadcast_to(borders[:, None], Z.shape)
image = above.pcolormesh(T, Z, stress, cmap="RdBu_r", vmin=-500, vmax=500, rasterized=True)
above.plot(t_exact, ends[:, 0], "k--", lw=1.2, label="characteristics: ends")
above.plot(t_exact, ends[:, 1], "k--", lw=1.2)
above.axhline(0, color="0.4", lw=4)
fig.colorbar(image, ax=[above, below], label="stress [Pa]", shrink=0.6)
above.set(ylabel="z [m]", title="A bar bounces: where it is, and its stress")
above.legend(loc="upper right")
middle, pressure = force(records, "bar", 0.01, 2)
below.plot(middle, pressure, color="tab:red", lw=1)
for start in (1, 11 / 3):
    below.axvspan(
        start,
        start + 2 * L / C,
        color="0.85",
        label=r"contact of the closed form" if start == 1 else None,
    )
below.set(xlabel="t [s]", ylabel="pressure on the floor [Pa]", xlim=(0, period))
below.grid(alpha=0.3)
below.legend(loc="upper center")
fig.savefig(folder / "scene_bouncing_bar.png", dpi=150)

exact = np.array([np.interp(t, t_exact, ends[:, i]) for i in (0, 1)]).T
off = np.abs(places[:, [0, -1]] - exact).max()
print(
    f"bouncing bar: characteristics end at {ends[-1, 0]:.3f} m (5), the run at {places[-1, 0]:.3f} m; "
    f"ends within {100 * off / L:.2f} % of the length"
)
assert abs(ends[-1, 0] - 5) < 1.01 * L / 900 and off < 0.05 * L

# %%
# A block slides down a slope
# ---------------------------
# ``block_on_an_incline.toml``: the slope falls by 3 on 4, friction is 0.3. The scene turns gravity and leaves the slope along
# x; the picture turns it back. The block goes down with the acceleration :math:`g (\sin\alpha - 0.3 \cos\alpha) = 3.6` m/s²,
# instead of 6 without friction.

incline = often(load("block_on_an_incline"), 2)
slope = np.arctan2(3, 4)
turn = np.array([[np.cos(slope), -np.sin(slope)], [np.sin(slope), np.cos(slope)]])
film = states(incline, [0.0, 1.0])
records = run(incline)
fig, (left, right) = plt.subplots(
    1, 2, figsize=(11, 4.4), width_ratios=[1.3, 1], layout="constrained"
)
for state in film:
    body = state["block"]
    corners, owners = face_corners(body, "y_min")
    image = PolyCollection(
        corners[:, :, [0, 2]] @ turn,
        array=body.stress[owners, 2],
        cmap="viridis",
        edgecolors="k",
        linewidths=0.4,
    )
    image.set_clim(-3000, 0)
    left.add_collection(image)
    corner = turn.T @ [body.positions[:, 0].min(), 0.36]
    left.text(
        *corner,
        f"t = {state.time:.1f} s",
        rotation=-np.degrees(slope),
        rotation_mode="anchor",
        fontsize=9,
    )
ground = turn.T @ np.array([[-0.3, 3.4], [0, 0]])
left.plot(*ground, "k", lw=2)
fig.colorbar(image, ax=left, label=r"$\sigma_z$ across the slope [Pa]")
left.set(aspect="equal", xlabel="[m]", ylabel="[m]", title="The block on its way")
mass = 300.0
v = records.body_momentum("block")["p"][:, 0] / mass
right.plot(records.time, 6 * records.time, color="0.6", ls=":", label="without friction, 6 t")
right.plot(records.time, 3.6 * records.time, "k--", lw=1.2, label="closed form, 3.6 t")
right.plot(records.time, v, color="tab:red", lw=1.2, label="computed")
right.set(
    xlabel="t [s]",
    ylabel="velocity down the slope [m/s]",
    xlim=(0, 1),
    ylim=(0, None),
    title="Friction takes its share",
)
right.grid(alpha=0.3)
right.legend()
fig.savefig(folder / "scene_block_on_an_incline.png", dpi=150)

# %%
# The computed velocity swings about the closed form: gravity comes at once, so the block hops and rocks on its soft ground, and
# friction follows the push of the slope. Whatever that push is, friction is 0.3 of it, so :math:`p_x + 0.3 p_z = 3.6\\,m t`.

p = records.body_momentum("block")["p"][-1]
print(
    f"block: velocity after 1 s {v[-1]:.3f} m/s (3.6); (p_x + 0.3 p_z) / m "
    f"{(p[0] + 0.3 * p[2]) / mass:.3f} m/s"
)
assert abs((p[0] + 0.3 * p[2]) / (3.6 * mass) - 1) < 5e-3

# %%
# A sphere is pressed into a plane
# --------------------------------
# ``hertz.toml``: a rigid sphere with the radius R = 4 goes 0.1 into an elastic block, a quarter of which is computed. Hertz:
# the force is :math:`\tfrac43 E^* \sqrt R\, d^{3/2}`, the radius of contact :math:`\sqrt{R d} = 0.63`, and under its middle the
# stress fades as :math:`\sigma_z = -p_0 / (1 + z^2/a^2)`. Elements of 0.2 are three to the radius, so the picture is coarse; it
# is a start for finer ones (:doc:`/theory/obstacle`). The pressure at the nodes is recovered from the forces there
# (:ref:`recovered-pressure`).

hertz = run(load("hertz"))
R, DEPTH, STAR = 4.0, 0.1, 1000 / (1 - 0.09)
a = np.sqrt(R * DEPTH)
p0 = 2 * STAR / np.pi * np.sqrt(DEPTH / R)
block = hertz.state["block"]
fig = plt.figure(figsize=(11, 8), layout="constrained")
parts = fig.add_gridspec(3, 2, width_ratios=[1.25, 1])
left = fig.add_subplot(parts[:, 0])
upper, centre, lower = (fig.add_subplot(parts[row, 1]) for row in range(3))
for side in (1, -1):
    image = draw(
        left, block, "y_min", block.stress[:, 2], [0, 2], (-p0, 0), mirror=(side, 1), cmap="magma"
    )
angle = np.linspace(-0.75, 0.75, 200)
left.fill_between(R * np.sin(angle), R - DEPTH - R * np.cos(angle), 0.9, color="0.75", lw=0)
left.set(
    xlim=(-2.5, 2.5),
    ylim=(-3, 0.9),
    xlabel="x [mm]",
    ylabel="z [mm]",
    title="Cut through the middle, true displacements",
)
fig.colorbar(image, ax=left, label=r"$\sigma_z$ [MPa]", location="bottom", shrink=0.8)
middle, push = force(hertz, "block", -1, 2)
depth = DEPTH * np.minimum(middle / 4e-5, 1)
pressing = middle < 4e-5
upper.plot(depth[pressing], 4 * push[pressing], color="tab:red", lw=1.2, label="computed")
fine = np.linspace(0, DEPTH, 200)
upper.plot(fine, 4 / 3 * STAR * np.sqrt(R) * fine**1.5, "k--", lw=1.2, label="Hertz")
upper.set(
    xlabel="depth [mm]",
    ylabel="force [N]",
    xlim=(0, DEPTH),
    ylim=(0, None),
    title="Force against depth",
)
nodes = hertz.pressure["obstacle"][0]
r, fine = np.hypot(*nodes["position"][:, :2].T), np.linspace(0, a, 200)
centre.plot(r, nodes["pressure"], "o", color="tab:red", ms=4, label="computed, at nodes")
centre.plot(fine, p0 * np.sqrt(1 - (fine / a) ** 2), "k--", lw=1.2, label="Hertz")
centre.set(
    xlabel="radius [mm]",
    ylabel="pressure [MPa]",
    xlim=(0, 1.2),
    ylim=(0, None),
    title="Contact pressure",
)
column = np.flatnonzero((block.centres[:, 0] < 0.2) & (block.centres[:, 1] < 0.2))
column = column[np.argsort(block.centres[column, 2])]
z = np.linspace(-4, 0, 400)
lower.plot(
    -block.centres[column, 2],
    block.stress[column, 2],
    "o-",
    color="tab:red",
    ms=4,
    lw=1,
    label="computed",
)
lower.plot(-z, -p0 / (1 + (z / a) ** 2), "k--", lw=1.2, label="Hertz, half-space")
lower.set(
    xlabel="depth below the middle [mm]",
    ylabel=r"$\sigma_z$ [MPa]",
    xlim=(0, 4),
    title="Stress under the middle",
)
for ax in (upper, centre, lower):
    ax.grid(alpha=0.3)
    ax.legend()
fig.savefig(folder / "scene_hertz.png", dpi=150)

work, hand = 4 * hertz.energy["external"][-1], 0.4 * 4 / 3 * STAR * np.sqrt(R) * DEPTH**2.5
print(f"Hertz: work of the sphere {work:.3f} mJ ({hand:.3f} on a half-space)")
assert abs(work / hand - 1) < 0.15

# %%
# A ring spins and breathes
# -------------------------
# ``spinning_ring.toml``: a ring of rubber is let go while it turns with 1000 rad/s. Nothing holds it together but its own
# tension, so it grows, turns slower, and swings back. A thin ring has one unknown, its stretch s: :math:`\rho R^2 (\ddot s -
# \omega^2 / s^3) = -W'(s)`. The dot is one and the same node all the time.

ring = load("spinning_ring")
RADIUS, RATE, YOUNG, POISSON, DENSITY = 0.1, 1000.0, 1e8, 0.4, 1000.0
MU, LAM = YOUNG / (2 * (1 + POISSON)), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))


def tension(s):
    """
    W'(s): Kirchhoff stress over the stretch of a neo-Hookean bar with free sides; b2 is the square of
    its lateral stretch.
    """
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


fig = plt.figure(figsize=(11, 6.2), layout="constrained")
parts = fig.add_gridspec(2, 4, height_ratios=[1.1, 1])
shown = [0, 10, 20, 31]
for i, k in enumerate(shown):
    ax = fig.add_subplot(parts[0, i])
    body = film[k]["ring"]
    image = draw(ax, body, "z_max", hoop(body) / 1e6, [0, 1], (0, 20), cmap="viridis")
    dot = body.positions[np.argmin(np.abs(nodes - [0.105, 0, 0.005]).sum(axis=1))]
    ax.plot(*dot[:2], "o", color="tab:red", ms=6)
    ax.add_patch(plt.Circle((0, 0), RADIUS, fill=False, ls=":", color="0.4"))
    ax.set(
        xlim=(-0.14, 0.14),
        ylim=(-0.14, 0.14),
        xticks=[],
        yticks=[],
        title=f"t = {1e3 * t[k]:.1f} ms",
    )
fig.colorbar(image, ax=fig.axes, label="hoop stress [MPa]", shrink=0.8)
ax = fig.add_subplot(parts[1, :])
ax.plot(1e3 * t_thin, s_thin, "k--", lw=1.2, label="thin ring")
ax.plot(1e3 * t, stretch, "o-", color="tab:red", ms=3, lw=1, label="computed")
ax.plot(1e3 * t[shown], stretch[shown], "o", mfc="none", mec="k", ms=10, label="pictures above")
ax.set(
    xlabel="t [ms]", ylabel="radius / radius at the start", xlim=(0, 6.3), title="The ring breathes"
)
ax.grid(alpha=0.3)
ax.legend(loc="upper right")
fig.savefig(folder / "scene_spinning_ring.png", dpi=150)

print(f"ring: largest stretch {stretch.max():.4f}, thin ring {s_thin.max():.4f}")
assert abs(stretch.max() - s_thin.max()) < 0.01 * (s_thin.max() - 1) + 2e-3

# %%
# A cantilever at rest
# --------------------
# ``cantilever.toml``: a beam of steel with a load on its end, relaxed until it is at rest. Bending and shear give :math:`w(x) =
# F x^2 (3L - x) / 6EI + F x / \kappa G A`, and the stress in the outer row of elements is :math:`M z / I` at their centres. At
# the wall the computed stress departs from the theory of beams: the wall lets nothing contract sideways.

beam_run = run(often(load("cantilever"), 100))
beam = beam_run.state["beam"]
LONG, SIDE, LOAD = 100.0, 10.0, 1000.0  # mm, mm, N
INERTIA, AREA, SHEAR = SIDE**4 / 12, SIDE**2, 2.1e5 / 2.6
KAPPA = 10 * (1 + NU) / (12 + 11 * NU)


def bending(x):
    """Deflection of Timoshenko's beam."""
    return LOAD * x**2 * (3 * LONG - x) / (6 * E * INERTIA) + LOAD * x / (KAPPA * SHEAR * AREA)


fig = plt.figure(figsize=(11, 6.2), layout="constrained")
parts = fig.add_gridspec(2, 2, height_ratios=[1, 1.1])
ax = fig.add_subplot(parts[0, :])
image = draw(ax, beam, "y_min", beam.stress[:, 0], [0, 2], (-500, 500), scale=5, lw=0.5)
x = np.linspace(0, LONG, 200)
ax.plot(x, SIDE / 2 - 5 * bending(x), "k--", lw=1.5, label="theory of beams: the axis")
ax.plot([0, 0], [-4, 14], color="0.4", lw=5)
ax.set(xlim=(-2, 106), ylim=(-13, 15), xlabel="x [mm]", ylabel="z [mm]", title="Displacements x 5")
ax.legend(loc="upper right")
fig.colorbar(image, ax=ax, label=r"$\sigma_x$ [MPa]")
left, right = fig.add_subplot(parts[1, 0]), fig.add_subplot(parts[1, 1])
upper_row = np.flatnonzero((beam.centres[:, 2] > SIDE / 2) & (beam.centres[:, 1] < SIDE / 2))
upper_row = upper_row[np.argsort(beam.centres[upper_row, 0])]
centres = beam.centres[upper_row]
by_hand = LOAD * (LONG - centres[:, 0]) * (centres[:, 2] - SIDE / 2) / INERTIA
left.plot(centres[:, 0], beam.stress[upper_row, 0], "o", color="tab:red", ms=4, label="computed")
left.plot(centres[:, 0], by_hand, "k--", lw=1.2, label="theory of beams, $Mz/I$")
left.set(xlabel="x [mm]", ylabel=r"$\sigma_x$ [MPa]", title="Stress in the upper row of elements")
left.legend()
energy = beam_run.energy
right.semilogy(
    1e3 * energy["time"],
    np.maximum(energy["kinetic"], 1e-12),
    color="tab:blue",
    lw=1.2,
    label="kinetic",
)
right.semilogy(
    1e3 * energy["time"],
    np.maximum(energy["strain"], 1e-12),
    color="tab:orange",
    lw=1.2,
    label="strain",
)
right.axhline(
    LOAD * bending(LONG) / 2, color="k", ls="--", lw=1.2, label="half the load times deflection"
)
right.set(xlabel="t [ms]", ylabel="energy [mJ]", title="The way to rest")
right.legend()
for ax in (left, right):
    ax.grid(alpha=0.3)
fig.savefig(folder / "scene_cantilever.png", dpi=150)

tip = -beam.displacement[np.isclose(beam.nodes[:, 0], LONG), 2].mean()
print(f"cantilever: deflection {tip:.4f} mm, theory of beams {bending(LONG):.4f} mm")
assert abs(tip / bending(LONG) - 1) < 0.02
assert np.allclose(beam.stress[upper_row[3:-1], 0], by_hand[3:-1], rtol=0.02)
