"""Runs of scenes on the processes of MPI, compared with the run of one:
``mpiexec -n N python -m mpi4py bits.py STEPS [all] [SCENE ...]``. The first process prints a line per run: scene, cut,
processes, and whether all bits are equal. With ``all``, three and more processes get all five cuts, too."""

import sys
import tempfile
from pathlib import Path

import numpy as np
from mpi4py import MPI
from scenes import NAMES, same, scene_of, touches

import libcontact as ct

COMM = MPI.COMM_WORLD


def cuts(count, every):
    """Ways to give elements to processes, without METIS where it is not installed."""
    numbers, size = np.arange(count), COMM.size
    found = {
        "metis": "metis",
        "coordinates": "coordinates",
        "in runs": size * numbers // count,
        "one by one": numbers % size,
        "at random": np.random.default_rng(1).integers(0, size, count),
    }
    return found if every or size <= 2 else dict(list(found.items())[:2])


def begun(scene, share, folder):
    """The keywords of runs that go on where the comparison begins."""
    if share == 0.0 or not ct.has("hdf5"):
        return {}
    file = folder / "begun.vtkhdf"
    if COMM.rank == 0:
        end = scene._built(None).end
        scene.run(progress=False, output=file, until=share * end)
    return {"restart": COMM.bcast(file)}


def compare(name, steps, every, folder):
    scene, share = scene_of(name)
    more = {"progress": False, "output": False, **begun(scene, share, folder)}
    problem = scene._built(None)
    more["until"] = min(share * problem.end + steps * problem.dt, problem.end)
    alone = scene.run(**more)
    count = sum(len(body.mesh.elements) for body in problem.bodies.values())
    for how, partition in cuts(count, every).items():
        run = scene.run(**more, comm=COMM, partition=partition)
        alike = same(run, alone) and len(run.steps) == len(alone.steps)
        alike &= (run.state is None) == (COMM.rank > 0)
        alike = COMM.allreduce(int(alike), MPI.MIN)
        if COMM.rank == 0:
            words = "same" if alike else "differs", "touches" if touches(alone) else "apart"
            print(name, how, COMM.size, *words, sep=" | ", flush=True)


if __name__ == "__main__":
    given = sys.argv[2:]
    with tempfile.TemporaryDirectory() as folder:
        for scene in [name for name in given if name != "all"] or NAMES:
            compare(scene, int(sys.argv[1]), "all" in given, Path(folder))
