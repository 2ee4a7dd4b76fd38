"""Two blocks that hit each other, in pieces: strong and weak scaling by counts (chapter "Pieces"). ``python
bench/pieces.py`` with valgrind counts the instructions of the piece that has most of them, and its messages, per step;
pieces are threads there, and what stands for MPI is not counted. ``--memory`` instead measures the memory of the
processes of MPI, on Linux."""

from __future__ import annotations

import math
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parent.parent
FIRST, STEPS, PIECES = 4, 20, (1, 2, 4, 8)
# Cells along an edge of a block: for a given model, and for one that grows with the pieces.
STRONG, WEAK = (12, 12, 12, 12), (8, 10, 13, 16)
# What stands for MPI, and the network of the estimate: instructions/s, s a message, bytes/s.
MESSAGES = ("add", "take_largest", "hand_over")
RATE, LATENCY, BANDWIDTH = 4e9, 2e-6, 1e9


@dataclass
class Count:
    """Of a step: instructions, sums and maxima, numbers in them; elements and received nodes of a piece."""

    cells: int
    pieces: int
    instructions: float
    joins: float
    joined: float
    elements: int
    received: int

    @property
    def seconds(self) -> float:
        """Estimate of a step: a sum over all pieces takes as many messages as doublings."""
        doublings = math.ceil(math.log2(self.pieces)) if self.pieces > 1 else 0
        messages = self.joins * doublings + (self.pieces > 1)
        volume = 8 * (self.joined * min(doublings, 1) + 3 * self.received)
        return self.instructions / RATE + messages * LATENCY + volume / BANDWIDTH


def counted(program: Path, *case: float, toggles: tuple[str, ...]) -> tuple[int, list[int]]:
    """Instructions of the thread with most of them in functions, and what the program printed."""
    with tempfile.TemporaryDirectory() as folder:
        # What a message before the first function does is counted, too, until that begins.
        command = ["valgrind", "--tool=callgrind", "--separate-threads=yes"]
        command += [f"--zero-before={toggles[0]}"]
        command += [f"--toggle-collect={name}" for name in toggles]
        command += [f"--callgrind-out-file={folder}/out", str(program), *map(str, case)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        totals = [
            re.findall(r"^totals: (\d+)", path.read_text(), re.M)
            for path in Path(folder).glob("out*")
        ]
    return max(int(found[-1]) for found in totals if found), [int(n) for n in done.stdout.split()]


def count(program: Path, cells: int, pieces: int, contact: int, friction: float) -> Count:
    toggles, case = ("ct_run", *MESSAGES), (cells, pieces, contact, friction)
    few, before = counted(program, *case, FIRST, toggles=toggles)
    many, after = counted(program, *case, FIRST + STEPS, toggles=toggles)
    joins, joined = ((b - a) / STEPS for a, b in zip(before[:2], after[:2]))
    return Count(cells, pieces, (many - few) / STEPS, joins, joined, *after[3:])


HEAD = "                 pieces   elements  M instructions  model  contact     sums  KB in them  KB received  efficiency"


def lines(program: Path, name: str, sizes: tuple[int, ...]) -> None:
    """A table; ``model``: instructions over those in proportion to the elements; ``contact``: its share of them."""
    print(f"{name}\n{HEAD}")
    bare: dict[int, Count] = {}
    for contact, friction in ((0, 0.0), (1, 0.0), (1, 0.3)):
        text = f"friction {friction}" if friction else "contact" if contact else "no contact"
        first = None
        for cells, pieces in zip(sizes, PIECES):
            one = count(program, cells, pieces, contact, friction)
            first = first or one
            bare.setdefault(pieces, one)
            ratio = one.instructions / (first.instructions / first.elements * one.elements)
            model = "" if contact else f"{ratio:.2f}"
            share = 1 - bare[pieces].instructions / one.instructions
            # Work of all pieces per element, relative to one piece.
            grown = (one.cells / first.cells) ** 3
            efficiency = grown * first.seconds / (pieces * one.seconds)
            print(
                f"{text:14} {pieces:8} {one.elements:10} {one.instructions / 1e6:15.2f}"
                f" {model:>6} {share:8.0%} {one.joins:8.0f}"
                f" {8e-3 * one.joined:11.1f} {24e-3 * one.received:12.1f} {efficiency:11.0%}",
                flush=True,
            )


def set_up(program: Path) -> None:
    """Instructions before the first step: of the whole model, and of the cut."""
    print(f"set-up of two blocks of {STRONG[0]}^3 with contact")
    for pieces in PIECES:
        case = (STRONG[0], pieces, 1, 0.0, 0)
        whole, _ = counted(program, *case, toggles=("main", "ct_state_cut"))
        cut, _ = counted(program, *case, toggles=("ct_state_cut", *MESSAGES))
        print(
            f"{pieces} pieces: whole model {whole / 1e6:.1f} M, cut {cut / 1e6:.1f} M", flush=True
        )


PROGRAM = """
import sys
import libcontact as ct
from mpi4py import MPI
def resident(key):
    found = [line for line in open("/proc/self/status") if line.startswith(key)]
    return int(found[0].split()[1]) / 1024
def run(cells, touches):
    scene = ct.Scene({"units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [{"name": "soft", "young": 900, "poisson": 0.3, "density": 1}], "time": {"end": 1},
        "body": [{"name": name, "material": "soft", "velocity": [0, 0, v],
            "box": {"origin": [0, 0, z], "size": [1, 1, 1], "cells": [cells] * 3}}
            for name, z, v in (("low", -1, 0.5), ("high", 0, -0.5))],
        "contact": [{"surfaces": ["low.z_max", "high.z_min"]}] * touches})
    until = 8 * scene._built(None).dt if comm.rank == 0 else None
    scene.run(progress=False, output=False, until=until, comm=comm, partition="coordinates")
comm = MPI.COMM_WORLD
run(2, 1)
start = resident("VmRSS")
run(int(sys.argv[1]), int(sys.argv[2]))
rows = comm.gather(resident("VmHWM") - start)
if comm.rank == 0:
    print(rows[0], max(rows[1:], default=0.0), sum(rows))
"""


def grown(pieces: int, cells: int, contact: int = 1) -> tuple[float, ...]:
    """Memory of the processes above that of Python in MB: of the first one, of the others, of all."""
    launcher = Path(sys.executable).with_name("mpiexec")
    command = [str(launcher), "-n", str(pieces), sys.executable, "-W", "ignore", "-m", "mpi4py"]
    command += ["-c", PROGRAM, str(cells), str(contact)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return tuple(map(float, done.stdout.split()))


def memory() -> None:
    """Memory for one model, and of a larger one for an element of a share and for a face of the surfaces."""
    cells, large = 48, 80
    print(f"two blocks of {cells}^3\nprocesses      first, MB     others, MB     of all, MB")
    for pieces in PIECES:
        first, others, everything = grown(pieces, cells)
        there = f"{others:14.0f}" if pieces > 1 else f"{'-':>14}"
        print(f"{pieces:9} {first:14.0f} {there} {everything:14.0f}", flush=True)
    heads = ("others, MB", "no contact, MB", "bytes/element", "bytes/face")
    print(f"\ntwo blocks of {large}^3\nprocesses", *(f"{head:>14}" for head in heads))
    for pieces in PIECES[2:]:
        touching, bare = grown(pieces, large)[1], grown(pieces, large, 0)[1]
        element = bare * 2**20 * pieces / (2 * large**3)
        face = (touching - bare) * 2**20 / (2 * large**2)
        row = f"{touching:14.0f} {bare:14.0f} {element:14.0f} {face:14.0f}"
        print(f"{pieces:9} {row}", flush=True)


def main() -> None:
    if "--memory" in sys.argv:
        memory()
        return
    with tempfile.TemporaryDirectory() as name:
        program = Path(name) / "pieces"
        command = ["cc", "-O1", "-std=c99", "-D_GNU_SOURCE", f"-I{ROOT / 'libcontact' / 'include'}"]
        command += [str(ROOT / "bench" / "pieces.c"), "-o", str(program)]
        command += [str(ROOT / "build" / "lib" / "libcontact.a"), "-fopenmp", "-lpthread", "-lm"]
        subprocess.run(command, check=True)
        lines(program, f"one model: two blocks of {STRONG[0]}^3", STRONG)
        lines(program, "a model that grows: two blocks of 8^3 to 16^3", WEAK)
        set_up(program)


if __name__ == "__main__":
    main()
