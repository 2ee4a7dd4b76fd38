"""Instructions of the piece that has most of them, sums and numbers in these, per step of two blocks that hit each
other (chapter "Pieces"): ``python bench/pieces.py``, with valgrind. Pieces are threads, so the work of the
messages counts, too."""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).parent.parent
CELLS, FIRST, STEPS = 12, 4, 20


def counted(program: Path, folder: Path, *case: float, steps: int) -> tuple[int, list[int]]:
    """Instructions in ``ct_run`` of the piece with most of them, and what the first piece printed."""
    for path in folder.glob("out*"):
        path.unlink()
    command = ["valgrind", "--tool=callgrind", "--separate-threads=yes", "--toggle-collect=ct_run"]
    command += [f"--callgrind-out-file={folder / 'out'}", str(program)]
    command += [str(each) for each in (CELLS, *case, steps)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    totals = [re.findall(r"^totals: (\d+)", path.read_text(), re.M) for path in folder.glob("out*")]
    return max(int(found[-1]) for found in totals if found), [int(n) for n in done.stdout.split()]


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        program = folder / "pieces"
        command = ["cc", "-O1", "-std=c99", "-D_GNU_SOURCE", f"-I{ROOT / 'libcontact' / 'include'}"]
        command += [str(ROOT / "bench" / "pieces.c"), "-o", str(program)]
        command += [str(ROOT / "build" / "lib" / "libcontact.a"), "-fopenmp", "-lpthread", "-lm"]
        subprocess.run(command, check=True)
        print(f"two blocks of {CELLS}^3  pieces  instructions a step   sums   numbers")
        for contact, friction in ((0, 0.0), (1, 0.0), (1, 0.3)):
            text = f"contact, friction {friction}" if contact else "no contact"
            for pieces in (1, 2, 4, 8):
                case = (pieces, contact, friction)
                few, before = counted(program, folder, *case, steps=FIRST)
                many, after = counted(program, folder, *case, steps=FIRST + STEPS)
                sums, numbers = ((b - a) / STEPS for a, b in zip(before, after))
                each = (many - few) // STEPS
                print(f"{text:22} {pieces:6} {each:20} {sums:6.1f} {numbers:9.0f}", flush=True)


if __name__ == "__main__":
    main()
