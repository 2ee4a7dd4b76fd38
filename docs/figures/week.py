"""Pictures of "Contact in one week", from the programs of its chapters."""

from functools import cache

import bar
import numpy as np
import plates
import wall
from matplotlib.figure import Figure
from shared.drawing import DARK

import libcontact as ct


def condition():
    """The three lines of the contact condition, and what the penalty makes of them."""
    figure = Figure(figsize=(7.5, 2.8))
    exact, soft = figure.subplots(1, 2, sharey=True)
    for ax, title in ((exact, "the condition"), (soft, "the penalty")):
        ax.set(title=title, xlabel="gap g", xlim=(-1, 2), ylim=(-0.2, 2), xticks=[0], yticks=[0])
        ax.plot([-1, 0], [0, 0] if ax is soft else [np.nan] * 2, alpha=0)
    exact.set_ylabel("contact force λ")
    exact.plot([0, 0, 2], [2, 0, 0], lw=2.5)
    exact.annotate("pushes, gap closed", (0, 1.3), (0.2, 1.25))
    exact.annotate("open, no force", (1, 0), (0.7, 0.12))
    soft.plot([-1, 0, 2], [2, 0, 0], lw=2.5)
    soft.annotate("slope −k", (-0.5, 1), (-0.3, 1.0))
    return figure


def bounce():
    """The gap of a mass at a wall over time, with steps of two lengths."""
    figure = Figure(figsize=(7.5, 3.0))
    ax = figure.subplots()
    t = np.linspace(0, 1, 1001)
    inside = (t > 0.2) & (t < 0.2 + np.pi / 10)
    exact = np.where(inside, -0.1 * np.sin(10 * (t - 0.2)), np.abs(t - 0.2 - inside * np.pi / 10))
    exact = np.where(t > 0.2 + np.pi / 10, t - 0.2 - np.pi / 10, exact)
    ax.plot(t, exact, color="black", lw=1, label="by hand")
    for dt in (0.02, 0.1):
        gaps, _ = wall.bounce(100.0, dt, gap=0.2)
        ax.plot(
            dt * np.arange(len(gaps)), gaps, "o-", ms=3.5, lw=0.8, label=f"Δt = {10 * dt:g} / ω"
        )
    ax.set(xlabel="time", ylabel="gap", xlim=(0, 0.8), ylim=(-0.16, 0.25))
    ax.legend()
    return figure


def rebounds():
    """The range of the speed after the impact over the length of the step, for both laws."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    steps = np.linspace(0.05, 1.95, 77)
    for controlled, label in ((False, "penalty"), (True, "energy-controlled penalty")):
        found = np.array([wall.rebound(step, controlled, samples=60) for step in steps])
        ax.fill_between(steps, found.min(axis=1), found.max(axis=1), alpha=0.6, label=label)
    ax.axhline(1.0, color="black", lw=1)
    ax.set(xlabel="Δt ω", ylabel="speed after / speed before", xlim=(0, 2), ylim=(0, 1.8))
    ax.legend(loc="upper left")
    return figure


def waves():
    """Stress in two bars over place and time."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = figure.subplots()
    times, stresses, _, _ = bar.impact(courant=0.9, travel=3.0)
    shown = np.delete(stresses, 100, axis=1)
    image = ax.imshow(
        shown, origin="lower", extent=(-1, 1, 0, 3), aspect="auto", vmin=-1.2, vmax=1.2
    )
    ax.axvline(0, color=DARK, lw=0.8)
    ax.set(xlabel="place x / L", ylabel="time c t / L")
    ax.grid(False)
    figure.colorbar(image, label="stress / (ρ c v)")
    return figure


def moving_waves():
    """The bars on their way through the impact, with the stress in each element."""
    elements, scale = 40, 0.12  # places on the picture are x + scale * u
    times, stresses, forces, _ = bar.impact(elements)
    figure = Figure(figsize=(7.5, 2.8), layout="constrained")
    ax = figure.subplots()
    before = np.arange(-0.5, 0, 0.05)
    shown, frames = np.concatenate([before, times[::2]]), {}
    for side, own in ((-1, slice(0, elements)), (1, slice(elements + 1, None))):
        strain = np.vstack([np.zeros((len(before), elements)), stresses[::2, own]])
        u = np.cumsum(strain, axis=1) / elements
        speed = -side + side * np.cumsum(forces) / elements  # of the centre of mass
        centre = np.cumsum(speed) / elements
        u += np.concatenate([-side * before, centre[::2]])[:, None] - u.mean(axis=1)[:, None]
        x = (np.arange(elements) + 0.5) / elements - (side < 0) + scale * u
        ends = x[:, [0, -1]] + np.array([-0.5, 0.5]) / elements
        low, high = np.full_like(x[:, :2], -1.5), np.full_like(x[:, :2], -1.35)
        box = np.stack(
            [np.hstack([ends, ends[:, ::-1], ends[:, :1]]), np.hstack([low, high, low[:, :1]])], -1
        )
        (line,) = ax.plot(x[0], strain[0])
        (body,) = ax.fill(*box[0].T, color=line.get_color(), lw=0)
        frames |= {line: np.stack([x, strain], -1), body: box}
    (clock,) = ax.plot([-1.3, -1.3], [0.35, 0.35], color=DARK, lw=2.5)
    ends = np.stack([np.full_like(shown, -1.3), -1.3 + 2.6 * (shown + 0.5) / 3.5], 1)
    frames[clock] = np.stack([ends, np.full_like(ends, 0.35)], -1)
    ax.set(xlabel="place x / L", ylabel="stress / (ρ c v)", xlim=(-1.3, 1.3), ylim=(-1.6, 0.4))
    return figure, 6.0, frames


def fronts():
    """The wave in the right bar at half of its length, with steps of three lengths."""
    figure = Figure(figsize=(7.5, 3.0))
    axes = figure.subplots(1, 3, sharey=True)
    for ax, courant in zip(axes, (1.0, 0.5, 0.125)):
        _, stresses, _, _ = bar.impact(courant=courant, travel=0.5 + courant / 100)
        x = (np.arange(100) + 0.5) / 100
        ax.plot([0, 0.5, 0.5, 1], [-1, -1, 0, 0], color="black", lw=1)
        ax.plot(x, stresses[-1][101:])
        ax.set(title=f"Courant number {courant:g}", xlabel="x / L")
    axes[0].set_ylabel("stress / (ρ c v)")
    return figure


CELLS = 100


@cache
def own_stress():
    """Stresses of the elements by the program of the chapter, which two pictures show."""
    return plates.centre_stress(plates.impact(CELLS)[1], CELLS)


def beside():
    """Fig. 4 of the paper: the 90 lines of the chapter, the library, and the exact solution."""
    figure = Figure(figsize=(7.5, 3.4))
    ax = figure.subplots()
    x = (np.arange(CELLS) + 0.5) / CELLS
    own = own_stress()[:, 0, 0]
    run = ct.Scene.load(ct.example("plates")).run(progress=False, output=False)
    place, stress = run.state["right"].centres, run.state["right"].stress
    row = place[:, 2] < plates.D / CELLS
    order = np.argsort(place[row, 0])
    theirs = stress[row, 0][order] * plates.C1 / (plates.LAMBDA * plates.SPEED)
    ax.plot([0, 0.56, 0.56, 1], [-7 / 3, -7 / 3, 0, 0], color="black", lw=1, label="exact")
    ax.plot(x, theirs, lw=3, alpha=0.5, label="libcontact")
    ax.plot(x, own, "--", lw=1.2, label="plates.py")
    ax.set(xlabel="x / d", ylabel="σx*")
    ax.legend()
    return figure


def field():
    """σz* in the right plate, with the fronts of the exact solution."""
    figure = Figure(figsize=(5.5, 4.2))
    ax = figure.subplots()
    stress = own_stress()[:, :, 1]
    image = ax.imshow(stress.T, origin="lower", extent=(0, 1, 0, 1), vmin=-1.5, vmax=1.5)
    angle = np.linspace(0, np.pi / 2, 200)
    slow = np.sqrt((1 - 2 * plates.NU) / (2 - 2 * plates.NU))
    for radius, name in ((0.56, "c₁"), (0.56 * slow, "c₂")):
        ax.plot(radius * np.sin(angle), 1 - radius * np.cos(angle), color=DARK, lw=0.8)
        ax.annotate(name, (radius * 0.6, 1 - radius * 0.64), color=DARK)
    ax.axvline(0.56, color=DARK, lw=0.8)
    ax.set(xlabel="x / d", ylabel="z / d")
    ax.grid(False)
    figure.colorbar(image, label="σz*")
    return figure
