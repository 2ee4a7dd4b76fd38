"""Projections through Python, compared with closed forms and VTK."""

import numpy as np
import pytest
from libcontact.projection import METHODS, Status

import libcontact as ct

QUADRILATERAL = np.array(
    [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float
)
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], float)
REFERENCE = {"Q4": QUADRILATERAL[:4], "Q8": QUADRILATERAL, "T3": TRIANGLE[:3], "T6": TRIANGLE}
KINDS = list(REFERENCE)


BY_VALUES = {"simplex", "nelder_mead"}


def flat(kind):
    return np.column_stack([REFERENCE[kind], np.zeros(len(REFERENCE[kind]))])


def test_the_docstring_names_every_method():
    assert [name for name in METHODS if f'``"{name}"``' not in ct.project.__doc__] == []


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", KINDS)
def test_point_above_a_flat_face(kind, method):
    points = np.array([[0.25, 0.25, 0.5], [0.3, 0.1, -0.25], [0.25, 0.5, 0.0]])
    found = ct.project(kind, flat(kind), points, method=method)
    np.testing.assert_allclose(found.xi, points[:, :2], atol=2e-8)
    np.testing.assert_allclose(found.point, points * [1, 1, 0], atol=2e-8)
    np.testing.assert_allclose(found.signed_distance, points[:, 2], atol=1e-10)
    np.testing.assert_allclose(found.distance, np.abs(points[:, 2]), atol=1e-10)
    assert list(found.where) == ["interior"] * 3
    assert (found.certified == (method == "certified")).all() and found.certified.dtype == bool
    assert (found.evaluations > 0).all()
    assert set(found.status) <= (
        {Status.OK, Status.ITERATION_LIMIT} if method in BY_VALUES else {Status.OK}
    )


@pytest.mark.parametrize("kind", KINDS)
def test_where_tells_interior_edge_vertex_and_outside(kind):
    points = np.array([[0.3, 0.3, 1], [0.3, -4, 1], [-4, -4, 1.0]])
    assert list(ct.project(kind, flat(kind), points).where) == ["interior", "edge", "vertex"]
    assert list(ct.project(kind, flat(kind), points, method="newton").where) == [
        "interior",
        "outside",
        "outside",
    ]


def test_arrays_of_other_kinds_are_taken_when_no_digit_is_lost():
    nodes, points = flat("Q8"), np.random.default_rng(3).uniform(-1, 1, (7, 3))
    want = ct.project("Q8", nodes, points)
    short = ct.project("Q8", nodes.astype(np.float32), np.asfortranarray(points))
    np.testing.assert_array_equal(short.xi, want.xi)
    stepped = np.repeat(points, 2, axis=0)[::2]
    np.testing.assert_array_equal(ct.project("Q8", nodes.tolist(), stepped).distance, want.distance)
    np.testing.assert_array_equal(
        ct.project("Q8", nodes.astype(int), points).distance, want.distance
    )


def test_start_for_one_and_for_all():
    nodes, points = flat("Q4"), np.array([[0.5, 0.5, 1], [-0.5, 0.25, 1]])
    for start in ([0, 0], points[:, :2], points[:, :2].astype(np.float32)):
        found = ct.project("Q4", nodes, points, method="newton", start=start)
        np.testing.assert_allclose(found.xi, points[:, :2], atol=1e-14)
    cold, warm = (
        ct.project("Q4", nodes, points),
        ct.project("Q4", nodes, points, start=points[:, :2]),
    )
    assert (warm.evaluations <= cold.evaluations).all()


def test_lines_that_hit_and_miss():
    points = np.array([[0.25, 0.25, 1], [0.25, 0.25, -2], [5, 0, 1], [np.nan, 0, 0]])
    hits = ct.project_ray("Q4", flat("Q4"), points, [0, 0, 3])
    np.testing.assert_array_equal(hits.distance[:2], [-1, 2])
    assert list(hits.where) == ["interior", "interior", "outside", "outside"]
    assert list(hits.status) == [Status.OK, Status.OK, Status.NO_CONVERGENCE, Status.INVALID]
    assert (
        np.isnan(hits.xi[2:]).all()
        and np.isnan(hits.normal[2:]).all()
        and (hits.normal[:2] == [0, 0, 1]).all()
    )
    assert ct.project_ray("T6", flat("T6"), np.zeros((0, 3)), [0, 0, 1]).xi.shape == (0, 2)
    with pytest.raises(ValueError, match="directions must have shape"):
        ct.project_ray("Q4", flat("Q4"), points, [[0, 0, 1]])
    with pytest.raises(ValueError, match="tolerance must be positive and below 1"):
        ct.project_ray("Q4", flat("Q4"), points, [0, 0, 1], tolerance=1)


def test_no_points_give_empty_arrays():
    found = ct.project("T6", flat("T6"), np.zeros((0, 3)), start=np.zeros((0, 2)))
    assert found.xi.shape == (0, 2) and found.point.shape == (0, 3) and found.where.shape == (0,)


@pytest.mark.parametrize("method", METHODS)
def test_numbers_that_are_not_finite_are_reported_for_each_point(method):
    points = np.array([[0, 0, 1.0], [np.nan, 0, 1], [np.inf, 0, 1]])
    found = ct.project("Q4", flat("Q4"), points, method=method)
    assert list(found.status[1:]) == [Status.INVALID] * 2 and found.status[0] != Status.INVALID
    for name in ("xi", "point", "distance", "signed_distance"):
        assert (
            np.isnan(getattr(found, name)[1:]).all() and np.isfinite(getattr(found, name)[0]).all()
        )
    nodes = flat("Q4")
    nodes[3, 1] = np.nan
    assert (ct.project("Q4", nodes, points, method=method).status == Status.INVALID).all()
    assert ct.project("Q4", np.ones((4, 3)), points[:1], method=method).status[0] == Status.INVALID


@pytest.mark.parametrize(
    ("arguments", "error", "words"),
    [
        (dict(kind="Q5"), ValueError, "kind must be one of Q4, Q8, T3, T6"),
        (dict(nodes=np.zeros((8, 3))), ValueError, r"nodes of a Q4 face must have shape \(4, 3\)"),
        (dict(points=np.zeros(3)), ValueError, r"points must have shape \(m, 3\)"),
        (dict(points=np.zeros((2, 2))), ValueError, "points must have shape"),
        (dict(points=[[1j, 0, 0]]), TypeError, "points must be real"),
        (dict(nodes=[["a"] * 3] * 4), TypeError, "nodes must be real"),
        (dict(method="secant"), ValueError, "method must be one of simplex"),
        (dict(tolerance=0), ValueError, "tolerance must be positive"),
        (dict(tolerance=float("nan")), ValueError, "tolerance must be positive"),
        (dict(start=[0, 0, 0]), ValueError, "start must have shape"),
        (dict(start=[0, np.nan]), ValueError, "start must be finite"),
    ],
)
def test_impossible_arguments_are_named(arguments, error, words):
    given_ = dict(kind="Q4", nodes=flat("Q4"), points=np.zeros((1, 3))) | arguments
    with pytest.raises(error, match=words):
        ct.project(**given_)


def test_node_order_and_shape_functions_are_those_of_vtk():
    vtk = pytest.importorskip("vtk")
    from libcontact._core import ffi, lib
    from libcontact.mesh import Mesh

    cases = [(vtk.vtkHexahedron, "hex8"), (vtk.vtkQuadraticHexahedron, "hex20")]
    for make, kind in cases:
        cell, brick = make(), Mesh.box(kind, [0, 0, 0], [1, 1, 1], [1, 1, 1])
        order = brick.elements[0]
        count = len(order)
        corners = np.reshape([cell.GetParametricCoords()[i] for i in range(3 * count)], (count, 3))
        np.testing.assert_array_equal(brick.nodes[order], corners)
        theirs, point = [0.0] * count, np.array([0.3, 0.8, 0.45])
        cell.InterpolateFunctions(point, theirs)
        np.testing.assert_allclose(brick.shape(2 * point - 1), theirs, atol=1e-14)
        sides = [{list(order).index(n) for n in face} for face in brick.faces("outer")[0]]
        assert all(side in faces_of(cell, count) for side in sides)
    for make, kind, half in [
        (vtk.vtkQuad, "Q4", 2),
        (vtk.vtkQuadraticQuad, "Q8", 2),
        (vtk.vtkTriangle, "T3", 1),
        (vtk.vtkQuadraticTriangle, "T6", 1),
    ]:
        cell, count = make(), len(REFERENCE[kind])
        theirs, N, point = [0.0] * count, ffi.new("double[8]"), [0.3, 0.45, 0.0]
        cell.InterpolateFunctions(point, theirs)
        lib.ct_segment_shape(
            getattr(lib, "CT_" + kind), [half * p - (half - 1) for p in point[:2]], N
        )
        np.testing.assert_allclose(list(N)[:count], theirs, atol=1e-14)


def faces_of(cell, count):
    """The node numbers of the sides of a VTK cell whose node i has the number i."""
    for i in range(count):
        cell.GetPointIds().SetId(i, i)
    sides = []
    for i in range(6):
        side = cell.GetFace(i)
        sides.append({side.GetPointId(j) for j in range(side.GetNumberOfPoints())})
    return sides


# The vector to the closest point, and points of a face.


def test_points_of_a_face_are_those_of_the_polynomial_through_its_nodes():
    rng = np.random.default_rng(5)
    for kind, powers, at in (
        (
            "Q8",
            [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
            [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0)],
        ),
        (
            "T6",
            [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
            [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5)],
        ),
    ):
        nodes = rng.normal(size=(len(at), 3))
        c = np.linalg.solve([[x**i * y**j for i, j in powers] for x, y in at], nodes)
        xi = rng.uniform(-1.5, 1.5, (4, 5, 2))
        want = sum(
            (xi[..., 0] ** i * xi[..., 1] ** j)[..., None] * row for (i, j), row in zip(powers, c)
        )
        np.testing.assert_allclose(ct.face_points(kind, nodes, xi), want, atol=1e-12)
        np.testing.assert_allclose(ct.face_points(kind, nodes, at), nodes, atol=1e-15)
    with pytest.raises(ValueError, match="xi"):
        ct.face_points("Q4", np.zeros((4, 3)), 0.0)


@pytest.mark.parametrize("method", ["simplex", "newton", "bfgs", "robust", "certified"])
def test_a_path_ends_at_the_foot_that_project_finds(method):
    nodes = np.array([[-1, -1, 0.1], [1.2, -1, -0.2], [1, 1, 0.3], [-1, 0.9, 0.2]])
    path, found = ct.project_path("Q4", nodes, [0.2, -0.3, 0.8], method, start=(0.5, 0.5))
    plain = ct.project("Q4", nodes, [[0.2, -0.3, 0.8]], method, start=(0.5, 0.5))
    assert len(path) > 2 and path[-1].tobytes() == plain.xi[0].tobytes()
    assert (found.evaluations[0], found.status[0], found.distance[0]) == (
        plain.evaluations[0],
        plain.status[0],
        plain.distance[0],
    )
    distance = np.linalg.norm(ct.face_points("Q4", nodes, path) - [0.2, -0.3, 0.8], axis=1)
    assert distance[-1] <= distance.min() + 1e-15


def test_a_path_of_a_wrong_point_is_refused():
    with pytest.raises(ValueError, match="point"):
        ct.project_path("T3", np.eye(3), [1.0, 2.0])
