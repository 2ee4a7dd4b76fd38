"""Named sets of a mesh as surfaces of a scene."""

import copy
import pickle

import h5py
import numpy as np
import pytest
from libcontact.mesh import Mesh
from libcontact.sets import Sets
from scenes import METRES, scene_with

import libcontact as ct
from libcontact import meshes, problem

PLANES = ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
KINDS = ("hex8", "hex20")


def shuffled(mesh, seed):
    """The mesh with its elements in another order."""
    order = np.random.default_rng(seed).permutation(len(mesh.elements))
    return mesh.nodes, np.ascontiguousarray(mesh.elements[order])


def sides_of(nodes, elements):
    """The faces of each plane of a box as elements and sides, under the names ``set_x_min`` and so on, found by
    coordinates of the corners; a brick along the axes has its side 2 k + upper there."""
    out, low, high = {}, nodes.min(axis=0), nodes.max(axis=0)
    for side, name in enumerate(PLANES):
        axis, end = side // 2, (low, high)[side % 2][side // 2]
        there = (np.abs(nodes[elements[:, :8], axis] - end) < 1e-9).sum(axis=1) == 4
        numbers = np.flatnonzero(there)
        out[f"set_{name}"] = {"faces": np.stack([numbers, np.full_like(numbers, side)], axis=1)}
    return out


def two_bars(named, element="hex8"):
    """Two bars of unlike meshes that hit, one held, one loaded; their surfaces named as sets or as planes."""
    scene = scene_with("soft", young=1.0, poisson=0.2, density=1.0)
    for k, (name, cells) in enumerate((("a", (4, 3, 2)), ("b", (4, 2, 3)))):
        made = Mesh.box(element, (2.0 * k, 0, 0), (2, 1, 1), cells)
        nodes, elements = shuffled(made, k)
        sets = {"sets": sides_of(nodes, elements)} if named else {}
        velocity = (0.1 - 0.2 * k, 0, 0)
        scene.add_body(
            name, material="soft", nodes=nodes, elements=elements, velocity=velocity, **sets
        )
    of = "set_" if named else ""
    scene.add_contact(f"a.{of}x_max", f"b.{of}x_min", friction=0.3)
    scene.add("load", surface=f"b.{of}x_max", pressure=0.01)
    scene.add("absorb", surface=f"b.{of}z_min")
    plane = {"point": [0, 1.01, 0], "normal": [0, -1, 0]}
    scene.add("obstacle", surface=f"b.{of}y_max", plane=plane)
    scene.add_support(f"a.{of}y_min", fix="y")
    path = {"travel": [0, 0, 0.01], "history": {"time": [0, 4], "value": [0, 1]}}
    scene.add_support(f"a.{of}z_min", fix="z", **path)
    scene.add_probe("mean", surface=f"a.{of}x_min")
    scene.add_effect(
        "spring", "b", f"{of}z_max", lambda view: -0.01 * view.displacement, omega_squared=1.0
    )
    return scene.set_time(end=4.0)


@pytest.mark.parametrize("element", KINDS)
def test_a_set_gives_the_bits_of_the_plane_that_it_names(element):
    by_set, by_plane = (two_bars(named, element).run(output=False) for named in (True, False))
    for name in "ab":
        one, two = by_set.state[name], by_plane.state[name]
        assert np.abs(one.displacement).max() > 0.05
        assert (one.displacement == two.displacement).all()
    assert (by_set.probes["mean"]["displacement"] == by_plane.probes["mean"]["displacement"]).all()
    assert by_set.energy["contact"].max() > 0.0


def block(sets, element="hex8", elements=None):
    scene = scene_with("soft", young=1.0, poisson=0.2, density=1.0)
    mesh = Mesh.box(element, (0, 0, 0), (2, 1, 1), (2, 1, 1))
    elements = mesh.elements if elements is None else elements
    scene.add_body("a", material="soft", nodes=mesh.nodes, elements=elements, sets=sets)
    return scene.set_time(end=1.0)


@pytest.mark.parametrize("element", KINDS)
def test_a_support_takes_the_nodes_of_any_set(element):
    """One element at x = 1 ... 2: its nodes, those of its face, those of a list."""
    sets = {"cells": {"elements": [1]}, "end": {"faces": [[1, 1]]}, "some": {"nodes": [5, 3, 5]}}
    for name, low in (("cells", 1.0), ("end", 2.0)):
        scene = block(sets, element)
        scene.add_support(f"a.{name}", fix="xyz", velocity=[1, 0, 0])
        body = scene.run(output=False).state["a"]
        moved = body.velocity[:, 0] == 1.0
        assert (moved == (body.nodes[:, 0] >= low)).all()
    scene = block(sets, element).add_support("a.some", fix="x", velocity=[1, 0, 0])
    velocity = scene.run(output=False).state["a"].velocity[:, 0]
    assert np.flatnonzero(velocity == 1.0).tolist() == [3, 5]


SETS = {"left": {"faces": [[0, 0]]}, "inner": {"faces": [[0, 1]]}, "base.of.it": {"nodes": [0]}}
SETS |= {"cells": {"elements": [1]}}


@pytest.mark.parametrize(
    "name, reasons",
    [
        ("LEFT", ['no face or set "LEFT"; did you mean "left"?']),
        ("lfet", ['no face or set "lfet"; did you mean "left"?', '"left" and "inner"', '"x_min"']),
        ("q", ['no face or set "q"; there are', 'sets of nodes "base.of.it"', '"cells"']),
        ("base.of.it", ['has no set of faces "base.of.it"; this is a set of nodes']),
        ("cells", ['has no set of faces "cells"; this is a set of elements']),
        ("inner", ['"a.inner": side 1 of element 0 is inside the body']),
    ],
)
def test_a_wrong_set_is_refused_with_the_names_that_exist(name, reasons):
    with pytest.raises(ct.SceneError) as error:
        block(SETS).add("load", surface=f"a.{name}", pressure=1.0).run()
    assert error.value.key == "load[0].surface"
    assert all(reason in error.value.reason for reason in reasons), error.value.reason


def test_nodes_are_no_surface_of_a_contact():
    scene = block(SETS)
    with pytest.raises(ct.SceneError, match="this is a set of nodes") as error:
        scene.add_contact("a.left", "a.base.of.it").explain()
    assert error.value.key == "contact[0].surfaces[1]"


@pytest.mark.parametrize(
    "sets, key, reason",
    [
        ({"x_min": {"nodes": [0]}}, "sets", '"x_min" is the name of a face that every body has'),
        ({"s": {"nodes": [12]}}, "sets", 'nodes "s" has the node 12, outside 0 ... 11'),
        ({"s": {"faces": [[0, 6]]}}, "sets", "element and side 0, 6, outside 0 ... 1 and 0 ... 5"),
        ({"s": {"elements": [2]}}, "sets", "element 2, outside 0 ... 1"),
        ({"s": {"nodes": []}}, "sets.s.nodes", "is empty"),
        ({"s": {"nodes": [True, 1]}}, "sets.s.nodes", "boolean"),
        ({"s": {"nodes": [0.5]}}, "sets.s.nodes", "whole"),
        ({"s": {"faces": [0, 1]}}, "sets.s.faces", "(n, 2)"),
        ({"s": {}}, "sets.s", 'gives none of "nodes", "faces" and "elements"'),
        ({"s": {"nodes": [0], "faces": [[0, 0]]}}, "sets.s.faces", "exactly one of"),
        ({}, "sets", "is empty"),
        ({"s": [0]}, "sets.s", "a table"),
    ],
)
def test_wrong_sets_of_arrays_are_refused(sets, key, reason):
    with pytest.raises(ct.SceneError) as error:
        block(sets)
    assert error.value.key == f"body[0].{key}" and reason in error.value.reason


def test_an_element_that_is_listed_twice_is_refused():
    elements = Mesh.box("hex8", (0, 0, 0), (2, 1, 1), (2, 1, 1)).elements[[0, 1, 0]]
    with pytest.raises(ct.SceneError, match="element 2 has the corners of element 0"):
        block({"s": {"nodes": [0]}}, elements=elements).run()


def test_explain_counts_the_sets_that_are_used():
    scene = block(SETS).add("load", surface="a.left", pressure=1.0)
    scene.add_support("a.base.of.it", fix="y").add_support("a.left", fix="z")
    text = scene.explain()
    found = {each["name"]: each for each in text.data["sets"]}
    assert found["a.left"]["counts"] == {"faces": 1, "nodes": 4}
    assert found["a.left"]["keys"] == ["support[1].set", "load[0].surface"]
    assert found["a.base.of.it"]["counts"] == {"nodes": 1}
    assert "set a.base.of.it: 1 node; support[0].set" in text


def test_a_scene_with_sets_is_copied_and_saved(tmp_path):
    scene = block(SETS).add("load", surface="a.left", pressure=1.0)
    scene.save(tmp_path / "block.toml")
    want = scene.run(output=False).state["a"].displacement
    others = [copy.deepcopy(scene), pickle.loads(pickle.dumps(scene))]
    others += [ct.Scene(scene.data), ct.Scene.load(tmp_path / "block.toml")]
    for other in others:
        assert (other.run(output=False).state["a"].displacement == want).all()


def test_a_mesh_keeps_its_sets_in_a_pickle():
    mesh = Mesh.box("hex8", (0, 0, 0), (2, 1, 1), (2, 1, 1))
    sets = Sets.read({"faces": {"left": [[0, 0]]}}, len(mesh.nodes), len(mesh.elements))
    mesh = Mesh.copy(np.ascontiguousarray(mesh.nodes), np.ascontiguousarray(mesh.elements), sets)
    left = pickle.loads(pickle.dumps(mesh)).face_nodes("left")
    assert left.tolist() == mesh.face_nodes("x_min").tolist()


# Sets of a mesh file. The readers of the formats have their own tests; here a file is what they return.


def mesh_data():
    mesh = Mesh.box("hex8", (0, 0, 0), (2, 1, 1), (2, 1, 1))
    return meshes.MeshData(
        np.array(mesh.nodes),
        np.array(mesh.elements),
        {"corner": np.array([0])},
        {"left": np.array([[0, 0]]), "none": np.empty((0, 2), int)},
        {"all": np.arange(len(mesh.elements))},
        None,
    )


@pytest.fixture
def file(monkeypatch):
    """A scene whose mesh is in a file, and the file's content with the arguments of its reader."""
    held = {"data": mesh_data()}

    class File(meshes.MeshFile):
        def __init__(self, path):
            self._taken = []

        def bricks(self, part, scale, extrude):
            held.update(part=part, scale=scale, extrude=extrude)
            return held["data"]

    monkeypatch.setattr(problem, "MeshFile", File)
    body = {"name": "a", "material": "soft", "mesh": "block.msh"}
    scene = {
        "units": METRES,
        "material": [{"name": "soft", "young": 1.0, "poisson": 0.2, "density": 1.0}],
        "body": [body],
        "load": [{"surface": "a.left", "pressure": 1.0}],
        "time": {"end": 1.0},
    }
    return scene, held


def test_sets_of_a_file_are_surfaces(file):
    scene, held = file
    scene["body"][0] |= {"part": "all", "scale": 2.0, "extrude": {"height": 3.0, "layers": 2}}
    scene["support"] = [{"set": "a.corner", "fix": ["x"]}]
    found = ct.Scene(scene).run(output=False).state["a"].displacement
    want = block(SETS | {"corner": {"nodes": [0]}}).add("load", surface="a.x_min", pressure=1.0)
    want.add_support("a.corner", fix="x")
    assert (found == want.run(output=False).state["a"].displacement).all()
    assert [held[key] for key in ("part", "scale", "extrude")] == [
        "all",
        2.0,
        (1.5, 2),
    ]  # in the file's units


@pytest.mark.parametrize(
    "name, reason",
    [
        ("lfet", 'body "a" of "block.msh" has no face or set "lfet"; did you mean "left"?'),
        ("corner", 'body "a" of "block.msh" has no set of faces "corner"; this is a set of nodes'),
        ("none", 'has no faces: the set is empty in body "a" of "block.msh"'),
    ],
)
def test_a_wrong_set_of_a_file_is_refused_with_the_file(file, name, reason):
    scene, _ = file
    scene["load"][0]["surface"] = f"a.{name}"
    with pytest.raises(ct.SceneError) as error:
        ct.Scene(scene).run()
    assert error.value.key == "load[0].surface" and reason in error.value.reason


def test_a_wrong_element_of_a_file_is_named_with_the_file(file):
    scene, held = file
    held["data"].elements[1] = np.roll(held["data"].elements[1], 4)  # upside down
    with pytest.raises(ct.SceneError, match='body "a" of "block.msh": element 1 is inverted'):
        ct.Scene(scene).run()


@pytest.mark.parametrize("key", ["part", "scale", "extrude"])
def test_keys_of_a_mesh_file_need_one(file, key):
    scene, _ = file
    given = {"part": "all", "scale": 2.0, "extrude": {"height": 1.0}}[key]
    box = {"size": [1, 1, 1], "cells": [1, 1, 1]}
    scene["body"] = [{"name": "a", "material": "soft", "box": box, key: given}]
    scene["load"] = []
    with pytest.raises(ct.SceneError, match='it belongs to "mesh"'):
        ct.Scene(scene)


@pytest.mark.skipif(not ct.has("hdf5"), reason="no HDF5")
@pytest.mark.parametrize("what", ["node", "elements", "sets", "nothing"])
def test_a_run_goes_on_only_with_the_mesh_that_it_had(file, what, tmp_path):
    scene, held = file
    path, changed = tmp_path / "first.vtkhdf", mesh_data()
    scene["output"] = {"file": str(path)}
    ct.Scene(scene).run()
    if what == "node":
        changed.nodes[1, 0] *= 1.0 + 1e-15
    elif what == "elements":
        changed.elements[1] = changed.elements[1][[1, 2, 3, 0, 5, 6, 7, 4]]  # its axes turned
    elif what == "sets":
        changed.face_sets["left"] = np.array([[0, 2]])
    held["data"] = changed
    scene["time"]["end"], scene["output"]["file"] = 2.0, str(tmp_path / "second.vtkhdf")
    if what == "nothing":
        assert ct.Scene(scene).run(restart=path).time[-1] == 2.0
        with h5py.File(path) as found:
            assert found["libcontact/body"]["elements"][0] != 0
        return
    with pytest.raises(ct.SceneError, match="belongs to another problem") as error:
        ct.Scene(scene).run(restart=path)
    assert error.value.key == "restart"
    assert 'the mesh file "block.msh" has changed since then' in error.value.reason


# A file of Abaqus: a bar of four bricks along x, 1, 2 brass and 3, 4 steel.
BAR = """*NODE
{nodes}
*ELEMENT, TYPE=C3D8R, ELSET=BAR
{elements}
*ELSET, ELSET=HUB
1, 2
*ELSET, ELSET=RIM
3, 4
*NSET, NSET=CORNER
1
*SURFACE, NAME=FRONT, TYPE=ELEMENT
4, S4
"""
SCENE = """
units = {length = "mm", mass = "t", time = "s"}
material = [
  {name = "steel", young = 2.0e5, poisson = 0.0, density = 8e-9},
  {name = "brass", young = 1.0e5, poisson = 0.0, density = 8e-9},
]
[[body]]
name = "bar"
mesh = "bar.inp"
scale = 1000.0
material = {RIM = "steel", HUB = "brass"}
[[support]]
set = "bar.x_min"
fix = ["x", "y", "z"]
[[load]]
surface = "bar.FRONT"
pressure = -100.0
[damping]
relaxation = true
[time]
end = 1.0
until_static = 1e-8
"""


def test_from_a_file_with_sets_and_materials_to_a_result(tmp_path):
    """20 lines: the ends move by σ Σ l / E = 100 (2000 / 1e5 + 2000 / 2e5) mm."""
    mesh = Mesh.box("hex8", (0, 0, 0), (4, 1, 1), (4, 1, 1))
    nodes = [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(mesh.nodes.tolist(), 1)]
    cells = [", ".join(map(str, [e + 1, *(n + 1)])) for e, n in enumerate(mesh.elements)]
    text = BAR.format(nodes="\n".join(nodes), elements="\n".join(cells))
    (tmp_path / "bar.inp").write_text(text)
    (tmp_path / "bar.toml").write_text(SCENE)
    run = ct.Scene.load(tmp_path / "bar.toml").run(output=False)
    end = run.state["bar"].displacement[mesh.nodes[:, 0] == 4.0, 0]
    assert np.abs(end - 3.0).max() < 1e-5


def test_two_bodies_of_one_file_meet_at_their_sets(tmp_path):
    """Its two halves as bodies, which the load presses against each other, held at the other end."""
    mesh = Mesh.box("hex8", (0, 0, 0), (4, 1, 1), (4, 1, 1))
    nodes = [f"{i}, {x}, {y}, {z}" for i, (x, y, z) in enumerate(mesh.nodes.tolist(), 1)]
    cells = [", ".join(map(str, [e + 1, *(n + 1)])) for e, n in enumerate(mesh.elements)]
    text = BAR.format(nodes="\n".join(nodes), elements="\n".join(cells))
    ends = "*SURFACE, NAME=MEET, TYPE=ELEMENT\n2, S4\n3, S6\n"
    (tmp_path / "bar.inp").write_text(text + ends)
    scene = ct.Scene(units=METRES, file=tmp_path / "bar.toml")
    scene.add_material("soft", young=1.0, poisson=0.0, density=1.0)
    for name, part in (("hub", "HUB"), ("rim", "RIM")):
        scene.add_body(name, material="soft", mesh="bar.inp", part=part)
    scene.add_contact("hub.MEET", "rim.MEET").add_support("hub.x_min", fix="xyz")
    scene.add("load", surface="rim.FRONT", pressure=0.01)
    scene.add("damping", relaxation=True).set_time(end=1e4, until_static=1e-8)
    found = scene.run(output=False)
    assert np.abs(found.state["hub"].stress[:, 0] + 0.01).max() < 1e-8
    assert np.abs(found.state["rim"].stress[:, 0] + 0.01).max() < 1e-8
    with pytest.raises(ct.SceneError, match='has no face or set "FRONT"'):
        scene.add("load", surface="hub.FRONT", pressure=0.01).explain()
