"""
``make stability``: all cases, one table. Ctrl-C keeps the completed rows. ``--book`` writes the tables of the
chapter "Stability" into ``docs/stability``.
"""

from __future__ import annotations

import json
import math
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import cases  # noqa: E402
import lab  # noqa: E402
import program  # noqa: E402

BOOK = Path(__file__).resolve().parents[1] / "docs" / "stability"
# Cases that share one line of the summary.
GROUPS = {
    "bar on a wall, other integrators": "bar on a wall, other integrators",
    "plates, other integrators": "plates, other integrators",
    "cube dropped on its face": "cube dropped",
    "cube dropped on its edge": "cube dropped",
    "cube dropped on its corner": "cube dropped",
    "last bit as given": "last bit of the input changed",
    "rounding to nearest": "rounding modes",
    "rounding down": "rounding modes",
    "rounding up": "rounding modes",
    "rounding to zero": "rounding modes",
    **{
        f"length {length} m": "sizes 1e-9 ... 1e6 m"
        for length in ("1", "1e-09", "1e-06", "0.001", "1000", "1e+06")
    },
}


def collect(names: list[str], short: bool) -> list[lab.Row]:
    """Run the cases of these names (none: all) and print each row as it comes."""
    rows: list[lab.Row] = []
    print(lab.head(), flush=True)
    try:
        for case in cases.CASES:
            if names and case.__name__ not in names:
                continue
            for row in case(short):
                rows.append(row)
                print(lab.line(row), flush=True)
    except KeyboardInterrupt:
        print("interrupted: the rows so far are kept", flush=True)
    return rows


def surprises(rows: list[lab.Row]) -> list[lab.Row]:
    """Rows whose result differs from the expectation of their case."""
    return [row for row in rows if not as_expected(row)]


def as_expected(row: lab.Row) -> bool:
    """Whether a row passes, or need not: where the leapfrog may gain energy it also may not."""
    if row.expected == "leapfrog":
        return row.good or row.told or row.by_leapfrog
    return row.good == (row.expected == "passes")


def write(rows: list[lab.Row], folder: Path) -> None:
    data = [row.data() for row in rows]
    plain = [{name: row[name] for name in row if name != "curve"} for row in data]
    program.write_table(folder / "stability.csv", plain)
    (folder / "stability.json").write_text(json.dumps(data, indent=1))


def summarise(rows: list[lab.Row]) -> list[dict[str, str]]:
    """One line for all rows of a case with one enforcement, with the worst value of each column."""
    groups: dict[tuple[str, str], list[lab.Row]] = {}
    for row in rows:
        groups.setdefault(
            (
                GROUPS.get(row.case, GROUPS.get(row.case.split(",")[0], row.case.split(",")[0])),
                row.enforcement,
            ),
            [],
        ).append(row)
    out = []
    for (case, enforcement), own in groups.items():
        whole = [row for row in own if math.isfinite(row.energy)]
        betas = sorted({row.beta for row in own if row.beta is not None})
        fractions = sorted({round(row.fraction, 2) for row in own if math.isfinite(row.fraction)})
        worst = {}
        for key in ("energy", "lost", "held", "made", "points", "nodes", "momentum"):
            values = [getattr(row, key) for row in whole if math.isfinite(getattr(row, key))]
            worst[key] = f"{max(values):.1e}" if values else ""
        out.append(
            {
                "case": case,
                "enforcement": enforcement.replace("_", "-"),
                "beta": _range(betas),
                "step": _range(fractions),
                "energy grows by": worst["energy"],
                "lost": worst["lost"],
                "may lose": _range(sorted({row.may_lose for row in whole if row.may_lose})),
                "held": worst["held"],
                "contact makes": worst["made"],
                "points / h": worst["points"],
                "nodes / h": worst["nodes"],
                "momentum": worst["momentum"],
                "passes": f"{sum(row.good for row in own)} of {len(own)}",
                "told": str(sum(row.told for row in own) or ""),
                "leapfrog": str(sum(row.by_leapfrog for row in own) or ""),
            }
        )
    return out


def _range(values: list[float]) -> str:
    return (
        ""
        if not values
        else f"{values[0]:g}"
        if len(values) == 1
        else f"{values[0]:g} ... {values[-1]:g}"
    )


def write_sweep(rows: list[lab.Row], folder: Path) -> None:
    """What the default law dissipates in the plates and how deep their points get, over penalty and step: a picture of
    the book (``docs/figures/stability.py``)."""
    own = [row for row in rows if row.case == "plates" and row.enforcement == lab.DEFAULT]
    if len({row.fraction for row in own}) < 2:
        return
    lines = [
        {"beta": f"{row.beta:g}", "step": f"{row.fraction:.2f}", "energy lost": f"{row.lost:.3g}"}
        | {"energy grows by": f"{row.energy:.3g}", "points / h": f"{row.points:.3g}"}
        for row in sorted(own, key=lambda row: (round(row.fraction, 2), row.beta))
    ]
    program.write_table(folder / "plates.csv", lines)


def main() -> int:
    parser = program.parser(__doc__, [case.__name__ for case in cases.CASES], "for the tables")
    parser.add_argument(
        "--short", action="store_true", help="fewer penalties and steps, small meshes"
    )
    given = parser.parse_args()
    rows = collect(given.cases, given.short)
    if rows:
        write(rows, given.folder)
        for place in (given.folder, BOOK) if given.book else (given.folder,):
            write_sweep(rows, place)
            program.write_table(place / "summary.csv", summarise(rows))
    odd = surprises(rows)
    default = [row for row in rows if row.enforcement == lab.DEFAULT]
    print(
        f"\n{len(rows)} rows; the default enforcement passes {sum(row.good for row in default)} of {len(default)}, {sum(row.told for row in default)} are told; {len(odd)} rows end otherwise than expected"
    )
    for row in odd:
        print("  " + lab.line(row))
    return 1 if odd else 0


if __name__ == "__main__":
    sys.exit(main())
