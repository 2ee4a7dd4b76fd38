"""The tables of ``make stability`` and ``make zoo``."""

from __future__ import annotations

import defaults

from .shared import DOCS, Numbers, measurement


@measurement
def laboratory() -> Numbers:
    """From the tables of `make stability` and `make zoo`, the default law: growth and loss of linear bodies and of the
    others, and how the runs of the zoo ended."""
    rows = defaults.table.read(DOCS / "stability" / "summary.csv")
    own = [row for row in rows if row["enforcement"] == "energy-controlled" and row["lost"] != ""]
    large = ("folding strip", "rolled strip", "coil", "crushed ring", "pair of bodies")
    found = {"linear_growth": max(r["energy grows by"] for r in own if r["case"] not in large)}
    found["plates_lost"] = max(r["lost"] for r in own if r["case"] == "plates")
    for name in large:
        (row,) = (r for r in own if r["case"] == name)
        key = name.split()[0]
        if key != "rolled":  # that of the rolled strip is round-off
            found[f"{key}_growth"] = row["energy grows by"]
        if key not in ("crushed", "pair"):
            found[f"{key}_lost"] = row["lost"]
    zoo = defaults.table.read(DOCS / "stability" / "zoo.csv")
    found |= {
        f"zoo_{name}": sum(r[name] for r in zoo)
        for name in ("runs", "ok", "told", "refused", "fail")
    }
    found["zoo_growth"] = max(r["bodies' energy grows by"] for r in zoo)
    return found


@measurement
def impacts() -> Numbers:
    """From the table of `stability/impacts.py`: the most that impacts of linear bodies and linear folds lose, and how
    far the speeds of cradles of two and four layers, and of one, are outside the range."""
    rows = {row["case"]: row for row in defaults.table.read(DOCS / "theory" / "impacts.csv")}
    large = ("discs", "ring", "fold")
    lost = {case: row["lost, %"] / 100 for case, row in rows.items()}
    return {
        "linear_lost": max(v for case, v in lost.items() if not any(n in case for n in large)),
        "fold_lost": lost["linear fold"],
        "cradle": max(rows[f"cradle of {n}"]["speed off"] for n in (2, 4)),
        "thin_cradle": max(rows[f"cradle of 1{mesh}"]["speed off"] for mesh in ("", ", 4:5:4")),
    }
