"""Bodies of several materials."""

import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import scene_with

import libcontact as ct

HARD = {"young": 8.0, "poisson": 0.0, "density": 2.0}
SOFT = {"young": 1.0, "poisson": 0.0, "density": 1.0}
KINDS = ("hex8", "hex20")


def layered(
    cells, size=(8.0, 1.0, 1.0), element="hex8", hard=HARD, soft=SOFT, material=None, **keys
):
    """A bar along x, of which the half at low x is hard, its elements in random order."""
    mesh = Mesh.box(element, (0, 0, 0), size, cells)
    elements = np.ascontiguousarray(
        mesh.elements[np.random.default_rng(3).permutation(len(mesh.elements))]
    )
    left = mesh.nodes[elements[:, :8], 0].mean(axis=1) < 0.5 * size[0]
    sets = {
        "left": {"elements": np.flatnonzero(left)},
        "right": {"elements": np.flatnonzero(~left)},
        "all": {"elements": np.arange(len(elements))},
    }
    scene = scene_with("hard", **hard).add_material("soft", **soft)
    by_set = {"left": "hard", "right": "soft"} if material is None else material
    arrays = {"nodes": mesh.nodes, "elements": elements, "sets": sets}
    return scene.add_body("bar", material=by_set, **arrays, **keys)


def run(scene):
    return scene.run(output=False)


@pytest.mark.parametrize("element", KINDS)
@pytest.mark.parametrize("law", ["linear", "st_venant_kirchhoff", "neo_hookean"])
def test_one_material_by_sets_has_the_bits_of_one(element, law):
    hard = HARD | {"poisson": 0.3, "law": law}
    ends = []
    for material in ("hard", {"left": "hard", "right": "hard"}):
        scene = layered((6, 2, 2), element=element, hard=hard, material=material, kernel="general")
        scene.add("load", surface="bar.x_max", pressure=0.1, traction=[0, 0.01, 0])
        ends.append(run(scene.set_time(end=3.0, dt=0.02)))
    one, two = ends
    assert np.abs(one.state["bar"].displacement).max() > 0.01
    assert (one.state["bar"].displacement == two.state["bar"].displacement).all()
    assert (one.state["bar"].stress == two.state["bar"].stress).all()
    assert (one.energy["strain"] == two.energy["strain"]).all()


@pytest.mark.parametrize(
    "element, integration", [*((k, "full") for k in KINDS), ("hex8", "reduced")]
)
def test_a_bar_at_rest_stretches_as_springs_in_series(element, integration):
    """u = σ l / E in each half, σ in all elements; the weight of each half by its density."""
    scene = layered((8, 1, 1), element=element, integration=integration)
    scene.add_support("bar.x_min", fix="xyz")
    scene.add("load", surface="bar.x_max", traction=[0.01, 0, 0])
    scene.add("damping", relaxation=True)
    body = run(scene.set_time(end=4000.0, until_static=1e-10)).state["bar"]
    x = body.nodes[:, 0]
    want = 0.01 * (np.minimum(x, 4.0) / 8.0 + np.maximum(x - 4.0, 0.0) / 1.0)
    # The residual is 1e-10 of the forces.
    assert np.abs(body.displacement[:, 0] - want).max() < 1e-8 * want.max()
    assert np.abs(body.stress[:, 0] - 0.01).max() < 1e-9


def pulse(duration):
    """A smooth pulse of the height 1."""
    time = np.linspace(0.0, duration, 65)
    value = np.sin(np.pi * time / duration) ** 4
    return {"time": time.tolist(), "value": value.tolist()}


def hits_the_interface(element, cells):
    """Largest stress with its sign in the hard and the soft part after a smooth pulse of the stress -1 in the hard
    part has met the interface."""
    c, length, width = 2.0, 40.0, 8.0  # c = √(E / ρ) of the hard part
    scene = layered((cells, 1, 1), (length, 0.1, 0.1), element)
    scene.add_support("bar.outer", fix="yz")
    scene.add("load", surface="bar.x_min", traction=[1.0, 0, 0], history=pulse(width / c))
    # Its end has passed the interface, and neither part has reached an end of the bar.
    body = run(scene.set_time(end=(20.0 + width) / c + 0.5, fraction=0.5)).state["bar"]
    stress, x = body.stress[:, 0], body.centres[:, 0]
    parts = (stress[x < 19.5], stress[x > 20.5])
    return [part[np.abs(part).argmax()] for part in parts]


@pytest.mark.parametrize("element, cells", [("hex8", 400), ("hex20", 200)])
def test_a_wave_is_reflected_by_the_ratio_of_impedances(element, cells):
    """Of the stress (Z2 - Z1) / (Z2 + Z1) is reflected and 2 Z2 / (Z2 + Z1) goes on, Z = √(E ρ)."""
    first, second = (np.sqrt(each["young"] * each["density"]) for each in (HARD, SOFT))
    back, on = hits_the_interface(element, cells)
    # Elements of 1/80 (1/40) of the pulse, peaks between centres: errors of some tenths of a percent.
    assert abs(-back - (second - first) / (second + first)) < 4e-3
    assert abs(-on - 2.0 * second / (second + first)) < 4e-3


def test_each_part_has_its_mass_and_energy_and_momentum_stay():
    scene = layered((8, 2, 2), velocity=[1, 2, 3])
    scene.add("obstacle", surface="bar.x_max", plane={"point": [8, 0, 0], "normal": [-1, 0, 0]})
    result = run(scene.set_time(end=2.0))
    momentum = result.momentum["p"]
    mass = 4.0 * HARD["density"] + 4.0 * SOFT["density"]
    assert np.abs(momentum[0] - mass * np.array([1, 2, 3])).max() < 1e-13 * mass
    assert np.abs(momentum[:, 1:] - mass * np.array([2, 3])).max() < 1e-12 * mass
    energy = result.energy
    assert np.abs(energy["balance"]).max() < 1e-12 * energy["total"][0]


def test_the_step_is_that_of_the_stiffest_part():
    """c₁ of the hard part is twice that of the soft one: h / c₁ for ν = 0, for elements in a row."""
    steps = {}
    for name, material in (("both", None), ("hard", {"all": "hard"}), ("soft", {"all": "soft"})):
        built = layered((8, 1, 1), material=material)
        steps[name] = built.set_time(end=1.0).explain().data["time"]["stable"]
    assert steps["both"] == steps["hard"]
    assert abs(steps["soft"] / steps["hard"] - 2.0) < 1e-12


@pytest.mark.parametrize("end, material", [("x_min", HARD), ("x_max", SOFT)])
def test_contact_has_the_penalty_of_the_material_behind_it(end, material):
    """4 ρ c₁² / h with h = 1, of the explicit penalty (eq:penalty-default)."""
    for with_body in (False, True):
        scene = layered((8, 1, 1))
        if with_body:
            box = {"origin": [-9, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
            scene.add_material("stiff", young=1e3, poisson=0.0, density=1.0)
            scene.add_body("other", material="stiff", box=box)
            scene.add_contact(f"bar.{end}", "other.x_max", enforcement="penalty")
        else:
            plane = {"point": [20, 0, 0], "normal": [-1, 0, 0]}
            scene.add("obstacle", surface=f"bar.{end}", plane=plane, enforcement="penalty")
        problem = scene.set_time(end=0.1)._built(None)
        if with_body:
            epsilon = problem.contacts[0].epsilon
        else:
            given = problem.parts.obstacle[0]
            materials = problem.materials_behind(given.surface)
            epsilon = given.penalties(problem.joined.bodies[0], materials)[0]
        assert abs(epsilon - 4.0 * material["young"]) < 1e-12 * epsilon


@pytest.mark.parametrize("end, other", [("x_min", "x_max"), ("x_max", "x_min")])
def test_a_boundary_absorbs_with_the_impedance_behind_it(end, other):
    """A pulse that starts in a part leaves through its end: of the wrong impedance a third would come back."""
    scene = layered((200, 1, 1), (40.0, 0.2, 0.2))
    scene.add_support("bar.outer", fix="yz")
    scene.add("absorb", surface=f"bar.{end}")
    sign = 1.0 if end == "x_max" else -1.0
    scene.add("load", surface=f"bar.{other}", traction=[sign, 0, 0], history=pulse(6.0))
    # Both halves take 20 / c; what the interface reflects has not come back there.
    stop = 10.0 + 20.0 + 6.0 + 1.0
    body = run(scene.set_time(end=stop, fraction=0.5)).state["bar"]
    x = body.centres[:, 0]
    near = (x > 30.0) if end == "x_max" else (x < 15.0)
    assert np.abs(body.stress[near, 0]).max() < 0.01


@pytest.mark.skipif(not ct.has("hdf5"), reason="no HDF5")
def test_stress_in_a_file_is_that_of_each_material(tmp_path):
    path = tmp_path / "bar.vtkhdf"
    scene = layered((8, 2, 2)).add("load", surface="bar.x_max", traction=[0.1, 0.05, 0])
    scene.add_probe("p", body="bar", point=[7.5, 0.2, 0.2], quantities=["stress"])
    scene.set_output(str(path)).set_time(end=2.0)
    made = scene.run()
    body, there = made.state["bar"], ct.Run.load(path).state["bar"]
    computed = run(scene).state["bar"].stress
    assert np.abs(computed).max() > 0.1
    assert (there.stress == computed).all() and (body.stress == computed).all()
    number = body.mesh.locate(np.array([[7.5, 0.2, 0.2]]))[0][0]
    assert np.abs(made.probes["p"]["stress"][-1] - computed[number]).max() < 1e-15
    # The same arrays with the materials exchanged are another problem.
    other = layered((8, 2, 2), material={"left": "hard", "right": "soft"}, hard=SOFT, soft=HARD)
    other.add("load", surface="bar.x_max", traction=[0.1, 0.05, 0])
    with pytest.raises(ct.SceneError, match="another"):
        other.set_time(end=4.0).run(restart=path)


def refused(**given):
    with pytest.raises(ct.SceneError) as error:
        keys = {key: given.pop(key) for key in ("kernel", "initial") if key in given}
        layered((4, 1, 1), **given, **keys).set_time(end=1.0).run(output=False)
    return error.value


@pytest.mark.parametrize(
    "material, key, reasons",
    [
        ({"left": "hard"}, "material", ["in none of the sets", "no material (2 such elements)"]),
        ({"all": "hard", "right": "soft"}, "material.right", ['in the sets "all" and "right"']),
        ({"lfet": "hard"}, "material.lfet", ['no set of elements "lfet"', 'mean "left"']),
        ({"left": "hrad"}, "material.left", ['no material is named "hrad"', 'mean "hard"']),
        ({}, "material", ["is empty"]),
        (3, "material", ["the name of a [[material]]"]),
    ],
)
def test_every_element_has_one_material(material, key, reasons):
    error = refused(material=material)
    assert error.key == f"body[0].{key}"
    assert all(reason in error.reason for reason in reasons), error.reason


def test_what_several_materials_lack_is_refused():
    error = refused(kernel="box")
    assert error.key == "body[0].kernel" and "one material" in error.reason
    error = refused(hard=HARD | {"law": "neo_hookean"})
    assert error.key == "body[0].material" and "one law" in error.reason
    error = refused(initial={"stress": [1, 0, 0, 0, 0, 0]})
    assert error.key == "body[0].initial.stress" and "one material" in error.reason
    scene = layered((4, 1, 1))
    with pytest.raises(ct.SceneError, match="bulk viscosity is for bodies of one"):
        scene.add("viscosity", linear=0.1)
    with pytest.raises(ct.SceneError, match="a box has none"):
        box = {"size": [1, 1, 1], "cells": [1, 1, 1]}
        layered((4, 1, 1)).add_body("b", material={"all": "hard"}, box=box)


def test_explain_names_all_materials():
    text = layered((4, 1, 1)).set_time(end=1.0).explain()
    (body,) = text.data["bodies"]
    assert body["elements_of"] == {"hard": 2, "soft": 2}
    assert "material hard, soft" in text and "several materials" in body["kernel_why"]
