"""Picture of the chapter on the planner: a bar on a wall, whose momentum after the impact is known."""

import numpy as np
from libcontact.planning.planner import extrapolate, together
from matplotlib.figure import Figure

import libcontact as ct

CELLS = (10, 14, 20, 28, 40)
SETTINGS = {
    "central difference": {"integrator": "central_difference"},
    "Tchamwa–Wielgosz 0.95": {"integrator": "tchamwa_wielgosz", "integrator_parameter": 0.95},
    "Chung–Lee 1.02": {"integrator": "chung_lee", "integrator_parameter": 1.02},
}


def momentum(cells, keys):
    """Momentum of the bar at the end of a run, over its value for an elastic impact."""
    data = ct.Scene.load(ct.example("bar_on_a_wall")).data
    data["body"][0]["box"] |= {"size": [10, 0.5, 0.5], "cells": [cells, 1, 1]}
    data["time"] |= {"fraction": 0.9, **keys}
    data["output"] = {"every": 10**9}
    run = ct.Scene(data).run(progress=False, output=False)
    return run.momentum["p"][-1, 0] / -run.momentum["p"][0, 0]


def limits():
    """Values of one functional on five meshes with three settings, their extrapolations, and the common limit."""
    figure = Figure(figsize=(7.5, 3.4))
    left, right = figure.subplots(1, 2, width_ratios=(3, 2))
    h, found = 10.0 / np.array(CELLS), []
    for k, (name, keys) in enumerate(SETTINGS.items()):
        values = np.array([momentum(cells, keys) for cells in CELLS])
        limit = extrapolate(h, values)
        found.append(limit)
        slope = np.linalg.lstsq((h**limit.order)[:, None], values - limit.value, rcond=None)[0][0]
        fine = np.linspace(0.0, h[0], 100)
        left.plot(fine, limit.value + slope * fine**limit.order, "--", lw=0.8, color=f"C{k}")
        left.plot(h, values, "o", ms=5, color=f"C{k}", label=f"{name}, order {limit.order:.1f}")
        error = {"yerr": limit.uncertainty, "capsize": 4, "color": f"C{k}"}
        right.errorbar(k, limit.value, fmt="s", ms=5, **error)
    mean, width = together(found)
    right.errorbar(len(found), mean, yerr=width, fmt="D", ms=6, capsize=4, color="black")
    for ax in (left, right):
        ax.axhline(1.0, lw=0.8, color="black")
    left.set(xlabel="size of the elements, h", ylabel="momentum after over before", xlim=(0, None))
    left.legend(fontsize=9, loc="lower left")
    right.set(xlim=(-0.6, 3.6), ylabel="limit", xticks=range(4))
    right.set_xticklabels(["1", "2", "3", "common"])
    return figure
