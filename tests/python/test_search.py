"""The nearest face of a surface: closed forms, brute force through ct.project, promises about starts and threads, bad input."""

import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

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


def soup(seed, count, kind):
    """Faces that have nothing to do with each other."""
    rng = np.random.default_rng(seed)
    shape = {
        "Q4": [[0, 0], [1, 0], [1, 1], [0, 1]],
        "T3": [[0, 0], [1, 0], [0, 1]],
        "T6": [[0, 0], [2, 0], [0, 2], [1, 0], [1, 1], [0, 1]],
        "Q8": [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1]],
    }[kind]
    flat = np.array(shape, float) / np.max(shape)
    frames = rng.normal(size=(count, 2, 3))
    nodes = (
        flat @ frames
        + rng.uniform(-5, 5, (count, 1, 3))
        + rng.normal(scale=0.08, size=(count, len(flat), 3))
    )
    return nodes.reshape(-1, 3), np.arange(count * len(flat)).reshape(count, -1)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 40),
    kind=st.sampled_from(["Q4", "Q8", "T3", "T6"]),
    scale=st.sampled_from([1.0, 2.0**-30, 2.0**30]),
)
def test_brute_force(seed, count, kind, scale):
    nodes, faces = soup(seed, count, kind)
    points = np.random.default_rng(seed + 1).uniform(-6, 6, (60, 3)) * scale
    nodes = nodes * scale
    found = ct.nearest(kind, nodes, faces, points)
    all_faces = np.array([ct.project(kind, nodes[face], points).distance for face in faces])
    assert np.abs(found.distance - all_faces.min(axis=0)).max() < 1e-13 * scale
    chosen = all_faces[found.face, np.arange(len(points))]
    assert np.abs(chosen - all_faces.min(axis=0)).max() < 1e-13 * scale


def same_bits(a, b):
    return all(
        np.array_equal(
            getattr(a, f.name), getattr(b, f.name), equal_nan=getattr(a, f.name).dtype.kind == "f"
        )
        for f in dataclasses.fields(a)
    )


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), kind=st.sampled_from(["Q4", "Q8", "T3", "T6"]))
def test_no_bit_depends_on_order_starts_threads_or_history(seed, kind):
    rng = np.random.default_rng(seed)
    nodes, faces = soup(seed, 30, kind)
    surface = ct.Surface(kind, nodes, faces)
    points = rng.uniform(-6, 6, (3000, 3))
    points[:100] = nodes[rng.integers(0, len(nodes), 100)]
    found = surface.nearest(points)
    assert same_bits(found, surface.nearest(points, start=rng.integers(-1, 30, 3000)))
    assert same_bits(found, surface.nearest(points, threads=2))
    order = rng.permutation(3000)
    again = surface.nearest(points[order])
    for field in dataclasses.fields(found):
        assert np.array_equal(getattr(found, field.name)[order], getattr(again, field.name))
    surface.move(nodes + rng.normal(scale=3, size=nodes.shape))
    surface.move(nodes)
    assert same_bits(found, surface.nearest(points))


def test_moved_surface():
    surface = ct.Surface("Q4", CUBE, SIDES)
    surface.move(CUBE + 10)
    assert surface.nearest([[10.5, 10.5, 12]]).signed_distance[0] == 1
    assert surface.builds == 1 and surface.cost == pytest.approx(1, rel=1e-3)


def test_equal_faces_the_first_wins():
    found = ct.nearest("Q4", CUBE, np.repeat(SIDES[1:2], 7, axis=0), [[0.5, 0.5, 3]])
    assert found.face[0] == 0 and found.distance[0] == 2


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
