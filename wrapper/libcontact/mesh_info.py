"""What is in a mesh file: cells, sets, size, quality and the time step that it allows."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from ._core import lib
from .bridge import Floats, call, doubles
from .mesh import CORNER_ENDS, Mesh
from .meshes import MeshData
from .scene import Scene

# Speed of the dilatational wave in steel [m/s].
STEEL = 6020.0


def describe(path: str | Path, data: MeshData, speed: float | None = None) -> dict[str, Any]:
    """
    The facts about a mesh as a dictionary.

    Parameters
    ----------
    path : str or Path
        Its file.
    data : MeshData
        What was read from it.
    speed : float, optional
        Speed of the dilatational wave [length / time] for the estimated step; by default that of steel, with
        lengths in metres.

    Returns
    -------
    dict
        Cells, sets with their counts, box, volume, quality, step and notes.
    """
    mesh = Mesh.copy(data.nodes, data.elements)
    quality = scaled_jacobian(data.nodes, data.elements)
    worst = int(np.argmin(quality))
    mass = np.empty(len(data.nodes))
    call(lib.ct_mass_lumped, mesh.pointer, 1.0, lib.CT_LUMP_DEFAULT, doubles(mass))
    low, high = mesh.bounds
    c1 = STEEL if speed is None else speed
    return {
        "file": str(path),
        "bytes": Path(path).stat().st_size,
        "kind": "mesh",
        "format": data.report.format,
        "cells": data.report.read,
        "dropped": data.report.dropped,
        "element": mesh.element,
        "elements": len(data.elements),
        "nodes": len(data.nodes),
        "split": data.report.split,
        "step_factor": data.report.step_factor,
        "from": low.tolist(),
        "to": high.tolist(),
        "volume": math.fsum(mass.tolist()),
        "shortest_edge": mesh.shortest_edge,
        "scaled_jacobian": float(quality[worst]),
        "worst_element": worst,
        "speed": c1,
        "steel": speed is None,
        "step": stable_length(data) / c1,
        "element_sets": {name: len(found) for name, found in data.element_sets.items()},
        "face_sets": {name: len(found) for name, found in data.face_sets.items()},
        "node_sets": {name: len(found) for name, found in data.node_sets.items()},
        "notes": list(data.report.notes),
    }


def scaled_jacobian(nodes: Floats, elements: Any) -> Floats:
    """The smallest determinant of the unit vectors along the edges at a corner, for each element: 1 for a box, 0 for
    a flat one. Corners with a collapsed edge do not count."""
    x = nodes[elements[:, :8]]
    least = np.full(len(x), np.inf)
    for corner, ends in enumerate(CORNER_ENDS):
        edges = x[:, ends] - x[:, corner, None]
        lengths = np.linalg.norm(edges, axis=2)
        size = lengths.max(axis=1)
        whole = (lengths > 1e-9 * size[:, None]).all(axis=1)
        frames = edges[whole] / lengths[whole][:, :, None]
        least[whole] = np.minimum(least[whole], np.linalg.det(frames))
    return least


def stable_length(data: MeshData) -> float:
    """The stable time step times the speed of the dilatational wave [length], for Poisson's ratio 0.3 and small
    strain."""
    nu = 0.3
    c1 = math.sqrt((1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)))
    scene = {
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [{"name": "m", "young": 1.0, "poisson": nu, "density": 1.0}],
        "body": [{"name": "b", "material": "m", "nodes": data.nodes, "elements": data.elements}],
        "time": {"end": float(np.ptp(data.nodes, axis=0).max())},
    }
    return float(Scene(scene)._built(None).stable.dt) * c1


def text(facts: dict[str, Any]) -> str:
    """The facts in lines."""

    def counted(counts: dict[str, int], mark: str = " ") -> str:
        return ", ".join(f"{n}{mark}{name}" for name, n in counts.items())

    def row(name: str, value: str) -> str:
        return f"{name:<10}{value}"

    lines = [f"{facts['file']}: {facts['format']}, {facts['bytes'] / 1e3:.3g} kB"]
    lines.append(row("cells", counted(facts["cells"])))
    if facts["dropped"]:
        lines.append(row("left out", counted(facts["dropped"])))
    lines.append(row("bricks", f"{facts['elements']} {facts['element']}, {facts['nodes']} nodes"))
    if facts["split"]:
        factor = f"the shortest edge is {facts['step_factor']:.2g} times that of the file"
        lines.append(row("split", f"a tetrahedron into four bricks; {factor}"))
    box = (", ".join(f"{x:g}" for x in facts[end]) for end in ("from", "to"))
    lines.append(row("box", "({}) to ({})".format(*box)))
    lines.append(row("volume", f"{facts['volume']:.6g}"))
    lines.append(row("edges", f"shortest {facts['shortest_edge']:.4g}"))
    worst = f"{facts['scaled_jacobian']:.3g} in element {facts['worst_element']}"
    lines.append(row("quality", f"smallest scaled Jacobian {worst} (a box has 1)"))
    of = "steel, lengths in m" if facts["steel"] else "lengths of the file"
    lines.append(row("step", f"at most {facts['step']:.3g} for c1 = {facts['speed']:g} ({of})"))
    for name, what in (("elements", "element"), ("faces", "face"), ("nodes", "node")):
        sets = facts[f"{what}_sets"]
        listed = ", ".join(f'"{each}" {n}' for each, n in sets.items()) or "none"
        lines.append(row(name, f"sets: {listed}"))
    lines += [row("note", note) for note in facts["notes"]]
    return "\n".join(lines)
