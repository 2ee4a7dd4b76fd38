"""Optimisations of a scene: the same bits with and without all, in tables, states and files, and after a restart;
refusals. Random scenes: tests/c/test_optimisations_fuzz.c."""

import ctypes
import gc

import numpy as np
import pytest
from libcontact._core import ffi, lib
from libcontact.errors import check, new_error
from libcontact.problem import new_state
from libcontact.schema import SceneError
from scenes import MILLIMETRES, STEEL, box_of, same_state

import libcontact as ct

needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")


def scene(savings=None, threads=1, **changes):
    """Two different plates that approach each other over a gap, with supports and loads at some places."""
    plate = lambda x, cells: box_of([x, 0, 0], [2.0, 0.25, 1.5], cells)
    data = {
        "units": MILLIMETRES,
        "material": [STEEL],
        "body": [
            {
                "name": "left",
                "box": plate(-2.02, [16, 1, 12]),
                "material": "steel",
                "velocity": [1e5, 0, 0],
            },
            {
                "name": "right",
                "box": plate(0.0, [10, 2, 7]),
                "material": "steel",
                "velocity": [-3e4, 0, 0],
                "kernel": "general",
            },
        ],
        "contact": [{"surfaces": ["left.x_max", "right.x_min"], "beta": 0.5}],
        "support": [
            {"set": "left.z_min", "fix": ["z"]},
            {"set": "right.x_max", "fix": ["x"], "velocity": [-3e4, 0, 0]},
        ],
        "time": {"end": 5e-7, "fraction": 0.99},
        "output": {"every": 7, "fields": ["displacement", "velocity"]},
        "run": {"threads": threads},
    }
    if savings is not None:
        data["run"]["savings"] = savings
    data.update(changes)
    return ct.Scene(data)


def same_run(a, b):
    tables = (
        a.energy.tobytes() == b.energy.tobytes() and a.momentum.tobytes() == b.momentum.tobytes()
    )
    return tables and same_state(a, b)


@needs_hdf5
def test_files_and_restarts_have_the_same_bits(tmp_path):
    h5py = pytest.importorskip("h5py")
    runs = {}
    for name, first, then in (
        ("off", [], None),
        ("on", None, None),
        ("on and off", None, []),
        ("off and on", [], None),
    ):
        half, whole = tmp_path / f"{name} half.vtkhdf", tmp_path / f"{name}.vtkhdf"
        if name in ("off", "on"):
            runs[name] = scene(first, 1 + (name == "on")).run(output=whole)
            continue
        scene(first).run(output=half, until=3e-7)
        runs[name] = scene(then).run(output=whole, restart=half)
    assert same_run(runs["off"], runs["on"]) and runs["off"].energy["contact"].max() > 0.0
    for name in ("on and off", "off and on"):
        assert same_state(runs["off"], runs[name])
        assert runs[name].energy[-1].tobytes() == runs["off"].energy[-1].tobytes()

    def datasets(path):
        found = {}
        with h5py.File(path) as file:
            file.visititems(
                lambda key, item: (
                    found.update({key: item[()].tobytes()})
                    if isinstance(item, h5py.Dataset) and item.dtype != object
                    else None
                )
            )
        return found

    off, on = datasets(tmp_path / "off.vtkhdf"), datasets(tmp_path / "on.vtkhdf")
    assert (
        off.keys() == on.keys()
        and any("velocity" in key for key in off)
        and not any("stress" in key for key in off)
    )
    # Only the text of the scene, which names the optimisations, may differ, and bytes that were never written.
    assert [key for key in off if off[key] != on[key] and "scene" not in key.lower()] == []


def test_an_unknown_saving_is_refused():
    for savings, reason in (
        (["quite"], 'did you mean "quiet"'),
        (["quiet", 3], "savings[1]"),
        ("quiet", "list"),
    ):
        with pytest.raises(
            SceneError, match=reason.replace("[", r"\[").replace("]", r"\]")
        ) as caught:
            scene(savings)
        assert caught.value.key.startswith("run.savings")


def numbered(cells, layers=None, **changes):
    """The scene with other cells of the left plate, whose layers may be chosen."""
    data = scene(**changes).data
    data["body"][0]["box"]["cells"] = cells
    if layers is not None:
        data["body"][0]["box"]["layers"] = layers
    return ct.Scene(data)


@pytest.mark.parametrize(
    ("cells", "changes", "layers"),
    [
        ([16, 1, 40], {}, "x"),  # the contact is across x, and rows along z get 40 cells
        ([16, 40, 1], {}, "x"),
        ([16, 1, 12], {}, "z"),  # rows would be short
        (
            [40, 1, 40],
            {"load": [{"surface": "left.z_max", "pressure": 1.0}]},
            "z",
        ),  # surfaces along two axes
        ([40, 1, 40], {"contact": [], "load": [{"surface": "left.y_max", "pressure": 1.0}]}, "y"),
        (
            [40, 1, 40],
            {
                "contact": [],
                "obstacle": [
                    {"surface": "left.x_min", "plane": {"point": [-3, 0, 0], "normal": [1, 0, 0]}}
                ],
            },
            "x",
        ),
        ([40, 1, 40], {"contact": []}, "z"),
    ],
)
def test_layers_go_from_what_presses_into_the_body(cells, changes, layers):
    told = [body["layers"] for body in numbered(cells, **changes).explain().data["bodies"]]
    assert told == [layers, "z"]
    asked = numbered(cells, "y", **changes).explain()
    assert asked.data["bodies"][0]["layers"] == "y" and "numbered layer by layer along y" in str(
        asked
    )


def test_explain_tells_the_savings():
    assert "quiet, plane_strain, congruent" in str(scene().explain())
    assert scene(["congruent"]).explain().data["savings"] == ["congruent"]
    with pytest.raises(SceneError, match='"distant" is gone.*leave it out'):
        scene(["distant"])
    assert "none, as set in the scene" in str(scene([]).explain())


def test_a_lattice_is_refused_for_lack_of_memory_only_where_tables_would_not_fit(monkeypatch):
    block = box_of([0, 0, 0], [1, 1, 1], [10, 10, 10])
    body = [{"name": "block", "box": block, "material": "steel"}]
    one = {"contact": [], "support": []}
    nodes, elements = 11**3, 10**3
    # With tables an element has its 8 node numbers and 24 forces, without them its numbers.
    monkeypatch.setattr("libcontact.problem.physical_memory", lambda: 256 * nodes + 150 * elements)
    scene(body=body, **one).explain()
    for savings, other in (([], {}), (None, {"material": [RUBBER]})):
        with pytest.raises(SceneError, match="GB, this machine has"):
            scene(savings, body=body, **one, **other).explain()


class Held(ctypes.Structure):
    """glibc's report of its memory."""

    _names_ = "arena ordblks smblks hblks hblkhd usmblks fsmblks uordblks fordblks keepcost"
    _fields_ = [(name, ctypes.c_size_t) for name in _names_.split()]


def held_bytes():
    libc = ctypes.CDLL(None)
    if not hasattr(libc, "mallinfo2"):
        pytest.skip("this libc does not report its allocated memory")
    libc.mallinfo2.restype = Held
    gc.collect()
    told = libc.mallinfo2()
    return told.hblkhd + told.uordblks


BLOCK = box_of([0, 0, 0], [1, 1, 1], [24, 24, 24])
RUBBER = {"name": "steel", "young": 2.1e5, "poisson": 0.3, "density": 7.8e-9, "law": "neo_hookean"}
ALONE = {"contact": [], "support": []}


def lattice_nodes(cells):
    """Nodes and elements of a cube numbered in rows, and of one whose elements are shuffled."""
    x = np.stack(np.meshgrid(*[np.arange(cells + 1.0)] * 3, indexing="ij"), -1).reshape(-1, 3)
    x[:, 0] += 0.1 * np.sin(x[:, 1])
    number, near = np.arange(len(x)).reshape([cells + 1] * 3), [slice(None, -1), slice(1, None)]
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    corner += [(i, j, 1) for i, j, _ in corner]
    elements = np.stack([number[near[i], near[j], near[k]].ravel() for i, j, k in corner], -1)
    return x / cells, elements


NODES, ROWS = lattice_nodes(24)
SHUFFLED = np.random.default_rng(1).permutation(ROWS)
# Every other element has its reference axes turned about the third one.
TURNED = np.where(
    np.arange(len(ROWS))[:, None] % 2, SHUFFLED, SHUFFLED[:, [1, 2, 3, 0, 5, 6, 7, 4]]
)


def own_mesh(elements):
    return [{"name": "block", "nodes": NODES, "elements": elements, "material": "steel"}]


def bodies(box, **other):
    return [{"name": "block", "box": box, "material": "steel", **other}]


@pytest.mark.parametrize(
    ("name", "savings", "changes"),
    [
        ("lattice", None, {**ALONE, "body": bodies(BLOCK)}),
        ("tables", [], {**ALONE, "body": bodies(BLOCK)}),
        (
            "hex20",
            None,
            {**ALONE, "body": bodies({**BLOCK, "cells": [12, 12, 12]}, element="hex20")},
        ),
        ("reduced", None, {**ALONE, "body": bodies(BLOCK, integration="reduced")}),
        (
            "held",
            None,
            {
                "contact": [],
                "support": [{"set": "block.x_min", "fix": ["x"]}],
                "body": bodies({**BLOCK, "cells": [24, 1, 500]}),
                "gravity": {"acceleration": [0, 0, -9810.0]},
            },
        ),
        ("own_rows", None, {**ALONE, "body": own_mesh(ROWS)}),
        ("own_shuffled", None, {**ALONE, "body": own_mesh(SHUFFLED)}),
        ("own_turned", None, {**ALONE, "body": own_mesh(TURNED)}),
        ("large", None, {**ALONE, "body": bodies(BLOCK), "material": [RUBBER]}),
        (
            "chung_lee",
            None,
            {
                **ALONE,
                "body": bodies(BLOCK),
                "time": {"end": 5e-7, "fraction": 0.9, "integrator": "chung_lee"},
            },
        ),
        (
            "obstacle",
            None,
            {
                **ALONE,
                "body": bodies({**BLOCK, "cells": [2, 80, 80]}),
                "obstacle": [
                    {"surface": "block.x_min", "plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}
                ],
            },
        ),
        (
            "contact",
            None,
            {
                "support": [],
                "body": [
                    {
                        "name": name,
                        "box": box_of([x, 0, 0], [0.25, 2, 2], [8, 50, 50]),
                        "material": "steel",
                    }
                    for name, x in (("left", -0.26), ("right", 0.0))
                ],
            },
        ),
    ],
)
def test_explain_tells_the_memory_that_a_run_holds(name, savings, changes):
    told = scene(savings, **changes).explain().data["cost"]["memory_bytes"]
    before = held_bytes()
    held_by_scene = scene(savings, **changes)
    problem = held_by_scene._built(None, None)
    state = new_state(problem)
    options, watch = (
        ffi.new("ct_monitor_options *", lib.ct_monitor_options_default()),
        ffi.new("ct_monitor **"),
    )
    options.stable = problem.stable.dt
    check(lib.ct_monitor_create(problem.pointer, state, options, watch, new_error()))
    held = held_bytes() - before
    lib.ct_monitor_free(watch[0])
    assert told == pytest.approx(held, rel=0.02), (
        f"{name}: {held} bytes, told {told}: {told / held:.3f}"
    )
