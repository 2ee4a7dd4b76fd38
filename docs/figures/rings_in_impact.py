"""Picture of the benchmark of two rings."""

from matplotlib.figure import Figure
from problems import rings


def velocities():
    """Velocity of the left ring over time, by modes and by the scene."""
    figure = Figure(figsize=(6.5, 3.2), layout="constrained")
    axes = figure.subplots()
    axes.plot(*rings.rings_exact(40, 0.02), label="modes")
    time, speed, _ = rings.rings(*rings.RINGS["48"])
    axes.plot(time, speed, "--", label="48 bricks")
    axes.set(xlabel="time", ylabel="velocity over that of the impact", xlim=(0, rings.RINGS_END))
    axes.legend(loc="upper right")
    return figure
