"""
Numbers that the pages quote: ``make measured`` writes them to ``docs/measured.json``, and the role ``:measured:`` reads
them from there.

To add a number, add it to a module of ``docs/measures``, run ``make measured`` and write
:measured:`function.name:format` on the page. ``tests/docs/test_measured.py`` computes them anew and compares, all but
the SLOW ones.
"""

from __future__ import annotations

import json
import sys

from measures import benchmarks
from measures.shared import DOCS, MEASUREMENTS, Numbers

FILE = DOCS / "measured.json"
# Too long for the test: a hundred runs each, and balls of hex20. The benchmarks have a test of their own.
SLOW = {"integrator", "explicit", "recovered_balls", "pressed_sphere", *benchmarks.CASES}


def rounded(numbers: Numbers) -> Numbers:
    """Five digits are more than a page shows, and few enough to be the same on every machine; what is below 1e-9 is
    round-off."""
    return {name: float(f"{round(float(value), 9):.5g}") for name, value in numbers.items()}


def main(names: list[str]) -> None:
    """Compute all numbers anew, or those of some functions."""
    found = json.loads(FILE.read_text())
    for name in names or MEASUREMENTS:
        print(f"  {name}", flush=True)
        found[name] = rounded(MEASUREMENTS[name]())
    FILE.write_text(json.dumps({n: found[n] for n in MEASUREMENTS if n in found}, indent=1) + "\n")


if __name__ == "__main__":
    main(sys.argv[1:])
