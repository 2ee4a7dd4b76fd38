"""The library in a page (docs/laboratory): the module of ``make page`` has the bits of this machine, in Node.

Without ``make page`` before, or without Node, these tests are skipped; ``make test-page`` runs them all.
"""

import json
import os
import shutil
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build")).resolve()
FOLDER = BUILD / "page" / "html"
NODE = shutil.which("node")

import native

module = pytest.mark.skipif(
    NODE is None or not (FOLDER / "laboratory.js").exists(), reason="no Node, or no make page"
)


def ask(*tasks):
    command = [NODE, ROOT / "tests" / "page" / "hashes.mjs", FOLDER]
    told = subprocess.run(command, input=json.dumps(tasks), capture_output=True, text=True)
    assert told.returncode == 0, told.stderr
    return json.loads(told.stdout)


@module
def test_the_module_has_the_bits_of_this_machine():
    tasks, found = native.hashes()
    assert ask(*tasks) == found


@module
def test_the_closed_form_is_that_of_this_machine_to_round_off():
    task, exact = native.closed_form()
    (answer,) = ask(task)
    assert np.abs(np.reshape(answer, (-1, 5)).T - exact).max() < 1e-12


@module
def test_a_body_is_stretched_and_turned_as_by_python():
    """Products of three by three numbers and sines may differ in the last bit."""
    task = {"task": "end", "scene": tomllib.loads(native.STRETCHED)}
    (answer,) = ask(task)
    moved = native.displacement(native.STRETCHED)
    assert np.abs(np.reshape(answer, (-1, 3)) - moved).max() < 1e-13 * np.abs(moved).max()


# Changes of RING and of the scene WALL that Python refuses: what stands there, and what takes its place.
WRONG = [
    ('name = "steel"', 'nam = "steel"'),
    ('name = "steel", ', ""),
    ("young = 2.1e5", 'young = "stiff"'),
    ("young = 2.1e5", "young = -1"),
    ("young = 2.1e5", "young = inf"),
    ("poisson = 0.3", "poisson = 0.5"),
    ("density = 7.8e-9", "density = 0.0"),
    ("density = 7.8e-9", "density = true"),
    ("density = 7.8e-9", 'density = 1, law = "neohookean"'),
    ('length = "mm"', 'length = "furlong"'),
    ('length = "mm", ', ""),
    (native.UNITS, ""),
    (native.STEEL, ""),
    ('name = "ring"', 'name = "block"'),
    ('name = "ring"', 'name = " ring"'),
    ('name = "ring"', 'name = "' + 64 * "r" + '"'),
    ('material = "steel"', 'material = "stel"'),
    ('material = "steel"', "material = 3"),
    ("cells = [2, 24, 2]", "cells = [2, 24]"),
    ("cells = [2, 24, 2]", "cells = [2, 2, 2]"),
    ("cells = [2, 24, 2]", "cells = [2, 24.0, 2]"),
    ("cells = [2, 24, 2]", 'cells = "many"'),
    ("radius = [0.8, 1.0]", "radius = [1.5, 1.0]"),
    ("radius = [0.8, 1.0]", "radius = { inner = 1 }"),
    ("width = 0.5", "with = 0.5"),
    ("ring = {", "ball = { radius = 1.0, cells = [2, 9] } #"),
    ("ring = {", "box = { size = [1, 1, 1], cells = [1, 1, 1] }\nring = {"),
    ("ring = {", "# ring = {"),
    ("ring = {", "ring = 3 # {"),
    ("velocity = [2e5, 1e5, 0]", "velocity = [2e5, nan, 0]"),
    ("velocity = [2e5, 1e5, 0]", "velocity = 2e5"),
    ("velocity = [2e5, 1e5, 0]", "speed = [2e5, 1e5, 0]"),
    ('"ring.outer"', '"ring.outside"'),
    ('"ring.outer"', '"rung.outer"'),
    ('"ring.outer"', '"ring"'),
    ('"ring.outer", ', ""),
    ("friction = 0.3", "friction = -0.3"),
    ("friction = 0.3", "tangent = 1"),
    ("friction = 0.3", "beta = 1\nepsilon = 2"),
    ("friction = 0.3", 'enforcement = "lagrange"'),
    ("friction = 0.3", 'enforcement = "penalty"\ndissipation = 0.3'),
    ("friction = 0.3", '[[contact]]\nsurfaces = ["block.x_min", "ring.outer"]'),
    ("end = 1.5e-6", "end = 0"),
    ("end = 1.5e-6", ""),
    ("end = 1.5e-6", "end = 1.5e-6\ncourant = 1\ndt = 1e-9"),
    ("end = 1.5e-6", 'end = 1\nintegrator = "chung-lee"'),
    ("[time]\nend = 1.5e-6", ""),
    ("[time]", "[friction]\nmu = 1\n[time]"),
    ("[time]", "[tim]"),
    ("[time]", '[[support]]\nset = "block.x_max"\nfix = ["q"]\n[time]'),
    ("[time]", '[[support]]\nset = "block.x_max"\nfix = ["x", "x"]\n[time]'),
    ("[time]", '[[support]]\nset = "block.x_max"\nfix = []\n[time]'),
    ("[time]", '[[support]]\nset = "block.x_max"\nfix = ["x"]\nvelocity = [0, 1, 0]\n[time]'),
    ("[time]", '[[load]]\nsurface = "block.x_max"\n[time]'),
    ("[time]", '[load]\nsurface = "block.x_max"\n[time]'),
    ("[time]", '[[load]]\nsurface = "block.x_max"\npressure = 1\nfollowing = 1\n[time]'),
    (
        "[time]",
        '[[load]]\nsurface = "block.x_max"\npressure = 1\nhistory = { time = [1, 0], value = [0, 1] }\n[time]',
    ),
    ("[time]", '[[probe]]\nname = "a/b"\nresultant = "contact"\n[time]'),
    ("[time]", '[[probe]]\nname = "a"\nresultant = "contact[1]"\n[time]'),
    ("[time]", '[[probe]]\nname = "a"\nresultant = "contacts"\n[time]'),
    ("[time]", '[[probe]]\nname = "a"\npoint = [0, 0, 0]\n[time]'),
    (
        "[time]",
        '[[obstacle]]\nsurface = "block.x_max"\nplane = { point = [0, 0, 0], normal = [0, 0, 0] }\n[time]',
    ),
    (
        "[time]",
        '[[obstacle]]\nsurface = "block.x_max"\nsphere = { centre = [0, 0, 0], radius = 1 }\ntravel = [1, 0, 0]\n[time]',
    ),
    ("[time]", "[gravity]\nacceleration = [0, -9.81]\n[time]"),
    ("cells = [4, 12, 6]", "cells = [4, 12, 6], grading = [1, 1, 1e7]"),
    ("cells = [4, 12, 6]", 'cells = [4, 12, 6], symmetric = ["y", "y"]'),
    ("velocity =", "spin = { rate = 1 }\nvelocity ="),
    ("velocity =", "spin = { rate = 1, axis = [0, 0, 0] }\nvelocity ="),
    ("velocity =", "spin = { axis = [0, 0, 1] }\nvelocity ="),
    ("velocity =", "initial = { angle = 1 }\nvelocity ="),
    ("velocity =", "initial = { angle = 0 }\nvelocity ="),
    ("velocity =", "initial = { stress = [1, 2, 3] }\nvelocity ="),
    ("velocity =", "initial = { gradient = [[1, 0, 0], [0, 1], [0, 0, 1]] }\nvelocity ="),
    ("[time]", "[damping]\n[time]"),
    ("[time]", "[damping]\nrate = -1\n[time]"),
    ("[time]", '[damping]\nrate = 1\nbodies = ["rung"]\n[time]'),
    ("[time]", "[damping]\nrate = 1\nrelaxation = true\n[time]"),
    ("density = 7.8e-9 }]", 'density = 7.8e-9, law = "neo_hookean" }]\n[damping]\nstiffness = 1'),
]


@module
def test_wrong_scenes_have_the_key_the_reason_and_the_line_of_python(tmp_path):
    path, tasks, expected = tmp_path / "wrong.toml", [], []
    for old, new in WRONG:
        assert old in native.RING
        text = native.RING.replace(old, new, 1)
        path.write_text(text, encoding="utf-8")
        with pytest.raises(ct.SceneError) as caught:
            ct.Scene.load(path)
        error = caught.value
        expected.append({"key": error.key, "reason": error.reason, "line": error.line})
        tasks.append({"task": "check", "text": text})
    found = ask(*tasks)
    differ = [
        (change, here, there)
        for change, here, there in zip(WRONG, found, expected)
        if here != there
    ]
    assert not differ


@module
def test_scenes_of_the_tutorials_are_read_as_by_python_or_refused_by_name():
    texts = {path.name: path.read_text() for path in (ROOT / "tutorials/scenes").glob("*.toml")}
    found = dict(zip(texts, ask(*({"task": "check", "text": t} for t in texts.values()))))
    taken = {name for name, answer in found.items() if "scene" in answer}
    assert {"plates.toml", "bar_on_a_wall.toml", "bouncing_bar.toml"} <= taken
    for name, answer in found.items():
        if name in taken:
            assert answer["scene"] == tomllib.loads(texts[name])
        else:
            assert answer["key"] and "run this scene with the library" in answer["reason"]


@module
def test_the_shown_simplex_rolls_as_that_of_the_library():
    """Its lowest corner after each step, until differences of distances are round-off."""
    for point in ([0.4, 0.3, 1.2], [-0.5, 0.1, -1.0], [0.9, -0.8, 0.4]):
        task = {"task": "simplex", "nodes": native.FACE, "point": point, "start": [-0.2, 0.6]}
        (answer,) = ask(task)
        assert len(answer["found"]) > 40
        assert answer["found"][:40] == answer["rolled"][:40]
