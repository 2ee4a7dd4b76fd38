"""Pictures of the chapter on the enforcement of contact."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, VIOLET
from shared.faces import patch

import libcontact as ct


def one_impact(enforcement, step, start=0.0):
    """Gaps and forces of a plate of mass 1 that falls on a fixed one with K = 1 and speed 1."""
    low, faces = patch(0.0, True, 1)
    x, others = patch(start, False, 1)
    contact = ct.Contact(
        ct.Surface("Q4", x.copy(), others),
        ct.Surface("Q4", low, faces),
        epsilon=1.0,
        enforcement=enforcement,
        restitution=0.0,
        depth=100.0,
    )
    v = np.zeros_like(x)
    v[:, 2] = -1.0
    held, free = np.zeros_like(x), np.full_like(x, 4.0)
    gaps, forces = [], []
    for _ in range(int(12 / step)):
        force = np.zeros_like(x)
        contact.step(step, (x, low), (v, held), (free, held), force_time=step)
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


def two_gaps():
    """The gaps and forces of one impact, and the force of one step where the ramp of the law meets the motion of the
    point."""
    step, n = 0.6, 2  # the step times ω, and the one that the right side shows
    gaps, forces, _ = one_impact("energy_controlled", step, start=0.5)
    a = 0.15 * np.sqrt(1 + 4 / step**2)  # (eq:surface-damping) for a point alone
    before = np.minimum(gaps[:-2], 0)
    law = lambda after, g: np.maximum(-0.5 * ((1 + a) * after + (1 - a) * g), 0)
    assert np.allclose(forces[1:-1], law(gaps[2:], before), atol=1e-12)
    figure = Figure(figsize=(7.5, 4.2))
    grid = figure.add_gridspec(2, 2, width_ratios=[1.15, 1], height_ratios=[1.5, 1])
    gap = figure.add_subplot(grid[0, 0])
    force = figure.add_subplot(grid[1, 0], sharex=gap)
    ramp = figure.add_subplot(grid[:, 1])
    t = np.arange(len(gaps))
    gap.axhline(0, color="black", lw=1)
    gap.plot(t, gaps, "o-", color=GREY, ms=4, lw=1)
    force.bar(t, forces, 0.5, color=GREY)
    force.bar(n, forces[n], 0.5, color=GREEN)
    names = ((n - 1, ORANGE, "$g_{n-1}$"), (n, GREY, "$g_n$"), (n + 1, BLUE, "$g_{n+1}$"))
    for at, colour, name in names:
        gap.plot(at, gaps[at], "o", color=colour, ms=8)
        gap.annotate(
            name, (at, gaps[at]), (-8, -10), textcoords="offset points", color=colour, ha="right"
        )
    force.annotate(
        r"$\lambda_n$", (n, forces[n]), (0, 2), textcoords="offset points", color=GREEN, ha="center"
    )
    gap.set(ylabel="gap ω / v", xlim=(-0.4, 8.4), ylim=(-1.0, 0.6))
    gap.tick_params(labelbottom=False)
    force.set(xlabel="step", ylabel="force", ylim=(0, 0.9))
    after = np.linspace(-1.15, 0.45, 200)
    ramp.plot(after, law(after, before[n - 1]), color=ORANGE, label="law, with $g_{n-1}$")
    free = 2 * gaps[n] - gaps[n - 1]
    ramp.plot(after, (after - free) / step**2, color=BLUE, label="motion, from $g_n$ and $g_{n-1}$")
    ramp.plot(gaps[n + 1], forces[n], "o", color=GREEN, ms=9, label="step of the library")
    ramp.plot(free, 0, "o", mfc="none", color=BLUE, ms=7, label="without contact")
    edge = -(1 - a) / (1 + a) * before[n - 1]
    ramp.plot(edge, 0, "|", color=ORANGE, ms=14, mew=2, label="threshold")
    ramp.set(xlabel="gap $g_{n+1}$ at the end of the step", ylabel="force λ", ylim=(-0.06, 1.0))
    ramp.set_xlim(-1.15, 0.45)
    figure.legend(*ramp.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def laws():
    """What settled contact loses in a period, and the surface mode that is left, for each law and four penalties."""
    with (Path(__file__).resolve().parents[1] / "theory" / "laws.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["settled, %"]]
    figure = Figure(figsize=(7.5, 4.4))
    ax = figure.subplots()
    colours = (GREY, VIOLET, GREEN, ORANGE, BLUE, RED)
    for law, colour in zip(dict.fromkeys(row["law"] for row in rows), colours, strict=True):
        own = [row for row in rows if row["law"] == law]
        x = np.maximum([float(row["settled, %"]) for row in own], 0.01)
        y = np.array([float(row["mode, %"]) for row in own])
        ax.loglog(x, y, "-", lw=2.4 if law == "ζ = 0.15" else 1.2, color=colour, label=law)
        ax.scatter(x, y, s=[12, 24, 44, 70], color=colour, zorder=3)
    ax.axhline(1, color="black", lw=0.8, ls=":")
    ax.axvline(0.5, color="black", lw=0.8, ls=":")
    ax.text(0.011, 1.05, "1 %", va="bottom")
    ax.text(0.52, 20, "0.5 %", va="top")
    ax.set(xlabel="settled contact: energy lost in a period, %  (0 is drawn at 0.01)")
    ax.set_ylabel("surface mode that is left, %")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure


def trade():
    """What each law takes from two plates that collide, or adds to them, over the layers, the penalty and the step."""
    with (Path(__file__).resolve().parents[1] / "theory" / "trade.csv").open() as file:
        rows = list(csv.DictReader(file))
    figure = Figure(figsize=(7.5, 3.6))
    usual = {"layers": "4", "beta": "40", "step": "0.9"}
    labels = {
        "layers": "layers of a plate",
        "beta": "penalty factor β",
        "step": "step / stable step",
    }
    for ax, swept in zip(figure.subplots(1, 3, sharey=True), usual):
        for law, colour in (
            ("explicit penalty", ORANGE),
            ("restitution 0", GREY),
            ("restitution 1", BLUE),
        ):
            fixed = {**usual, "law": law, **({"beta": "4"} if law == "explicit penalty" else {})}
            own = [r for r in rows if all(r[k] == v for k, v in fixed.items() if k != swept)]
            x = np.array([float(row[swept]) for row in own])
            lost = 100 * np.array([1 - float(row["least"]) for row in own])
            made = 100 * np.array([float(row["most"]) - 1 for row in own])
            (line,) = ax.plot(x, np.maximum(lost, 1e-2), "o-", color=colour, ms=4, lw=1.3)
            line.set_label(law)
            grows = made > 1e-6
            ax.plot(x[grows], np.maximum(made[grows], 1e-2), "x", color=RED, ms=7, mew=1.6)
        ax.set(xlabel=labels[swept], yscale="log")
        if swept != "step":
            ax.set_xscale("log")
            ticks = sorted({float(row[swept]) for row in rows})
            ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            ax.minorticks_off()
    figure.axes[0].set_ylabel("energy of the impact, %")
    figure.axes[0].plot([], [], "x", color=RED, label="energy made")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
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
    shape.legend(fontsize=9)
    beta = np.geomspace(0.02, 50, 60)
    r = 1 / (beta + np.sqrt(1 + beta**2))
    pitch.semilogx(beta, 0.5 * np.sqrt(2 + r + 1 / r), color=BLUE, lw=1.2)
    some = np.geomspace(0.02, 50, 9)
    pitch.plot(some, [highest(b)[0] for b in some], "o", color=BLUE, ms=4)
    pitch.axhline(1, color="black", ls=":", lw=1)
    pitch.set(xlabel="β′", ylabel="frequency / cut-off")
    return figure
