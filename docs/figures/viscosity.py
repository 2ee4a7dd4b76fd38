"""Pictures of the chapter on bulk viscosity."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
from shared.scenes import bar, done, scene_of


def viscous_pressure(speed, linear, quadratic):
    """Pressure of the bulk viscosity of a cube whose ends approach each other at this speed, from one step of the
    library."""
    scene = bar(scene_of(), cells=1, velocity=[-speed, 0, 0])
    scene.add_support("bar.x_min", fix="x")
    scene.add("viscosity", linear=linear, quadratic=quadratic)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    run = done(scene.set_time(end=1e-4, dt=1e-4))
    # From t = 0 the end, half of the mass, has gained half a kick of the pressure; the stress is of higher order.
    return (run.probes["end"]["displacement"][1, 0] / run.dt + speed) / run.dt


def viscosity_law():
    """The pressure of the bulk viscosity over the closing speed of an element."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    x = np.linspace(-0.03, 0.1, 261)
    knee, a, closing = 0.03 / 1.44, 1.44, np.maximum(x, 0)
    parabola = np.where(closing <= knee, a * closing**2, a * knee * (2 * closing - knee))
    ax.axvline(knee, color=GREY, lw=0.8)
    ax.text(knee + 0.001, 0.0105, "$x_*$")
    ax.plot(x, 0.06 * closing, label="linear part, Q₁ = 0.06")
    ax.plot(x, parabola, label="quadratic part, Q₂ = 1.2")
    ax.plot(closing, a * closing**2, "--", color=GREY, lw=1, label="parabola without limit")
    ax.plot(x, 0.06 * closing + parabola, color="black", label="both")
    at = np.array([-0.02, 0.01, 0.02, 0.04, 0.06, 0.08])
    for linear, quadratic, colour in ((0.06, 0.0, BLUE), (0.0, 1.2, ORANGE), (0.06, 1.2, "black")):
        found = [viscous_pressure(speed, linear, quadratic) for speed in at]
        ax.plot(at, found, "o", color=colour, ms=4)
    ax.set(xlabel="closing speed  l|D| / c₁  (left of 0: expansion)", ylabel="q / ρ c₁²")
    ax.set(ylim=(-0.0005, 0.0115), xlim=(-0.03, 0.1))
    ax.legend(loc="upper left")
    return figure


def shock():
    """The front in a rod of cubes that hits a wall at 5 % of c, after 120 cubes, with bulk viscosity of different
    strength."""
    figure = Figure(figsize=(7.5, 4.4))
    axes = figure.subplots(4, 1, sharex=True, sharey=True)
    for ax, (linear, quadratic), colour in zip(
        axes, ((0, 0), (0.06, 0), (0.06, 1.2), (0.5, 0)), (GREY, BLUE, ORANGE, GREEN), strict=True
    ):
        scene = bar(scene_of(), cells=160, length=160.0, velocity=[-0.05, 0, 0])
        scene.add_support("bar.x_min", fix="x")
        if linear:
            scene.add("viscosity", linear=linear, quadratic=quadratic)
        body = done(scene.set_time(end=120.0, courant=0.2)).state["bar"]
        order = np.argsort(body.centres[:, 0])
        ax.plot([60, 120, 120, 150], [1, 1, 0, 0], color="black", lw=0.8)
        ax.plot(
            body.centres[order, 0], -body.stress[order, 0] / 0.05, ".-", ms=4, lw=1, color=colour
        )
        ax.set_title(f"Q₁ = {linear}, Q₂ = {quadratic}", loc="left", fontsize=9)
        ax.set(xlim=(70, 140), ylim=(-0.15, 1.4))
    figure.supylabel("stress over the exact one", fontsize=10)
    axes[-1].set_xlabel("distance from the wall, elements")
    return figure
