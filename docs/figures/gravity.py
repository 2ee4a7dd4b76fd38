"""Picture of the chapter on gravity."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE
from shared.scenes import done, scene_of


def fall():
    """A stone thrown up: twelve long steps on the parabola, and its energies."""
    scene = scene_of(young=100.0)
    box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
    scene.add_body("stone", material="elastic", box=box, velocity=[0, 0, 5])
    scene.add("gravity", acceleration=[0, 0, -10])
    scene.add_probe("stone", body="stone", point=[0, 0, 0], quantities=["displacement"])
    run = done(scene.set_time(end=1.0, dt=1 / 12).set_output(every=1))
    figure = Figure(figsize=(7.5, 3.0))
    height, energy = figure.subplots(1, 2)
    t = np.linspace(0, 1, 201)
    height.plot(t, 5 * t - 5 * t**2, color="black", lw=1, label="v₀t − ½gt²")
    height.plot(run.probes["stone"]["time"], run.probes["stone"]["displacement"][:, 2], "o")
    height.set(xlabel="time", ylabel="height")
    height.legend(loc="lower center")
    for name, colour in (("kinetic", BLUE), ("gravity", ORANGE), ("total", "black")):
        energy.plot(run.energy["time"], run.energy[name], ".-", color=colour, label=name, lw=1)
    energy.axhline(12.5, color=GREY, lw=1, ls="--", label="½mv₀²")
    energy.set(xlabel="time", ylabel="energy")
    energy.legend(loc="center")
    return figure
