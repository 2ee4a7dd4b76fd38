"""Pictures of the chapter on the enforcement of contact."""

import csv
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED, VIOLET


def laws():
    """What settled contact loses in a period, and the surface mode that is left, for each law and four penalties."""
    with (Path(__file__).resolve().parents[1] / "theory" / "laws.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["settled, %"]]
    figure = Figure(figsize=(7.5, 4.4))
    ax = figure.subplots()
    colours = (GREY, VIOLET, GREEN, ORANGE, BLUE, RED)
    for law, colour in zip(dict.fromkeys(row["law"] for row in rows), colours, strict=True):
        own = [row for row in rows if row["law"] == law]
        x = np.maximum([float(row["settled, %"]) for row in own], 0.01)
        y = np.array([float(row["mode, %"]) for row in own])
        ax.loglog(x, y, "-", lw=2.4 if law == "ζ = 0.15" else 1.2, color=colour, label=law)
        ax.scatter(x, y, s=[12, 24, 44, 70], color=colour, zorder=3)
    ax.axhline(1, color="black", lw=0.8, ls=":")
    ax.axvline(0.5, color="black", lw=0.8, ls=":")
    ax.text(0.011, 1.05, "1 %", va="bottom")
    ax.text(0.52, 20, "0.5 %", va="top")
    ax.set(xlabel="settled contact: energy lost in a period, %  (0 is drawn at 0.01)")
    ax.set_ylabel("surface mode that is left, %")
    figure.legend(*ax.get_legend_handles_labels(), loc="outside lower center", ncols=6)
    return figure


def trade():
    """What each law takes from two plates that collide, or adds to them, over the layers, the penalty and the step."""
    with (Path(__file__).resolve().parents[1] / "theory" / "trade.csv").open() as file:
        rows = list(csv.DictReader(file))
    figure = Figure(figsize=(7.5, 3.6))
    usual = {"layers": "4", "beta": "40", "step": "0.9"}
    labels = {
        "layers": "layers of a plate",
        "beta": "penalty factor β",
        "step": "step / stable step",
    }
    for ax, swept in zip(figure.subplots(1, 3, sharey=True), usual):
        for law, colour in (
            ("explicit penalty", ORANGE),
            ("restitution 0", GREY),
            ("restitution 1", BLUE),
        ):
            fixed = {**usual, "law": law, **({"beta": "4"} if law == "explicit penalty" else {})}
            own = [r for r in rows if all(r[k] == v for k, v in fixed.items() if k != swept)]
            x = np.array([float(row[swept]) for row in own])
            lost = 100 * np.array([1 - float(row["least"]) for row in own])
            made = 100 * np.array([float(row["most"]) - 1 for row in own])
            (line,) = ax.plot(x, np.maximum(lost, 1e-2), "o-", color=colour, ms=4, lw=1.3)
            line.set_label(law)
            grows = made > 1e-6
            ax.plot(x[grows], np.maximum(made[grows], 1e-2), "x", color=RED, ms=7, mew=1.6)
        ax.set(xlabel=labels[swept], yscale="log")
        if swept != "step":
            ax.set_xscale("log")
            ticks = sorted({float(row[swept]) for row in rows})
            ax.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
            ax.minorticks_off()
    figure.axes[0].set_ylabel("energy of the impact, %")
    figure.axes[0].plot([], [], "x", color=RED, label="energy made")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    return figure


def surface_mode():
    """The mode at the end of a bar with a spring, from its matrix and from the closed form."""
    figure = Figure(figsize=(7.5, 3.0))
    shape, pitch = figure.subplots(1, 2)
    n = 60

    def highest(beta):
        stiff = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
        stiff[0, 0] = 1 + beta
        half = np.ones(n)
        half[0] = np.sqrt(0.5)
        values, vectors = np.linalg.eigh(stiff / np.outer(half, half))
        mode = vectors[:, -1] / half
        return np.sqrt(values[-1]) / 2, mode / mode[0]

    node = np.arange(12)
    for beta, colour in ((0.1, BLUE), (1.0, ORANGE), (4.0, GREEN)):
        r = 1 / (beta + np.sqrt(1 + beta**2))
        shape.plot(node, (-r) ** node, color=colour, lw=1)
        shape.plot(node, highest(beta)[1][:12], "o", color=colour, ms=4, label=f"β′ = {beta:g}")
    shape.set(xlabel="node from the contact", ylabel="displacement")
    shape.legend(fontsize=9)
    beta = np.geomspace(0.02, 50, 60)
    r = 1 / (beta + np.sqrt(1 + beta**2))
    pitch.semilogx(beta, 0.5 * np.sqrt(2 + r + 1 / r), color=BLUE, lw=1.2)
    some = np.geomspace(0.02, 50, 9)
    pitch.plot(some, [highest(b)[0] for b in some], "o", color=BLUE, ms=4)
    pitch.axhline(1, color="black", ls=":", lw=1)
    pitch.set(xlabel="β′", ylabel="frequency / cut-off")
    return figure
