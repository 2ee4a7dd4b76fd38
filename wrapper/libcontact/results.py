"""Reading runs from VTKHDF files (layout: docs/theory/output.rst), and the tables of a run that was saved from
memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from .bridge import Floats, Ints, Rows
from .mesh import KINDS, WIDTH, Mesh, open_hdf5, text_in
from .model import FIELDS, FILTERED, LAWS, Material
from .older import tomllib
from .schema import Place
from .state import BodyState, State
from .tables import MOMENTUM, Table, as_table, energy_table
from .units import Units

LAYOUT = 1
T = TypeVar("T")


def read(path: Path, record: int = -1) -> dict[str, Any]:
    """Read what a ``Run`` holds; a ValueError names what is wrong with the file."""
    return _reading(path, lambda file: _read(path, file, record))


def origin(path: Path) -> tuple[str, float]:
    """Read only the scene's text and the time step of a run."""
    return _reading(path, lambda file: _origin(path, file))


class Records(Sequence[State]):
    """The states of a results file; each is read when it is used. They share their meshes."""

    def __init__(self, path: Path, length: int):
        self.path, self.length = path, length
        self.meshes = dict[str, Mesh]()

    def __len__(self) -> int:
        return self.length

    def __getitem__(self, record: Any) -> Any:
        if isinstance(record, slice):
            return [self[i] for i in range(*record.indices(self.length))]
        if not -self.length <= record < self.length:
            raise IndexError(f'"{self.path}" has {self.length} records')
        return _reading(self.path, lambda file: _state(file, record % self.length, self.meshes))


def in_file(path: Path) -> dict[str, Any]:
    """The version of the library that wrote a run, and the fields that it recorded."""

    def read(file: Any) -> dict[str, Any]:
        groups = [file["VTKHDF"][name] for name in ("PointData", "CellData")]
        fields = [name for name in (*FIELDS, *FILTERED) if any(name in group for group in groups)]
        return {"version": text_in(file["libcontact"].attrs["version"]), "fields": fields}

    return _reading(path, read)


def _reading(path: Path, read: Callable[[Any], T]) -> T:
    with open_hdf5(path) as file:
        try:
            return read(file)
        except KeyError as error:
            raise ValueError(f'"{path}" is not a run of libcontact: {error.args[0]}') from None
        except Exception as error:
            # The contents of a damaged file may have any type and size.
            if str(path) in str(error):
                raise
            reason = str(error) or type(error).__name__
            raise ValueError(f'"{path}" is damaged: {reason}') from None


def _origin(path: Path, file: Any) -> tuple[str, float]:
    own = file["libcontact"]
    if own.attrs.get("layout") != LAYOUT:
        raise ValueError(f'"{path}" has layout {own.attrs.get("layout")}; layout {LAYOUT} is read')
    return text_in(own["scene"][()]) if "scene" in own else "", float(own.attrs["dt"])


def _read(path: Path, file: Any, record: int) -> dict[str, Any]:
    scene, dt = _origin(path, file)
    own, vtk = file["libcontact"], file["VTKHDF"]
    count = int(vtk["Steps"].attrs["NSteps"])
    if not -count <= record < count:
        raise ValueError(f'"{path}" has {count} records; there is none with the number {record}')
    record %= count
    bodies = own["body"][()]
    state = _state(file, record, {})
    probes, records = _probes(own, float(vtk["Steps/Values"][count - 1])), Records(path, count)
    # The rows of the recorded steps, or the whole history in a file that was saved from memory.
    if "history" in own:
        own, count = own["history"], len(own["history/step"])
    return dict(
        bodies=[text_in(row["name"]) for row in bodies],
        units=_units(scene),
        steps=own["step"][:count].astype(np.int64),
        energy=as_table(_energy(own, count)),
        momentum=as_table(_momentum(own["momentum"][: count * len(bodies)])),
        state=state,
        states=records,
        path=path,
        scene=scene,
        dt=dt / _parts(state.time, state.step, dt),
        probes=probes,
        pressure=NotInFile('record the field "contact_pressure" and read it from run.state'),
        impulse=NotInFile("record a [[probe]] of the resultant, or use run.momentum"),
    )


def _parts(time: float, step: int, dt: float) -> int:
    """The number of parts into which a run has divided the step of its file, :eq:`record-step`."""
    return max(1, round(dt * step / time)) if time > 0.0 and step > 0 else 1


def _state(file: Any, record: int, meshes: dict[str, Mesh]) -> State:
    """The bodies at one record, with those of the ``meshes`` that have the same arrays; others are added to them."""
    own, vtk = file["libcontact"], file["VTKHDF"]
    time, step = float(vtk["Steps/Values"][record]), int(own["step"][record])
    scene = text_in(own["scene"][()]) if "scene" in own else ""
    return State(
        time, step, _bodies(vtk, own["body"][()], record, _initial_stresses(scene), meshes)
    )


@lru_cache(maxsize=1)  # all records of a file have the same text
def _initial_stresses(scene: str) -> dict[str, Any]:
    """The initial stress of each body that has one."""
    bodies = tomllib.loads(scene)["body"] if "initial" in scene else []
    found = {body["name"]: body.get("initial", {}).get("stress") for body in bodies}
    return {name: stress for name, stress in found.items() if stress}


class NotInFile(dict[str, Any]):
    """The empty table of a run that was read from a file; a lookup raises an error that names the
    alternative."""

    def __init__(self, instead: str):
        super().__init__()
        self.instead = instead

    def __missing__(self, name: str) -> Any:
        raise KeyError(f'a run from a file has no table for "{name}"; {self.instead}')


def _probes(own: Any, last: float) -> dict[str, Table]:
    """The histories up to the last record; a killed run may have written further rows."""
    tables = {name: table[()] for name, table in own.get("probe", {}).items()}
    return {name: as_table(rows[rows["time"] <= last]) for name, rows in tables.items()}


def _momentum(held: Rows) -> Rows:
    """The momenta of bodies; an impulse that is missing in an older file is NaN."""
    momentum = np.zeros(len(held), MOMENTUM)
    for name in MOMENTUM.names or ():
        momentum[name] = held[name] if name in (held.dtype.names or ()) else np.nan
    return momentum


def _energy(own: Any, count: int) -> Rows:
    """The energy balance; in a file that was written during a run, effects have a table of their own."""
    energy: Rows = own["energy"][:count]
    if "effects" not in own:
        return energy
    effects = own["effects"][()]
    values = own["effect"][: count * len(effects)].reshape(count, len(effects))
    values = np.where(effects["stores"], values["energy"], values["work"])
    return energy_table(energy, [text_in(name) for name in effects["name"]], values)


def _same(mesh: Mesh | None, nodes: Floats, elements: Ints) -> bool:
    """Whether a mesh has these arrays and so need not be copied and checked again."""
    return (
        mesh is not None
        and np.array_equal(mesh.nodes, nodes)
        and np.array_equal(mesh.elements, elements)
    )


def _bodies(
    vtk: Any, rows: Rows, record: int, stresses: dict[str, Any], meshes: dict[str, Mesh]
) -> dict[str, BodyState]:
    points, connectivity, offsets = (
        vtk[name][()] for name in ("Points", "Connectivity", "Offsets")
    )
    groups = {
        name: "CellData" if name.startswith("stress") else "PointData"
        for name in (*FIELDS, *FILTERED)
    }
    count = {"PointData": len(points), "CellData": len(offsets) - 1}
    held = {name: group for name, group in groups.items() if name in vtk[group]}
    fields = {name: _field(vtk, of, name, record, count[of]) for name, of in held.items()}
    out = {}
    for row in rows:
        nodes, cells = (
            slice(row[f"first_{what}"], row[f"first_{what}"] + row[f"{what}_count"])
            for what in ("node", "cell")
        )
        elements = connectivity[offsets[cells.start] : offsets[cells.stop]] - nodes.start
        elements = elements.reshape(-1, WIDTH[list(KINDS)[row["kind"]]]).astype(np.int32)
        law = tuple(LAWS)[row["law"] if "law" in row.dtype.names else 0]
        constants = {name: float(row[name]) for name in ("young", "poisson", "density")}
        name, own = text_in(row["name"]), np.ascontiguousarray(points[nodes])
        if not _same(meshes.get(name), own, elements):
            meshes[name] = Mesh.copy(own, elements)
        part = {"PointData": nodes, "CellData": cells}
        cut = {key: values[part[groups[key]]] for key, values in fields.items()}
        if "rigid" in row.dtype.names and row["rigid"]:
            cut.setdefault("stress", np.zeros((len(elements), 6)))
        several = "materials" in row.dtype.names and row["materials"] != 0
        material = None if several else Material("", **constants, law=law)
        out[name] = BodyState(name, meshes[name], material, stresses.get(name), (), **cut)
    return out


def _field(vtk: Any, group: str, name: str, record: int, rows: int) -> Floats:
    """The rows of one field at one record."""
    start = int(vtk[f"Steps/{group}Offsets/{name}"][record])
    values = np.ascontiguousarray(vtk[f"{group}/{name}"][start : start + rows], np.float64)
    if not np.isfinite(values).all():
        raise ValueError(f"the field {name} of record {record} is damaged: it is not finite")
    return values


def _units(scene: str) -> Units | None:
    try:
        return Units.read(tomllib.loads(scene)["units"], Place())
    except (ValueError, KeyError, TypeError):
        return None


def write_tables(path: Path, steps: Any, energy: Rows, momentum: Rows) -> None:
    """Add the history of a run in memory to a file with its last state, in the group
    libcontact/history."""
    with open_hdf5(path, "r+") as file:
        group = file.create_group("libcontact/history")
        group["step"], group["energy"], group["momentum"] = steps, energy, momentum
