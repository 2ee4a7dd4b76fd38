"""
Kill runs while they write (``make kill``).

A child process runs a scene that records every step. After a random time it is killed (SIGKILL). Then the
file must open, its records must be those of an undisturbed run, and a restart from it must end with the
same bits. A missing file is correct only if no record was complete.
"""

from __future__ import annotations

import argparse
import os
import random
import signal
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from libcontact.run import Run

import libcontact as ct

STEPS = 300


def scene() -> ct.Scene:
    """Two blocks with large strain that collide with friction, so that the state has memory."""
    out = ct.Scene(title="two blocks", units={"length": "m", "mass": "kg", "time": "s"})
    out.add_material("soft", young=2.0, poisson=0.3, density=1.0, law="neo_hookean")
    for name, x, v in (("left", -1.0, 0.1), ("right", 0.01, -0.1)):
        out.add_body(
            name,
            material="soft",
            box={"origin": [x, 0, 0], "size": [1, 1, 1], "cells": [2, 2, 2]},
            velocity=[v, 0.01 * v, 0],
        )
    out.add_contact("left.x_max", "right.x_min", beta=1, friction=0.3)
    return out.set_time(end=STEPS * 0.02, dt=0.02).set_output(every=1)


def child(path: Path) -> int:
    """Start a run that writes to the path, and return its process."""
    pid = os.fork()
    if pid:
        return pid
    try:
        scene().run(progress=False, output=path)
    finally:
        os._exit(0)


def killed(path: Path, wait: float) -> bool:
    """Start a run and kill it after a time; return whether it was still running."""
    pid = child(path)
    time.sleep(wait)
    os.kill(pid, signal.SIGKILL)
    return os.WIFSIGNALED(os.waitpid(pid, 0)[1])


def same(a: Run, b: Run) -> bool:
    return a.state.step == b.state.step and all(
        a.state[name].displacement.tobytes() == b.state[name].displacement.tobytes()
        and a.state[name].velocity.tobytes() == b.state[name].velocity.tobytes()
        for name in b.state
    )


def verdict(path: Path, whole: Run) -> str:
    """Check the file of a killed run: "early" (no file yet), "good", or a sentence with the fault."""
    if not path.exists():
        return "early"
    try:
        left = Run.load(path)
    except ValueError as error:
        return f"the file can't be read: {error}"
    count = len(left.steps)
    if left.steps.tolist() != list(range(count)):
        return f"the records are those of steps {left.steps.tolist()}"
    for table in ("energy", "momentum"):
        rows = count * (1 if table == "energy" else len(whole.bodies))
        if getattr(left, table).tobytes() != getattr(whole, table)[:rows].tobytes():
            return f"the table {table} differs"
    rest = scene().run(progress=False, restart=path, output=False)
    if rest.steps[0] < left.steps[-1]:
        return f"the restart begins at step {rest.steps[0]}, the last record is of step {left.steps[-1]}"
    return "good" if same(rest, whole) else "the restarted run ends with other bits"


def kill_campaign(kills: int, seed: int = 1, folder: Path | None = None) -> dict[str, int]:
    """Kill runs at random times and count the results; "late" counts runs that had ended before."""
    chance, counts = random.Random(seed), {}
    with tempfile.TemporaryDirectory(dir=folder) as name:
        path = Path(name) / "run.vtkhdf"
        begin = time.perf_counter()
        whole = scene().run(progress=False, output=path)
        took = time.perf_counter() - begin
        for file in Path(name).iterdir():
            assert file == path, f"a completed run leaves {file.name}"
        while (
            counts.get("good", 0)
            + sum(n for told, n in counts.items() if told not in ("good", "late", "early"))
            < kills
        ):
            for file in Path(name).iterdir():
                file.unlink()
            told = verdict(path, whole) if killed(path, chance.uniform(0.0, took)) else "late"
            counts[told] = counts.get(told, 0) + 1
            if counts.get("late", 0) + counts.get("early", 0) > 20 * kills + 100:
                raise RuntimeError(f"no run was still running when it was killed: {counts}")
    return counts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kills", nargs="?", type=int, default=100, help="number of runs (100)")
    parser.add_argument("seed", nargs="?", type=int, default=int(time.time()), help="(the time)")
    given = parser.parse_args()
    np.seterr(all="raise")
    counts = kill_campaign(given.kills, given.seed)
    print(f"{given.kills} runs killed while they wrote (seed {given.seed}): {counts}")
    return int(bool(set(counts) - {"good", "early", "late"}))


if __name__ == "__main__":
    sys.exit(main())
