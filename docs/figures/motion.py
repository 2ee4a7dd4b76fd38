"""Picture of the chapter on prescribed motion."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, ORANGE
from shared.scenes import bar, done, scene_of


def pushed(time, value):
    """A long bar whose end follows a path: displacement and force of the end."""
    scene = bar(scene_of(), cells=100, length=2.0)
    history = {"time": time, "value": value}
    scene.add_support("bar.x_min", fix="x", travel=[0.1, 0, 0], history=history)
    scene.add_probe("end", body="bar", point=[0, 0, 0], quantities=["displacement"])
    scene.add_probe("force", resultant="support[4]", body="bar", quantities=["force"])
    run = done(scene.set_time(end=1.8, fraction=0.7))
    end, force = run.probes["end"], run.probes["force"]
    return end["time"], end["displacement"][:, 0], force["time"], force["force"][:, 0] / 4e-4


def paths():
    """Two paths of the end of a bar, with straight lines and rounded, and the forces that they take."""
    figure = Figure(figsize=(7.5, 3.4))
    place, force = figure.subplots(2, 1, sharex=True)
    t = np.linspace(0, 1, 81)
    smooth = (t - np.sin(2 * np.pi * t) / (2 * np.pi)).tolist()
    for label, time, value, colour in (
        ("straight", [0.0, 1.0], [0.0, 1.0], ORANGE),
        ("rounded", t.tolist(), smooth, BLUE),
    ):
        when, u, then, f = pushed(time, value)
        place.plot(when, u, color=colour, label=label)
        force.plot(then, f, color=colour, lw=1.2)
    place.set(ylabel="displacement")
    place.legend(loc="lower right")
    force.set(xlabel="time", ylabel="force / ρ c² A", ylim=(-0.15, 0.35))
    return figure
