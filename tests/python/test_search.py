"""The nearest face of a surface: a cube, moves, bad input."""

import numpy as np
import pytest

import libcontact as ct

CUBE = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
SIDES = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
TRIANGLES = np.concatenate([SIDES[:, [0, 1, 2]], SIDES[:, [0, 2, 3]]])


def cube_distance(points):
    """Signed distance from the unit cube."""
    beyond = np.maximum(np.abs(points - 0.5) - 0.5, 0)
    inside = (np.abs(points - 0.5) - 0.5).max(axis=1)
    return np.where(inside > 0, np.linalg.norm(beyond, axis=1), inside)


@pytest.mark.parametrize("kind, faces", [("Q4", SIDES), ("T3", TRIANGLES)])
def test_cube(kind, faces):
    points = np.random.default_rng(1).uniform(-1, 2, (5000, 3))
    found = ct.nearest(kind, CUBE, faces, points)
    assert np.abs(found.signed_distance - cube_distance(points)).max() < 1e-14
    assert set(found.where) == {"interior", "edge", "vertex"}
    assert (found.status == ct.Status.OK).all()
    assert np.abs(np.linalg.norm(found.point - points, axis=1) - found.distance).max() < 1e-14
    assert ((found.index == -1) == (found.where == "interior")).all()
    outwards = np.einsum("ij,ij->i", points - found.point, found.normal)
    assert (np.sign(outwards) == np.sign(found.signed_distance)).all()


def test_moved_surface():
    surface = ct.Surface("Q4", CUBE, SIDES)
    surface.move(CUBE + 10)
    assert surface.nearest([[10.5, 10.5, 12]]).signed_distance[0] == 1
    assert surface.builds == 1 and surface.cost == pytest.approx(1, rel=1e-3)


def test_points_without_an_answer():
    found = ct.nearest("T3", CUBE, TRIANGLES, [[np.nan, 0, 0], [np.inf, 0, 0], [0.5, 0.5, 2]])
    assert found.status.tolist() == [ct.Status.INVALID, ct.Status.INVALID, ct.Status.OK]
    assert found.face[0] == -1 and np.isnan(found.distance[:2]).all() and found.distance[2] == 1


def test_no_points():
    assert ct.nearest("T3", CUBE, TRIANGLES, np.zeros((0, 3))).face.shape == (0,)


@pytest.mark.parametrize(
    "kind, nodes, faces, error",
    [
        ("Q5", CUBE, SIDES, ValueError),
        ("Q4", CUBE[:, :2], SIDES, ValueError),
        ("Q4", CUBE, SIDES[:, :3], ValueError),
        ("Q4", CUBE, SIDES[:0], ValueError),
        ("Q4", CUBE, SIDES + 1, ValueError),
        ("Q4", CUBE, SIDES.astype(float), TypeError),
        ("Q4", CUBE + np.nan, SIDES, ValueError),
        ("T3", CUBE, [[0, 1, 1]], ct.GeometryError),
        ("T3", CUBE.astype(complex), TRIANGLES, TypeError),
    ],
)
def test_refused(kind, nodes, faces, error):
    with pytest.raises(error):
        ct.Surface(kind, nodes, faces)


@pytest.mark.parametrize(
    "bad",
    [
        {"start": [6]},
        {"start": [-2]},
        {"start": [0, 0]},
        {"tolerance": 0},
        {"tolerance": np.inf},
        {"threads": 0},
    ],
)
def test_refused_queries(bad):
    with pytest.raises(ValueError):
        ct.Surface("Q4", CUBE, SIDES).nearest([[0, 0, 0]], **bad)


def test_refused_move_changes_nothing():
    surface = ct.Surface("Q4", CUBE, SIDES)
    for nodes in (CUBE[:5], np.where(CUBE == 1, np.inf, CUBE)):
        with pytest.raises(ValueError):
            surface.move(nodes)
    assert surface.nearest([[0.5, 0.5, 2]]).distance[0] == 1
