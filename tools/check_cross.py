"""One table: the runs of ``tests/cross/cross.c`` by each compiler and machine, bits, speed and size.

``check_cross.py build "cc -fopenmp" linux-x86_64=x86_64-linux-gnu.2.17 ...``, after make has built the library for each
target in ``build/cross``. The first line, of the machine's own compiler, is what the others are compared with; other
bits, with one thread or two, end the command with 1. A target whose emulator is not here is named and left out. TABLE
names a file that gets the table, too. A row is kept for the next time, until one of its programs changes.
"""

from __future__ import annotations

import csv
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterable
from functools import partial
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
SOURCE = ROOT / "tests/cross/cross.c"
REPEATS = 5
HEAD = (
    "target",
    "compiler",
    "kernels",
    "run by",
    "bits",
    "M updates/s",
    "of gcc",
    "contact s",
    "of gcc",
    "kB",
)
# What runs the programs of a machine that is not this one.
WASM = """
import sys, wasmtime as w
engine = w.Engine()
linker, store, wasi = w.Linker(engine), w.Store(engine), w.WasiConfig()
wasi.inherit_stdout()
wasi.argv = sys.argv[1:]
linker.define_wasi()
store.set_wasi(wasi)
instance = linker.instantiate(store, w.Module.from_file(engine, sys.argv[1]))
try:
    instance.exports(store)["_start"](store)
except w.ExitTrap as end:
    sys.exit(end.code)
"""
RUNNERS = {
    "aarch64-linux": ("QEMU", ["qemu-aarch64"]),
    "windows": ("Wine", ["wine"]),
    "wasm32": ("Wasmtime", [sys.executable, "-c", WASM]),
    "macos": ("", ["no emulator of macOS"]),
}


class Target(NamedTuple):
    compiler: list[str]
    library: Path
    flags: list[str] = ["-lpthread"]
    emulator: str = ""
    runner: list[str] = []

    def runs(self) -> bool:
        return not self.runner or shutil.which(self.runner[0]) is not None


def target_of(name: str, triple: str, cross: Path) -> Target:
    emulator, runner = next((r for part, r in RUNNERS.items() if part in triple), ("", []))
    wasm = ["-D_WASI_EMULATED_PROCESS_CLOCKS", "-lwasi-emulated-process-clocks"]
    return Target(
        [sys.executable, "-m", "ziglang", "cc", "-target", triple],
        cross / name / "lib/libcontact.a",
        wasm if "wasm" in name else ["-lpthread"],
        emulator,
        runner,
    )


def own_wine(cross: Path) -> None:
    """Wine has its folder in the build, and says nothing of itself."""
    os.environ["WINEPREFIX"], os.environ["WINEDEBUG"] = str(cross / "wine"), "-all"


def version(compiler: list[str]) -> str:
    """The compiler and its version."""
    words = [word for word in compiler if not word.startswith("-f")]
    said = subprocess.run([*words, "--version"], capture_output=True, text=True).stdout
    number = re.search(r"\d+\.\d+", said)
    return f"{'clang' if 'clang' in said else 'gcc'} {number[0] if number else '?'}"


def build(target: Target, program: Path) -> Path:
    command = [*target.compiler, "-std=c99", "-Os", "-s", "-Ilibcontact/include", str(SOURCE)]
    command += [str(target.library), "-lm", *target.flags, "-o", str(program)]
    program.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(command, cwd=ROOT, check=True)
    return program


def run(target: Target, program: Path, *arguments: str) -> tuple[dict[str, str], float, float]:
    """Hashes by name, element updates in a second, and the seconds of contact."""
    command = [*target.runner, str(program), *arguments]
    said = subprocess.run(command, capture_output=True, text=True, check=True)
    found = dict(line.split() for line in said.stdout.splitlines())
    return found, float(found.pop("speed")), float(found.pop("seconds"))


def kept(
    store: Path, inputs: Iterable[Path], row: Callable[[], tuple[str, ...]]
) -> tuple[str, ...]:
    """A row of a table; that of an earlier run, if its files and the emulators are the same."""
    found = [path.read_bytes() for path in inputs]
    found += [str(shutil.which(words[0])).encode() for _, words in RUNNERS.values()]
    key = hashlib.sha256(b"".join(found)).hexdigest()
    if store.exists() and (old := json.loads(store.read_text()))[0] == key:
        return tuple(old[1:])
    new = row()
    store.write_text(json.dumps([key, *new]))
    return new


def write(head: Iterable[str], rows: list[tuple[str, ...]]) -> None:
    """Print a table, and write the file that TABLE names."""
    lines = [tuple(head), *rows]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    for line in lines:
        print("  ".join(word.ljust(w) for word, w in zip(line, widths, strict=True)).rstrip())
    if os.environ.get("TABLE"):
        with open(os.environ["TABLE"], "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows(lines)


def measure(native: Target, target: Target, first: Path, program: Path) -> tuple[str, ...]:
    """Bits, speed, time of contact and size of a program, and their shares of the first one's."""
    # In turn with the first one, as other programs share the machine.
    repeats = 1 if target.emulator else REPEATS
    pairs = [(run(native, first), run(target, program)) for _ in range(repeats)]
    speeds = [max(pair[i][1] for pair in pairs) for i in (0, 1)]
    seconds = [min(pair[i][2] for pair in pairs) for i in (0, 1)]
    hashes = [pair[1][0] for pair in pairs] + [run(target, program, "60", "2")[0]]
    bits = "equal" if all(one == pairs[0][0][0] for one in hashes) else "DIFFER"
    numbers = (f"{speeds[1] / 1e6:.1f}", f"{speeds[1] / speeds[0]:.2f}")
    numbers += (f"{seconds[1]:.3f}", f"{seconds[1] / seconds[0]:.2f}")
    return (bits, *numbers, f"{program.stat().st_size / 1e3:.0f}")


def main(build_folder: str, compiler: str, *targets: str) -> int:
    folder = Path(build_folder).resolve()
    cross = folder / "cross"
    own_wine(cross)
    native = Target(shlex.split(compiler), folder / "lib/libcontact.a")
    all_of = {"native": native}
    for name, triple in (each.split("=") for each in targets):
        all_of[name] = target_of(name, triple, cross)
    rows = []
    first = cross / "cross-native.exe"
    for name, target in all_of.items():
        print(f"  {name}", file=sys.stderr, flush=True)
        program = build(target, cross / f"cross-{name}.exe")
        # The names of the kernels of the newest machine.
        kernels = "chosen" if b".avx512f" in target.library.read_bytes() else "one set"
        words = (name, version(target.compiler), kernels, target.emulator)
        if target.runs():
            row = partial(measure, native, target, first, program)
            rows.append((*words, *kept(cross / f"cross-{name}.json", (first, program), row)))
        else:
            rows.append((*words, "not run", *5 * ("",)))
    write(HEAD, rows)
    return any("DIFFER" in line for line in rows)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
