"""The tables of a scene for the pages: the keys of Python's model with kinds, limits, words and defaults, as JSON.

``KEPT`` names the keys that a page computes; a page refuses the others by their names.
"""

from __future__ import annotations

from typing import Any

from libcontact.parts import NO_TABLE, Parts

from libcontact import schema, units

KEPT: dict[str, str] = {
    "Parts": "title units material body contact support obstacle gravity load damping time output probe run",
    "Units": "length mass time",
    "Material": "name young poisson density law",
    "Body": "name material box ring cylinder ball shell element velocity spin initial integration",
    "Box": "origin size cells layers grading symmetric",
    "Ring": "centre radius width cells",
    "Cylinder": "centre radius width cells",
    "Ball": "centre radius cells",
    "Shell": "centre radius cells",
    "Spin": "axis rate centre",
    "Initial": "displacement gradient angle axis centre stress",
    "Contact": "surfaces beta epsilon enforcement dissipation restitution friction tangent adjust "
    "initial_penetration points method",
    "Support": "set fix velocity",
    "Obstacle": "surface plane sphere cylinder velocity travel history beta epsilon enforcement dissipation "
    "restitution friction tangent adjust initial_penetration points",
    "Plane": "point normal",
    "Sphere": "centre radius",
    "obstacle.Cylinder": "centre radius axis",
    "Gravity": "acceleration history",
    "Load": "surface traction pressure following history",
    "Damping": "bodies rate stiffness",
    "History": "time value",
    "Time": "end end_c1t_over courant fraction dt integrator",
    "FrontTime": "length value",
    "Output": "file fields every times",
    "Probe": "name body point resultant every",
    "Run": "threads savings",
}


def name_of(model: type[schema.Table]) -> str:
    name = model.__name__
    return "obstacle.Cylinder" if "obstacle" in model.__module__ and name == "Cylinder" else name


def kind_of(kind: schema.Kind, found: dict[str, Any]) -> dict[str, Any]:
    """A kind of values; the tables within it go to ``found``."""
    out: dict[str, Any] = {"kind": type(kind).__name__}
    match kind:
        case schema.Number():
            out |= {"why": kind.why, "limits": [[h[1], value] for h, value in kind.limits.items()]}
        case schema.Whole():
            out |= {"least": kind.least, "most": kind.most, "step": kind.step}
        case schema.Flag():
            out |= {"only": kind.only}
        case schema.Reference():
            out |= {"table": kind.table}
        case schema.PartKey():
            out |= {"tables": list(kind.tables)}
        case schema.Choice():
            out |= {"known": list(kind.known), "gone": dict(kind.gone)}
        case schema.Each():
            out |= {"kinds": [kind_of(each, found) for each in kind.kinds]}
        case schema.Many():
            out |= {"of": kind_of(kind.kind, found), "none": kind.none, "distinct": kind.distinct}
        case schema.OneOrByName():
            # Sets of elements have materials of their own only in meshes from files.
            return kind_of(kind.kind, found)
        case schema.Nested():
            out |= {"table": table_of(kind.model, found)}
    return out


def table_of(model: type[schema.Table], found: dict[str, Any]) -> str:
    """The name of a table, which with its keys is in ``found`` then."""
    name = name_of(model)
    if name in found:
        return name
    table = found[name] = {
        "one": [list(group) for group in model.one],
        "rivals": [list(group) for group in model.rivals],
        "needs": dict(model.needs),
        "belongs": {key: list(other) for key, other in model.belongs.items()},
        "keys": {},
    }
    kept = KEPT.get(name, "").split()
    for key, field in model.keys().items():
        about: dict[str, Any] = {"required": schema.required(field), "kept": key in kept}
        if isinstance(field.default, (bool, int, float, str)):
            about["default"] = field.default
        if key in kept:
            about |= kind_of(field.metadata["kind"], found)
        table["keys"][key] = about
    return name


def tables() -> dict[str, Any]:
    found: dict[str, Any] = {}
    table_of(Parts, found)
    bases = {"length": units.LENGTH, "mass": units.MASS, "time": units.TIME}
    names = {name: list(known.items()) for name, known in units.NAMES.items()}
    labels = {"bases": bases, "exponents": units.EXPONENTS, "names": names}
    return {"tables": found, "faces": list(schema.FACES), "gone": NO_TABLE, "units": labels}
