"""A whole scene from its tables: read, then checked for what the tables say of each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from .effects import Added, Effect, absorb, damping, gravity, load, obstacle, viscosity
from .model import Body, Contact, History, Material, Output, Support, Time
from .model import Run as RunKeys
from .schema import Place, Table, Text, describe, suggestion
from .units import Units

# In the order in which their forces are added and their columns stand in the ledger.
EFFECTS: dict[str, type[Effect]] = {
    "obstacle": obstacle.Obstacle,
    "gravity": gravity.Gravity,
    "load": load.Load,
    "damping": damping.Damping,
    "absorb": absorb.Absorb,
    "viscosity": viscosity.Viscosity,
}
MANY: dict[str, type[Table]] = {
    "material": Material,
    "body": Body,
    "contact": Contact,
    "support": Support,
    **{name: effect for name, effect in EFFECTS.items() if effect.many},
}
ONCE: dict[str, type[Table]] = {
    "units": Units,
    **{name: effect for name, effect in EFFECTS.items() if not effect.many},
    "time": Time,
    "output": Output,
    "run": RunKeys,
}
# What a scene can't lack, and what it may lack while it is being built.
NEEDED, LATER = ("units",), ("body", "time")
NO_FRICTION = "can't stand alone: there is no friction without a pressure; write friction = 0.3 in a [[contact]] or an [[obstacle]]"


@dataclass(frozen=True, eq=False)
class Parts:
    """A whole checked scene; ``time`` is None as long as a scene that is built in Python has none."""

    title: str
    units: Units
    materials: dict[str, Material]
    bodies: dict[str, Body]
    contacts: tuple[Contact, ...]
    supports: tuple[Support, ...]
    effects: tuple[Added, ...]
    time: Any
    output: Output
    run: RunKeys

    @property
    def threads(self) -> int:
        """Threads of the run."""
        return self.run.threads

    @property
    def savings(self) -> Sequence[str]:
        """What may be left out because it changes no result."""
        return self.run.savings

    def histories(self) -> list[History]:
        """The histories of loads, obstacles and supports."""
        given = [*self.supports, *(added.given for added in self.effects)]
        found = (getattr(table, "history", None) for table in given)
        return [history for history in found if history is not None]


def read(data: Any, file: str | None = None, whole: bool = True) -> Parts:
    """Check the tables of a scene. ``whole`` also asks for what a scene that is still being built may lack: bodies and time."""
    top = Place("", file)
    tables = read_tables(data, top, NEEDED + LATER if whole else NEEDED)
    names = {key: _named(tables[key], top / key) for key in ("material", "body")}
    for key, tables_of_key in tables.items():
        for at, table in _placed(key, tables_of_key, top):
            for place, part in table.walk(at):
                _refuse(part.refusals(), place)
                _check_references(part, place, names)
    if whole and not tables["body"]:
        raise (top / "body").error("there is no [[body]]; a scene needs at least one")
    parts = Parts(
        title=Text().read(data.get("title", ""), top / "title"),
        units=tables["units"],
        materials=names["material"],
        bodies=names["body"],
        contacts=tables["contact"],
        supports=tables["support"],
        effects=tuple(
            Added(at.key, given) for key in EFFECTS for at, given in _placed(key, tables[key], top)
        ),
        time=tables["time"],
        output=tables["output"] or Output(),
        run=tables["run"] or RunKeys(),
    )
    for key, reason in conflicts(parts):
        raise (top / key).error(reason)
    return parts


def read_tables(data: Any, top: Place, needed: Sequence[str]) -> dict[str, Any]:
    """The tables of a scene by their keys, each key checked alone: a tuple of those that may stand several times, else one or None."""
    if not isinstance(data, dict):
        raise top.error(f"is {describe(data)}; it must be a table")
    out: dict[str, Any] = {}
    for key in data:
        if key == "friction":
            raise (top / key).error(NO_FRICTION)
        if key not in ONCE and key not in MANY and key != "title":
            known = ["title", *ONCE, *MANY]
            raise (top / str(key)).error("unknown key" + suggestion(key, known))
        if data[key] is None:
            raise (top / key).error("is None; leave the key out instead")
    for key in needed:
        if key in ONCE and key not in data:
            raise (top / key).error("is missing")
    for key, table in ONCE.items():
        out[key] = table.read(data[key], top / key) if key in data else None
    for key, table in MANY.items():
        given = data.get(key, [])
        if not isinstance(given, (list, tuple)):
            reason = f"is {describe(given)}; it must be an array of tables, written [[{key}]]"
            raise (top / key).error(reason)
        out[key] = tuple(table.read(item, (top / key)[i]) for i, item in enumerate(given))
    return out


def schema() -> dict[str, Any]:
    """
    The JSON Schema of a scene file, for editors and other programs.

    Returns
    -------
    dict
        The schema (draft 2020-12). It holds what each key may be; what keys say of each other is checked when the scene is read.
    """
    tables = {key: table.schema() for key, table in ONCE.items()}
    tables |= {key: {"type": "array", "items": table.schema()} for key, table in MANY.items()}
    tables["body"]["minItems"] = 1
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "libcontact scene",
        "type": "object",
        "properties": {"title": {"type": "string"}, **tables},
        "required": [*NEEDED, *LATER],
        "additionalProperties": False,
    }


def _placed(key: str, tables: Any, top: Place) -> Iterator[tuple[Place, Any]]:
    """The tables of a key with their places."""
    if key in MANY:
        yield from (((top / key)[i], table) for i, table in enumerate(tables))
    elif tables is not None:
        yield top / key, tables


def _named(tables: Sequence[Any], at: Place) -> dict[str, Any]:
    """Tables by their names, which must differ."""
    out: dict[str, Any] = {}
    for i, table in enumerate(tables):
        if table.name in out:
            raise (at[i] / "name").error(f'"{table.name}" is used twice')
        out[table.name] = table
    return out


def _refuse(refusals: Iterator[tuple[str, str]], at: Place) -> None:
    """Raise the first refusal."""
    for key, reason in refusals:
        raise (at / key).error(reason)


def _check_references(table: Table, at: Place, names: Mapping[str, Mapping[str, Any]]) -> None:
    """Refuse names of materials and bodies that are not there."""
    for name, field in table.keys().items():
        value = getattr(table, name)
        if value is not None:
            for place, key, wanted in field.metadata["kind"].references(value, at / name):
                if wanted not in names[key]:
                    near = suggestion(wanted, names[key])
                    raise place.error(f'no {key} is named "{wanted}"{near}')


# Tables that are right one by one and contradict each other together.


def conflicts(parts: Parts) -> Iterator[tuple[str, str]]:
    """Keys of later ones of two tables that contradict each other, and the reasons."""
    yield from _bodies(parts)
    yield from _same_pair(parts)
    yield from _absorbing(parts)


def _bodies(parts: Parts) -> Iterator[tuple[str, str]]:
    """What the law of a body, its elements and its kernel do not have."""
    for i, (name, body) in enumerate(parts.bodies.items()):
        law = parts.materials[body.material].law
        for key, reason in body.small_strain_only(body.material, law):
            yield f"body[{i}].{key}", reason
        for added in parts.effects:
            on = getattr(added.given, "bodies", ()) is None or name in _bodies_of(added.given)
            if on and added.name == "viscosity" and body.bricks == "hex20":
                yield f"{added.key}.bodies", f'"{name}" is of hex20; bulk viscosity is for hex8'
            if on and body.kernel == "plane":
                yield from _out_of_plane(parts, body, added)


def _bodies_of(given: Any) -> Sequence[str]:
    """The bodies that an effect names, as a whole or by a surface."""
    bodies: Sequence[str] = getattr(given, "bodies", None) or getattr(given, "surface", ())[:1]
    return bodies


def _out_of_plane(parts: Parts, body: Body, added: Added) -> Iterator[tuple[str, str]]:
    """A load along the thickness of a body that asks for the kernel of plane strain."""
    held = {axis for each in parts.supports if each.body == body.name for axis in each.fix}
    cells = body.box.cells if body.box else ()
    thin = [k for k, n in enumerate(cells) if n == 1 and "xyz"[k] in held]
    vector = getattr(added.given, "acceleration", getattr(added.given, "traction", None))
    if vector is not None and thin and all(vector[k] != 0.0 for k in thin):
        yield (
            added.key,
            f'acts on "{body.name}" along {"xyz"[thin[0]]}, the thickness of its plane strain (kernel = "plane"), where nothing may move',
        )


def _same_pair(parts: Parts) -> Iterator[tuple[str, str]]:
    """Two contacts of one pair would press twice."""
    seen: dict[frozenset[tuple[str, str]], int] = {}
    for i, contact in enumerate(parts.contacts):
        first = seen.setdefault(frozenset(contact.surfaces), i)
        if first != i:
            yield (
                f"contact[{i}].surfaces",
                f"is the pair of contact[{first}]; its penalty would count twice (the order of the two surfaces makes no difference)",
            )


def _absorbing(parts: Parts) -> Iterator[tuple[str, str]]:
    """A surface that absorbs twice has twice the impedance and reflects a third of each wave; one that can't move takes no energy out."""
    seen: dict[tuple[str, str], str] = {}
    for added in parts.effects:
        if added.name != "absorb":
            continue
        surface, name = added.given.surface, f'"{".".join(added.given.surface)}"'
        first = seen.setdefault(surface, added.key)
        if first != added.key:
            yield (
                f"{added.key}.surface",
                f"{name} absorbs already ({first}); with twice the impedance it would reflect again",
            )
        held = {
            axis for support in parts.supports if support.set == surface for axis in support.fix
        }
        if len(held) == 3:
            yield (
                f"{added.key}.surface",
                f"{name} is held along x, y and z by a [[support]]; what does not move absorbs nothing",
            )
