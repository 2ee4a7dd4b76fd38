"""
What each saving saves, beside the same run with it off: time and memory, with the same bits, those of plane strain, too. Five scenes of bench/scene_loop.c; minima of
interleaved runs.
"""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
RUNS = 5
SCENES = {"plates": "plate impact, 100 x 100, near the stable step", "plates200": "plate impact, 200 x 200", "bar": "bar hit by a bar, 200 x 8 x 8",
          "block": "block that flies, 40 x 40 x 40", "flight": "bar that flies half its length to a plate"}
STEPS = {"block": 50}
SAVINGS = {"-": "none", "q": "quiet", "c": "congruent", "d": "distant", "qcd": "all three", "p": "plane strain", "cdp": "all but quiet", "qcdp": "all four"}
PLANE = ("plates", "plates200")


def program(folder: Path) -> Path:
    out = folder / "scene_loop"
    subprocess.run([os.environ.get("CC", "cc"), "-O2", "-std=c99", f"-I{ROOT / 'libcontact' / 'include'}", str(ROOT / "bench" / "scene_loop.c"), "-o", str(out),
                    str(ROOT / "build" / "lib" / "libcontact.a"), "-fopenmp", "-lm", "-Wl,--wrap=calloc", "-Wl,--wrap=free"], check=True)
    return out


def run(loop: Path, scene: str, savings: str) -> dict:
    done = subprocess.run([str(loop), scene, savings, str(STEPS.get(scene, 0))], capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


def measure() -> dict:
    result: dict[str, dict[str, dict]] = {scene: {} for scene in SCENES}
    with tempfile.TemporaryDirectory() as folder:
        loop = program(Path(folder))
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
        assert len({row["hash"] for row in rows.values()}) == 1, f"{scene}: a saving has changed a bit"
    return result


def report(result: dict) -> str:
    lines = ["What the savings save (all results have the same bits); contact and the rest of the time loop as parts of the run without savings"]
    for scene, rows in result.items():
        plain = rows["-"]
        lines.append(f"{SCENES[scene]}: {plain['elements']} elements, {plain['steps']} steps at Courant number {plain['courant']:.3f}, "
                     f"{1e3 * plain['seconds']:.4g} ms, {plain['bytes'] / plain['elements']:.0f} bytes an element, contact {plain['contact'] / plain['seconds']:.0%}")
        for savings, row in rows.items():
            if savings == "-":
                continue
            own = (plain["solid"] + plain["rest"]) / (row["solid"] + row["rest"])
            lines.append(f"  {SAVINGS[savings]:>10}: run {plain['seconds'] / row['seconds']:.2f} times faster, elements and nodes {own:.2f} times, "
                         f"memory {plain['bytes'] / row['bytes']:.2f} times less ({row['bytes'] / row['elements']:.0f} bytes an element, "
                         f"{row['peak'] / row['bytes']:.2f} times that at most while it is built)")
    return "\n".join(lines)


def draw(result: dict, path: Path) -> None:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(9, 3.4), constrained_layout=True)
    names = [savings for savings in SAVINGS if savings != "-" and "p" not in savings]
    for axis, key, label in zip(axes, ("seconds", "bytes"), ("times faster", "times less memory")):
        for k, savings in enumerate(names):
            ratios = [rows["-"][key] / rows[savings][key] for rows in result.values()]
            axis.bar([i + 0.2 * (k - 1.5) for i in range(len(ratios))], ratios, 0.18, label=SAVINGS[savings])
        axis.axhline(1.0, color="black", linewidth=0.8)
        axis.set_xticks(range(len(result)), list(result))
        axis.set_ylabel(label)
    axes[0].legend(frameon=False)
    figure.savefig(path, dpi=150)
    plt.close(figure)


if __name__ == "__main__":
    print(report(measure()))
