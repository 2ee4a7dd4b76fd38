"""A few of the random bodies of :file:`tests/fuzz/obstacle_scenes.py`: overlaps with obstacles at the start, and
obstacles smaller than an element."""

import numpy as np
import pytest
from scenes import METRES, box_of, continued, same_state

import libcontact as ct

obstacle_scenes = pytest.importorskip("obstacle_scenes")
needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")


@pytest.mark.parametrize("seed", range(12))
def test_a_body_that_begins_inside_an_obstacle_gains_nothing(seed):
    found = obstacle_scenes.one("overlap", seed)
    assert found["ended"] == "ok" or found["refused"]
    assert found["growth"] <= obstacle_scenes.ALLOWED
    # A corner may be inside where no point is.
    assert found["told"] or not found["still"] or found["deepest"] == 0.0


@pytest.mark.parametrize("seed", range(12))
def test_a_small_obstacle_does_not_pass(seed):
    found = obstacle_scenes.one("small", seed)
    assert found["ended"] == "ok" and found["hit"] and found["impulse"] > 0.0
    assert found["growth"] <= obstacle_scenes.ALLOWED and found["sunk"] < 0.0


def plate(sphere_at, **time):
    """A steel plate of elements of 250 mm, held at two sides, and a sphere of R = 50 mm at 0.008 c1."""
    return ct.Scene(
        {
            "units": METRES,
            "material": [{"name": "steel", "young": 2.1e11, "poisson": 0.3, "density": 7800.0}],
            "body": [
                {
                    "name": "plate",
                    "material": "steel",
                    "box": box_of([-0.5, -0.5, 0], [1, 1, 0.25], [4, 4, 1]),
                }
            ],
            "support": [
                {"set": f"plate.x_{end}", "fix": ["x", "y", "z"]} for end in ("min", "max")
            ],
            "obstacle": [
                {
                    "surface": "plate.outer",
                    "sphere": {"centre": [*sphere_at, 0.31], "radius": 0.05},
                    "velocity": [0, 0, -48.0],
                }
            ],
            "time": time or {"end": 4e-3},
            "output": {"every": 20},
        }
    )


@pytest.mark.parametrize("at", [(0.0, 0.0), (0.125, 0.125), (0.03, 0.11)])
def test_a_sphere_of_a_fifth_of_an_element_does_not_pass_through_a_plate(at):
    run = plate(at).run(output=False)
    # It has moved by 0.19 and carries the plate along: the middle is pressed in by almost as much.
    u = run.state["plate"].displacement[:, 2]
    assert u.min() < -0.5 * (48.0 * run.state.time - 0.01)
    energy = run.energy
    assert energy["external"][-1] > 0.0
    assert ((energy["kinetic"] + energy["strain"]) <= 1.002 * energy["external"]).all()
    # Its force is a pressure at the nodes around it, whose sum is the reaction.
    pressure = run.pressure["obstacle"][0]
    assert (pressure["area"][:, None] * pressure["traction"]).sum(axis=0)[2] < 0.0


def test_a_gap_under_a_small_sphere_is_adjusted():
    """The closest place to its centre has a normal without a point on a face."""
    data = plate((0.03, 0.11), end=1e-4).data
    data["obstacle"][0] |= {"adjust": 0.02, "velocity": [0, 0, -4.8]}
    run = ct.Scene(data).run(output=False)
    assert run.energy["obstacle"][-1] > 0.0


def test_friction_with_the_explicit_penalty_leaves_the_station_alone():
    """Friction acts at points of the faces, between which the sphere is; its station has a row, too."""
    runs = []
    for keys in {"friction": 0.3}, {}:
        data = plate((0.03, 0.11), end=4e-4).data
        data["body"][0]["box"] = box_of([-0.125, -0.125, 0], [0.25] * 3, [1] * 3)
        data["obstacle"][0] |= {"surface": "plate.z_max", "enforcement": "penalty", **keys}
        del data["support"]
        runs.append(ct.Scene(data).run(output=False))
    assert runs[0].impulse["obstacle"][2] < 0.0 and not runs[0].impulse["friction"].any()
    assert np.array_equal(*(run.state["plate"].velocity for run in runs))


@needs_hdf5
def test_a_restart_under_a_small_sphere_has_the_same_bits(tmp_path):
    scene = plate((0.03, 0.11))
    whole = scene.run(output=False)
    assert same_state(whole, continued(scene, tmp_path, 2e-3))
    assert same_state(whole, scene.run(output=False, threads=3))
