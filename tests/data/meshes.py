"""Write ``meshes.zip`` with Gmsh and the netCDF library: ``python meshes.py`` in an environment with the packages gmsh
and netCDF4. The tests read the archive and need neither.

=================  ==========================================================================================
``gears.msh``      two gears of 8 and 6 teeth, bricks; version 4.1, text
``rings.msh``      two rings of 16 and 12 facets, bricks; version 2.2, text
``notch.msh``      a notched block of two materials, bricks; version 4.1, binary
``notch22.msh``    the same; version 2.2, binary
``cam.msh``        an eccentric disc of bricks and wedges; version 4.1, text
``cam.inp``        the same, as Gmsh writes it for Abaqus
``tets.msh``       a box of tetrahedra; version 4.1, text
``hex20.msh``      a box of quadratic bricks; version 4.1, text
``plate.msh``      quadrilaterals and triangles in a plane; version 4.1, text
``blocks.g``       two blocks in the layout of Cubit, netCDF-4
``blocks3.g``      the same, classic netCDF
=================  ==========================================================================================
"""

import math
import sys
import tempfile
import zipfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent


def gear(teeth, root, tip):
    """Outline of a gear with straight flanks, four points a tooth."""
    points = []
    for i in range(teeth):
        for part, radius in ((0.0, root), (0.25, root), (0.35, tip), (0.75, tip)):
            angle = 2 * math.pi * (i + part) / teeth
            points.append((radius * math.cos(angle), radius * math.sin(angle)))
    return points


def regular(n, radius):
    """A polygon on a circle."""
    return [
        (radius * math.cos(2 * math.pi * i / n), radius * math.sin(2 * math.pi * i / n))
        for i in range(n)
    ]


def ngon(gmsh, points, x, y):
    """A closed line through points that are moved: its lines and its points."""
    geo = gmsh.model.geo
    tags = [geo.addPoint(x + px, y + py, 0) for px, py in points]
    return [geo.addLine(a, b) for a, b in zip(tags, tags[1:] + tags[:1])], tags


def swept(gmsh, outlines, x, y, name, layers=1, height=0.5):
    """A volume over a polygon with holes, and physical groups of its outer and inner surfaces."""
    geo = gmsh.model.geo
    lines = [ngon(gmsh, points, x, y)[0] for points in outlines]
    surface = geo.addPlaneSurface([geo.addCurveLoop(each) for each in lines])
    geo.synchronize()
    geo.mesh.setRecombine(2, surface)
    made = geo.extrude([(2, surface)], 0, 0, height, [layers], recombine=True)
    geo.synchronize()
    volume = [tag for dim, tag in made if dim == 3]
    sides = [tag for dim, tag in made[2:] if dim == 2]
    gmsh.model.addPhysicalGroup(3, volume, -1, name)
    gmsh.model.addPhysicalGroup(2, sides[: len(lines[0])], -1, f"{name}_outer")
    if len(lines) > 1:
        gmsh.model.addPhysicalGroup(2, sides[len(lines[0]) :], -1, f"{name}_hole")
    return surface, made[0][1]


def gears(gmsh):
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 1)  # mostly quadrilaterals
    swept(gmsh, [gear(8, 0.8, 1.0), regular(8, 0.4)], 0.0, 0.0, "big")
    swept(gmsh, [gear(6, 0.6, 0.8), regular(6, 0.3)], 1.7, 0.0, "small")


def rings(gmsh):
    geo = gmsh.model.geo
    for name, n, r, R in (("outer", 16, 1.0, 1.2), ("inner", 12, 0.8, 0.99)):
        lines, points = zip(*(ngon(gmsh, regular(n, radius), 0, 0) for radius in (r, R)))
        spokes = [geo.addLine(a, b) for a, b in zip(*points)]
        faces = []
        for i in range(n):
            j = (i + 1) % n
            loop = geo.addCurveLoop([spokes[i], lines[1][i], -spokes[j], -lines[0][i]])
            faces.append(geo.addPlaneSurface([loop]))
        for line in lines[0] + lines[1]:
            geo.mesh.setTransfiniteCurve(line, 2)
        for line in spokes:
            geo.mesh.setTransfiniteCurve(line, 3)
        for face in faces:
            geo.mesh.setTransfiniteSurface(face)
            geo.mesh.setRecombine(2, face)
        volumes, skin = [], {"in": [], "out": []}
        for face in faces:
            made = geo.extrude([(2, face)], 0, 0, 0.5, [1], recombine=True)
            volumes.append(made[1][1])
            skin["out"].append(made[3][1])
            skin["in"].append(made[5][1])
        geo.synchronize()
        gmsh.model.addPhysicalGroup(3, volumes, -1, name)
        for side, tags in skin.items():
            gmsh.model.addPhysicalGroup(2, tags, -1, f"{name}_{side}")


def notch(gmsh):
    gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 1)  # mostly quadrilaterals
    geo = gmsh.model.geo
    points = [(0, 0), (1, 0), (1, 0.6), (0.8, 1), (0, 1), (2, 0), (2, 1), (1.2, 1)]
    tags = [geo.addPoint(x, y, 0) for x, y in points]
    shared = geo.addLine(tags[1], tags[2])
    left = [geo.addLine(tags[0], tags[1]), shared]
    left += [geo.addLine(tags[a], tags[b]) for a, b in ((2, 3), (3, 4), (4, 0))]
    right = [geo.addLine(tags[a], tags[b]) for a, b in ((1, 5), (5, 6), (6, 7), (7, 2))]
    faces = [geo.addPlaneSurface([geo.addCurveLoop(left)])]
    faces.append(geo.addPlaneSurface([geo.addCurveLoop([*right, -shared])]))
    for name, face in zip(("steel", "rubber"), faces):
        geo.mesh.setRecombine(2, face)
        made = geo.extrude([(2, face)], 0, 0, 0.5, [2], recombine=True)
        geo.synchronize()
        gmsh.model.addPhysicalGroup(3, [made[1][1]], -1, name)
        end = 6 if name == "steel" else 3
        gmsh.model.addPhysicalGroup(2, [made[end][1]], -1, f"{name}_end")


def cam(gmsh):
    outline = [(1.2 * x, y) for x, y in regular(20, 1.0)]
    hole = [(0.3 + x, y) for x, y in regular(8, 0.35)]
    bottom, top = swept(gmsh, [outline, hole], 0, 0, "cam", 2)
    gmsh.model.addPhysicalGroup(2, [bottom], -1, "bottom")
    gmsh.model.addPhysicalGroup(2, [top], -1, "top")


def tets(gmsh):
    gmsh.model.occ.addBox(0, 0, 0, 1, 2, 3)
    gmsh.model.occ.synchronize()
    gmsh.model.addPhysicalGroup(3, [1], -1, "box")
    gmsh.model.addPhysicalGroup(2, [1], -1, "x_zero")
    gmsh.model.addPhysicalGroup(1, [1], -1, "edge")


def hex20(gmsh):
    geo = gmsh.model.geo
    made = [(0, geo.addPoint(0, 0, 0))]
    for step, cells in (((1, 0, 0), 2), ((0, 2, 0), 3), ((0, 0, 3), 2)):
        made = [each for each in geo.extrude(made[:2][-1:], *step, [cells], recombine=True)]
    geo.synchronize()
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 1)
    gmsh.model.addPhysicalGroup(3, [tag for dim, tag in made if dim == 3], -1, "box")
    gmsh.model.addPhysicalGroup(2, [made[0][1]], -1, "top")


def plate(gmsh):
    geo = gmsh.model.geo
    lines, _ = ngon(gmsh, [(0, 0), (2, 0), (2, 1), (0.5, 1.2)], 0, 0)
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.synchronize()
    gmsh.model.mesh.setRecombine(2, surface)
    gmsh.option.setNumber("Mesh.RecombineMinimumQuality", 0.5)
    gmsh.model.addPhysicalGroup(2, [surface], -1, "plate")
    gmsh.model.addPhysicalGroup(1, [lines[0]], -1, "base")


# Name, geometry, version, binary, size of the elements.
MESHES = (
    ("gears.msh", gears, 4.1, 0, 0.6),
    ("rings.msh", rings, 2.2, 0, 0.5),
    ("notch.msh", notch, 4.1, 1, 0.6),
    ("notch22.msh", notch, 2.2, 1, 0.6),
    ("cam.msh", cam, 4.1, 0, 0.4),
    ("cam.inp", cam, 4.1, 0, 0.4),
    ("tets.msh", tets, 4.1, 0, 1.0),
    ("hex20.msh", hex20, 4.1, 0, 1.0),
    ("plate.msh", plate, 4.1, 0, 0.4),
)


def letters(names, width=33):
    """Names as rows of characters."""
    out = np.zeros((len(names), width), "S1")
    for row, name in zip(out, names):
        row[: len(name)] = list(name)
    return out


def exodus(path, form):
    """Two bricks in two blocks, side by side along x, as Cubit writes them."""
    from netCDF4 import Dataset

    nodes = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1, 2)], float)
    first = np.array([1, 2, 5, 4, 7, 8, 11, 10])
    sizes = {"time_step": None, "len_string": 33, "len_line": 81, "four": 4, "len_name": 33}
    sizes |= {"num_dim": 3, "num_nodes": 12, "num_elem": 2, "num_el_blk": 2, "num_node_sets": 1}
    sizes |= {"num_side_sets": 2, "num_side_ss1": 1, "num_side_ss2": 2, "num_nod_ns1": 4}
    sizes |= {
        f"num_{what}{b}": n for b in (1, 2) for what, n in (("el_in_blk", 1), ("nod_per_el", 8))
    }
    with Dataset(path, "w", format=form) as file:
        for name, value in (("api_version", 8.03), ("version", 8.03)):
            file.setncattr(name, np.float32(value))
        file.setncattr("floating_point_word_size", np.int32(8))
        file.setncattr("title", "cubit(blocks.g)")
        for name, size in sizes.items():
            file.createDimension(name, size)

        def variable(name, kind, dimensions, values, /, **attributes):
            made = file.createVariable(name, kind, dimensions)
            made[:] = values
            for key, value in attributes.items():
                made.setncattr(key, value)

        for axis, column in zip("xyz", nodes.T):
            variable(f"coord{axis}", "f8", ("num_nodes",), column)
        variable("eb_prop1", "i4", ("num_el_blk",), [10, 20], name="ID")
        variable("eb_names", "S1", ("num_el_blk", "len_name"), letters(["left", "right"]))
        for b in (1, 2):
            shape = (f"num_el_in_blk{b}", f"num_nod_per_el{b}")
            variable(f"connect{b}", "i4", shape, [first + b - 1], elem_type="HEX8")
        variable("elem_num_map", "i4", ("num_elem",), [101, 102])
        variable("ss_prop1", "i4", ("num_side_sets",), [7, 8], name="ID")
        variable("ss_names", "S1", ("num_side_sets", "len_name"), letters(["front", ""]))
        variable("elem_ss1", "i4", ("num_side_ss1",), [2])
        variable("side_ss1", "i4", ("num_side_ss1",), [2])
        variable("elem_ss2", "i4", ("num_side_ss2",), [1, 2])
        variable("side_ss2", "i4", ("num_side_ss2",), [6, 6])
        variable("ns_prop1", "i4", ("num_node_sets",), [3], name="ID")
        variable("node_ns1", "i4", ("num_nod_ns1",), [1, 4, 7, 10])


def main(target=HERE / "meshes.zip"):
    import gmsh

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file, geometry, version, binary, size in MESHES:
            gmsh.initialize()
            gmsh.option.setNumber("General.Terminal", 0)
            for option in ("MeshSizeMin", "MeshSizeMax"):
                gmsh.option.setNumber(f"Mesh.{option}", size)
            gmsh.option.setNumber("Mesh.RecombinationAlgorithm", 0)
            gmsh.option.setNumber("Mesh.MshFileVersion", version)
            gmsh.option.setNumber("Mesh.Binary", binary)
            geometry(gmsh)
            gmsh.model.mesh.generate(2 if geometry is plate else 3)
            gmsh.write(str(folder / file))
            gmsh.finalize()
        exodus(folder / "blocks.g", "NETCDF4")
        exodus(folder / "blocks3.g", "NETCDF3_64BIT_OFFSET")
        with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(folder.iterdir()):
                archive.write(path, path.name)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
