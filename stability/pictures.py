"""Pictures of the stability laboratory."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402


def draw(rows: list, folder: Path) -> None:
    """The picture of the plates, if there are rows for it; the others are drawn by the book (``docs/figures/stability.py``)."""
    figure = sweep(rows)
    if figure is not None:
        figure.savefig(folder / "sweep.png", dpi=150)
        plt.close(figure)


def sweep(rows: list):
    """Energy that the default enforcement dissipates in the plates, and their largest overlap, over
    penalty and step."""
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
