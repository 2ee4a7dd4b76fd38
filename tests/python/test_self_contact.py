"""Scenes with a body in contact with itself: a hairpin that a falling block closes, thin bodies and neighbouring faces
without contact."""

import warnings

import fuzz_self
import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import METRES, box_of, continued, same_state, scene_with

import libcontact as ct

LEG, THICK, GAP = 0.6, 0.1, 0.08


def hairpin(element="hex8"):
    """A strip folded once; nodes, elements."""
    mesh = Mesh.box(element, (0, 0, 0), (1, 0.2, 1), (18, 2, 2))
    return fuzz_self.folded(mesh.nodes, LEG, THICK, GAP), mesh.elements


def press(surfaces, element="hex8", enforcement="energy_controlled", **changes):
    """A block falls on the upper leg; the lower leg is free, so that no external force acts."""
    nodes, elements = hairpin(element)
    top = GAP / 2 + THICK
    block = box_of([0, -0.05, top + 0.005], [0.2, 0.3, 0.2], [2, 3, 2])
    scene = {
        "units": METRES,
        "material": [
            {"name": "soft", "young": 1e5, "poisson": 0.3, "density": 1000.0},
            {"name": "heavy", "young": 1e6, "poisson": 0.3, "density": 4000.0},
        ],
        "body": [
            {"name": "u", "nodes": nodes, "elements": elements, "material": "soft"},
            {
                "name": "block",
                "box": block,
                "element": "hex8",
                "material": "heavy",
                "velocity": [0, 0, -0.6],
            },
        ],
        "contact": [{"surfaces": ["block.outer", "u.outer"], "beta": 1}],
        "time": {"end": 0.25, "fraction": 0.5},
        "output": {"every": 20},
    }
    if surfaces:
        scene["contact"].append({"surfaces": surfaces, "beta": 1})
    for contact in scene["contact"]:
        contact["enforcement"] = enforcement
    scene.update(changes)
    return ct.Scene(scene)


def overlap(run):
    """Penetration of the end of the upper leg into the lower one: the surfaces that face each other."""
    state = run.state["u"]
    inner = {
        sign: np.isclose(state.nodes[:, 2], sign * GAP / 2) & (state.nodes[:, 0] < 0.5 * LEG)
        for sign in (-1, 1)
    }
    low, high = (state.positions[inner[sign]] for sign in (-1, 1))
    # Both are nearly straight along x: compare at the places of the upper nodes, column by column in y.
    return max(
        float(np.interp(x, *low[np.argsort(low[:, 0])][:, [0, 2]].T) - z) for x, _, z in high
    )


@pytest.fixture(scope="module", params=["hex8", "hex20"])
def pressed(request):
    """The time of deepest penetration: a run that is stopped then, with and without contact of the hairpin with
    itself."""
    element = request.param
    changes = {"time": {"end": 0.12, "fraction": 0.5}}
    return press(["u.outer", "u.outer"], element, **changes).run(), press(
        None, element, **changes
    ).run()


def test_the_layers_of_a_fold_do_not_pass_through_each_other(pressed):
    with_contact, without = pressed
    assert overlap(without) > 0.4 * GAP, "the block is to drive one leg into the other"
    assert overlap(with_contact) < 0.1 * GAP
    points = with_contact.contact[1]
    pushed = points[points["raw_pressure"] > 0.0]
    assert len(pushed) > 6 and set(points["side"]) == {0}
    assert np.all(np.abs(pushed["position"][:, 2] - pushed["closest"][:, 2]) < 0.1 * GAP)


@pytest.mark.parametrize(
    "enforcement, lost, won", [("penalty", 0.02, 0.02), ("energy_controlled", 0.05, 1e-9)]
)
def test_momentum_and_energy_of_a_fold_that_closes_and_opens_again(enforcement, lost, won):
    run = press(["u.outer", "u.outer"], enforcement=enforcement).run()
    assert run.energy["contact"].max() > 1e-3 * run.energy["total"][0], "the contact is to matter"
    size = 4000.0 * 0.2 * 0.3 * 0.2
    p = sum(run.body_momentum(body)["p"] for body in run.bodies)
    assert np.abs(p - p[0]).max() < 1e-12 * size
    total = run.energy["total"]
    assert (total / total[0] - 1.0).max() < won and (total / total[0] - 1.0).min() > -lost
    assert np.abs(run.energy["balance"]).max() < 1e-12 * total[0]


def test_two_faces_of_one_body_meet_as_the_faces_of_two_bodies_do():
    """Contact acts only where inner sides of the fold face each other: without all other faces nothing changes, and
    threads and order have no influence."""
    whole = press(["u.outer", "u.outer"]).run(until=0.12)
    for surfaces in (["u.z_min", "u.outer"], ["u.outer", "u.y_min"]):
        part = press(surfaces).run(until=0.12, threads=2)
        assert part.state["u"].positions.tobytes() == whole.state["u"].positions.tobytes()


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_a_run_that_is_stopped_in_self_contact_goes_on_with_the_same_bits(tmp_path):
    scene = press(["u.outer", "u.outer"], time={"end": 0.12, "fraction": 0.5})
    assert same_state(scene.run(), continued(scene, tmp_path, 0.1))


def plate(surfaces):
    """A thin plate in free flight without spin: it must not deform, for any surface in contact with itself."""
    return ct.Scene(
        {
            "units": METRES,
            "material": [{"name": "soft", "young": 1e5, "poisson": 0.3, "density": 1000.0}],
            "body": [
                {
                    "name": "p",
                    "box": box_of([0, 0, 0], [1, 1, 0.05], [5, 5, 1]),
                    "material": "soft",
                    "velocity": [3, 2, 1],
                }
            ],
            "contact": [{"surfaces": surfaces}],
            "time": {"end": 0.01, "fraction": 0.5},
        }
    )


@pytest.mark.parametrize(
    "surfaces",
    [
        ["p.z_min", "p.z_max"],
        ["p.x_max", "p.z_max"],
        ["p.outer", "p.z_min"],
        ["p.y_min", "p.y_min"],
    ],
)
def test_the_far_side_of_a_plate_and_its_neighbouring_sides_are_no_contact(surfaces):
    run = plate(surfaces).run()
    assert run.energy["contact"].max() == 0.0
    assert run.energy["strain"].max() < 1e-20 * run.energy["kinetic"][0]
    assert not any("overlap" in warning for warning in plate(surfaces).explain().data["warnings"])


def closing_pages(seed: int, sign: np.ndarray) -> np.ndarray:
    """Two uneven pages with friction that close about the edge between them, in a host; mirrored by `sign`, and back:
    where their nodes are at the end."""
    rng = np.random.default_rng(seed)
    s, t = np.meshgrid(np.linspace(-1, 1, 7), np.linspace(0, 1, 4), indexing="ij")
    x = np.stack([-0.3 * np.abs(s), s, t], -1).reshape(-1, 3) + 0.02 * rng.normal(size=(28, 3))
    v = np.stack([-2 * x[:, 1] ** 2, -4 * x[:, 1], 0 * x[:, 2]], -1)
    v += 0.3 * rng.normal(size=(28, 3))
    x, v, dt = x * sign, v * sign, 2e-3
    node = np.arange(28).reshape(7, 4)
    corners = [node[:-1, :-1], node[1:, :-1], node[1:, 1:], node[:-1, 1:]]
    faces = np.stack(corners, -1).reshape(-1, 4)
    surface = ct.Surface("Q4", x, faces if sign.prod() > 0 else faces[:, ::-1])
    contact = ct.Contact(surface, epsilon=1e4, friction=1.0, travel_time=1e-3)
    for step in range(400):
        tau, force = dt if step else dt / 2, np.zeros_like(x)
        contact.step(dt, x, v, np.ones_like(x), force, force_time=tau)
        contact.add_force(force)
        v = v + tau * force
        x = x + dt * v
    return x * sign


@pytest.mark.parametrize("seed", [0, 5])
def test_mirrored_pages_with_friction_have_the_same_bits(seed):
    """Points without a force do not stick (eq:slip-stick): whether their slips are known depends on the order of
    points, of which some of a face press."""
    one, other = (closing_pages(seed, np.array([1.0, 1.0, sign])) for sign in (1.0, -1.0))
    np.testing.assert_array_equal(one, other)


def test_explain_tells_who_meets_itself():
    explained = press(["u.outer", "u.outer"]).explain()
    contact = explained.data["contacts"][1]
    outer = 2 * (18 * 2 + 18 * 2 + 2 * 2)
    assert (
        contact["with_itself"]
        and contact["faces"] == [outer]
        and contact["gauss_points"] == [4 * outer]
    )
    assert 0.9 * GAP < contact["initial_gap"] <= GAP, (
        "the ring between the legs is a polygon, a little narrower than they"
    )
    assert f"contact u.outer with itself: {outer} faces of one body" in explained
    two = press(["u.y_min", "u.y_max"]).explain()
    assert (
        two.data["contacts"][1]["faces"] == [2 * 18 * 2]
        and "contact u.y_min with u.y_max: 72 faces of one body" in two
    )
    assert not two.data["contacts"][0]["with_itself"]


def test_a_scene_piece_by_piece():
    scene = scene_with("soft", young=1e5, poisson=0.3, density=1000.0)
    nodes, elements = hairpin()
    scene.add_body("u", material="soft", nodes=nodes, elements=elements).add_contact(
        "u.outer", "u.outer"
    ).set_time(end=1e-3, fraction=0.5)
    assert scene.explain().data["contacts"][0]["with_itself"]


def test_a_body_whose_ends_move_apart_does_not_pass_through_itself():
    """A folded strip that is squeezed: distant parts have different velocities, which ended the run by the check of
    passage (eq:tunnelling). Without restitution no part comes back so fast that a step is divided for good reason."""
    made, about = fuzz_self.scene(7)
    data = made.data
    for contact in data["contact"]:
        contact["restitution"] = 0.0
    run = ct.Scene(data).run(output=False)
    assert len(run.divisions) == 0, about


@pytest.mark.parametrize("seed", range(20000, 20012))
def test_random_scenes_of_bodies_that_meet_themselves_come_to_their_end(seed):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        kind, about, divided = fuzz_self.run(seed)
    assert (kind, divided) == ("end", 0), about
