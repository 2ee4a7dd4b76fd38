"""
Time and memory that each optimisation saves, compared with the same run without it; all results have the
same values. The scenes are the six of bench/scene_loop.c; times are minima of alternating runs. With
--instructions the program instead counts the instructions of the time loop with valgrind, which other
processes do not disturb, and writes the table of the book.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

from off_is_free import compiled, counted

ROOT = Path(__file__).parent.parent
RUNS = 5
SCENES = {
    "plates": "plate impact, 100 x 100, near the stable step",
    "platesz": "the same, numbered along the direction of the wave",
    "plates200": "plate impact, 200 x 200",
    "bar": "bar hit by a bar, 200 x 8 x 8",
    "block": "block that flies, 40 x 40 x 40",
    "flight": "bar that flies half its length to a plate",
}
STEPS = {"block": 50}
SAVINGS = {
    "-": "none",
    "q": "sleep",
    "c": "shared stiffness",
    "qc": "both",
    "p": "plane strain",
    "cp": "all three but sleep",
    "qcp": "all three",
}
PLANE = ("plates", "platesz", "plates200")


def run(loop: Path, scene: str, savings: str) -> dict:
    done = subprocess.run(
        [str(loop), scene, savings, str(STEPS.get(scene, 0))],
        capture_output=True,
        text=True,
        check=True,
    )
    return json.loads(done.stdout)


def measure() -> dict:
    result: dict[str, dict[str, dict]] = {scene: {} for scene in SCENES}
    with tempfile.TemporaryDirectory() as folder:
        loop = compiled("scene_loop.c", Path(folder))
        for _ in range(RUNS):
            for scene in SCENES:
                for savings in SAVINGS:
                    if "p" in savings and scene not in PLANE:
                        continue
                    told, best = run(loop, scene, savings), result[scene].get(savings)
                    for key in ("seconds", "solid", "contact", "rest"):
                        told[key] = min(told[key], best[key]) if best else told[key]
                    assert best is None or best["hash"] == told["hash"], (scene, savings)
                    result[scene][savings] = told
    for scene, rows in result.items():
        assert len({row["hash"] for row in rows.values()}) == 1, (
            f"{scene}: an optimisation has changed a value"
        )
    return result


def report(result: dict) -> str:
    lines = [
        "Gain by the optimisations (all results have the same values); contact and the rest of the time loop as fractions of the run without them"
    ]
    for scene, rows in result.items():
        plain = rows["-"]
        lines.append(
            f"{SCENES[scene]}: {plain['elements']} elements, {plain['steps']} steps at Courant number {plain['courant']:.3f}, "
            f"{1e3 * plain['seconds']:.4g} ms, {plain['bytes'] / plain['elements']:.0f} bytes per element, contact {plain['contact'] / plain['seconds']:.0%}"
        )
        for savings, row in rows.items():
            if savings == "-":
                continue
            # Gain by sleeping alone, also in addition to the others.
            without = rows.get(savings.replace("q", "")) if "q" in savings else None
            beside = (
                f"; {without['seconds'] / row['seconds']:.2f} times faster than without sleeping"
                if without and savings != "q"
                else ""
            )
            own = (plain["solid"] + plain["rest"]) / (row["solid"] + row["rest"])
            lines.append(
                f"  {SAVINGS[savings]:>10}: run {plain['seconds'] / row['seconds']:.2f} times faster, elements and nodes {own:.2f} times, "
                f"memory {plain['bytes'] / row['bytes']:.2f} times less ({row['bytes'] / row['elements']:.0f} bytes per element, "
                f"{row['peak'] / row['bytes']:.2f} times as much while it is built){beside}"
            )
    return "\n".join(lines)


# The table of the book: the pairs that are compared.
TABLE = ROOT / "docs" / "theory" / "savings.csv"
RATIOS = {
    "sleep": ("-", "q"),
    "sleep beside shared stiffness": ("c", "qc"),
    "sleep and shared stiffness": ("-", "qc"),
    "plane strain": ("-", "p"),
    "sleep beside both others": ("cp", "qcp"),
    "all three": ("-", "qcp"),
}


def write_table(path: Path) -> None:
    rows = [["scene", *RATIOS, "bytes of the run, shared stiffness"]]
    with tempfile.TemporaryDirectory() as folder:
        loop = compiled("scene_loop.c", Path(folder))
        for scene, title in SCENES.items():
            names = {
                name
                for pair in RATIOS.values()
                for name in pair
                if "p" not in name or scene in PLANE
            }
            steps = str(STEPS.get(scene, 0))
            told = {name: counted(loop, [scene, name, steps], Path(folder)) for name in names}
            bytes_held = [told[name]["bytes"] for name in ("-", "c")]
            cells = [
                f"{told[a]['instructions'] / told[b]['instructions']:.2f}" if b in told else ""
                for a, b in RATIOS.values()
            ]
            rows.append([title, *cells, f"{bytes_held[0] / bytes_held[1]:.2f}"])
    with path.open("w", newline="") as file:
        csv.writer(file).writerows(rows)


if __name__ == "__main__":
    if sys.argv[1:] == ["--instructions"]:
        write_table(TABLE)
    else:
        print(report(measure()))
