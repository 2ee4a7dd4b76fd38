"""Pictures of the chapters on contact: laws, faces, statuses, enforcement, friction, obstacles."""

import warnings

import numpy as np
from matplotlib.figure import Figure

import libcontact as ct

BLUE, ORANGE, GREEN, RED, GREY = "#3b8bd4", "#e8762b", "#3fa34d", "#d64550", "#8a8a8a"
UNITS = {"length": "m", "mass": "kg", "time": "s"}


def line(ax, a, b, **style):
    """A straight line between two points of a plane."""
    ax.plot(*np.array([a, b], float).T, **style)


def arrow(ax, start, along, name, colour="black", off=(0.0, 0.0)):
    """An arrow with its name at the tip."""
    start, along = np.asarray(start, float), np.asarray(along, float)
    style = {"arrowstyle": "-|>", "color": colour, "lw": 1.4, "shrinkA": 0, "shrinkB": 0}
    ax.annotate("", start + along, start, arrowprops=style)
    ax.text(*(start + 1.16 * along + off), name, color=colour, ha="center", va="center")


def bare(ax, x, y):
    """Axes without frame, of equal scales."""
    ax.set(xlim=x, ylim=y, aspect="equal")
    ax.set_axis_off()


def laws():
    """The pressure that each law allows at a gap."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = figure.subplots()
    g = np.linspace(-0.6, 1.0, 400)
    for epsilon in (2.0, 5.0, 20.0):
        ax.plot(g, epsilon * np.maximum(-g, 0), color=BLUE, lw=1.4)
    near = np.linspace(1e-3, 0.4, 400)
    for epsilon in (0.5, 2.0):
        p = epsilon * (2 * (near - 0.4) * np.log(near / 0.4) + (near - 0.4) ** 2 / near)
        ax.plot(near, p, color=GREEN, lw=1.4)
    for constant in (0.4, 0.8, 1.2):
        ax.plot(g, constant + 2.5 * g, color=ORANGE, ls=":", lw=1.4)
        ax.plot(0, constant, "o", color=ORANGE, ms=6)
    ax.plot([0, 0, 1], [2, 0, 0], color="black", lw=2.6)
    ax.text(-0.58, 1.3, "penalties", color=BLUE)
    ax.text(0.27, 0.5, "barriers", color=GREEN)
    ax.text(0.55, 1.35, "Nitsche: p − εg = const", color=ORANGE)
    ax.text(0.45, 0.1, "exact condition, multiplier")
    ax.set(xlabel="gap g / h", ylabel="pressure p", xlim=(-0.6, 1), ylim=(-0.1, 2), yticks=[0])
    return figure


def fold_normals(ax, slope, marks, off):
    """Two plane sides that meet at the origin, and points whose closest point is the edge."""
    sides = np.array([[-1.0, -slope], [1.0, -slope]]) / np.hypot(1, slope)
    normals = np.array([[-slope, 1.0], [slope, 1.0]]) / np.hypot(1, slope)
    low = min(-1.5, -2.0 * slope)
    body = [
        2.2 * sides[0],
        [0, 0],
        2.2 * sides[1],
        [2.2 * sides[1][0], low],
        [2.2 * sides[0][0], low],
    ]
    ax.fill(*np.array(body).T, color=GREY, alpha=0.25, lw=0)
    for side in sides:
        line(ax, (0, 0), 2.2 * side, color="black", lw=1.8)
    rng = np.random.default_rng(2)
    points = rng.uniform(-1.4, 1.4, (700, 2))
    points = points[(points @ sides.T <= 0).all(axis=1) & (np.hypot(*points.T) < 1.35)]
    outside = (points @ normals.sum(axis=0) > 0) if slope > 0 else points @ normals.sum(axis=0) > 0
    wrong = (points @ normals[0] > 0) != outside
    ax.plot(*points[~wrong].T, "o", color=BLUE, ms=3.5)
    ax.plot(*points[wrong].T, "o", color=RED, ms=3.5)
    for normal, side, name in zip(normals, sides, ("$\\mathbf{n}_1$", "$\\mathbf{n}_2$")):
        arrow(ax, 1.5 * side, 0.6 * normal, name)
    arrow(ax, (0, 0), 0.45 * normals.sum(axis=0), marks, GREEN, off=off)


def wedge():
    """The wedge of a sharp ridge, with what one normal and the sum of both say; and of a valley."""
    figure = Figure(figsize=(7.5, 3.4))
    ridge, valley = figure.subplots(1, 2)
    fold_normals(ridge, 2.2, r"$\mathbf{n}_1 + \mathbf{n}_2$", (-0.95, -0.35))
    fold_normals(valley, -0.8, r"$\mathbf{n}_1 + \mathbf{n}_2$", (0.0, 0.1))
    bare(ridge, (-2.0, 2.0), (-2.1, 1.6))
    bare(valley, (-2.0, 2.0), (-2.0, 1.7))
    ridge.set_title("ridge: the wedge is outside")
    valley.set_title("valley: the wedge is inside")
    return figure


def nearest():
    """Points over a ridge of two faces: the face and the closest point that the library names."""
    nodes = np.array(
        [[-1, 0, 0], [-1, 1, 0], [0, 1, 0.5], [0, 0, 0.5], [1, 0, 0], [1, 1, 0]], float
    )
    faces = [[0, 3, 2, 1], [3, 4, 5, 2]]
    rng = np.random.default_rng(5)
    points = np.column_stack([rng.uniform(-1, 1, 60), np.full(60, 0.5), rng.uniform(0.4, 1.5, 60)])
    keep = points[:, 2] > 0.58 - 0.5 * np.abs(points[:, 0])
    points = points[keep]
    found = [ct.project("Q4", nodes[face], points) for face in faces]
    distance = np.array([f.distance for f in found])
    face = distance.argmin(axis=0)
    figure = Figure(figsize=(6.4, 3.0))
    ax = figure.subplots()
    for y, f in zip(points, range(len(points))):
        at = found[face[f]].point[f]
        colour = BLUE if face[f] == 0 else ORANGE
        line(ax, y[[0, 2]], at[[0, 2]], color=colour, lw=0.6, ls="--")
        ax.plot(*y[[0, 2]], "o", color=colour, ms=4)
    ax.plot([-1, 0, 1], [0, 0.5, 0], color="black", lw=2)
    ax.text(-0.72, 0.02, "face 0", color=BLUE)
    ax.text(0.5, 0.02, "face 1", color=ORANGE)
    bare(ax, (-1.1, 1.1), (-0.05, 1.55))
    return figure


def unseen():
    """What Gauss points of a square face leave out, and the points of Lobatto's rule."""
    figure = Figure(figsize=(7.5, 2.9))
    gauss, corner, lobatto = figure.subplots(1, 3)
    at = 0.5 / np.sqrt(3)
    for ax in (gauss, lobatto):
        ax.plot([-0.5, 0.5, 0.5, -0.5, -0.5], [-0.5, -0.5, 0.5, 0.5, -0.5], color="black", lw=1.5)
    for x in (-at, at):
        for y in (-at, at):
            gauss.plot(x, y, "s", color=BLUE, ms=6)
            circle = np.linspace(0, 2 * np.pi, 100)
            r = (0.5 - at) * np.sqrt(2)
            gauss.plot(x + r * np.cos(circle), y + r * np.sin(circle), color=BLUE, lw=0.7)
    line(gauss, (at, at), (0.5, 0.5), color=RED, lw=1.8)
    gauss.text(0.4, 0.6, "0.299 h", color=RED, ha="center")
    for x in (-0.5, 0, 0.5):
        for y in (-0.5, 0, 0.5):
            lobatto.plot(x, y, "s", color=ORANGE, ms=6)
    side = np.array([1.0, 1.0]) / np.sqrt(2)
    tip = np.array([0.0, -0.13])
    for way in (1, -1):
        edge = side * [way, 1]
        line(corner, tip, tip + 0.95 * edge, color="black", lw=1.8)
        for s in (0.5 - at, 0.5 + at):
            corner.plot(*(tip + 0.95 * s * edge), "s", color=BLUE, ms=6)
    corner.fill_between([-0.7, 0.7], [-0.6, -0.6], [0, 0], color=GREY, alpha=0.25, lw=0)
    line(corner, (-0.7, 0), (0.7, 0), color=GREY, lw=1.5)
    corner.plot(*tip, "o", color=RED, ms=6)
    gauss.set_title("Gauss points")
    corner.set_title("a corner comes in unseen")
    lobatto.set_title("Lobatto points")
    for ax in (gauss, corner, lobatto):
        bare(ax, (-0.75, 0.75), (-0.7, 0.75))
    return figure


def bar_scene(cells, at, **law):
    """A bar of unit length, speed and wave speed that flies at a wall."""
    scene = ct.Scene(title="bar on a wall", units=UNITS)
    scene.add_material("elastic", young=1.0, poisson=0.0, density=1.0)
    box = {"origin": [at, 0, 0], "size": [1, 0.05, 0.05], "cells": [cells, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, velocity=[-1, 0, 0])
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, **law)
    return scene.set_output(every=1, fields=[])


def delay():
    """Pressure of a bar at a wall for three penalties, against the closed form."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    cells, at = 100, 0.01
    for beta, colour in ((0.2, BLUE), (1.0, ORANGE), (10.0, GREEN)):
        scene = bar_scene(cells, at, beta=beta).set_time(end=at + 0.3, fraction=0.2)
        run = scene.run(progress=False, output=False)
        t = run.momentum["time"]
        p = np.gradient(run.momentum["p"][:, 0], t) / 0.05**2
        elements = cells * (t - at)
        ax.plot(elements, p, color=colour, label=f"β = {beta:g}")
        later = np.linspace(0, 20, 400)
        ax.plot(later, 1 - np.exp(-beta * later), color=colour, ls="--", lw=1)
    ax.plot([-2, 0, 0, 20], [0, 0, 1, 1], color="black", lw=1)
    ax.set(xlabel="time c t / h after the touch", ylabel="pressure / (ρ c v)")
    ax.set(xlim=(-1, 20), ylim=(-0.05, 1.5))
    ax.legend()
    return figure


def after_impact(fraction, landings=3, **law):
    """Largest energy after the impact over that before, and the step over that of the elements."""
    worst, cells = 0.0, 40
    for place in range(landings):
        at = 0.02 + place / landings * fraction / cells
        scene = bar_scene(cells, at, **law).set_time(end=2.3 + at, dt=fraction / cells)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the growth that the picture is to show
            run = scene.run(progress=False, output=False)
        worst = max(worst, run.energy["total"][-1] / run.energy["total"][0])
    return worst


def growth():
    """Energy after an impact over the length of the step, for the explicit penalty and the default."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    part = np.linspace(0.4, 0.99, 5)
    for beta, colour in ((1.0, ORANGE), (5.0, GREEN), (10.0, RED)):
        # Reported step of a bar on a wall: 1 / sqrt(1 + β) of that of the elements.
        steps = part / np.sqrt(1 + beta)
        ratio = [after_impact(s, beta=beta, enforcement="penalty") for s in steps]
        ax.plot(steps, ratio, "o-", ms=3.5, color=colour, label=f"explicit, β = {beta:g}")
    steps = np.linspace(0.2, 0.98, 4)
    ratio = [after_impact(s) for s in steps]
    ax.plot(steps, ratio, "s-", ms=3.5, color="black", label="default")
    ax.axhline(1.0, color=GREY, lw=0.8)
    ax.set(xlabel="step / stable step of the elements", ylabel="energy after / before")
    ax.legend(fontsize=8)
    return figure


def patch(z, up, cells=2, size=1.0):
    """A flat patch of Q4 faces that points up or down: nodes and faces."""
    x = np.linspace(0, size, cells + 1)
    nodes = np.array([[a, b, z] for b in x for a in x])
    i = np.arange(cells)
    first = (i[:, None] * (cells + 1) + i[None, :]).ravel()
    faces = np.stack([first, first + 1, first + cells + 2, first + cells + 1], -1)
    return nodes, faces if up else faces[:, ::-1].copy()


def status_of(heights, start, depth):
    """Gap, status and force of the first point of a patch that is moved to the heights in turn."""
    low, faces = patch(0.0, True)
    high, others = patch(start, False)
    contact = ct.Contact(
        ct.Surface("Q4", high, others),
        ct.Surface("Q4", low, faces),
        epsilon=1.0,
        enforcement="penalty",
        initial_penetration="push",
        depth=depth,
    )
    rest, free, out = np.zeros_like(high), np.ones_like(high), []
    for height in heights:
        moved = high + [0, 0, height - start]
        contact.step(0.01, (moved, low), (rest, rest), (free, free), (rest, rest), kick=0.01)
        found = contact.points
        mine = found[(found["side"] == 0) & (found["face"] == 0) & (found["point"] == 0)]
        out.append(mine["gap"][0] if len(mine) and mine["other"][0] >= 0 else np.nan)
    return np.array(out)


def statuses():
    """The status of a point over the steps of a motion."""
    figure = Figure(figsize=(7.5, 4.0))
    axes = figure.subplots(2, 1, sharex=True)
    step = np.arange(33)
    swing = 0.3 + 0.55 * np.cos(2 * np.pi * step / 32)
    deep = -0.6 + 0.85 * np.sin(np.pi * step / 16) ** 2
    deep[24:] = np.linspace(deep[24], -0.25, 9)
    for ax, heights, title in (
        (axes[0], swing, "comes near"),
        (axes[1], deep, "begins deep inside"),
    ):
        gap = status_of(heights, heights[0], 0.4)
        has, inside = ~np.isnan(gap), heights < 0
        been_out = np.cumsum(~inside) > 0
        kinds = (
            ("new", ~has & ~inside, GREY, "o"),
            ("outside", has & (gap >= 0), BLUE, "o"),
            ("inside, with a force", has & (gap < 0), ORANGE, "s"),
            ("buried", ~has & inside & ~been_out, RED, "X"),
        )
        ax.axhline(0, color="black", lw=1)
        ax.plot(step, heights, color=GREY, lw=0.7)
        for name, which, colour, mark in kinds:
            ax.plot(step[which], heights[which], mark, color=colour, ms=5.5, label=name)
        ax.axhline(-0.4, color=GREY, lw=0.8, ls=":")
        ax.text(33, -0.4, "−D", va="center")
        ax.set(ylabel="height / h", title=title, ylim=(-0.75, 1.0))
    axes[1].set_xlabel("step")
    handles, labels = axes[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def far_side():
    """A point in a thin plate, and the normals that are far sides."""
    figure = Figure(figsize=(7.5, 3.2))
    plate, ring = figure.subplots(1, 2, width_ratios=[1.4, 1])
    plate.fill([-1.6, 1.6, 1.6, -1.6], [-0.5, -0.5, 0.5, 0.5], color=GREY, alpha=0.25, lw=0)
    plate.plot([-1.6, 1.6, 1.6, -1.6, -1.6], [-0.5, -0.5, 0.5, 0.5, -0.5], color="black", lw=1.6)
    plate.plot([0, 0], [1.25, -0.2], color=ORANGE, ls="--", lw=1.2)
    plate.plot(0, -0.2, "o", color=ORANGE, ms=8)
    arrow(plate, (-0.16, -0.2), (0, 0.7), "kept", GREEN, off=(-0.35, -0.02))
    arrow(plate, (0.16, -0.2), (0, -0.3), "nearer, but far side", RED, off=(0.1, -0.18))
    arrow(plate, (-1.2, 0.5), (0, 0.5), r"$\mathbf{n}_\mathrm{last}$", off=(0, 0.05))
    arrow(plate, (-1.2, -0.5), (0, -0.5), r"$\mathbf{n}$", off=(0, -0.05))
    bare(plate, (-1.8, 1.8), (-1.35, 1.35))
    angle = np.linspace(0, 2 * np.pi, 361)
    normal = np.stack([np.cos(angle), np.sin(angle)], -1)
    last, own = np.array([0.0, 1.0]), np.array([0.6, -0.8])
    far = (normal @ last < -0.5) | ((normal @ last < 0.5) & (normal @ own >= 0.5))
    for which, colour in ((far, RED), (~far, GREEN)):
        ring.scatter(*normal[which].T, s=9, color=colour)
    arrow(ring, (0, 0), 0.8 * last, r"$\mathbf{n}_\mathrm{last}$", off=(0.27, -0.15))
    arrow(ring, (0, 0), 0.8 * own, r"$\mathbf{n}_\mathrm{own}$", off=(-0.32, 0.16))
    ring.text(0, 1.15, "no far side", color=GREEN, ha="center")
    ring.text(0, -1.25, "far side", color=RED, ha="center")
    bare(ring, (-1.35, 1.35), (-1.4, 1.35))
    return figure


def hairpin(close):
    """A strip of thickness 0.1 folded once, in section; the upper leg is bent down by `close`."""
    from libcontact.mesh import Mesh

    leg, thick, gap = 0.6, 0.1, 0.08
    mesh = Mesh.box("hex8", (0, 0, 0), (1, 0.1, 1), (36, 1, 2))
    s, y, t = mesh.nodes.T
    middle = 0.5 * (thick + gap)
    along, off = (2 * leg + np.pi * middle) * s, thick * (t - 0.5)
    angle = np.clip((along - leg) / middle, 0.0, np.pi)
    x = np.where(
        along < leg, along, np.where(angle >= np.pi, 2 * leg + np.pi * middle - along, leg)
    )
    z = -(middle - off) * np.cos(angle)
    reference = np.stack([x + (middle - off) * np.sin(angle), y, z], -1)
    now = reference.copy()
    bent = angle >= np.pi
    now[bent, 2] -= close * ((leg - x[bent]) / leg) ** 2
    return mesh, reference, now


def fold():
    """The partners of the points of a folded strip, as the library finds them."""
    mesh, reference, now = hairpin(0.0)
    outer = mesh.outer_faces() if hasattr(mesh, "outer_faces") else outer_faces(mesh)
    surface = ct.Surface("Q4", reference, outer)
    contact = ct.Contact(surface, epsilon=1.0, enforcement="penalty", depth=0.12)
    rest, free = np.zeros_like(reference), np.ones_like(reference)
    for close in np.linspace(0.0, 0.1, 21):
        now = hairpin(close)[2]
        contact.step(0.01, now, rest, free, rest, kick=0.01)
    points = contact.points
    figure = Figure(figsize=(7.5, 2.9))
    ax = figure.subplots()
    for face in outer:
        corners = now[face]
        front = corners[np.isclose(corners[:, 1], 0.0)]
        if len(front) == 2:
            line(ax, *front[:, [0, 2]], color="black", lw=1.3)
    for p in points:
        if np.ptp(now[outer[p["face"]]][:, 1]) < 1e-9:
            continue
        met = p["other"] >= 0
        at = p["position"][[0, 2]]
        colour = (RED if p["gap"] < 0 else ORANGE) if met else GREY
        if met:
            line(ax, at, p["closest"][[0, 2]], color=colour, lw=0.8)
        ax.plot(*at, "o", color=colour, ms=3)
    bare(ax, (-0.05, 0.82), (-0.2, 0.17))
    return figure


def outer_faces(mesh):
    """Faces of hex8 that only one element has."""
    sides = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    faces = np.concatenate([mesh.elements[:, side] for side in sides])
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(first[count == 1])]


def one_impact(enforcement, step, start=0.0):
    """Gaps and forces of a plate of mass 1 that falls on a fixed one with K = 1 and speed 1."""
    low, faces = patch(0.0, True, 1)
    x, others = patch(start, False, 1)
    contact = ct.Contact(
        ct.Surface("Q4", x.copy(), others),
        ct.Surface("Q4", low, faces),
        epsilon=1.0,
        enforcement=enforcement,
        depth=100.0,
    )
    v = np.zeros_like(x)
    v[:, 2] = -1.0
    held, free = np.zeros_like(x), np.full_like(x, 4.0)
    gaps, forces = [], []
    for _ in range(int(12 / step)):
        force = np.zeros_like(x)
        contact.step(step, (x, low), (v, held), (free, held), kick=step)
        contact.add_force((force, np.zeros_like(x)))
        gaps.append(x[0, 2])
        forces.append(force[:, 2].sum())
        v = v + step * free * force
        x = x + step * v
        if x[0, 2] > 0.8 and v[0, 2] > 0:
            break
    return np.array(gaps), np.array(forces), v[0, 2]


def impact_loop():
    """Force over gap of one impact, for the explicit penalty and the energy-controlled one."""
    figure = Figure(figsize=(7.5, 3.4))
    names = (("penalty", "explicit penalty"), ("energy_controlled", "energy-controlled"))
    for ax, (law, title) in zip(figure.subplots(1, 2, sharey=True), names):
        gaps, forces, speed = one_impact(law, 0.6, start=0.5)
        g = np.linspace(-1.4, 0.9, 50)
        ax.plot(g, np.maximum(-g, 0), color=GREY, lw=1)
        deepest = int(gaps.argmin())
        for n in range(len(gaps) - 1):
            if forces[n] == forces[n + 1] == 0.0:
                continue
            colour = ORANGE if n < deepest else BLUE
            style = {"arrowstyle": "-|>", "color": colour, "lw": 1.2, "shrinkA": 2, "shrinkB": 2}
            ax.annotate("", (gaps[n + 1], forces[n + 1]), (gaps[n], forces[n]), arrowprops=style)
        ax.plot(gaps, forces, "o", color="black", ms=4)
        ax.set(xlabel="gap g / (v / ω)", title=f"{title}: rebound {speed:.2f}", xlim=(-1.4, 0.9))
        ax.text(-1.35, 0.08, "loading", color=ORANGE)
        ax.text(-1.35, 0.25, "unloading", color=BLUE)
    figure.axes[0].set_ylabel("force λ / (v √(k m))")
    return figure


def surface_mode():
    """The mode at the end of a bar with a spring, from its matrix and from the closed form."""
    figure = Figure(figsize=(7.5, 3.0))
    shape, pitch = figure.subplots(1, 2)
    n = 60

    def highest(beta):
        stiff = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
        stiff[0, 0] = 1 + beta
        half = np.ones(n)
        half[0] = np.sqrt(0.5)
        values, vectors = np.linalg.eigh(stiff / np.outer(half, half))
        mode = vectors[:, -1] / half
        return np.sqrt(values[-1]) / 2, mode / mode[0]

    node = np.arange(12)
    for beta, colour in ((0.1, BLUE), (1.0, ORANGE), (4.0, GREEN)):
        r = 1 / (beta + np.sqrt(1 + beta**2))
        shape.plot(node, (-r) ** node, color=colour, lw=1)
        shape.plot(node, highest(beta)[1][:12], "o", color=colour, ms=4, label=f"β′ = {beta:g}")
    shape.set(xlabel="node from the contact", ylabel="displacement")
    shape.legend(fontsize=8)
    beta = np.geomspace(0.02, 50, 60)
    r = 1 / (beta + np.sqrt(1 + beta**2))
    pitch.semilogx(beta, 0.5 * np.sqrt(2 + r + 1 / r), color=BLUE, lw=1.2)
    some = np.geomspace(0.02, 50, 9)
    pitch.plot(some, [highest(b)[0] for b in some], "o", color=BLUE, ms=4)
    pitch.axhline(1, color="black", ls=":", lw=1)
    pitch.set(xlabel="β′", ylabel="frequency / cut-off")
    return figure


def iteration():
    """A quadratic function of two forces under λ ≥ 0, and the way to its minimum."""
    W = np.array([[1.0, 0.7], [0.7, 1.2]])
    free = np.array([-1.0, -0.3])
    value = lambda f: 0.5 * np.einsum("...i,ij,...j", f, W, f) + f @ free
    D = np.abs(W).sum(axis=1)
    path = [np.array([0.1, 0.9])]
    for _ in range(12):
        rest = W @ path[-1] + free
        path.append(path[-1] - np.minimum(rest / D, path[-1]))
    figure = Figure(figsize=(5.6, 3.8))
    ax = figure.subplots()
    grid = np.linspace(-0.8, 1.7, 161)
    height = value(np.stack(np.meshgrid(grid, grid), -1))
    levels = value(np.array([1.0, 0.0])) + np.array([0.003, 0.02, 0.06, 0.15, 0.3, 0.5, 0.8, 1.2])
    ax.contour(grid, grid, height, levels, colors=GREY, linewidths=0.7)
    ax.fill([0, 1.6, 1.6, 0], [0, 0, 1.2, 1.2], color=BLUE, alpha=0.08, lw=0)
    ax.plot(*np.array(path).T, "o-", color=ORANGE, ms=4.5)
    ax.plot(*np.linalg.solve(W, -free), "x", color=RED, ms=9, mew=2)
    ax.plot(1, 0, "*", color="black", ms=11)
    ax.set(xlabel="λ₁", ylabel="λ₂", xlim=(-0.3, 1.6), ylim=(-0.75, 1.15), aspect="equal")
    ax.axhline(0, color="black", lw=1)
    ax.axvline(0, color="black", lw=1)
    ax.grid(False)
    return figure


def return_map():
    """The slip before and after the return, in the plane; and the force over the slip."""
    figure = Figure(figsize=(7.5, 3.2))
    plane, loop = figure.subplots(1, 2)
    angle = np.linspace(0, 2 * np.pi, 200)
    plane.fill(np.cos(angle), np.sin(angle), color=BLUE, alpha=0.15, lw=0)
    plane.plot(np.cos(angle), np.sin(angle), color=BLUE, lw=1.4)
    for trial, colour in (((1.25, 0.9), ORANGE), ((-0.5, 0.45), GREEN), ((-0.9, -1.1), ORANGE)):
        trial = np.array(trial)
        back = trial * min(1.0, 1.0 / np.hypot(*trial))
        plane.plot(*trial, "o", color=colour, ms=7)
        plane.plot(*back, "s", color=colour, ms=6)
        if np.hypot(*trial) > 1:
            style = {"arrowstyle": "-|>", "color": colour, "lw": 1.4}
            plane.annotate("", back, trial, arrowprops=style)
    plane.text(1.25, 1.02, r"$\mathbf{s}^*$", color=ORANGE)
    plane.text(0.6, 0.33, r"$\mathbf{s}$", color=ORANGE)
    plane.text(-0.5, 0.58, r"$\mathbf{s} = \mathbf{s}^*$", color=GREEN, ha="center")
    plane.text(0, -0.25, r"$|\mathbf{s}| \leq \mu |\mathbf{d}| / \varrho$", color=BLUE, ha="center")
    bare(plane, (-1.6, 1.75), (-1.4, 1.4))
    motion, force = rubbed()
    loop.plot(motion, force, color=ORANGE)
    loop.axhline(1, color=BLUE, lw=1, ls="--")
    loop.axhline(-1, color=BLUE, lw=1, ls="--")
    loop.text(0.02, 1.06, "μ N", color=BLUE)
    loop.set(xlabel="motion / (μ d / ϱ)", ylabel="force / (μ N)", ylim=(-1.3, 1.3))
    return figure


def rubbed():
    """Motion to and fro of a patch that is pressed on a larger one, and the friction on it, by the library."""
    low, faces = patch(0.0, True, 3, 3.0)
    high, others = patch(-0.01, False, 1)
    high = high + [1.25, 1.25, 0]  # no border of a face is crossed on the way
    mu, depth = 0.5, 0.01
    contact = ct.Contact(
        ct.Surface("Q4", high, others),
        ct.Surface("Q4", low, faces),
        epsilon=1.0,
        enforcement="penalty",
        initial_penetration="push",
        friction=mu,
    )
    way = (
        2.5
        * mu
        * depth
        * np.concatenate([np.linspace(0, 1, 60), np.linspace(1, -1, 120), np.linspace(-1, 1, 120)])
    )
    free, last, force = np.zeros_like(high), 0.0, []
    for x in way:
        v = np.zeros_like(high)
        v[:, 0] = (x - last) / 0.01
        still = np.zeros_like(low)
        contact.step(0.01, (high + [x, 0, 0], low), (v, still), (free, still), kick=0.01)
        total = np.zeros_like(high)
        contact.add_force((total, still.copy()))
        force.append(-total[:, 0].sum() / (mu * total[:, 2].sum()))
        last = x
    return way / (mu * depth), np.array(force)


def zones():
    """Stick and slip under a block that is pressed on a plane and pulled along it."""
    scene = ct.Scene(title="stick and slip", units=UNITS)
    scene.add_material("rubber", young=1.0, poisson=0.3, density=1.0)
    cells, mu = 40, 0.5
    box = {"origin": [0, 0, 0], "size": [2, 0.05, 0.5], "cells": [cells, 1, cells // 4]}
    scene.add_body("block", material="rubber", box=box)
    scene.add_support("block.y_min", fix="y")
    scene.add_support("block.y_max", fix="y")
    plane = {"point": [0, 0, 0], "normal": [0, 0, 1]}
    scene.add("obstacle", surface="block.z_min", plane=plane, friction=mu, beta=4)
    press = {"time": [0, 15, 200], "value": [0, 1, 1]}
    pull = {"time": [0, 20, 50, 200], "value": [0, 0, 1, 1]}
    scene.add("load", surface="block.z_max", traction=[0, 0, -0.01], history=press)
    scene.add("load", surface="block.z_max", traction=[0.004, 0, 0], history=pull)
    scene.add("damping", rate=0.6)
    scene.set_time(end=90.0, fraction=0.9).set_output(every=10**6, fields=[])
    state = scene.run(progress=False, output=False).state["block"]
    low = state.centres[:, 2] < 0.5 / (cells // 4)
    order = np.argsort(state.centres[low, 0])
    x, stress = state.centres[low, 0][order], state.stress[low][order]
    pressure, shear = -stress[:, 2], np.abs(stress[:, 5])
    figure = Figure(figsize=(7.5, 3.0))
    ax = figure.subplots()
    slips = shear > 0.95 * mu * pressure
    edges = np.linspace(0, 2, cells + 1)
    for a, b, slip in zip(edges, edges[1:], slips):
        ax.axvspan(a, b, ymax=0.06, color=RED if slip else GREEN, alpha=0.8, lw=0)
    ax.plot(x, mu * pressure / 0.01, color=BLUE, label="μ × pressure")
    ax.plot(x, shear / 0.01, color=ORANGE, label="shear")
    ax.set(xlabel="place x", ylabel="stress / mean pressure", xlim=(0, 2), ylim=(-0.06, None))
    ax.legend()
    return figure


def shapes():
    """The three obstacles with their normals, and their gaps as contours."""
    figure = Figure(figsize=(7.5, 2.9))
    grid = np.linspace(-2, 2, 121)
    x, z = np.meshgrid(grid, grid)
    slope = np.array([0.35, 1.0]) / np.hypot(0.35, 1.0)
    axis = np.array([1.0, 0.25]) / np.hypot(1.0, 0.25)
    across = np.array([-axis[1], axis[0]])
    distances = (
        ("plane", slope[0] * x + slope[1] * z),
        ("sphere", np.hypot(x, z) - 1.0),
        ("cylinder, from the side", np.abs(across[0] * x + across[1] * z) - 0.7),
    )
    starts = (
        [
            -1.3 * np.array([slope[1], -slope[0]]),
            np.zeros(2),
            1.3 * np.array([slope[1], -slope[0]]),
        ],
        [np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.4, 2.6, 4.4)],
        [s * axis + side * 0.7 * across for s in (-1, 0.2) for side in (-1, 1)],
    )
    for ax, (name, gap), places in zip(figure.subplots(1, 3), distances, starts):
        ax.contourf(x, z, gap, [-9, 0], colors=[GREY], alpha=0.3)
        ax.contour(x, z, gap, [-0.8, -0.4, 0.4, 0.8], colors=GREY, linewidths=0.6, linestyles=":")
        ax.contour(x, z, gap, [0], colors=BLUE, linewidths=1.8)
        for place in places:
            normal = slope if name == "plane" else place / np.hypot(*place)
            if name.startswith("cylinder"):
                normal = across * np.sign(place @ across)
            arrow(ax, place, 0.55 * normal, r"$\mathbf{n}$", ORANGE)
        if name == "sphere":
            ax.plot(0, 0, "+", color="black", ms=8)
        if name.startswith("cylinder"):
            line(ax, -2 * axis, 2 * axis, color="black", lw=0.8, ls="-.")
        ax.set_title(name)
        bare(ax, (-2, 2), (-2, 2))
    return figure


def hertz():
    """The recovered pressure under a sphere, beside Hertz's."""
    data = ct.Scene.load(ct.example("hertz")).data
    box = {"origin": [0, 0, -3], "size": [3, 3, 3], "cells": [20, 20, 20]}
    data["body"][0] |= {"box": box}
    data["obstacle"][0]["beta"] = 10
    data["time"] |= {"end": 4e-3, "until_static": 1e-4}
    data |= {"damping": {"relaxation": True}, "output": {"every": 10**6, "fields": []}}
    run = ct.Scene(data).run(progress=False, output=False)
    (nodes,) = run.pressure["obstacle"]
    r = np.hypot(*nodes["position"][:, :2].T)
    force = 4 * -(nodes["area"] * nodes["traction"][:, 2]).sum()
    modulus, radius = 1000 / 0.91, 4.0
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    peak = 1.5 * force / (np.pi * a**2)
    figure = Figure(figsize=(7.5, 3.4))
    ax = figure.subplots()
    fine = np.linspace(0, a, 300)
    ax.plot(fine / a, np.sqrt(1 - (fine / a) ** 2), color="black", lw=1.4, label="Hertz")
    near = r < 1.5 * a
    ax.plot(r[near] / a, nodes["pressure"][near] / peak, "o", ms=4, label="pressure at the nodes")
    ax.set(xlabel="distance from the middle r / a", ylabel="pressure / peak", xlim=(0, 1.5))
    ax.legend()
    return figure
