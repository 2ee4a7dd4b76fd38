"""Pictures of the stability laboratory."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402


def draw(rows: list, folder: Path) -> None:
    """Every picture for which there are rows."""
    for name, picture in (("verdicts", verdicts), ("sweep", sweep), ("bouncing", bouncing)):
        figure = picture(rows)
        if figure is not None:
            figure.savefig(folder / f"{name}.png", dpi=150)
            plt.close(figure)


def verdicts(rows: list):
    """Growth of energy of every row, by enforcement."""
    names = list(dict.fromkeys(row.enforcement for row in rows))
    figure, axis = plt.subplots(figsize=(8, 4), constrained_layout=True)
    for k, name in enumerate(names):
        own = [row for row in rows if row.enforcement == name and np.isfinite(row.energy)]
        spread = k + 0.6 * (np.arange(len(own)) / max(len(own), 1) - 0.5)
        axis.scatter(
            spread,
            [max(row.energy, 1e-17) for row in own],
            s=14,
            c=["tab:green" if row.good else "tab:red" for row in own],
        )
    axis.axhline(0.01, color="black", linewidth=0.8)
    axis.set_yscale("log")
    axis.set_xticks(range(len(names)), [name.replace("_", " ") for name in names])
    axis.set_ylabel("largest growth of energy, over its scale")
    axis.set_title("Every run of the laboratory: green passes, red does not")
    return figure


def sweep(rows: list):
    """What the default enforcement takes from the plates, and how deep they overlap, over penalty and step."""
    own = [row for row in rows if row.case == "plates" and row.enforcement == "energy_controlled"]
    if len({row.fraction for row in own}) < 2:
        return None
    figure, (lost, depth) = plt.subplots(1, 2, figsize=(9, 3.6), constrained_layout=True)
    for fraction in sorted({round(row.fraction, 2) for row in own}):
        part = sorted(
            (row for row in own if round(row.fraction, 2) == fraction), key=lambda row: row.beta
        )
        beta = [row.beta for row in part]
        lost.semilogx(
            beta,
            [100 * row.lost for row in part],
            "o-",
            markersize=4,
            label=f"{fraction:g} of the limit",
        )
        depth.loglog(beta, [max(row.points, 1e-17) for row in part], "o-", markersize=4)
    lost.set_ylabel("energy taken away [%]")
    lost.set_ylim(bottom=0)
    lost.legend(frameon=False, fontsize=8)
    depth.set_ylabel("deepest Gauss point / h")
    for axis in (lost, depth):
        axis.set_xlabel("penalty factor β")
        axis.spines[["top", "right"]].set_visible(False)
    most = max(row.energy for row in own)
    figure.suptitle(
        "Plate impact, energy-controlled penalty: "
        + (f"energy grows by {most:.1g} at most" if most > 0 else "energy grows in no run")
    )
    return figure


def bouncing(rows: list):
    """Phase of each impact of the bouncing bar."""
    own = [row for row in rows if row.case.startswith("bouncing") and row.curve]
    if not own:
        return None
    figure, axis = plt.subplots(figsize=(7, 3.8), constrained_layout=True)
    for row in own:
        axis.plot(
            row.curve["impact"],
            100 * np.array(row.curve["late"]),
            ".-",
            label=f"{row.enforcement.replace('_', ' ')}, {row.fraction:.2g} of the step, {row.steps} steps",
        )
    axis.axhline(0, color="black", linewidth=0.8)
    axis.set_xlabel("impact")
    axis.set_ylabel("late, % of a period")
    axis.legend(frameon=False, fontsize=8)
    axis.set_title("A bar that bounces: each impact shakes it, and the shaking shifts the next one")
    return figure
