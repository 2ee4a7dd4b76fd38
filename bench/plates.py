"""Speed of the plate impact, cost of its contact, and comparison with other codes on the same
machine in the same run."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import libcontact as ct

HERE = Path(__file__).parent
SCENES = HERE.parent / "tutorials" / "scenes"
RUNS = 5
ELEMENTS, PAIRS = 10_000, 100  # of one plate, of the contact


def seconds(scene: ct.Scene) -> tuple[float, int]:
    """Wall seconds of one run without a results file, and its steps."""
    start = time.perf_counter()
    run = scene.run(progress=False, output=False)
    return time.perf_counter() - start, int(run.steps[-1])


def without_contact(scene: ct.Scene) -> ct.Scene:
    data = scene.data
    del data["contact"]
    return ct.Scene(data)


def roofline() -> dict[str, float]:
    """Limits of one core of this machine: GB/s of a copy that does not fit its cache, and Gflop/s of a
    matrix product."""
    array, other = np.zeros(4_000_000), np.ones(4_000_000)
    copies = []
    for _ in range(5):
        start = time.perf_counter()
        np.copyto(array, other)
        copies.append(time.perf_counter() - start)
    a = np.random.default_rng(0).random((1000, 1000))
    products = []
    for _ in range(3):
        start = time.perf_counter()
        a @ a
        products.append(time.perf_counter() - start)
    return {
        "copy_GB_per_s": 2 * 8 * array.size / min(copies) / 1e9,
        "matrix_product_Gflop_per_s": 2e9 / min(products) / 1e9,
    }


def peer(code: str, steps: int) -> dict | None:
    """The same plate in another code, in a process of its own; None if it is not installed."""
    # malloc keeps large blocks: otherwise Akantu returns its arrays to the system in each step and takes
    # twice as long.
    keep = {
        "MALLOC_MMAP_THRESHOLD_": str(2**30),
        "MALLOC_TRIM_THRESHOLD_": str(2**30),
        "MALLOC_TOP_PAD_": str(2**28),
    }
    done = subprocess.run(
        [sys.executable, str(HERE / "peers.py"), code, str(steps)],
        env={**os.environ, **keep, "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
    )
    return json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else None


def measure() -> dict:
    """All figures. Our runs and those of the other codes alternate, so that a slower machine affects all."""
    contact_scene = ct.Scene.load(SCENES / "plates.toml")
    data = contact_scene.data
    data["output"] = {"every": 10**9}
    contact_scene = ct.Scene(data)
    data = ct.Scene.load(SCENES / "plates_reference.toml").data
    data["output"] = {"every": 10**9}
    plate_scene = ct.Scene(data)
    free_scene = without_contact(contact_scene)
    with_contact, free, plate, scipy, akantu = [], [], [], [], []
    for _ in range(RUNS):
        run, steps = seconds(contact_scene)
        with_contact.append(run)
        free.append(seconds(free_scene)[0])
        plate.append(seconds(plate_scene)[0])
        scipy.append(peer("scipy", 100))
        akantu.append(peer("akantu", 20))
    median = statistics.median
    result = {
        "steps": steps,
        "updates_per_s": 2 * ELEMENTS * steps / median(with_contact),
        "us_per_update": 1e6 * median(with_contact) / (2 * ELEMENTS * steps),
        "us_per_update_one_plate": 1e6 * median(plate) / (ELEMENTS * steps),
        "contact_us_per_pair_and_step": 1e6
        * median(a - b for a, b in zip(with_contact, free))
        / (steps * PAIRS),
        "roofline": roofline(),
        "plan": contact_scene.explain().data,
        "peers": {},
    }
    for code, rows in (("scipy", scipy), ("akantu", akantu)):
        if all(rows):
            ratios = [
                row["us_per_update"] / (1e6 * own / (ELEMENTS * steps))
                for row, own in zip(rows, plate)
            ]
            result["peers"][code] = {
                "us_per_update": median(row["us_per_update"] for row in rows),
                "times_ours": median(ratios),
                "times_ours_range": [min(ratios), max(ratios)],
            }
    return result


def report(result: dict) -> str:
    lines = [
        f"two plates, {2 * ELEMENTS} hex8, {result['steps']} steps, one core, everything included:",
        f"  {result['updates_per_s'] / 1e6:.1f} million element updates per second ({result['us_per_update']:.4f} µs per update)",
        f"  contact: {result['contact_us_per_pair_and_step']:.2f} µs per face pair and step ({PAIRS} pairs)",
        f"one plate, no contact: {result['us_per_update_one_plate']:.4f} µs per update",
    ]
    for code, row in result["peers"].items():
        low, high = row["times_ours_range"]
        lines.append(
            f"  {code}: {row['us_per_update']:.3f} µs per update, {row['times_ours']:.1f} times ours ({low:.1f} to {high:.1f} in {RUNS} pairs)"
        )
    for code in ("scipy", "akantu"):
        if code not in result["peers"]:
            lines.append(f"  {code}: not installed here")
    roof = result["roofline"]
    lines.append(
        f"roofline: one core copies {roof['copy_GB_per_s']:.1f} GB/s, a matrix product runs at {roof['matrix_product_Gflop_per_s']:.0f} Gflop/s"
    )
    return "\n".join(lines)
