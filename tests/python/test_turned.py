"""A scene turned by any angle, and with its surfaces swapped."""

import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import box_of, scene_with

# Place of the upper block and its width: within the lower one, or over two of its edges.
PLACES = {"within": ([0.1, 0.107, 1.05], 0.8137), "overhanging": ([0.3, 0.2, 1.05], 1.0)}


def rotation_of(seed):
    """Any rotation."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.linalg.det(q)
    return q


def oblique(rotation, swapped=False, place="within"):
    """Two blocks with unlike meshes that collide off their centres, all of it turned."""
    origin, side = PLACES[place]
    made = scene_with("m", young=100.0, poisson=0.3, density=1.0, law="st_venant_kirchhoff")
    for name, corner, wide, n, speed in (
        ("low", [0, 0, 0], 1.0, [3, 3, 2], [0, 0, 0.4]),
        ("high", origin, side, [2, 2, 2], [0.1, 0, -0.4]),
    ):
        mesh = Mesh.box("hex8", *box_of(corner, [wide, wide, 1], n).values())
        made.add_body(
            name,
            material="m",
            nodes=mesh.nodes @ rotation.T,
            elements=mesh.elements,
            velocity=(rotation @ speed).tolist(),
        )
    pair = ("high.outer", "low.outer") if swapped else ("low.outer", "high.outer")
    made.add_contact(*pair)
    run = made.set_time(end=0.5, dt=2e-3, force_tolerance=1e-12).set_output(every=20).run()
    return np.concatenate([run.state[b].displacement for b in ("low", "high")]), run


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("seed", range(3))
def test_a_turned_scene(seed, place):
    """Turned by any angle about any axis, the displacements turn with it, to 1e-12 of the largest. Where blocks
    overhang, points with round-off in their reserve come near again, which must not act (:eq:`release-time`)."""
    q = rotation_of(seed)
    here, run = oblique(np.eye(3), place=place)
    there, _ = oblique(q, place=place)
    assert run.energy["strain"].max() > 0.05 * run.energy["kinetic"][0]
    assert np.abs(there - here @ q.T).max() < 1e-12 * np.abs(here).max()


def struck(rotation, radius):
    """A block that falls on a cylinder along an oblique axis, all of it turned."""
    mesh = Mesh.box("hex8", *box_of([-0.5, -0.5, 0.0], [1, 1, 0.6], [3, 3, 2]).values())
    made = scene_with("m", young=100.0, poisson=0.3, density=1.0, law="st_venant_kirchhoff")
    made.add_body(
        "block",
        material="m",
        nodes=mesh.nodes @ rotation.T,
        elements=mesh.elements,
        velocity=(rotation @ [0.05, 0.0, -0.4]).tolist(),
    )
    cylinder = {
        "centre": (rotation @ [0.07, 0.02, -radius - 0.06]).tolist(),
        "axis": (rotation @ [1.0, 0.4, 0.1]).tolist(),
        "radius": radius,
    }
    made.add_obstacle(surface="block.outer", cylinder=cylinder)
    run = made.set_time(end=0.3, dt=2e-3, force_tolerance=1e-12).set_output(every=20).run()
    return run.state["block"].displacement, run.energy["obstacle"]


@pytest.mark.parametrize("radius, limit", [(0.1, 1e-5), (0.6, 1e-12)])
@pytest.mark.parametrize("seed", range(3))
def test_a_turned_block_on_a_cylinder(seed, radius, limit):
    """Whether an obstacle is small (:eq:`station-needed`) and where its stations are (:eq:`station-axis`) does not
    depend on the axes. The closest places of stations have the tolerance of the search, those of points none."""
    q = rotation_of(seed)
    here, energy = struck(np.eye(3), radius)
    assert energy.max() > 0.0
    assert np.abs(struck(q, radius)[0] - here @ q.T).max() < limit * np.abs(here).max()


def test_swapped_surfaces_have_the_same_bits():
    assert np.array_equal(oblique(np.eye(3))[0], oblique(np.eye(3), swapped=True)[0])


def test_a_mirrored_cradle_of_which_a_side_is_held():
    """The rule for a layer between two contacts (:eq:`release-passed`) does not depend on which node is the first."""
    ends = {}
    for side in ("x_min", "x_max"):
        made = scene_with("m", young=1.0, poisson=0.0, density=1.0)
        for i, speed in enumerate((0.01, 0.0, 0.0)):
            made.add_body(
                f"b{i}",
                material="m",
                velocity=[0, 0, speed],
                box=box_of([-2, -2, i], [4, 4, 1], [4, 4, 1]),
            )
        for i in range(2):
            made.add_contact(f"b{i}.z_max", f"b{i + 1}.z_min")
        made.add_support(f"b2.{side}", fix=["x", "y", "z"]).set_time(end=8.0, fraction=0.6)
        ends[side] = made.run(output=False).state
    for one, other in zip(ends["x_min"].values(), ends["x_max"].values(), strict=True):
        order = np.lexsort((one.nodes * [-1, 1, 1]).T), np.lexsort(other.nodes.T)
        moved = one.displacement[order[0]] * [-1, 1, 1]
        assert np.array_equal(moved, other.displacement[order[1]])
