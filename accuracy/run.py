"""
``make accuracy``: the cost of accuracy. ``run.py FOLDER [--reduced | --short] [--book]`` runs each case of
``campaign.py`` that FOLDER/accuracy.csv does not have yet, so it can be stopped at any time and continued
with the same command. ``--book`` renews the tables of the chapter "What accuracy costs", the list of the
planner and the picture of the start page. ``--instructions`` only counts the instructions of the short
runs (callgrind); with ``--book`` it renews their table.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.append(str(Path(__file__).resolve().parent))

import campaign  # noqa: E402
import closest  # noqa: E402
import defaults  # noqa: E402
import drawings  # noqa: E402
import instructions  # noqa: E402
import table  # noqa: E402


def main() -> int:
    options = {argument for argument in sys.argv[1:] if argument.startswith("--")}
    level = next((name for name in campaign.LEVELS if f"--{name}" in options), "whole")
    folder = Path(next(argument for argument in sys.argv[1:] if not argument.startswith("--")))
    if "--instructions" in options:
        return count(folder, "--book" in options)
    try:
        rows = table.collect(level, folder / "accuracy.csv")
    except KeyboardInterrupt:
        print("interrupted: the rows so far are kept; the same command continues")
        return 1
    closest.write(folder / "accuracy_search.csv")
    defaults.write(folder / "accuracy_defaults.csv")
    if "--book" in options:
        for name in ("accuracy.csv", "accuracy_search.csv", "accuracy_defaults.csv"):
            shutil.copyfile(folder / name, table.BOOK / name)
        table.write_prices(rows, table.PRICES)
        drawings.write_lists(level, table.BOOK)
        drawings.write_list(table.BOOK / "accuracy_far.csv", defaults.far(table.BOOK))
        drawings.few().savefig(table.BOOK.parent / "_static" / "accuracy.png", dpi=110)
    drawings.draw(folder)
    print(
        f"{len(rows)} rows; {sum(row['status'] != 'done' for row in rows)} were refused or failed"
    )
    return 0


def count(folder: Path, book: bool) -> int:
    folder.mkdir(parents=True, exist_ok=True)
    counts = folder / "accuracy_instructions.csv"
    if not instructions.write(counts):
        print("callgrind counts the instructions: install valgrind")
        return 1
    if book:
        shutil.copyfile(counts, table.BOOK / counts.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
