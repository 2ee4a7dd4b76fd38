"""
What is known of a scene before its first step and is probably not meant, and what a run shows later. Each is one warning object (``libcontact.errors``):
``explain`` prints those of ``known``, a run issues them (chapter "Warnings").
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import has
from ._core import ffi
from .chatter import chatter
from .errors import (
    InsideOutWarning,
    NeverMeetWarning,
    OutputWarning,
    OverlapWarning,
    RotationWarning,
    SamePlaceWarning,
    SceneWarning,
    ThinWarning,
    UnitsWarning,
)
from .mesh import Mesh, rotation
from .model import AXES, FEEDING, Contact
from .problem import BuiltBody, Problem, contact_points, new_state, penetrations, speeds
from .surfaces import obstacle_name, pair_name
from .touch import Touch, first_touch, gravity_on, surface_box

# Wave speeds [m/s] between which every solid lies, with much room on both sides.
SLOW, FAST = 1.0, 30000.0
# Two bodies are in one place if this share of the smaller one is inside the other; so many of its element centres are tried.
SHARED, TRIED = 0.5, 64
# A rotation θ is a strain of θ²/2 to the small-strain law (eq:turned); it is found from so many nodes.
TURNED, TURN_NODES = 0.04, 2000
# Share of the energy of an impact that the nodes which hit first may hold (eq:thin-loss): 1/(2n) for n equal elements.
THIN = 0.3
# Effects that leave a body that moves without strain as it is, or act on all nodes of a body alike.
HARMLESS = ("gravity", "viscosity")


def known(
    problem: Problem, output: Any, found: Sequence[dict[str, Any]] | None = None
) -> list[SceneWarning]:
    """
    All warnings that are known before the first step of a run which writes to ``output`` (None: no file). ``found``: what is inside at
    the points of each contact at t = 0, if it was asked before.
    """
    if found is None:
        _, found = at_start(problem)
    away = list(_inside_out(problem))
    follow = [*_overlaps(problem, found), *_never_meet(problem), *_thin(problem)]
    keys = {warning.key for warning in away}  # no second warning of what follows from the first
    return [
        *_units(problem),
        *_file(output),
        *away,
        *_same_place(problem),
        *(warning for warning in follow if warning.key not in keys),
        *chatter(problem),
    ]


def at_start(problem: Problem) -> tuple[list[float | None], list[dict[str, Any]]]:
    """Of each contact at t = 0 the smallest gap (None where no point is near the other surface), and what is inside at its points."""
    if not problem.contacts:
        return [], []
    state = new_state(problem)
    gaps = [
        (points["gap"] + points["start_gap"])[points["other"] >= 0]
        for points in contact_points(problem, state)
    ]
    return [float(gap.min()) if gap.size else None for gap in gaps], [
        found["points"] for found in penetrations(problem, state)
    ]


def turned(problem: Problem, state: Any) -> Iterator[RotationWarning]:
    """The bodies with the small-strain law that have turned too far in a state (``ct_state *``)."""
    u = np.frombuffer(
        ffi.buffer(state.displacement, 24 * problem.pointer.node_count), np.float64
    ).reshape(-1, 3)
    for i, body in enumerate(problem.bodies.values()):
        if body.material.law != "linear":
            continue
        some = _spread(len(body.mesh.nodes))
        angle = _angle(body.mesh.nodes[some], u[body.nodes][some])
        if angle > TURNED:
            turned = f"has turned by {angle:.3g} rad ({math.degrees(angle):.3g} degrees) at t = {state.time:.4g}"
            strain = (
                f'the law "linear" takes a rotation for a strain, of {0.5 * angle * angle:.2g} here'
            )
            advice = f'give material "{body.material.name}" the law "st_venant_kirchhoff" or "neo_hookean"'
            yield RotationWarning(
                f'body "{body.name}" {turned}, and {strain}; {advice}', f"body[{i}]"
            )


def _spread(count: int) -> NDArray[Any]:
    """Numbers of nodes spread over a body, all of them if they are few; by the golden section, so that no lattice puts them into one line."""
    if count <= TURN_NODES:
        return np.arange(count)
    return (np.arange(TURN_NODES) * (math.sqrt(5.0) - 1.0) / 2.0 % 1.0 * count).astype(int)


def _angle(X: NDArray[Any], u: NDArray[Any]) -> float:
    """The angle [rad] of the rotation that comes nearest to the displacements u of nodes at X."""
    R = rotation(X, X + u)
    skew = R - R.T
    return math.atan2(math.sqrt(0.5 * float((skew * skew).sum())), float(np.trace(R)) - 1.0)


def _units(problem: Problem) -> Iterator[UnitsWarning]:
    for i, body in enumerate(problem.bodies.values()):
        si = speeds(body.material)[0] * problem.parts.units.factor("velocity")
        if not SLOW <= si <= FAST:
            yield UnitsWarning(
                f'material "{body.material.name}": c1 = {si:.4g} m/s is outside {SLOW:g} ... {FAST:g} m/s; are young, density and [units] consistent?',
                f"body[{i}]",
            )


def _file(output: Any) -> Iterator[OutputWarning]:
    if output is not None and not has("hdf5"):
        text = f'this build has no HDF5: "{output}" is not written, the results stay in memory; build with HDF5 to get the file'
        yield OutputWarning(text, "output.file")


# What becomes of an overlap that is neither within ``adjust`` nor removed.
FATE = {
    "keep": 'gaps count from there, so no energy is added (initial_penetration = "keep")',
    "push": 'the penalty pushes them apart, which adds energy to the bodies (initial_penetration = "push")',
    "refuse": 'the run is refused (initial_penetration = "refuse")',
}


def _overlaps(problem: Problem, found: Sequence[dict[str, Any]]) -> Iterator[OverlapWarning]:
    """Points that are inside the other surface at the start, where the scene says nothing of it: neither ``adjust`` nor ``"remove"``."""
    for i, (given, points) in enumerate(zip(problem.parts.contact, found)):
        deepest = points["deepest"]
        if deepest > max(points["touching"], given.adjust) and given.initial_penetration in FATE:
            where = ", ".join(f"{x:.4g}" for x in points["position"])
            count, how = points["inside"] - points["buried"], given.initial_penetration
            text = f"the surfaces overlap by {deepest:.3g} at the start, at {count} points, most at ({where}) on {points['surface']}; {FATE[how]}"
            if how != "refuse":
                text += f". If they are meant to touch, give adjust = {1.1 * deepest:.2g} or more, which closes gaps, too; if not, move the bodies or see initial_penetration"
            yield OverlapWarning(f"{pair_name(given.surfaces)}: {text}", f"contact[{i}]")
        if points["buried"]:
            text = f"{points['buried']} points are deep beneath the other surface at the start, or on its far side; they are in no contact before they have been outside"
            yield OverlapWarning(f"{pair_name(given.surfaces)}: {text}", f"contact[{i}]")


# Surfaces that face away from each other.


def _inside_out(problem: Problem) -> Iterator[InsideOutWarning]:
    for i, contact in enumerate(problem.parts.contact):
        reason = "" if contact.with_itself else _away(problem, i, contact)
        if reason:
            text = f"{reason}, so they never press on each other and the bodies pass through; name the faces that look at each other"
            yield InsideOutWarning(f"{pair_name(contact.surfaces)}: {text}", f"contact[{i}]")
    for effect in problem.parts.effects:
        if effect.name == "obstacle" and _behind(problem, effect.given):
            how = f"inside the {effect.given.shape}; move it, or make the radius smaller"
            if effect.given.shape == "plane":
                how = "behind the plane; turn its normal round"
            yield InsideOutWarning(f"{obstacle_name(effect)} lies {how}", effect.key)


def _away(problem: Problem, i: int, contact: Contact) -> str:
    """Why two plane faces can't press on each other; "" if they can, or if a body turns."""
    bodies, faces = zip(*contact.surfaces)
    if "outer" in faces or any(problem.parts.bodies[body].spin is not None for body in bodies):
        return ""
    (first, side), (second, other) = ((face[0], face.endswith("max")) for face in faces)
    if first != second:
        return ""
    if side == other:
        return "both surfaces look the same way"
    (low, high), (low_b, high_b) = (surface_box(problem, i, k) for k in (0, 1))
    axis = "xyz".index(first)
    across = [k for k in range(3) if k != axis]
    gap = (low_b - high if side else low - high_b)[axis]
    aside = np.any(np.maximum(low, low_b)[across] > np.minimum(high, high_b)[across])
    sides = zip(bodies, problem.faces[i])
    largest = max(_largest_face(problem.bodies[body].mesh, faces) for body, faces in sides)
    far = aside or gap >= -(contact.depth or largest)
    return "" if far else "the surfaces look away from each other"


def _largest_face(mesh: Mesh, faces: NDArray[Any]) -> float:
    """The longest diagonal of the faces' boxes."""
    x = mesh.nodes[faces]
    return float(np.linalg.norm(x.max(axis=1) - x.min(axis=1), axis=1).max())


def _behind(problem: Problem, given: Any) -> bool:
    """Whether the middle of a body is behind a plane, or all of a surface inside a sphere or cylinder by more than an element."""
    mesh = problem.bodies[given.surface[0]].mesh
    if given.shape == "plane":
        return bool(given.gaps(mesh.nodes)[0].mean() < 0.0)
    gaps, _ = given.gaps(mesh.nodes[mesh.face_nodes(given.surface[1])])
    return bool(gaps.max() < -mesh.shortest_edge)


# Bodies in one place.


def _same_place(problem: Problem) -> Iterator[SamePlaceWarning]:
    order = {name: i for i, name in enumerate(problem.bodies)}
    for a, b in combinations(problem.bodies.values(), 2):
        share = _shared(problem, a, b)
        if share >= SHARED:
            text = f'bodies "{a.name}" and "{b.name}" are in one place: about {100 * share:.0f} % of the smaller one is inside the other; move one of them'
            yield SamePlaceWarning(text, f"body[{order[b.name]}]")


def _shared(problem: Problem, a: BuiltBody, b: BuiltBody) -> float:
    """The share of the smaller body that is inside the other: of its box, and if that is much, of its element centres."""
    boxes = [body.mesh.bounds for body in (a, b)]
    sides = np.minimum(boxes[0][1], boxes[1][1]) - np.maximum(boxes[0][0], boxes[1][0])
    volumes = [float(np.prod(high - low)) for low, high in boxes]
    if np.any(sides <= 0.0) or np.prod(sides) < SHARED * min(volumes):
        return 0.0
    small, large = (a, b) if volumes[0] <= volumes[1] else (b, a)
    some = np.linspace(0, len(small.mesh.elements) - 1, TRIED).astype(int)
    centres = small.mesh.nodes[small.mesh.elements[some]].mean(axis=1)
    if problem.parts.bodies[large.name].box is not None:
        low, high = large.mesh.bounds
        return float(((centres > low) & (centres < high)).all(axis=1).mean())
    return float((large.mesh.locate(centres)[0] >= 0).mean())


# Bodies that can never meet.


def _never_meet(problem: Problem) -> Iterator[NeverMeetWarning]:
    """
    Contacts whose surfaces can't come together. Only bodies count that nothing acts on but a gravity that they fall in freely: they keep their
    velocity, and the boxes around the bodies give the earliest time of a touch. A body that may be hit counts no more.
    """
    acted_on = _acted_on(problem)
    touches = {touch.contact: touch for touch in first_touch(problem) if touch.name == "contact"}
    contacts = enumerate(problem.parts.contact)
    apart = {i: contact for i, contact in contacts if not contact.with_itself}
    before = -1
    while len(apart) != before:
        before = len(apart)
        for i, contact in list(apart.items()):
            bodies = {body for body, _ in contact.surfaces}
            if bodies & acted_on or touches[i].time <= problem.end * (1.0 + 1e-9):
                acted_on |= bodies
                del apart[i]
    for i, contact in apart.items():
        when, gap = "nothing moves them towards each other", np.abs(touches[i].shift).max()
        if math.isfinite(touches[i].time):
            when = f"they would touch at t = {touches[i].time:.4g}"
        text = f"the surfaces are {gap:.4g} apart and cannot meet before the run ends at t = {problem.end:.4g}, as {when}; check velocities, places and end, or leave the contact out"
        yield NeverMeetWarning(f"{pair_name(contact.surfaces)}: {text}", f"contact[{i}]")


def _acted_on(problem: Problem) -> set[str]:
    """The bodies whose motion before a contact is not known: something other than a free fall acts on them."""
    parts, out = problem.parts, {own.body for own in problem.own}
    out |= {name for name, body in parts.bodies.items() if body.spin is not None}
    out |= {contact.surfaces[0][0] for contact in parts.contact if contact.with_itself}
    for support in parts.support:
        velocity = parts.bodies[support.body].velocity
        held = [AXES.index(axis) for axis in support.fix]
        drives = any(support.velocity[k] != velocity[k] for k in held)
        if drives or support.history or gravity_on(problem, support.body).any():
            out.add(support.body)
    for effect in parts.effects:
        if effect.name not in HARMLESS:
            surface = getattr(effect.given, "surface", None)
            bodies = getattr(effect.given, "bodies", None)
            out |= {surface[0]} if surface else set(parts.bodies if bodies is None else bodies)
    return out


# Bodies that are too thin for an impact.


def _thin(problem: Problem) -> Iterator[ThinWarning]:
    """Contacts and obstacles whose first impact loses much: the nodes that hit hold a large part of what moves (eq:thin-loss)."""
    touches = {(touch.name, touch.contact): touch for touch in first_touch(problem)}

    def loses(given: Any, touch: Touch) -> bool:
        meets = touch.closing > 0.0 and touch.time <= problem.end
        return given.enforcement not in FEEDING and meets

    for i, contact in enumerate(problem.parts.contact):
        touch = touches["contact", i]
        if not contact.with_itself and loses(contact, touch):
            yield from _thin_in(problem, f"contact[{i}]", touch, _first_nodes(problem, i, touch))
    obstacles = [effect for effect in problem.parts.effects if effect.name == "obstacle"]
    for i, effect in enumerate(obstacles):
        touch, given = touches["obstacle", i], effect.given
        if loses(given, touch):
            body = problem.bodies[given.surface[0]]
            nodes = body.mesh.face_nodes(given.surface[1])
            gaps, _ = given.gaps(body.mesh.nodes[nodes])
            near = nodes[gaps <= gaps.min() + 1e-3 * body.mesh.shortest_edge]
            yield from _thin_in(problem, effect.key, touch, {body.name: near})


def _first_nodes(problem: Problem, i: int, touch: Touch) -> dict[str, NDArray[Any]]:
    """The nodes of both surfaces that hit first: the foremost ones that have the other surface before them."""
    contact, along = problem.parts.contact[i], touch.normal != 0.0
    boxes, out = [surface_box(problem, i, k) for k in (0, 1)], {}
    for k, (name, _) in enumerate(contact.surfaces):
        mesh, (low, high) = problem.bodies[name].mesh, boxes[1 - k]
        nodes = np.unique(problem.faces[i][k])
        x, h = mesh.nodes[nodes], mesh.shortest_edge
        ahead = (1.0 if k == 0 else -1.0) * (x @ touch.normal)
        before = (((x >= low - 1e-3 * h) & (x <= high + 1e-3 * h)) | along).all(axis=1)
        out[name] = nodes[(ahead >= ahead.max() - 1e-3 * h) & before]
    return out


def _thin_in(
    problem: Problem, key: str, touch: Touch, first: dict[str, NDArray[Any]]
) -> Iterator[ThinWarning]:
    masses = {name: _masses(problem, name, nodes, touch.normal) for name, nodes in first.items()}
    hit, moving = (_reduced([pair[k] for pair in masses.values()]) for k in (0, 1))
    if not math.isfinite(moving) or hit < THIN * moving:
        return
    share = {name: a / b if math.isfinite(a) else 0.0 for name, (a, b) in masses.items()}
    name, axis = max(share, key=lambda name: share[name]), AXES[int(np.abs(touch.normal).argmax())]
    text = f'body "{name}" is about one element thick where it hits, along {axis}: the nodes that hit first hold {100 * hit / moving:.0f} % of the energy of the impact, which can be lost; '
    advice = (
        "divide it into at least 4 elements along that direction (n equal ones lose up to 1/(2 n))"
    )
    yield ThinWarning(text + advice, key)


def _masses(
    problem: Problem, name: str, nodes: NDArray[Any], normal: NDArray[Any]
) -> tuple[float, float]:
    """Mass of some nodes of a body and of all of it, along a direction; infinite if nodes are held there."""
    count, first = problem.pointer.node_count, problem.bodies[name].nodes
    axis = int(np.argmax(np.abs(normal)))
    mass = np.frombuffer(ffi.buffer(problem.pointer.mass, 8 * count), np.float64)[first]
    inverse = ffi.buffer(problem.pointer.inverse_mass, 24 * count)
    free = np.frombuffer(inverse, np.float64).reshape(-1, 3)[first, axis] > 0.0
    whole = float(mass.sum()) if free.all() else math.inf
    return float(mass[nodes].sum()) if free[nodes].all() else math.inf, whole


def _reduced(masses: list[float]) -> float:
    """The mass with which two bodies meet, m1 m2 / (m1 + m2); of one body that meets a wall its own."""
    if not all(masses):
        return 0.0
    inverse = sum(1.0 / m for m in masses)
    return 1.0 / inverse if inverse > 0.0 else math.inf
