"""What a scene will compute, what it will not, and why, as text and as data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any

from ._core import ffi, lib
from .errors import SceneWarning
from .model import Body, Contact, ContactKeys, Support
from .parts import EFFECTS, Parts
from .plan import Cost, predict, table
from .problem import BuiltBody, BuiltContact, Problem, speeds
from .surfaces import pair_name
from .units import Units
from .warned import at_start, known

# Effects of the library, with what a scene that leaves them out goes without.
WITHOUT = {
    "solid": "internal forces of the bodies (every scene has them)",
    "contact": "no [[contact]]: bodies pass through each other",
    "friction": "no friction in a contact or an obstacle: surfaces slide freely",
    "support": "no [[support]]: nothing holds the bodies",
    **{name: effect.without for name, effect in EFFECTS.items()},
}
PENALTY = "contact by a penalty, so surfaces overlap by pressure / epsilon"
NAMED = "surfaces meet only where a [[contact]] names them; a body passes through itself unless one names two surfaces of it, or one twice"
RELAXED = "dynamic relaxation: the way to rest is not the true motion, only the end is"
DEAD = "loads keep the direction and size that they have on the undeformed surface"
RINGING = (
    "no damping and no artificial viscosity: the ringing behind a steep front is the mesh's own"
)
LAWS = {
    "linear": "small strains and rotations, linear isotropic elasticity",
    "st_venant_kirchhoff": "any rotation and moderate strain by St. Venant-Kirchhoff's law, which gives way under strong compression",
    "neo_hookean": "any rotation and large strain by the compressible neo-Hookean law",
}
STIFFENS = "the stable step is that of the undeformed bodies; a body that is strained much can need a smaller one"
KERNELS = {
    "reduced": 'integration = "reduced": one point, and hourglass control',
    "plane": "one layer of equal boxes held along its thickness: plane strain, in two dimensions",
    "box": "all elements are equal boxes along x, y, z: integrals in closed form",
}


class Explanation(str):
    """The text of ``Scene.explain``.

    Attributes
    ----------
    data
        The same facts as a dictionary.
    warnings
        The objects that a run of the scene issues at its start.
    """

    data: dict[str, Any]
    warnings: list[SceneWarning]


def explain(problem: Problem, every: int, records: int) -> Explanation:
    """Explain a built problem that is recorded at ``records`` steps (about every ``every`` steps)."""
    gaps, found = at_start(problem)
    parts, units, output = problem.parts, problem.parts.units, problem.parts.output
    warnings, plan = known(problem, output.file, found), predict(problem, records)
    bodies = [_body(problem, body) for body in problem.bodies.values()]
    contacts = [_contact(*row) for row in zip(problem.contacts, parts.contact, gaps, found)]
    for name, rows in (("body", bodies), ("contact", contacts)):
        for i, row in enumerate(rows):
            own = [warning for warning in warnings if warning.key == f"{name}[{i}]"]
            row["warnings"] = [str(warning) for warning in own]
    elements = [body["elements"] for body in bodies]
    labels = {name: units.label(name) for name in ("stress", "energy")}
    data = {
        "title": parts.title,
        "file": problem.file,
        "units": {**values_of(units), **labels},
        "bodies": bodies,
        "effects": list(dict.fromkeys(problem.effects)),
        "savings": list(parts.run.savings),
        "left_out": {name: why for name, why in WITHOUT.items() if name not in problem.effects},
        "assumptions": _assumptions(parts),
        "contacts": contacts,
        "supports": [_support(support) for support in parts.support],
        "added": [
            {"name": added.name, "key": added.key, "text": added.given.describe(units)}
            for added in parts.effects
        ],
        "time": _time(problem, plan.costs),
        "cost": {
            "memory_bytes": plan.memory,
            "flops_per_step": sum(body["flops_per_update"] * body["elements"] for body in bodies),
            "bytes_per_step": sum(body["bytes_per_update"] * body["elements"] for body in bodies),
            "updates": problem.step_count * sum(elements),
            "threads": problem.threads,
            "seconds": plan.seconds,
            "output_bytes": plan.output,
            "rehearsed": plan.rehearsed,
        },
        "warnings": [str(warning) for warning in warnings],
        "plan": list(plan.costs),
        "output": {
            "file": output.file,
            "fields": list(output.fields),
            "every": every,
            "records": records,
        },
    }
    text = Explanation("\n".join(_lines(data, units)))
    text.data, text.warnings = data, warnings
    return text


# The facts.


def values_of(table: Any) -> dict[str, Any]:
    """The values of a table's keys, lists in place of tuples."""
    values = ((field.name, getattr(table, field.name)) for field in fields(table))
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values}


def _assumptions(parts: Parts) -> list[str]:
    """What each body is taken to be, by its law, and what holds for all."""
    bodies: dict[str, list[str]] = {}
    for body in parts.bodies.values():
        bodies.setdefault(parts.materials[body.material].law, []).append(body.name)
    laws = [
        LAWS[law] + (f" ({', '.join(names)})" if len(bodies) > 1 else "")
        for law, names in bodies.items()
    ]
    given = {name: [each.given for each in parts.effects if each.name == name] for name in EFFECTS}
    pressed = [*parts.contact, *given["obstacle"]]
    holds = {
        STIFFENS: set(bodies) != {"linear"},
        PENALTY: any(each.enforcement != "lagrange" for each in pressed),
        NAMED: True,
        DEAD: any(not load.following for load in given["load"]),
        RELAXED: any(damping.rate is None for damping in given["damping"]),
        RINGING: not given["damping"] and not given["viscosity"],
    }
    return [*laws, *(sentence for sentence, true in holds.items() if true)]


def _body(problem: Problem, body: BuiltBody) -> dict[str, Any]:
    given: Body = problem.parts.bodies[body.name]
    c1, c2 = speeds(body.material)
    return {
        "name": body.name,
        "material": body.material.name,
        "law": body.material.law,
        "element": body.mesh.element,
        "nodes": len(body.mesh.nodes),
        "elements": len(body.mesh.elements),
        "kernel": body.kernel,
        "kernel_why": _why(given.kernel, body),
        "lumping": given.lumping or ("row_sum" if body.mesh.element == "hex8" else "hrz"),
        "layers": problem.layers(given) if given.box else None,
        "c1": c1,
        "c2": c2,
        "c1_si": c1 * problem.parts.units.factor("velocity"),
        "shortest_edge": body.mesh.shortest_edge,
        "flops_per_update": body.flops,
        "bytes_per_update": body.bytes,
    }


def _why(asked: str, body: BuiltBody) -> str:
    if asked != "auto" or body.kernel in KERNELS:
        return "asked for" if asked != "auto" else KERNELS[body.kernel]
    points = "3x3x3" if body.mesh.element == "hex20" else "2x2x2"
    large = body.material.law != "linear"
    why = "large strain" if large else "elements are not equal boxes along x, y, z"
    return f"{why}: {points} Gauss points"


def _contact(
    built: BuiltContact, given: Contact, gap: float | None, found: dict[str, Any]
) -> dict[str, Any]:
    return {
        **values_of(given),
        **values_of(built),
        "penalty_is_default": not given.penalty_given,
        "tangent": given.tangent or 1.0,
        "removal_time": given.removal_time or 0.0,
        "penetration": found,
        "initial_gap": gap,
    }


def _support(support: Support) -> dict[str, Any]:
    points = len(support.history.time) if support.history else 0
    return {**values_of(support), "set": ".".join(support.set), "history": points}


def _time(problem: Problem, plan: Sequence[Cost]) -> dict[str, Any]:
    given, stable = problem.parts.time, problem.stable
    integrator = ffi.addressof(problem.pointer, "integrator")
    return {
        "integrator": given.integrator,
        "integrator_parameter": given.parameter,
        "evaluations_per_step": lib.ct_integrator_stages(integrator, ffi.new("ct_stage[2]")),
        "integrator_limit": lib.ct_integrator_limit(integrator),
        "end": problem.end,
        "asked": dict([given.step]),
        "dt": problem.dt,
        "steps": problem.step_count,
        "stable": stable.dt,
        "stable_without_contact": stable.dt_without_contact,
        "dt_courant": stable.dt_courant,
        "courant": problem.dt / stable.dt_courant if stable.dt_courant > 0.0 else math.inf,
        "fraction": problem.dt / stable.dt,
        "limited_by": _limited_by(problem, plan),
    }


def _limited_by(problem: Problem, plan: Sequence[Cost]) -> str:
    """The effects that bound the stable step, :eq:`plan-share`, that with the largest share first; those with less than 1 % are left out."""
    rate, shares = 2.0 / problem.stable.dt, dict[str, float]()
    for cost in plan:
        shares[cost.name] = cost.omega_squared + rate * cost.rate
    large = [name for name in shares if shares[name] > 0.01 * sum(shares.values())]
    large.sort(key=lambda name: -shares[name])
    bodies = "elements" if problem.parts.time.stable_step == "elements" else "the assembled bodies"
    text = " and ".join(bodies if name == "solid" else name for name in large)
    return text + (" together" if len(large) > 1 else "") if text else "nothing"


# The text. Empty lines of a section are left out.


def _lines(data: dict[str, Any], units: Units) -> list[str]:
    labels = data["units"]
    base = f"units {units.length}, {units.mass}, {units.time}"
    computed = [line for contact in data["contacts"] for line in _contact_lines(contact, units)]
    computed += [_support_line(support, units) for support in data["supports"]]
    computed += [f"{added['name']}: {added['text']}" for added in data["added"]]
    savings = ", ".join(data["savings"]) or "none, by the scene's own wish"
    sections = {
        data["title"] or "(no title)": [
            f"scene {data['file']}" if data["file"] else "",
            f"{base}: stress in {labels['stress']}, energy in {labels['energy']}",
        ],
        "Bodies": [line for body in data["bodies"] for line in _body_lines(body, units)],
        "Effects that are computed: " + ", ".join(data["effects"]): computed,
        "What is not computed": [
            *(f"{name}: {why}" for name, why in data["left_out"].items()),
            f"what changes no result: {savings}",
            *(f"assumed: {assumption}" for assumption in data["assumptions"]),
        ],
        "Time": _time_lines(data["time"], units),
        "Output": [_output_line(data["output"])],
        "Cost": _cost_lines(data["cost"]) + _plan_lines(data),
        "Warnings": data["warnings"],
    }
    out: list[str] = []
    for title, lines in sections.items():
        if lines or title != "Warnings":
            out += ["", title, *(f"  {line}" for line in lines if line)]
    return out[1:]


def _body_lines(body: dict[str, Any], units: Units) -> list[str]:
    speed = units.label("velocity")
    layers = f", numbered layer by layer along {body['layers']}" if body["layers"] else ""
    return [
        f"{body['name']}: {body['elements']} {body['element']}, {body['nodes']} nodes, material {body['material']}, shortest edge {body['shortest_edge']:.6g} {units.length}",
        f"  waves: c1 = {body['c1']:.6g} {speed} ({body['c1_si']:.5g} m/s), c2 = {body['c2']:.6g} {speed}",
        f"  kernel {body['kernel']} ({body['kernel_why']}), mass lumped by {body['lumping']}{layers}",
    ]


def _contact_lines(contact: dict[str, Any], units: Units) -> list[str]:
    faces, other = contact["faces"], "the other surface"
    how = f"{faces[0]} and {faces[-1]} faces, each side slave and master once"
    if contact["with_itself"]:
        how = f"{faces[0]} faces of one body, each against all that share no node with it"
        other = "another part of the surface"
    origin = "given" if contact["beta"] is None else f"beta = {contact['beta']:g}"
    origin += ", the default" if contact["penalty_is_default"] else ""
    gap, nearest = contact["initial_gap"], f"no point is near {other}"
    if gap is not None:
        nearest = f"the smallest gap is {gap:.4g} {units.length}"
    return [
        f"contact {pair_name(contact['surfaces'])}: {how}, {sum(contact['gauss_points'])} points",
        f"  penalty epsilon = {contact['epsilon']:.6g} {units.label('penalty')} ({origin})",
        f"  {', '.join(_choices(contact))}",
        f"  at the start {nearest}",
    ]


def _choices(contact: dict[str, Any]) -> Iterator[str]:
    """The other keys of a contact that have a meaning in it, with their values."""
    for name in ContactKeys.keys():
        other, wanted = Contact.belongs.get(name, (name, contact[name]))
        if name not in ("beta", "epsilon") and contact[other] == wanted:
            value = contact[name]
            if value is not None:
                text = f"{value:g}" if isinstance(value, float) else value
                yield f"{name.replace('_', ' ')} {text}"


def _support_line(support: dict[str, Any], units: Units) -> str:
    moving = ""
    if any(support["velocity"]):
        moving = f" at the velocity {support['velocity']} {units.label('velocity')}"
    if support["history"]:
        moving = f" on a path, {support['travel']} {units.length} times a history of {support['history']} points"
    return f"support {support['set']}: {', '.join(support['fix'])} held{moving}"


def _time_lines(time: dict[str, Any], units: Units) -> list[str]:
    ((asked, value),), t, name = time["asked"].items(), units.time, time["integrator"]
    if name != "central_difference":
        name = f"{name} ({time['integrator_parameter']:.6g})"
    return [
        f"{name} to t = {time['end']:.6g} {t} in {time['steps']} steps of {time['dt']:.6g} {t} (asked: {asked} = {value:g})",
        f"limit of the integrator: omega dt = {time['integrator_limit']:.5g}, {time['evaluations_per_step']} evaluation(s) of the forces a step",
        f"stable step {time['stable']:.6g} {t} with contact, {time['stable_without_contact']:.6g} {t} without; limited by {time['limited_by']}",
        f"Courant number c1 dt / h = {time['courant']:.4g}, fraction of the stable step = {time['fraction']:.4g}",
    ]


def _output_line(output: dict[str, Any]) -> str:
    file = f"to {output['file']}" if output["file"] else "in memory only (no file named)"
    fields = ", ".join(output["fields"]) if output["fields"] and output["file"] else "the ledger"
    return f"{output['records']} records of {fields} {file}"


def _cost_lines(cost: dict[str, Any]) -> list[str]:
    return [
        f"{cost['updates']:.4g} element updates; about {cost['flops_per_step']:.3g} flops and {cost['bytes_per_step']:.3g} bytes a step in the elements",
        f"memory about {cost['memory_bytes'] / 1e6:.3g} MB, threads {cost['threads']}",
    ]


def _plan_lines(data: dict[str, Any]) -> list[str]:
    if any(cost.predicted is None for cost in data["plan"]):
        return ["no prediction: a trial of a few steps failed"]
    how = "no rehearsal is possible: predicted as if all surfaces touched from the start"
    if data["cost"]["rehearsed"]:
        how = "predicted from a rehearsal and a trial on this machine"
    rows = table(data["plan"], data["time"]["stable"]).splitlines()
    return [f"{how}; flops and bytes with all at work:", *rows]
