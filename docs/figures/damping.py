"""Pictures of the chapter on damping."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED
from shared.scenes import bar, done, scene_of


def decay(young, **damping):
    """The fraction of critical damping of a cube that swings along its length, from the peaks of a run, and its ω."""
    scene = bar(scene_of(young=young), cells=1, velocity=[1e-3, 0, 0])
    scene.add_support("bar.x_min", fix="x").add("damping", **damping)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    omega = np.sqrt(2 * young)
    run = done(scene.set_time(end=40 / omega, dt=0.02 / omega))
    u = run.probes["end"]["displacement"][:, 0]
    peaks = np.flatnonzero((u[1:-1] > u[:-2]) & (u[1:-1] > u[2:])) + 1
    fall = np.log(u[peaks[0]] / u[peaks[-1]]) / (len(peaks) - 1) / (2 * np.pi)
    return omega, fall / np.sqrt(1 + fall**2)


def ratios():
    """The damping ratio of modes: damping in proportion to mass, to stiffness, and both."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    omega, rate, slow = np.geomspace(0.3, 30, 201), 0.2, 0.01
    ax.loglog(omega, rate / (2 * omega), label="α M", color=BLUE)
    ax.loglog(omega, slow * omega / 2, label="β K", color=ORANGE)
    ax.loglog(omega, rate / (2 * omega) + slow * omega / 2, "k--", lw=1, label="α M + β K")
    for colour, label, keys in (
        (BLUE, "α M, runs", {"rate": rate}),
        (ORANGE, "β K, runs", {"stiffness": slow}),
    ):
        found = np.array([decay(young, **keys) for young in (0.2, 1, 5, 25, 125)])
        ax.loglog(*found.T, "o", color=colour, label=label)
    ax.set(xlabel="ω of the mode", ylabel="damping ratio ζ", xlim=(0.3, 30), ylim=(1e-3, 1))
    ax.legend(loc="center left")
    return figure


def to_rest():
    """A bar that hangs at one end and gets its weight at once: without damping, with three rates, and relaxed."""
    figure = Figure(figsize=(7.5, 3.4))
    ax = figure.subplots()
    lowest = np.pi / 2  # of a bar with ρ = c = L = 1
    for label, keys, colour in (
        ("no damping", None, GREY),
        ("α = 0.4 ω₁", {"rate": 0.4 * lowest}, BLUE),
        ("α = 2 ω₁", {"rate": 2 * lowest}, ORANGE),
        ("α = 10 ω₁", {"rate": 10 * lowest}, GREEN),
        ("relaxation", {"relaxation": True}, RED),
    ):
        scene = bar(scene_of(), cells=20)
        scene.add_support("bar.x_min", fix="x").add("gravity", acceleration=[1e-3, 0, 0])
        if keys:
            scene.add("damping", **keys)
        scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
        run = done(scene.set_time(end=16.0, fraction=0.9))
        u = run.probes["end"]["displacement"][:, 0] / 0.5e-3
        ax.plot(run.probes["end"]["time"], u, label=label, color=colour, lw=1.4)
    ax.axhline(1.0, color="black", lw=0.8)
    ax.set(xlabel="time c t / L", ylabel="displacement of the end / at rest", ylim=(-0.05, 2.4))
    ax.legend(ncols=3, loc="upper right")
    return figure
