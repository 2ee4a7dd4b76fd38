"""The campaign's table: one CSV with a row per case, written row by row."""

from __future__ import annotations

import csv
import io
import os
import platform
import subprocess
from pathlib import Path
from typing import Any

import campaign
import price
from libcontact.planning import planner
from tqdm import tqdm

ROOT = Path(__file__).resolve().parents[1]
BOOK = ROOT / "docs" / "theory"
PRICES = ROOT / "wrapper" / "libcontact" / "planning" / "prices.csv"
LIBRARY = ("libcontact", "wrapper")
TEXT = {"scene", "setting", "status", "machine", "compiler", "flags", "commit"}
COLUMNS = (*price.COLUMNS, "machine", "compiler", "flags", "commit")


def where() -> dict[str, str]:
    """Machine, compiler, flags, and the last commit that changed the library ("+": with later changes)."""

    def says(*command: str) -> str:
        done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
        return done.stdout.splitlines()[0] if done.returncode == 0 and done.stdout else ""

    try:
        names = Path("/proc/cpuinfo").read_text().splitlines()
        machine = next(line.split(":", 1)[1].strip() for line in names if "model name" in line)
    except (OSError, StopIteration):
        machine = platform.processor()
    flags = ROOT / "build" / "flags"
    return {
        "machine": machine,
        "compiler": says(os.environ.get("CC", "cc"), "--version"),
        "flags": flags.read_text().strip() if flags.exists() else "",
        "commit": says("git", "log", "-1", "--format=%h", "--", *LIBRARY)
        + ("+" if says("git", "status", "--porcelain", "--", *LIBRARY) else ""),
    }


def read(path: Path) -> list[dict[str, Any]]:
    """The complete rows of a table, with numbers as numbers. An incomplete line, as a kill may leave it, is
    skipped."""
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    lines = text[: text.rfind("\n") + 1]
    return [
        {name: value if name in TEXT else number(value) for name, value in row.items()}
        for row in csv.DictReader(io.StringIO(lines))
    ]


def number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


def line(values: Any) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(
        f"{value:.10g}" if isinstance(value, float) else value for value in values
    )
    return text.getvalue()


def for_planner(row: dict[str, Any]) -> bool:
    """Whether the planner may choose the setting of a row; of contacts it takes the laws alone."""
    keys = {each.partition("=")[0] for each in row["setting"].split("; ")}
    used = "time.fraction" in keys and keys <= planner.WORDS.keys()
    return used and (row["scene"] == "reference" or "contact.beta" in keys)


def write_prices(rows: list[dict[str, Any]], path: Path) -> None:
    """Write the planner's list: error on Fig. 4's line over the plateau, and cost over that of the paper's setting."""
    head = ["scene", "cells", "setting", "cost", "error", "growth"]
    done = [row for row in rows if row["status"] == "done" and for_planner(row)]
    plateau = price.plate(campaign.case("reference", 1, {})).plateau
    numbers = [(row["times_paper"], row["l1_fig4"] / plateau, row["growth"]) for row in done]
    values = [[*(row[name] for name in head[:3]), *own] for row, own in zip(done, numbers)]
    path.write_text("".join(line(each) for each in (head, *values)), encoding="utf-8")


def of_campaign(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows of cases that some level has, not those of a method that has left."""
    known = {case.name for level in campaign.LEVELS for case in campaign.cases(level)}
    return [row for row in rows if (row["scene"], int(row["cells"]), row["setting"]) in known]


def collect(level: str, path: Path) -> list[dict[str, Any]]:
    """Run the cases that the table lacks, and add each row when it is complete. Rows of cases that no level
    has any more are dropped."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = of_campaign(read(path))
    head = "".join([line(COLUMNS), *(line(row[name] for name in COLUMNS) for row in rows)])
    path.with_suffix(".new").write_text(head, encoding="utf-8")
    path.with_suffix(".new").replace(path)
    done, place = {(row["scene"], int(row["cells"]), row["setting"]) for row in rows}, where()
    todo = [case for case in campaign.cases(level) if case.name not in done]
    with path.open("a", encoding="utf-8") as file:
        for own in tqdm(todo, unit="row", disable=None):
            found = price.row(own) | place
            file.write(line(found[name] for name in COLUMNS))
            file.flush()
    return read(path)
