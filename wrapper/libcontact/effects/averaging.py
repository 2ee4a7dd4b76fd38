"""``[averaging]``: a mass that is averaged over neighbouring nodes (chapter "Averaged mass")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from .._core import ffi
from ..units import Units
from . import OnBodies


class Averaging(OnBodies):
    """A mass that is averaged over neighbouring nodes, so that short dilatational waves along the
    axes have almost the correct speed (:doc:`/theory/averaging`).

    Attributes
    ----------
    bodies
        Names of the bodies that it acts on.
    """

    without = "no [averaging]: short waves are slow, and fronts ring"

    def members(self, maker: Any) -> dict[str, Any]:
        """The bodies, and the nodes of all surfaces on which forces of the solver act."""
        nodes = [maker.face_nodes(surface) for surface in _apart(maker.parts)]
        rows = maker.keep(np.concatenate(nodes) if nodes else np.empty(0, np.int32))
        apart = ffi.from_buffer("int32_t[]", rows) if nodes else ffi.NULL
        return {**super().members(maker), "apart": apart, "apart_count": len(rows)}

    def describe(self, units: Units) -> str:
        return f"accelerations of {self.whom} are averaged, except at contacts, obstacles and prescribed motions"


def _apart(parts: Any) -> Iterator[tuple[str, str]]:
    """Surfaces whose forces are computed after the averaging."""
    for contact in parts.contact:
        yield from contact.surfaces
    yield from (obstacle.surface for obstacle in parts.obstacle)
    yield from (support.set for support in parts.support if support.history)
