"""The short list of the stability laboratory on the processes of MPI:
``mpiexec -n N python -m mpi4py laboratory.py STEPS [CASE ...]``. Each run of a case goes to 0.6 of its end on one
process, and from there some steps on one and, cut in five ways, on all. The first process prints a line per run: case,
cut, processes, whether all bits are equal. Verdicts of the cases are not looked at, as their runs are cut short."""

import os
import sys
import tempfile
import warnings
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "stability"))

import cases  # noqa: E402
from bits import cuts  # noqa: E402
from libcontact.pieces import elements_of  # noqa: E402
from mpi4py import MPI  # noqa: E402
from scenes import same, touches  # noqa: E402

import libcontact as ct  # noqa: E402

COMM, SHARE = MPI.COMM_WORLD, 0.6
alone_run = ct.Scene.run


class Comparison:
    """In place of ``Scene.run``."""

    def __init__(self, steps, folder):
        self.steps, self.file, self.case = steps, folder / "begun.vtkhdf", ""

    def __call__(self, scene, **given):
        scene.set_output(every=10**6)  # cases look at each step, which a file would make slow
        problem = scene._built(given.get("threads"))
        begin, more = SHARE * problem.end, {"progress": False, "output": False}
        more["until"] = min(begin + self.steps * problem.dt, problem.end)
        failed = False
        if COMM.rank == 0:
            try:
                alone_run(scene, progress=False, output=self.file, until=begin)
            except ct.RunError:
                failed = True
        if COMM.bcast(failed):
            if COMM.rank == 0:
                print(self.case, "ends before with an error", sep=" | ", flush=True)
            return alone_run(scene, **more)
        more["restart"] = self.file
        alone = self.outcome(scene, {**more, "watch": given.get("watch")})
        for how, partition in cuts(elements_of(problem), True).items():
            run = self.outcome(scene, {**more, "comm": COMM, "partition": partition})
            self.tell(how, alone, run)
        if isinstance(alone, Exception):
            raise alone
        return alone

    @staticmethod
    def outcome(scene, more):
        try:
            return alone_run(scene, **more)
        except ct.RunError as error:
            return error

    def tell(self, partition, alone, run):
        if isinstance(alone, Exception) or isinstance(run, Exception):
            alike, words = type(alone) is type(run), f"{type(alone).__name__}"
        else:
            alike, words = same(run, alone), "touches" if touches(alone) else "apart"
        alike = COMM.allreduce(int(alike), MPI.MIN)
        if COMM.rank == 0:
            said = self.case, partition, COMM.size, "same" if alike else "differs", words
            print(*said, sep=" | ", flush=True)


def main():
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        compare = Comparison(int(sys.argv[1]), Path(COMM.bcast(folder)))
        ct.Scene.run = lambda scene, **given: compare(scene, **given)
        for case in cases.CASES:
            if sys.argv[2:] and case.__name__ not in sys.argv[2:]:
                continue
            compare.case = case.__name__
            try:
                for _ in case(True):
                    pass
            except Exception as reason:  # of what a case computes from a run that was cut short
                if COMM.rank == 0:
                    print(case.__name__, f"ends: {reason!r}", sep=" | ", flush=True)


if __name__ == "__main__":
    main()
