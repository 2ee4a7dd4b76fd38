"""Mesh files of other programs: volumes and areas against closed forms, sets, conversion to bricks, refusals."""

import math
import sys
import zipfile
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from libcontact.meshes import read_mesh

DATA = Path(__file__).resolve().parents[1] / "data"
sys.path.insert(0, str(DATA))
import meshes as made  # noqa: E402

# Corners of the faces of a brick, as `ct_brick_face` has them.
FACES = np.array(
    [[3, 0, 4, 7], [1, 2, 6, 5], [0, 1, 5, 4], [2, 3, 7, 6], [1, 0, 3, 2], [4, 5, 6, 7]]
)
HEX = (
    2.0
    * np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    )
    - 1.0
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The archive of tests/data, unpacked."""
    path = tmp_path_factory.mktemp("meshes")
    with zipfile.ZipFile(DATA / "meshes.zip") as archive:
        archive.extractall(path)
    return path


def gradients(mesh):
    """Per element and corner: the integral of the gradient of the shape function; and the volumes. Of trilinear bricks
    the rule of 2 x 2 x 2 points is exact."""
    x = mesh.nodes[mesh.elements[:, :8]]
    total, volume = np.zeros(x.shape), np.zeros(len(x))
    for xi in HEX / math.sqrt(3.0):
        factors = 1.0 + HEX * xi
        dN = np.stack(
            [HEX[:, a] * factors[:, (a + 1) % 3] * factors[:, (a + 2) % 3] / 8 for a in range(3)], 1
        )
        J = np.einsum("eaj,ak->ejk", x, dN)
        total += np.einsum("ak,ekj->eaj", dN, np.linalg.inv(J)) * np.linalg.det(J)[:, None, None]
        volume += np.linalg.det(J)
    return total, volume


def volume(mesh, name=None):
    """Volume of the mesh or of a set of elements."""
    found = gradients(mesh)[1]
    return found.sum() if name is None else found[mesh.element_sets[name]].sum()


def corners(mesh, name):
    """Coordinates of the corners of the faces of a set, shape (m, 4, 3)."""
    element, face = mesh.face_sets[name].T
    return mesh.nodes[mesh.elements[element[:, None], FACES[face]]]


def area(mesh, name):
    """Area of a set of plane faces."""
    a, b, c, d = corners(mesh, name).transpose(1, 0, 2)
    return np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2.0


def polygon(points):
    """Area and perimeter of a polygon."""
    ring = [*points, points[0]]
    twice = sum(a[0] * b[1] - b[0] * a[1] for a, b in pairwise(ring))
    return twice / 2.0, sum(math.dist(a, b) for a, b in pairwise(ring))


def outer_faces(mesh):
    """Faces that one element has alone, without those that are collapsed to an edge."""
    faces = mesh.elements[:, FACES].reshape(-1, 4)
    keys = np.sort(faces, axis=1)
    keys[:, 1:][np.diff(keys, axis=1) == 0] = -1
    keys = np.sort(keys, axis=1)
    faces, keys = faces[keys[:, 1] >= 0], keys[keys[:, 1] >= 0]
    _, first, count = np.unique(keys, axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def check_patch(mesh):
    """A constant stress is in equilibrium at all inner nodes, so the mesh has no gaps and no hanging nodes."""
    total, _ = gradients(mesh)
    force = np.zeros(mesh.nodes.shape)
    np.add.at(force, mesh.elements[:, :8], total)
    inner = np.setdiff1d(np.arange(len(force)), np.unique(outer_faces(mesh)))
    assert inner.size and np.abs(force[inner]).max() < 1e-13 * np.abs(total).max()


BIG, SMALL = made.gear(8, 0.8, 1.0), made.gear(6, 0.6, 0.8)


def test_a_pair_of_gears_keeps_its_bodies_and_flanks(folder):
    mesh = read_mesh(folder / "gears.msh")
    assert mesh.report.format == "Gmsh 4.1"
    for name, outline, hole in (
        ("big", BIG, made.regular(8, 0.4)),
        ("small", SMALL, made.regular(6, 0.3)),
    ):
        (outer, around), (inner, hub) = polygon(outline), polygon(hole)
        assert volume(mesh, name) == pytest.approx(0.5 * (outer - inner), rel=1e-12)
        assert area(mesh, f"{name}_outer") == pytest.approx(0.5 * around, rel=1e-12)
        assert area(mesh, f"{name}_hole") == pytest.approx(0.5 * hub, rel=1e-12)
        one = read_mesh(folder / "gears.msh", part=name)
        assert set(one.face_sets) == {f"{name}_outer", f"{name}_hole"}
        assert volume(one) == pytest.approx(0.5 * (outer - inner), rel=1e-12)
        assert set(np.unique(one.elements)) == set(range(len(one.nodes)))
        assert area(one, f"{name}_outer") == pytest.approx(0.5 * around, rel=1e-12)


def test_faces_of_a_set_point_out_of_the_body(folder):
    mesh = read_mesh(folder / "rings.msh")
    for name, sign in (("outer_in", -1), ("outer_out", 1), ("inner_in", -1), ("inner_out", 1)):
        a, b, c, d = corners(mesh, name).transpose(1, 0, 2)
        middle = (a + b + c + d) / 4.0 * [1.0, 1.0, 0.0]
        assert (sign * (np.cross(c - a, d - b) * middle).sum(axis=1) > 0.0).all()


def test_rings_of_16_and_12_facets(folder):
    mesh = read_mesh(folder / "rings.msh", scale=1e-3)
    for name, n, r, R in (("outer", 16, 1.0, 1.2), ("inner", 12, 0.8, 0.99)):
        section = n / 2 * math.sin(2 * math.pi / n) * (R * R - r * r)
        assert volume(mesh, name) == pytest.approx(0.5e-9 * section, rel=1e-12)
        assert len(mesh.face_sets[f"{name}_in"]) == n
        assert area(mesh, f"{name}_out") == pytest.approx(
            1e-6 * n * R * math.sin(math.pi / n), rel=1e-12
        )


@pytest.mark.parametrize("file", ["notch.msh", "notch22.msh"])
def test_a_notched_block_of_two_materials_shares_its_interface(folder, file):
    mesh = read_mesh(folder / file)
    assert volume(mesh, "steel") == pytest.approx(0.48, rel=1e-12)
    assert volume(mesh, "rubber") == pytest.approx(0.48, rel=1e-12)
    assert not set(mesh.element_sets["steel"]) & set(mesh.element_sets["rubber"])
    assert len(mesh.element_sets["steel"]) + len(mesh.element_sets["rubber"]) == len(mesh.elements)
    assert area(mesh, "steel_end") == pytest.approx(0.5, rel=1e-12)
    check_patch(mesh)


@pytest.mark.parametrize("file", ["cam.msh", "cam.inp"])
def test_a_cam_of_bricks_and_wedges_becomes_bricks(folder, file):
    mesh = read_mesh(folder / file)
    (outer, around), (hole, hub) = (
        polygon([(1.2 * x, y) for x, y in made.regular(20, 1.0)]),
        polygon(made.regular(8, 0.35)),
    )
    assert mesh.report.read["wedge6"] > 0 and mesh.report.read["hex8"] > 0
    assert volume(mesh) == pytest.approx(0.5 * (outer - hole), rel=1e-12)
    for name, exact in (
        ("bottom", outer - hole),
        ("top", outer - hole),
        ("cam_outer", 0.5 * around),
        ("cam_hole", 0.5 * hub),
    ):
        assert area(mesh, name) == pytest.approx(exact, rel=1e-12), name
    assert set(np.unique(mesh.nodes[:, 2])) == {0.0, 0.25, 0.5}  # the layers are not split
    # A wedge stays one element: a brick with a collapsed side.
    assert len(mesh.elements) == sum(mesh.report.read.values()) and not mesh.report.split
    check_patch(mesh)


def test_tetrahedra_become_four_bricks_each(folder):
    mesh = read_mesh(folder / "tets.msh")
    assert len(mesh.elements) == 4 * mesh.report.read["tet4"]
    assert volume(mesh) == pytest.approx(6.0, rel=1e-12)
    assert area(mesh, "x_zero") == pytest.approx(6.0, rel=1e-12)
    # A line gives nodes, and the middles of its edges join them.
    edge = mesh.nodes[mesh.node_sets["edge"]]
    assert (np.ptp(edge, axis=0) > 0).sum() == 1 and len(edge) == 2 * mesh.report.dropped[
        "line2"
    ] + 1
    check_patch(mesh)


# A wedge with a tetrahedron on it, three bricks in a row beside it, and one beside the row.
MIXED = """*Node
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 1, 0, 1
6, 0, 1, 1
7, .25, .25, 2
11, 0, -1, 0
12, 1, -1, 0
13, 0, -1, 1
14, 1, -1, 1
21, 0, -2, 0
22, 1, -2, 0
23, 0, -2, 1
24, 1, -2, 1
31, 2, 0, 0
32, 2, -1, 0
33, 2, 0, 1
34, 2, -1, 1
*Element, type=C3D6, elset=Wedge
1, 1, 2, 3, 4, 5, 6
*Element, type=C3D4, elset=Tet
2, 4, 5, 6, 7
*Element, type=C3D8, elset=Row
3, 11, 12, 2, 1, 13, 14, 5, 4
4, 21, 22, 12, 11, 23, 24, 14, 13
*Element, type=C3D8, elset=Beside
5, 12, 32, 31, 2, 14, 34, 33, 5
*Surface, name=Front
Row, S4
Beside, S3
*Surface, name=Below
Wedge, S1
*Nset, nset=Low
1, 2, 11, 12
"""


def test_a_tetrahedron_splits_its_neighbours_as_far_as_they_must_be(tmp_path):
    path = tmp_path / "mixed.inp"
    path.write_text(MIXED)
    mesh = read_mesh(path)
    counts = {name: len(found) for name, found in mesh.element_sets.items()}
    assert counts == {"Wedge": 3, "Tet": 4, "Row": 4, "Beside": 1}
    for name, exact in (("Wedge", 1 / 2), ("Tet", 1 / 6), ("Row", 2.0), ("Beside", 1.0)):
        assert volume(mesh, name) == pytest.approx(exact, rel=1e-12)
    assert area(mesh, "Below") == pytest.approx(0.5) and len(mesh.face_sets["Below"]) == 3
    assert area(mesh, "Front") == pytest.approx(3.0)
    assert sorted(mesh.nodes[mesh.node_sets["Low"]].tolist()) == [
        [0.0, -1.0, 0.0], [0.0, 0.0, 0.0], [0.5, -1.0, 0.0], [0.5, 0.0, 0.0], [1.0, -1.0, 0.0], [1.0, 0.0, 0.0]
    ]  # fmt: skip
    # No inner face is left open: the outer faces have the area of the body's surface.
    a, b, c, d = mesh.nodes[outer_faces(mesh)].transpose(1, 0, 2)
    sides = math.hypot(0.25, 1.0) * 2 / 2 + math.sqrt(2) * math.hypot(0.5 / math.sqrt(2), 1.0) / 2
    exact = 0.5 + 1.0 + math.sqrt(2) + sides + 8.0 + 5.0  # wedge, tetrahedron, row, beside
    assert np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2 == pytest.approx(
        exact, rel=1e-12
    )
    assert 0.1 < mesh.report.step_factor < 0.5


def test_quadratic_bricks_have_their_nodes_in_the_order_of_vtk(folder):
    mesh = read_mesh(folder / "hex20.msh")
    assert mesh.elements.shape == (12, 20) and area(mesh, "top") == pytest.approx(2.0)
    x = mesh.nodes[mesh.elements]
    ends = [
        (0, 1),
        (1, 2),
        (2, 3),
        (3, 0),
        (4, 5),
        (5, 6),
        (6, 7),
        (7, 4),
        (0, 4),
        (1, 5),
        (2, 6),
        (3, 7),
    ]
    for i, (a, b) in enumerate(ends):
        assert np.allclose(x[:, 8 + i], (x[:, a] + x[:, b]) / 2.0, atol=1e-14)


def test_a_plate_is_extruded(folder):
    with pytest.raises(ValueError, match=r"extrude = \[height, layers\]"):
        read_mesh(folder / "plate.msh")
    mesh = read_mesh(folder / "plate.msh", extrude=(0.6, 3), scale=10.0)
    flat, _ = polygon([(0, 0), (2, 0), (2, 1), (0.5, 1.2)])
    assert volume(mesh) == pytest.approx(600.0 * flat, rel=1e-12)
    assert area(mesh, "base") == pytest.approx(100.0 * 2.0 * 0.6, rel=1e-12)
    assert len(mesh.element_sets["plate"]) == len(mesh.elements)
    assert np.allclose(np.unique(mesh.nodes[:, 2]), [0.0, 2.0, 4.0, 6.0], atol=1e-14)
    check_patch(mesh)


@pytest.mark.parametrize("file", ["blocks.g", "blocks3.g"])
def test_blocks_and_sets_of_exodus(folder, file):
    mesh = read_mesh(folder / file)
    assert {name: each.tolist() for name, each in mesh.element_sets.items()} == {
        "left": [0],
        "right": [1],
    }
    assert np.all(corners(mesh, "front")[..., 0] == 2.0) and area(mesh, "front") == 1.0
    assert np.all(corners(mesh, "side_set_8")[..., 2] == 1.0) and area(mesh, "side_set_8") == 2.0
    assert mesh.nodes[mesh.node_sets["node_set_3"]].tolist() == [
        [0, 0, 0],
        [0, 1, 0],
        [0, 0, 1],
        [0, 1, 1],
    ]
    right = read_mesh(folder / file, part="right")
    assert (
        len(right.nodes) == 8
        and set(right.face_sets) == {"front", "side_set_8"}
        and not right.node_sets
    )
