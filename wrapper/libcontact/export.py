"""Results in the formats of other programs: CSV, VTU and XDMF."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from .errors import NotBuiltIn, install
from .run import Run
from .state import BodyState, State
from .tables import write_csv

# Names of the cells in meshio.
CELLS = {"hex8": "hexahedron", "hex20": "hexahedron20"}
# Fields with values at the points.
POINTS = ("displacement", "velocity", "contact_pressure")


def to_csv(run: Run, folder: Path) -> None:
    """The tables of a run, one file each, in a folder that is made if there is none."""
    folder.mkdir(parents=True, exist_ok=True)
    tables = {"energy": run.energy, "momentum": run.momentum}
    tables |= {f"probe_{name}": rows for name, rows in run.probes.items()}
    for name, table in tables.items():
        write_csv(folder / (re.sub(r"[^\w.-]", "_", name) + ".csv"), table, run.bodies)


def to_vtu(run: Run, path: Path) -> None:
    """The state of a run as an unstructured grid of VTK."""
    assert run.state is not None
    meshio = _meshio()
    points, cells = _fields(run.state)
    grid = meshio.Mesh(*_mesh(run.state), point_data=points, cell_data=cells)
    meshio.write(path, grid, file_format="vtu")


def to_xdmf(run: Run, path: Path) -> None:
    """All records of a run as a time series, whose numbers are in an HDF5 file beside it."""
    assert run.path is not None
    numbers = path.with_suffix(".h5")
    if numbers.exists() and numbers.samefile(run.path):
        raise ValueError(f'"{numbers}" holds the numbers of "{path}", and is the run itself')
    meshio = _meshio()
    # meshio writes the numbers into the current folder.
    with contextlib.chdir(path.parent), meshio.xdmf.TimeSeriesWriter(path.name) as writer:
        for number, state in enumerate(run.states):
            if number == 0:
                writer.write_points_cells(*_mesh(state))
            points, cells = _fields(state)
            writer.write_data(state.time, point_data=points, cell_data=cells)


FORMATS: dict[str, Callable[[Run, Path], None]] = {"csv": to_csv, "vtu": to_vtu, "xdmf": to_xdmf}


def _mesh(state: State) -> tuple[Any, list[tuple[str, Any]]]:
    """Points and cells of all bodies, one block for each kind of cells."""
    first, cells = 0, dict[str, list[Any]]()
    for body in state.values():
        cells.setdefault(CELLS[body.mesh.element], []).append(body.elements + first)
        first += len(body.nodes)
    points = np.concatenate([body.nodes for body in state.values()])
    return points, [(kind, np.concatenate(blocks)) for kind, blocks in cells.items()]


def _fields(state: State) -> tuple[dict[str, Any], dict[str, list[Any]]]:
    """The fields that all bodies have: values of the points, and of each block of cells."""
    bodies = list(state.values())
    kinds = list(dict.fromkeys(body.mesh.element for body in bodies))

    def blocks(values: Callable[[int, BodyState], Any]) -> list[Any]:
        numbered = list(enumerate(bodies))
        return [
            np.concatenate([values(i, body) for i, body in numbered if body.mesh.element == kind])
            for kind in kinds
        ]

    names = [name for name in POINTS if all(body.holds(name) for body in bodies)]
    points = {name: np.concatenate([getattr(body, name) for body in bodies]) for name in names}
    cells = {"body": blocks(lambda i, body: np.full(len(body.elements), i))}
    if all(body.holds("stress") for body in bodies):
        cells["stress"] = blocks(lambda i, body: body.stress)
    return points, cells


def _meshio() -> Any:
    try:
        import meshio
    except ImportError:
        raise NotBuiltIn(f"this format needs meshio: {install('export')}") from None
    return meshio
