"""
The fuzz campaign: ``run_fuzz.py SECONDS FOLDER [PROGRAM SAVINGS]``, used by ``make fuzz``. The time is shared by random
calls of the whole C library (PROGRAM, with sanitizers), random scenes with and without optimisations (likewise), and
random scenes and results files; changed mesh files come with every round. Seeds go on where the last campaign ended,
counts add up in ``FOLDER/counts.json``; each part prints its seeds, and a failure the seed that shows it.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BATCH = 60.0
# HDF5 itself loses memory on a damaged file.
SUPPRESSED = "leak:libhdf5\n"
# Counts that fuzz_api.c and fuzz_optimisations.c print after these words, and what they are called here.
CALLS = {
    "to": "next seed",
    "inputs": "inputs",
    "calls": "calls",
    "scenes": "C scenes",
    "built": "C scenes built",
    "steps": "C steps",
}
PAIRS = {
    "to": "next seed",
    "scenes": "scenes",
    "built": "pairs of runs",
    "failures": "errors on the way",
    "steps": "steps",
}


def run(
    program: str, seconds: float, seed: int, folder: Path, more: list[str], counted: dict[str, str]
) -> dict:
    """Run a program with sanitizers for so long, and return the counts that it prints."""
    suppressions = folder / "suppressions"
    suppressions.write_text(SUPPRESSED)
    environment = {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "ASAN_OPTIONS": "detect_leaks=1:abort_on_error=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1:abort_on_error=1",
        "LSAN_OPTIONS": f"suppressions={suppressions}:print_suppressions=0",
    }
    done = subprocess.run(
        [program, str(seconds), str(seed), *more],
        capture_output=True,
        text=True,
        errors="replace",
        env=environment,
    )
    if done.returncode:
        raise SystemExit(f"{program} ended with {done.returncode}\n{done.stderr[-6000:]}")
    print(done.stdout.strip(), flush=True)
    return {
        name: int(re.search(rf"{word} (\d+)", done.stdout).group(1))
        for word, name in counted.items()
    }


def api(program: str, seconds: float, seed: int, folder: Path) -> dict:
    """Random calls for so long; with files in every other batch."""
    return run(program, seconds, seed, folder, [str(folder) if seed % 2 else ""], CALLS)


def savings(program: str, seconds: float, seed: int, folder: Path) -> dict:
    return run(program, seconds, seed, folder, [], PAIRS)


def script(name: str, seed: int, *arguments: str) -> dict:
    """Run a program in Python; its last line has the counts."""
    done = subprocess.run(
        [sys.executable, str(HERE / name), *arguments],
        capture_output=True,
        text=True,
        errors="replace",
    )
    if done.returncode:
        raise SystemExit(f"{name} ended with {done.returncode}\n{done.stderr[-6000:]}")
    print(f"seeds from {seed}: {done.stdout.strip()}", flush=True)
    return json.loads(done.stdout.splitlines()[-1])


def scenes(seconds: float, seed: int, folder: Path) -> dict:
    return script("fuzz_scenes.py", seed, str(seconds), str(seed), str(folder))


def meshes(seed: int, folder: Path) -> dict:
    """Changed mesh files, 300 of each format, whatever time they take (about ten seconds)."""
    return script("fuzz_meshes.py", seed, "300", str(seed), str(folder))


def main() -> None:
    seconds, folder = float(sys.argv[1]), Path(sys.argv[2])
    programs = sys.argv[3:]
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "counts.json"
    counts = json.loads(file.read_text()) if file.exists() else {}
    left = seconds
    while left > 0:
        part = min(left, BATCH)
        calls = {
            "scenes": lambda s, n: scenes(s, n, folder),
            "meshes": lambda s, n: meshes(n, folder),
        }
        if programs:
            calls["api"] = lambda s, n: api(programs[0], s, n, folder)
            calls["savings"] = lambda s, n: savings(programs[1], s, n, folder)
        for name, call in calls.items():
            total = counts.setdefault(name, {"next seed": 1})
            told = call(part / len(calls), total["next seed"])
            total["next seed"] = told.pop("next seed") + 1
            for key, n in told.items():
                total[key] = total.get(key, 0) + n
            file.write_text(json.dumps(counts, indent=1))
        left -= part
    print("so far:", json.dumps(counts))


if __name__ == "__main__":
    main()
