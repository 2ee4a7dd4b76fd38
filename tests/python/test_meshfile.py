"""Mesh files of other programs: volumes and areas against closed forms, sets, conversion to bricks, refusals."""

import json
import math
import sys
import zipfile
from functools import cache
from itertools import pairwise, permutations
from pathlib import Path

import h5py
import meshes as made
import meshio
import numpy as np
import pytest
from commands import captured
from libcontact.command import main
from libcontact.errors import NotBuiltIn
from libcontact.mesh import Mesh
from libcontact.meshes import read_mesh

DATA = Path(__file__).resolve().parents[1] / "data"
DECK = (DATA / "deck.inp").read_text()  # two blocks, one on the other and turned

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
    assert mesh.elements.flags.c_contiguous  # C reads them
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
    with pytest.raises(
        ValueError, match=r"extrude = { height = .*, layers = .* }.*--extrude HEIGHT LAYERS"
    ):
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


def deck(tmp_path, text=DECK):
    path = tmp_path / "deck.inp"
    path.write_text(text)
    return path


def test_parts_instances_and_surfaces_of_abaqus(tmp_path):
    mesh = read_mesh(deck(tmp_path))
    assert len(mesh.elements) == 2 and volume(mesh) == pytest.approx(4.0, rel=1e-15)
    assert set(mesh.element_sets) >= {"Lower", "Upper", "Block", "Lower.All", "Upper.All"}
    upper = mesh.nodes[mesh.elements[mesh.element_sets["Upper"][0]]]
    # (x, y, z) goes to (-y, x, z + 1); a quarter turn is exact.
    assert np.array_equal(upper.min(axis=0), [-1, 0, 1]) and np.array_equal(
        upper.max(axis=0), [0, 2, 2]
    )
    assert np.all(corners(mesh, "Upper.Lid")[..., 2] == 2.0) and area(mesh, "Upper.Lid") == 2.0
    assert np.all(corners(mesh, "Meet")[..., 2] == 1.0) and area(mesh, "Meet") == 4.0
    assert mesh.nodes[mesh.node_sets["Held"]].tolist() == [
        [0, 0, 0],
        [2, 0, 0],
        [2, 1, 0],
        [0, 1, 0],
    ]
    assert len(mesh.node_sets["Lower.Generated"]) == 4
    assert mesh.report.dropped["MASS"] == 1 and "Reference" in mesh.report.notes[0]
    one = read_mesh(deck(tmp_path), part="upper")
    assert set(one.node_sets) == {"Low", "Top", "Generated"} and set(one.face_sets) == {
        "Lid",
        "Meet",
    }
    assert len(one.elements) == 1 and area(one, "Meet") == 2.0


def test_a_file_is_included_only_from_its_own_folder(tmp_path):
    inner = tmp_path / "in"
    inner.mkdir()
    nodes, rest = (
        DECK[DECK.index("1, 0.") : DECK.index("*Node, nset=Top")],
        DECK.index("*Node, nset=Top"),
    )
    head = DECK[: DECK.index("1, 0.")]
    for where, name in ((inner, "nodes.txt"), (tmp_path, "outside.txt")):
        (where / name).write_text(nodes)
    (inner / "sub").mkdir()
    (inner / "sub" / "nodes.txt").write_text(nodes)
    (inner / "link.txt").symlink_to(tmp_path / "outside.txt")
    wanted = read_mesh(deck(tmp_path))
    for source in ("nodes.txt", "sub/nodes.txt"):
        for card in (f"*INCLUDE, INPUT={source}\n", f"*INCLUDE, INPUT={source}"):
            mesh = read_mesh(deck(inner, head + card.rstrip() + "\n" + DECK[rest:]))
            assert np.array_equal(mesh.nodes, wanted.nodes)
    for source in ("../outside.txt", "/etc/passwd", str(tmp_path / "outside.txt"), "link.txt", ""):
        with pytest.raises(ValueError, match=r'deck.inp", line 5: .* is not in the folder'):
            read_mesh(deck(inner, f"{head}*INCLUDE, INPUT={source}\n{DECK[rest:]}"))
    with pytest.raises(ValueError, match="included within itself"):
        read_mesh(deck(inner, head + "*INCLUDE, INPUT=deck.inp\n"))
    (inner / "loop.txt").write_text("*INCLUDE, INPUT=loop.txt\n")
    with pytest.raises(ValueError, match="included within itself"):
        read_mesh(deck(inner, head + "*INCLUDE, INPUT=loop.txt\n"))


CUBE = "*Node\n" + "".join(
    f"{i}, {x}, {y}, {z}\n" for i, (x, y, z) in enumerate(((np.array(HEX) + 1) / 2).tolist(), 1)
)
BRICK = "*Element, type=C3D8\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"


@pytest.mark.parametrize(
    "text, reason",
    [
        (
            CUBE + BRICK.replace("5, 6, 7, 8", "5, 6, 7, 9"),
            "line 11: element 1 has node 9, which is not",
        ),
        (CUBE + BRICK + "1, 1, 2, 3, 4, 5, 6, 7, 8\n", "line 12: element 1 is defined twice"),
        (
            CUBE + BRICK + "2, 2, 3, 4, 1, 6, 7, 8, 5\n",
            "line 12: element 2 has the corners of element 1",
        ),
        (CUBE + BRICK.replace("1, 2, 3, 4,", "4, 3, 2, 1,"), "line 11: element 1 is inverted"),
        (CUBE.replace(", 1.0\n", ", 0.0\n") + BRICK, "line 11: element 1 is collapsed"),
        (CUBE + "1, 0, 0, 0\n" + BRICK, "line 10: node 1 is defined twice"),
        (
            CUBE.replace("0.0", "nan", 1) + BRICK,
            "line 2: coordinates: a number of .* is not finite",
        ),
        (CUBE + BRICK.replace("3, 4", "x, 4"), "line 11: element: .* are no whole numbers"),
        (CUBE + BRICK + "*Nset, nset=none\n", 'the node set "none" is empty'),
        (CUBE + BRICK + "*Elset, elset=e\n7\n", 'line 12: the set "e" has element 7, which is not'),
        (CUBE + BRICK + "*Elset, elset=e\nf\n", 'line 13: no set "F" is defined above'),
        (
            CUBE + BRICK + "*Nset, nset=n, generate\n1, 2000000000\n",
            "line 12: 1 to 2000000000 by 1 are",
        ),
        (CUBE + BRICK + "*Surface, name=s\n1, S7\n", "line 13: hex8 has no face S7"),
        (CUBE + BRICK.replace("5, 6, 7, 8", "5, 6"), "line 11: element .* has too few nodes"),
        (CUBE + BRICK.replace("C3D8", "C3D5").replace(", 6, 7, 8", ""), "element 1 is a pyramid5"),
        (CUBE + "*Element, type=SPRINGA\n1, 1, 2\n", r"has no elements that are read \(SPRINGA\)"),
        (CUBE + "*Instance, name=a, part=b\n", 'line 10: no part "B" is defined above'),
        (CUBE.replace("*Node", "*Node, system=C") + BRICK, "line 1: only coordinates of SYSTEM=R"),
    ],
)
def test_a_mistake_in_a_text_file_is_named_with_its_line(tmp_path, text, reason):
    with pytest.raises(ValueError, match=f'deck.inp".*{reason}'):
        read_mesh(deck(tmp_path, text))


@pytest.mark.parametrize(
    "kind, width, cure",
    [
        ("C3D10", 10, "ElementOrder = 1"),
        ("C3D15", 15, "ElementOrder = 1"),
        ("C3D27", 27, "SecondOrderIncomplete"),
    ],
)
def test_kinds_that_do_not_become_bricks_are_refused_with_a_cure(tmp_path, kind, width, cure):
    nodes = "".join(f"{i}, {i}, 0, 0\n" for i in range(1, width + 1))
    row = ", ".join(map(str, range(1, width + 1)))
    with pytest.raises(
        ValueError, match=rf"element 7 is a \w+, which does not become bricks: .*{cure}"
    ):
        read_mesh(deck(tmp_path, f"*Node\n{nodes}*Element, type={kind}\n7, {row}\n"))


def test_a_face_of_three_elements_is_refused(tmp_path):
    text = (
        CUBE
        + "9, 2, 0, 0\n10, 2, 1, 0\n11, 2, 0, 1\n12, 2, 1, 1\n13, 3, 0, 0\n14, 3, 1, 0\n15, 3, 0, 1\n16, 3, 1, 1\n"
    )
    bricks = "2, 2, 9, 10, 3, 6, 11, 12, 7\n3, 2, 13, 14, 3, 6, 15, 16, 7\n"
    with pytest.raises(
        ValueError, match="line 21: element 3 shares a face with both element 1 and element 2"
    ):
        read_mesh(deck(tmp_path, text + BRICK + bricks))


# As Gmsh 4.15 writes a brick that is in two groups in version 2.2: once for each, with two numbers.
TWICE = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 3 "top"
3 1 "one"
3 2 "two"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 0 1 0
4 1 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
3
1 3 2 3 27 5 6 7 8
3 5 2 1 1 1 2 4 3 5 6 7 8
4 5 2 2 1 1 2 4 3 5 6 7 8
$EndElements
"""


def test_an_element_of_two_groups_is_one_element(tmp_path):
    path = tmp_path / "twice.msh"
    path.write_text(TWICE)
    mesh = read_mesh(path)
    assert {name: found.tolist() for name, found in mesh.element_sets.items()} == {
        "one": [0],
        "two": [0],
    }
    assert len(mesh.elements) == 1 and np.all(corners(mesh, "top")[..., 2] == 1.0)
    path.write_text(TWICE.replace("4 5 2 2 1", "4 5 2 1 1"))
    with pytest.raises(
        ValueError, match='twice.msh", line 24: element 3 is listed twice in the group "one"'
    ):
        read_mesh(path)


def test_no_other_file_is_opened_through_hdf5(folder, tmp_path):
    outside = tmp_path / "outside"
    outside.mkdir()
    with zipfile.ZipFile(DATA / "meshes.zip") as archive:
        archive.extract("blocks.g", outside)
        archive.extract("blocks.g", tmp_path)
    for make in (
        lambda file: h5py.ExternalLink(outside / "blocks.g", "connect1"),
        lambda file: h5py.SoftLink("/connect2"),
    ):
        with h5py.File(tmp_path / "blocks.g", "r+") as file:
            del file["connect1"]
            file["connect1"] = make(file)
        with pytest.raises(ValueError, match='blocks.g": connect1 is a link'):
            read_mesh(tmp_path / "blocks.g")
    with h5py.File(tmp_path / "blocks.g", "r+") as file:
        del file["coordx"]
        (outside / "raw").write_bytes(bytes(96))
        file.create_dataset("coordx", (12,), "f8", external=[(str(outside / "raw"), 0, 96)])
    with pytest.raises(ValueError, match="coordx are in another file"):
        read_mesh(tmp_path / "blocks.g")


def test_a_count_that_the_file_cannot_hold_is_refused(folder, tmp_path):
    with zipfile.ZipFile(DATA / "meshes.zip") as archive:
        archive.extract("blocks.g", tmp_path)
    with h5py.File(tmp_path / "blocks.g", "r+") as file:
        del file["connect1"]
        file.create_dataset("connect1", (10**9, 8), "i4", chunks=(1000, 8))
    with pytest.raises(
        ValueError, match=r"blocks.g\": connect1 need 3.2e\+04 MB, but the file has"
    ):
        read_mesh(tmp_path / "blocks.g")


def test_gmsh_and_meshio_read_the_same_mesh(folder, tmp_path):
    """Another program's reader: nodes, kinds and groups of all files of Gmsh."""
    for file in ("gears.msh", "rings.msh", "notch.msh", "notch22.msh", "hex20.msh"):
        mine, other = read_mesh(folder / file), meshio.read(folder / file)
        for kind in ("hexahedron", "hexahedron20"):
            cells = other.get_cells_type(kind)
            if len(cells):
                count = mine.report.read["hex8" if kind == "hexahedron" else "hex20"]
                found = mine.nodes[mine.elements[:count]]
                key = lambda x: sorted(map(str, x.round(12).tolist()))  # noqa: E731
                assert len(cells) == count and key(found) == key(other.points[cells])


def test_vtu_keeps_bodies_as_sets(folder, tmp_path):
    mesh = read_mesh(folder / "gears.msh")
    body = np.zeros(len(mesh.elements), int)
    body[mesh.element_sets["small"]] = 1
    path = tmp_path / "gears.vtu"
    meshio.Mesh(mesh.nodes, [("hexahedron", mesh.elements)], cell_data={"body": [body]}).write(path)
    found = read_mesh(path, part="body_1")
    assert volume(found) == pytest.approx(volume(mesh, "small"), rel=1e-14)
    whole = read_mesh(path)
    assert np.array_equal(whole.nodes, mesh.nodes) and np.array_equal(whole.elements, mesh.elements)


GROWTH = """
import resource, sys
from libcontact.meshes import read_mesh
def most():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
read_mesh(sys.argv[1])
before = most()
read_mesh(sys.argv[2])
print(1024 * (most() - before))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="ru_maxrss is counted in kB on Linux")
def test_a_compressed_file_needs_at_most_20_times_its_size(tmp_path):
    """Zlib makes a regular lattice three times smaller than the arrays of the mesh. A small file is read before, so
    that what is imported late does not count."""
    sizes = []
    for name, n in (("small", 2), ("large", 50)):
        mesh = Mesh.box("hex8", (0, 0, 0), (1, 1, 1), (n, n, n))
        body = {"body": [np.zeros(n**3, int)]}
        path = tmp_path / f"{name}.vtu"
        meshio.Mesh(mesh.nodes, [("hexahedron", mesh.elements)], cell_data=body).write(path)
        sizes.append(path.stat().st_size)
    paths = [str(tmp_path / f"{name}.vtu") for name in ("small", "large")]
    grown = int(captured([sys.executable, "-c", GROWTH, *paths], check=True).stdout)
    assert sizes[1] > 2e6 and grown < 20 * sizes[1]


def test_names_that_do_not_exist_are_answered_with_those_that_do(folder):
    with pytest.raises(
        ValueError, match=r'no part or set of elements is named "bigg".*"big", "small"'
    ):
        read_mesh(folder / "gears.msh", part="bigg")
    with pytest.raises(ValueError, match=r"none.msh.*no such file"):
        read_mesh(folder / "none.msh")
    (folder / "mesh.stl").write_text("solid")
    with pytest.raises(ValueError, match=r'mesh.stl": the ending must be one of .vtkhdf, .msh'):
        read_mesh(folder / "mesh.stl")
    for wrong in (
        {"scale": 0.0},
        {"scale": math.nan},
        {"extrude": (1.0, 0)},
        {"extrude": (-1.0, 2)},
    ):
        with pytest.raises(ValueError, match="plate.msh"):
            read_mesh(folder / "plate.msh", **wrong)


@pytest.mark.parametrize(
    "package, file", [("meshio.vtu", "a.vtu"), ("scipy.io", "blocks3.g"), ("h5py", "blocks.g")]
)
def test_a_missing_package_is_named_with_its_command(folder, tmp_path, monkeypatch, package, file):
    if file == "a.vtu":
        (folder / file).write_text("<VTKFile/>")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(NotBuiltIn, match=r"-m pip install .*(meshio|h5py)"):
        read_mesh(folder / file)


@cache
def turns(kind):
    """All ways to number the nodes of a cell that keep it from being inverted."""
    x = {
        "C3D8": HEX,
        "C3D6": np.array([[0, 0, -1], [1, 0, -1], [0, 1, -1], [0, 0, 1], [1, 0, 1], [0, 1, 1]]),
    }
    x["C3D4"] = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    nodes = x[kind] - x[kind].mean(axis=0)
    if kind == "C3D6":  # the first triangle turned, or the wedge upside down
        return [[a, b, c, a + 3, b + 3, c + 3] for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1))] + [
            [a + 3, b + 3, c + 3, a, b, c] for a, b, c in ((0, 2, 1), (2, 1, 0), (1, 0, 2))
        ]
    found = []
    for order in permutations(range(len(nodes)), 4):
        turned, known = nodes[list(order)], nodes[:4]
        pick = [0, 1, 3] if kind == "C3D8" else [0, 1, 2]
        if kind == "C3D8" and not np.allclose(turned[0] + turned[2], turned[1] + turned[3]):
            continue
        turn = np.linalg.solve(known[pick], turned[pick])
        if np.allclose(turn @ turn.T, np.eye(3)) and np.linalg.det(turn) > 0.5:
            image = nodes @ turn
            found.append([int(np.argmin(np.linalg.norm(nodes - point, axis=1))) for point in image])
    return [list(each) for each in dict.fromkeys(map(tuple, found))]


def test_numbering_and_order_in_a_file_change_no_bit(tmp_path):
    """However nodes and elements are numbered, the bricks of a mixed mesh are the same: the middles of edges, faces and
    elements do not depend on the order of their nodes."""
    assert [len(turns(kind)) for kind in ("C3D8", "C3D6", "C3D4")] == [24, 6, 12]
    path, chance, first = tmp_path / "mixed.inp", np.random.default_rng(3), None
    mixed = MIXED[: MIXED.index("*Surface")].replace("*Element, type=C3D8, elset=Beside\n", "")
    head, *cards = mixed.split("*Element")
    rows = [row.split(",") for row in head.splitlines()[1:]]
    # Numbers whose sums are rounded.
    rows = [
        [
            row[0],
            *(
                repr(float(x) * f + x0)
                for x, f, x0 in zip(row[1:], (0.7, 0.9, 1.1), (0.1, 0.3, 0.7))
            ),
        ]
        for row in rows
    ]
    for _ in range(20):
        chance.shuffle(rows)
        text = "*Node\n" + "\n".join(",".join(row) for row in rows)
        for card in cards:
            first_line, *elements = card.splitlines()
            kind = first_line.split("type=")[1].split(",")[0]
            text += f"\n*Element{first_line}"
            for element in elements:
                number, *nodes = element.split(",")
                turn = turns(kind)[chance.integers(len(turns(kind)))]
                text += f"\n{number}," + ",".join(nodes[i] for i in turn)
        path.write_text(text + "\n")
        mesh = read_mesh(path)
        # A brick is known by its corners, in any order.
        found = sorted(sorted(map(tuple, brick)) for brick in mesh.nodes[mesh.elements].tolist())
        assert len(found) == 12 and (first is None or found == first)
        first = found


PRISM = "*Node\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n5, 1, 0, 1\n6, 0, 1, 1\n"
# Where faces S1, S2, ... of Abaqus are: a plane a x = b.
PLANES = {
    "C3D8": ([0, 0, 1, 0], [0, 0, 1, 1], [0, 1, 0, 0], [1, 0, 0, 1], [0, 1, 0, 1], [1, 0, 0, 0]),
    "C3D6": ([0, 0, 1, 0], [0, 0, 1, 1], [0, 1, 0, 0], [1, 1, 0, 1], [1, 0, 0, 0]),
    "C3D4": ([0, 0, 1, 0], [0, 1, 0, 0], [1, 1, 1, 1], [1, 0, 0, 0]),
}
# Sides of Exodus by faces of Abaqus.
SIDES = {"C3D8": (3, 4, 5, 6, 1, 2), "C3D6": (3, 4, 5, 1, 2), "C3D4": (2, 3, 4, 1)}
NODES = {"C3D8": (1, 2, 3, 4, 5, 6, 7, 8), "C3D6": (1, 2, 3, 4, 5, 6), "C3D4": (1, 2, 3, 4)}


def check_planes(mesh, kind, name, face):
    """The faces of a set are all in the plane of a face, and as many as it has."""
    *normal, offset = PLANES[kind][face - 1]
    assert np.allclose(corners(mesh, name) @ normal, offset, atol=1e-15), (kind, name)
    triangle = kind == "C3D4" or kind == "C3D6" and face < 3
    assert len(mesh.face_sets[name]) == (3 if kind == "C3D4" else 1)
    exact = (
        (0.5 if triangle else 1.0) * np.linalg.norm(normal)
        if kind != "C3D4"
        else np.linalg.norm(normal) / 2
    )
    assert area(mesh, name) == pytest.approx(exact, rel=1e-14), (kind, name)


@pytest.mark.parametrize("kind", PLANES)
def test_faces_of_abaqus_are_where_its_manual_has_them(tmp_path, kind):
    nodes = CUBE if kind == "C3D8" else PRISM
    text = f"{nodes}*Element, type={kind}\n1, {', '.join(map(str, NODES[kind]))}\n"
    for face in range(1, len(PLANES[kind]) + 1):
        text += f"*Surface, name=f{face}\n1, S{face}\n"
    mesh = read_mesh(deck(tmp_path, text))
    for face in range(1, len(PLANES[kind]) + 1):
        check_planes(mesh, kind, f"f{face}", face)


@pytest.mark.parametrize("kind", PLANES)
def test_sides_of_exodus_are_where_its_manual_has_them(tmp_path, kind):
    path, names = tmp_path / "one.e", {"C3D8": "HEX8", "C3D6": "WEDGE", "C3D4": "TETRA"}
    text = CUBE if kind == "C3D8" else PRISM
    points = np.array([[float(x) for x in row.split(",")[1:]] for row in text.splitlines()[1:]])
    with h5py.File(path, "w") as file:
        for axis, column in zip("xyz", points[: len(NODES[kind])].T):
            file[f"coord{axis}"] = column
        file["connect1"] = np.array([NODES[kind]], "i4")
        file["connect1"].attrs["elem_type"] = np.bytes_(names[kind])
        for side in range(1, len(SIDES[kind]) + 1):
            file[f"elem_ss{side}"], file[f"side_ss{side}"] = np.array([1]), np.array([side])
    mesh = read_mesh(path)
    for side, face in enumerate(SIDES[kind], 1):
        check_planes(mesh, kind, f"side_set_{side}", face)


def test_a_wedge_under_a_tetrahedron_is_split_down_to_its_other_end(tmp_path):
    text = MIXED[: MIXED.index("*Element, type=C3D8, elset=Row")]
    text = text.replace(
        "*Element, type=C3D6, elset=Wedge\n",
        "41, 0, 0, -1\n42, 1, 0, -1\n43, 0, 1, -1\n*Element, type=C3D6\n8, 41, 42, 43, 1, 2, 3\n",
    )
    mesh = read_mesh(deck(tmp_path, text))
    assert len(mesh.elements) == 3 + 3 + 4 and volume(mesh) == pytest.approx(1.0 + 1.0 / 6.0)
    a, b, c, d = mesh.nodes[outer_faces(mesh)].transpose(1, 0, 2)
    sides = math.hypot(0.25, 1.0) * 2 / 2 + math.sqrt(2) * math.hypot(0.5 / math.sqrt(2), 1.0) / 2
    exact = 0.5 + 2 * (2.0 + math.sqrt(2)) + sides
    assert np.linalg.norm(np.cross(c - a, d - b), axis=1).sum() / 2 == pytest.approx(
        exact, rel=1e-12
    )


def test_the_page_shows_what_the_command_prints(folder, capsys, monkeypatch):
    monkeypatch.chdir(folder)
    assert main(["mesh", "cam.msh"]) == 0
    page = DATA.parents[1] / "docs" / "start" / "cam.out"
    assert capsys.readouterr().out == page.read_text()


def test_the_command_tells_what_is_in_a_mesh(folder, capsys):
    pytest.importorskip("matplotlib")
    assert main(["mesh", str(folder / "cam.msh"), "--plot"]) == 0
    told = capsys.readouterr().out
    for words in (
        "80 hex8, 32 wedge6",
        "left out",
        "volume    1.68086",
        '"cam_outer" 40',
        "c1 = 6020",
    ):
        assert words in told
    assert (folder / "cam.msh.png").stat().st_size > 10_000
    assert (
        main(
            [
                "mesh",
                str(folder / "plate.msh"),
                "--extrude",
                "0.5",
                "2",
                "--speed",
                "1000",
                "--json",
            ]
        )
        == 0
    )
    facts = json.loads(capsys.readouterr().out)
    mesh = read_mesh(folder / "plate.msh", extrude=(0.5, 2))
    assert facts["volume"] == pytest.approx(volume(mesh), rel=1e-12)
    assert facts["shortest_edge"] == Mesh.copy(mesh.nodes, mesh.elements).shortest_edge
    assert 0.3 * facts["shortest_edge"] < 1000 * facts["step"] < facts["shortest_edge"]
    assert main(["mesh", str(folder / "none.msh")]) == 2
    assert main(["mesh", str(folder / "plate.msh"), "--extrude", "1", "two"]) == 2
    assert main(["info", str(folder / "cam.msh")]) == 0
