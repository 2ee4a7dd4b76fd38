"""Host: Akantu, a program in C++, with its own time loop."""

import tempfile
import time
from pathlib import Path

import akantu
import meshio
import numpy as np
import two_plates as plates
from libcontact.mesh import Mesh

import libcontact as ct

MATERIAL = f"""material elastic [
  name = steel
  rho = {plates.DENSITY}
  E = {plates.YOUNG}
  nu = {plates.POISSON}
]
"""


def read():
    """Akantu's mesh of both plates, and the nodes of each."""
    sides = [Mesh.box("hex8", plates.origin(s), plates.SIZE, plates.COUNTS) for s in (0, 1)]
    first = len(sides[0].nodes)
    nodes = np.concatenate([side.nodes for side in sides])
    bricks = np.concatenate([sides[0].elements, sides[1].elements + first])
    with tempfile.TemporaryDirectory() as folder:
        material, file = Path(folder, "material.dat"), Path(folder, "plates.msh")
        material.write_text(MATERIAL)
        meshio.write_points_cells(
            file, nodes, {"hexahedron": bricks}, file_format="gmsh22", binary=False
        )
        akantu.parseInput(str(material))
        mesh = akantu.Mesh(3)
        mesh.read(str(file))
    return mesh, [slice(0, first), slice(first, None)]


def start(solid, parts):
    """Supports and velocities."""
    solid.getBlockedDOFs()[:] = plates.fixed(solid.getMesh().getNodes())
    for side, part in enumerate(parts):
        solid.getVelocity()[part] = plates.velocity(side)


class Shot:
    """One plate, as two_plates.py takes it."""

    def __init__(self, solid, part):
        self.X = solid.getMesh().getNodes()[part].copy()
        self.x = self.X + solid.getDisplacement()[part]


def run(beta):
    """Both plates in Akantu's loop, with the contact of this library."""
    mesh, parts = read()
    solid = akantu.SolidMechanicsModel(mesh)
    solid.initFull(_analysis_method=akantu._explicit_lumped_mass)
    solid.assembleMassLumped()
    X, u, m = mesh.getNodes(), solid.getDisplacement(), solid.getMass()
    v, a = solid.getVelocity(), solid.getAcceleration()
    w = np.where(plates.fixed(X), 0.0, 1.0 / m)

    def force(displacement):
        u[:] = displacement
        solid.assembleInternalForces()
        return solid.getInternalForce().copy()

    dt = plates.FRACTION * plates.largest_step(force, w)
    force(np.zeros_like(X))
    result = plates.Result(dt)
    start(solid, parts)
    solid.setTimeStep(dt)
    begin = time.process_time()
    # -- glue
    X, bricks = X.copy(), mesh.getConnectivity(akantu._hexahedron_8).astype("i4")
    faces, owners = Mesh.copy(X, bricks).faces("outer")
    hit, left = (X[faces, 0] == 0.0).all(axis=1), owners < len(bricks) // 2
    first, second = (ct.Surface("Q4", X, faces[hit & side]) for side in (left, ~left))
    keys = {"travel_time": plates.H / plates.C1, "force_tolerance": plates.TOLERANCE}
    epsilon = ct.Contact.penalty(beta, plates.YOUNG, plates.H)
    contact = plates.Timed(first, second, epsilon=epsilon, **keys)
    # -- end
    for n in range(result.steps):
        # -- glue
        f, half = np.zeros_like(X), dt / 2 if n else 0.0
        contact.step(dt, X + u, v - half * a, w, m * a, force_time=half + dt / 2)
        contact.add_force(f)
        a += w * f
        v += half * w * f
        # -- end
        kinetic = 0.5 * (m * (v**2 - (half * a) ** 2)).sum()
        result.energy.append(solid.getEnergy("potential") + kinetic + contact.energy)
        solid.solveStep()
        result.shoot(n, [Shot(solid, part) for part in parts])
    result.share = contact.seconds / (time.process_time() - begin)
    return result
