"""Scenes: reading, refusing, building, explaining. test_run.py tests the results of runs."""

import copy
import dataclasses
import math
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from commands import captured
from libcontact.mesh import Mesh
from libcontact.meshes import read_mesh
from libcontact.schema import Place, Rows, SceneError
from libcontact.units import Units
from scenes import EDGES, MILLIMETRES, STEEL, box_of, scene_with

import libcontact as ct

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"
CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)


def small(**changes):
    """Two small plates of steel, in mm, t, s."""
    plate = {"size": [2.5, 0.5, 2.5], "cells": [4, 1, 3]}
    scene = {
        "title": "small plates",
        "units": MILLIMETRES,
        "material": [STEEL],
        "body": [
            {
                "name": "left",
                "box": {"origin": [-2.5, 0, 0], **plate},
                "element": "hex8",
                "material": "steel",
                "velocity": [1000, 0, 0],
            },
            {
                "name": "right",
                "box": {"origin": [0, 0, 0], **plate},
                "element": "hex8",
                "material": "steel",
                "velocity": [-1000, 0, 0],
            },
        ],
        "contact": [{"surfaces": ["left.x_max", "right.x_min"], "beta": 4}],
        "support": [{"set": "left.z_min", "fix": ["z"]}, {"set": "right.z_min", "fix": ["z"]}],
        "time": {"end": 2e-7, "courant": 0.125},
        "output": {"fields": ["displacement", "stress"], "every": 5},
    }
    scene.update(changes)
    return scene


def changed(path, value=None, drop=False):
    """A small scene with one entry replaced or dropped; ``path`` is like ``("body", 1, "material")``."""
    scene = copy.deepcopy(small())
    table = scene
    for step in path[:-1]:
        table = table[step]
    if drop:
        del table[path[-1]]
    else:
        table[path[-1]] = value
    return scene


def refused(scene, run=False):
    """The error of a scene that must be refused when it is read, or (``run``) at the latest when it is explained."""
    with pytest.raises(SceneError) as caught:
        made = ct.Scene(scene)
        assert run, "accepted when read"
        made.explain()
    return caught.value


# Units.


@pytest.mark.parametrize(
    "bases, stress, energy",
    [
        (("mm", "t", "s"), "MPa", "mJ"),
        (("m", "kg", "s"), "Pa", "J"),
        (("mm", "kg", "ms"), "GPa", "J"),
        (("mm", "g", "ms"), "MPa", "mJ"),
        (("um", "kg", "s"), "MPa", "kg um^2/s^2"),
        (("cm", "g", "us"), "g/(cm us^2)", "g cm^2/us^2"),
        (("in", "slinch", "s"), "slinch/(in s^2)", "slinch in^2/s^2"),
    ],
)
def test_labels_of_derived_units(bases, stress, energy):
    units = Units(*bases)
    assert units.label("stress") == stress
    if energy != "kg um^2/s^2":
        assert units.label("energy") == energy


def test_a_slinch_per_square_inch_makes_a_psi():
    # 1 psi = 1 lbf / in^2 = 6894.757293168361 Pa (NIST SP 811).
    assert Units("in", "slinch", "s").factor("stress") == pytest.approx(
        6894.757293168361, rel=1e-12
    )


# Reading and writing.


@pytest.mark.parametrize("name", ["plates.toml", "plates_reference.toml"])
def test_saved_scene_has_the_same_tables(name, tmp_path):
    scene = ct.Scene.load(SCENES / name)
    scene.save(tmp_path / "copy.toml")
    assert tomllib.loads((tmp_path / "copy.toml").read_text()) == tomllib.loads(
        (SCENES / name).read_text()
    )


def test_plates_are_those_of_the_paper():
    facts = ct.Scene.load(SCENES / "plates.toml").explain().data
    assert [body["elements"] for body in facts["bodies"]] == [10000, 10000]
    assert [body["nodes"] for body in facts["bodies"]] == [101 * 2 * 101] * 2
    c1 = math.sqrt(2.1e11 * 0.7 / (1.3 * 0.4 * 7800.0))
    assert facts["bodies"][0]["c1_si"] == pytest.approx(c1, rel=1e-12)
    assert facts["time"]["end"] == pytest.approx(0.56 * 2.5e-3 / c1, rel=1e-12)
    assert facts["time"]["courant"] == pytest.approx(0.125, rel=0.01) and facts["time"][
        "courant"
    ] <= 0.125 * (1 + 1e-12)
    # c1 t / h = 0.56 * 100 cells, in steps of 0.125 cells.
    assert facts["time"]["steps"] in (448, 449)


def test_the_scene_that_is_built_piece_by_piece_is_the_one_that_is_read():
    box = lambda x: box_of((x, 0, 0), np.array([2.5, 0.5, 2.5]), np.array([4, 1, 3]))
    scene = scene_with(**STEEL, units=MILLIMETRES, title="small plates")
    scene.add_body("left", box=box(-2.5), element="hex8", material="steel", velocity=[1000, 0, 0])
    scene.add_body(
        "right", box=box(0), element="hex8", material="steel", velocity=np.array([-1000, 0, 0])
    )
    scene.add_contact("left.x_max", "right.x_min", beta=4)
    scene.add_support("left.z_min", fix="z").add_support("right.z_min", fix=["z"])
    scene.set_time(end=2e-7, courant=0.125).set_output(fields=["displacement", "stress"], every=5)
    assert scene.data == ct.Scene(small()).data


def test_a_scene_without_time_says_so_when_it_is_used():
    scene = scene_with("rubber", young=1e6, poisson=0.4, density=1000.0)
    scene.add_body("block", box={"size": [1, 1, 1], "cells": [1, 1, 1]}, material="rubber")
    with pytest.raises(SceneError, match="time: is missing"):
        scene.explain()


def test_changing_the_copy_of_the_data_changes_nothing():
    scene = ct.Scene(small())
    scene.data["time"]["courant"] = 99.0
    assert scene.data["time"]["courant"] == 0.125


def test_arrays_survive_saving_bit_for_bit(tmp_path):
    nodes = CUBE * 0.1 + 1.0 / 3.0
    body = {"name": "cube", "nodes": nodes, "elements": np.arange(8)[None], "material": "steel"}
    ct.Scene(small(body=[body], contact=[], support=[])).save(tmp_path / "cube.toml")
    table = ct.Scene.load(tmp_path / "cube.toml").data["body"][0]
    assert table["nodes"].tobytes() == nodes.tobytes()
    assert table["elements"].tolist() == [list(range(8))]


# Refusals while reading.

REFUSED = [
    (("bodi",), [], "bodi", 'did you mean "body"'),
    (("tmie",), {}, "tmie", 'did you mean "time"'),
    (
        ("body", 0, "box", "cells"),
        2,
        "body[0].box.cells",
        "a list of 3: numbers of elements along x, y and z",
    ),
    (
        ("body", 0),
        {"name": "a", "material": "steel", "mesh": {"file": "a.msh"}},
        "body[0].mesh",
        "must be the name of a file, in quotes",
    ),
    (("units",), {"length": "mm", "mass": "t"}, "units.time", "is missing"),
    # Of a key that is unknown and one that is missing, the unknown one tells what was meant.
    (("support",), [{"surface": "left.x_min", "fix": ["x"]}], "support[0].surface", "belongs to"),
    (("support",), [{"sets": "left.x_min", "fix": ["x"]}], "support[0].sets", 'mean "set"'),
    (("units", "length"), "furlong", "units.length", "unknown"),
    (("units", "mass"), "k", "units.mass", "unknown"),
    (("units", "length"), True, "units.length", "boolean true"),
    (("material", 0, "poisson"), 0.5, "material[0].poisson", "below 0.5"),
    (("material", 0, "poisson"), -1, "material[0].poisson", "above -1"),
    (("material", 0, "density"), -7.8e-9, "material[0].density", "above 0"),
    (("material", 0, "density"), 0, "material[0].density", "above 0"),
    (("material", 0, "young"), "2.1e5", "material[0].young", "must be a number"),
    (("material", 0, "young"), True, "material[0].young", "boolean"),
    (("material", 0, "young"), math.nan, "material[0].young", "finite"),
    (("material", 0, "young"), 10**400, "material[0].young", "finite"),
    (("material", 0, "yuong"), 1.0, "material[0].yuong", 'did you mean "young"'),
    (("body", 1, "material"), "stel", "body[1].material", 'did you mean "steel"'),
    (("body", 1, "name"), "left", "body[1].name", "twice"),
    (("body", 1, "name"), "x" * 64, "body[1].name", "64 bytes"),
    (("body", 1, "name"), " right", "body[1].name", "no name"),
    (("body", 0, "element"), "hex27", "body[0].element", "unknown"),
    (("body", 0, "lumping"), "rowsum", "body[0].lumping", 'did you mean "row_sum"'),
    (("body", 0, "kernel"), "fast", "body[0].kernel", "unknown"),
    (("body", 0, "mesh"), "a.vtkhdf", "body[0].mesh", "exactly one"),
    (("body", 0, "elements"), [[0]], "body[0].elements", '"nodes"'),
    (("body", 0, "velocity"), [1, 2], "body[0].velocity", "must have 3"),
    (("body", 0, "velocity"), [1, 2, "3"], "body[0].velocity[2]", "number"),
    (("body", 0, "box", "cells"), [4, 1, 0], "body[0].box.cells[2]", "at least 1"),
    (("body", 0, "box", "cells"), [4, 1, 2.0], "body[0].box.cells[2]", "whole number"),
    (("body", 0, "box", "cells"), [True, 1, 1], "body[0].box.cells[0]", "boolean"),
    (("body", 0, "box", "size"), [1, -1, 1], "body[0].box.size[1]", "above 0"),
    (("body", 0, "box", "layers"), "w", "body[0].box.layers", "unknown"),
    (("body", 0, "box", "sizes"), [1, 1, 1], "body[0].box.sizes", 'did you mean "size"'),
    (("body", 0), 7, "body[0]", "table"),
    (("body",), {}, "body", "[[body]]"),
    (("body",), [], "contact[0].surfaces[0]", "no body"),
    (
        ("contact", 0, "surfaces"),
        ["left.x_max", "right.x_mni"],
        "contact[0].surfaces[1]",
        'did you mean "x_min"',
    ),
    (
        ("contact", 0, "surfaces"),
        ["lfet.x_max", "right.x_min"],
        "contact[0].surfaces[0]",
        'did you mean "left"',
    ),
    (("contact", 0, "surfaces"), ["left", "right.x_min"], "contact[0].surfaces[0]", "dot"),
    (("contact", 0, "surfaces"), "left.x_max", "contact[0].surfaces", "list"),
    (("contact", 0, "beta"), 0, "contact[0].beta", "above 0"),
    (("contact", 0, "epsilon"), 1e6, "contact[0].epsilon", "exactly one"),
    (("contact", 0, "method"), "simplx", "contact[0].method", 'did you mean "simplex"'),
    (("support", 0, "set"), "left.z", "support[0].set", "no face"),
    (("support", 0, "fix"), [], "support[0].fix", "empty"),
    (("support", 0, "fix"), ["w"], "support[0].fix[0]", '"x", "y" or "z"'),
    (("support", 0, "fix"), ["z", "z"], "support[0].fix[1]", "twice"),
    (("support", 0, "velocity"), [1, 0, 0], "support[0].velocity[0]", "not in fix"),
    (("time", "fraction"), 0.5, "time.fraction", "exactly one"),
    (("time", "end_c1t_over"), {"length": 1, "value": 1}, "time.end_c1t_over", "exactly one"),
    (("time", "courant"), 0, "time.courant", "above 0"),
    (("time", "integrator"), "newmark", "time.integrator", "unknown"),
    (("output", "every"), 0, "output.every", "at least 1"),
    (("output", "times"), [1e-7], "output.times", "exactly one"),
    (("output", "fields"), ["displacment"], "output.fields[0]", 'did you mean "displacement"'),
    (("output", "file"), "", "output.file", "no file name"),
    (("run",), {"threads": 0}, "run.threads", "at least 1"),
    (
        ("time", "friction"),
        0.3,
        "time.friction",
        '"friction" belongs to [[contact]] or [[obstacle]]',
    ),
    (("end",), 1.0, "end", '"end" belongs to [time]'),
    (("run",), {"thread": 1}, "run.thread", 'did you mean "threads"'),
    (("title",), "\ud800", "title", "Unicode"),
    (("body", 0, "lumping"), None, "body[0].lumping", "leave the key out"),
]


@pytest.mark.parametrize("path, value, key, reason", REFUSED)
def test_a_wrong_entry_is_refused_with_key_and_reason(path, value, key, reason):
    error = refused(changed(path, value))
    assert error.key == key
    assert reason in error.reason
    assert str(error).startswith(f"scene: {key}: ")


def test_a_table_under_the_name_of_others_is_told_by_its_keys():
    data = small()
    data["tie"] = data.pop("time")
    assert refused(data).reason == 'is a table with the keys of "time"; is that meant?'
    own = refused(small(tie={"surfaces": ["left.x_max", "right.x_min"]}))
    assert (own.key, own.reason) == (
        "tie",
        "is a table; it must be an array of tables, written [[tie]]",
    )


@pytest.mark.parametrize(
    "path, key",
    [
        (("units",), "units"),
        (("time",), "time"),
        (("time", "end"), "time"),
        (("material", 0, "density"), "material[0].density"),
        (("material",), "body[0].material"),
        (("body", 0, "name"), "body[0].name"),
        (("body", 0, "box"), "body[0]"),
        (("body", 0, "box", "cells"), "body[0].box.cells"),
        (("contact", 0, "surfaces"), "contact[0].surfaces"),
        (("support", 0, "fix"), "support[0].fix"),
    ],
)
def test_a_missing_entry_is_refused_with_its_key(path, key):
    assert refused(changed(path, drop=True)).key == key


def test_the_file_is_named(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text(
        (SCENES / "plates.toml").read_text().replace('material = "steel"', 'material = "stone"')
    )
    with pytest.raises(SceneError) as caught:
        ct.Scene.load(file)
    assert caught.value.file == str(file)
    assert str(caught.value).startswith(f"{file}:16: body[0].material: ")


@pytest.mark.parametrize(
    "content", [b"title = ", b"\xff\xfe", b"a = " + b"[" * 100000, b"x = " + b"9" * 5000, b""]
)
def test_files_that_are_no_scenes_are_refused(content, tmp_path):
    file = tmp_path / "scene.toml"
    file.write_bytes(content)
    with pytest.raises(SceneError) as caught:
        ct.Scene.load(file)
    assert str(file) in str(caught.value)


def test_results_and_scenes_in_each_others_place_are_named(tmp_path):
    results, scene = tmp_path / "out.vtkhdf", tmp_path / "scene.toml"
    results.write_bytes(b"\x89HDF\r\n\x1a\n")
    scene.write_text("[units]\n")
    with pytest.raises(SceneError, match="out.vtkhdf: can't be read: no text in UTF-8"):
        ct.Scene.load(results)
    with pytest.raises(ValueError, match='scene.toml": no HDF5 file'):
        ct.Run.load(scene)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    for path in (tmp_path / "none.toml", tmp_path):
        with pytest.raises(SceneError, match="can't be read"):
            ct.Scene.load(path)


# Refusals: arrays and meshes.


def cube(nodes, elements=None):
    elements = np.arange(8)[None] if elements is None else elements
    body = {"name": "cube", "nodes": nodes, "elements": elements, "material": "steel"}
    return small(body=[body], contact=[], support=[])


@pytest.mark.parametrize("dtype", ["f4", ">f8", "f2", "i4", "u1", "f8"])
def test_numbers_that_float64_holds_are_taken_by_value(dtype):
    # A float32 array read as doubles would be garbage of half the length.
    assert Rows(3).read(CUBE.astype(dtype), Place()).tolist() == CUBE.tolist()
    assert ct.Scene(cube(CUBE.astype(dtype))).explain().data["bodies"][0]["nodes"] == 8


def test_strided_arrays_are_taken_by_value():
    wide = np.full((16, 6), -1.0)
    wide[::2, ::2] = CUBE
    for strided in (wide[::2, ::2], np.asfortranarray(CUBE), CUBE[::-1][::-1]):
        out = Rows(3).read(strided, Place())
        assert out.flags.c_contiguous and out.tolist() == CUBE.tolist()


@pytest.mark.parametrize(
    "bad, reason",
    [
        (CUBE.astype(complex), "complex128"),
        (CUBE.astype(bool), "bool"),
        (CUBE.astype(str), "<U"),
        (CUBE.astype(object), "object"),
        (CUBE.astype(np.longdouble), "float128"),
        (CUBE[:, :2], "(8, 2)"),
        (CUBE[0], "(3,)"),
        ([[1, 2, 3], [4, 5]], "rectangular"),
        (np.full((8, 3), 2**53 + 1), "2^53"),
        ("nodes.csv", "must be an array"),
        ([], "empty"),
        (np.empty((0, 3)), "empty"),
    ],
)
def test_other_arrays_are_refused(bad, reason):
    error = refused(cube(bad))
    assert error.key == "body[0].nodes" and reason in error.reason


def test_a_nan_is_refused_with_its_node():
    nodes = CUBE.copy()
    nodes[5, 1] = math.nan
    error = refused(cube(nodes))
    assert error.key == "body[0].nodes" and "row 5" in error.reason


@pytest.mark.parametrize(
    "elements, reason",
    [
        (np.arange(8.0)[None], "float64"),
        (np.arange(1, 9)[None], "outside 0 ... 7"),
        (np.array([[-1, 1, 2, 3, 4, 5, 6, 7]]), "outside"),
        (np.arange(6)[None], "8 or 20"),
        (np.array([[2**40, 1, 2, 3, 4, 5, 6, 7]]), "outside"),
    ],
)
def test_impossible_node_numbers_are_refused(elements, reason):
    error = refused(cube(CUBE, elements))
    assert error.key == "body[0].elements" and reason in error.reason


def test_node_numbers_of_any_whole_type_are_taken():
    for dtype in ("i1", "u2", "i8", ">i4"):
        read = Rows(8, 20, whole=True).read(np.arange(8, dtype=dtype)[None], Place())
        assert read.dtype == np.int32


def test_inverted_and_collapsed_elements_are_named():
    inside_out = np.array([[4, 5, 6, 7, 0, 1, 2, 3]])
    error = refused(cube(CUBE, inside_out), run=True)
    assert (
        'body "cube"' in error.reason and "element 0" in error.reason and "inverted" in error.reason
    )
    flat = CUBE * [1, 1, 0]
    error = refused(cube(flat), run=True)
    assert (
        'body "cube"' in error.reason
        and "element 0" in error.reason
        and "collapsed" in error.reason
    )


def test_a_mid_side_node_beyond_the_quarter_point_is_refused():
    nodes = np.vstack([CUBE] + [0.5 * (CUBE[[a]] + CUBE[[b]]) for a, b in EDGES])
    number = np.arange(20)[None]
    nodes[18] = [1, 1, 0.75]  # at the quarter point seen from node 6: used for cracks
    assert ct.Scene(cube(nodes, number)).explain()
    nodes[18] = [1, 1, 0.8]
    error = refused(cube(nodes, number), run=True)
    assert (
        'body "cube"' in error.reason
        and "element 0 is inverted at its corner 6 (node 6)" in error.reason
    )


def test_a_node_without_element_is_refused():
    error = refused(cube(np.vstack([CUBE, [[9, 9, 9]]])), run=True)
    assert "node 8 belongs to no element" in error.reason


def test_a_face_that_no_element_has_is_refused():
    # A wedge-like brick whose highest x is an edge: there is no outer face in the plane x = 2.
    nodes = CUBE.copy()
    nodes[[1, 2], 0] = 2.0
    scene = cube(nodes)
    scene["body"].append({**small()["body"][1], "box": box_of([2, 0, 0], [1, 1, 1], [1, 1, 1])})
    scene["contact"] = [{"surfaces": ["cube.x_max", "right.x_min"]}]
    error = refused(scene, run=True)
    assert error.key == "contact[0].surfaces[0]" and "no faces" in error.reason


def test_what_c_refuses_has_the_key_of_its_table():
    held = [
        {"set": "left.x_min", "fix": ["x"]},
        {"set": "left.y_min", "fix": ["x"], "velocity": [1, 0, 0]},
    ]
    error = refused(small(support=held), run=True)
    assert error.key == "support[1]" and "velocity" in error.reason
    skew = cube(CUBE + 0.1 * CUBE[:, [1, 2, 0]])
    skew["body"][0]["kernel"] = "box"
    error = refused(skew, run=True)
    assert error.key == "body[0]" and "cube" in error.reason and "kernel" in error.reason
    assert refused(small(time={"end": 1e300, "courant": 0.1}), run=True).key == "time"


def test_a_collapsed_edge_does_not_count_in_the_courant_number():
    nodes = CUBE.copy()
    nodes[[2, 6]] = nodes[[1, 5]]
    wedge = cube(nodes)
    wedge["time"] = {"end": 2e-7, "fraction": 0.5}
    facts = ct.Scene(wedge).explain().data["time"]
    # The wedge of a unit cube: its shortest real edge is 1.
    c1 = ct.Scene(wedge).explain().data["bodies"][0]["c1"]
    assert (
        facts["courant"] == pytest.approx(c1 * facts["dt"], rel=1e-12)
        and 0 < facts["fraction"] <= 0.5
    )


def test_what_does_not_fit_the_machine_is_refused_before_it_is_tried():
    error = refused(changed(("body", 0, "box", "cells"), [10**6, 10**6, 10**6]), run=True)
    assert error.key == "body[0].box.cells" and "GB" in error.reason


def test_a_mesh_file_must_be_there(tmp_path):
    scene = changed(("body", 0, "mesh"), str(tmp_path / "none.vtkhdf"))
    del scene["body"][0]["box"]
    error = refused(scene, run=True)
    assert error.key == "body[0].mesh" and "no such file" in error.reason


# Meshes.


def write_grid(path, nodes, elements, cell_type, **changes):
    """A static VTKHDF grid, as VTK's own writer lays it out."""
    h5py = pytest.importorskip("h5py")
    with h5py.File(path, "w") as file:
        group = file.create_group("VTKHDF")
        group.attrs["Version"] = np.array([2, 2])
        group.attrs["Type"] = np.bytes_("UnstructuredGrid")
        width = elements.shape[1]
        grid = {
            "NumberOfPoints": [len(nodes)],
            "NumberOfCells": [len(elements)],
            "NumberOfConnectivityIds": [elements.size],
            "Points": nodes,
            "Connectivity": elements.ravel(),
            "Offsets": width * np.arange(len(elements) + 1),
            "Types": np.full(len(elements), cell_type, np.uint8),
            **changes,
        }
        for name, values in grid.items():
            group[name] = np.asarray(values)


def test_a_mesh_is_read_from_beside_the_scene_file_and_found_from_elsewhere(tmp_path):
    write_grid(tmp_path / "cube.vtkhdf", CUBE.astype("f4"), np.arange(8)[None], 12)
    table = small(
        body=[{"name": "cube", "mesh": "cube.vtkhdf", "material": "steel"}], contact=[], support=[]
    )
    ct.Scene(table, file=tmp_path / "scene.toml").save(tmp_path / "scene.toml")
    facts = ct.Scene.load(tmp_path / "scene.toml").explain().data["bodies"][0]
    assert (facts["nodes"], facts["elements"], facts["element"]) == (8, 1, "hex8")
    (tmp_path / "deep").mkdir()
    ct.Scene.load(tmp_path / "scene.toml").save(tmp_path / "deep" / "scene.toml")
    assert ct.Scene.load(tmp_path / "deep" / "scene.toml").explain().data["bodies"][0]["nodes"] == 8


def test_grids_that_are_no_bricks_are_refused(tmp_path):
    path = tmp_path / "grid.vtkhdf"
    for kind, changes, reason in [
        (42, {}, "VTK types"),
        (12, {"Offsets": [0, 7]}, "Offsets"),
        (12, {"NumberOfPoints": [4, 4]}, "2 parts"),
    ]:
        write_grid(path, CUBE, np.arange(8)[None], kind, **changes)
        with pytest.raises(ValueError, match=reason):
            read_mesh(path)


@pytest.mark.parametrize(
    "element, count", [("hex8", 3 * 4 * 5), ("hex20", 60 + 2 * 4 * 5 + 3 * 3 * 5 + 3 * 4 * 4)]
)
def test_a_box_has_the_nodes_and_faces_that_one_counts(element, count):
    mesh = Mesh.box(element, (0, 0, 0), (2, 3, 4), (2, 3, 4))
    assert mesh.nodes.shape == (count, 3) and len(mesh.elements) == 24
    assert len(mesh.faces("outer")[0]) == 2 * (2 * 3 + 3 * 4 + 2 * 4)
    assert len(mesh.faces("y_max")[0]) == 8 and np.all(mesh.nodes[mesh.faces("y_max")[0], 1] == 3.0)
    assert mesh.shortest_edge == 1.0
    i, j, k = np.unravel_index(np.arange(24), (4, 3, 2))[::-1]
    assert np.array_equal(mesh.centres(), np.stack([i, j, k], axis=1) + 0.5)


def test_views_of_a_mesh_are_read_only_and_outlive_it():
    mesh = Mesh.box("hex8", (0, 0, 0), (1, 1, 1), (1, 1, 1))
    nodes = mesh.nodes
    with pytest.raises(ValueError):
        nodes[0, 0] = 1.0
    with pytest.raises(ValueError):
        nodes.flags.writeable = True
    before = nodes.copy()
    del mesh
    rubbish = [Mesh.box("hex8", (7, 7, 7), (1, 1, 1), (1, 1, 1)) for _ in range(50)]
    assert np.array_equal(nodes, before) and rubbish


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_points_are_found_in_distorted_elements(element):
    # Bend a box by a smooth map; the images of points of an element must be found in it.
    box = Mesh.box(element, (-1, -1, -1), (2, 2, 2), (2, 2, 2))
    x, y, z = box.nodes.T
    mesh = Mesh.copy(
        np.stack([x + 0.2 * y * z, y + 0.1 * x * x, z + 0.15 * x * y], axis=1),
        np.array(box.elements),
    )
    rng = np.random.default_rng(7)
    put_in, put_xi = rng.integers(0, 8, 40), rng.uniform(-0.99, 0.99, (40, 3))
    points = np.array(
        [mesh.shape(xi) @ mesh.nodes[mesh.elements[e]] for e, xi in zip(put_in, put_xi)]
    )
    found_in, found_xi = mesh.locate(points)
    assert np.array_equal(found_in, put_in)
    assert np.abs(found_xi - put_xi).max() < 1e-12
    assert mesh.locate(np.array([[9.0, 0, 0]]))[0][0] == -1


def test_mirrored_meshes_have_mirrored_centres():
    for element in ("hex8", "hex20"):
        right = Mesh.box(element, (0, 0, 0), (0.7, 0.3, 0.9), (7, 1, 3))
        left = Mesh.box(element, (-0.7, 0, 0), (0.7, 0.3, 0.9), (7, 1, 3))
        mirrored = left.centres().reshape(3, 1, 7, 3)[:, :, ::-1] * [-1, 1, 1]
        assert np.array_equal(mirrored.reshape(-1, 3), right.centres())


# Explaining.


def test_explain_tells_what_was_asked_and_what_is_left_out():
    text = ct.Scene(small(contact=[])).explain()
    assert isinstance(text, str) and "contact: no [[contact]]" in text
    assert text.data["effects"] == ["solid", "support"] and {"contact", "gravity"} <= set(
        text.data["left_out"]
    )
    assert "beta = 4" in ct.Scene(small()).explain()
    default = small(contact=[{"surfaces": ["left.x_max", "right.x_min"]}])
    assert "(the default)" in ct.Scene(default).explain()


def test_the_penalty_is_beta_young_over_the_shortest_edge():
    contact = ct.Scene(small()).explain().data["contacts"][0]
    assert contact["epsilon"] == pytest.approx(4 * 2.1e5 / 0.5, rel=1e-14)
    assert contact["faces"] == [3, 3] and contact["gauss_points"] == [12, 12]


def test_time_needs_only_an_end():
    """By default the step is at most 0.9 of the stable one, in as few steps as possible."""
    made = ct.Scene(small(time={"end": 2e-7}))
    chosen, stable = (
        made.explain().data["time"],
        ct.Scene(small(time={"end": 2e-7, "fraction": 1.0})),
    )
    limit = stable.explain().data["time"]
    largest = 0.9 * limit["dt"] / limit["fraction"]
    assert chosen["steps"] == math.ceil(2e-7 / largest * (1 - 1e-12))
    assert chosen["asked"] == {"fraction": 0.9} and 0.8 < chosen["fraction"] <= 0.9
    assert made.data["time"] == {"end": 2e-7}
    by_name = ct.Scene(small(time={"end": 2e-7, "fraction": 0.9})).run()
    plain = made.run()
    assert plain.dt == by_name.dt
    assert np.array_equal(plain.state["left"].displacement, by_name.state["left"].displacement)


@pytest.mark.parametrize("pair", [("courant", "fraction"), ("fraction", "dt"), ("courant", "dt")])
def test_two_steps_are_refused(pair):
    time = {"end": 2e-7, **dict.fromkeys(pair, 1e-9)}
    assert refused(small(time=time)).key in {f"time.{name}" for name in pair}


def test_both_step_numbers_are_told_whichever_was_asked():
    by_courant = ct.Scene(small()).explain().data["time"]
    wanted = by_courant["dt_courant"] * 0.125
    assert by_courant["dt"] == pytest.approx(2e-7 / math.ceil(2e-7 / wanted), rel=1e-12)
    by_fraction = (
        ct.Scene(small(time={"end": 2e-7, "fraction": by_courant["fraction"] * (1 + 1e-9)}))
        .explain()
        .data["time"]
    )
    assert by_fraction["steps"] == by_courant["steps"] and by_fraction["courant"] == pytest.approx(
        by_courant["courant"]
    )
    assert by_courant["stable"] == by_courant["stable_without_contact"], (
        "the energy-controlled penalty leaves the step as it is"
    )
    data = small()
    data["contact"][0]["enforcement"] = "penalty"
    explicit = ct.Scene(data).explain().data["time"]
    assert explicit["stable"] < explicit["stable_without_contact"] == by_courant["stable"]
    # h / c1 in closed form: the shortest edge is 0.5 mm.
    c1 = math.sqrt(2.1e5 * 0.7 / (1.3 * 0.4 * 7.8e-9))
    assert by_courant["dt_courant"] == pytest.approx(0.5 / c1, rel=1e-12)


def test_a_step_above_the_stable_one_is_refused_with_both_numbers():
    stable = ct.Scene(small()).explain().data["time"]["stable"]
    error = refused(small(time={"end": 2e-7, "dt": 1.5e-7}), run=True)
    assert (
        error.key == "time.dt" and "1.5e-07" in error.reason and f"{stable:g}"[:4] in error.reason
    )
    assert refused(small(time={"end": 2e-7, "fraction": 1.01}), run=True).key == "time.fraction"
    assert refused(small(time={"end": 2e-7, "courant": 5.0}), run=True).key == "time.courant"


def test_inconsistent_units_show_at_once():
    wrong = changed(("material", 0, "density"), 7800.0)
    text = ct.Scene(small(material=wrong["material"], time={"end": 1e-1, "courant": 0.1})).explain()
    assert text.data["warnings"] and "consistent" in text
    wrong = changed(("material", 0, "density"), 7.8e-6)  # kg/mm³: waves seem possible, 190 m/s
    text = ct.Scene(small(material=wrong["material"])).explain()
    assert "the density 7.8e+06 kg/m³ is above 30000 kg/m³; are young, density" in text


# The page about the scene file.

PAGE = Path(__file__).parents[2] / "docs" / "theory" / "scene.rst"


def blocks(language):
    """The code blocks of the page in one language, without their indent."""
    found, inside = [], False
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith(f".. code-block:: {language}"):
            found.append([])
            inside = True
        elif inside and line and not line.startswith("   "):
            inside = False
        elif inside:
            found[-1].append(line[3:])
    return ["\n".join(lines) for lines in found]


def test_the_python_of_the_page_runs(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = (
        (SCENES / "plates.toml").read_text(encoding="utf-8").replace("[100, 1, 100]", "[10, 1, 10]")
    )
    Path("plates.toml").write_text(text.split("[output]")[0], encoding="utf-8")
    names = {}
    for block in blocks("python"):
        exec(block, names)
    assert "left: 100 hex8" in capsys.readouterr().out
    assert names["other"].data["contact"][0]["beta"] == 10 and names["stress"].shape == (401,)


def test_the_error_of_the_page_is_the_error_that_comes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (SCENES / "plates.toml").read_text(encoding="utf-8")
    before, after = text.rsplit('material = "steel"', 1)
    Path("plates.toml").write_text(before + 'material = "stel"' + after, encoding="utf-8")
    with pytest.raises(SceneError) as caught:
        ct.Scene.load("plates.toml")
    assert str(caught.value) == blocks("text")[0].strip()


def test_an_overlap_at_the_start_is_told():
    """The right block begins 0.1 inside the left one: explain warns of it."""
    scene = scene_with("soft", young=1.0, poisson=0.0, density=1.0, title="overlap")
    for name, origin in (("left", -1.0), ("right", -0.1)):
        scene.add_body(name, material="soft", box=box_of([origin, 0, 0], [1, 1, 1], [2, 2, 2]))
    scene.add_contact("left.x_max", "right.x_min", beta=1).set_time(end=1.0, fraction=0.5)
    facts = scene.explain().data
    assert facts["contacts"][0]["initial_gap"] == pytest.approx(-0.1, abs=1e-12)
    assert any("overlap by 0.1" in warning for warning in facts["warnings"])


def test_a_scene_file_is_not_overwritten_by_its_results(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(
        (SCENES / "plates_reference.toml").read_text().replace("[100, 1, 100]", "[4, 1, 4]")
    )
    before = path.read_bytes()
    with pytest.raises(ct.SceneError, match="not a results file"):
        ct.Scene.load(path).run(output=path)
    assert path.read_bytes() == before


def test_masked_nodes_are_refused():
    nodes = np.ma.array(CUBE, mask=False)
    nodes[3, 1] = np.ma.masked
    with pytest.raises(ct.SceneError, match="masked"):
        ct.Scene(cube(nodes)).explain()


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.toml")), ids=lambda path: path.stem)
def test_a_scene_of_the_tutorials_is_short_and_explained(path):
    assert len(path.read_text(encoding="utf-8").splitlines()) <= 40
    assert ct.Scene.load(path).explain().data["bodies"]
    shown = [file.read_text(encoding="utf-8") for file in SCENES.parent.glob("0*.py")]
    assert any(f'"{path.stem}"' in text for text in shown) or path.stem == "plates_reference"


def test_a_scene_is_read_without_planning_and_pictures():
    code = "import sys, libcontact as ct; ct.Scene.load(ct.example('plates')); print(*sys.modules)"
    out = captured([sys.executable, "-c", code], check=True)
    loaded = {name.split(".")[1] for name in out.stdout.split() if name.startswith("libcontact.")}
    assert "scene" in loaded and not loaded & {"planning", "pictures", "command"}


def test_a_table_that_was_read_stays_as_it_is():
    body = ct.Scene.load(ct.example("plates"))._parts.body[0]
    with pytest.raises(dataclasses.FrozenInstanceError, match="name"):
        body.name = "other"
    with pytest.raises(dataclasses.FrozenInstanceError, match="name"):
        del body.name
    assert body.name == "left" and repr(body).startswith(
        "Body(name='left', material='steel', box=Box("
    )
