"""Picture of the chapter on supports."""

import numpy as np
from matplotlib.figure import Figure
from shared.scenes import bar, done, scene_of


def reaction():
    """The force of a rigid wall on a bar that flies against it, over ρ c v₀ A, and the impulse of the support."""
    scene = bar(scene_of(), cells=100, velocity=[-1, 0, 0])
    scene.add_support("bar.x_min", fix="x")
    scene.add_probe("wall", resultant="support[4]", body="bar", quantities=["force"])
    run = done(scene.set_time(end=1.8, fraction=0.5))
    figure = Figure(figsize=(7.5, 2.9))
    force, impulse = figure.subplots(1, 2)
    t, f = run.probes["wall"]["time"], run.probes["wall"]["force"][:, 0] / 1e-4
    force.plot(t, f, lw=1)
    force.plot([0, 1.8], [1, 1], color="black", lw=1)
    force.set(xlabel="time c t / L", ylabel="reaction / ρ c v₀ A", ylim=(-0.1, 1.7))
    impulse.plot(t, np.cumsum(f) * run.dt)
    impulse.plot([0, 1.8], [0, 1.8], color="black", lw=1)
    impulse.set(xlabel="time c t / L", ylabel="its impulse / ρ A L v₀")
    return figure
