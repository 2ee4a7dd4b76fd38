"""The cost of each effect in a scene that has it, and a check that it costs nothing in a scene
without it. ``effect_loop.c`` is compiled once for each effect, so that the program contains the code
of this effect alone; a program without any effect is linked a second time with the code of all.
Callgrind counts instructions in the time loop, an allocator counts bytes, and ``size`` measures code.
The last rows are the plates with contact, linked with the objects that they need and with all, and with
ten probes.
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
EFFECTS = (
    *("support", "motion", "gravity", "load", "damping", "viscosity"),
    *("absorb", "obstacle", "friction", "contact", "pair_friction", "probe"),
)
STEPS = 20
FACES = 12 * 12  # of a block, in contact


def compiled(source: str, folder: Path, effect: str = "none", whole: bool = False) -> Path:
    """A program, linked with the objects that it refers to or with the whole library."""
    out = folder / f"{Path(source).stem}_{effect}_{'all' if whole else 'own'}"
    archive = [str(ROOT / "build" / "lib" / "libcontact.a")]
    if whole:
        archive = ["-Wl,--whole-archive", *archive, "-Wl,--no-whole-archive"]
    command = [os.environ.get("CC", "cc"), "-O2", "-std=c99", f"-DEFFECT={effect.upper()}"]
    command += [f"-I{ROOT / 'libcontact' / 'include'}", str(ROOT / "bench" / source)]
    command += ["-o", str(out), *archive, "-fopenmp", "-lm"]
    subprocess.run(command, check=True)
    return out


def counted(program: Path, arguments: list[str], folder: Path) -> dict:
    """Instructions inside ct_run, bytes of code, and the program's output."""
    out = folder / "callgrind.out"
    command = ["valgrind", "--tool=callgrind", "--toggle-collect=ct_run"]
    command += [f"--callgrind-out-file={out}", str(program), *arguments]
    done = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    (total,) = re.findall(r"^(?:summary|totals): (\d+)", out.read_text(), re.MULTILINE)[-1:]
    size = subprocess.run(["size", str(program)], capture_output=True, text=True, check=True)
    told = json.loads(done.stdout)
    return {
        "instructions": int(total),
        "code": int(size.stdout.splitlines()[1].split()[0]),
        "bytes": told["bytes"],
        "hash": told["hash"],
    }


def measure() -> dict:
    if not shutil.which("valgrind"):
        return {"skipped": "valgrind is not installed (Debian: apt install valgrind)"}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loop = [str(STEPS)]
        rows = {
            effect: counted(compiled("effect_loop.c", folder, effect), loop, folder)
            for effect in ("none", *EFFECTS)
        }
        off = counted(compiled("effect_loop.c", folder, whole=True), loop, folder)
        plates = [
            counted(compiled("scene_loop.c", folder, whole=whole), ["plates", "qc", "20"], folder)
            for whole in (False, True)
        ]
        probed = counted(compiled("scene_loop.c", folder), ["plates", "qch", "20"], folder)
    assert probed["hash"] == plates[0]["hash"]
    for alone, all_linked in ((rows["none"], off), plates):
        assert alone["hash"] == all_linked["hash"] and alone["bytes"] == all_linked["bytes"]
        assert abs(all_linked["instructions"] / alone["instructions"] - 1.0) <= 1e-3
    return {"effects": rows, "off": off, "plates": plates, "probed": probed}


def report(result: dict) -> str:
    if "skipped" in result:
        return "Cost of the effects in a scene: not measured, " + result["skipped"]
    none, off = result["effects"]["none"], result["off"]
    lines = [
        f"Cost that each effect adds to two blocks of 12 x 12 x 12 hex8, {STEPS} steps",
        f"  {'':22}{'instructions/step':>20}{'bytes held':>14}{'bytes of code':>15}",
        f"  {'solid alone':22}{none['instructions'] // STEPS:>20}{none['bytes']:>14}{none['code']:>15}",
    ]
    for effect in EFFECTS:
        row = result["effects"][effect]
        step = (row["instructions"] - none["instructions"]) // STEPS
        more = row["bytes"] - none["bytes"], row["code"] - none["code"]
        lines.append(f"  + {effect:20}{step:>+20}{more[0]:>+14}{more[1]:>+15}")
    step = (off["instructions"] - none["instructions"]) / STEPS
    lines.append(
        f"  {'all linked, none on':22}{step:>+20.1f}{off['bytes'] - none['bytes']:>+14}{off['code'] - none['code']:>+15}"
    )
    for text, more, less in (
        ("a face at a plane", "obstacle", "none"),
        ("  friction there", "friction", "obstacle"),
        ("a face pair", "contact", "none"),
        ("  friction there", "pair_friction", "contact"),
    ):
        count = result["effects"][more]["instructions"] - result["effects"][less]["instructions"]
        lines.append(f"  {text:22}{count // (STEPS * FACES):>+20} instructions a step")
    own, whole = result["plates"]
    lines.append(
        f"  plates with contact, own objects and all: {own['instructions']} and {whole['instructions']} instructions, "
        f"{own['bytes']} and {whole['bytes']} bytes, the same bits"
    )
    share = result["probed"]["instructions"] / own["instructions"] - 1.0
    lines.append(
        f"  the plates with ten probes (six nodes, two faces of 202 nodes, two resultants): {share:+.2%}"
    )
    lines.append(
        "  the rows of friction include obstacle and contact; probe: a node and a face of 169 nodes"
    )
    return "\n".join(lines)


if __name__ == "__main__":
    print(report(measure()))
