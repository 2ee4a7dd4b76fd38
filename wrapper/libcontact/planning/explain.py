"""Description of what a scene computes, what it omits, and why, as text and as data."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from .._core import ffi, lib
from ..checks.warned import at_start, known
from ..errors import SceneWarning
from ..html import sections
from ..mesh import FACTS
from ..model import AXES, FEEDS, INTEGRATORS, Contact, ContactKeys, Support, speeds
from ..parts import EFFECTS, Parts
from ..pieces import piece_lines
from ..probes import Located
from ..problem import BuiltBody, BuiltContact, Problem, tied_points
from ..schema import FACES, Face, Place, walk
from ..surfaces import contact_tables, pair_name
from ..units import Units
from .inertia import inertia_ratios
from .plan import Cost, Prediction, predict, table

# Effects of the library, and what is missing in a scene without them.
WITHOUT = {
    "solid": "internal forces of the bodies (every scene has them)",
    "contact": "no [[contact]]: bodies pass through each other",
    "friction": "no friction in a contact or an obstacle: surfaces slide freely",
    "support": "no [[support]]: all bodies are free",
    **{name: effect.without for name, effect in EFFECTS.items()},
}
PENALTY = "contact by a penalty, so surfaces overlap by pressure / epsilon"
BOUNCES = "impacts lose almost nothing (restitution 1), and nothing damps the bodies: what bounces or vibrates does not come to rest; for rest give [damping] or a restitution below 1"
STOPS = "a restitution below 1: an impact loses energy of the nodes that hit, less on a finer mesh"
DIVIDES = "a step that is too large, because a body stiffens or surfaces could pass through each other, is divided by 2, 4, 8, ..."
NAMED = "only surfaces named in a [[contact]] are in contact; a body passes through itself unless a contact names two of its surfaces, or one twice"
RELAXED = "dynamic relaxation: only the state of rest has a meaning, not the motion"
DEAD = "loads keep the direction and size that they have on the undeformed surface"
RINGING = "no damping, no artificial viscosity: the mesh causes oscillations behind a steep front"
LAWS = {
    "linear": "small strains and rotations, linear isotropic elasticity",
    "st_venant_kirchhoff": "any rotation and moderate strain by St. Venant-Kirchhoff's law, which is unstable under strong compression",
    "neo_hookean": "any rotation and large strain by the compressible neo-Hookean law",
}
STIFFENS = (
    "the stable step is that of the undeformed bodies; large strain can require a smaller one"
)
KERNELS = {
    "rigid": "a rigid body has no strain",
    "reduced": 'integration = "reduced": one point, and hourglass control',
    "plane": "one layer of equal boxes, fixed along its thickness: plane strain, in two dimensions",
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

    def _repr_html_(self) -> str:
        """The text in a notebook, in sections."""
        return sections(self)


def explain(problem: Problem, every: int, records: int, pieces: Any = None) -> Explanation:
    """Explain a built problem that is recorded at ``records`` steps (about every ``every`` steps); ``pieces`` are
    the counts of processes, or None."""
    gaps, found = at_start(problem)
    parts, units, output = problem.parts, problem.parts.units, problem.parts.output
    warnings, plan = known(problem, output.file, found), predict(problem, records)
    bodies = [_body(problem, body) for body in problem.bodies.values()]
    contacts = [_contact(*row) for row in zip(problem.contacts, parts.contact, gaps, found)]
    for name, rows in (("body", bodies), ("contact", contacts)):
        for i, row in enumerate(rows):
            own = [warning for warning in warnings if warning.key == f"{name}[{i}]"]
            row["warnings"] = [str(warning) for warning in own]
    labels = {name: units.label(name) for name in ("stress", "energy")}
    data = {
        "title": parts.title,
        "file": problem.file,
        "units": {**values_of(units), **labels},
        "bodies": bodies,
        "sets": _sets(problem),
        "effects": list(dict.fromkeys(problem.effects)),
        "savings": list(parts.run.savings),
        "left_out": {name: why for name, why in WITHOUT.items() if name not in problem.effects},
        "assumptions": _assumptions(parts),
        "contacts": contacts,
        "supports": [_support(support) for support in parts.support],
        "added": _added(problem, found),
        "probes": [_probe(each) for each in problem.probes],
        "time": _time(problem, plan.costs),
        "cost": _cost(problem, bodies, plan),
        "warnings": [str(warning) for warning in warnings],
        "plan": list(plan.costs),
        "output": {
            **values_of(output),
            "fields": list(parts.fields),
            "every": every,
            "records": records,
        },
    }
    lines = [_text(data, units)]
    if pieces is not None:
        data["pieces"] = [dict(zip(pieces.dtype.names, row.tolist())) for row in pieces]
        lines += ["", "Pieces, one per process", *piece_lines(pieces)]
    text = Explanation("\n".join(lines))
    text.data, text.warnings = data, warnings
    return text


# The facts.


def _added(problem: Problem, found: Sequence[dict[str, Any]]) -> list[dict[str, Any]]:
    """The effects that the scene adds; those of contact with the points that are inside at the start."""
    parts = problem.parts
    depths = {key: points for (key, _, _), points in zip(contact_tables(parts), found)}
    tied = {
        key: "; {} of {} points are tied".format(*of) for key, of in tied_points(problem).items()
    }
    return [
        {
            "name": each.name,
            "key": each.key,
            "text": each.given.describe(parts.units) + tied.get(each.key, ""),
        }
        | ({"penetration": depths[each.key]} if each.key in depths else {})
        for each in parts.effects
    ]


def _cost(problem: Problem, bodies: Sequence[dict[str, Any]], plan: Prediction) -> dict[str, Any]:
    """What the run costs: updates, operations, memory, time."""
    counts = [body["elements"] for body in bodies]
    cost = {"updates": problem.step_count * sum(counts), "threads": problem.threads}
    for name in ("flops", "bytes"):
        each = [body[f"{name}_per_update"] for body in bodies]
        cost[f"{name}_per_step"] = sum(n * price for n, price in zip(counts, each))
    cost |= {"memory_bytes": plan.memory, "output_bytes": plan.output}
    return cost | {"seconds": plan.seconds, "rehearsed": plan.rehearsed}


def values_of(table: Any) -> dict[str, Any]:
    """The values of a table's keys, lists in place of tuples."""
    values = ((field.name, getattr(table, field.name)) for field in fields(table))
    return {name: list(value) if isinstance(value, tuple) else value for name, value in values}


def _assumptions(parts: Parts) -> list[str]:
    """Assumptions about each body, by its law, and about all bodies."""
    bodies: dict[str, list[str]] = {}
    for body in parts.bodies.values():
        if body.name in parts.rigid_names:
            continue
        bodies.setdefault(parts.materials_of(body)[0].law, []).append(body.name)
    laws = [LAWS[law] for law in bodies]
    if len(bodies) > 1:
        laws = [f"{LAWS[law]} ({', '.join(names)})" for law, names in bodies.items()]
    laws_of_contact = [*parts.contact, *parts.obstacle]
    shares = [law.restitution for law in laws_of_contact if not FEEDS[law.enforcement]]
    holds = {
        STIFFENS: not set(bodies) <= {"linear"},
        PENALTY: bool(laws_of_contact),
        BOUNCES: 1.0 in shares and parts.damping is None and parts.viscosity is None,
        STOPS: any(share < 1.0 for share in shares) and not parts.relaxed,
        DIVIDES: not set(bodies) <= {"linear"} or bool(laws_of_contact),
        NAMED: True,
        DEAD: any(not load.following for load in parts.load),
        RELAXED: parts.relaxed,
        RINGING: bool(bodies) and parts.damping is None and parts.viscosity is None,
    }
    return [*laws, *(sentence for sentence, true in holds.items() if true), *_unbent(parts)]


def _unbent(parts: Parts) -> Iterator[str]:
    """Thin boxes of hex8 that are too stiff in bending, as false shear adds 1 + (l / t)² / 2, chapter "Elements"."""
    for name, body in parts.bodies.items():
        if not body.box or body.element == "hex20" or body.integration == "reduced":
            continue
        t, thin = min(zip(body.box.size, AXES))
        sides = {(name, f"{thin}_min"), (name, f"{thin}_max")}
        held = any(each.set in sides and thin in each.fix for each in parts.support)
        along = zip(body.box.size, body.box.cells)
        long = max((size / n for size, n in along if size >= 4.0 * t), default=0.0)
        if long >= t / 2.0 and not held and name not in parts.rigid_names:
            stiff = f"elements of hex8 that are {long:.3g} {parts.units.length} long in a thickness of {t:.3g} {parts.units.length} are {1.0 + (long / t) ** 2 / 2.0:.3g} times as stiff"
            yield f'"{name}" does not bend: {stiff}, however many lie across it; for bending take element = "hex20", or elements shorter than a third of the thickness'


def _body(problem: Problem, body: BuiltBody) -> dict[str, Any]:
    given, mesh, material = problem.parts.bodies[body.name], body.mesh, body.material
    c1, c2 = speeds(material)
    named = ", ".join(each.name for each in body.materials)
    facts: dict[str, Any] = {"name": body.name, "material": named, "law": material.law}
    facts |= {"elements_of": {each.name: len(own) for each, own in body.by_material}}
    facts |= {"element": mesh.element, "nodes": len(mesh.nodes), "elements": len(mesh.elements)}
    facts |= {"kernel": body.kernel, "kernel_why": _why(given.kernel, body)}
    facts |= {"lumping": given.lumping or ("row_sum" if FACTS[mesh.element].row_sum else "hrz")}
    facts |= {"layers": problem.layers(given) if given.box else None}
    facts |= {"place": [each.tolist() for each in mesh.bounds] if given.place else None}
    facts |= {"c1": c1, "c2": c2, "c1_si": c1 * problem.parts.units.factor("velocity")}
    facts |= {"shortest_edge": mesh.shortest_edge}
    masses = np.frombuffer(ffi.buffer(problem.pointer.mass, 8 * problem.pointer.node_count))
    facts |= {"inertia": 3 * [1.0] if given.inertia else inertia_ratios(mesh, masses[body.nodes])}
    return facts | {"flops_per_update": body.flops, "bytes_per_update": body.bytes}


def _sets(problem: Problem) -> list[dict[str, Any]]:
    """The sets that the scene uses, with their counts and the keys that name them."""
    found: dict[tuple[str, str], list[str]] = {}
    for at, face in walk(problem.parts, Place()):
        if isinstance(face, Face) and face.face not in FACES:
            found.setdefault((str(face.body), face.face), []).append(at.key)
    return [_set(problem, name, keys) for name, keys in found.items()]


def _set(problem: Problem, surface: tuple[str, str], keys: list[str]) -> dict[str, Any]:
    body, name = surface
    mesh = problem.bodies[body].mesh
    kinds, nodes = mesh.sets.kinds(name), len(mesh.face_nodes(name))
    counts = {kind: len(getattr(mesh.sets, kind)[name]) for kind in kinds}
    return {"name": f"{body}.{name}", "counts": counts | {"nodes": nodes}, "keys": keys}


def _set_line(found: dict[str, Any]) -> str:
    counts = found["counts"].items()
    counted = ", ".join(f"{n} {kind if n != 1 else kind[:-1]}" for kind, n in counts)
    return f"set {found['name']}: {counted}; {', '.join(found['keys'])}"


def _why(asked: str, body: BuiltBody) -> str:
    """The reason for the choice of a body's kernel."""
    if asked != "auto" or body.kernel in KERNELS:
        return "asked for" if asked != "auto" else KERNELS[body.kernel]
    large, several = body.material.law != "linear", len(body.materials) > 1
    why = "several materials" if several else "elements are not equal boxes along x, y, z"
    why = "large strain" if large else why
    return f"{why}: {'x'.join(3 * [str(FACTS[body.mesh.element].points)])} Gauss points"


def _contact(
    built: BuiltContact, given: Contact, gap: float | None, found: dict[str, Any]
) -> dict[str, Any]:
    default = given.beta is None and given.epsilon is None
    facts = {**values_of(given), **values_of(built), "penalty_is_default": default}
    facts |= {"removal_time": given.removal_time or 0.0}
    return facts | {"penetration": found, "initial_gap": gap}


def _support(support: Support) -> dict[str, Any]:
    points = len(support.history.time) if support.history else 0
    return {**values_of(support), "set": ".".join(support.set), "history": points}


def _probe(probe: Located) -> dict[str, Any]:
    given = probe.given
    facts = {"name": given.name, "quantities": list(given.taken), "every": given.every}
    return {**facts, "where": probe.words, "row_bytes": probe.row_bytes}


def _time(problem: Problem, plan: Sequence[Cost]) -> dict[str, Any]:
    given, stable = problem.parts.time, problem.stable
    integrator = ffi.new("ct_integrator *", given.scheme)
    courant = problem.dt / stable.dt_courant if stable.dt_courant > 0.0 else math.inf
    facts = {"integrator": given.integrator, "integrator_parameter": given.parameter}
    facts |= {
        "evaluations_per_step": lib.ct_integrator_evaluations(integrator),
        "integrator_limit": lib.ct_integrator_limit(integrator),
    }
    facts |= {"end": problem.end, "asked": dict([given.step])}
    facts |= {"dt": problem.dt, "steps": problem.step_count, "dt_courant": stable.dt_courant}
    facts |= {"stable": stable.dt, "stable_without_contact": stable.dt_without_contact}
    facts |= {"courant": courant, "fraction": problem.dt / stable.dt}
    return facts | {"limited_by": _limited_by(problem, plan)}


def _limited_by(problem: Problem, plan: Sequence[Cost]) -> str:
    """The effects that bound the stable step, :eq:`plan-share`, the largest contribution first; those
    below 1 % are left out."""
    rate, shares = 2.0 / problem.stable.dt, dict[str, float]()
    for cost in plan:
        shares[cost.name] = cost.omega_squared + rate * cost.rate
    large = [name for name in shares if shares[name] > 0.01 * sum(shares.values())]
    large.sort(key=lambda name: -shares[name])
    bodies = "elements" if problem.parts.time.stable_step == "elements" else "the assembled bodies"
    text = " and ".join(bodies if name == "solid" else name for name in large)
    return text + (" together" if len(large) > 1 else "") if text else "nothing"


# The text: a template for each section, filled with the facts and the units. Empty lines are left out.

HEAD = """{title}{where}
  units {length}, {mass}, {time}: stress in {stress}, energy in {energy}"""
BODY = """  {name}: {elements} {element}, {nodes} nodes, material {material}, shortest edge {shortest_edge:.6g} {length}
    waves: c1 = {c1:.6g} {velocity} ({c1_si:.5g} m/s), c2 = {c2:.6g} {velocity}
    kernel {kernel} ({kernel_why}), mass lumped by {lumping}{numbered}"""
CONTACT = """  contact {pair}: {how}, {count} points
    penalty epsilon = {epsilon:.6g} {penalty} ({origin})
    {choices}
    at the start {nearest}"""
TIME = """  {scheme} to t = {end:.6g} {time} in {steps} steps of {dt:.6g} {time} (requested: {asked})
  limit of the integrator: omega dt = {integrator_limit:.5g}, {evaluations_per_step} evaluation(s) of the forces per step
  stable step {stable:.6g} {time} with contact, {stable_without_contact:.6g} {time} without; limited by {limited_by}
  Courant number c1 dt / h = {courant:.4g}, fraction of the stable step = {fraction:.4g}"""
COST = """  {updates:.4g} element updates; about {flops_per_step:.3g} flops and {bytes_per_step:.3g} bytes per step in the elements
  memory about {megabytes:.3g} MB, threads {threads}"""


def _text(data: dict[str, Any], units: Units) -> str:
    labels = {**data["units"], **{name: units.label(name) for name in ("velocity", "penalty")}}
    savings = ", ".join(data["savings"]) or "none, as set in the scene"
    output, time, cost = data["output"], data["time"], data["cost"]
    ((asked, value),), scheme = time["asked"].items(), time["integrator"]
    facts = lib.ct_integrator_facts(INTEGRATORS[scheme])
    if facts.most > facts.least:
        scheme += f" ({time['integrator_parameter']:.6g})"
    time = {**time, "asked": f"{asked} = {value:g}", "scheme": scheme}
    fields = ", ".join(output["fields"]) if output["fields"] and output["file"] else "the ledger"
    where = f"to {output['file']}" if output["file"] else "in memory only (no file named)"
    file = f"\n  scene {data['file']}" if data["file"] else ""
    lines = [HEAD.format(**{**labels, "title": data["title"] or "(no title)", "where": file})]
    lines += ["", "Bodies"]
    for body in data["bodies"]:
        layers = f", numbered layer by layer along {body['layers']}" if body["layers"] else ""
        text = BODY.format(**labels, **body, numbered=layers)
        if body["place"]:
            low, high = (", ".join(f"{x:.6g}" for x in corner) for corner in body["place"])
            text += f"\n    placed between ({low}) and ({high}) {labels['length']}"
        if body["inertia"]:
            ratios = ", ".join(f"{ratio:.4g}" for ratio in body["inertia"])
            text += f"\n    inertia of these masses over that of the body: {ratios}"
        lines.append(text)
    lines += [f"  {_set_line(found)}" for found in data["sets"]]
    lines += ["", f"Effects that are computed: {', '.join(data['effects'])}"]
    lines += [_contact_text(contact, labels) for contact in data["contacts"]]
    lines += [f"  {_support_line(support, labels)}" for support in data["supports"]]
    lines += [f"  {added['name']}: {added['text']}" for added in data["added"]]
    lines += ["", "What is not computed"]
    lines += [f"  {name}: {why}" for name, why in data["left_out"].items()]
    lines += [f"  optimisations, which do not change results: {savings}"]
    lines += [f"  assumed: {assumption}" for assumption in data["assumptions"]]
    lines += ["", "Time", TIME.format(**{**time, "time": labels["time"]})]
    if output["filter"]:
        fields += f", unfiltered and filtered {output['filter']} times,"
    lines += ["", "Output", f"  {output['records']} records of {fields} {where}"]
    lines += [f"  {_probe_line(probe)}" for probe in data["probes"]]
    lines += ["", "Cost", COST.format(**cost, megabytes=cost["memory_bytes"] / 1e6)]
    lines += [f"  {line}" for line in _plan_lines(data)]
    if data["warnings"]:
        lines += ["", "Warnings", *(f"  {line}" for line in data["warnings"])]
    return "\n".join(lines)


def _contact_text(contact: dict[str, Any], labels: dict[str, str]) -> str:
    faces, other = contact["faces"], "the other surface"
    how = f"{faces[0]} and {faces[-1]} faces, each side slave and master once"
    if contact["with_itself"]:
        how = f"{faces[0]} faces of one body, each against all that share no node with it"
        other = "another part of the surface"
    origin = "given" if contact["beta"] is None else f"beta = {contact['beta']:g}"
    if contact["penalty_is_default"]:
        origin = "the default"
    gap, nearest = contact["initial_gap"], f"no point is near {other}"
    if gap is not None:
        nearest = f"the smallest gap of a contact point is {gap:.4g} {labels['length']}"
    return CONTACT.format(
        **{**labels, **contact},
        pair=pair_name(contact["surfaces"]),
        how=how,
        count=sum(contact["gauss_points"]),
        origin=origin,
        choices=", ".join(_choices(contact)),
        nearest=nearest,
    )


def _choices(contact: dict[str, Any]) -> Iterator[str]:
    """The other keys of a contact that have a meaning in it, with their values."""
    for name in ContactKeys.keys():
        other, wanted = Contact.belongs.get(name, (name, contact[name]))
        if name not in ("beta", "epsilon") and contact[other] == wanted:
            value = contact[name]
            if value is not None:
                text = f"{value:g}" if isinstance(value, float) else value
                yield f"{name.replace('_', ' ')} {text}"


def _support_line(support: dict[str, Any], labels: dict[str, str]) -> str:
    moving = ""
    if any(support["velocity"]):
        moving = f" at the velocity {support['velocity']} {labels['velocity']}"
    if support["history"]:
        moving = f" on a path, {support['travel']} {labels['length']} times a history of {support['history']} points"
    return f"support {support['set']}: {', '.join(support['fix'])} prescribed{moving}"


def _probe_line(probe: dict[str, Any]) -> str:
    every = "every step" if probe["every"] == 1 else f"every {probe['every']} steps"
    return f"probe {probe['name']}: {', '.join(probe['quantities'])} of {probe['where']}, {every}"


def _plan_lines(data: dict[str, Any]) -> list[str]:
    if any(cost.predicted is None for cost in data["plan"]):
        return ["no prediction: a trial of a few steps failed"]
    how = "no rehearsal is possible: predicted as if all surfaces touched from the start"
    if data["cost"]["rehearsed"]:
        how = "predicted from a rehearsal and a trial on this machine"
    rows = table(data["plan"], data["time"]["stable"]).splitlines()
    return [f"{how}; flops and bytes with all parts active:", *rows]
