"""Kernels and effects of elements, requested or chosen by default: reduced integration, plane strain, bulk
viscosity."""

import numpy as np
import pytest
from scenes import MILLIMETRES, STEEL, box_of, same_state, scene_with

import libcontact as ct


def block(cells=(4, 3, 3), **body):
    scene = scene_with(**STEEL, units=MILLIMETRES)
    return scene.add_body(
        "block", material="steel", box={"size": [4, 3, 3], "cells": list(cells)}, **body
    )


def plates(**run):
    scene = scene_with(**STEEL, units=MILLIMETRES)
    for name, origin, speed in ("left", -0.5, 1000), ("right", 0.0, -1000):
        scene.add_body(
            name,
            material="steel",
            box=box_of([origin, 0, 0], [0.5, 0.05, 0.5], [10, 1, 10]),
            velocity=[speed, 0, 0],
        )
        scene.add_support(f"{name}.z_min", fix="z")
        scene.add_support(f"{name}.y_min", fix="y").add_support(f"{name}.y_max", fix="y")
    scene.add_contact("left.x_max", "right.x_min")
    scene.set_time(end=1e-7, courant=0.3)
    data = {**scene.data, "run": run} if run else scene.data
    return ct.Scene(data)


def test_plane_strain_is_chosen_and_changes_no_bit():
    two, three = plates(), plates(savings=["quiet", "congruent"])
    assert [body["kernel"] for body in two.explain().data["bodies"]] == ["plane", "plane"]
    assert [body["kernel"] for body in three.explain().data["bodies"]] == ["box", "box"]
    assert "plane strain" in str(two.explain())
    a, b = two.run(), three.run()
    assert same_state(a, b)
    assert np.array_equal(a.energy, b.energy) and np.array_equal(a.momentum, b.momentum)


def test_reduced_integration_has_its_hourglass_energy_in_the_ledger():
    scene = block(integration="reduced", hourglass=0.5, velocity=[0, 0, 1000]).add_support(
        "block.x_min", fix="xyz"
    )
    run = scene.set_time(end=1e-5, fraction=0.9).run()
    energy = run.energy
    assert (
        "hourglass" in energy.dtype.names and energy["hourglass"].max() > 1e-3 * energy["total"][0]
    )
    np.testing.assert_allclose(
        energy["kinetic"] + energy["strain"] + energy["hourglass"] - energy["external"],
        energy["total"],
        rtol=1e-12,
    )
    np.testing.assert_allclose(energy["total"], energy["total"][0], rtol=1e-12)
    assert np.abs(energy["balance"]).max() < 1e-12 * energy["total"][0]
    body = scene.explain().data["bodies"][0]
    assert body["kernel"] == "reduced" and "hourglass" in body["kernel_why"]


def test_viscosity_takes_the_overshoot_of_a_front_and_its_work_is_in_the_ledger():
    def hit(**viscosity):
        scene = scene_with("rod", young=2.1e5, poisson=0.0, density=7.8e-9, units=MILLIMETRES)
        scene.add_body(
            "rod",
            material="rod",
            box={"size": [10, 0.1, 0.1], "cells": [100, 1, 1]},
            velocity=[-1e4, 0, 0],
        )
        scene.add_support("rod.x_min", fix="x")
        if viscosity:
            scene.add("viscosity", **viscosity)
        return scene.set_time(end=1e-6, fraction=0.9).run()

    def highest(run):
        # the exact stress behind the front is rho c v
        return -run.state["rod"].stress[:, 0].min() / np.sqrt(2.1e5 * 7.8e-9) / 1e4

    plain, viscous = hit(), hit(linear=0.2, quadratic=0)
    assert highest(plain) > 1.15 and highest(viscous) < 1.03
    assert viscous.energy["viscosity"][-1] < 0 and np.all(np.diff(viscous.energy["viscosity"]) <= 0)
    np.testing.assert_allclose(viscous.energy["total"], viscous.energy["total"][0], rtol=1e-10)


def test_boxes_of_hex20_share_one_operator():
    def run(**body):
        scene = block(element="hex20", velocity=[1000, 0, 0], **body).add_support(
            "block.x_min", fix="x"
        )
        scene.set_time(end=2e-6, fraction=0.9)
        return scene.explain().data["bodies"][0], scene.run()

    box, general = run(), run(kernel="general")
    assert (
        box[0]["kernel"] == "box"
        and "equal boxes" in box[0]["kernel_why"]
        and general[0]["kernel"] == "general"
    )
    assert run(kernel="box")[0]["kernel_why"] == "asked for"
    assert general[0]["flops_per_update"] > 6 * box[0]["flops_per_update"]
    np.testing.assert_allclose(box[1].dt, general[1].dt, rtol=0)
    u, v = (r[1].state["block"].displacement for r in (box, general))
    assert np.abs(u - v).max() < 1e-13 * np.abs(v).max()
    ring = scene_with(**STEEL, units=MILLIMETRES)
    ring.add_body(
        "ring",
        material="steel",
        element="hex20",
        ring={"radius": [1, 2], "width": 1, "cells": [1, 8, 1]},
    )
    ring.set_time(end=1e-7, fraction=0.9)
    body = ring.explain().data["bodies"][0]
    assert (
        body["kernel"] == "general"
        and "not equal boxes" in body["kernel_why"]
        and "3x3x3" in body["kernel_why"]
    )


@pytest.mark.parametrize(
    "body, reason",
    [
        ({"element": "hex20", "integration": "reduced"}, r"body\[0\].integration.*hex20"),
        ({"hourglass": 0.1}, r"body\[0\].hourglass.*reduced"),
        ({"integration": "reduced", "hourglass": -1.0}, r"body\[0\].hourglass"),
        ({"integration": "reduced", "kernel": "box"}, r"body\[0\].kernel.*full"),
        ({"element": "hex20", "kernel": "plane"}, r"body\[0\].kernel.*hex8"),
        ({"integration": "one"}, r"body\[0\].integration"),
    ],
)
def test_what_does_not_go_together_is_refused(body, reason):
    with pytest.raises(ct.SceneError, match=reason):
        block(**body).set_time(end=1e-6, fraction=0.9).explain()


def test_large_deformation_is_integrated_in_full():
    scene = scene_with(
        "soft", young=1.0, poisson=0.3, density=1e-9, law="neo_hookean", units=MILLIMETRES
    )
    with pytest.raises(ct.SceneError, match=r"body\[0\].integration.*neo_hookean"):
        scene.add_body(
            "block",
            material="soft",
            box={"size": [1, 1, 1], "cells": [2, 2, 2]},
            integration="reduced",
        ).set_time(end=1e-6, fraction=0.9).explain()


def test_plane_strain_with_a_load_along_its_thickness_is_refused():
    scene = (
        block(cells=(4, 1, 3), kernel="plane")
        .add_support("block.y_min", fix="y")
        .add_support("block.y_max", fix="y")
    )
    scene.set_time(end=1e-6, fraction=0.9)
    assert scene.explain().data["bodies"][0]["kernel"] == "plane"
    with pytest.raises(ct.SceneError, match="gravity.*along y"):
        ct.Scene(scene.data).add("gravity", acceleration=[0, 1, 0]).explain()
    with pytest.raises(ct.SceneError, match="all held along its thickness"):
        block(cells=(4, 1, 3), kernel="plane").set_time(end=1e-6, fraction=0.9).explain()


@pytest.mark.parametrize(
    "table, reason",
    [
        ({"linear": -1}, "viscosity.linear"),
        ({"linear": 0, "quadratic": 0}, "viscosity.linear"),
        ({"bodies": ["blok"]}, "block"),
    ],
)
def test_viscosity_that_cannot_be_is_refused(table, reason):
    with pytest.raises(ct.SceneError, match=reason):
        block().add("viscosity", **table).set_time(end=1e-6, fraction=0.9).explain()


def test_viscosity_is_for_small_rotations():
    """A cube that spins would lose its spin: the volume of the reference shape seems to shrink at 2 ω sin φ."""
    scene = block().set_time(end=1e-6).add("viscosity")
    scene.explain()
    turning = scene.data
    turning["material"][0]["law"] = "neo_hookean"
    with pytest.raises(ct.SceneError, match=r'viscosity.bodies.*"linear".*"neo_hookean"'):
        ct.Scene(turning).explain()


def test_viscosity_is_for_hex8():
    with pytest.raises(ct.SceneError, match="viscosity.bodies.*hex20"):
        block(element="hex20").add("viscosity").set_time(end=1e-6, fraction=0.9).explain()
