"""From a checked scene to the C library's problem: meshes, masses, effects, stable step."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from . import effects
from . import parts as scene_parts
from ._core import ffi, lib
from .errors import Error, check, new_error, text_of
from .mesh import KINDS, WIDTH, Mesh, physical_memory, read_vtkhdf, row_length
from .projection import METHODS
from .schema import SceneError, float_array, index_array
from .surfaces import ENFORCEMENTS, INITIAL, RULES

LUMPING = {None: lib.CT_LUMP_DEFAULT, "row_sum": lib.CT_LUMP_ROW_SUM, "hrz": lib.CT_LUMP_HRZ}
LAW = {
    "linear": lib.CT_LINEAR,
    "st_venant_kirchhoff": lib.CT_ST_VENANT_KIRCHHOFF,
    "neo_hookean": lib.CT_NEO_HOOKEAN,
}
KERNEL = {
    "auto": lib.CT_KERNEL_AUTO,
    "general": lib.CT_KERNEL_GENERAL,
    "box": lib.CT_KERNEL_BOX,
    "plane": lib.CT_KERNEL_PLANE,
    "reduced": lib.CT_KERNEL_REDUCED,
}
MOST_STEPS = 10**12
# Bytes of a contact for each of its points: the point itself, its memory, its share of the faces and their search. Of an integrator for
# each node: accelerations before.
POINT_BYTES = 440
CARRIED = {lib.CT_CHUNG_LEE: 48, lib.CT_NOH_BATHE: 24, lib.CT_TCHAMWA_WIELGOSZ: 24}
# Shorter rows are numbered along x: many short pieces cost more than whole layers save.
SHORTEST_ROW = 32
# Bodies with shorter rows are not told from others (the library's ct_lattice_find).
SHORTEST_LATTICE = 8
POINT = np.dtype(
    [
        ("side", "i4"),
        ("face", "i4"),
        ("gauss", "i4"),
        ("other", "i4"),
        ("position", "f8", 3),
        ("closest", "f8", 3),
        ("xi", "f8", 2),
        ("gap", "f8"),
        ("pressure", "f8"),
        ("weight", "f8"),
        ("start_gap", "f8"),
    ],
    align=True,
)


@dataclass(frozen=True, eq=False)
class BuiltBody:
    """A body of a built problem; its nodes are the rows ``nodes`` of the problem's arrays."""

    name: str
    mesh: Mesh
    material: scene_parts.Material
    nodes: slice
    kernel: str
    flops: float
    bytes: float


@dataclass(frozen=True)
class BuiltContact:
    """A contact; ``faces`` and ``points`` count those of each side. A surface in contact with itself is its one side."""

    surfaces: tuple[str, str]
    with_itself: bool
    faces: tuple[int, ...]
    points: tuple[int, ...]
    epsilon: float


def speeds(material: scene_parts.Material) -> tuple[float, float]:
    """Speeds c₁ and c₂ of a material's waves, in the units of the scene."""
    c = ffi.new("double[2]")
    lib.ct_material_speeds(c_material(material), c, c + 1)
    return c[0], c[1]


def c_material(material: scene_parts.Material) -> Any:
    return ffi.new(
        "ct_material *",
        {
            "young": material.young,
            "poisson": material.poisson,
            "density": material.density,
            "law": LAW[material.law],
        },
    )


def memory_estimate(nodes: int, elements: int, width: int, lattice: bool = False) -> int:
    """
    Bytes that a run of bodies alone holds: 31 numbers a node (10 of the problem: coordinates, masses, first velocity; 12 of the state:
    displacement, velocity, work, force; 9 of the last good state), the places where it finds its forces, and the node numbers of the
    elements, twice, with the forces of their nodes on the way to the sum. A ``lattice`` of congruent elements needs their numbers once.
    """
    return nodes * 31 * 8 + (
        elements * width * 4 if lattice else nodes * 8 * 4 + elements * width * (2 * 4 + 3 * 8)
    )


def memory_of(problem: Problem) -> int:
    """The same for all that a built problem has, about: what is laid down for a kernel, the integrator, effects, contacts and their search."""
    total = 0
    for name, body in problem.bodies.items():
        (nodes, elements), width = (
            (len(body.mesh.nodes), len(body.mesh.elements)),
            WIDTH[body.mesh.element],
        )
        total += memory_estimate(
            nodes, elements, width, problem._is_lattice(problem.parts.bodies[name])
        )
        total += elements * 256 if body.kernel == "reduced" else 0
        # Of a body that may stiffen its frequency is watched: a direction, and a force with room of its own.
        total += nodes * 72 + elements * (24 * width + 18) if body.material.law != "linear" else 0
        total += nodes * CARRIED.get(problem.pointer.integrator.scheme, 0)
    for k in range(1, problem.pointer.effect_count):
        effect = problem.pointer.effects[k]
        # Impulse in two parts, of the state and the good one; of a force also its work, itself, and what it is put right with.
        total += (
            effect.node_count * (96 if effect.phase == lib.CT_PHASE_REACTION else 96 + 48 + 24 + 76)
            + 24 * effect.memory_count
        )
        total += 0 if effect.nodes == ffi.NULL else 4 * effect.node_count
        # The solver keeps a constraint twice, and 18 numbers to find its force.
        total += (
            effect.constraint_count * (2 * ffi.sizeof("ct_constraint") + 18 * 8)
            if effect.phase == lib.CT_PHASE_CONSTRAINT
            else 0
        )
    return total + POINT_BYTES * sum(sum(contact.points) for contact in problem.contacts)


class Problem:
    """A built problem and all that keeps it alive. Everything that does not move during a run is here."""

    step_count: int

    def __init__(
        self,
        parts: scene_parts.Parts,
        file: str | None = None,
        threads: int | None = None,
        own: Sequence[Any] = (),
        dt: float | None = None,
    ):
        """``dt``: the step to the last bit, as a run had it that is continued; None: as the scene says."""
        self.parts, self.file, self.own = parts, file, tuple(own)
        self.threads = parts.threads if threads is None else threads
        self._check_size()
        out = ffi.new("ct_scene **")
        self._call(lib.ct_scene_create, out, key="")
        self._scene = ffi.gc(out[0], lib.ct_scene_free)
        savings = ffi.new(
            "ct_savings *", {name: name in parts.savings for name in scene_parts.SAVINGS}
        )
        self._call(lib.ct_scene_set_savings, self._scene, savings, key="run.savings")
        self._add_bodies()
        self.faces = [self._add_contact(i, contact) for i, contact in enumerate(parts.contacts)]
        for i, support in enumerate(parts.supports):
            if not support.history[0]:
                self._add_support(i, support)
        self.kept: list[Any] = []
        self._add_effects(own)
        self._build(dt)
        self.bodies = {name: self._built_body(i, name) for i, name in enumerate(parts.bodies)}
        self.contacts = [
            self._built_contact(i, contact) for i, contact in enumerate(parts.contacts)
        ]
        self.effects = [
            ffi.string(self.pointer.effects[i].label).decode()
            for i in range(self.pointer.effect_count)
        ]
        self.stores = [
            self.pointer.effects[i].energy != ffi.NULL for i in range(self.pointer.effect_count)
        ]

    @property
    def dt(self) -> float:
        return self.pointer.dt

    @property
    def end(self) -> float:
        """The end of the run in the scene's units."""
        time = self.parts.time
        if time.end is not None:
            return time.end
        return time.end_over[0] * time.end_over[1] / self.fastest

    @property
    def fastest(self) -> float:
        """The fastest c₁ of all bodies: the one that ``end_c1t_over`` means."""
        return max(
            speeds(self.parts.materials[body.material])[0] for body in self.parts.bodies.values()
        )

    @property
    def settled(self) -> float:
        """When the last history of a load or a support is over."""
        histories = [support.history for support in self.parts.supports] + [
            getattr(added.given, "history", ((), ())) for added in self.parts.effects
        ]
        return max((time[-1] for time, _ in histories if time), default=0.0)

    # Errors of the C library, as the scene's keys tell them.

    def _call(self, function: Any, *arguments: Any, key: str, about: str = "") -> None:
        error = new_error()
        status = function(*arguments, error)
        if status != lib.CT_OK:
            raise self._refusal(status, error, key, about)

    def _refusal(self, status: int, error: Any, key: str, about: str = "") -> SceneError:
        text = text_of(status, error)
        names = list(self.parts.bodies)
        part = text.partition(":")[0].partition(" ")[0]
        if not key and part in ("contact", "support", "time"):
            key, text = part, text.partition(":")[2].strip() or text
        elif not about and error.code == status and 0 <= error.body < len(names):
            key = key or f"body[{error.body}]"
            about = "" if names[error.body] in text else f'body "{names[error.body]}": '
        return SceneError(about + text, key, self.file)

    # The pieces.

    def _check_size(self) -> None:
        """Refuse boxes and rings that this machine can't hold before their meshes are made."""
        need = 0
        for i, body in enumerate(self.parts.bodies.values()):
            if body.box is not None or body.ring is not None:
                x, y, z = (body.box or body.ring).cells
                nodes = (x + 1) * (y + 1) * (z + 1) * (4 if body.element == "hex20" else 1)
                need += memory_estimate(
                    nodes, x * y * z, WIDTH[body.element], self._is_lattice(body)
                )
            if need > physical_memory():
                reason = f"the run needs about {need / 1e9:.3g} GB, this machine has {physical_memory() / 1e9:.3g} GB"
                raise SceneError(
                    reason, f"body[{i}].{'box' if body.box else 'ring'}.cells", self.file
                )

    def _is_lattice(self, body: scene_parts.Body) -> bool:
        """Whether nothing is stored of the elements of a body, :eq:`lattice-ring`."""
        if (
            body.box is None
            or body.element != "hex8"
            or body.integration != "full"
            or body.kernel not in ("auto", "box", "plane")
        ):
            return False
        linear = self.parts.materials[body.material].law == "linear"
        return "congruent" in self.parts.savings and linear and self.has_rows(body)

    def has_rows(self, body: scene_parts.Body) -> bool:
        """Whether a body is a box whose rows are long enough to be taken for those of a lattice."""
        return body.box is not None and row_length(body.box, self.layers(body)) >= SHORTEST_LATTICE

    def layers(self, body: scene_parts.Body) -> str:
        """
        The axis that layers of a box follow one another along. Unless the scene says it, it goes from the faces that something presses on into the body, so that a wave comes to layer
        after layer; ``"z"`` where there are no such faces, or several, or where rows would be short.
        """
        if body.box.layers is not None:
            return body.box.layers
        pressed = [surface for contact in self.parts.contacts for surface in contact.surfaces]
        pressed += [
            added.given.surface
            for added in self.parts.effects
            if added.name in ("obstacle", "load")
        ]
        axes = {face[0] for name, face in pressed if name == body.name}
        axis = axes.pop() if len(axes) == 1 else "z"
        if axis not in ("x", "y"):
            return "z"
        return axis if row_length(body.box, axis) >= SHORTEST_ROW else "z"

    def _mesh(self, i: int, body: scene_parts.Body) -> Mesh:
        key = f"body[{i}]." + (
            "box" if body.box else "ring" if body.ring else "mesh" if body.mesh else "elements"
        )
        about = f'body "{body.name}": '
        if body.box is not None:
            box = body.box
            return self._checked(
                lambda: Mesh.box(body.element, box.origin, box.size, box.cells, self.layers(body)),
                key,
                about,
            )
        if body.ring is not None:
            return self._checked(lambda: Mesh.ring(body.element, body.ring), key, about)
        nodes, elements = (body.nodes, body.elements) if body.mesh is None else self._read(i, body)
        unused = np.flatnonzero(np.bincount(elements.ravel(), minlength=len(nodes)) == 0)
        if unused.size:
            raise SceneError(
                f"{about}node {unused[0]} belongs to no element, so it would have no mass",
                key,
                self.file,
            )
        return self._checked(lambda: Mesh.copy(nodes, elements), key, about)

    def _read(self, i: int, body: scene_parts.Body) -> tuple[np.ndarray, np.ndarray]:
        path = Path(self.file).parent / body.mesh if self.file else Path(body.mesh)
        try:
            nodes, elements = read_vtkhdf(path)
            nodes = float_array(nodes, 3)
            elements = index_array(elements, (8, 20), len(nodes))
        except (Error, ValueError) as error:
            raise SceneError(f'body "{body.name}": {error}', f"body[{i}].mesh", self.file) from None
        found = "hex8" if elements.shape[1] == 8 else "hex20"
        if body.element not in (None, found):
            raise SceneError(
                f'is "{body.element}", but "{path}" holds {found}', f"body[{i}].element", self.file
            )
        if found == "hex20" and (
            body.lumping == "row_sum" or body.kernel == "plane" or body.integration == "reduced"
        ):
            key = (
                "lumping"
                if body.lumping == "row_sum"
                else "integration"
                if body.integration == "reduced"
                else "kernel"
            )
            raise SceneError(
                f'"{getattr(body, key)}" is for hex8, and "{path}" holds hex20',
                f"body[{i}].{key}",
                self.file,
            )
        return nodes, elements

    def _checked(self, make: Any, key: str, about: str) -> Mesh:
        try:
            return make()
        except (Error, ValueError, MemoryError, OverflowError) as error:
            raise SceneError(f"{about}{error}", key, self.file) from None

    def _add_bodies(self) -> None:
        self._meshes = {}
        number = ffi.new("int32_t *")
        for i, body in enumerate(self.parts.bodies.values()):
            mesh = self._mesh(i, body)
            material = c_material(self.parts.materials[body.material])
            c1 = speeds(self.parts.materials[body.material])[0]
            if not (math.isfinite(c1) and c1 > 0.0):
                raise SceneError(
                    f'material "{body.material}" has the wave speed {c1:g}',
                    f"body[{i}].material",
                    self.file,
                )
            self._call(
                lib.ct_scene_add_body,
                self._scene,
                body.name.encode(),
                mesh.pointer,
                material,
                LUMPING[body.lumping],
                KERNEL["reduced" if body.integration == "reduced" else body.kernel],
                list(body.velocity),
                number,
                key=f"body[{i}]",
                about=f'body "{body.name}": ',
            )
            if body.hourglass is not None:
                self._call(
                    lib.ct_scene_set_hourglass,
                    self._scene,
                    number[0],
                    body.hourglass,
                    key=f"body[{i}].hourglass",
                )
            if body.spin is not None:
                velocity = _spinning(body, mesh)
                self._call(
                    lib.ct_scene_set_velocity,
                    self._scene,
                    number[0],
                    ffi.from_buffer("double[]", velocity),
                    key=f"body[{i}].spin",
                )
            self._meshes[body.name] = mesh

    def _add_contact(self, i: int, contact: scene_parts.Contact) -> list[np.ndarray]:
        numbers = {name: n for n, name in enumerate(self.parts.bodies)}
        faces = []
        for j, (body, face) in enumerate(contact.surfaces):
            faces.append(self._meshes[body].faces(face)[0])
            if not len(faces[j]):
                raise SceneError(
                    f'"{body}.{face}" has no faces: no outer face of the body lies in that plane',
                    f"contact[{i}].surfaces[{j}]",
                    self.file,
                )
        if contact.with_itself:
            faces = [_together(*faces)] * 2
        new = ffi.new(
            "ct_scene_contact *",
            {
                "beta": contact.beta or 0.0,
                "friction": contact.friction,
                "tangent": contact.tangent,
                "options": lib.ct_contact_options_default(),
            },
        )
        for side, (body, _), table in zip("ab", contact.surfaces, faces):
            setattr(new, f"body_{side}", numbers[body])
            setattr(new, f"face_count_{side}", len(table))
            setattr(new, f"faces_{side}", ffi.from_buffer("int32_t[]", table))
        new.options.epsilon = contact.epsilon or 0.0
        new.options.method = METHODS[contact.method]
        new.options.threads = self.threads
        new.options.enforcement = ENFORCEMENTS[contact.enforcement]
        new.options.dissipation = contact.dissipation
        new.options.points = RULES[contact.points]
        new.options.initial = INITIAL[contact.initial_penetration]
        new.options.removal = contact.removal_time
        new.options.adjust = contact.adjust
        if contact.tolerance is not None:
            new.options.tolerance = contact.tolerance
        if contact.depth is not None:
            new.options.depth = contact.depth
        self._call(lib.ct_scene_add_contact, self._scene, new, key=f"contact[{i}]")
        return faces[:1] if contact.with_itself else faces

    def _add_support(self, i: int, support: scene_parts.Support) -> None:
        nodes = self._meshes[support.body].face_nodes(support.face)
        if not nodes.size:
            raise SceneError(
                f'"{support.body}.{support.face}" has no nodes', f"support[{i}].set", self.file
            )
        new = ffi.new(
            "ct_scene_support *",
            {
                "body": list(self.parts.bodies).index(support.body),
                "nodes": ffi.from_buffer("int32_t[]", nodes),
                "node_count": len(nodes),
                "fixed": [axis in support.fix for axis in "xyz"],
                "velocity": list(support.velocity),
            },
        )
        self._call(lib.ct_scene_add_support, self._scene, new, key=f"support[{i}]")

    def _add_effects(self, own: Sequence[Any]) -> None:
        """The effects beside contacts and supports, which are made for the joined bodies: those of the scene's tables, then those of the user's ``own``."""
        paths = {
            f"support[{i}]": support
            for i, support in enumerate(self.parts.supports)
            if support.history[0]
        }
        if not self.parts.effects and not own and not paths:
            return
        joined = ffi.new("const ct_problem **")
        self._call(lib.ct_scene_join, self._scene, joined, key="")
        calls = [(added.key, added.module.create, added.given) for added in self.parts.effects]
        calls += [
            (effect.name, lambda given, maker: given.create(maker), effect) for effect in own
        ] + ([(next(iter(paths)), _motion, paths)] if paths else [])
        made = []
        for key, create, given in calls:
            new = create(given, Maker(self, joined[0], key))
            made += [
                (key, ffi.gc(effect, lib.ct_effect_free))
                for effect in (new if isinstance(new, list) else [new])
            ]
        for key, effect in made:
            ffi.gc(effect, None)  # the scene takes it over, whatever it answers
            self._call(lib.ct_scene_add_effect, self._scene, effect, key=key)

    def _build(self, dt: float | None) -> None:
        name, value = self.parts.time.step if dt is None else ("dt", dt)
        end = self.end
        if not (math.isfinite(end) and end > 0.0):
            raise SceneError(f"the end of the run is {end:g}", "time", self.file)
        integrator = (
            scene_parts.INTEGRATORS.index(self.parts.time.integrator),
            self.parts.time.parameter,
        )
        time = ffi.new(
            "ct_scene_time *",
            {
                "end": end,
                name: value,
                "keep_dt": dt is not None,
                "integrator": integrator,
                "assembled": self.parts.time.stable_step == "assembled",
                "threads": self.threads,
                "clock": ffi.addressof(lib, "wall_clock"),
            },
        )
        problem, count, self.stable = (
            ffi.new("const ct_problem **"),
            ffi.new("int64_t *"),
            ffi.new("ct_stable_step *"),
        )
        error = new_error()
        status = lib.ct_scene_build(self._scene, time, problem, count, self.stable, error)
        if status != lib.CT_OK:
            key = f"time.{name}" if status == lib.CT_ERROR_STEP else ""
            raise self._refusal(status, error, key)
        if not 1 <= count[0] <= MOST_STEPS:
            raise SceneError(
                f"asks for {count[0]} steps; at most {MOST_STEPS:g} are taken",
                f"time.{name}",
                self.file,
            )
        self.pointer, self.step_count = problem[0], count[0]
        self._meshes = {}

    def _built_body(self, i: int, name: str) -> BuiltBody:
        body = self.pointer.bodies[i]
        kernel, cost = ffi.new("ct_solid_kernel *"), ffi.new("double[2]")
        lib.ct_solid_block_plan(self.pointer.effects[0], i, kernel, cost, cost + 1)
        chosen = next(word for word, value in KERNEL.items() if value == kernel[0])
        rows = slice(body.first_node, body.first_node + body.mesh.node_count)
        material = self.parts.materials[self.parts.bodies[name].material]
        return BuiltBody(
            name, Mesh(body.mesh, self._scene), material, rows, chosen, cost[0], cost[1]
        )

    def _built_contact(self, i: int, contact: scene_parts.Contact) -> BuiltContact:
        epsilon = ffi.new("double *")
        lib.ct_scene_contact_epsilon(self._scene, i, epsilon)
        rule = ffi.new("ct_rule *")
        points = []
        for (body, _), faces in zip(contact.surfaces, self.faces[i]):
            lib.ct_rule_face(lib.ct_brick_face_kind(KINDS[self.bodies[body].mesh.element]), 0, rule)
            points.append(len(faces) * rule.count)
        names = tuple(".".join(surface) for surface in contact.surfaces)
        return BuiltContact(
            names,
            contact.with_itself,
            tuple(len(faces) for faces in self.faces[i]),
            tuple(points),
            epsilon[0],
        )


class Maker:
    """
    What a module of ``libcontact.effects`` needs to make its effect: the joined ``problem`` (``const ct_problem *``), whose nodes are those of all
    bodies one after another, and the scene's ``parts``.
    """

    def __init__(self, built: Problem, joined: Any, key: str):
        self.problem, self.parts, self.key = joined, built.parts, key
        self._built = built

    def keep(self, value: Any) -> Any:
        """Keep something alive as long as the problem."""
        self._built.kept.append(value)
        return value

    def error(self, reason: str, key: str = "") -> SceneError:
        return SceneError(reason, f"{self.key}.{key}" if key else self.key, self._built.file)

    def make(self, function: Any, options: Any) -> Any:
        """The effect that a ``ct_..._create_effect`` makes of its options."""
        out = ffi.new("ct_effect **")
        if any(name == "cookie" for name, _ in ffi.typeof(options).item.fields):
            options.cookie = lib.ct_gravity_def_default().cookie  # the same for all definitions
        self._built._call(function, options, self.problem, out, key=self.key)
        return out[0]

    def body(self, name: str) -> Any:
        """The ``ct_body`` of a name."""
        return self.problem.bodies[list(self.parts.bodies).index(name)]

    def body_nodes(self, name: str) -> np.ndarray:
        """Numbers of all nodes of a body in the problem (int32)."""
        body = self.body(name)
        return np.arange(body.first_node, body.first_node + body.mesh.node_count, dtype=np.int32)

    def face_nodes(self, surface: tuple[str, str]) -> np.ndarray:
        """Numbers of the nodes of a surface (body, face) in the problem, ascending (int32); none is an error."""
        nodes = self._built._meshes[surface[0]].face_nodes(surface[1])
        return self._on_surface(nodes, surface)

    def faces(self, surface: tuple[str, str]) -> tuple[int, np.ndarray]:
        """Kind (``CT_Q4``, ``CT_Q8``) and node numbers (faces, 4 or 8) of a surface (body, face) in the problem; none is an error."""
        mesh = self._built._meshes[surface[0]]
        return lib.ct_brick_face_kind(KINDS[mesh.element]), self._on_surface(
            mesh.faces(surface[1])[0], surface
        )

    def _on_surface(self, numbers: np.ndarray, surface: tuple[str, str]) -> np.ndarray:
        if not len(numbers):
            raise self.error(
                f'"{".".join(surface)}" has no faces: no outer face of the body lies in that plane'
            )
        return np.ascontiguousarray(numbers + self.body(surface[0]).first_node, dtype=np.int32)


def _motion(paths: dict[str, scene_parts.Support], maker: Maker) -> Any:
    """The effect of all supports on a path."""
    motions = maker.keep(ffi.new("ct_motion[]", len(paths)))
    for motion, support in zip(motions, paths.values()):
        nodes = maker.keep(maker.face_nodes((support.body, support.face)))
        motion.nodes, motion.node_count = ffi.from_buffer("int32_t[]", nodes), len(nodes)
        motion.fixed, motion.displacement = (
            [axis in support.fix for axis in "xyz"],
            list(support.travel),
        )
        motion.history = effects.load.c_history(support.history, maker)
    definition = ffi.new("ct_motion_def *", {"motions": motions, "motion_count": len(paths)})
    return maker.make(lib.ct_motion_create_effect, definition)


def _together(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """The faces of two surfaces of one body as one surface: those of the first, then those of the second that it does not have."""
    both = np.concatenate([first, second])
    _, places = np.unique(both, axis=0, return_index=True)
    return np.ascontiguousarray(both[np.sort(places)])


def _contacts(problem: Problem, state: Any) -> Iterator[Any]:
    """The contacts of the problem (``const ct_contact *``) in a state (``ct_state *``)."""
    for k in range(len(problem.effects)):
        if problem.pointer.effects[k].kind == lib.CT_EFFECT_CONTACT:
            error = new_error()
            contact = lib.ct_state_contact(problem.pointer, state, k, error)
            if contact == ffi.NULL:
                check(error.code, error)
            yield contact


def contact_points(problem: Problem, state: Any) -> list[np.ndarray]:
    """The points of each contact of the problem in a state (``ct_state *``)."""
    out = []
    for contact in _contacts(problem, state):
        points = np.zeros(lib.ct_contact_point_count(contact), POINT)
        check(lib.ct_contact_points(contact, ffi.cast("ct_contact_point *", points.ctypes.data)))
        out.append(points)
    return out


def penetrations(problem: Problem, state: Any) -> list[dict[str, dict[str, Any]]]:
    """How far the surfaces of each contact are inside each other in a state (``ct_state *``); see ``Run.penetration``."""
    out: list[dict[str, dict[str, Any]]] = []
    for built, contact in zip(problem.contacts, _contacts(problem, state)):
        places = (
            {"points": lib.CT_AT_POINTS}
            if built.with_itself
            else {
                "points": lib.CT_AT_POINTS,
                "corners": lib.CT_AT_CORNERS,
                "edges": lib.CT_AT_EDGES,
            }
        )
        found, table = ffi.new("ct_penetration *"), {}
        for place, at in places.items():
            check(lib.ct_contact_penetration(contact, at, found))
            table[place] = {
                "inside": found.inside,
                "buried": found.buried,
                "deepest": found.deepest,
                "surface": built.surfaces[found.side] if found.side >= 0 else None,
                "face": found.face,
                "position": tuple(found.position),
                "touching": found.touching,
            }
        out.append(table)
    return out


def new_state(problem: Problem) -> Any:
    """A state of the problem at t = 0; where that has numbers that are none, the scene is at fault."""
    out, error = ffi.new("ct_state **"), new_error()
    try:
        check(lib.ct_state_create(problem.pointer, out, error), error)
    except Error as reason:
        raise SceneError(str(reason), "", problem.file) from None
    # Freeing a state asks the problem's effects, so the state keeps the problem alive.
    return ffi.gc(out[0], lambda state, free=lib.ct_state_free, problem=problem: free(state))


def _spinning(body: scene_parts.Body, mesh: Mesh) -> np.ndarray:
    """Velocity of each node of a body that flies and turns, v + ω × (X - centre)."""
    low, high = mesh.bounds
    centre = 0.5 * (low + high) if body.spin.centre is None else np.array(body.spin.centre)
    axis = np.array(body.spin.axis)
    omega = body.spin.rate / math.hypot(*axis) * axis
    return np.ascontiguousarray(np.array(body.velocity) + np.cross(omega, mesh.nodes - centre))
