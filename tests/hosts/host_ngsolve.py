"""Host: NGSolve, a program in C++, makes mesh, stiffness and masses, and multiplies."""

import ngsolve as ng
import numpy as np
import two_plates as plates
from libcontact.mesh import Mesh
from ngsolve.meshes import MakeHexMesh

import libcontact as ct


class Plate:
    """A plate of NGSolve, whose vectors hold all x, then all y, then all z."""

    def __init__(self, side):
        n, low = plates.CELLS, plates.origin(side)
        size = (plates.SIDE, plates.H, plates.SIDE)
        place = lambda *s: tuple(a + b * c for a, b, c in zip(low, size, s))  # noqa: E731
        self.side, self.mesh = side, MakeHexMesh(nx=n, ny=1, nz=n, mapping=place)
        u, v = (space := ng.VectorH1(self.mesh, order=1)).TnT()
        strain = lambda u: 0.5 * (ng.Grad(u) + ng.Grad(u).trans)  # noqa: E731
        shear = 2 * plates.MU * ng.InnerProduct(strain(u), strain(v))
        self.K = ng.BilinearForm((shear + plates.LAMBDA * ng.div(u) * ng.div(v)) * ng.dx)
        mass = ng.BilinearForm(plates.DENSITY * u * v * ng.dx).Assemble().mat
        self.K, ones = self.K.Assemble().mat, mass.CreateColVector()
        ones[:] = 1.0
        self.u, self.f = self.K.CreateColVector(), self.K.CreateColVector()
        self.f.data = mass * ones
        self.m = self.f.FV().NumPy().reshape(3, space.ndof // 3).T.copy()
        self.X = np.array([vertex.point for vertex in self.mesh.vertices])

    def force(self, u):
        """Internal forces (n, 3)."""
        self.u.FV().NumPy()[:] = u.T.ravel()
        self.f.data = self.K * self.u
        return np.ascontiguousarray(-self.f.FV().NumPy().reshape(3, -1).T)

    # -- glue
    def surface(self):
        """The face that hits, of bricks in VTK's order, which those of MakeHexMesh mirror."""
        bricks = np.array([[v.nr for v in each.vertices] for each in self.mesh.Elements()], "i4")
        bricks, face = bricks[:, [0, 3, 2, 1, 4, 7, 6, 5]], ("x_max", "x_min")[self.side]
        faces, _ = Mesh.copy(self.X, np.ascontiguousarray(bricks)).faces(face)
        return ct.Surface("Q4", self.X, faces)

    # -- end


def run(beta):
    """Both plates, in the loop of two_plates.py."""
    return plates.run_host([Plate(0), Plate(1)], beta)
