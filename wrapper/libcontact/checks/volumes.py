"""Elements that collapse in a run (chapter "Warnings")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..errors import SceneWarning
from ..mesh import CORNER_ENDS, Mesh
from ..observers import Observer, spread
from ..problem import Problem
from .limits import CHECKS, LEAST_STEPS

# An element has collapsed if the volume at a corner is below this fraction of that at the start (eq:corner-volume).
COLLAPSED = 0.1
# Elements whose corners are computed together: what they need stays in the processor's cache.
TOGETHER = 4096


class Volumes(Observer):
    """Finds elements that have collapsed or are inverted. Displacements that differ by less than a third of the
    shortest edge leave every element most of its volume."""

    at_records = True

    def __init__(self, problem: Problem):
        bodies = enumerate(problem.bodies.values())
        self._bodies = {i: body for i, body in bodies if body.kernel != "rigid"}
        super().__init__(problem, spread(problem, CHECKS, LEAST_STEPS))

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        """Yield a warning for each body with such an element in a state (``ct_state *``), once per body."""
        u = self._problem.rows(state.displacement)
        for i, body in list(self._bodies.items()):
            mesh, moved = body.mesh, u[body.nodes]
            # Component by component, much faster than along the axis of the nodes.
            if max(np.ptp(moved[:, c]) for c in range(3)) < mesh.shortest_edge / 3.0:
                continue
            # (eq:corner-volume)
            now, before = corner_volumes(mesh, mesh.nodes + moved), corner_volumes(mesh, mesh.nodes)
            left = (now / before).min(axis=1)
            worst = int(left.argmin())
            if left[worst] >= COLLAPSED:
                continue
            del self._bodies[i]
            where = ", ".join(
                f"{x:.4g}" for x in (mesh.nodes + moved)[mesh.elements[worst]].mean(axis=0)
            )
            how = (
                "is inverted" if left[worst] <= 0.0 else f"has {left[worst]:.2g} of its volume left"
            )
            count = int((left < COLLAPSED).sum())
            text = f'body "{body.name}": element {worst} at ({where}) {how} at a corner '
            text += f"at t = {state.time:.4g}, one of {count} that collapse; "
            if body.material.law == "linear":
                text += 'the law "linear" is for small strain: give material '
                text += f'"{body.material.name}" the law "neo_hookean", or check loads and units'
            else:
                text += "check loads and units, or take a finer mesh there"
            yield SceneWarning("volume", text, f"body[{i}]")


def corner_volumes(mesh: Mesh, x: Any) -> Any:
    """The volume spanned by the three edges at each corner of the elements with nodes at x, shape (elements, 8)."""
    volumes = np.empty((len(mesh.elements), 8))
    for first in range(0, len(volumes), TOGETHER):
        corners = x.T[:, mesh.elements[first : first + TOGETHER, :8]]
        a, b, c = (corners[:, :, CORNER_ENDS[:, k]] - corners for k in range(3))
        # For many elements this is much faster than np.cross.
        volumes[first : first + TOGETHER] = sum(
            c[i] * (a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2]) for i in range(3)
        )
    return volumes
