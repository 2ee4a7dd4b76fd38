"""Picture of the benchmark of two discs."""

from matplotlib.figure import Figure
from problems import runs


def velocities():
    """Mean velocities of both discs over time, and those of plane waves."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.subplots()
    data = runs.load("discs")
    data["output"]["every"] = 1
    run = runs.done(data)
    mass = run.body_momentum("small")["p"][0, 2] / -100
    for name, own, after in (("small", mass, 0), ("large", mass / 0.9**2, -81)):
        rows = run.body_momentum(name)
        (line,) = axes.plot(1e6 * run.time, rows["p"][:, 2] / own, label=f"{name} disc")
        axes.axhline(after, color=line.get_color(), ls="--", lw=1)
    axes.set(xlabel="time [µs]", ylabel="mean velocity [m/s]", xlim=(0, 100))
    axes.legend(loc="center right")
    return figure
