"""One table: the runs of ``tests/cross/cross.c`` by each compiler and machine, bits, speed and size.

``check_cross.py build "cc" linux-x86_64=x86_64-linux-gnu.2.17 ...``, after make has built the library for each target
in ``build/cross``. The first line, of the machine's own compiler, is what the others are compared with; other bits end
the command with 1. A target whose emulator is not here is named and left out.
"""

from __future__ import annotations

import shlex
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "tests/cross/cross.c"
REPEATS = 5
# What runs the programs of a machine that is not this one.
WASM = """
import sys, wasmtime as w
engine = w.Engine()
linker, store, wasi = w.Linker(engine), w.Store(engine), w.WasiConfig()
wasi.inherit_stdout()
linker.define_wasi()
store.set_wasi(wasi)
instance = linker.instantiate(store, w.Module.from_file(engine, sys.argv[1]))
try:
    instance.exports(store)["_start"](store)
except w.ExitTrap as end:
    sys.exit(end.code)
"""
RUNNERS = {"aarch64": ["qemu-aarch64"], "windows": ["wine"], "wasm32": [sys.executable, "-c", WASM]}


def build(compiler: list[str], flags: list[str], library: Path, program: Path) -> Path:
    command = [*compiler, "-std=c99", "-O2", "-s", "-Ilibcontact/include", *flags]
    command += [str(SOURCE), str(library), "-lm", "-o", str(program)]
    program.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(command, cwd=ROOT, check=True)
    return program


def run(runner: list[str], program: Path) -> dict[str, str]:
    """Hashes by name, and the best speed of some runs."""
    found: dict[str, str] = {}
    for _ in range(REPEATS):
        said = subprocess.run([*runner, str(program)], capture_output=True, text=True, check=True)
        lines = dict(line.split() for line in said.stdout.splitlines())
        lines["speed"] = str(max(float(lines["speed"]), float(found.get("speed", 0))))
        lines["seconds"] = str(min(float(lines["seconds"]), float(found.get("seconds", 1e300))))
        found = lines
    return found


def main(build_folder: str, compiler: str, *targets: str) -> int:
    folder = Path(build_folder).resolve()
    programs = {"native": (shlex.split(compiler), ["-fopenmp"], folder / "lib/libcontact.a", [])}
    for name, triple in (each.split("=") for each in targets):
        zig = [sys.executable, "-m", "ziglang", "cc", "-target", triple]
        flags = []
        if "wasm" in name:
            flags = ["-D_WASI_EMULATED_PROCESS_CLOCKS", "-lwasi-emulated-process-clocks"]
        runner = next((words for part, words in RUNNERS.items() if part in triple), [])
        programs[name] = (zig, flags, folder / "cross" / name / "lib/libcontact.a", runner)
    first, faults = None, 0
    print(
        f"{'target':16}{'bits':8}{'M updates/s':>12}{'share':>7}{'contact s':>11}{'share':>7}{'kB':>7}"
    )
    for name, (words, flags, library, runner) in programs.items():
        program = build(words, flags, library, folder / "cross" / f"cross-{name}.exe")
        if runner and runner[0] != sys.executable and shutil.which(runner[0]) is None:
            print(f"{name:16}not run: no {runner[0]}")
            continue
        found = run(runner, program)
        speed, seconds = float(found.pop("speed")), float(found.pop("seconds"))
        first = first or (found, speed, seconds)
        equal = found == first[0]
        faults += not equal
        print(
            f"{name:16}{'equal' if equal else 'DIFFER':8}{speed / 1e6:12.1f}{speed / first[1]:7.2f}"
            f"{seconds:11.3f}{seconds / first[2]:7.2f}{program.stat().st_size / 1e3:7.0f}"
        )
    return faults > 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
