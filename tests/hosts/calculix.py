"""CalculiX, an explicit program with its own contact: the pressure is beta E / h times the overlap of the faces."""

import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import two_plates as plates
from libcontact.mesh import Mesh

# Its time is in µs, because it takes steps of nanoseconds for none.
MICRO = 1e-6


def rows(first, table):
    """Numbered lines of a table, from ``first`` on; CalculiX reads 20 characters of a number."""
    form = "%d" if table.dtype.kind == "i" else "%.12e"
    numbers = np.arange(first, first + len(table))
    return "".join(f"{i}, {', '.join(form % x for x in row)}\n" for i, row in zip(numbers, table))


def deck(beta, courant):
    """The input, and the mesh of each plate. The face x_max of a brick is S4, x_min S6."""
    sides = [Mesh.box("hex8", plates.origin(s), plates.SIZE, plates.COUNTS) for s in (0, 1)]
    text, node, element = "", 1, 1
    for side, mesh in enumerate(sides):
        text += f"*NODE, NSET=N{side}\n{rows(node, mesh.nodes)}"
        text += f"*ELEMENT, TYPE=C3D8, ELSET=E{side}\n{rows(element, mesh.elements + node)}"
        hit = mesh.faces(("x_max", "x_min")[side])[1] + element
        text += f"*SURFACE, NAME=S{side}\n"
        text += "".join(f"{each}, {('S4', 'S6')[side]}\n" for each in hit)
        held = plates.fixed(mesh.nodes)
        text += "*BOUNDARY\n" + "".join(
            f"{i + node}, {k + 1}, {k + 1}\n" for i, k in np.argwhere(held)
        )
        text += (
            f"*INITIAL CONDITIONS, TYPE=VELOCITY\nN{side}, 1, {plates.velocity(side)[0] * MICRO}\n"
        )
        text += f"*SOLID SECTION, ELSET=E{side}, MATERIAL=STEEL\n"
        node, element = node + len(mesh.nodes), element + len(mesh.elements)
    text += f"*MATERIAL, NAME=STEEL\n*ELASTIC\n{plates.YOUNG}, {plates.POISSON}\n"
    text += f"*DENSITY\n{plates.DENSITY / MICRO**2}\n"
    stiffness = beta * plates.YOUNG / plates.H
    text += "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n"
    text += f"{stiffness:.12e}\n*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\nS0, S1\n"
    text += "*STEP, NLGEOM, INC=1000000\n*DYNAMIC, EXPLICIT\n"
    dt = courant * plates.H / plates.C1 / MICRO
    text += f"{dt:.12e}, {plates.PLATEAU / MICRO:.12e}, , {dt:.12e}\n"
    for side in (0, 1):
        text += f"*NODE PRINT, NSET=N{side}, FREQUENCY=1000000\nU\n"
    return text + "*END STEP\n", sides


def run(beta, courant=0.25):
    """Coordinates and displacements of both plates at the time PLATEAU, as a shot of two_plates.py."""
    text, sides = deck(beta, courant)
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "plates.inp").write_text(text)
        subprocess.run(["ccx", "plates"], cwd=folder, check=True, capture_output=True)
        data = Path(folder, "plates.dat").read_text()
    found = re.findall(r"\(vx,vy,vz\).*\n\n((?: +\d.*\n)+)", data)
    return [side.nodes for side in sides], [np.loadtxt(t.splitlines())[:, 1:] for t in found[-2:]]
