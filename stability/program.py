"""The arguments of the programs of the laboratory."""

from __future__ import annotations

import argparse
from collections.abc import Collection
from pathlib import Path


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
