"""When a run uses threads; and a process that is forked after a run with several: OpenMP's threads do not exist in it,
and its runs must still end."""

import os
import sys

import numpy as np
import pytest
from commands import captured
from libcontact._core import lib
from scenes import MILLIMETRES, STEEL, box_of, scene_with

import libcontact as ct

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="a system without fork")

PROGRAM = """
import multiprocessing, os, sys
import numpy as np
import libcontact as ct
sys.path.insert(0, {folder!r})
from test_fork import scene, nearest

before, points, run = scene(), nearest(2), scene().run(threads=2)

def compute(_):
    again = [before.run(threads=2), scene().run(threads=2)]
    return all(np.array_equal(other.energy, run.energy) for other in again) and np.array_equal(nearest(2), points)

before.run(threads=2)
child = os.fork()
if child == 0:
    os._exit(0 if compute(0) else 1)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
with multiprocessing.get_context("fork").Pool(2) as pool:
    print(pool.map(compute, range(3)))
print(compute(0))
"""


SHORT = """
import os, sys
import libcontact as ct
sys.path.insert(0, {folder!r})
from test_fork import scene

def tasks():
    return len(os.listdir("/proc/self/task"))

alone = tasks()
for cells in (4, 24):
    scene(cells).run(threads=2)
    print(tasks() - alone)
"""


def scene(cells=24):
    made = scene_with(**STEEL, units=MILLIMETRES, title="two blocks")
    for name, x, velocity in (("left", -1.0, 1000.0), ("right", 0.0, 0.0)):
        made.add_body(
            name,
            material="steel",
            element="hex8",
            box=box_of([x, 0, 0], [1, 1, 1], [cells, cells, cells]),
            velocity=[velocity, 0, 0],
        )
    made.add_contact("left.x_max", "right.x_min", friction=0.3)
    return made.set_time(end=1e-7, fraction=0.5)


def nearest(threads):
    """Distances of many points from a face, computed by several threads."""
    nodes = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.2]], float)
    points = np.random.default_rng(1).uniform(-1, 1, (3000, 3))
    return ct.nearest("Q4", nodes, [[0, 1, 2, 3]], points, threads=threads).distance


@pytest.mark.skipif(not lib.ct_has_openmp(), reason="built without OpenMP")
def test_a_forked_child_runs(tmp_path):
    program = tmp_path / "forks.py"
    program.write_text(PROGRAM.format(folder=os.path.dirname(__file__)))
    # A child that waits for missing threads would wait forever; the limit is far above the time needed.
    done = captured([sys.executable, "-W", "ignore", str(program)], timeout=60)
    assert done.stdout.split("\n")[:3] == ["0", "[True, True, True]", "True"], done.stderr


@pytest.mark.skipif(
    not lib.ct_has_openmp() or not os.path.exists("/proc/self/task"),
    reason="built without OpenMP, or a system that does not list threads",
)
def test_short_loops_start_no_threads(tmp_path):
    """Starting a thread takes longer than a step of a small scene; a larger one uses the requested threads."""
    program = tmp_path / "short.py"
    program.write_text(SHORT.format(folder=os.path.dirname(__file__)))
    done = captured([sys.executable, str(program)])
    assert done.stdout.split() == ["0", "1"], done.stderr
