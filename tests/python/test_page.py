"""The library in a page (docs/laboratory): the module of ``make page`` has the bits of this machine, in Node.

Without ``make page`` before, or without Node, these tests are skipped; ``make test-page`` runs them all.
"""

import json
import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build")).resolve()
FOLDER = BUILD / "page" / "html"
NODE = shutil.which("node")
sys.path.insert(0, str(ROOT / "tools"))

import build_page  # noqa: E402

module = pytest.mark.skipif(
    NODE is None or not (FOLDER / "laboratory.js").exists(), reason="no Node, or no make page"
)
UNITS = 'units = { length = "mm", mass = "t", time = "s" }\n'
STEEL = 'material = [{ name = "steel", young = 2.1e5, poisson = 0.3, density = 7.8e-9 }]\n'
RING = (
    UNITS
    + STEEL
    + """
[[body]]
name = "ring"
ring = { centre = [-1.002, 0, 0], radius = [0.8, 1.0], width = 0.5, cells = [2, 24, 2] }
material = "steel"
velocity = [2e5, 1e5, 0]
[[body]]
name = "block"
box = { origin = [0, -1.5, -0.75], size = [1, 3, 1.5], cells = [4, 12, 6] }
material = "steel"
[[contact]]
surfaces = ["ring.outer", "block.x_min"]
friction = 0.3
[time]
end = 1.5e-6
"""
)
FACE = [
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 1, 0.5],
    [0, -1, 0.25],
    [1, 0, 0.125],
    [0, 1, 0.5],
    [-1, 0, 0],
]


def hash_of(array):
    """FNV-1a of its bytes."""
    value = 14695981039346656037
    for byte in np.ascontiguousarray(array, np.float64).tobytes():
        value = (value ^ byte) * 1099511628211 & (2**64 - 1)
    return f"{value:016x}"


def scenes():
    plates = ct.example("plates").read_text(encoding="utf-8").replace("100, 1, 100", "20, 1, 20")
    wall = ct.example("bar_on_a_wall").read_text(encoding="utf-8")
    incline = ct.example("block_on_an_incline").read_text(encoding="utf-8")
    own = plates.replace('enforcement = "penalty"', 'enforcement = "energy_controlled"')
    own = own.replace('"central_difference"', '"tchamwa_wielgosz"').replace("hex8", "hex20", 1)
    return {"plates": plates, "default": own, "wall": wall, "incline": incline, "ring": RING}


def ask(kind, *tasks):
    command = [NODE, ROOT / "tests" / "page" / "hashes.mjs", FOLDER, kind]
    told = subprocess.run(command, input=json.dumps(tasks), capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    return json.loads(told.stdout)


@module
@pytest.mark.parametrize("kind", ["simd", "plain"])
def test_the_module_has_the_bits_of_this_machine(kind, tmp_path):
    found, tasks = [], []
    for name, text in scenes().items():
        path = tmp_path / f"{name}.toml"
        path.write_text(text, encoding="utf-8")
        state = ct.Scene.load(path).run(progress=False, output=False).state
        given = tomllib.loads(text)
        moved = [state[body["name"]].displacement for body in given["body"]]
        found.append(hash_of(np.concatenate(moved)))
        tasks.append({"task": "run", "scene": given})
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (10_000, 3))
    closest = ct.project("Q8", np.array(FACE), points)
    found.append(hash_of(np.column_stack([closest.xi, closest.distance])))
    tasks.append({"task": "project", "nodes": FACE, "points": points.tolist()})
    assert len(set(found)) == len(found)
    assert ask(kind, *tasks) == found


@module
@pytest.mark.parametrize("kind", ["simd", "plain"])
def test_the_closed_form_is_that_of_this_machine_to_round_off(kind):
    random = np.random.default_rng(2)
    x, z, t = random.uniform([0.0, -1.0, 0.0], [0.8, 1.0, 1.1], (500, 3)).T
    stress, speed = ct.exact.plates(x, z, t)
    exact = np.array([*stress, *speed])
    rows = np.column_stack([x, z, t, 0 * x, 0 * x])
    (answer,) = ask(kind, {"task": "exact", "rows": rows.tolist(), "poisson": 0.3})
    assert np.abs(np.reshape(answer, (500, 5)).T - exact).max() < 1e-12


@module
def test_the_shown_simplex_rolls_as_that_of_the_library():
    """Its lowest corner after each step, until differences of distances are round-off."""
    for point in ([0.4, 0.3, 1.2], [-0.5, 0.1, -1.0], [0.9, -0.8, 0.4]):
        task = {"task": "simplex", "nodes": FACE, "point": point, "start": [-0.2, 0.6]}
        (answer,) = ask("simd", task)
        assert len(answer["found"]) > 40
        assert answer["found"][:40] == answer["rolled"][:40]


def test_a_module_is_put_together_from_its_differences():
    """The inverse of ``differences``, written as ``unpackDifferences`` of packed.js reads it."""
    random = np.random.default_rng(3)
    old = random.bytes(3000)
    new = old[500:900] + random.bytes(40) + old[100:130] + old[2000:] + b"end"
    stored, out, at = build_page.differences(new, old), b"", 0

    def number():
        nonlocal at
        value, shift = 0, 0
        while True:
            byte, at = stored[at], at + 1
            value, shift = value | (byte & 127) << shift, shift + 7
            if byte < 128:
                return value

    while at < len(stored):
        own = number()
        out, at = out + stored[at : at + own], at + own
        place = number()
        out += old[place : place + number()]
    assert out == new and len(stored) < 150
