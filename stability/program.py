"""The arguments of the programs of the laboratory, and their tables."""

from __future__ import annotations

import argparse
import csv
from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Any


def parser(text: str, cases: Collection[str] = (), folder: str = "") -> argparse.ArgumentParser:
    """Arguments that several programs have: the ``folder`` for its files, if it writes some, ``cases`` of which only
    some may be run, and ``--book``."""

    def case(name: str) -> str:
        if name not in cases:
            known = ", ".join(cases)
            raise argparse.ArgumentTypeError(f"no case is named {name}; there are {known}")
        return name

    raw = argparse.RawDescriptionHelpFormatter
    out = argparse.ArgumentParser(description=text, formatter_class=raw)
    if folder:
        out.add_argument("folder", metavar="FOLDER", type=Path, help=folder)
    if cases:
        only = f"run only these of {', '.join(cases)}"
        out.add_argument("cases", metavar="CASE", nargs="*", type=case, help=only)
    out.add_argument("--book", action="store_true", help="write the tables of the book, too")
    return out


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Write rows with the same names as a CSV file, in a folder that need not exist."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, list(rows[0]) if rows else ["nothing"], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
