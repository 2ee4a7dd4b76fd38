"""Reading runs from VTKHDF files (layout: docs/theory/output.rst), and the tables of a run that was saved from memory."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import numpy as np

from .mesh import WIDTH, Mesh, need_h5py
from .parts import LAWS, Material
from .run import ENERGY, MOMENTUM, BodyState, Run, State, energy_dtype
from .schema import check_file
from .units import BASES, Units

LAYOUT = 1
KIND = ("hex8", "hex20")


def load(path: Path, record: int = -1) -> Run:
    """Read a run; a ValueError says what is wrong with the file."""
    h5py = need_h5py()
    try:
        if not path.exists():
            raise ValueError(f'can\'t read "{path}": no such file')
        check_file(path)
        with h5py.File(path, "r") as file:
            return _read(path, file, record)
    except OSError as error:
        raise ValueError(f'can\'t read "{path}": {error}') from None
    except KeyError as error:
        raise ValueError(f'"{path}" is no run of libcontact: {error.args[0]}') from None
    except (
        ArithmeticError,
        AttributeError,
        LookupError,
        MemoryError,
        RuntimeError,
        TypeError,
        ValueError,
    ) as error:
        # What a damaged file says may be of any type and size.
        raise (
            error
            if str(path) in str(error)
            else ValueError(f'"{path}" is damaged: {error or type(error).__name__}')
        ) from None


def _read(path: Path, file: Any, record: int) -> Run:
    own, vtk = file["libcontact"], file["VTKHDF"]
    if own.attrs.get("layout") != LAYOUT:
        raise ValueError(f'"{path}" has layout {own.attrs.get("layout")}; layout {LAYOUT} is read')
    count = int(vtk["Steps"].attrs["NSteps"])
    if not -count <= record < count:
        raise ValueError(f'"{path}" has {count} records; there is none with the number {record}')
    record %= count
    bodies = own["body"][()]
    names = [_text(row["name"]) for row in bodies]
    scene = _text(own["scene"][()]) if "scene" in own else ""
    steps, energy, momentum = _tables(own, count, len(names))
    state = State(
        float(vtk["Steps/Values"][record]),
        int(own["step"][record]),
        _bodies(vtk, bodies, names, record),
    )
    return Run(
        bodies=names,
        units=_units(scene),
        steps=steps,
        energy=energy,
        momentum=momentum,
        state=state,
        path=path,
        scene=scene,
        dt=float(own.attrs["dt"]),
    )


def _tables(own: Any, count: int, bodies: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps, energies and momenta: the rows of the recorded steps, or, where the file was saved from memory, its whole history."""
    if "history" in own:
        own, count = own["history"], len(own["history/step"])
    energy = own["energy"][:count]
    if "effects" in own:
        energy = _with_effects(energy, own, count)
    return (
        own["step"][:count],
        _columns(energy, energy.dtype),
        _columns(own["momentum"][: count * bodies], MOMENTUM),
    )


def _with_effects(energy: np.ndarray, own: Any, count: int) -> np.ndarray:
    """The ledger with a column for each further effect, from the table of all effects' work and stored energy."""
    names = [_text(row["name"]) for row in own["effects"][()]]
    stores = [bool(row["stores"]) for row in own["effects"][()]]
    rows = own["effect"][: count * len(names)].reshape(count, len(names))
    out = np.zeros(count, energy_dtype(names))
    for name in ENERGY.names:
        out[name] = energy[name]
    for k, name in enumerate(names):
        if name in out.dtype.names and name not in ENERGY.names:
            out[name] += rows["energy" if stores[k] else "work"][:, k]
    return out


def _columns(rows: np.ndarray, dtype: np.dtype) -> np.ndarray:
    out = np.zeros(len(rows), dtype)
    for name in dtype.names:
        out[name] = rows[name]
    return out


def _bodies(vtk: Any, rows: np.ndarray, names: list[str], record: int) -> dict[str, BodyState]:
    points = vtk["Points"][()]
    connectivity, offsets = vtk["Connectivity"][()], vtk["Offsets"][()]
    fields = {
        name: _field(vtk, "PointData", name, record, len(points))
        for name in ("displacement", "velocity")
    }
    stress = _field(vtk, "CellData", "stress", record, len(offsets) - 1)
    out = {}
    for name, row in zip(names, rows):
        nodes = slice(int(row["first_node"]), int(row["first_node"]) + int(row["node_count"]))
        cells = slice(int(row["first_cell"]), int(row["first_cell"]) + int(row["cell_count"]))
        width = WIDTH[KIND[row["kind"]]]
        elements = (
            connectivity[offsets[cells.start] : offsets[cells.stop]].reshape(-1, width)
            - nodes.start
        )
        mesh = Mesh.copy(np.ascontiguousarray(points[nodes]), elements.astype(np.int32))
        law = LAWS[int(row["law"])] if "law" in rows.dtype.names else LAWS[0]
        material = Material(
            "", float(row["young"]), float(row["poisson"]), float(row["density"]), law
        )
        cut = [
            None if fields[field] is None else fields[field][nodes]
            for field in ("displacement", "velocity")
        ]
        out[name] = BodyState(name, mesh, material, *cut, None if stress is None else stress[cells])
    return out


def _field(vtk: Any, group: str, name: str, record: int, rows: int) -> np.ndarray | None:
    """The rows of one field at one record, read-only; None where the file doesn't hold the field."""
    if name not in vtk[group]:
        return None
    start = int(vtk[f"Steps/{group}Offsets/{name}"][record])
    values = np.ascontiguousarray(vtk[f"{group}/{name}"][start : start + rows], np.float64)
    if not np.isfinite(values).all():
        raise ValueError(f"the field {name} of record {record} is damaged: it is not finite")
    values.flags.writeable = False
    return values


def _units(scene: str) -> Units | None:
    try:
        table = tomllib.loads(scene)["units"]
        if all(table[base] in names for base, names in BASES.items()):
            return Units(*(table[base] for base in ("length", "mass", "time")))
    except (tomllib.TOMLDecodeError, KeyError, TypeError):
        pass
    return None


def _text(value: Any) -> str:
    return value.decode(errors="replace").rstrip("\0") if isinstance(value, bytes) else str(value)


def write_tables(path: Path, steps: np.ndarray, energy: np.ndarray, momentum: np.ndarray) -> None:
    """Add the history of a run in memory to a file that holds its last state only, in the group libcontact/history."""
    with need_h5py().File(path, "r+") as file:
        group = file.create_group("libcontact/history")
        group["step"], group["energy"], group["momentum"] = steps, energy, momentum
