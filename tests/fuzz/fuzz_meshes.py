"""
Mesh files that were changed at random: ``fuzz_meshes.py FILES SEED [FOLDER]``, FILES of each format.

A good file has bytes, lines, words or numbers changed, or is cut; an HDF5 file also has objects changed. What comes out
is a mesh that the library accepts or a ValueError with the file's name. Nothing outside the file's folder is opened,
nothing is printed, and memory stays below 20 times the size of the file and a constant. Each batch is read in a process
of its own with a limit of its address space and a limit of time, since HDF5 itself may end on a damaged file; that is
counted apart.
"""

from __future__ import annotations

import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import warnings
import zipfile
from collections import Counter
from pathlib import Path

import numpy as np
from fuzz_scenes import damaged, rebuilt, run_batch
from libcontact.meshes import MeshData, read_mesh

DATA = Path(__file__).resolve().parents[1] / "data"
BATCH = 50
# Beside 20 times the size of the file: modules that are imported late, and what HDF5 and numpy take for themselves.
ROOM = 256_000_000
SECONDS = 20  # for one file
WORDS = (
    b"0 -1 1 2 3 7 8 9 99 2147483647 2147483648 99999999999 9223372036854775808 -9223372036854775808 1e308 "
    b"-1e308 1e-320 nan inf 1.5 abc * ** *INCLUDE $ $Nodes $Elements $EndNodes S1 S7 GENERATE , ,, = < > </ & \xff"
).split()
LINES = (
    b"*INCLUDE, INPUT=/etc/passwd",
    b"*INCLUDE, INPUT=../other.inp",
    b"*INCLUDE, INPUT=deck.inp",
    b"*NODE, INPUT=/etc/passwd",
    b"*NODE",
    b"*ELEMENT, TYPE=C3D8",
    b"*NSET, NSET=X, GENERATE\n1, 1000000000",
    b"*ELSET, ELSET=X\nX",
    b"*INSTANCE, NAME=A, PART=Block\n1,1,1\n0,0,0,0,0,0,90",
    b"*SURFACE, NAME=S\nX, S3",
    b"$Nodes\n99999999999",
    b"$Entities\n9 9 9 9",
    b'$PhysicalNames\n1\n3 1 "x"\n$EndPhysicalNames',
)


def good_files(folder: Path) -> dict[str, list[str]]:
    """Good files of each format, written into a folder."""
    import h5py
    import meshio

    with zipfile.ZipFile(DATA / "meshes.zip") as archive:
        archive.extractall(folder)
    shutil.copy(DATA / "deck.inp", folder)
    mesh = read_mesh(folder / "cam.msh")
    wedge = [[9, 0, 0], [10, 0, 0], [9, 1, 0], [9, 0, 1], [10, 0, 1], [9, 1, 1]]
    cells = [("hexahedron", mesh.elements), ("wedge", len(mesh.nodes) + np.arange(6)[None])]
    data = {"body": [np.arange(len(mesh.elements)) % 3, np.array([7])]}
    for name, options in (
        ("plain.vtu", {"binary": False}),
        ("packed.vtu", {"compression": "zlib"}),
    ):
        meshio.Mesh(np.vstack([mesh.nodes, wedge]), cells, cell_data=data).write(
            folder / name, **options
        )
    with h5py.File(folder / "cam.vtkhdf", "w") as file:
        group = file.create_group("VTKHDF")
        group.attrs["Version"], group.attrs["Type"] = (2, 2), np.bytes_("UnstructuredGrid")
        n = len(mesh.elements)
        for name, values in {
            "NumberOfPoints": [len(mesh.nodes)],
            "NumberOfCells": [n],
            "NumberOfConnectivityIds": [8 * n],
            "Points": mesh.nodes,
            "Connectivity": mesh.elements.ravel(),
            "Offsets": 8 * np.arange(n + 1),
            "Types": np.full(n, 12, "u1"),
            "CellData/body": np.arange(n) % 2,
        }.items():
            group[name] = np.asarray(values)
    return {
        "msh": [
            "gears.msh",
            "rings.msh",
            "notch.msh",
            "notch22.msh",
            "cam.msh",
            "tets.msh",
            "hex20.msh",
        ],
        "inp": ["deck.inp", "deck.inp", "cam.inp"],
        "vtu": ["plain.vtu", "packed.vtu"],
        "exodus": ["blocks.g", "blocks3.g"],
        "vtkhdf": ["cam.vtkhdf"],
    }


def changed_lines(chance: random.Random, good: bytes) -> bytes:
    """A text file with lines or words changed."""
    lines = good.split(b"\n")
    for _ in range(chance.choice([1, 1, 1, 2, 5])):
        at, kind = chance.randrange(len(lines)), chance.randrange(6)
        if kind == 0:
            del lines[at : at + chance.choice([1, 1, 3])]
        elif kind == 1:
            lines.insert(at, lines[chance.randrange(len(lines))])
        elif kind == 2:
            lines.insert(at, chance.choice(LINES))
        else:
            mark = b"," if b"," in lines[at] else b" "
            words = lines[at].split(mark)
            words[chance.randrange(len(words))] = chance.choice(WORDS)
            lines[at] = mark.join(words)
        lines = lines or [b""]
    return b"\n".join(lines)


def change(chance: random.Random, path: Path, good: bytes, hdf5: bool) -> None:
    """Write a changed file."""
    if hdf5 and chance.random() < 0.5:
        rebuilt(chance, path, good)
    elif not hdf5 and chance.random() < 0.6:
        path.write_bytes(changed_lines(chance, good))
    else:
        path.write_bytes(damaged(chance, good))


def check(mesh: MeshData) -> None:
    """What every mesh promises."""
    n, m = len(mesh.nodes), len(mesh.elements)
    assert mesh.nodes.dtype == np.float64 and mesh.elements.dtype == np.int32
    assert np.isfinite(mesh.nodes).all() and m > 0
    assert np.array_equal(np.unique(mesh.elements), np.arange(n)), "each node has an element"
    for sets, count in ((mesh.node_sets, n), (mesh.element_sets, m)):
        for found in sets.values():
            assert len(found) and (np.diff(found) > 0).all() and 0 <= found[0] <= found[-1] < count
    for found in mesh.face_sets.values():
        assert len(found) and found.min() >= 0 and found[:, 0].max() < m and found[:, 1].max() < 6


def limit_memory(size: int) -> None:
    """Allow this process as much address space as it has, and what a file of this size may take."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    most = pages * resource.getpagesize() + 20 * size + ROOM
    resource.setrlimit(resource.RLIMIT_AS, (most, resource.getrlimit(resource.RLIMIT_AS)[1]))


def try_file(chance: random.Random, folder: Path, name: str, counts: Counter) -> None:
    """Change a file and read it."""
    path = folder / "changed" / f"changed{Path(name).suffix}"
    good = (folder / name).read_bytes()
    change(chance, path, good, good[:4] == b"\x89HDF")
    options = {"part": "Lower"} if chance.random() < 0.1 else {}
    OPENED.clear()
    limit_memory(path.stat().st_size)
    signal.alarm(SECONDS)
    try:
        check(read_mesh(path, **options))
        kind = "read"
    except ValueError as error:
        text = str(error)
        assert "more memory" not in text, text
        assert path.name in text or "deck.inp" in text, text  # an error in a file that is included
        kind = "refused with a line" if ", line " in str(error) else "refused"
    signal.alarm(0)
    outside = [
        each
        for each in OPENED
        if not each.startswith((str(path.parent), sys.prefix, sys.base_prefix))
    ]
    assert not outside, outside
    counts[kind] += 1


OPENED: list[str] = []


def note(event: str, arguments: tuple) -> None:
    """Note the files that are opened."""
    if event == "open" and isinstance(arguments[0], (str, bytes, os.PathLike)):
        path = os.path.realpath(os.fsdecode(arguments[0]))
        if not path.startswith(("/proc/", "/dev/")):
            OPENED.append(path)


def campaign(files: int, seed: int, folder: Path | None = None) -> dict[str, int]:
    """Change so many files of each format; the counts of what came out. A broken promise is an AssertionError that
    names the seed."""
    counts: Counter = Counter()
    with tempfile.TemporaryDirectory(dir=folder) as name:
        good = good_files(Path(name))
        (Path(name) / "changed").mkdir()
        shutil.copy(DATA / "deck.inp", Path(name) / "changed")
        for form, names in good.items():
            for first in range(0, files, BATCH):

                def batch(seed=seed, first=first, names=names):
                    warnings.simplefilter("ignore")
                    sys.addaudithook(note)
                    chance, told = random.Random(seed), Counter()
                    for _ in range(min(BATCH, files - first)):
                        try_file(chance, Path(name), chance.choice(names), told)
                    return told

                seed += 1
                who, hdf5 = f"seed {seed - 1}, {form}", form in ("exodus", "vtkhdf")
                run_batch(counts, batch, SECONDS * BATCH, who, hdf5, f"{form} ")
    return {**counts, "next seed": seed}


if __name__ == "__main__":
    where = Path(sys.argv[3]) if len(sys.argv) > 3 else None
    print(json.dumps(campaign(int(sys.argv[1]), int(sys.argv[2]), where)))
