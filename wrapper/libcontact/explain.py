"""What a scene will compute, what it will not, and why, as text and as data."""

from __future__ import annotations

import math
from typing import Any

from . import effects
from ._core import ffi, lib
from .errors import SceneWarning
from .parts import Contact, Parts
from .plan import Cost, predict, table
from .problem import BuiltBody, BuiltContact, Problem, memory_of, speeds
from .surfaces import DEFAULT_BETA, pair_name
from .units import Units
from .warned import at_start, known

# Effects of the library, with what a scene that leaves them out goes without.
EFFECTS = {
    "solid": "internal forces of the bodies (every scene has them)",
    "contact": "no [[contact]]: bodies pass through each other",
    "friction": "no friction in a contact or an obstacle: surfaces slide freely",
    "support": "no [[support]]: nothing holds the bodies",
    **{effects.name_of(module): module.WITHOUT for module in effects.MODULES},
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


class Explanation(str):
    """The text of ``Scene.explain``, with the same facts as a dictionary in ``data``; ``warnings`` are the objects that a run of the scene issues at its start."""

    data: dict[str, Any]
    warnings: list[SceneWarning]


def explain(problem: Problem, every: int, records: int) -> Explanation:
    """Explain a built problem that is recorded at ``records`` steps (about every ``every`` steps)."""
    gaps, found = at_start(problem)
    warnings = known(problem, problem.parts.output.file, found)
    data = _facts(problem, gaps, found, warnings)
    plan = predict(problem, records)
    data["plan"] = list(plan.costs)
    data["cost"] |= {
        "seconds": plan.seconds,
        "output_bytes": plan.output,
        "rehearsed": plan.rehearsed,
    }
    data["time"]["limited_by"] = _limited_by(problem, data["plan"])
    data["output"] = {
        "file": problem.parts.output.file,
        "fields": list(problem.parts.output.fields),
        "every": every,
        "records": records,
    }
    text = Explanation("\n".join(_lines(data, problem.parts.units)))
    text.data, text.warnings = data, warnings
    return text


def _facts(
    problem: Problem,
    gaps: list[float | None],
    found: list[dict[str, Any]],
    warnings: list[SceneWarning],
) -> dict[str, Any]:
    parts = problem.parts
    used = list(dict.fromkeys(problem.effects))
    bodies = [_body(problem, body) for body in problem.bodies.values()]
    contacts = [_contact(*row) for row in zip(problem.contacts, parts.contacts, gaps, found)]
    for name, rows in (("body", bodies), ("contact", contacts)):
        for i, row in enumerate(rows):
            row["warnings"] = [
                str(warning) for warning in warnings if warning.key == f"{name}[{i}]"
            ]
    return {
        "title": parts.title,
        "file": problem.file,
        "units": {
            "length": parts.units.length,
            "mass": parts.units.mass,
            "time": parts.units.time,
            "stress": parts.units.label("stress"),
            "energy": parts.units.label("energy"),
        },
        "bodies": bodies,
        "effects": used,
        "savings": list(parts.savings),
        "left_out": {name: why for name, why in EFFECTS.items() if name not in used},
        "assumptions": _assumptions(parts),
        "contacts": contacts,
        "supports": [
            {
                "set": f"{s.body}.{s.face}",
                "fix": list(s.fix),
                "velocity": list(s.velocity),
                "travel": list(s.travel),
                "history": len(s.history[0]),
            }
            for s in parts.supports
        ],
        "added": [
            {
                "name": added.name,
                "key": added.key,
                "text": added.module.describe(added.given, parts.units),
            }
            for added in parts.effects
        ],
        "time": _time(problem),
        "cost": {
            "memory_bytes": memory_of(problem),
            "flops_per_step": sum(b["elements"] * b["flops_per_update"] for b in bodies),
            "bytes_per_step": sum(b["elements"] * b["bytes_per_update"] for b in bodies),
            "updates": problem.step_count * sum(b["elements"] for b in bodies),
            "threads": problem.threads,
        },
        "warnings": [str(warning) for warning in warnings],
    }


def _assumptions(parts: Parts) -> list[str]:
    """What each body is taken to be, by its law, and what holds for all."""
    bodies: dict[str, list[str]] = {}
    for body in parts.bodies.values():
        bodies.setdefault(parts.materials[body.material].law, []).append(body.name)
    laws = [
        LAWS[law] + (f" ({', '.join(names)})" if len(bodies) > 1 else "")
        for law, names in bodies.items()
    ]
    added = {effect.name for effect in parts.effects}
    pressed = [
        *parts.contacts,
        *(effect.given for effect in parts.effects if effect.name == "obstacle"),
    ]
    holds = (
        (set(bodies) != {"linear"}, STIFFENS),
        (any(given.enforcement != "lagrange" for given in pressed), PENALTY),
        (True, NAMED),
        (
            any(effect.name == "load" and not effect.given.following for effect in parts.effects),
            DEAD,
        ),
        (
            any(effect.name == "damping" and effect.given.rate is None for effect in parts.effects),
            RELAXED,
        ),
        (not {"damping", "viscosity"} & added, RINGING),
    )
    return [*laws, *(sentence for true, sentence in holds if true)]


def _body(problem: Problem, body: BuiltBody) -> dict[str, Any]:
    given = problem.parts.bodies[body.name]
    c1, c2 = speeds(body.material)
    si = c1 * problem.parts.units.factor("velocity")
    lumping = given.lumping or ("row_sum" if body.mesh.element == "hex8" else "hrz")
    return {
        "name": body.name,
        "material": body.material.name,
        "law": body.material.law,
        "element": body.mesh.element,
        "nodes": len(body.mesh.nodes),
        "elements": len(body.mesh.elements),
        "kernel": body.kernel,
        "kernel_why": _why(given.kernel, body),
        "lumping": lumping,
        "layers": problem.layers(given) if given.box else None,
        "c1": c1,
        "c2": c2,
        "c1_si": si,
        "shortest_edge": body.mesh.shortest_edge,
        "flops_per_update": body.flops,
        "bytes_per_update": body.bytes,
    }


def _why(asked: str, body: BuiltBody) -> str:
    if asked != "auto":
        return "asked for"
    if body.kernel == "reduced":
        return 'integration = "reduced": one point, and hourglass control'
    if body.kernel == "plane":
        return "one layer of equal boxes held along its thickness: plane strain, in two dimensions"
    if body.kernel == "box":
        return "all elements are equal boxes along x, y, z: integrals in closed form"
    points = "3x3x3" if body.mesh.element == "hex20" else "2x2x2"
    if body.material.law != "linear":
        return f"large strain: {points} Gauss points"
    return f"elements are not equal boxes along x, y, z: {points} Gauss points"


def _contact(
    built: BuiltContact, given: Contact, gap: float | None, found: dict[str, Any]
) -> dict[str, Any]:
    return {
        "surfaces": list(built.surfaces),
        "with_itself": built.with_itself,
        "faces": list(built.faces),
        "gauss_points": list(built.points),
        "epsilon": built.epsilon,
        "beta": given.beta,
        "penalty_is_default": not given.penalty_given,
        "enforcement": given.enforcement,
        "dissipation": given.dissipation,
        "friction": given.friction,
        "tangent": given.tangent or 1.0,
        "method": given.method,
        "tolerance": given.tolerance,
        "depth": given.depth,
        "points": given.points,
        "adjust": given.adjust,
        "initial_penetration": given.initial_penetration,
        "removal_time": given.removal_time,
        "penetration": found,
        "initial_gap": gap,
    }


def _integrator(problem: Problem) -> Any:
    """The integrator of the problem, for the library's calls."""
    return ffi.addressof(problem.pointer, "integrator")


def _time(problem: Problem) -> dict[str, Any]:
    stable, (asked, value) = problem.stable, problem.parts.time.step
    return {
        "integrator": problem.parts.time.integrator,
        "integrator_parameter": problem.parts.time.parameter,
        "evaluations_per_step": lib.ct_integrator_stages(
            _integrator(problem), ffi.new("ct_stage[2]")
        ),
        "integrator_limit": lib.ct_integrator_limit(_integrator(problem)),
        "end": problem.end,
        "asked": {asked: value},
        "dt": problem.dt,
        "steps": problem.step_count,
        "stable": stable.dt,
        "stable_without_contact": stable.dt_without_contact,
        "dt_courant": stable.dt_courant,
        "courant": problem.dt / stable.dt_courant if stable.dt_courant > 0.0 else math.inf,
        "fraction": problem.dt / stable.dt,
    }


def _limited_by(problem: Problem, plan: list[Cost]) -> str:
    """The effects that bound the stable step, :eq:`plan-share`, that with the largest share first; those with less than 1 % are left out."""
    bodies = "elements" if problem.parts.time.stable_step == "elements" else "the assembled bodies"
    share = {
        bodies if cost.name == "solid" else cost.name: cost.omega_squared
        + 2.0 * cost.rate / problem.stable.dt
        for cost in plan
    }
    large = [
        name
        for name in sorted(share, key=share.get, reverse=True)
        if share[name] > 0.01 * sum(share.values())
    ]
    return " and ".join(large) + (" together" if len(large) > 1 else "") if large else "nothing"


def _lines(data: dict[str, Any], units: Units) -> list[str]:
    out = [data["title"] or "(no title)"]
    if data["file"]:
        out.append(f"  scene {data['file']}")
    out.append(
        f"  units {units.length}, {units.mass}, {units.time}: stress in {units.label('stress')}, energy in {units.label('energy')}"
    )
    out += ["", "Bodies"]
    for body in data["bodies"]:
        out += _body_lines(body, units)
    out += ["", "Effects that are computed: " + ", ".join(data["effects"])]
    for contact in data["contacts"]:
        out += _contact_lines(contact, units)
    for support in data["supports"]:
        moving = (
            f" at the velocity {support['velocity']} {units.label('velocity')}"
            if any(support["velocity"])
            else ""
        )
        if support["history"]:
            moving = f" on a path, {support['travel']} {units.length} times a history of {support['history']} points"
        out.append(f"  support {support['set']}: {', '.join(support['fix'])} held{moving}")
    out += [f"  {added['name']}: {added['text']}" for added in data["added"]]
    out += ["", "What is not computed"]
    out += [f"  {name}: {why}" for name, why in data["left_out"].items()]
    out += [
        "  what changes no result: "
        + (", ".join(data["savings"]) or "none, by the scene's own wish")
    ]
    out += [f"  assumed: {assumption}" for assumption in data["assumptions"]]
    out += ["", "Time"] + _time_lines(data["time"], units)
    out += ["", "Output"] + _output_lines(data["output"])
    out += ["", "Cost"] + _cost_lines(data["cost"])
    out += _plan_lines(data["plan"], data["time"]["stable"], data["cost"]["rehearsed"])
    if data["warnings"]:
        out += ["", "Warnings"] + [f"  {warning}" for warning in data["warnings"]]
    return out


def _body_lines(body: dict[str, Any], units: Units) -> list[str]:
    speed = units.label("velocity")
    return [
        f"  {body['name']}: {body['elements']} {body['element']}, {body['nodes']} nodes, material {body['material']}, "
        + f"shortest edge {body['shortest_edge']:.6g} {units.length}",
        f"    waves: c1 = {body['c1']:.6g} {speed} ({body['c1_si']:.5g} m/s), c2 = {body['c2']:.6g} {speed}",
        f"    kernel {body['kernel']} ({body['kernel_why']}), mass lumped by {body['lumping']}"
        + (f", numbered layer by layer along {body['layers']}" if body["layers"] else ""),
    ]


def _contact_lines(contact: dict[str, Any], units: Units) -> list[str]:
    if contact["with_itself"]:
        how = (
            f"{contact['faces'][0]} faces of one body, each against all that share no node with it"
        )
        nobody = "no point is near another part of the surface"
    else:
        how = f"{contact['faces'][0]} and {contact['faces'][1]} faces, each side slave and master once"
        nobody = "no point is near the other surface"
    if contact["penalty_is_default"]:
        origin = f"beta = {DEFAULT_BETA:g}, the default"
    else:
        origin = f"beta = {contact['beta']:g}" if contact["beta"] is not None else "given"
    return [
        f"  contact {pair_name(contact['surfaces'])}: {how}, {sum(contact['gauss_points'])} {'Gauss' if contact['points'] == 'gauss' else 'Lobatto'} points",
        f"    penalty epsilon = {contact['epsilon']:.6g} {units.label('penalty')} ({origin}), closest points by {contact['method']}",
        f"    enforced by {contact['enforcement']}"
        + (
            f", dissipation {contact['dissipation']:g}"
            if contact["enforcement"] == "energy_controlled"
            else ""
        ),
        *(
            [
                f"    friction {contact['friction']:g}, tangential penalty {contact['tangent']:g} epsilon"
            ]
            if contact["friction"]
            else []
        ),
        "    at the start "
        + (
            nobody
            if contact["initial_gap"] is None
            else f"the smallest gap is {contact['initial_gap']:.4g} {units.length}"
        ),
        *(
            [
                f"    gaps and overlaps at the start up to {contact['adjust']:g} {units.length} are taken as touching"
            ]
            if contact["adjust"]
            else []
        ),
    ]


def _integrator_line(time: dict[str, Any]) -> str:
    name = time["integrator"]
    return name if name == "central_difference" else f"{name} ({time['integrator_parameter']:.6g})"


def _time_lines(time: dict[str, Any], units: Units) -> list[str]:
    ((asked, value),) = time["asked"].items()
    t = units.time
    return [
        f"  {_integrator_line(time)} to t = {time['end']:.6g} {t} in {time['steps']} steps of {time['dt']:.6g} {t} "
        + f"(asked: {asked} = {value:g})",
        f"  limit of the integrator: omega dt = {time['integrator_limit']:.5g}, {time['evaluations_per_step']} evaluation(s) of the forces a step",
        f"  stable step {time['stable']:.6g} {t} with contact, {time['stable_without_contact']:.6g} {t} without; "
        + f"limited by {time['limited_by']}",
        f"  Courant number c1 dt / h = {time['courant']:.4g}, fraction of the stable step = {time['fraction']:.4g}",
    ]


def _output_lines(output: dict[str, Any]) -> list[str]:
    file = f"to {output['file']}" if output["file"] else "in memory only (no file named)"
    fields = ", ".join(output["fields"]) if output["fields"] and output["file"] else "the ledger"
    return [f"  {output['records']} records of {fields} {file}"]


def _cost_lines(cost: dict[str, Any]) -> list[str]:
    return [
        f"  {cost['updates']:.4g} element updates; about {cost['flops_per_step']:.3g} flops and {cost['bytes_per_step']:.3g} bytes a step "
        + "in the elements",
        f"  memory about {cost['memory_bytes'] / 1e6:.3g} MB, threads {cost['threads']}",
    ]


def _plan_lines(plan: list[Cost], stable: float, rehearsed: bool) -> list[str]:
    if any(cost.predicted is None for cost in plan):
        return ["  no prediction: a trial of a few steps failed"]
    how = (
        "predicted from a rehearsal and a trial on this machine"
        if rehearsed
        else "no rehearsal is possible: predicted as if all surfaces touched from the start"
    )
    return [
        f"  {how}; flops and bytes with all at work:",
        *(f"  {line}" for line in table(plan, stable).splitlines()),
    ]
