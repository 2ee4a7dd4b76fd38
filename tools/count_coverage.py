"""``make coverage``: lines and branches of the C library that the C tests run, by room.

``count_coverage.py BUILD [--book]`` reads what gcov counted in BUILD, a build with ``--coverage`` whose tests have
run; prints the rooms and what is below 90 %; writes BUILD/coverage.csv, and with ``--book`` the table of the
chapter "Tests". A test that compiles sources of the library itself (``test_output_faults``) counts for lines,
but not for branches, because its calls have other branches.
"""

from __future__ import annotations

import csv
import json
import os
import shlex
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ROOT / "libcontact" / "src"
BOOK = ROOT / "docs" / "develop" / "coverage.csv"
FLOOR = 0.9


class Counts:
    """How often the lines of a file and their branches were run."""

    def __init__(self) -> None:
        self.lines: dict[int, int] = defaultdict(int)
        self.branches: dict[tuple[int, int], int] = defaultdict(int)

    def add(self, line: dict, with_branches: bool) -> None:
        number = line["line_number"]
        self.lines[number] += line["count"]
        for k, branch in enumerate(line["branches"] if with_branches else ()):
            self.branches[number, k] += branch["count"]


def fractions(files: list[Counts]) -> tuple[int, float, int, float]:
    """Lines and branches of some files, and the fraction of each that was run."""
    lines = [count for one in files for count in one.lines.values()]
    branches = [count for one in files for count in one.branches.values()]

    def run(counts: list[int]) -> float:
        return sum(count > 0 for count in counts) / len(counts) if counts else 1.0

    return len(lines), run(lines), len(branches), run(branches)


def collect(build: Path) -> dict[Path, Counts]:
    """The counts of each source of the library."""
    files: dict[Path, Counts] = defaultdict(Counts)
    gcov = shlex.split(os.environ.get("GCOV", "gcov"))
    for data in sorted(build.rglob("*.gcda")):
        told = subprocess.run(
            [
                *gcov,
                "--json-format",
                "--branch-probabilities",
                "--branch-counts",
                "--stdout",
                str(data),
            ],
            capture_output=True,
            text=True,
            check=True,
        )
        own = (build / "obj") in data.parents
        for text in told.stdout.splitlines():
            for file in json.loads(text)["files"]:
                path = (ROOT / file["file"]).resolve()
                if SOURCES in path.parents:
                    for line in file["lines"]:
                        files[path].add(line, own)
    return files


def percent(fraction: float) -> str:
    return f"{100 * fraction:.1f}"


def rows(files: dict[Path, Counts]) -> list[dict[str, str]]:
    """A row for each room, and one for all."""
    rooms: dict[str, list[Counts]] = defaultdict(list)
    for path, counts in files.items():
        rooms[path.relative_to(SOURCES).parts[0]].append(counts)
    out = []
    for name, own in [*sorted(rooms.items()), ("all", list(files.values()))]:
        lines, of_lines, branches, of_branches = fractions(own)
        out.append(
            {
                "room": name,
                "files": str(len(own)),
                "lines": str(lines),
                "of them run, %": percent(of_lines),
                "branches": str(branches),
                "of them taken, %": percent(of_branches),
            }
        )
    return out


def low(files: dict[Path, Counts]) -> list[str]:
    """Files of which less than 90 % of the lines or branches were run."""
    out = []
    for path, counts in sorted(files.items()):
        lines, of_lines, branches, of_branches = fractions([counts])
        if min(of_lines, of_branches) < FLOOR:
            name = path.relative_to(SOURCES)
            missed = [number for number, count in sorted(counts.lines.items()) if count == 0]
            some = ", ".join(map(str, missed[:12])) + (" ..." if len(missed) > 12 else "")
            out.append(
                f"{name!s:<34} lines {percent(of_lines):>5} % of {lines:4d}, branches {percent(of_branches):>5} % of"
                f" {branches:4d}" + (f"; not run: {some}" if some else "")
            )
    return out


def main() -> int:
    build = Path(sys.argv[1]).resolve()
    files = collect(build)
    if not files:
        print(f"{build}: no file of gcov; `make coverage` makes them")
        return 1
    table = rows(files)
    for path in (
        (build / "coverage.csv", BOOK) if "--book" in sys.argv else (build / "coverage.csv",)
    ):
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows(table)
    for row in table:
        print(
            f"{row['room']:<12} {row['files']:>3} files  lines {row['of them run, %']:>5} % of {row['lines']:>5}"
            f"  branches {row['of them taken, %']:>5} % of {row['branches']:>5}"
        )
    print(f"below {100 * FLOOR:.0f} %:")
    for text in low(files):
        print("  " + text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
