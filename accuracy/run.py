"""
``make accuracy``: what accuracy costs. ``run.py FOLDER [--reduced | --short] [--book]`` runs every case of ``campaign.py`` that FOLDER/accuracy.csv does not have yet, so
it can be stopped at any time and goes on where it was; ``--book`` copies the tables for the chapter "What accuracy costs" and draws its pictures into FOLDER.
"""

from __future__ import annotations

import csv
import io
import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parent))

import campaign  # noqa: E402
import measure  # noqa: E402
from tqdm import tqdm  # noqa: E402

ROOT = Path(__file__).resolve().parents[1]
BOOK = ROOT / "docs" / "theory"
COLUMNS = (*measure.COLUMNS, "machine", "compiler", "flags", "commit")


def where() -> dict[str, str]:
    """Machine, compiler, flags and commit."""

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
        "commit": says("git", "describe", "--always", "--dirty"),
    }


def read(path: Path) -> list[dict[str, Any]]:
    """The whole rows of a table; numbers as numbers. A line that a kill cut short is left out."""
    if not path.exists():
        return []
    text = path.read_text(encoding="utf-8")
    lines = text[: text.rfind("\n") + 1]
    return [
        {name: number(value) for name, value in row.items()}
        for row in csv.DictReader(io.StringIO(lines))
        if None not in row.values()
    ]


def number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text


def line(values: Any) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(
        f"{value:.6g}" if isinstance(value, float) else value for value in values
    )
    return text.getvalue()


def collect(level: str, path: Path) -> list[dict[str, Any]]:
    """Run the cases that the table lacks and add each as it is done."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = read(path)
    head = "".join([line(COLUMNS), *(line(row[name] for name in COLUMNS) for row in rows)])
    path.with_suffix(".new").write_text(head, encoding="utf-8")
    path.with_suffix(".new").replace(path)
    done, place = {(row["scene"], int(row["cells"]), row["setting"]) for row in rows}, where()
    todo = [case for case in campaign.cases(level) if case.name not in done]
    with path.open("a", encoding="utf-8") as file:
        for case in tqdm(todo, unit="row", disable=None):
            found = measure.row(case) | place
            file.write(line(found[name] for name in COLUMNS))
            file.flush()
    return read(path)


def main() -> int:
    options = {argument for argument in sys.argv[1:] if argument.startswith("--")}
    level = next((name for name in campaign.LEVELS if f"--{name}" in options), "whole")
    folder = Path(next(argument for argument in sys.argv[1:] if not argument.startswith("--")))
    try:
        rows = collect(level, folder / "accuracy.csv")
    except KeyboardInterrupt:
        print("interrupted: the rows so far are kept; the same command goes on")
        return 1
    import closest

    closest.write(folder / "accuracy_search.csv")
    if "--book" in options:
        for name in ("accuracy.csv", "accuracy_search.csv"):
            shutil.copyfile(folder / name, BOOK / name)
    import pictures

    pictures.draw(folder)
    print(
        f"{len(rows)} rows, {sum(row['status'] != 'done' for row in rows)} of them without an end"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
