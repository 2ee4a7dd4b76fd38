"""Surfaces with overlaps and gaps at the start: different meshes of one curved surface, separated blocks, folds; with
each enforcement, friction, restarts and threads."""

import itertools
import warnings

import numpy as np
import pytest
from libcontact.model import ENFORCEMENTS
from scenes import EDGES, METRES, box_of, continued, same_state, scene_with

import libcontact as ct

CORNERS = [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)]
INNER, MIDDLE, OUTER, WIDTH = 0.8, 1.0, 1.2, 0.2


def quarter(inner, outer, facets, quadratic):
    """Nodes, elements and the nodes at the inner radius with their forces of a uniform pressure, of a quarter of a
    cylindrical shell with one element over its thickness."""
    step = 2 if quadratic else 1
    number, nodes = {}, []
    for i, j, k in itertools.product(range(facets * step + 1), range(step + 1), range(step + 1)):
        if quadratic and i % 2 + j % 2 + k % 2 > 1:
            continue
        number[i, j, k] = len(nodes)
        angle, radius = np.pi / 2 * i / (facets * step), inner + (outer - inner) * j / step
        nodes.append((radius * np.cos(angle), radius * np.sin(angle), WIDTH * k / step))
    elements, share = [], {}
    chord = 2 * inner * np.sin(np.pi / 4 / facets)
    for f in range(facets):
        corners = [((f + a) * step, b * step, c * step) for a, b, c in CORNERS]
        middles = (
            [tuple((np.array(corners[p]) + corners[q]) // 2) for p, q in EDGES] if quadratic else []
        )
        elements.append([number[place] for place in corners + middles])
        # A face with mid-sides has -1/12 of the force of a uniform pressure at each corner and 1/3 at each mid-side.
        for place in corners + middles:
            if place[1] == 0:
                on_corner = all(index % step == 0 for index in place)
                part = (-1 / 12 if on_corner else 1 / 3) if quadratic else 1 / 4
                share[number[place]] = share.get(number[place], 0.0) + part * chord * WIDTH
    rows = sorted(share)
    return np.array(nodes), elements, rows, np.array([share[row] for row in rows])


def scene_of(name, contact, **bodies):
    scene = ct.Scene(title=name, units=METRES)
    scene.add_material("soft", young=100.0, poisson=0.3, density=1.0)
    for body, given in bodies.items():
        scene.add_body(body, material="soft", **given)
    return scene.add_contact("a.outer", "b.outer", **contact)


def shells(facets_a, facets_b, quadratic=False, turn=None, velocity=(0, 0, 0), **contact):
    """Two nested quarter shells that should touch at the radius 1; the inner one moves."""
    bodies = {}
    for body, facets, inner, outer in (
        ("a", facets_a, INNER, MIDDLE),
        ("b", facets_b, MIDDLE, OUTER),
    ):
        nodes, elements, _, _ = quarter(inner, outer, facets, quadratic)
        bodies[body] = {"nodes": nodes if turn is None else nodes @ turn.T, "elements": elements}
    bodies["a"]["velocity"] = list(velocity)
    return scene_of("shells", contact, **bodies)


def mean_pressure(facets_a, facets_b, quadratic, **contact):
    """Mean of the pressure between the shells, at rest under a uniform inner pressure of 0.1; and the contact's energy
    at the start."""
    scene = shells(facets_a, facets_b, quadratic, **contact)
    for body in "ab":
        for face, axis in (("x_min", "x"), ("y_min", "y"), ("z_min", "z"), ("z_max", "z")):
            scene.add_support(f"{body}.{face}", fix=[axis])
    nodes, _, rows, share = quarter(INNER, MIDDLE, facets_a, quadratic)
    outward = nodes[rows] * [1.0, 1.0, 0.0] / INNER
    force = 0.1 * share[:, None] * outward
    scene.add_effect("inside", "a", rows, lambda view: force)
    scene.add("damping", relaxation=True).set_time(
        end=10, fraction=0.8, until_static=1e-6
    ).set_output(every=1000, fields=[])
    run = scene.run()
    points = run.contact[0]
    return (points["raw_pressure"] * points["weight"]).sum() / 2 / (
        np.pi / 2 * MIDDLE * WIDTH
    ), run.energy["contact"][0]


@pytest.mark.parametrize(
    "facets_a, facets_b, quadratic", [(4, 5, False), (8, 11, False), (3, 4, True)]
)
def test_shells_of_unlike_meshes_press_as_matching_ones(facets_a, facets_b, quadratic):
    """Adjusted, they start without energy and have the mean pressure of shells with the coarser mesh on both sides;
    otherwise the gaps of the facets stay."""
    matching, _ = mean_pressure(facets_a, facets_a, quadratic)
    adjusted, begin = mean_pressure(facets_a, facets_b, quadratic, adjust=0.08)
    assert begin == 0.0
    assert adjusted == pytest.approx(matching, rel=0.01)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "overlap:")
        kept, _ = mean_pressure(facets_a, facets_b, quadratic)
    assert kept < 0.985 * matching


@pytest.mark.parametrize(
    "facets_a, facets_b, quadratic", [(16, 12, False), (12, 16, False), (3, 4, True), (7, 6, True)]
)
def test_unloaded_rings_stay_at_rest(facets_a, facets_b, quadratic):
    """For any orientation: exactly no energy, whether gaps are closed or only overlaps are kept."""
    chance = np.random.default_rng(facets_a)
    for adjust in (None, 0.1):
        turn, _ = np.linalg.qr(chance.normal(size=(3, 3)))
        turn *= np.linalg.det(turn)
        with warnings.catch_warnings():
            warnings.filterwarnings("error" if adjust else "ignore", "overlap:")
            run = (
                shells(facets_a, facets_b, quadratic, turn, adjust=adjust)
                .set_time(end=0.3, fraction=0.8)
                .set_output(every=1, fields=[])
                .run()
            )
        start = run.contact[0]["start_gap"]
        assert (start < 0.0).any() and (start > 1e-12).any() == bool(adjust)
        assert not run.energy["total"].any()
        assert not any(run.state[body].displacement.any() for body in "ab")


def test_an_overlap_is_told():
    """Once, with advice; not if surfaces touch to rounding, nor if adjust covers the overlap."""

    def told(run):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run()
        return [str(w.message) for w in caught if str(w.message).startswith("overlap:")]

    def rings(**contact):
        return shells(16, 12, **contact).set_time(end=0.01, fraction=0.8)

    (kept,), (pushed,) = (
        told(lambda how=how: rings(**how).run()) for how in ({}, {"initial_penetration": "force"})
    )
    sag = 1.0 - np.cos(
        np.pi / 48
    )  # of the 12 facets of a quarter, whose middles are closest to the axis
    assert (
        "overlap by 0.00127 m " in kept
        and "at 96 points" in kept
        and "no energy is added" in kept
        and f"adjust = {1.1 * sag:.2g}" in kept
    )
    assert "adds energy" in pushed
    assert kept in str(rings().explain())
    assert told(rings(adjust=0.1).run) == []
    (removed,) = told(rings(initial_penetration="remove", removal_time=1.0).run)
    assert "the pressure follows the faces" in removed
    assert "adjust 0.1" in str(rings(adjust=0.1).explain())
    # Two cubes that share a face, far from the origin and rotated, so that its coordinates are rounded.
    angle = 0.3
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    cube = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    cells = [[0, 4, 6, 2, 1, 5, 7, 3]]
    apart = {
        "a": {"nodes": cube @ turn.T + 1000, "elements": cells},
        "b": {"nodes": (cube + [1, 0, 0]) @ turn.T + 1000, "elements": cells},
    }
    assert told(lambda: scene_of("cubes", {}, **apart).set_time(end=0.1, fraction=0.5).run()) == []


def blocks(gap, speed=0.0, pull=0.0, **contact):
    """A block over a slab with a gap, which moves down with a speed and is pulled along it."""
    scene = scene_of(
        "blocks",
        contact,
        a={"box": box_of([-1, 0, -1], [4, 1, 1], [8, 2, 2])},
        b={"box": box_of([0, 0, gap], [1, 1, 1], [3, 3, 3]), "velocity": [pull, 0, -speed]},
    )
    return (
        scene.add_support("a.z_min", fix=["x", "y", "z"])
        .set_time(end=0.12, fraction=0.4)
        .set_output(every=1)
    )


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("enforcement", ENFORCEMENTS)
def test_a_closed_gap_is_as_good_as_touching(enforcement):
    """With an adjusted gap or overlap the motion is that of touching blocks, for each enforcement."""
    touching = blocks(0.0, 0.1, enforcement=enforcement).run()
    for gap in (0.02, -0.02):
        run = blocks(gap, 0.1, enforcement=enforcement, adjust=0.03).run()
        assert run.energy["contact"][0] == pytest.approx(touching.energy["contact"][0], rel=1e-9)
        # The faces tilt slightly, which moves closest points by the gap times the tilt.
        assert run.state["b"].displacement == pytest.approx(
            touching.state["b"].displacement,
            abs=1e-3 * np.abs(touching.state["b"].displacement).max(),
        )
        points = run.contact[0]
        bottom = points[points["start_gap"] != 0.0]
        # The gap of the law and the start gap add up to the true distance.
        distance = np.linalg.norm(bottom["closest"] - bottom["position"], axis=1)
        assert np.abs(bottom["gap"] + bottom["start_gap"]) == pytest.approx(distance, abs=1e-14)


def test_friction_takes_the_pressure_of_closed_gaps():
    """A block slides over a closed gap or overlap: the impulse of friction is mu times that of the pressure, and the
    total momentum does not change."""
    for gap in (0.0, 0.02, -0.02):
        run = blocks(gap, 0.1, 0.3, adjust=0.03, friction=0.25, enforcement="penalty").run()
        momentum = run.body_momentum("b")
        drag, press = (
            momentum["p"][-1][0] - momentum["p"][0][0],
            momentum["p"][-1][2] - momentum["p"][0][2],
        )
        assert drag == pytest.approx(-0.25 * press, rel=2e-3)
        assert press > 0.0
        assert run.impulse["friction"] == pytest.approx([0.0, 0.0, 0.0], abs=1e-13)


def test_only_surfaces_that_face_each_other_are_adjusted():
    # eq:initial-facing
    """A large distance closes the gap under a block, not those between the walls of the block and the slab around
    it."""
    points = blocks(0.02, adjust=0.3).run().contact[0]
    near = points[points["start_gap"] != 0.0]
    assert near["start_gap"] == pytest.approx(0.02, abs=1e-12)
    bottom = points[(points["side"] == 1) & (np.abs(points["position"][:, 2] - 0.02) < 1e-9)]
    under = points[
        (points["side"] == 0)
        & (np.abs(points["position"][:, 2]) < 1e-9)
        & (points["position"][:, 0] > 0)
        & (points["position"][:, 0] < 1)
    ]
    assert len(bottom) == 36 and len(near) == len(bottom) + len(under)


def test_a_fold_that_gapes_is_closed():
    """The legs of a hairpin, with a gap below the distance, are in contact as soon as they approach; no other part
    is."""
    for adjust in (0.0, 0.15):
        boxes = [(x, 0) for x in range(6)] + [(5, 1)] + [(x, 2) for x in range(6)]
        corners = np.array([[x + a, y + b, c] for x, y in boxes for a, b, c in CORNERS], float)
        nodes, elements = np.unique(corners, axis=0, return_inverse=True)
        nodes[:, 1] = np.array([0.0, 1.0, 1.1, 2.1])[nodes[:, 1].astype(int)]
        scene = scene_with("soft", young=100.0, poisson=0.3, density=1.0, title="hairpin")
        order = [0, 3, 2, 1, 4, 7, 6, 5]
        scene.add_body(
            "u", material="soft", nodes=nodes, elements=elements.reshape(-1, 8)[:, order]
        )
        scene.add_contact("u.outer", "u.outer", depth=0.2, adjust=adjust)
        tip = np.flatnonzero(nodes[:, 1] == 2.1)
        scene.add_support("u.y_min", fix=["x", "y", "z"]).add_effect(
            "press", "u", tip, lambda view: np.full((len(tip), 3), [0.0, -0.02, 0.0])
        )
        run = scene.set_time(end=3.0, fraction=0.6).set_output(every=1).run()
        points = run.contact[0]
        assert run.energy["contact"][0] == 0.0
        assert (points["raw_pressure"] > 0.0).any() == bool(adjust)
        assert np.isin(points["start_gap"].round(12), [0.0, 0.1] if adjust else [0.0]).all()


def test_start_gaps_are_in_a_restart_and_do_not_depend_on_threads(tmp_path):
    """Shells with different meshes that collide: the same bits after a restart, and with two threads."""
    pytest.importorskip("h5py")
    scene = shells(5, 7, velocity=(0.3, 0.2, 0.0), adjust=0.05)
    scene.set_time(end=0.4, fraction=0.5).set_output(every=5)
    whole = scene.run()
    assert whole.energy["contact"].max() > 0.0
    assert same_state(whole, scene.run(threads=2))
    assert same_state(whole, continued(scene, tmp_path, 0.2))


def test_moving_shells_keep_their_energy():
    """They slide, separate and close again with start gaps of both signs: with the plain penalty and small steps the
    total is constant."""
    scene = shells(6, 7, velocity=(0.3, 0.1, 0.0), adjust=0.05, enforcement="penalty", beta=1.0)
    run = scene.set_time(end=1.5, fraction=0.1).set_output(every=5, fields=[]).run()
    total = run.energy["total"]
    assert run.energy["contact"].max() > 0.01 * total[0]
    assert np.abs(total - total[0]).max() < 2e-3 * total[0]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("steps", [1, 3])
def test_the_end_of_a_fade_makes_no_energy(steps):
    """The blocks press while the start gap fades within some steps: its last part counts, too."""
    fade = {"initial_penetration": "remove", "removal_time": 0.01 * steps}
    total = blocks(0.02, 2.0, adjust=0.03, **fade).run().energy["total"]
    assert (total - np.minimum.accumulate(total)).max() < 1e-12 * total[0]


def test_a_distance_beyond_the_depth_is_refused():
    with pytest.raises(
        ct.SceneError, match="adjust must be at most the depth of the search, 0.25, not 0.3"
    ):
        blocks(0.0, adjust=0.3, depth=0.25).run()
    with pytest.raises(ct.SceneError, match="adjust"):
        blocks(0.0, adjust=-0.1)
