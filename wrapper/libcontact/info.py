"""What is in a file: a results file, a mesh or a scene."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .mesh import Mesh, open_hdf5
from .meshes import FORMATS, read_mesh
from .older import tomllib
from .results import in_file
from .run import Run
from .scene import Scene


def describe_file(path: str | Path) -> dict[str, Any]:
    """The facts about a file as a dictionary; a ValueError names what is wrong with it."""
    path = Path(path)
    if path.suffix == ".toml":
        facts = _scene(Scene.load(path))
    elif path.suffix.lower() in FORMATS.keys() - {".vtkhdf"}:
        facts = _mesh(path)
    else:
        with open_hdf5(path) as file:
            run = "libcontact" in file
        facts = _run(path) if run else _mesh(path)
    return {"file": str(path), "bytes": path.stat().st_size, **facts}


def _scene(scene: Scene) -> dict[str, Any]:
    problem = scene._built(None)
    return {
        "kind": "scene",
        "title": problem.parts.title,
        "units": scene.data["units"],
        "bodies": [
            _body(name, body.mesh, body.material.law) for name, body in problem.bodies.items()
        ],
        "effects": list(dict.fromkeys(problem.effects)),
        "steps": [0, problem.step_count],
        "times": [0.0, problem.step_count * problem.dt],
        "dt": problem.dt,
        "probes": [located.given.name for located in problem.probes],
    }


def _run(path: Path) -> dict[str, Any]:
    run = Run.load(path)
    scene = tomllib.loads(run.scene) if run.scene else {}
    return {
        "kind": "results",
        **in_file(path),
        "title": scene.get("title", ""),
        "units": scene.get("units"),
        "bodies": [
            _body(name, body.mesh, body.material.law if body.material else None)
            for name, body in (run.state or {}).items()
        ],
        "records": len(run.steps),
        "steps": [int(run.steps[0]), int(run.steps[-1])],
        "times": [float(run.time[0]), float(run.time[-1])],
        "dt": run.dt,
        "probes": [
            {"name": name, "rows": len(rows), "columns": [*dict(rows.columns())]}
            for name, rows in run.probes.items()
        ],
    }


def _mesh(path: Path) -> dict[str, Any]:
    found = read_mesh(path)
    body = _body("", Mesh.copy(found.nodes, found.elements), None)
    low, high = (getattr(found.nodes, end)(axis=0).tolist() for end in ("min", "max"))
    return {"kind": "mesh", "bodies": [body], "from": low, "to": high}


def _body(name: str, mesh: Mesh, law: str | None) -> dict[str, Any]:
    counts = {"nodes": len(mesh.nodes), "elements": len(mesh.elements), "element": mesh.element}
    return {"name": name, **counts, **({"law": law} if law else {})}


def text(facts: dict[str, Any]) -> str:
    """The facts in lines."""
    units = facts.get("units") or {}
    time = f" {units['time']}" if units else ""
    lines = [f"{facts['file']}: {facts['kind']}, {_size(facts['bytes'])}"]
    if "version" in facts:
        lines[0] += f", written by libcontact {facts['version']}"
    if facts.get("title"):
        lines.append(f"title    {facts['title']}")
    if units:
        lines.append(f"units    {', '.join(units.values())}")
    for body in facts["bodies"]:
        name = f"{body['name']}: " if body["name"] else ""
        law = f", {body['law']}" if "law" in body else ""
        counts = f"{body['elements']} {body['element']}, {body['nodes']} nodes"
        lines.append(f"body     {name}{counts}{law}")
    if "effects" in facts:
        lines.append(f"effects  {', '.join(facts['effects'])}")
    if "steps" in facts:
        records = f" in {facts['records']} records" if "records" in facts else ""
        lines.append(f"steps    {facts['steps'][0]} to {facts['steps'][1]}{records}")
        first, last = facts["times"]
        lines.append(f"time     {first:.6g} to {last:.6g}{time}, step {facts['dt']:.6g}{time}")
    if "from" in facts:
        box = (", ".join(f"{x:g}" for x in facts[end]) for end in ("from", "to"))
        lines.append("box      ({}) to ({})".format(*box))
    if "fields" in facts:
        lines.append(f"fields   {', '.join(facts['fields']) or 'none'}")
    for probe in facts.get("probes", []):
        if isinstance(probe, str):
            lines.append(f"probe    {probe}")
        else:
            columns = ", ".join(probe["columns"])
            lines.append(f"probe    {probe['name']}: {probe['rows']} rows of {columns}")
    return "\n".join(lines)


def _size(count: int) -> str:
    """Bytes for a reader."""
    for factor, unit in ((1e9, "GB"), (1e6, "MB"), (1e3, "kB")):
        if count >= factor:
            return f"{count / factor:.3g} {unit}"
    return f"{count} bytes"
