"""Picture of the benchmark of two rods."""

from matplotlib.figure import Figure
from problems import rods, runs

NAMES = {
    "rods_equal": "equal",
    "rods_unequal": "equal times of travel",
    "rods_saint_venant": "Saint-Venant",
}


def pressures():
    """Pressure of the contact over time, and that of the closed form."""
    figure = Figure(figsize=(7.5, 3.0), layout="constrained")
    axes = figure.subplots()
    for name, label in NAMES.items():
        data = runs.load(name)
        rows = runs.done(data).probes["contact"]
        area = data["body"][0]["box"]["size"][1] ** 2
        (line,) = axes.plot(rows["time"], rows["force"][:, 0] / area, lw=1, label=label)
        exact = rods.RODS[name]["pressure"]
        axes.plot([0, 0, 20, 20], [0, exact, exact, 0], color=line.get_color(), ls="--", lw=1)
    axes.set(xlabel="time", ylabel="pressure", xlim=(-0.5, 25))
    axes.legend(loc="lower left")
    return figure
