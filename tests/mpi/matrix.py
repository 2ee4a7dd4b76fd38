"""Each scene of ``bits.py`` and each run of the laboratory's short list, on 1 to 4 processes of MPI and with all five
cuts: ``python matrix.py [--steps 12] [--processes 1,2,3,4] [CASE ...]``. Prints the equal and all runs of each program,
and the runs that differ; a run that differs, or a program without runs, is an error."""

import argparse
import os
import subprocess
import sys
from pathlib import Path

EXEC = Path(sys.executable).with_name("mpiexec")
# More processes than processors: those that wait must let the others go on.
YIELDING = {"MPIR_CVAR_ENABLE_HEAVY_YIELD": "1", "MPIR_CVAR_POLLS_BEFORE_YIELD": "20"}
PROGRAMS = {"bits": ["all"], "laboratory": []}


def compared(name, processes, steps, cases):
    """The rows that a program printed: case, cut, processes, "same" or "differs", what it touches."""
    program = Path(__file__).with_name(f"{name}.py")
    command = [EXEC, "-n", processes, sys.executable, "-W", "ignore", "-m", "mpi4py", program]
    command += [steps, *PROGRAMS[name], *cases]
    environment = {**os.environ, **YIELDING, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [*map(str, command)], env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    rows = [line.split(" | ") for line in done.stdout.splitlines()]
    return [row for row in rows if len(row) == 5]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=12)
    parser.add_argument("--processes", default="1,2,3,4")
    parser.add_argument("--programs", default=",".join(PROGRAMS))
    parser.add_argument("cases", nargs="*")
    given, failed = parser.parse_args(), False
    print("program     processes  equal    all  touching")
    for name in given.programs.split(","):
        for processes in given.processes.split(","):
            rows = compared(name, processes, given.steps, given.cases)
            differing = [row for row in rows if row[3] != "same"]
            touching = sum(row[4] == "touches" for row in rows)
            numbers = f"{len(rows) - len(differing):6} {len(rows):6} {touching:9}"
            print(f"{name:11} {processes:>9} {numbers}", flush=True)
            for row in differing:
                print("differs:", *row[:3], flush=True)
            failed |= bool(differing) or not rows
    sys.exit(failed)


if __name__ == "__main__":
    main()
