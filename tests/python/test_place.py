"""Bodies that stand turned and moved (``[body.place]``), against closed forms and scenes turned as a whole."""

import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import box_of, scene_with

import libcontact as ct

SIZE, CORNER = np.array([1.0, 1.0, 1.0]), np.arctan(np.sqrt(2.0))
STANDS = {"angle": CORNER, "axis": [1, -1, 0], "centre": [0, 0, 0], "move": [0, 0, 0.01]}


def cube(
    element="hex8", place=None, velocity=(0.0, 0.0, -1.0), normal=(0.0, 0.0, 1.0), side="outer"
):
    """A cube that flies into a plane through the origin."""
    scene = scene_with("soft", young=1e5, poisson=0.3, density=1000.0)
    box = box_of([0, 0, 0], SIZE, [3, 3, 3])
    given = {"element": element, "velocity": [*velocity]} | ({"place": place} if place else {})
    scene.add_body("cube", material="soft", box=box, **given)
    scene.add_obstacle(surface=f"cube.{side}", plane={"point": [0, 0, 0], "normal": [*normal]})
    return scene.set_time(end=0.15, fraction=0.9)


def quaternion(axis, angle):
    """The matrix of a rotation by the formula of its quaternion, which the library does not use."""
    x, y, z = np.sin(angle / 2) * np.array(axis) / np.linalg.norm(axis)
    w = np.cos(angle / 2)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


@pytest.mark.parametrize("element", ["hex8", "hex20"])
def test_a_cube_stands_on_its_corner(element):
    """The space diagonal is vertical: heights 0, √3/3, 2√3/3 and √3 above the lowest corner, and no stress at the
    start, though the law is for small strain."""
    run = cube(element, STANDS).run(output=False, until=1e-9)
    corners = np.unique(np.round(run.state["cube"].nodes[:, 2] - 0.01, 12))
    assert {0.0, *np.round(np.sqrt(3) * np.array([1, 2, 3]) / 3, 12)} <= set(corners)
    assert corners[0] == 0.0 and corners[-1] == np.round(np.sqrt(3), 12)
    assert run.energy["strain"][0] == 0.0


def test_sides_keep_their_names():
    """The side x_max of a turned cube strikes a plane as that of the cube as it is given."""
    turn = quaternion([1, 2, 3], 0.7)
    place = {"angle": 0.7, "axis": [1, 2, 3], "centre": [0, 0, 0], "move": -turn[:, 0]}
    there = cube(place=place, velocity=turn[:, 0], normal=-turn[:, 0], side="x_max")
    here = cube(place={"move": [-1, 0, 0]}, velocity=[1, 0, 0], normal=[-1, 0, 0], side="x_max")
    impulses = [scene.run(output=False).momentum["obstacle_impulse"] for scene in (here, there)]
    assert impulses[0][-1][0] < -1000
    np.testing.assert_allclose(impulses[1], impulses[0] @ turn.T, atol=1e-9)


def test_a_place_is_a_turned_scene():
    """The cube falls obliquely on its corner; turned with the plane and the velocity it has the same energies."""
    turn, v = quaternion([2, -1, 1], 1.1), np.array([0.2, 0.1, -1.0])
    here = cube(place=STANDS, velocity=v).run(output=False)
    both = turn @ quaternion(STANDS["axis"], CORNER)
    # The axis and the angle of the product of two rotations.
    axis = np.array([both[2, 1] - both[1, 2], both[0, 2] - both[2, 0], both[1, 0] - both[0, 1]])
    angle = np.arctan2(np.linalg.norm(axis) / 2, (np.trace(both) - 1) / 2)
    place = {"angle": angle, "axis": axis, "centre": [0, 0, 0], "move": turn @ [0, 0, 0.01]}
    there = cube(place=place, velocity=turn @ v, normal=turn[:, 2]).run(output=False)
    assert here.energy["strain"].max() > 10
    for name in ("kinetic", "strain", "obstacle"):
        np.testing.assert_allclose(there.energy[name], here.energy[name], atol=1e-9)


def test_two_bodies_of_one_mesh_file(tmp_path, monkeypatch):
    """A file is used twice, as long as the places differ; a moved one has the same masses."""
    monkeypatch.chdir(tmp_path)
    mesh = Mesh.box("hex8", (0, 0, 0), (2, 1, 1), (2, 1, 1))
    meshio = pytest.importorskip("meshio")
    meshio.write("brick.vtu", meshio.Mesh(mesh.nodes, [("hexahedron", mesh.elements)]))
    scene = scene_with("soft", young=1e5, poisson=0.3, density=1000.0)
    scene.add_body("left", material="soft", mesh="brick.vtu")
    scene.add_body(
        "right", material="soft", mesh="brick.vtu", place={"move": [2, 0, 0]}, velocity=[-1, 0, 0]
    )
    scene.add_contact(surfaces=["left.x_max", "right.x_min"])
    run = scene.set_time(end=0.01, fraction=0.9).run(output=False)
    np.testing.assert_allclose(
        run.body_momentum("left")["p"][-1] + run.body_momentum("right")["p"][-1], [-2000, 0, 0]
    )
    assert run.body_momentum("left")["contact_impulse"][-1][0] < -100
    assert "placed between (2, 0, 0) and (4, 1, 1) m" in str(scene.explain())


@pytest.mark.parametrize(
    "place, key, reason",
    [
        ({"angle": 1.0, "axis": [0, 0, 0]}, ".axis", "is 0"),
        ({"move": [0, 0, 0]}, "", "gives no angle and no move"),
        ({"turn": 90}, ".turn", "unknown key"),
    ],
)
def test_wrong_places_are_refused(place, key, reason):
    with pytest.raises(ct.SceneError, match=rf"body\[0\].place{key}: {reason}"):
        cube(place=place).explain()
