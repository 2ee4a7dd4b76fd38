"""
Instructions of an element update for each method, to compare runs whose updates differ in cost:
``run.py FOLDER --instructions`` counts the time loop of the short runs with callgrind. Any machine with
the same compiled code has the same counts.
"""

from __future__ import annotations

import csv
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import campaign
import price

MESHES = (12, 25)
COLUMNS = ("method", "cells", "steps", "evaluations", "updates", "instructions", "over_plain")
# The time loop, without records and energy balance; each run begins with a state.
LOOP, BEGIN = "ct_series_steps", "ct_scene_start"
HERE = "import sys; sys.path.insert(0, {!r}); import instructions; instructions.run_all()"


def cases() -> list[tuple[str, campaign.Case]]:
    return [
        (name, campaign.case("reference", cells, keys))
        for cells in MESHES
        for name, keys in campaign.METHODS.items()
    ]


def run_all() -> None:
    """The program that callgrind counts."""
    for _, own in cases():
        price.run(price.scene_of(own, price.T))


def counted() -> list[int]:
    """Instructions of the time loop of each case, in turn."""
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", "--collect-atstart=no"]
        command += [f"--toggle-collect={LOOP}", f"--dump-before={BEGIN}"]
        command += [f"--callgrind-out-file={folder}/out", sys.executable, "-c"]
        command += [HERE.format(str(Path(__file__).parent))]
        subprocess.run(command, check=True, capture_output=True)
        # The dump before the first state is empty, the file without a number is the last run.
        parts = sorted(Path(folder).glob("out.*"), key=lambda path: int(path.suffix[1:]))
        files = [*parts[1:], Path(folder) / "out"]
        return [int(re.search(r"^summary: (\d+)", path.read_text(), re.M)[1]) for path in files]


def write(path: Path) -> bool:
    """The table; false without valgrind."""
    if shutil.which("valgrind") is None:
        return False
    rows: list[dict[str, Any]] = []
    for (name, own), instructions in zip(cases(), counted(), strict=True):
        result = price.run(price.scene_of(own, price.T))
        updates, evaluations = price.work(result, own)
        rows.append(
            {"method": name, "cells": own.cells, "steps": int(result.steps[-1])}
            | {"evaluations": evaluations, "updates": updates, "instructions": instructions}
        )
    plain = {row["cells"]: row for row in rows if row["method"] == "default at 0.98"}
    for row in rows:
        each, other = (own["instructions"] / own["updates"] for own in (row, plain[row["cells"]]))
        row["over_plain"] = f"{each / other:.3f}"
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
    return True
