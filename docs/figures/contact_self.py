"""Pictures of the chapter on self-contact: the status of a point, far sides, a fold."""

import numpy as np
from libcontact.mesh import Mesh
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, arrow, bare, line
from shared.faces import patch, patch_contact

import libcontact as ct


def status_of(heights, start, depth):
    """Gap, status and force of the first point of a patch that is moved to the heights in turn."""
    low, faces = patch(0.0, True)
    high, others = patch(start, False)
    contact = patch_contact((high, others), (low, faces), depth=depth)
    rest, free, out = np.zeros_like(high), np.ones_like(high), []
    for height in heights:
        moved = high + [0, 0, height - start]
        contact.step(0.01, (moved, low), (rest, rest), (free, free), (rest, rest), force_time=0.01)
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
    outer, _ = mesh.faces("outer")
    surface = ct.Surface("Q4", reference, outer)
    contact = ct.Contact(surface, epsilon=1.0, enforcement="penalty", depth=0.12)
    rest, free = np.zeros_like(reference), np.ones_like(reference)
    for close in np.linspace(0.0, 0.1, 21):
        now = hairpin(close)[2]
        contact.step(0.01, now, rest, free, rest, force_time=0.01)
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
