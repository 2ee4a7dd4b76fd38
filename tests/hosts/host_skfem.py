"""Host: scikit-fem makes mesh, stiffness and masses; SciPy multiplies."""

import numpy as np
import skfem
import two_plates as plates
from libcontact.mesh import Mesh
from skfem.models.elasticity import linear_elasticity

import libcontact as ct


class Plate:
    """A plate of scikit-fem."""

    def __init__(self, side):
        self.side, self.mesh = side, skfem.MeshHex.init_tensor(*plates.lines(side))
        basis = skfem.Basis(self.mesh, skfem.ElementVector(skfem.ElementHex1()))
        self.K = linear_elasticity(plates.LAMBDA, plates.MU).assemble(basis).tocsr()
        mass = skfem.BilinearForm(lambda u, v, w: sum(u[i] * v[i] for i in range(3)))
        lumped = plates.DENSITY * np.asarray(mass.assemble(basis).sum(axis=1)).ravel()
        self.dofs = basis.nodal_dofs.T
        self.X, self.m = np.ascontiguousarray(self.mesh.p.T), lumped[self.dofs]

    def force(self, u):
        """Internal forces (n, 3)."""
        full = np.empty(u.size)
        full[self.dofs] = u
        return -(self.K @ full)[self.dofs]

    # -- glue
    def surface(self):
        """The face that hits, of bricks in VTK's order."""
        bricks, face = self.mesh.t[[0, 3, 6, 2, 1, 5, 7, 4]].T, ("x_max", "x_min")[self.side]
        faces, _ = Mesh.copy(self.X, bricks.astype("i4", "C")).faces(face)
        return ct.Surface("Q4", self.X, faces)

    # -- end


def run(beta):
    """Both plates, in the loop of two_plates.py."""
    return plates.run_host([Plate(0), Plate(1)], beta)
