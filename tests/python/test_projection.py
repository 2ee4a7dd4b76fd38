"""Projections through Python, against closed forms, fifty-digit arithmetic and VTK."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from libcontact.projection import METHODS, Status

import libcontact as ct

mp = pytest.importorskip("mpmath")

QUADRILATERAL = np.array(
    [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float
)
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]], float)
REFERENCE = {"Q4": QUADRILATERAL[:4], "Q8": QUADRILATERAL, "T3": TRIANGLE[:3], "T6": TRIANGLE}
KINDS = list(REFERENCE)
numbers = st.floats(-1, 1, allow_subnormal=False)


def shape(kind, x, y):
    """Shape functions written from the book's formulas, for any number type."""
    if kind[0] == "T":
        L = [1 - x - y, x, y]
        if kind == "T3":
            return L
        return [a * (2 * a - 1) for a in L] + [4 * L[i] * L[(i + 1) % 3] for i in range(3)]
    corners = [
        ((1 + a * x) * (1 + b * y), a * x + b * y - 1) for a, b in QUADRILATERAL[:4].astype(int)
    ]
    if kind == "Q4":
        return [c / 4 for c, _ in corners]
    sides = [
        (1 - x * x) * (1 - y) / 2,
        (1 + x) * (1 - y * y) / 2,
        (1 - x * x) * (1 + y) / 2,
        (1 - x) * (1 - y * y) / 2,
    ]
    return [c * e / 4 for c, e in corners] + sides


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


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.lists(numbers, min_size=24, max_size=24),
    st.lists(numbers, min_size=3, max_size=3),
)
def test_newton_from_the_robust_foot_agrees_with_fifty_digits(kind, noise, point):
    """Where the foot is inside, fifty-digit Newton from it moves by rounding only, whatever the shape of the face."""
    count = len(REFERENCE[kind])
    nodes = flat(kind) + 0.1 * np.reshape(noise, (8, 3))[:count]
    found = ct.project(kind, nodes, [point])
    if found.where[0] != "interior" or found.status[0] != Status.OK:
        return
    with mp.workdps(50):

        def gradient(x, y):
            def f(x, y):
                N = shape(kind, x, y)
                d = [
                    sum(n * mp.mpf(node[k]) for n, node in zip(N, nodes.tolist()))
                    - mp.mpf(point[k])
                    for k in range(3)
                ]
                return sum(c * c for c in d)

            return mp.diff(f, (x, y), (1, 0)), mp.diff(f, (x, y), (0, 1))

        start = [mp.mpf(float(v)) for v in found.xi[0]]
        root = mp.findroot(gradient, start, tol=1e-30)
        for a in range(2):
            assert abs(root[a] - start[a]) <= 1e-10 * (1 if kind[0] == "Q" else 0.5)


@settings(max_examples=100, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.lists(numbers, min_size=24, max_size=24),
    st.lists(numbers, min_size=3, max_size=3),
)
def test_no_sample_of_the_face_is_closer(kind, noise, point):
    count = len(REFERENCE[kind])
    nodes = flat(kind) + 0.1 * np.reshape(noise, (8, 3))[:count]
    found = ct.project(kind, nodes, [point])
    x, y = np.meshgrid(np.linspace(-1, 1, 41), np.linspace(-1, 1, 41))
    if kind[0] == "T":
        x, y = (1 + x) / 2, (1 + y) / 2
        inside = x + y <= 1
        x, y = x[inside], y[inside]
    face = sum(n[..., None] * node for n, node in zip(map(np.asarray, shape(kind, x, y)), nodes))
    assert found.distance[0] <= np.linalg.norm(face - point, axis=-1).min() + 1e-14
    assert found.distance[0] == pytest.approx(np.linalg.norm(found.point[0] - point), abs=1e-15)


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


@settings(max_examples=100, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.lists(numbers, min_size=24, max_size=24),
    st.lists(numbers, min_size=3, max_size=3),
)
def test_what_is_certified_no_method_beats(kind, noise, point):
    count = len(REFERENCE[kind])
    nodes = flat(kind) + 0.5 * np.reshape(noise, (8, 3))[:count]
    best = ct.project(kind, nodes, [3 * np.array(point)], method="certified")
    if best.status[0] == Status.INVALID:
        return
    assert best.certified[0] == (best.status[0] == Status.OK)
    size = max(best.distance[0], np.ptp(nodes, axis=0).max())
    for method in METHODS:
        found = ct.project(kind, nodes, [3 * np.array(point)], method=method)
        if best.certified[0] and found.where[0] != "outside" and found.status[0] != Status.INVALID:
            assert best.distance[0] <= found.distance[0] + 1e-10 * size


@settings(max_examples=60, deadline=None)
@given(
    st.sampled_from(KINDS),
    st.lists(numbers, min_size=24, max_size=24),
    st.tuples(numbers, numbers),
    numbers,
)
def test_a_line_along_the_normal_comes_back_to_the_foot(kind, noise, place, gap):
    nodes = flat(kind) + 0.05 * np.reshape(noise, (8, 3))[: len(REFERENCE[kind])]
    x = np.array(place) if kind[0] == "Q" else np.array([(1 + place[0]) / 4, (1 + place[1]) / 4])
    foot = np.array(shape(kind, *x)) @ nodes
    normal = ct.project(kind, nodes, [foot], method="newton", start=x)
    up = ct.project_ray(kind, nodes, [foot], [0, 0, 1]).normal
    found = ct.project_ray(kind, nodes, foot + 0.2 * gap * up, up)
    assert normal.distance[0] < 1e-14 and found.status[0] == Status.OK
    np.testing.assert_allclose(found.xi[0], x, atol=1e-12)
    np.testing.assert_allclose(found.distance, -0.2 * gap, atol=1e-13)


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


# The way to the foot, and points of a face.


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


def test_newton_is_done_on_a_triangle_after_one_step():
    """f is a quadratic polynomial there, so the step from any start leads to the foot; the paper says so."""
    rng = np.random.default_rng(9)
    for _ in range(50):
        nodes, point, start = rng.normal(size=(3, 3)), rng.normal(size=3), rng.uniform(0, 0.5, 2)
        path, _ = ct.project_path("T3", nodes, point, "newton", start=start)
        edges = (nodes[1:] - nodes[0]).T
        foot = np.linalg.lstsq(edges, point - nodes[0], rcond=None)[0]
        scale = np.linalg.cond(edges) ** 2 * (1 + np.abs(foot).max())
        assert np.abs(path[0] - start).max() == 0.0
        assert np.abs(path[1] - foot).max() < 1e-13 * scale


def test_a_path_of_a_wrong_point_is_refused():
    with pytest.raises(ValueError, match="point"):
        ct.project_path("T3", np.eye(3), [1.0, 2.0])


# What a change of names or of place must not change.


# Corners in another order that means the same face: new[i] = old[ORDER[i]], with the reference coordinates that the old foot has there.
TURNS = {
    "Q4": ([1, 2, 3, 0], lambda xi: np.array([xi[1], -xi[0]])),
    "Q8": ([1, 2, 3, 0, 5, 6, 7, 4], lambda xi: np.array([xi[1], -xi[0]])),
    "T3": ([1, 2, 0], lambda xi: np.array([xi[1], 1 - xi[0] - xi[1]])),
    "T6": ([1, 2, 0, 4, 5, 3], lambda xi: np.array([xi[1], 1 - xi[0] - xi[1]])),
}


def wavy(rng, kind):
    """A curved face of size about 1 and a point over it, none of whose feet are far."""
    nodes = flat(kind) + rng.uniform(-0.12, 0.12, (len(REFERENCE[kind]), 3))
    place = rng.uniform(0.1, 0.4, 2) if kind[0] == "T" else rng.uniform(-0.8, 0.8, 2)
    return nodes, ct.face_points(kind, nodes, place) + [0, 0, rng.uniform(-0.4, 0.4)]


@pytest.mark.parametrize("method", ["newton", "bfgs", "robust", "certified"])
@pytest.mark.parametrize("kind", KINDS)
def test_a_face_whose_nodes_are_numbered_from_another_corner_has_the_same_foot(kind, method):
    rng = np.random.default_rng(77)
    order, turned = TURNS[kind]
    for _ in range(60):
        nodes, point = wavy(rng, kind)
        a = ct.project(kind, nodes, [point], method)
        if method in ("robust", "certified") or a.where[0] == "interior":
            b = ct.project(
                kind,
                nodes[order],
                [point],
                method,
                start=None if method in ("robust", "certified") else turned(a.xi[0]) + 0.01,
            )
            assert a.distance[0] == pytest.approx(b.distance[0], abs=1e-14)
            assert (a.where[0], a.certified[0]) == (b.where[0], b.certified[0])
            assert np.abs(a.point[0] - b.point[0]).max() < 1e-9
            assert np.abs(turned(a.xi[0]) - b.xi[0]).max() < 2e-9
            assert a.signed_distance[0] == pytest.approx(b.signed_distance[0], abs=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_a_face_that_is_turned_over_has_the_other_sign(kind):
    """Corners clockwise: the normal looks the other way, and nothing else changes."""
    over = {
        "Q4": [0, 3, 2, 1],
        "Q8": [0, 3, 2, 1, 7, 6, 5, 4],
        "T3": [0, 2, 1],
        "T6": [0, 2, 1, 5, 4, 3],
    }[kind]
    rng = np.random.default_rng(78)
    for _ in range(60):
        nodes, point = wavy(rng, kind)
        a, b = ct.project(kind, nodes, [point]), ct.project(kind, nodes[over], [point])
        assert a.signed_distance[0] == pytest.approx(-b.signed_distance[0], abs=1e-14)
        assert a.where[0] == b.where[0] and np.abs(a.xi[0][::-1] - b.xi[0]).max() < 2e-9


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_face_that_is_turned_and_moved_has_the_turned_and_moved_foot(kind, method):
    rng = np.random.default_rng(79)
    for _ in range(30):
        nodes, point = wavy(rng, kind)
        q, r = np.linalg.qr(rng.normal(size=(3, 3)))
        q *= np.sign(np.diag(r))
        q *= np.sign(np.linalg.det(q))
        shift = rng.uniform(-5, 5, 3)
        a = ct.project(kind, nodes, [point], method, 1e-9)
        b = ct.project(kind, nodes @ q.T + shift, [q @ point + shift], method, 1e-9)
        if (
            a.status[0] == b.status[0] == Status.OK and np.abs(a.xi - b.xi).max() < 0.1
        ):  # else rounding has sent a free method another way
            assert a.distance[0] == pytest.approx(b.distance[0], abs=1e-13)
            assert np.abs(q @ a.point[0] + shift - b.point[0]).max() < 1e-7
        if method in ("robust", "certified"):
            assert (
                a.distance[0] == pytest.approx(b.distance[0], abs=1e-13)
                and a.where[0] == b.where[0]
            )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", KINDS)
def test_each_extreme_number_has_its_status(kind, method):
    nodes, point = flat(kind), np.array([0.2, 0.3, 0.5])
    plain = ct.project(kind, nodes, [point], method)
    status = lambda own, place: ct.project(kind, own, [place], method).status[0]
    assert plain.status[0] in (Status.OK, Status.NOT_CERTIFIED, Status.ITERATION_LIMIT)
    # Bit for bit as long as squares and fourth powers stay normal.
    for power in (2.0**-200, 2.0**200):
        same = ct.project(kind, power * nodes, [power * point], method)
        assert (
            same.xi.tobytes() == plain.xi.tobytes()
            and same.distance[0] == power * plain.distance[0]
            and same.status[0] == plain.status[0]
        )
    for huge in (1e300, -1e300, 1.7e308, np.inf, np.nan):
        assert status(nodes, [huge, 0, 0]) == Status.INVALID
        one = nodes.copy()
        one[1, 2] = huge
        assert status(one, point) == Status.INVALID
    for tiny in (0.0, 5e-324, 1e-310, 1e-300):  # no face is left
        assert status(tiny * nodes, point) == Status.INVALID
    low = nodes.copy()  # a denormal is a number like others where it does not matter
    low[:, 2] = 5e-324
    assert ct.project(kind, low, [point], method).distance[0] == plain.distance[0]
    found = ct.project(kind, nodes, [[0.2, 0.3, 5e-324]], method)
    assert 0.0 <= found.distance[0] < 1e-7 and found.status[0] != Status.INVALID
