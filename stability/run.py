"""``make stability``: every case, one table, pictures. ``run.py FOLDER [--short] [CASE ...]``; Ctrl-C keeps what is done."""

from __future__ import annotations

import csv
import json
import os
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import cases  # noqa: E402
import lab  # noqa: E402


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
    """Rows that do not end as their case expects."""
    return [row for row in rows if row.good != (row.expected == "passes")]


def write(rows: list[lab.Row], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "stability.json").write_text(json.dumps([row.data() for row in rows], indent=1))
    with (folder / "stability.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        names = [name for name in rows[0].data() if name != "curve"]
        table.writerow(names)
        table.writerows([[row.data()[name] for name in names] for row in rows])


def main() -> int:
    arguments = [argument for argument in sys.argv[1:] if argument != "--short"]
    folder, names = Path(arguments[0]), arguments[1:]
    known = [case.__name__ for case in cases.CASES]
    if unknown := [name for name in names if name not in known]:
        print(f"no case is named {', '.join(unknown)}; there are {', '.join(known)}")
        return 2
    rows = collect(names, "--short" in sys.argv)
    if rows:
        write(rows, folder)
        import pictures

        pictures.draw(rows, folder)
    odd = surprises(rows)
    default = [row for row in rows if row.enforcement == lab.DEFAULT]
    print(f"\n{len(rows)} rows; the default enforcement passes {sum(row.good for row in default)} of {len(default)}; {len(odd)} rows end otherwise than expected")
    for row in odd:
        print("  " + lab.line(row))
    return 1 if odd else 0


if __name__ == "__main__":
    sys.exit(main())
