"""Runs of scenes on the processes of MPI, compared with the run of one: ``mpiexec -n N python bits.py STEPS``.
The first process prints a line per run: scene, cut, processes, and whether all bits are equal."""

import sys
from pathlib import Path

import numpy as np
from mpi4py import MPI

import libcontact as ct

SCENES = Path(__file__).resolve().parents[2] / "tutorials" / "scenes"
NAMES = ("plates", "hertz", "block_on_an_incline", "cam", "bent_plate", "spinning_ring")
COMM = MPI.COMM_WORLD


def cuts(count):
    """Five ways to give elements to processes; three and more processes get two of them."""
    numbers, size = np.arange(count), COMM.size
    return {
        "metis": "metis",
        "coordinates": "coordinates",
        **(
            {}
            if size > 2
            else {
                "in runs": size * numbers // count,
                "one by one": numbers % size,
                "at random": np.random.default_rng(1).integers(0, size, count),
            }
        ),
    }


def tables(run):
    """All numbers of a run: states, stresses, energies, momenta, probes, contact points."""
    for body in run.state.values():
        yield from (body.displacement, body.velocity, body.stress)
    for table in (run.energy, run.momentum, *run.probes.values()):
        yield from dict(table.columns()).values()
    for points in run.contact:
        yield from (points[name] for name in points.dtype.names)


def same(one, other):
    """Equal as numbers and, but for the sign of zeros, to the last bit."""
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(tables(one), tables(other)))


for name in NAMES:
    scene = ct.Scene.load(SCENES / f"{name}.toml")
    problem = scene._built(None)
    until = int(sys.argv[1]) * problem.dt
    alone = scene.run(progress=False, output=False, until=until)
    count = sum(len(body.mesh.elements) for body in problem.bodies.values())
    for how, partition in cuts(count).items():
        run = scene.run(progress=False, output=False, until=until, comm=COMM, partition=partition)
        alike = COMM.allreduce(
            int(same(run, alone) and len(run.steps) == len(alone.steps)), MPI.MIN
        )
        if COMM.rank == 0:
            print(name, how, COMM.size, "same" if alike else "differs", sep=" | ", flush=True)
