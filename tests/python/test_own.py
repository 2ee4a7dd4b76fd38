"""Effects that a caller writes in Python: a spring against its closed form, and what its mistakes come to."""

import numpy as np
import pytest

import libcontact as ct

UNITS = {"length": "m", "mass": "kg", "time": "s"}
K = 8.0


def block(**body):
    scene = ct.Scene(units=UNITS).add_material("stiff", young=1e5, poisson=0.3, density=2.0)
    return scene.add_body("block", material="stiff", box={"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}, **body).set_time(end=3, fraction=0.5)


def pull(view):
    return -K / 8 * view.displacement[view.nodes]


def stored(view):
    return 0.5 * K / 8 * np.sum(view.displacement[view.nodes] ** 2)


def test_a_block_on_springs_swings():
    """Mass 2 on springs of 8 altogether: omega = 2, u = v / omega sin omega t, and the energy goes to and fro."""
    scene = block(velocity=[0.3, 0, 0]).add_effect("spring", "block", force=pull, energy=stored, frequency=(K / 2) ** 0.5)
    run = scene.run(progress=False)
    np.testing.assert_allclose(run.state["block"].displacement[:, 0], 0.15 * np.sin(2 * run.time[-1]), rtol=1e-4)
    np.testing.assert_allclose(run.energy["spring"], 0.5 * K * (0.15 * np.sin(2 * run.time)) ** 2, atol=1e-4 * 0.09)
    np.testing.assert_allclose(run.energy["total"], 0.09, rtol=1e-12)
    assert np.abs(run.energy["balance"]).max() < 1e-13
    assert "spring" in scene.explain().data["effects"] and "caller's own" in scene.explain()


def test_its_frequency_limits_the_step_and_without_energy_it_is_work():
    plain = block().explain().data["time"]["stable"]
    own = block().add_effect("spring", ("block", [0, 3]), force=pull, frequency=2 / plain).explain().data["time"]["stable"]
    assert own == pytest.approx(plain / 2**0.5)
    run = block(velocity=[0.3, 0, 0]).add_effect("spring", "block.x_min", force=pull, frequency=2.0).run(progress=False)
    assert run.energy["spring"][-1] == run.energy["external"][-1] != 0.0


def test_the_view_shows_the_run_itself():
    seen = []

    def look(view):
        with pytest.raises(ValueError):
            view.displacement[0, 0] = 1.0
        seen.append((view.time, view.displacement.shape, view.displacement.flags.owndata, view.reference[view.nodes][:, 0].tolist()))
        return np.zeros((4, 3))

    block().add_effect("eye", "block.x_max", force=look).run(progress=False)
    assert seen[-1][0] > 2.9 and seen[0][1:] == ((8, 3), False, [1.0] * 4)


@pytest.mark.parametrize("force, kind, words", [
    (lambda view: 1 / 0 if view.time > 1 else np.zeros((8, 3)), ZeroDivisionError, "division by zero"),
    (lambda view: np.zeros((8 if view.time < 1 else 7, 3)), ValueError, "the shape (7, 3)"),
    (lambda view: np.full((8, 3), 0.0 if view.time < 1 else np.nan), ValueError, "not finite"),
])
def test_what_it_raises_ends_the_run_with_the_reason(force, kind, words):
    with pytest.raises(ct.RunError, match="effect bad: force") as failed:
        block().add_effect("bad", "block", force=force).run(progress=False)
    assert words in str(failed.value) and isinstance(failed.value.__cause__, kind)
    assert 0.9 < failed.value.run.time[-1] <= 1.1


def test_an_effect_that_fails_at_once_is_refused():
    with pytest.raises(ct.SceneError, match="KeyError") as failed:
        block().add_effect("bad", "block", force=lambda view: {}["no"]).run(progress=False)
    assert isinstance(failed.value.__cause__, KeyError)


@pytest.mark.parametrize("arguments, words", [
    (("gravity", "block", pull), "names no other effect"), (("total", "block", pull), "names no other effect"), (("a b", "block", pull), "a word"),
    (("spring", "block", 3), "functions"), (("spring", "blok", pull), "no body"), (("spring", "block.top", pull), "no face"),
    (("spring", ("block", [8]), pull), "from 0 to 7"), (("spring", ("block", [0.5]), pull), "whole numbers"),
])
def test_what_cannot_be_is_refused(arguments, words):
    name, nodes, force = arguments
    with pytest.raises(ct.SceneError, match=words):
        block().add_effect(name, nodes, force=force).explain()


def test_a_scene_file_cannot_hold_it(tmp_path):
    with pytest.raises(ct.SceneError, match="can't hold"):
        block().add_effect("spring", "block", force=pull).save(tmp_path / "a.toml")
