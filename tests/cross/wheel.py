"""What a wheel has to do where it is installed: a run, also with two threads, its results file, a restart, a picture,
and the same by commands.

The last line has the bits of the results, the same on every machine. A folder for the files is the argument; what needs
a package that is not there (h5py, matplotlib) is named and left out.
"""

import hashlib
import importlib.util
import subprocess
import sys
from pathlib import Path

import libcontact as ct

folder = Path(sys.argv[1])
HALF, END = 2e-8, 4e-8  # seconds


def run(name, until=END, **options):
    scene = ct.Scene.load(ct.example("plates"))
    path = folder / f"{name}.vtkhdf" if ct.has("hdf5") else False
    done = scene.run(progress=False, until=until, output=path, **options)
    words = [getattr(done.state[b], q).tobytes() for b in done.bodies for q in QUANTITIES]
    return hashlib.sha1(b"".join([*words, done.energy[-1].tobytes()])).hexdigest(), done


def command(*words):
    subprocess.run([sys.executable, "-m", "libcontact", *map(str, words)], check=True, cwd=folder)


def command_line(last):
    """``run --restart --plot`` and ``plot``; without files ``run --plot``. Returns what was done."""
    run = ("run", ct.example("plates"), "--quiet", "--until")
    if not ct.has("hdf5"):
        command(*run, END, "--plot")
        return ["run --plot"]
    command(*run, HALF, "-o", "first.vtkhdf")
    command(*run, END, "-o", "second.vtkhdf", "--restart", "first.vtkhdf", "--plot")
    assert ct.Run.load(folder / "second.vtkhdf").energy[-1] == last, "run --restart"
    command("plot", "first.vtkhdf")
    assert all((folder / f"{name}.png").stat().st_size > 10_000 for name in ("first", "second"))
    return ["run --plot", "plot"]


QUANTITIES = ("displacement", "velocity")
bits, whole = run("whole")
assert run("threads", threads=2)[0] == bits, "two threads"
done = ["run", "2 threads" if ct.has("openmp") else "no threads"]
if ct.has("hdf5"):
    _, half = run("half", HALF)
    assert run("rest", restart=half.path)[0] == bits, "restart"
    read = ct.Run.load(whole.path)
    assert read.energy.tobytes() == whole.energy.tobytes(), "results file"
    done += ["file", "restart"]
if importlib.util.find_spec("matplotlib"):
    whole.plot().savefig(folder / "plates.png")
    assert (folder / "plates.png").stat().st_size > 10_000
    done += ["picture"]
    done += command_line(whole.energy[-1])
print(", ".join(done))
print(bits)
