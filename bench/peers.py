"""Seconds per step of other codes for one plate (100 x 100 hex8, no contact), each in its own process.

``python peers.py scipy STEPS`` or ``python peers.py akantu STEPS`` prints one JSON object. The plate, its
supports, its lumped mass and the step are those of tutorials/scenes/plates_reference.toml. ``check``, the
kinetic energy at the end, shows that all codes compute the same motion.
"""

import json
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

N = 100
D = 2.5  # mm
YOUNG, NU, RHO, V0 = 2.1e5, 0.3, 7.8e-9, 1000.0
LAMBDA, MU = YOUNG * NU / ((1 + NU) * (1 - 2 * NU)), YOUNG / (2 * (1 + NU))
H = D / N
DT = 0.125 * H / np.sqrt((LAMBDA + 2 * MU) / RHO)


def mesh():
    """Nodes (n, 3) and elements (N², 8) of the plate, x fastest."""
    k, j, i = np.meshgrid(np.arange(N + 1), np.arange(2), np.arange(N + 1), indexing="ij")
    nodes = np.column_stack([i.ravel(), j.ravel(), k.ravel()]) * H
    kk, ii = (a.ravel() for a in np.meshgrid(np.arange(N), np.arange(N), indexing="ij"))
    first = ii + 2 * (N + 1) * kk
    row, layer = N + 1, 2 * (N + 1)
    elements = first[:, None] + np.array(
        [0, 1, 1 + row, row, layer, layer + 1, layer + 1 + row, layer + row]
    )
    return nodes, elements


def stiffness():
    """Stiffness of one cube of edge H, 2 x 2 x 2 Gauss points."""
    square = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    corner = np.array([[*side, z] for z in (-1, 1) for side in square])
    C = np.zeros((6, 6))
    C[:3, :3] = LAMBDA
    C[range(6), range(6)] += [2 * MU] * 3 + [MU] * 3
    K = np.zeros((24, 24))
    for point in corner / np.sqrt(3):
        terms = 1 + corner * point
        dN = (
            np.stack(
                [corner[:, a] * np.delete(terms, a, axis=1).prod(axis=1) / 8 for a in range(3)],
                axis=1,
            )
            * 2
            / H
        )
        B = np.zeros((6, 24))
        for a in range(3):
            B[a, a::3] = dN[:, a]
        for row, (a, b) in enumerate(((0, 1), (1, 2), (2, 0)), start=3):
            B[row, a::3], B[row, b::3] = dN[:, b], dN[:, a]
        K += B.T @ C @ B * H**3 / 8
    return K


def run_scipy(steps):
    """The assembled sparse matrix times the displacements, once per step: seconds of the steps, and the kinetic
    energy."""
    from scipy import sparse

    nodes, elements = mesh()
    dofs = (3 * elements[:, :, None] + np.arange(3)).reshape(len(elements), 24)
    K = stiffness()
    rows, columns = np.repeat(dofs, 24, axis=1).ravel(), np.tile(dofs, (1, 24)).ravel()
    matrix = sparse.csr_matrix(
        (np.tile(K.ravel(), len(elements)), (rows, columns)), shape=(nodes.size, nodes.size)
    )
    mass = np.bincount(elements.ravel(), minlength=len(nodes)) * RHO * H**3 / 8
    held = np.stack([nodes[:, 0] == 0, np.ones(len(nodes), bool), nodes[:, 2] == 0], axis=1).ravel()
    scale = np.where(held, 0.0, DT / np.repeat(mass, 3))
    v = np.where(held, 0.0, np.tile([-V0, 0.0, 0.0], len(nodes)))
    u = np.zeros(nodes.size)
    start = time.perf_counter()
    for _ in range(steps):
        force = matrix @ u
        force *= scale
        v -= force
        u += DT * v
    seconds = time.perf_counter() - start
    return seconds, 0.5 * np.sum(np.repeat(mass, 3) * v**2)


def write_msh(path):
    """Write the mesh in gmsh's format 2.2; the element kind is hexahedron_8."""
    nodes, elements = mesh()
    with open(path, "w") as file:
        file.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        file.writelines(f"{i} {x:.17g} {y:.17g} {z:.17g}\n" for i, (x, y, z) in enumerate(nodes, 1))
        file.write(f"$EndNodes\n$Elements\n{len(elements)}\n")
        file.writelines(
            f"{i} 5 2 1 1 {' '.join(map(str, row + 1))}\n" for i, row in enumerate(elements, 1)
        )
        file.write("$EndElements\n")


def run_akantu(steps):
    """Akantu, explicit with lumped mass; Python calls its solveStep."""
    import akantu

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder)
        write_msh(path / "plate.msh")
        (path / "material.dat").write_text(
            f"material elastic [\n name = steel\n rho = {RHO}\n E = {YOUNG}\n nu = {NU}\n]\n"
        )
        akantu.parseInput(str(path / "material.dat"))
        plate = akantu.Mesh(3)
        plate.read(str(path / "plate.msh"))
    model = akantu.SolidMechanicsModel(plate)
    model.initFull(_analysis_method=akantu._explicit_lumped_mass)
    nodes = plate.getNodes()
    held = model.getBlockedDOFs()
    held[:, 0] = np.isclose(nodes[:, 0], 0, atol=1e-9)
    held[:, 1] = True
    held[:, 2] = np.isclose(nodes[:, 2], 0, atol=1e-9)
    model.getVelocity()[:] = np.where(held, 0.0, [-V0, 0.0, 0.0])
    model.setTimeStep(DT)
    start = time.perf_counter()
    for _ in range(steps):
        model.solveStep()
    return time.perf_counter() - start, model.getEnergy("kinetic")


if __name__ == "__main__":
    steps = int(sys.argv[2])
    seconds, check = {"scipy": run_scipy, "akantu": run_akantu}[sys.argv[1]](steps)
    print(
        json.dumps(
            {
                "code": sys.argv[1],
                "steps": steps,
                "us_per_update": 1e6 * seconds / steps / N**2,
                "check": check,
            }
        )
    )
