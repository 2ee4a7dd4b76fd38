"""Warnings of a scene that are known before its first step, and of what a run shows later. Each is
one warning object (``libcontact.errors``): ``explain`` prints those of ``known``, a run issues them
(chapter "Warnings").
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence, Set
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..bridge import has
from ..errors import SceneWarning, came_in_late
from ..hdf5 import ADVICE
from ..mesh import FACTS, rotation
from ..meshes.bricks import components
from ..model import AXES, FEEDS, Contact, Turn, speeds
from ..observers import Observer, spread
from ..parts import acts_on
from ..problem import BuiltBody, Problem, contact_points, new_state, penetrations
from ..schema import SIDES, Place, walk
from ..surfaces import contact_tables, pair_name, whole_skin
from .chatter import chatter
from .limits import Depths, long_run, short_run
from .touch import Touch, first_touch, gravity_on, meetings, started
from .volumes import Volumes

Points = dict[str, NDArray[np.int32]]

# Limits of the wave speed [m/s], far below and far above those of all solids; largest density [kg/m³].
SLOW, FAST, DENSE = 1.0, 30000.0, 30000.0
# The acceleration of gravity on the earth, in m/s² and so in no other units.
EARTH = (9.7, 9.9)
# Two bodies are in the same place if this fraction of the smaller one is inside the other; number of
# its element centres that are checked.
COMMON, TRIED = 0.5, 64
# Largest rotation θ [rad] for the small-strain law, which sees a strain of θ²/2 (eq:turned); number of
# nodes from which it is computed.
TURNED, TURN_NODES = 0.04, 2000
# Fraction of the energy of an impact that may be lost (eq:thin-loss): (1 - e)/(2n) for n equal elements.
THIN = 0.3
# Width over length of hex20 elements in an impact up to which they lose little (eq:hex20-section).
WIDE = 1.5
# Part of an overlap by which it differs between points, from which on flat faces decide about the pressure of a press
# fit: rings of 48 and 40 faces have 5 % too much at .14, of 24 and 26 8 % at .37, of 48 and 24 31 % at .19.
FACETS = 0.15
# Angle between two faces from which on they meet at an edge of the body and not on a curved surface.
SHARP = math.radians(50.0)
# Pairs of faces that are compared to find those that lie opposite each other.
MOST_PAIRS = 4_000_000
# Effects that do not act on a body that moves without strain, or accelerate all its nodes equally.
HARMLESS = ("gravity", "viscosity")
# Effects that do not set a body in motion that is at rest.
PASSIVE = ("damping", "absorb", "rigid")


def known(
    problem: Problem, output: Any, found: Sequence[dict[str, Any]] | None = None, state: Any = None
) -> list[SceneWarning]:
    """
    Return all warnings that are known before the first step of a run.

    The run writes to the file ``output`` (None: no file). ``found``, the penetration at the points of
    each contact and obstacle at t = 0, and ``state``, the state (``ct_state *``) at t = 0, are computed if they are
    not given.
    """
    if found is None:
        _, found = at_start(problem, state)
    touches = first_touch(problem)
    acted_on, still = _acted_on(problem, touches)
    away = list(_inside_out(problem, touches))
    follow = [*_overlaps(problem, found), *_never_meet(problem, touches, acted_on)]
    follow += [*_thin(problem, touches), *_wide(problem, touches), *_unlike(problem, found)]
    keys = {warning.key for warning in away}  # no second warning with the same cause
    return [
        *_units(problem),
        *_file(output),
        *away,
        *_same_place(problem),
        *_no_contact(problem, acted_on - still, still),
        *(warning for warning in follow if warning.key not in keys),
        *chatter(problem),
        *long_run(problem),
        *short_run(problem),
    ]


def during(problem: Problem) -> list[Observer]:
    """The checks that a run makes between its steps."""
    return [Turning(problem), Volumes(problem), Borders(problem), Depths(problem)]


def at_start(
    problem: Problem, state: Any = None
) -> tuple[list[float | None], list[dict[str, Any]]]:
    """The smallest gap of each contact at t = 0 (None if no point is near the other surface), and the penetration at
    the points of each contact, and by how much it differs ("spread"), and of each obstacle."""
    if not problem.contacts and not problem.parts.obstacle:
        return [], []
    state = new_state(problem) if state is None else state
    gaps = []
    inside = [found["points"] for found in penetrations(problem, state, ["points"])]
    for points, found in zip(contact_points(problem, state), inside):
        near = (points["gap"] + points["start_gap"])[points["other"] >= 0]
        gaps.append(float(near.min()) if near.size else None)
        found["spread"] = float(np.ptp(near[near < 0.0])) if (near < 0.0).any() else 0.0
    return gaps, inside


class Turning(Observer):
    """Finds bodies with the small-strain law that have rotated too far for it. For each body a cheap
    bound on the displacements tells that it has not (:eq:`turned-bound`)."""

    at_records = True

    def __init__(self, problem: Problem):
        super().__init__(problem)
        self._bodies = {
            i: (body, *_spread_of(body.mesh.nodes))
            for i, body in enumerate(problem.bodies.values())
            if body.material.law == "linear" and body.kernel != "rigid"
        }

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        """Yield a warning for each body that has rotated too far in a state (``ct_state *``), once per
        body."""
        u = self._problem.rows(state.displacement)
        for i, (body, some, least) in list(self._bodies.items()):
            # In numpy this is much faster than u[...][some] and .mean(axis=0).
            moved = u[body.nodes].take(some, axis=0)
            spread = moved - np.full(len(some), 1.0 / len(some)) @ moved
            if float(np.vdot(spread, spread)) <= least:
                continue
            angle = _angle(body.mesh.nodes[some], moved)
            if angle > TURNED:
                del self._bodies[i]
                turned = (
                    f"{angle:.3g} rad ({math.degrees(angle):.3g} degrees) at t = {state.time:.4g}"
                )
                strain, material = 0.5 * angle * angle, '", "'.join(m.name for m in body.materials)
                text = f'body "{body.name}" has turned by {turned}, and with the law "linear" '
                text += f"this rotation causes a false strain of {strain:.2g}; "
                text += f'give material "{material}" the law "st_venant_kirchhoff" or "neo_hookean"'
                yield SceneWarning("rotation", text, f"body[{i}]")


def _spread_of(X: NDArray[Any]) -> tuple[NDArray[Any], float]:
    """Nodes spread over a body, and a bound on the sum of squares of their displacements about the mean:
    every rotation by TURNED exceeds it, :eq:`turned-bound`."""
    some = _spread(len(X))
    spread = X[some] - X[some].mean(axis=0)
    inertia = spread.T @ spread
    # (eq:turned-bound)
    across = float(np.trace(inertia) - np.linalg.eigvalsh(inertia)[-1])
    return some, (1.0 - 1e-9) * math.sin(0.5 * TURNED) ** 2 * across


def _spread(count: int) -> NDArray[Any]:
    """Numbers of nodes spread over a body by the golden ratio, so that they do not lie on one line of a
    regular mesh; all nodes if they are few."""
    if count <= TURN_NODES:
        return np.arange(count)
    return (np.arange(TURN_NODES) * (math.sqrt(5.0) - 1.0) / 2.0 % 1.0 * count).astype(int)


def _angle(X: NDArray[Any], u: NDArray[Any]) -> float:
    """Angle [rad] of the rotation that is closest to the displacements u of the nodes at X."""
    R = rotation(X, X + u)
    skew = R - R.T
    return math.atan2(math.sqrt(0.5 * float((skew * skew).sum())), float(np.trace(R)) - 1.0)


def _units(problem: Problem) -> Iterator[SceneWarning]:
    units, given = problem.parts.units, dict[str, tuple[int, Any]]()
    for i, body in enumerate(problem.bodies.values()):
        for each in body.materials:
            given.setdefault(each.name, (i, each))
    for i, material in given.values():
        si = speeds(material)[0] * units.factor("velocity")
        if not SLOW <= si <= FAST:
            text = f"c1 = {si:.4g} m/s is outside {SLOW:g} ... {FAST:g} m/s"
        elif (si := material.density * units.factor("density")) > DENSE:
            text = f"the density {si:.4g} kg/m³ is above {DENSE:g} kg/m³"
        else:
            continue
        text = f'material "{material.name}": {text}; are young, density and [units] consistent?'
        yield SceneWarning("units", text, f"body[{i}]")
    factor, weight = units.factor("velocity") / units.factor("time"), problem.parts.gravity
    size = math.hypot(*weight.acceleration) if weight else 0.0
    if EARTH[0] <= size <= EARTH[1] and not math.isclose(factor, 1.0):
        text = f"{size:g} {units.length}/{units.time}^2 are {size * factor:.4g} m/s²; {size:g} m/s² are {size / factor:.6g} {units.length}/{units.time}^2"
        yield SceneWarning("units", text, "gravity.acceleration")
    for at, table in walk(problem.parts, Place()):
        if isinstance(table, Turn) and abs(table.angle) > 2.0 * math.pi:
            text = f"{table.angle:g} rad is more than a turn; {table.angle:g} degrees are {math.radians(table.angle):.5g} rad"
            yield SceneWarning("units", text, f"{at.key}.angle")


def _file(output: Any) -> Iterator[SceneWarning]:
    if output is not None and not has("hdf5"):
        text = f'this build has no HDF5: "{output}" is not written, the results stay in memory; to get the file: {ADVICE}'
        yield SceneWarning("output", text, "output.file")


# Treatment of an overlap that is neither within ``adjust`` nor removed.
FATE = {
    "keep": 'gaps are measured from there, so no energy is added (initial_penetration = "keep")',
    "force": 'the penalty pushes them apart, which adds energy to the bodies (initial_penetration = "force")',
    "refuse": 'the run ends (initial_penetration = "refuse")',
}


def _overlaps(problem: Problem, found: Sequence[dict[str, Any]]) -> Iterator[SceneWarning]:
    """Overlaps at the start that neither ``adjust`` nor ``"remove"`` covers."""
    unit = problem.parts.units.length
    for (key, name, given), points in zip(contact_tables(problem.parts), found):
        deepest = points["deepest"]
        if deepest > max(points["touching"], given.adjust) and given.initial_penetration in FATE:
            where = ", ".join(f"{x:.4g}" for x in points["position"])
            count, how = points["inside"] - points["buried"], given.initial_penetration
            who = (
                "the surfaces overlap by"
                if key.startswith("contact")
                else "it overlaps the obstacle by"
            )
            text = f"{who} {deepest:.3g} {unit} at the start, at {count} points, deepest at ({where}) on {points['surface']}; {FATE[how]}"
            if how != "refuse":
                if deepest < _edge(problem, given):
                    text += f". If they should touch, set adjust = {1.1 * max(deepest, _sag(problem, given)):.2g} or more, which also closes gaps; if not, move the bodies or set initial_penetration"
                else:  # no facet is off by so much
                    text += f". Move the bodies apart by {deepest:.3g} {unit}, or set initial_penetration"
            yield SceneWarning("overlap", f"{name}: {text}", key)
        if points["buried"]:
            text = f"{points['buried']} points are deep beneath the other surface at the start, or on its far side; they are not in contact until they have been outside"
            yield SceneWarning("overlap", f"{name}: {text}", key)


def _unlike(problem: Problem, found: Sequence[dict[str, Any]]) -> Iterator[SceneWarning]:
    """Overlaps that are removed, where unlike flat faces of curved surfaces decide how large they are (eq:sag)."""
    unit = problem.parts.units.length
    for (key, name, given), points in zip(contact_tables(problem.parts), found):
        deepest = points["deepest"]
        if given.initial_penetration != "remove" or deepest <= given.adjust:
            continue
        sag, spread = _sag(problem, given), points.get("spread", 0.0)
        if min(sag, spread) > FACETS * deepest:
            text = f"the overlap that is removed is up to {deepest:.3g} {unit}, but differs by {spread:.3g} {unit} from point to point, since flat faces lie off the curved surface by up to {sag:.3g} {unit}; the pressure follows the faces. Give both surfaces the same faces, or smaller ones (half the size: a quarter of that), or take hex20; if they should only touch, set adjust = {1.1 * max(deepest, sag):.2g}"
            yield SceneWarning("overlap", f"{name}: {text}", key)


def _edge(problem: Problem, given: Any) -> float:
    """The shortest edge of the bodies of a contact or of the one at an obstacle."""
    surfaces = getattr(given, "surfaces", None) or [given.surface]
    return min(problem.bodies[name].mesh.shortest_edge for name, _ in surfaces)


def _sag(problem: Problem, given: Any) -> float:
    """By how much flat faces lie off the curved surface that their corners are on, for the coarser surface of a
    contact or the one at an obstacle: a face of the width w between edges at which it turns by θ is off by w θ / 8."""
    surfaces = getattr(given, "surfaces", None) or [given.surface]
    made = [_flat_faces(problem, *surface) for surface in surfaces]
    return max(_sag_of(*made[k], *made[len(made) - 1 - k][1:]) for k in range(len(made)))


def _flat_faces(problem: Problem, name: str, face: str) -> tuple[Any, Any, Any]:
    """Corner numbers and positions (n, 4, 3) of the faces of a surface at the start, and their area vectors."""
    mesh = problem.bodies[name].mesh
    faces = mesh.faces(face)[0]
    if faces.shape[1] != 4:
        faces = faces[:0]  # curved edges follow the surface
    x = started(problem, name)[faces]
    return faces, x, 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])


def _sag_of(faces: Any, x: Any, normals: Any, other_x: Any, other_normals: Any) -> float:
    """The sag of those faces of one surface that lie opposite the other surface."""
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    order = np.lexsort(edges.T)
    same = np.flatnonzero((edges[order][1:] == edges[order][:-1]).all(axis=1))
    one, two = order[same] // 4, order[same + 1] // 4
    areas = np.linalg.norm(normals, axis=1)
    length = np.linalg.norm(x - np.roll(x, -1, axis=1), axis=2).ravel()[order[same]]
    cosine = (normals[one] * normals[two]).sum(axis=1) / (areas[one] * areas[two])
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    sags = np.maximum(areas[one], areas[two]) / length * angle / 8.0
    near = _opposite(x, normals, other_x, other_normals)
    # Where it turns more, the surface has an edge of its own.
    return float(sags[(angle < SHARP) & near[one] & near[two]].max(initial=0.0))


def _opposite(x: Any, normals: Any, other_x: Any, other_normals: Any) -> Any:
    """Whether each face lies opposite one of the other surface within the size of both; in large surfaces, and of
    a surface at an obstacle, each does."""
    if len(x) * len(other_x) > MOST_PAIRS or x is other_x:
        return np.ones(len(x), bool)
    n, m = (v / np.linalg.norm(v, axis=1, keepdims=True) for v in (normals, other_normals))
    sizes = [np.linalg.norm(each[:, 2] - each[:, 0], axis=1) for each in (x, other_x)]
    centres = [each.mean(axis=1) for each in (x, other_x)]
    apart = np.linalg.norm(centres[0][:, None] - centres[1], axis=2)
    reach = np.maximum(sizes[0][:, None], sizes[1])
    return ((n @ m.T < -0.7) & (apart < reach)).any(axis=1)


class Borders(Observer):
    """Finds contacts around whose surfaces the bodies have come into each other."""

    #: Checks of the corners in a run, and how deep one may be there, as a fraction of the shortest edge.
    CHECKS, LEAST_STEPS, DEEP = 50, 16, 0.1

    def __init__(self, problem: Problem):
        contacts = problem.parts.contact
        self._told = set[int]()
        self._open = {i for i, given in enumerate(contacts) if whole_skin(given.surfaces)}
        self._first = dict.fromkeys(self._open, 0.0)
        least = self.LEAST_STEPS if self._open else 4 * self.LEAST_STEPS
        super().__init__(problem, spread(problem, self.CHECKS, least) if contacts else 0)

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        """Yield a warning for each contact with points that were found inside, or for parts of skins
        with a corner that is inside beyond the borders or between the points, once per contact."""
        if len(self._told) == len(self._problem.parts.contact):
            return
        asked = ["points", "corners"] if self._open - self._told else ["points"]
        # -- The contacts come first, before the obstacles
        contacts = self._problem.parts.contact
        for i, (given, found) in enumerate(
            zip(contacts, penetrations(self._problem, state, asked))
        ):
            surfaces = given.surfaces
            text = ""
            if found["points"]["late"]:
                points = found["points"]
                text = came_in_late(points["late"], points["late_depth"], i in self._open)
            elif i in self._open and "corners" in found:
                text = self._corner(i, found["corners"], state)
            if text and i not in self._told:
                self._told.add(i)
                text = f"{pair_name(surfaces)}: {text}{whole_skin(surfaces)}"
                yield SceneWarning("border", text, f"contact[{i}]")

    def _corner(self, i: int, found: dict[str, Any], state: Any) -> str:
        """What to say of the deepest corner, unless it is no deeper than at the start."""
        edge = _edge(self._problem, self._problem.parts.contact[i])
        if state.step == 0:
            self._first[i] = found["deepest"]
        if not found["deepest"] > self._first[i] + self.DEEP * edge:
            return ""
        finer, units = "finer faces help", self._problem.parts.units
        if self._problem.parts.contact[i].points == "gauss":
            finer = 'finer faces or points = "lobatto" help'
        return f"a corner of {found['surface']} is {found['deepest']:.3g} {units.length} inside the other surface at t = {state.time:.6g} {units.time}, where no contact point is: the bodies pass into each other beside the surfaces, or between their points, where {finer}"


# Surfaces that face away from each other.


def _inside_out(problem: Problem, touches: Sequence[Touch]) -> Iterator[SceneWarning]:
    for touch in touches:
        if len(touch.surfaces) == 1:
            who, why = ".".join(touch.given.surface), _behind(problem, touch.given)
            text = f"{who} lies {why}"
        else:
            who, why = pair_name(touch.surfaces), _away(problem, touch.given)
            text = f"{who}: {why}, so no contact force acts and the bodies pass through each other; name faces that point towards each other"
        if why:
            yield SceneWarning("inside_out", text, touch.key)


def _away(problem: Problem, contact: Contact) -> str:
    """The reason why two plane faces cannot come into contact; "" if they can, or if a body rotates."""
    (a, face), (b, other) = contact.surfaces
    turns = any(problem.parts.bodies[body].spin is not None for body in (a, b))
    plane = face in SIDES and other in SIDES
    if contact.with_itself or not plane or turns or face[0] != other[0]:
        return ""
    if face == other:
        return "both surfaces point in the same direction"
    near, far = (_surface(problem, surface) for surface in contact.surfaces)
    low, high = np.maximum(near.min(0), far.min(0)), np.minimum(near.max(0), far.max(0))
    axis = "xyz".index(face[0])
    gap = (far[0] - near[0])[axis] * (1.0 if face.endswith("max") else -1.0)
    aside = np.any(np.delete(low > high, axis))
    within = contact.depth or max(_largest_face(problem, surface) for surface in contact.surfaces)
    return "" if aside or gap >= -within else "the surfaces face away from each other"


def _largest_face(problem: Problem, surface: tuple[str, str]) -> float:
    """The longest diagonal of the bounding boxes of a surface's faces."""
    mesh = problem.bodies[surface[0]].mesh
    x = mesh.nodes[mesh.faces(surface[1])[0]]
    return float(np.linalg.norm(np.ptp(x, axis=1), axis=1).max())


def _behind(problem: Problem, given: Any) -> str:
    """The reason why an obstacle encloses the body in front of it; "" if it does not. The body's mean is
    behind a plane, or its whole surface is inside a sphere or cylinder by more than an element."""
    mesh = problem.bodies[given.surface[0]].mesh
    if given.shape == "plane":
        nodes = started(problem, given.surface[0])
        behind = given.gaps(nodes.mean(axis=0, keepdims=True))[0][0] < 0.0
        return "behind the plane; reverse its normal" if behind else ""
    inside = given.gaps(_surface(problem, given.surface))[0].max() < -mesh.shortest_edge
    return f"inside the {given.shape}; move it, or make the radius smaller" if inside else ""


def _surface(problem: Problem, surface: tuple[str, str]) -> NDArray[Any]:
    """Positions (n, 3) of the nodes of a surface at the start."""
    mesh = problem.bodies[surface[0]].mesh
    return started(problem, surface[0])[mesh.face_nodes(surface[1])]


# Bodies in the same place.


def _same_place(problem: Problem) -> Iterator[SceneWarning]:
    moved = {body.name for body in problem.parts.body if body.initial and body.initial.displaces}
    for (_, a), (i, b) in combinations(enumerate(problem.bodies.values()), 2):
        if {a.name, b.name} & moved:
            continue
        share = _common_fraction(problem, a, b)
        if share >= COMMON:
            text = f'bodies "{a.name}" and "{b.name}" occupy the same space: about {100 * share:.0f} % of the smaller one is inside the other; move one of them'
            yield SceneWarning("same_place", text, f"body[{i}]")


def _common_fraction(problem: Problem, a: BuiltBody, b: BuiltBody) -> float:
    """Fraction of the smaller body that is inside the other: 0 if their boxes overlap little, otherwise
    the fraction of its element centres."""
    small, large = sorted((a, b), key=lambda body: float(np.prod(np.ptp(body.mesh.bounds, axis=0))))
    (low, high), (low_b, high_b) = small.mesh.bounds, large.mesh.bounds
    sides = np.maximum(np.minimum(high, high_b) - np.maximum(low, low_b), 0.0)
    if not sides.all() or np.prod(sides) < COMMON * np.prod(high - low):
        return 0.0
    some = np.linspace(0, len(small.mesh.elements) - 1, TRIED).astype(int)
    centres = small.mesh.nodes[small.mesh.elements[some]].mean(axis=1)
    return float((large.mesh.locate(centres)[0] >= 0).mean())


# Bodies that can never meet.


def _never_meet(
    problem: Problem, touches: Sequence[Touch], acted_on: Set[str]
) -> Iterator[SceneWarning]:
    """
    Find contacts whose surfaces cannot come together.

    This is known only for bodies in free flight, on which nothing acts but gravity: their bounding
    boxes give the earliest time of a touch. A body that may be hit by another one is excluded.
    """
    acted_on, before = set(acted_on), -1
    pairs = [(touch, {body for body, _ in touch.surfaces}) for touch in touches]
    pairs = [pair for pair in pairs if len(pair[1]) == 2]
    while len(acted_on) != before:
        before = len(acted_on)
        for touch, bodies in pairs:
            if touch.time <= problem.end * (1.0 + 1e-9) or bodies & acted_on:
                acted_on |= bodies
    units = problem.parts.units
    for touch, bodies in pairs:
        if not bodies & acted_on:
            when, gap = "they do not move towards each other", np.abs(touch.shift).max()
            if math.isfinite(touch.time):
                when = f"they would touch at t = {touch.time:.4g} {units.time}"
            text = f"{pair_name(touch.surfaces)}: the surfaces are {gap:.4g} {units.length} apart and cannot meet before the run ends at t = {problem.end:.4g} {units.time}, as {when}; check velocities, places and end, or leave the contact out"
            yield SceneWarning("never_meet", text, touch.key)


def _acted_on(problem: Problem, touches: Sequence[Touch]) -> tuple[set[str], set[str]]:
    """The bodies that are not in free flight, so that their motion before a contact is unknown, and the bodies that
    stay in their places: at rest, moved by nothing, and held against gravity."""
    parts, moved = problem.parts, {own.body for own in problem.own}
    moved |= {name for name, body in parts.bodies.items() if body.spin or body.initial}
    moved |= {contact.surfaces[0][0] for contact in parts.contact if contact.with_itself}
    fixed = {name: np.zeros(3, bool) for name in parts.bodies}
    for support in parts.support:
        name, axes = support.set.body, [AXES.index(axis) for axis in support.fix]
        drives = np.subtract(support.velocity, parts.bodies[name].velocity)[axes].any()
        moved |= {name} if drives or support.history else set()
        fixed[name][axes] = True
    pull = {name: gravity_on(problem, name) for name in parts.bodies}
    out = moved | {name for name, axes in fixed.items() if pull[name][axes].any()}
    for effect in parts.effects:
        given, history = effect.given, getattr(effect.given, "history", None)
        if effect.name not in HARMLESS or history:
            carrier = getattr(given, "carrier", None)
            names = {name for name in parts.bodies if acts_on(given, name) or name == carrier}
            rests = effect.name == "obstacle" and not (any(given.velocity) or history or carrier)
            moved |= set() if rests or effect.name in PASSIVE else names
            out |= names
    calm = {name for name, body in parts.bodies.items() if not any(body.velocity)} - moved
    still = {name for name in calm if not pull[name][~fixed[name]].any()}
    before: set[str] | None = None
    # A body that lies on one that stays in its place, or on an obstacle, stays, too.
    while still != before:
        before = set(still)
        still |= {
            body
            for touch in touches
            for body, sign in zip(dict(touch.surfaces), (1.0, -1.0))
            if body in calm
            and {name for name, _ in touch.surfaces} <= still | {body}
            and np.abs(touch.shift).max() <= 1e-3 * problem.bodies[body].mesh.shortest_edge
            and pull[body] @ touch.normal * sign >= (1.0 - 1e-9) * np.linalg.norm(pull[body])
        }
    return out, still


# Bodies that meet and have no contact.


def _no_contact(problem: Problem, unknown: set[str], still: set[str]) -> Iterator[SceneWarning]:
    """Find bodies that reach each other before one of them hits another body, as far as their motion is known, and that
    neither a contact nor a tie joins, also not by way of other bodies."""
    number = {name: i for i, name in enumerate(problem.bodies)}
    joins = [each.surfaces for each in (*problem.parts.contact, *problem.parts.tie)]
    ends = np.array([[number[body] for body, _ in pair] for pair in joins], int).reshape(-1, 2)
    group = dict(zip(number, components(len(number), *ends.T)))
    for time, a, b, apart in meetings(problem, still) if not problem.own else ():
        if {a, b} & unknown:
            continue
        if group[a] == group[b]:
            unknown = unknown | ({a, b} - still)
        elif apart:
            text = f'bodies "{a}" and "{b}" meet at about t = {time:.4g} {problem.parts.units.time} and will pass through each other, as no [[contact]] names both: add one, with the surfaces that meet'
            yield SceneWarning("no_contact", text, "contact")


# Bodies that are too thin for an impact.


def _thin(problem: Problem, touches: Sequence[Touch]) -> Iterator[SceneWarning]:
    """Contacts and obstacles whose first impact loses much energy, because the nodes that hit hold a large
    part of the moving mass (eq:thin-loss)."""
    for touch in touches:
        meets = touch.closing > 0.0 and touch.time <= problem.end
        if not meets or problem.parts.relaxed or FEEDS[touch.given.enforcement]:
            continue
        first = _first_nodes(problem, touch)
        masses = {name: _masses(problem, name, first[name], touch.normal) for name in first}
        hit, moving = (_reduced(list(each)) for each in zip(*masses.values()))
        # (eq:thin-loss)
        kept = touch.given.restitution
        if math.isfinite(moving) and (1.0 - kept) * hit >= THIN * moving:
            share = {name: a / b if math.isfinite(a) else 0.0 for name, (a, b) in masses.items()}
            name, axis = max(share, key=share.__getitem__), AXES[np.abs(touch.normal).argmax()]
            text = f'body "{name}" is about one element thick where it hits, along {axis}: '
            lost = 100 * (1.0 - kept) * hit / moving
            text += f"with restitution {kept:g} about {lost:.0f} % of the energy of the impact is lost; "
            text += f"for elastic bodies take {_lossless(problem)}, or divide it into at least 4 "
            text += "elements along that direction (n equal ones lose (1 - restitution)/(2 n))"
            yield SceneWarning("thin", text, touch.key)


def _wide(problem: Problem, touches: Sequence[Touch]) -> Iterator[SceneWarning]:
    """Impacts of hex20 bodies whose elements at the surface are wider than long along the impact (eq:hex20-section)."""
    for touch in touches:
        if not (touch.closing > 0.0 and touch.time <= problem.end):
            continue
        axis, first = int(np.abs(touch.normal).argmax()), _first_nodes(problem, touch)
        for name, nodes in first.items():
            body = problem.bodies[name]
            if FACTS[body.mesh.element].trilinear or not nodes.size:
                continue
            hit = np.isin(body.mesh.elements, nodes).any(axis=1)
            size = np.ptp(started(problem, name)[body.mesh.elements[hit]], axis=1)
            ratio = float(np.median(np.delete(size, axis, axis=1).max(axis=1) / size[:, axis]))
            if ratio > WIDE:
                text = f'body "{name}" is of hex20, and where it hits its elements are {ratio:.2g} times as wide as they are long along {AXES[axis]}: '
                text += "their masses do not follow the loads of a plane wave, so the impact leaves vibrations and the body bounces back too slowly "
                text += "(20 elements 4 times as wide as long kept 0.91 of their speed, cubes 0.97, hex8 1.00); "
                drawn = problem.parts.bodies[name]
                own = drawn.mesh is not None or drawn.nodes is not None
                hex8 = "a mesh of hex8" if own else 'element = "hex8"'
                text += f"take {hex8}, or more elements across {AXES[axis]}"
                yield SceneWarning("wide", text, touch.key)


def _lossless(problem: Problem) -> str:
    """What an impact of elastic bodies takes: with other integrators than the leapfrog bodies may gain what contacts
    hold."""
    moves = problem.parts.time.is_leapfrog
    return "restitution 1" if moves else 'the integrator "central_difference"'


def _first_nodes(problem: Problem, touch: Touch) -> Points:
    """The nodes of each surface that hit first: the foremost ones that lie opposite the other surface,
    if there is one."""
    out: Points = {}
    for k, (name, face) in enumerate(touch.surfaces):
        mesh = problem.bodies[name].mesh
        nodes, slack = mesh.face_nodes(face), 1e-3 * mesh.shortest_edge
        x = started(problem, name)[nodes]
        if len(touch.surfaces) == 1:
            ahead, before = -touch.given.gaps(x)[0], np.ones(len(x), bool)
        else:
            other = _surface(problem, touch.surfaces[1 - k])
            inside = (x >= other.min(axis=0) - slack) & (x <= other.max(axis=0) + slack)
            ahead = (1 - 2 * k) * (x @ touch.normal)
            before = (inside | (touch.normal != 0.0)).all(axis=1)
        out[name] = nodes[(ahead >= ahead.max() - slack) & before]
    return out


def _masses(
    problem: Problem, name: str, nodes: NDArray[Any], normal: NDArray[Any]
) -> tuple[float, float]:
    """Mass of some nodes of a body, and of the whole body, along a direction; infinite if a node is fixed
    in it."""
    axis, rows = np.abs(normal).argmax(), problem.bodies[name].nodes
    # The inverse mass of a fixed node is 0.
    with np.errstate(divide="ignore"):
        mass = 1.0 / problem.rows(problem.pointer.inverse_mass)[rows, axis]
    return float(mass[nodes].sum()), float(mass.sum())


def _reduced(masses: list[float]) -> float:
    """Reduced mass of two bodies that meet, m1 m2 / (m1 + m2); the body's own mass if it meets a wall."""
    inverse = sum(1.0 / m if m else math.inf for m in masses)
    return 1.0 / inverse if inverse else math.inf
