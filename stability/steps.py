"""
Is the reported step safe, and how sharp is it? For each mesh the true limit follows from all eigenvalues
of the assembled system. Each integrator runs below the reported step and above the true one (chapter
"Integrator").
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from libcontact._core import ffi, lib
from libcontact.errors import Error, check, new_error
from libcontact.mesh import EDGE_ENDS, Mesh
from libcontact.model import INTEGRATORS
from libcontact.problem import Problem, new_state

import libcontact as ct

UNITS = {"length": "m", "mass": "kg", "time": "s"}
MESHES = (
    "cubes",
    "flat bricks",
    "nearly incompressible",
    "graded",
    "distorted by 0.1 h",
    "distorted by 0.2 h",
)
REGULAR = MESHES[:3]
BELOW, ABOVE, BLOWN = 0.999, 1.02, 1e3


@dataclass
class Row:
    """One mesh with one integrator: the reported and the true stable step, and the growth of the velocity
    below the reported and above the true one. ``elements`` is the default bound by elements and blocks,
    ``reported`` that of the assembled bodies, which is never below it."""

    element: str
    mesh: str
    integrator: str
    elements: float
    reported: float
    true: float
    below: float
    above: float

    @property
    def sharpness(self) -> float:
        return self.reported / self.true

    @property
    def good(self) -> bool:
        sharp = self.sharpness >= 0.9 and (
            self.mesh not in REGULAR or self.elements >= 0.9 * self.true
        )
        return (
            sharp
            and self.sharpness <= 1.0 + 1e-6
            and self.elements <= self.reported
            and self.below < BLOWN < self.above
        )


def block(element: str, mesh: str) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and elements of a small block."""
    cells = 4 if element == "hex8" else 3
    made = Mesh.box(
        element, [0, 0, 0], [1.0, 1.0, 0.2 if mesh == "flat bricks" else 1.0], [cells] * 3
    )
    nodes, elements = np.array(made.nodes), np.array(made.elements)
    if mesh == "graded":
        nodes[:, 0] = np.expm1(1.5 * nodes[:, 0]) / np.expm1(1.5)
    if mesh.startswith("distorted"):
        amount = float(mesh.split()[2]) / cells
        corners = np.unique(elements[:, :8])
        inside = corners[np.all((nodes[corners] > 1e-9) & (nodes[corners] < 1 - 1e-9), axis=1)]
        nodes[inside] += np.random.default_rng(7).uniform(-amount, amount, (len(inside), 3))
    if element == "hex20":
        # Mid-side nodes stay halfway between their corners.
        for k, (a, b) in enumerate(EDGE_ENDS):
            nodes[elements[:, 8 + k]] = 0.5 * (nodes[elements[:, a]] + nodes[elements[:, b]])
    return nodes, elements


def problem_of(element: str, mesh: str, integrator: str, stable_step: str = "assembled") -> Problem:
    nodes, elements = block(element, mesh)
    made = ct.Scene(title="block", units=UNITS)
    made.add_material(
        "soft", young=1e8, poisson=0.49 if mesh == "nearly incompressible" else 0.3, density=1.0
    )
    made.add_body("block", nodes=nodes, elements=elements, element=element, material="soft")
    return made.set_time(
        end=1.0, fraction=0.5, integrator=integrator, stable_step=stable_step
    )._built(None)


def array(pointer: Any, count: int) -> np.ndarray:
    return np.frombuffer(ffi.buffer(pointer, 8 * count), np.float64)


def stiffness(problem: Problem) -> np.ndarray:
    """The stiffness of the assembled bodies: one force for each unit displacement."""
    count = 3 * problem.pointer.node_count
    one, other, error, force = new_state(problem), new_state(problem), new_error(), np.empty(count)
    u = array(one.displacement, count)
    matrix = np.empty((count, count))
    for d in range(count):
        u[d] = 1.0
        check(lib.ct_state_copy(problem.pointer, one, other, error), error)
        check(
            lib.ct_state_force(
                problem.pointer, other, 0, ffi.cast("double *", force.ctypes.data), error
            ),
            error,
        )
        matrix[d] = -force
        u[d] = 0.0
    return 0.5 * (matrix + matrix.T)


def largest_omega(problem: Problem) -> float:
    """The largest frequency of the assembled system, from all eigenvalues."""
    root = np.sqrt(array(problem.pointer.inverse_mass, 3 * problem.pointer.node_count))
    return float(np.sqrt(np.linalg.eigvalsh(root[:, None] * stiffness(problem) * root)[-1]))


def growth(problem: Problem, dt: float, steps: int) -> float:
    """Largest velocity over a number of steps, sampled at intervals, over the largest of a random start."""
    count = 3 * problem.pointer.node_count
    start = np.random.default_rng(3).uniform(-1e-6, 1e-6, count)
    own = ffi.new("ct_problem *", problem.pointer[0])
    own.dt, own.initial_velocity = dt, ffi.cast("double *", start.ctypes.data)
    out, error, top = ffi.new("ct_state **"), new_error(), 0.0
    check(lib.ct_state_create(own, out, error), error)
    velocity = array(out[0].velocity, count)
    try:
        for _ in range(50):
            check(lib.ct_run(own, out[0], max(steps // 50, 1), ffi.NULL, 0, error), error)
            top = max(top, float(np.abs(velocity).max() / np.abs(start).max()))
            if top > 1e12:
                break
    except Error:
        top = np.inf
    finally:
        lib.ct_state_free(out[0])
    return top


def rows(
    meshes: Sequence[str] = MESHES,
    elements: Sequence[str] = ("hex8", "hex20"),
    steps: int = 100_000,
) -> Iterator[Row]:
    for element in elements:
        for mesh in meshes:
            omega = largest_omega(problem_of(element, mesh, next(iter(INTEGRATORS))))
            for integrator in INTEGRATORS:
                problem = problem_of(element, mesh, integrator)
                reported, true = (
                    problem.stable.dt,
                    lib.ct_integrator_limit(ffi.new("ct_integrator *", problem.parts.time.scheme))
                    / omega,
                )
                elements_alone = problem_of(element, mesh, integrator, "elements").stable.dt
                yield Row(
                    element,
                    mesh,
                    integrator,
                    elements_alone,
                    reported,
                    true,
                    growth(problem, BELOW * reported, steps),
                    growth(problem, ABOVE * true, 5000),
                )


HEAD = "element  mesh                   integrator          default/true   assembled/true  0.999 reported   1.02 true"


def line(row: Row) -> str:
    return (
        f"{row.element:<8} {row.mesh:<22} {row.integrator:<18} {row.elements / row.true:13.4f} {row.sharpness:14.4f} {row.below:16.3g} {min(row.above, 1e99):11.2g}  {'' if row.good else 'FAILS'}"
    ).rstrip()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=100_000, help="steps below the reported limit")
    given, failed = parser.parse_args(), 0
    print(HEAD)
    for row in rows(steps=given.steps):
        print(line(row), flush=True)
        failed += not row.good
    return 1 if failed else 0


if __name__ == "__main__":
    raise SystemExit(main())
