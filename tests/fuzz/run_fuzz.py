"""
The fuzz campaign: ``run_fuzz.py SECONDS FOLDER [PROGRAM]``, used by ``make fuzz``. The time is shared by random calls of the whole C library (PROGRAM, with sanitizers) and
random scenes and results files. Seeds go on where the last campaign ended, counts add up in ``FOLDER/counts.json``; each part prints its seeds, and a failure the seed that shows it.
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


def api(program: str, seconds: float, seed: int, folder: Path) -> dict:
    """Random calls for so long; with files in every other batch."""
    suppressions = folder / "suppressions"
    suppressions.write_text(SUPPRESSED)
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "ASAN_OPTIONS": "detect_leaks=1:abort_on_error=1", "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1:abort_on_error=1",
                   "LSAN_OPTIONS": f"suppressions={suppressions}:print_suppressions=0"}
    done = subprocess.run([program, str(seconds), str(seed), str(folder) if seed % 2 else ""], capture_output=True, text=True, errors="replace", env=environment)
    if done.returncode:
        raise SystemExit(f"{program} ended with {done.returncode}\n{done.stderr[-6000:]}")
    print(done.stdout.strip(), flush=True)
    found = re.search(r"to (\d+): inputs (\d+) calls (\d+) scenes (\d+) built (\d+) steps (\d+)", done.stdout)
    return dict(zip(("next seed", "inputs", "calls", "C scenes", "C scenes built", "C steps"), map(int, found.groups())))


def scenes(seconds: float, seed: int, folder: Path) -> dict:
    done = subprocess.run([sys.executable, str(HERE / "fuzz_scenes.py"), str(seconds), str(seed), str(folder)], capture_output=True, text=True, errors="replace")
    if done.returncode:
        raise SystemExit(f"fuzz_scenes.py ended with {done.returncode}\n{done.stderr[-6000:]}")
    print(f"seeds from {seed}: {done.stdout.strip()}", flush=True)
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    seconds, folder = float(sys.argv[1]), Path(sys.argv[2])
    program = sys.argv[3] if len(sys.argv) > 3 else None
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "counts.json"
    counts = json.loads(file.read_text()) if file.exists() else {}
    left = seconds
    while left > 0:
        part = min(left, BATCH)
        for name, call in (("api", (lambda s, n: api(program, s, n, folder)) if program else None), ("scenes", lambda s, n: scenes(s, n, folder))):
            if call is None:
                continue
            total = counts.setdefault(name, {"next seed": 1})
            told = call(part / 2, total["next seed"])
            total["next seed"] = told.pop("next seed") + 1
            for key, n in told.items():
                total[key] = total.get(key, 0) + n
            file.write_text(json.dumps(counts, indent=1))
        left -= part
    print("so far:", json.dumps(counts))


if __name__ == "__main__":
    main()
