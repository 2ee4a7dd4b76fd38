"""Pictures of the chapter on a contact force that adds no energy."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
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
    figure.axes[0].set_ylabel("force / (v √(k m))")
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
        "$A_p p_n$", (n, forces[n]), (0, 2), textcoords="offset points", color=GREEN, ha="center"
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
    ramp.set(xlabel="gap $g_{n+1}$ at the end of the step", ylabel="force", ylim=(-0.06, 1.0))
    ramp.set_xlim(-1.15, 0.45)
    figure.legend(*ramp.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure
