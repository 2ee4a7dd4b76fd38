"""Runs on several processes of MPI; skipped without mpi4py. ``make test-mpi`` installs what they need."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commands import captured
from libcontact.pieces import owners_of
from scenes import same_state

import libcontact as ct

pytest.importorskip("mpi4py", reason="mpi4py is not installed: make test-mpi")
ROOT = Path(__file__).resolve().parents[2]
EXEC = Path(sys.executable).with_name("mpiexec")
pytestmark = pytest.mark.skipif(not EXEC.exists(), reason="no mpiexec: make test-mpi")
# More processes than processors: those that wait must let the others go on.
YIELDING = {"MPIR_CVAR_ENABLE_HEAVY_YIELD": "1", "MPIR_CVAR_POLLS_BEFORE_YIELD": "20"}
ENVIRONMENT = {**os.environ, **YIELDING}
LONG = {"time.end_c1t_over.value": 50}
PLATES = ROOT / "tutorials" / "scenes" / "plates.toml"


def launched(count, *command):
    """A command on some processes."""
    return captured([EXEC, "-n", str(count), *map(str, command)], env=ENVIRONMENT)


def run_command(scene, *more):
    return (sys.executable, "-m", "libcontact", "run", scene, *more)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_each_number_of_processes_and_each_cut_has_the_bits_of_one(count):
    program = ROOT / "tests" / "mpi" / "bits.py"
    done = launched(count, sys.executable, "-m", "mpi4py", program, 12 if count == 2 else 6)
    rows = [line.split(" | ") for line in done.stdout.splitlines()]
    assert len(rows) == 13 * (5 if count == 2 else 2), done.stderr
    assert {row[3] for row in rows} == {"same"}, rows
    assert {row[0] for row in rows if row[4] != "touches"} == {"spinning_ring"}, rows


def test_without_metis_the_cut_is_the_one_by_coordinates(monkeypatch):
    problem = ct.Scene.load(PLATES)._built(None)
    monkeypatch.setitem(sys.modules, "pymetis", None)
    owners = owners_of(problem, 3, None)
    assert np.array_equal(owners, owners_of(problem, 3, "coordinates"))
    assert np.array_equal(np.unique(owners), [0, 1, 2])
    with pytest.raises(ct.NotBuiltIn, match="pip install .*mpi4py.*pymetis"):
        owners_of(problem, 3, "metis")


def test_a_program_of_c_has_the_same_bits_on_each_number_of_processes():
    program = ROOT / os.environ.get("LIBCONTACT_BUILD", "build") / "mpi" / "pieces"
    if not program.exists():
        pytest.skip("not built: make test-mpi")
    hashes = {launched(count, program, 6).stdout for count in (1, 2, 3)}
    assert len(hashes) == 1 and "contact" in hashes.pop()


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_cube_exchanges_what_the_model_says(count, tmp_path):
    """Elements and forces of the piece with most of them, and one exchange a step (chapter "Pieces")."""
    program, edge, steps = tmp_path / "cube.py", 8, 5
    program.write_text(
        "import libcontact as ct\nfrom libcontact._core import ffi, lib\nfrom libcontact.bridge import call\n"
        "from libcontact.pieces import Pieces\nfrom libcontact.problem import new_state\n"
        "from mpi4py import MPI\ncomm = MPI.COMM_WORLD\n"
        "body = {'name': 'cube', 'material': 'soft', 'box': {'origin': [0, 0, 0], 'size': [1, 1, 1]}}\n"
        f"body['box']['cells'] = [{edge}] * 3\n"
        "data = {'units': {'length': 'm', 'mass': 'kg', 'time': 's'}, 'time': {'end': 1}, 'body': [body],\n"
        "    'material': [{'name': 'soft', 'young': 900, 'poisson': 0.3, 'density': 1}]}\n"
        "problem, pieces = ct.Scene(data)._built(None), Pieces(comm, 'coordinates')\n"
        "piece = pieces.cut(problem, new_state(problem) if comm.rank == 0 else None)\n"
        f"call(lib.ct_run, problem.pointer, piece, {steps}, ffi.NULL, 0)\n"
        "rows = pieces.counts(piece)\n"
        "if comm.rank == 0:\n"
        "    print(*(rows[name].max() for name in ('elements', 'received', 'exchanges')))\n"
    )
    done = launched(count, sys.executable, "-m", "mpi4py", program)
    assert done.returncode == 0, done.stderr
    parts = {1: (1, 1, 1), 2: (2, 1, 1), 4: (2, 2, 1)}[count]
    layers = [edge // k + (k > 1) for k in parts]
    own = [edge // k + 1 for k in parts]
    received = np.prod([n + 1 for n in layers]) - np.prod(own)
    assert [int(word) for word in done.stdout.split()] == [np.prod(layers), received, steps]


def test_a_mesh_too_small_for_metis_is_cut_by_coordinates(capfd):
    cells = {f"body[{i}].box.cells": [3, 1, 2] for i in range(2)}
    problem = ct.Scene.load(PLATES, cells)._built(None)
    owners = owners_of(problem, 3, "metis")
    assert np.array_equal(owners, owners_of(problem, 3, "coordinates"))
    assert capfd.readouterr().out == ""


HOST = f"""add_executable(host {ROOT}/tests/mpi/pieces.c)
target_link_libraries(host PRIVATE libcontact::mpi libcontact::core)
"""
FIND = {
    "installed": "find_package(libcontact 0.2 REQUIRED COMPONENTS mpi)\n",
    "fetched": "include(FetchContent)\nset(LIBCONTACT_MPI ON)\n"
    f"FetchContent_Declare(libcontact SOURCE_DIR {ROOT})\nFetchContent_MakeAvailable(libcontact)\n",
}


@pytest.fixture(scope="module")
def stage(tmp_path_factory):
    """An installed copy with the add-on."""
    if shutil.which("make") is None:
        pytest.skip("no make")
    prefix, build = tmp_path_factory.mktemp("stage"), os.environ.get("LIBCONTACT_BUILD", "build")
    mpicc = EXEC.with_name("mpicc")
    command = ["make", "install-mpi", f"prefix={prefix}", f"BUILD={build}", f"MPICC={mpicc}"]
    built(command, ROOT)
    return prefix


def built(command, folder):
    done = captured([*map(str, command)], cwd=folder, env={**os.environ, "MAKEFLAGS": ""})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.split()


@pytest.mark.skipif(shutil.which("pkg-config") is None, reason="no pkg-config")
def test_pkg_config_finds_an_installed_copy(stage, tmp_path):
    find = ["env", f"PKG_CONFIG_PATH={stage}/lib/pkgconfig", "pkg-config", "--cflags", "--libs"]
    flags = built([*find, "libcontact-mpi"], tmp_path)
    source, host = ROOT / "tests/mpi/pieces.c", tmp_path / "host"
    compiler = [EXEC.with_name("mpicc"), "-std=c99", source]
    built([*compiler, *flags, f"-Wl,-rpath,{stage}/lib", "-lm", "-o", host], tmp_path)
    assert "contact" in launched(2, host, 2).stdout


@pytest.mark.parametrize("kind", FIND)
def test_cmake_finds_the_add_on(kind, stage, tmp_path):
    cmake = shutil.which("cmake", path=str(EXEC.parent)) or shutil.which("cmake")
    if cmake is None:
        pytest.skip("no cmake")
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.14)\nproject(host C)\n{FIND[kind]}{HOST}"
    )
    fast = "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_FLAGS=-O0 -g0 -DCT_NO_CLONES"
    compiler = f"-DMPI_C_COMPILER={EXEC.with_name('mpicc')}"
    built([cmake, "-B", "made", f"-DCMAKE_PREFIX_PATH={stage}", compiler, *fast], tmp_path)
    built([cmake, "--build", "made"], tmp_path)
    assert "contact" in launched(2, tmp_path / "made" / "host", 2).stdout


@pytest.fixture
def scene(tmp_path):
    """Plates of fewer cells, recorded every four steps, with a probe of the contact force."""
    data = ct.Scene.load(PLATES, {"output.every": 4}).data
    for body in data["body"]:
        body["box"]["cells"] = [10, 1, 10]
    data["probe"] = [{"name": "wall", "resultant": "contact"}]
    path = tmp_path / "plates.toml"
    ct.Scene(data).save(path)
    return path


def content(path):
    """The records of a file as numbers."""
    run = ct.Run.load(path)
    states = [body for state in run.states for body in state.values()]
    arrays = [
        run.steps,
        *(each.displacement for each in states),
        *(each.velocity for each in states),
    ]
    return arrays + [*dict(run.energy.columns()).values(), *dict(run.momentum.columns()).values()]


def equal(one, other):
    return all(map(np.array_equal, content(one), content(other)))


def test_what_one_process_computes_is_refused_on_several_once():
    done = launched(3, sys.executable, "-m", "libcontact", "plan", PLATES, "--error", "1%")
    assert done.returncode == 2
    assert done.stderr.count("only run computes on several processes") == 1


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_a_run_continues_on_another_number_of_processes(scene, tmp_path):
    whole, half, rest = (tmp_path / name for name in ("whole.vtkhdf", "half.vtkhdf", "rest.vtkhdf"))
    made = ct.Scene.load(scene)
    alone = made.run(output=whole)
    middle = alone.time[len(alone.time) // 2]
    until = ("--until", repr(float(middle)))
    assert launched(2, *run_command(scene, "-o", half, "--quiet", *until)).returncode == 0
    assert (
        launched(3, *run_command(scene, "-o", rest, "--quiet", "--restart", half)).returncode == 0
    )
    one, other = content(whole), content(rest)
    count = len(other[0])
    assert np.array_equal(one[0][-count:], other[0])
    made.run(output=tmp_path / "alone.vtkhdf", restart=half)
    assert equal(tmp_path / "alone.vtkhdf", rest)


def test_an_error_of_one_process_ends_all_with_one_message(tmp_path):
    program = tmp_path / "fails.py"
    program.write_text(
        "import sys, numpy as np, libcontact as ct\n"
        "from mpi4py import MPI\n"
        "comm = MPI.COMM_WORLD\n"
        f"scene = ct.Scene.load({str(PLATES)!r})\n"
        "from libcontact.pieces import Pieces\n"
        "cut = Pieces.cut\n"
        "def poisoned(self, problem, *state):\n"
        "    piece = cut(self, problem, *state)\n"
        "    if self.rank == 1:\n"
        "        problem.rows(piece.velocity)[-1] = np.nan\n"
        "    return piece\n"
        "Pieces.cut = poisoned\n"
        "try:\n"
        "    scene.run(output=False, comm=comm, partition='coordinates')\n"
        "except ct.RunError as error:\n"
        "    texts = comm.allgather((str(error), int(error.run.steps[-1])))\n"
        "    if comm.rank == 0:\n"
        "        print(len(set(texts)), texts[0])\n"
    )
    done = launched(2, sys.executable, program)
    assert done.stdout.startswith("1 "), done.stderr
    assert (
        "stopped being finite" in done.stdout and "last good state, t = 0 (step 0)" in done.stdout
    )


ALONE = {
    "out of memory before the run": (
        "def short(self, *given):\n    raise MemoryError('no room')\nct.Scene._followed = short\n"
    ),
    "out of memory for a part of another one": (
        "from libcontact.cutting import Whole\n"
        "def short(self, number):\n    raise MemoryError('no room')\nWhole.part = short\n"
        "ct.Scene._followed = lambda *given: print('the whole is built', file=sys.stderr)\n"
    ),
    "what a caller's function raises": (
        "def watch(run):\n"
        "    if run.steps[-1] > 0:\n"
        "        raise KeyError('no room')\n"
        "more['watch'] = watch\n"
    ),
}


@pytest.mark.parametrize("case", ALONE)
def test_one_process_that_fails_alone_ends_all_with_its_message(case, tmp_path):
    program = tmp_path / "fails.py"
    program.write_text(
        "import sys, libcontact as ct\nfrom mpi4py import MPI\n"
        "COMM, more = MPI.COMM_WORLD, {}\n"
        f"scene = ct.Scene.load({str(PLATES)!r}, {{'output.every': 4}})\n{ALONE[case]}"
        "scene.run(output=False, comm=COMM, partition='coordinates', **more)\n"
    )
    done = launched(2, sys.executable, "-m", "mpi4py", program)
    assert done.returncode != 0 and "no room" in done.stderr
    assert "in another piece" not in done.stderr and "the whole is built" not in done.stderr


OTHERS = {
    "contact": "scene = ct.Scene.load(FILE, {'contact[0].friction': 0.25})",
    "effects": "scene.add_effect('pull', 'left', [0], lambda view: 0 * view.velocity)",
}


@pytest.mark.parametrize("case", OTHERS)
def test_another_scene_on_another_process_is_refused(case, tmp_path):
    program = tmp_path / "differs.py"
    program.write_text(
        "import libcontact as ct\nfrom mpi4py import MPI\n"
        f"FILE, COMM = {str(PLATES)!r}, MPI.COMM_WORLD\nscene = ct.Scene.load(FILE)\n"
        f"if COMM.rank == 1:\n    {OTHERS[case]}\n"
        "try:\n    scene.run(output=False, comm=COMM)\n"
        "except ct.SceneError as error:\n    print(error)\n"
    )
    told = launched(2, sys.executable, "-m", "mpi4py", program).stdout
    assert case in told and told.count("is not that of the first process") == 2  # both tell it


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_the_file_of_four_processes_is_that_of_one(scene, tmp_path):
    """The first process gathers the records; the one file has the same bits, so VTK reads it as any other."""
    import h5py

    files = {count: tmp_path / f"{count}.vtkhdf" for count in (1, 4)}
    for count, file in files.items():
        command = Path(sys.executable).with_name("libcontact"), "run", scene, "-o", file, "--quiet"
        assert launched(count, *command).returncode == 0
    with h5py.File(files[1]) as one, h5py.File(files[4]) as four:
        names: list[str] = []
        one.visit(names.append)
        other: list[str] = []
        four.visit(other.append)
        assert names == other and one["VTKHDF"].attrs["Type"] == b"UnstructuredGrid"
        for name in names:
            if isinstance(one[name], h5py.Dataset):
                assert one[name][()].tobytes() == four[name][()].tobytes(), name
            for key, value in one[name].attrs.items():
                assert np.array_equal(value, four[name].attrs[key]), (name, key)


def start(scene, output):
    """A long run on two processes, which write their numbers into files, and the first one a letter per record."""
    program = scene.with_name("long.py")
    program.write_text(
        "import os\nfrom pathlib import Path\nimport libcontact as ct\n"
        "from mpi4py import MPI\n"
        f"comm, folder = MPI.COMM_WORLD, Path({str(scene.parent)!r})\n"
        "(folder / f'pid{comm.rank}').write_text(str(os.getpid()))\n"
        "def watch(run):\n"
        "    with open(folder / 'records', 'a') as file:\n"
        "        file.write('.')\n"
        f"scene = ct.Scene.load({str(scene)!r}, {LONG})\n"
        f"run = scene.run(output={str(output)!r}, comm=comm, watch=watch)\n"
        "print(run.interrupted, len(run.steps), flush=True)\n"
    )
    command = [str(EXEC), "-n", "2", sys.executable, str(program)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, env=ENVIRONMENT, **pipes)
    records = scene.with_name("records")
    while process.poll() is None:
        if records.exists() and records.stat().st_size >= 3:
            return process
        time.sleep(0.02)
    raise AssertionError(process.communicate())


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
@pytest.mark.parametrize("rank", [0, 1])
def test_a_killed_process_ends_all_and_the_file_continues(scene, tmp_path, rank):
    output, rest = tmp_path / "killed.vtkhdf", tmp_path / "rest.vtkhdf"
    process = start(scene, output)
    os.kill(int((tmp_path / f"pid{rank}").read_text()), signal.SIGKILL)
    process.communicate()
    assert process.returncode != 0
    made = ct.Scene.load(scene, LONG)
    until = float(ct.Run.load(output).time[-1] + 8 * made._built(None).dt)
    one = made.run(output=False, until=until)
    more = ("--set", "time.end_c1t_over.value=50", "--until", repr(until), "--quiet")
    assert launched(2, *run_command(scene, "-o", rest, "--restart", output, *more)).returncode == 0
    assert same_state(one, ct.Run.load(rest))


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_ctrl_c_at_one_process_interrupts_all_after_a_record(scene, tmp_path):
    output = tmp_path / "stopped.vtkhdf"
    process = start(scene, output)
    os.kill(int((tmp_path / "pid1").read_text()), signal.SIGINT)
    lines, errors = process.communicate()
    assert process.returncode == 0, errors
    # The launcher may join the words of both.
    assert lines.count("True") == lines.count(f" {len(ct.Run.load(output).steps)}") == 2
