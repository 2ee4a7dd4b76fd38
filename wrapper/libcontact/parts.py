"""A whole scene from its tables, read and checked for contradictions between tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

from .effects import Added, Effect, absorb, damping, gravity, load, obstacle, rigid, tie, viscosity
from .mesh import FACTS
from .model import (
    FEEDS,
    FIELDS,
    LARGE,
    Body,
    Contact,
    History,
    Material,
    Output,
    Probe,
    Run,
    Support,
    Time,
)
from .schema import FACES, Face, Nested, Place, Several, Table, Text, key, suggestion, walk
from .units import Units

# Tables that a scene cannot have, and what to write instead.
NO_TABLE = {
    "friction": "can't stand alone: there is no friction without a pressure; write friction = 0.3 in a [[contact]] or an [[obstacle]]",
    "averaging": "is gone: other methods reach its errors at a lower price; for a front without oscillations write "
    'integrator = "tchamwa_wielgosz" in [time]',
}


class Parts(Table):
    """A whole scene, whose keys are its tables. Forces are added, and columns of the energy balance are
    written, in the order of the effects' tables."""

    title: str = key(Text(), default="")
    units: Units = key(Nested(Units))
    material: tuple[Material, ...] = key(Several(Material), default=())
    body: tuple[Body, ...] = key(Several(Body), default=())
    contact: tuple[Contact, ...] = key(Several(Contact), default=())
    support: tuple[Support, ...] = key(Several(Support), default=())
    obstacle: Any = key(Several(obstacle.Obstacle), default=())
    gravity: Any = key(Nested(gravity.Gravity), default=None)
    load: Any = key(Several(load.Load), default=())
    damping: Any = key(Nested(damping.Damping), default=None)
    absorb: Any = key(Several(absorb.Absorb), default=())
    viscosity: Any = key(Nested(viscosity.Viscosity), default=None)
    tie: Any = key(Several(tie.Tie), default=())
    rigid: Any = key(Several(rigid.Rigid), default=())
    time: Any = key(Nested(Time), default=None)
    output: Output = key(Nested(Output), default=Output())
    probe: tuple[Probe, ...] = key(Several(Probe), default=())
    run: Run = key(Nested(Run), default=Run())

    @cached_property
    def materials(self) -> dict[str, Material]:
        """The materials by name."""
        return {material.name: material for material in self.material}

    def materials_of(self, body: Body) -> tuple[Material, ...]:
        """The materials of a body, each once."""
        return tuple(self.materials[name] for name in body.material_names)

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """The bodies by name."""
        return {body.name: body for body in self.body}

    @cached_property
    def effects(self) -> tuple[Added, ...]:
        """The effects, each with its key."""
        found = walk(self, Place())
        return tuple(Added(at.key, table) for at, table in found if isinstance(table, Effect))

    @cached_property
    def rigid_names(self) -> frozenset[str]:
        """Names of the bodies that are rigid as a whole."""
        return frozenset(each.body for each in self.rigid if each.body)

    @property
    def fields(self) -> Sequence[str]:
        """The fields that are written: those of the output, or by default all that the scene has."""
        if self.output.fields is not None:
            return self.output.fields
        return FIELDS if self.contact or self.obstacle else FIELDS[:3]

    @property
    def relaxed(self) -> bool:
        """Whether dynamic relaxation looks for a state of rest."""
        return self.damping is not None and bool(self.damping.relaxation)

    def histories(self) -> list[History]:
        """The histories of gravity, loads, obstacles and supports."""
        return [table for _, table in walk(self, Place()) if isinstance(table, History)]


MODELS = {name: field.metadata["kind"] for name, field in Parts.keys().items() if name != "title"}
MANY = {name: kind.model for name, kind in MODELS.items() if isinstance(kind, Several)}
ONCE = {name: kind.model for name, kind in MODELS.items() if name not in MANY}
EFFECTS = {name: kind.model for name, kind in MODELS.items() if issubclass(kind.model, Effect)}


def read(data: Any, file: str | None = None, whole: bool = True) -> Parts:
    """Check the tables of a scene. ``whole`` also requires bodies and time, which a scene that is still
    being built may lack."""
    top = Place("", file, _dotted(data), _home)
    for name, reason in NO_TABLE.items():
        if isinstance(data, dict) and name in data:
            raise (top / name).error(reason)
    parts = _usual_time(_without_reserve(Parts.read(data, top), data), data)
    if whole and parts.time is None:
        raise (top / "time").error("is missing")
    for name in ("material", "body", "probe"):
        names = [table.name for table in getattr(parts, name)]
        for i, word in enumerate(names):
            if word in names[:i]:
                raise ((top / name)[i] / "name").error(f'"{word}" is used twice')
    for at, found in walk(parts, top):
        if isinstance(found, Table):
            for name, reason in found.refusals():
                raise (at / name).error(reason)
            continue
        if isinstance(found, Face):
            _check_set(parts, found, at)
            continue
        known = [table.name for table in getattr(parts, found.table)]
        if found not in known:
            raise at.error(f'no {found.table} is named "{found}"{suggestion(found, known)}')
    if whole and not parts.body:
        raise (top / "body").error("there is no [[body]]; a scene needs at least one")
    for name, reason in (*conflicts(parts), *(_deforming(parts) if whole else ())):
        raise (top / name).error(reason)
    return parts


def _home(name: str) -> str:
    """The tables that have a key which is unknown where it stands."""
    there = [each for each, kind in MODELS.items() if name in kind.model.keys()]
    written = " or ".join(f"[[{each}]]" if each in MANY else f"[{each}]" for each in there)
    return f'; "{name}" belongs to {written}' if there else ""


def _dotted(data: Any) -> tuple[str, ...]:
    """Names of bodies that have dots, in tables that are not checked yet."""
    bodies = data.get("body") if isinstance(data, dict) else None
    tables = [each for each in bodies if isinstance(each, dict)] if isinstance(bodies, list) else []
    names = [name for table in tables if isinstance(name := table.get("name"), str)]
    return tuple(name for name in names if "." in name)


def _check_set(parts: Parts, surface: Face, at: Place) -> None:
    """Raise an error for a surface that its body does not have. The sets of a mesh file are known when it is
    read."""
    body = parts.bodies.get(surface.body)
    sets = None if body is None else body.mesh_sets
    if sets is None or surface.face in FACES or sets.kinds(surface.face):
        return
    why = f'has no face "{surface.face}"{suggestion(surface.face, FACES)}'
    if sets:
        why = sets.unknown(surface.face)
    raise at.error(f'"{".".join(surface)}": body "{surface.body}" {why}')


def _without_reserve(parts: Parts, data: dict[str, Any]) -> Parts:
    """The parts, with restitution 0 by default where contacts should not hold energy and give it back: dynamic
    relaxation looks for a state of rest, in which their points would stay in motion, and an integrator other than
    the leapfrog has no proof that bodies gain nothing by it."""
    if not parts.relaxed and (parts.time is None or parts.time.is_leapfrog):
        return parts

    def plain(name: str) -> Any:
        pairs = zip(getattr(parts, name), data.get(name, ()))
        return tuple(
            law
            if "restitution" in given or FEEDS[law.enforcement]
            else replace(law, restitution=0.0)
            for law, given in pairs
        )

    return replace(parts, contact=plain("contact"), obstacle=plain("obstacle"))


# Force tolerance of a scene that comes to rest: over thousands of steps in which points are about to slip, the
# errors of 1e-4 a step sum to a tenth of friction's traction at the edge of a contact.
RELAXED_TOLERANCE = 1e-6
# Fraction of the stable step at large strain: vibrations of four steps a period gain energy (eq:step-resonance).
LARGE_FRACTION = 0.7


def _usual_time(parts: Parts, data: dict[str, Any]) -> Parts:
    """The parts, by default with tighter forces where dynamic relaxation looks for a state of rest, and with a smaller
    step where an elastic body has a law for large strain."""
    usual = dict[str, float]()
    if parts.time is not None and parts.relaxed and "force_tolerance" not in data["time"]:
        usual["force_tolerance"] = RELAXED_TOLERANCE
    elastic = [body for body in parts.body if body.name not in parts.rigid_names]
    used = {name for body in elastic for name in body.material_names}
    is_large = any(material.law != "linear" for material in parts.material if material.name in used)
    if parts.time is not None and is_large and not data["time"].keys() & {*Time.rivals[0]}:
        usual["fraction"] = LARGE_FRACTION
    return replace(parts, time=replace(parts.time, **usual)) if usual else parts


def schema() -> dict[str, Any]:
    """
    The JSON Schema of a scene file, for editors and other programs.

    Returns
    -------
    dict
        The schema (draft 2020-12). It describes each key; combinations of keys are checked when the
        scene is read.
    """
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "title": "libcontact scene"}
    out = {**head, **Parts.schema()}
    out["required"] += ["body", "time"]
    out["properties"]["body"]["minItems"] = 1
    return out


# Tables that are valid alone but contradict each other.


def conflicts(parts: Parts) -> Iterator[tuple[str, str]]:
    """For each pair of tables that contradict each other the key of the later one, and the reason."""
    for i, body in enumerate(parts.body):
        first, *further = parts.materials_of(body)
        for other in further:
            if other.law != first.law:
                why = f'has the law "{other.law}", and "{first.name}" has "{first.law}"'
                yield f"body[{i}].material", f'"{other.name}" {why}; a body has one law'
        for name, reason in body.small_strain_only(first):
            yield f"body[{i}].{name}", reason
        for added in parts.effects:
            if acts_on(added.given, body.name):
                yield from _not_on(parts, body, added)
    yield from _same_pair(parts)
    yield from _rigid(parts)
    yield from _absorbing(parts)
    yield from _probing(parts)
    others = [body for body in parts.body if body.name not in parts.rigid_names]
    large = [body.name for body in others if parts.materials_of(body)[0].law != "linear"]
    if parts.output.filter and large:
        yield "output.filter", f'is for linear bodies; "{large[0]}" is not linear'


def _deforming(parts: Parts) -> Iterator[tuple[str, str]]:
    """Refuse what only a rigid body may have, unless a later table says that it is: mass without a mesh, an
    obstacle that it carries, and a rotation with small strain."""
    for i, each in enumerate(parts.obstacle):
        if each.carrier and each.carrier not in parts.rigid_names:
            why = f'"{each.carrier}" deforms; add [[rigid]] with body = "{each.carrier}"'
            yield f"obstacle[{i}].carrier", why
    for i, body in enumerate(parts.body):
        material = parts.materials_of(body)[0]
        if body.inertia and body.name not in parts.rigid_names:
            why = f'is that of a rigid body; add [[rigid]] with body = "{body.name}"'
            yield f"body[{i}].inertia", why
        if material.law != "linear" or body.name in parts.rigid_names:
            continue
        turns = {"spin": body.spin, "initial.angle": body.initial and body.initial.angle}
        other = f'material "{material.name}" has the law "linear"'
        for name in [name for name, turn in turns.items() if turn]:
            why = f"turns the body, {other}, with which a rotation causes false strain"
            yield f"body[{i}].{name}", f"{why}; give it the law {LARGE}, or make it [[rigid]]"


def acts_on(effect: Any, name: str) -> bool:
    """Whether an effect acts on a body, as a whole or on a surface of it."""
    if hasattr(effect, "bodies"):
        return effect.bodies is None or name in effect.bodies
    return bool(effect.surface[0] == name)


def _not_on(parts: Parts, body: Body, added: Added) -> Iterator[tuple[str, str]]:
    """Refuse viscosity for quadratic elements, viscosity and damping by stiffness for large strain, and a load
    along the thickness of a body with the plane kernel."""
    if added.name == "viscosity" and not FACTS[body.bricks or "hex8"].trilinear:
        yield (
            f"{added.key}.bodies",
            f'"{body.name}" is of {body.bricks}; bulk viscosity is for hex8',
        )
    law = parts.materials_of(body)[0].law
    small = f'is for the law "linear", and "{body.name}" has "{law}"; '
    if added.name == "damping" and added.given.stiffness and law != "linear":
        yield f"{added.key}.stiffness", small + 'give a rate, or name other bodies in "bodies"'
    if added.name == "viscosity" and law != "linear":
        why = 'use [damping], or name other bodies in "bodies"'
        yield f"{added.key}.bodies", f"bulk viscosity {small}{why}"
    if added.name == "viscosity" and len(body.material_names) > 1:
        why = "has several materials; bulk viscosity is for bodies of one"
        yield f"{added.key}.bodies", f'"{body.name}" {why}'
    held = {axis for each in parts.support if each.set.body == body.name for axis in each.fix}
    cells = body.box.cells if body.box and body.kernel == "plane" else ()
    thin = [k for k, n in enumerate(cells) if n == 1 and "xyz"[k] in held]
    vector = getattr(added.given, "acceleration", getattr(added.given, "traction", None))
    if vector is not None and thin and all(vector[k] != 0.0 for k in thin):
        why = 'the thickness of its plane strain (kernel = "plane"), where nothing may move'
        yield added.key, f'acts on "{body.name}" along {"xyz"[thin[0]]}, {why}'


def _rigid(parts: Parts) -> Iterator[tuple[str, str]]:
    """Refuse a body that is rigid twice, one that a support holds, and effects that need its strain."""
    names = [each.of for each in parts.rigid]
    for i, name in enumerate(names):
        if name in names[:i]:
            key = "body" if parts.rigid[i].body else "set"
            yield f"rigid[{i}].{key}", f'"{name}" is rigid already (rigid[{names.index(name)}])'
    names = [each.body for each in parts.rigid]
    for i, support in enumerate(parts.support):
        if support.set.body in names:
            at = f"rigid[{names.index(support.set.body)}].fixed"
            why = f'holds nodes of the rigid body "{support.set.body}"; give its fixed freedoms in {at}'
            yield f"support[{i}].set", why
    for i, body in enumerate(parts.body):
        if body.name in names and (body.kernel != "auto" or body.integration != "full"):
            which = "kernel" if body.kernel != "auto" else "integration"
            yield f"body[{i}].{which}", "is for bodies that deform; this one is rigid; leave it out"
    viscous = set(names) & set((parts.viscosity and parts.viscosity.bodies) or ())
    if viscous:
        why = "is rigid and has no strain rate; leave it out"
        yield "viscosity.bodies", f'"{min(viscous)}" {why}'


def _same_pair(parts: Parts) -> Iterator[tuple[str, str]]:
    """Refuse two contacts of one pair, whose force would act twice, and a tie of such a pair."""
    pairs = [frozenset(contact.surfaces) for contact in parts.contact]
    for i, pair in enumerate(pairs):
        if pair in pairs[:i]:
            why = (
                "its penalty would count twice (the order of the two surfaces makes no difference)"
            )
            yield f"contact[{i}].surfaces", f"is the pair of contact[{pairs.index(pair)}]; {why}"
    for i, tied in enumerate(parts.tie):
        pair = frozenset(tied.surfaces)
        if pair in pairs:
            why = "what is glued together needs no contact"
            yield f"tie[{i}].surfaces", f"is the pair of contact[{pairs.index(pair)}]; {why}"


def _absorbing(parts: Parts) -> Iterator[tuple[str, str]]:
    """Refuse a surface that absorbs twice, as twice the impedance reflects a third of each wave, and one
    that cannot move, as it absorbs no energy."""
    surfaces = [each.surface for each in parts.absorb]
    for i, surface in enumerate(surfaces):
        at, name = f"absorb[{i}].surface", f'"{".".join(surface)}"'
        if surface in surfaces[:i]:
            first = f"absorbs already (absorb[{surfaces.index(surface)}])"
            yield at, f"{name} {first}; with twice the impedance it would reflect again"
        held = {axis for support in parts.support if support.set == surface for axis in support.fix}
        if len(held) == 3:
            why = "is held along x, y and z by a [[support]]; what does not move absorbs nothing"
            yield at, f"{name} {why}"


def resultant_of(parts: Parts, probe: Probe) -> tuple[int, Any, tuple[str, ...]]:
    """Number, table and bodies of the contact, obstacle or support whose resultant a probe records."""
    table, number = probe.resultant
    given = getattr(parts, table)[number or 0]
    one: Any = given.set if table == "support" else getattr(given, "surface", None)
    surfaces = given.surfaces if table == "contact" else [one]
    return number or 0, given, tuple(str(body) for body, _ in surfaces)


def _probing(parts: Parts) -> Iterator[tuple[str, str]]:
    """Refuse a resultant that does not exist, is ambiguous, or acts on another body."""
    for i, probe in enumerate(parts.probe):
        if probe.resultant is None:
            continue
        (table, number), at = probe.resultant, f"probe[{i}].resultant"
        count = len(getattr(parts, table))
        if (number or 0) >= count:
            there = f"the scene has {count or 'no'} [[{table}]]"
            yield at, f"{there}{', counted from 0' if count else ''}"
            continue
        if number is None and count > 1:
            yield at, f'"{table}" is one of {count}; write "{table}[0]" ... "{table}[{count - 1}]"'
        _, given, bodies = resultant_of(parts, probe)
        if table == "contact" and given.with_itself:
            yield at, f'is a contact of "{bodies[0]}" with itself, whose forces have the sum 0'
        if probe.body is not None and probe.body not in bodies:
            known = suggestion(probe.body, bodies)
            yield f"probe[{i}].body", f'"{table}" does not act on "{probe.body}"{known}'
