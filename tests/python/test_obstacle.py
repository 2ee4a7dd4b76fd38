"""Scenes with obstacles and friction: closed forms, energy balances, restart, and refusals."""

import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
from libcontact.schema import SceneError
from scenes import METRES, box_of, continued, same_state

import libcontact as ct

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"
needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")


def changed(name, **changes):
    data = tomllib.loads((SCENES / f"{name}.toml").read_text(encoding="utf-8"))
    for key, value in changes.items():
        data[key] = value
    return data


def enforced(name, enforcement):
    """A scene of the tutorials, its obstacle with another enforcement."""
    data = changed(name)
    data["obstacle"][0]["enforcement"] = enforcement
    if enforcement == "penalty":
        data["obstacle"][0].pop("restitution", None)
    return ct.Scene(data).run(output=False)


@pytest.mark.parametrize("points", ["gauss", "lobatto"])
def test_bar_on_a_wall(points):
    data = changed("bar_on_a_wall")
    data["obstacle"][0]["points"] = points
    run = ct.Scene(data).run(output=False)
    energy, p = run.energy, run.momentum["p"][:, 0] / 0.1
    touching = energy["time"][energy["obstacle"] > 0.05 * energy["obstacle"].max()]
    assert abs(touching[0] - 0.5) < 0.02 and abs(touching[-1] - (0.5 + 2 / 3)) < 0.02
    # Momentum grows by pressure times area: 300 over the area, of a bar of mass 10 over the area.
    steady = (energy["time"] > 0.6) & (energy["time"] < 1.1)
    assert np.polyfit(energy["time"][steady], p[steady], 1)[0] == pytest.approx(30.0, rel=0.01)
    assert p[-1] == pytest.approx(10.0, rel=0.01)
    assert np.abs(energy["balance"]).max() < 1e-12 * energy["kinetic"][0]


@pytest.mark.parametrize("enforcement, lost", [("penalty", 0.0), ("energy_controlled", 0.01)])
def test_block_on_an_incline(enforcement, lost):
    run = enforced("block_on_an_incline", enforcement)
    last, p = run.energy[-1], run.momentum[-1]["p"]
    # Friction is 0.3 of the normal force except while it sticks at the start.
    assert p[0] == pytest.approx(300 * 3.6 - 0.3 * p[2], rel=5e-3)
    assert last["friction"] < 0 and abs(last["balance"]) < 1e-12 * last["kinetic"]
    # The penalty conserves energy, the others may dissipate some when the block drops.
    assert -(2e-3 + lost) * last["kinetic"] < last["total"] < 2e-3 * last["kinetic"]


def test_block_stays_below_the_angle_of_friction():
    data = changed("block_on_an_incline", gravity={"acceleration": [2, 0, -8]})
    data["obstacle"][0]["friction"] = 0.9
    run = ct.Scene(data).run(output=False)
    slip = 2 * 1000 * 0.3 / (1e5 / 0.15)
    assert np.abs(run.state["block"].displacement[:, 0]).max() < 20 * slip
    assert abs(run.momentum[-1]["p"][0]) < 0.05 * 300 * 2


def settled(friction, slope):
    """The block on a slope with this tangent of its angle, default contact. Damping against the velocity settles it.
    Returns times, mean velocities along the slope and what gravity and friction accelerate the block with together."""
    g, rate, angle = 10.0, 20.0, np.arctan(slope)
    data = changed("block_on_an_incline", damping={"rate": rate})
    data["gravity"]["acceleration"] = [g * np.sin(angle), 0.0, -g * np.cos(angle)]
    data["time"], data["output"]["every"] = {"end": 1.5}, 1
    del data["obstacle"][0]["beta"]
    data["obstacle"][0]["friction"] = friction
    record = ct.Scene(data).run(output=False).body_momentum("block")
    t, v = record["time"], record["p"][:, 0] / 300.0
    return t, v, (v[1:] - v[:-1]) / np.diff(t) + 0.5 * rate * (v[1:] + v[:-1])


def test_acceleration_above_the_angle_of_friction():
    """g (sin α - μ cos α) = 0.085749 g, to 0.1 %."""
    t, _, a = settled(0.5, 0.6)
    assert a[t[1:] > 1.0].mean() == pytest.approx(10.0 * 0.085749, rel=1e-3)


def test_a_block_below_the_angle_of_friction_does_not_creep():
    """It shifts while it settles, by the elastic slip and its own shear, and then stays."""
    t, v, _ = settled(0.6, 0.5)
    late = t[1:] > 1.0
    shift = np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))
    assert np.abs(v[1:][late]).max() < 1e-6
    assert 0.0 < shift[-1] < 0.03 * 0.3
    assert np.ptp(shift[late]) < 1e-4 * shift[-1]


@needs_hdf5
def test_a_scene_and_a_host_take_the_same_tables():
    """``add_obstacle`` of a scene is its table ``[[obstacle]]``, and a host's takes the same shapes."""
    data, shapes = changed("bar_on_a_wall"), {"plane": {"point": [0, 0, 0], "normal": [1, 0, 0]}}
    (wall,) = data.pop("obstacle")
    built = ct.Scene(units=data["units"])
    for each in data["material"]:
        built.add_material(**each)
    for each in data["body"]:
        built.add_body(**each)
    assert built.add_obstacle(**wall).data["obstacle"] == [wall]
    with pytest.raises(SceneError, match=r"obstacle\[1\].plane.normal: is missing"):
        built.add_obstacle(surface="bar.x_min", plane={"point": [0, 0, 0]})
    built.add_obstacle(surface="bar.x_min", **shapes)
    square = ct.Surface("Q4", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2, 3]])
    assert ct.Contact(square, itself=False, epsilon=1.0).add_obstacle(**shapes, epsilon=1.0) == 0


def test_restart_carries_friction(tmp_path):
    scene = ct.Scene(changed("block_on_an_incline", output={"every": 50}))
    assert same_state(scene.run(output=False), continued(scene, tmp_path, 0.5))


def test_contact_with_friction_has_its_own_column_and_line():
    box = lambda z, size: box_of([0, 0, z], size, [3, 3, 1])
    data = {
        "units": METRES,
        "material": [{"name": "m", "young": 1e4, "poisson": 0.2, "density": 1.0}],
        "body": [
            {"name": "slab", "box": box(-0.3, [2, 1, 0.3]), "material": "m"},
            {
                "name": "block",
                "box": box(-1e-4, [1, 1, 0.3]),
                "material": "m",
                "velocity": [1, 0, -0.1],
            },
        ],
        "contact": [{"surfaces": ["slab.z_max", "block.z_min"], "friction": 0.4}],
        "time": {"end": 0.02, "fraction": 0.5},
    }
    scene = ct.Scene(data)
    assert "friction 0.4" in scene.explain()
    rough = scene.run()
    assert rough.energy["friction"][-1] < 0
    # The momentum along x that one body loses is gained by the other.
    p = rough.momentum["p"].reshape(-1, 2, 3)
    assert p[-1, 0, 0] > 1e-3 and np.abs(p.sum(axis=1) - p[0].sum(axis=0)).max() < 1e-13
    del data["contact"][0]["friction"]
    smooth = ct.Scene(data).run()
    assert (
        "friction" not in smooth.energy.dtype.names
        and np.abs(smooth.momentum["p"].reshape(-1, 2, 3)[-1, 0, 0]) < 1e-4
    )


@pytest.mark.parametrize(
    "change, key, reason",
    [
        ({"friction": [{"coefficient": 0.3}]}, "friction", "no friction without a pressure"),
        ({"surface": "block.top"}, "obstacle[0].surface", "no face"),
        ({"plane": {"point": [0, 0, 0], "normal": [0, 0, 0]}}, "obstacle[0].plane.normal", "zero"),
        (
            {"sphere": {"centre": [0, 0, 0], "radius": 1}},
            "obstacle[0].sphere",
            "cannot stand beside",
        ),
        ({"plane": None}, "obstacle[0]", "exactly one is needed"),
        ({"travel": [0, 0, 1]}, "obstacle[0].history", "go together"),
        ({"tangent": 1.0, "friction": 0.0}, "obstacle[0].tangent", "belongs to friction"),
        ({"friction": -1}, "obstacle[0].friction", "at least 0"),
        ({"speed": 1}, "obstacle[0].speed", "unknown key"),
        ({"enforcement": "lagrange"}, "obstacle[0].enforcement", 'write "energy_controlled"'),
        ({"enforcement": "bipenalty"}, "obstacle[0].enforcement", 'write "energy_controlled"'),
        ({"initial_penetration": "push"}, "obstacle[0].initial_penetration", 'write "force"'),
    ],
)
def test_refusals(change, key, reason):
    data = changed("block_on_an_incline")
    if isinstance(change.get("friction"), list):
        data.update(change)
    else:
        data["obstacle"][0].update(change)
        data["obstacle"][0] = {
            name: value for name, value in data["obstacle"][0].items() if value is not None
        }
    with pytest.raises(SceneError) as error:
        ct.Scene(data)
    assert error.value.key == key and reason in str(error.value)


@pytest.mark.parametrize(
    "enforcement, beta, fraction, told",
    [
        ("penalty", 10, 0.9, True),
        ("penalty", 10, 0.3, False),
        ("penalty", 1, 0.9, False),
        ("energy_controlled", 1e4, 0.9, False),
    ],
)
def test_chatter_is_foretold(enforcement, beta, fraction, told):
    """Scenes with a warning gain more than 1 % of energy, those without gain less."""
    data = changed(
        "bar_on_a_wall",
        time={"end": 1.5, "fraction": fraction, "energy_limit": 1e6},
        output={"every": 1},
    )
    epsilon = beta * 900 / 0.1
    for key, value in (("beta", beta), ("epsilon", epsilon)):
        data["obstacle"][0].pop("beta", None)
        data["obstacle"][0].pop("epsilon", None)
        data["obstacle"][0] |= {"enforcement": enforcement, key: value}
        scene = ct.Scene(data)
        assert ("is known to feed energy" in scene.explain()) == told
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            total = scene.run(output=False).energy["total"]
        assert (
            any("bar.x_min" in str(w.message) and enforcement in str(w.message) for w in caught)
            == told
        )
        assert (total.max() / total[0] - 1 > 0.01) == told


def sunk(depth, **keys):
    """A steel cube of 1 m at rest, its lower face in a floor."""
    floor = {"surface": "cube.z_min", "plane": {"point": [0, 0, depth], "normal": [0, 0, 1]}}
    return ct.Scene(
        {
            "units": METRES,
            "material": [{"name": "steel", "young": 2.1e11, "poisson": 0.3, "density": 7800.0}],
            "body": [
                {
                    "name": "cube",
                    "material": "steel",
                    "box": box_of([0, 0, 0], [1, 1, 1], [4, 4, 4]),
                }
            ],
            "obstacle": [{**floor, **keys}],
            "time": {"end": 1e-3},
        }
    )


@pytest.mark.parametrize("depth", [2.5e-3, 25e-3])
def test_a_body_that_begins_inside_an_obstacle_stays_at_rest(depth):
    with pytest.warns(
        ct.SceneWarning, match=r"overlap: obstacle\[0\]: cube.z_min: it overlaps the obstacle by"
    ):
        run = sunk(depth).run(output=False)
    assert not run.energy["total"].any() and not run.state["cube"].displacement.any()
    for place in ("points", "corners", "edges"):
        found = run.penetration[0][place]
        assert found["deepest"] == pytest.approx(depth, rel=1e-12)
        assert found["surface"] == "cube.z_min" and found["inside"] > 0 and found["buried"] == 0
    assert run.penetration[0]["corners"]["position"][2] == 0.0


def test_an_overlap_with_an_obstacle_is_pushed_removed_or_refused():
    # The energy of the penalty, 40 rho c1^2 / h over 1 m^2, stands in the first row.
    modulus = 2.1e11 * 0.7 / (1.3 * 0.4)
    with pytest.warns(ct.SceneWarning, match="overlap: .* adds energy"):
        run = sunk(2.5e-3, initial_penetration="force").run(output=False)
    stored = 0.5 * 40 * modulus / 0.25 * 2.5e-3**2
    assert run.energy["total"][0] == pytest.approx(stored, rel=1e-9)
    with warnings.catch_warnings():
        warnings.filterwarnings("error", "overlap:")
        keys = {"initial_penetration": "remove", "removal_time": 5e-4}
        run = sunk(2.5e-3, **keys).run(output=False)
    work = run.energy["external"][-1]
    assert work > 0.0 and abs(run.energy["total"]).max() < 2e-3 * work
    assert run.penetration[0]["points"]["deepest"] == 0.0
    with pytest.raises(SceneError, match="obstacle: 64 points of its surface are inside"):
        sunk(2.5e-3, initial_penetration="refuse").run(output=False)


def test_explain_tells_of_an_overlap_with_an_obstacle():
    told = sunk(2.5e-3, adjust=1e-4).explain()
    assert "initial penetration keep, adjust 0.0001 m" in told
    assert "it overlaps the obstacle by 0.0025 m " in told
    assert told.data["added"][0]["penetration"]["inside"] == 64


@needs_hdf5
def test_a_restart_carries_start_gaps_of_an_obstacle(tmp_path):
    scene = sunk(2.5e-3, initial_penetration="remove", removal_time=5e-4)
    scene.set_output(every=10)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        whole, rest = scene.run(output=False), continued(scene, tmp_path, 3e-4)
    assert same_state(whole, rest) and rest.energy["total"][-1] == whole.energy["total"][-1]
