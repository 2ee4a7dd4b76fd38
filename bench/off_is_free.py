"""
What a scene does not declare costs nothing: a block that flies and rings, with no contact and no support, is run by a program that is linked with what it
needs only, and by one that holds the code of every effect of the library. Instructions in the time loop (callgrind), bytes and bits are compared; and a
scene with contact, once with the objects it needs and once with all.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
PROGRAMS = {
    "a block alone": ("solid_loop.c", ["30"]),
    "plates with contact and supports": ("scene_loop.c", ["plates", "qcd", "20"]),
}
MARK = "ct_contact_create_effect"


def compiled(source: str, whole: bool, folder: Path) -> Path:
    """One of the programs, linked with the objects that it names or with all of the library."""
    out = folder / f"{Path(source).stem}_{'all' if whole else 'own'}"
    archive = [str(ROOT / "build" / "lib" / "libcontact.a")]
    if whole:
        archive = ["-Wl,--whole-archive", *archive, "-Wl,--no-whole-archive"]
    subprocess.run(
        [
            os.environ.get("CC", "cc"),
            "-O2",
            "-std=c99",
            f"-I{ROOT / 'libcontact' / 'include'}",
            str(ROOT / "bench" / source),
            "-o",
            str(out),
            *archive,
            "-fopenmp",
            "-lm",
            "-Wl,--wrap=calloc",
            "-Wl,--wrap=free",
        ],
        check=True,
    )
    return out


def counted(program: Path, arguments: list[str], folder: Path) -> dict:
    """Instructions inside ct_step_many, and what the program prints."""
    out = folder / "callgrind.out"
    done = subprocess.run(
        [
            "valgrind",
            "--tool=callgrind",
            "--toggle-collect=ct_step_many",
            f"--callgrind-out-file={out}",
            str(program),
            *arguments,
        ],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    (total,) = re.findall(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)[-1:]
    symbols = subprocess.run(
        ["nm", str(program)], capture_output=True, text=True, check=True
    ).stdout
    told = json.loads(done.stdout)
    return {
        "instructions": int(total),
        "bytes": told["bytes"],
        "hash": told["hash"],
        "has_contact": MARK in symbols,
    }


def measure() -> dict:
    if not shutil.which("valgrind"):
        return {"skipped": "valgrind is not installed (Debian: apt install valgrind)"}
    result = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, (source, arguments) in PROGRAMS.items():
            own, whole = (
                counted(compiled(source, every, Path(folder)), arguments, Path(folder))
                for every in (False, True)
            )
            result[name] = {
                "own": own,
                "whole": whole,
                "same_bits": own["hash"] == whole["hash"],
                "same_bytes": own["bytes"] == whole["bytes"],
                "more_instructions": whole["instructions"] / own["instructions"] - 1.0,
            }
    assert all(
        case["same_bits"] and case["same_bytes"] and abs(case["more_instructions"]) <= 1e-3
        for case in result.values()
    ), result
    assert (
        not result["a block alone"]["own"]["has_contact"]
        and result["a block alone"]["whole"]["has_contact"]
    ), result
    return result


def report(result: dict) -> str:
    if "skipped" in result:
        return "Off is free: not measured, " + result["skipped"]
    lines = [
        "Off is free: the time loop with the objects it needs, and with the code of all effects in the program"
    ]
    for name, case in result.items():
        own, whole = case["own"], case["whole"]
        lines.append(
            f"  {name}: {own['instructions']} and {whole['instructions']} instructions ({case['more_instructions']:+.2e}), "
            f"{own['bytes']} and {whole['bytes']} bytes, results {'the same bits' if case['same_bits'] else 'DIFFERENT'}; "
            f"contact code in the first program: {'yes' if own['has_contact'] else 'no'}"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(report(measure()))
