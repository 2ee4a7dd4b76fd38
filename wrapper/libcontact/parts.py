"""The parts of a scene as checked values: units, materials, bodies, contacts, supports, other effects, time, output."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from . import conflicts, effects
from ._core import ffi, lib
from .errors import new_error
from .projection import METHODS
from .schema import SceneError, Table, describe, float_array, index_array, suggestion
from .surfaces import DEFAULT_BETA, INITIAL, RULES, read_enforcement, split_face
from .units import BASES, Units

ELEMENTS = ("hex8", "hex20")
LUMPINGS = ("row_sum", "hrz")
LAWS = ("linear", "st_venant_kirchhoff", "neo_hookean")
KERNELS = ("auto", "general", "box", "plane")
INTEGRATIONS = ("full", "reduced")
FIELDS = ("displacement", "velocity", "stress")
SAVINGS = ("quiet", "plane_strain", "congruent", "distant")
STABLE_STEPS = ("elements", "assembled")
INTEGRATORS = ("central_difference", "chung_lee", "noh_bathe", "tchamwa_wielgosz")


@dataclass(frozen=True)
class Material:
    name: str
    young: float
    poisson: float
    density: float
    law: str = "linear"


@dataclass(frozen=True)
class Box:
    """A box; ``layers`` is the axis that its layers of numbers follow one another along, None: whichever is best."""

    origin: tuple[float, float, float]
    size: tuple[float, float, float]
    cells: tuple[int, int, int]
    layers: str | None = None


@dataclass(frozen=True)
class Ring:
    """A ring about an axis along z; ``cells`` along the radius, around, across."""

    centre: tuple[float, float, float]
    radius: tuple[float, float]
    width: float
    cells: tuple[int, int, int]


@dataclass(frozen=True)
class Spin:
    """A rotation at the start: angle in time about an axis through ``centre`` (None: the middle of the body's bounds)."""

    axis: tuple[float, float, float]
    rate: float
    centre: tuple[float, float, float] | None


@dataclass(frozen=True, eq=False)
class Body:
    """A body; exactly one of ``box``, ``ring``, ``mesh`` (a file) and ``nodes`` with ``elements`` is given."""

    name: str
    material: str
    element: str | None
    velocity: tuple[float, float, float]
    lumping: str | None
    kernel: str
    box: Box | None
    mesh: str | None
    nodes: np.ndarray | None
    elements: np.ndarray | None
    ring: Ring | None = None
    spin: Spin | None = None
    integration: str = "full"
    hourglass: float | None = None


@dataclass(frozen=True)
class Contact:
    """
    A contact of two surfaces (body, face); exactly one of ``beta`` and ``epsilon`` is a number. Surfaces of one body are taken as one, which is in
    contact with itself: only so neighbouring faces and the far side of a thin body are told from contact.
    """

    surfaces: tuple[tuple[str, str], tuple[str, str]]
    beta: float | None
    epsilon: float | None
    penalty_given: bool
    method: str
    tolerance: float | None
    depth: float | None
    friction: float
    tangent: float
    enforcement: str
    dissipation: float
    points: str = "gauss"
    initial_penetration: str = "keep"
    removal_time: float = 0.0
    adjust: float = 0.0

    @property
    def with_itself(self) -> bool:
        return self.surfaces[0][0] == self.surfaces[1][0]


@dataclass(frozen=True)
class Support:
    """What is held: with the constant ``velocity``, or, where ``history`` has points, on the path ``travel`` times history."""

    body: str
    face: str
    fix: tuple[str, ...]
    velocity: tuple[float, float, float]
    travel: tuple[float, float, float] = (0.0, 0.0, 0.0)
    history: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())


@dataclass(frozen=True)
class Time:
    """
    End and step of the run: ``end``, or ``end_over`` = (length, value) for end = value length / c₁; ``step`` = ("courant", 0.125). With ``until_static`` the run
    ends as soon as it is that near to rest and all histories are over. The run fails when a share of ``energy_limit`` appears from nothing; it is looked at after every
    ``look_every`` steps.
    """

    end: float | None
    end_over: tuple[float, float] | None
    step: tuple[str, float]
    integrator: str
    parameter: float
    stable_step: str = STABLE_STEPS[0]
    until_static: float | None = None
    energy_limit: float = 1.0
    look_every: int = 1024


@dataclass(frozen=True)
class Output:
    file: str | None
    fields: tuple[str, ...]
    every: int | None
    times: tuple[float, ...] | None


@dataclass(frozen=True, eq=False)
class Parts:
    """A whole checked scene; ``time`` is None as long as a scene that is built in Python has none."""

    title: str
    units: Units
    materials: dict[str, Material]
    bodies: dict[str, Body]
    contacts: tuple[Contact, ...]
    supports: tuple[Support, ...]
    effects: tuple[effects.Added, ...]
    time: Time | None
    output: Output
    threads: int
    savings: tuple[str, ...]


def read(data: Any, file: str | None = None, whole: bool = True) -> Parts:
    """Check the tables of a scene. ``whole`` also asks for what a scene that is still being built may lack: bodies and time."""
    scene = Table(data, "", file)
    title = scene.text("title", "")
    units = _units(scene.table("units"))
    materials = _named(scene.tables("material"), _material)
    bodies = _named(scene.tables("body"), lambda table: _body(table, materials))
    contacts = tuple(_contact(table, bodies) for table in scene.tables("contact"))
    supports = tuple(_support(table, bodies) for table in scene.tables("support"))
    if scene.has("friction"):
        reason = "can't stand alone: there is no friction without a pressure; write friction = 0.3 in a [[contact]] or an [[obstacle]]"
        raise scene.error("friction", reason)
    added = effects.read(scene, effects.Known(materials, bodies, contacts))
    for i, body in enumerate(bodies.values()):
        if body.kernel == "plane":
            _no_load_out_of_plane(i, bodies, supports, added, file)
    table = scene.table("time", None) if not whole else scene.table("time")
    time = _time(table) if table is not None else None
    output = _output(scene.table("output", {}))
    run = scene.table("run", {})
    threads = run.integer("threads", 1, most=1024)
    savings = _savings(run)
    run.done()
    scene.done()
    if whole and not bodies:
        raise SceneError("there is no [[body]]; a scene needs at least one", "body", file)
    parts = Parts(
        title, units, materials, bodies, contacts, supports, added, time, output, threads, savings
    )
    conflicts.refuse(parts, file)
    return parts


def _named(tables: list[Table], reader: Any) -> dict[str, Any]:
    """Read an array of tables whose names must differ."""
    out: dict[str, Any] = {}
    for table in tables:
        part = reader(table)
        if part.name in out:
            raise table.error("name", f'"{part.name}" is used twice')
        out[part.name] = part
    return out


def _units(table: Table) -> Units:
    chosen = {base: table.choice(base, names) for base, names in BASES.items()}
    table.done()
    return Units(**chosen)


def _material(table: Table) -> Material:
    material = Material(
        name=table.name("name"),
        young=table.number("young", above=0.0),
        poisson=table.number("poisson", above=-1.0),
        density=table.number("density", above=0.0),
        law=table.choice("law", LAWS, "linear"),
    )
    if material.poisson >= 0.5:
        raise table.error(
            "poisson",
            f"is {material.poisson:g}; it must be below 0.5, where a material stops changing volume",
        )
    table.done()
    return material


def _body(table: Table, materials: dict[str, Material]) -> Body:
    name = table.name("name")
    material = table.text("material")
    if material not in materials:
        raise table.error(
            "material", f'no material is named "{material}"' + suggestion(material, materials)
        )
    element = table.choice("element", ELEMENTS, None)
    velocity = table.vector("velocity", (0.0, 0.0, 0.0))
    lumping = table.choice("lumping", LUMPINGS, None)
    kernel = table.choice("kernel", KERNELS, "auto")
    shape = table.one_of("box", "ring", "mesh", "nodes")
    box = _box(table.table("box")) if shape == "box" else None
    ring = _ring(table.table("ring")) if shape == "ring" else None
    spin = _spin(table.table("spin")) if table.has("spin") else None
    mesh = table.text("mesh") if shape == "mesh" else None
    nodes, elements = _arrays(table) if shape == "nodes" else (None, None)
    if table.has("elements") and shape != "nodes":
        raise table.error("elements", f'cannot stand beside "{shape}"; it belongs to "nodes"')
    if elements is not None:
        found = "hex8" if elements.shape[1] == 8 else "hex20"
        if element not in (None, found):
            raise table.error(
                "element",
                f'is "{element}", but "elements" has {elements.shape[1]} nodes a row ({found})',
            )
        element = found
    if shape in ("box", "ring") and element is None:
        element = "hex8"
    if element == "hex20" and lumping == "row_sum":
        raise table.error(
            "lumping", '"row_sum" gives the corners of hex20 a negative mass; use "hrz"'
        )
    if element == "hex20" and kernel == "plane":
        raise table.error(
            "kernel", '"plane" is for hex8; hex20 has the kernels "general" and "box"'
        )
    integration, hourglass = _integration(table, kernel, element)
    large = materials[material].law != "linear"
    if large and integration == "reduced":
        raise table.error(
            "integration",
            f'"reduced" is for small strain; material "{material}" has the law "{materials[material].law}"',
        )
    if large and kernel in ("box", "plane"):
        raise table.error(
            "kernel",
            f'"{kernel}" is for small strain; material "{material}" has the law "{materials[material].law}"',
        )
    if spin is not None and not large:
        raise table.error(
            "spin",
            f'turns the body, and the law "linear" of material "{material}" takes a rotation for a strain; '
            'give the material the law "st_venant_kirchhoff" or "neo_hookean"',
        )
    table.done()
    return Body(
        name,
        material,
        element,
        velocity,
        lumping,
        kernel,
        box,
        mesh,
        nodes,
        elements,
        ring,
        spin,
        integration,
        hourglass,
    )


def _integration(table: Table, kernel: str, element: str | None) -> tuple[str, float | None]:
    """The keys ``integration`` and ``hourglass``, the coefficient of the control that one point an element needs."""
    integration = table.choice("integration", INTEGRATIONS, "full")
    hourglass = table.number("hourglass", None, above=0.0)
    if integration == "reduced" and element == "hex20":
        raise table.error(
            "integration",
            '"reduced" with hourglass control is for hex8; hex20 is integrated in full',
        )
    if integration == "reduced" and kernel != "auto":
        raise table.error(
            "kernel",
            f'"{kernel}" integrates in full, and the body asks for integration = "reduced"',
        )
    if hourglass is not None and integration == "full":
        raise table.error(
            "hourglass",
            'needs integration = "reduced"; full integration has no hourglass motion to control',
        )
    return integration, hourglass


def _no_load_out_of_plane(
    body: int,
    bodies: dict[str, Body],
    supports: tuple[Support, ...],
    added: tuple[effects.Added, ...],
    file: str | None,
) -> None:
    """Refuse a load along the thickness of a body that asks for the kernel of plane strain."""
    name, given = list(bodies.items())[body]
    held = {axis for support in supports if support.body == name for axis in support.fix}
    thin = [
        k
        for k in range(3)
        if given.box is not None and given.box.cells[k] == 1 and "xyz"[k] in held
    ]
    for effect in added:
        own = effect.given
        named = (
            getattr(own, "bodies", ()) is None
            or name in (getattr(own, "bodies", None) or ())
            or name == getattr(own, "surface", ("",))[0]
        )
        vector = getattr(own, "acceleration", getattr(own, "traction", None))
        if named and vector is not None and thin and all(vector[k] != 0.0 for k in thin):
            raise SceneError(
                f'acts on "{name}" along {"xyz"[thin[0]]}, the thickness of its plane strain (kernel = "plane"), where nothing may move',
                effect.key,
                file,
            )


def _box(table: Table) -> Box:
    origin = table.vector("origin", (0.0, 0.0, 0.0))
    size = table.vector("size", above=0.0)
    cells = _cells(table, (1, 1, 1))
    layers = table.choice("layers", ("x", "y", "z"), None)
    table.done()
    return Box(origin, size, cells, layers)


def _cells(table: Table, least: tuple[int, int, int]) -> tuple[int, int, int]:
    return tuple(
        table.checked_integer(n, f"cells[{i}]", least[i], 2**31 - 1)
        for i, n in enumerate(table.items("cells", 3))
    )


def _ring(table: Table) -> Ring:
    centre = table.vector("centre", (0.0, 0.0, 0.0))
    inner, outer = (
        table.checked_number(r, f"radius[{i}]", above=0.0)
        for i, r in enumerate(table.items("radius", 2))
    )
    if not outer > inner:
        raise table.error(
            "radius[1]", f"is {outer:g}; the outer radius must be above the inner one, {inner:g}"
        )
    width = table.number("width", above=0.0)
    cells = _cells(table, (1, 3, 1))
    table.done()
    return Ring(centre, (inner, outer), width, cells)


def _spin(table: Table) -> Spin:
    axis = table.vector("axis", (0.0, 0.0, 1.0))
    if not any(axis):
        raise table.error("axis", "is 0; it must have a direction")
    rate = table.number("rate")
    centre = table.vector("centre", None)
    table.done()
    return Spin(axis, rate, centre)


def _arrays(table: Table) -> tuple[np.ndarray, np.ndarray]:
    try:
        nodes = float_array(table.get("nodes"), 3)
    except ValueError as error:
        raise table.error("nodes", str(error)) from None
    try:
        elements = index_array(table.get("elements"), (8, 20), len(nodes))
    except SceneError:
        raise
    except ValueError as error:
        raise table.error("elements", str(error)) from None
    return nodes, elements


def _contact(table: Table, bodies: dict[str, Body]) -> Contact:
    surfaces = tuple(
        split_face(table, f"surfaces[{i}]", value, bodies)
        for i, value in enumerate(table.items("surfaces", 2))
    )
    given = table.one_of("beta", "epsilon", required=False)
    contact = Contact(
        surfaces=surfaces,
        beta=table.number("beta", None if given else DEFAULT_BETA, above=0.0),
        epsilon=table.number("epsilon", None, above=0.0),
        penalty_given=given is not None,
        method=table.choice("method", METHODS, "robust"),
        tolerance=table.number("tolerance", None, above=0.0),
        depth=table.number("depth", None, above=0.0),
        friction=table.number("friction", 0.0, least=0.0),
        tangent=table.number("tangent", 0.0, above=0.0),
        **dict(zip(("enforcement", "dissipation"), read_enforcement(table))),
        points=table.choice("points", RULES, "gauss"),
        initial_penetration=table.choice("initial_penetration", INITIAL, "keep"),
        removal_time=table.number("removal_time", 0.0, above=0.0),
        adjust=table.number("adjust", 0.0, least=0.0),
    )
    if contact.tangent and not contact.friction:
        raise table.error("tangent", 'belongs to friction; give "friction" too')
    if (contact.initial_penetration == "remove") != (contact.removal_time > 0.0):
        raise table.error(
            "removal_time", 'and initial_penetration = "remove" belong together; give both or none'
        )
    table.done()
    return contact


def _support(table: Table, bodies: dict[str, Body]) -> Support:
    body, face = split_face(table, "set", table.text("set"), bodies)
    fix = table.items("fix")
    if not fix:
        raise table.error("fix", 'is empty; name at least one of "x", "y", "z"')
    for i, axis in enumerate(fix):
        if not isinstance(axis, str) or axis not in ("x", "y", "z"):
            raise table.error(f"fix[{i}]", f'is {describe(axis)}; it must be "x", "y" or "z"')
        if axis in fix[:i]:
            raise table.error(f"fix[{i}]", f'"{axis}" is named twice')
    velocity = table.vector("velocity", (0.0, 0.0, 0.0))
    for i, axis in enumerate("xyz"):
        if velocity[i] != 0.0 and axis not in fix:
            raise table.error(f"velocity[{i}]", f'is {velocity[i]:g}, but "{axis}" is not in fix')
    travel, history = _path(table, fix)
    table.done()
    return Support(body, face, tuple(fix), velocity, travel, history)


def _path(table: Table, fix: list[str]) -> tuple[Any, Any]:
    """The keys ``travel`` and ``history`` of a support: both or none."""
    there = [key for key in ("travel", "history") if table.has(key)]
    if not there:
        return (0.0, 0.0, 0.0), ((), ())
    if len(there) == 1:
        raise table.error(
            there[0], "stands alone; a path is the travel times a history, and both are needed"
        )
    if table.has("velocity"):
        raise table.error(
            "velocity", 'cannot stand beside "travel": a support keeps a velocity or follows a path'
        )
    travel = table.vector("travel")
    for i, axis in enumerate("xyz"):
        if travel[i] != 0.0 and axis not in fix:
            raise table.error(f"travel[{i}]", f'is {travel[i]:g}, but "{axis}" is not in fix')
    return travel, effects.load.read_history(table)


def _savings(table: Table) -> tuple[str, ...]:
    """What may be left out because it changes no result; all of it unless the scene lists some."""
    savings = table.items("savings", None, list(SAVINGS))
    for i, saving in enumerate(savings):
        if not isinstance(saving, str) or saving not in SAVINGS:
            raise table.error(
                f"savings[{i}]",
                f"{describe(saving)} is no saving" + suggestion(str(saving), SAVINGS),
            )
    return tuple(dict.fromkeys(savings))


def _time(table: Table) -> Time:
    which = table.one_of("end", "end_c1t_over")
    end = table.number("end", above=0.0) if which == "end" else None
    end_over = None
    if which == "end_c1t_over":
        over = table.table("end_c1t_over")
        end_over = (over.number("length", above=0.0), over.number("value", above=0.0))
        over.done()
    step = table.one_of("courant", "fraction", "dt")
    value = table.number(step, above=0.0)
    integrator = table.choice("integrator", INTEGRATORS, INTEGRATORS[0])
    parameter = _integrator_parameter(table, INTEGRATORS.index(integrator))
    stable_step = table.choice("stable_step", STABLE_STEPS, STABLE_STEPS[0])
    until_static = table.number("until_static", None, least=1e-12)
    energy_limit = table.number("energy_limit", Time.energy_limit, above=0.0)
    look_every = table.integer("look_every", Time.look_every, least=1, most=2**53)
    table.done()
    return Time(
        end,
        end_over,
        (step, value),
        integrator,
        parameter,
        stable_step,
        until_static,
        energy_limit,
        look_every,
    )


def _integrator_parameter(table: Table, scheme: int) -> float:
    """The one number of an integrator, checked by the library."""
    usual = lib.ct_integrator_default(scheme).parameter
    value = table.number("integrator_parameter", usual)
    error = new_error()
    if (
        lib.ct_integrator_check(
            ffi.new("ct_integrator *", {"scheme": scheme, "parameter": value}), error
        )
        != lib.CT_OK
    ):
        raise table.error("integrator_parameter", ffi.string(error.text).decode())
    return float(value)


def _output(table: Table) -> Output:
    file = table.text("file", None)
    if file == "" or (file is not None and "\0" in file):
        raise table.error("file", "is no file name")
    fields = table.items("fields", None, list(FIELDS))
    for i, field in enumerate(fields):
        if not isinstance(field, str) or field not in FIELDS:
            raise table.error(
                f"fields[{i}]", f"{describe(field)} is no field" + suggestion(str(field), FIELDS)
            )
    which = table.one_of("every", "times", required=False)
    every = table.integer("every", least=1, most=2**53) if which == "every" else None
    times = None
    if which == "times":
        times = tuple(
            table.checked_number(t, f"times[{i}]", least=0.0)
            for i, t in enumerate(table.items("times"))
        )
    table.done()
    return Output(file, tuple(dict.fromkeys(fields)), every, times)
