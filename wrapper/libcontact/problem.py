"""From a checked scene to the C library's problem: meshes, masses, effects, stable step."""

from __future__ import annotations

import gc
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import Floats, Ints, ask, call, doubles, ints, names, point_rows, table
from .contact import PLACES, depths
from .errors import Error, check, new_error, text_of
from .mesh import (
    FACTS,
    KINDS,
    NO_SETS,
    WIDTH,
    Mesh,
    c_box,
    c_mesh,
    mesh_of,
    physical_memory,
    row_length,
)
from .meshes import MeshFile
from .model import AXES, KERNELS, OPTIMISATIONS, Body, Contact, History, Material, Support, speeds
from .parts import Parts, acts_on
from .probes import Located, locate
from .problem_part import Part, PartBody, PartMesh
from .schema import FACES, SceneError, Table, listed, nearest, suggestion, word
from .sets import KINDS as SET_KINDS
from .sets import Sets
from .surfaces import pair_name

MOST_STEPS = 10**12
# With shorter rows the layers follow one another along z: many short rows cost more than layers save.
SHORTEST_ROW = 32
# The library treats bodies with shorter rows as general ones (ct_force_ring_create).
SHORTEST_LATTICE = 8
NODE = np.dtype(
    [
        ("side", "i4"),
        ("body", "i4"),
        ("node", "i4"),
        ("position", "f8", 3),
        ("area", "f8"),
        ("traction", "f8", 3),
        ("pressure", "f8"),
        ("friction", "f8", 3),
        ("slip", "i4"),
    ]
)


@dataclass(frozen=True, eq=False)
class BuiltBody:
    """A body of a built problem; its nodes are the rows ``nodes`` of the problem's arrays. Of several materials
    ``material`` is the one with the largest c₁, and ``by_material`` has the elements of each."""

    name: str
    mesh: Mesh
    material: Material
    nodes: slice
    kernel: str
    flops: float
    bytes: float
    by_material: tuple[tuple[Material, NDArray[np.int64]], ...] = ()

    @property
    def materials(self) -> tuple[Material, ...]:
        """Its materials, each once."""
        return tuple(given for given, _ in self.by_material) or (self.material,)


class Arrays(NamedTuple):
    """Nodes and elements of a mesh that C copies."""

    nodes: Floats
    elements: Ints


@dataclass(frozen=True)
class BuiltContact:
    """A contact; ``faces`` and ``gauss_points`` are the counts of each side. A surface in contact with
    itself is the only side."""

    surfaces: tuple[str, str]
    with_itself: bool
    faces: tuple[int, ...]
    gauss_points: tuple[int, ...]
    epsilon: float


def memory_estimate(nodes: int, elements: int, width: int, lattice: bool = False) -> int:
    """
    Estimate the memory of a run of bodies without other effects [bytes].

    There are 31 numbers per node: 10 of the problem (coordinates, masses, initial velocity), 12 of the
    state (displacement, velocity, work, force), 9 of the last good state. Each element has its node
    numbers and the forces on its nodes, and each node a list of the forces to add. A ``lattice``, a
    body of equal elements numbered in rows, stores only node numbers and runs of nodes.
    """
    forces = nodes * 8 if lattice else nodes * 8 * 4 + elements * width * 3 * 8
    return nodes * 31 * 8 + elements * width * 4 + forces


class Held:
    """Counts the bytes that the library allocates within the block and does not free. Python's collector,
    which may free other objects, waits."""

    def __enter__(self) -> Held:
        self.bytes, self._collects = -lib.bytes_held(), gc.isenabled()
        gc.disable()
        return self

    def __exit__(self, *_: object) -> None:
        self.bytes += lib.bytes_held()
        if self._collects:
            gc.enable()


def memory_of(problem: Problem, grown: int = 0) -> int:
    """
    Memory of a run [bytes]: of the problem and its state, and ``grown`` bytes that a run adds to them.

    The capacity for rows of probes may be twice their number, and a scene holds the arrays of its own
    meshes twice: in its tables and as it has read them.
    """
    rows = sum(2 * problem.step_count // p.given.every * p.row_bytes for p in problem.probes)
    own = sum(
        problem.bodies[name].mesh.nodes.nbytes + 2 * problem.bodies[name].mesh.elements.nbytes
        for name, given in problem.parts.bodies.items()
        if given.elements is not None
    )
    return int(problem.held + grown + rows + own)


class Problem:
    """A built problem and the objects that keep it alive. It contains everything that is constant
    during a run."""

    step_count: int

    def __init__(
        self,
        parts: Parts,
        file: str | None = None,
        threads: int | None = None,
        own: Sequence[Any] = (),
        dt: float | None = None,
        checked: bool = True,
        part: Part | None = None,
    ):
        """``dt``: the step to the last bit, as a run had it that is continued; None: as the scene says. If the
        step is not to be ``checked`` there is no first state. ``part``: what this process has of the bodies; None:
        all."""
        self.parts, self.file, self.own = parts, file, tuple(own)
        self.part = part
        # Names of the surfaces of each body that were asked for: of faces, and of nodes.
        self.asked: dict[tuple[str, bool], dict[str, None]] = {}
        self.threads = parts.run.threads if threads is None else threads
        if part is None:
            self._check_size()
        with Held() as held:
            self._make(dt, checked)
        # Of the problem and its first state [bytes].
        self.held = held.bytes
        self.part = part and part.light()

    def _make(self, dt: float | None, checked: bool) -> None:
        out = ffi.new("ct_scene **")
        self._call("", lib.ct_scene_create, out)
        self._scene = ffi.gc(out[0], lib.ct_scene_free)
        clock = ffi.addressof(lib, "wall_clock")
        settings = ffi.new("ct_run_settings *", {"threads": self.threads, "clock": clock})
        self._call("run.threads", lib.ct_scene_set_run_settings, self._scene, settings)
        savings = {member: key in self.parts.run.savings for key, member in OPTIMISATIONS.items()}
        chosen = ffi.new("ct_optimisations *", savings)
        self._call("run.savings", lib.ct_scene_set_optimisations, self._scene, chosen)
        self._add_bodies()
        self.faces = [self._add_contact(i, contact) for i, contact in enumerate(self.parts.contact)]
        for i, support in enumerate(self.parts.support):
            if not support.history:
                self._add_support(i, support)
        self.kept: list[Any] = []
        self._add_effects()
        self._build(dt, checked)
        self.bodies = {name: self._built_body(i, name) for i, name in enumerate(self.parts.bodies)}
        self.contacts = [self._built_contact(*each) for each in enumerate(self.parts.contact)]
        self.made = [self.pointer.effects[i] for i in range(self.pointer.effect_count)]
        self.effects = [ffi.string(effect.label).decode() for effect in self.made]
        self.stores = [effect.calls.energy != ffi.NULL for effect in self.made]
        self.probes = self._located()

    @property
    def dt(self) -> float:
        """The time step."""
        return float(self.pointer.dt)

    @property
    def end(self) -> float:
        """The end of the run in the scene's units; ``end_c1t_over`` means the fastest c₁ of all bodies."""
        time, over = self.parts.time, self.parts.time.end_c1t_over
        if time.end is not None:
            return float(time.end)
        fastest = max(speeds(self.parts.materials[each])[0] for each in self._used())
        return float(over.length * over.value / fastest)

    def _used(self) -> set[str]:
        """Names of the materials that bodies have."""
        return {name for body in self.parts.body for name in body.material_names}

    @property
    def settled(self) -> float:
        """When the last history of a load or a support is over."""
        return max((history.time[-1] for history in self.parts.histories()), default=0.0)

    def rows(self, pointer: Any) -> NDArray[np.float64]:
        """Three numbers of each node (n, 3) in the memory of C, to be read or changed there."""
        return np.frombuffer(ffi.buffer(pointer, 24 * self.pointer.node_count)).reshape(-1, 3)

    # Errors of the C library, as the scene's keys tell them.

    def _error(self, reason: str, key: str) -> SceneError:
        return SceneError(reason, key, self.file)

    def _call(self, key: str, function: Any, *arguments: Any, about: str = "") -> None:
        """Call a function of the library that creates the object of a key; without a key, the error
        names its object."""
        error = new_error()
        status = function(*arguments, error)
        if status == lib.CT_OK:
            return
        text = text_of(status, error)
        if status == lib.CT_ERROR_STEP:
            key = f"time.{self.parts.time.step[0]}"
        elif not key and error.part != lib.CT_PART_NONE:
            table = word(names("ct_scene_part"), error.part)
            key, text = self._key_of(table, error.number), text.removeprefix(f"{table}: ")
        elif not about and 0 <= error.body < len(self.parts.bodies):
            key = key or f"body[{error.body}]"
            about = f'body "{list(self.parts.bodies)[error.body]}": '
        raise self._error(about + text, key)

    def _key_of(self, table: str, number: int) -> str:
        """The key of a part that has this number in the library, whose supports are those without a path."""
        held = [i for i, support in enumerate(self.parts.support) if not support.history]
        numbers = {"contact": range(len(self.parts.contact)), "support": held}
        return f"{table}[{numbers[table][number]}]" if table in numbers else table

    def _located(self) -> list[Located]:
        """The probes of the scene."""
        if self.part is None:
            return locate(self)
        return [Located(given, *each) for given, each in zip(self.parts.probe, self.part.probes)]

    # The pieces.

    def _check_size(self) -> None:
        """Raise an error for meshes of the library that exceed the memory of this machine, before their
        meshes are created."""
        need = 0
        for i, body in enumerate(self.parts.bodies.values()):
            if body.shape:
                elements, corners = body.lattice.counts()
                nodes = corners * FACTS[str(body.bricks)].cell_nodes
                width = WIDTH[str(body.bricks)]
                need += memory_estimate(nodes, elements, width, self._is_lattice(body))
            if need > physical_memory():
                there = f"this machine has {physical_memory() / 1e9:.3g} GB"
                key = f"body[{i}].{body.shape}.cells"
                raise self._error(f"the run needs about {need / 1e9:.3g} GB, {there}", key)

    def _is_lattice(self, body: Body) -> bool:
        """Whether the library stores no element forces of a box, :eq:`lattice-ring`."""
        return (
            "congruent" in self.parts.run.savings
            and body.box is not None
            and body.place is None
            and body.box.equal
            and self.parts.materials_of(body)[0].law == "linear"
            and FACTS[str(body.bricks)].trilinear
            and row_length(body.box, self.layers(body)) >= SHORTEST_LATTICE
        )

    def layers(self, body: Body) -> str:
        """
        The axis along which layers of a box follow one another.

        By default it is normal to the faces with a contact, an obstacle or a load, so that a wave
        reaches layer after layer. It is ``"z"`` if there are no such faces, if they have several
        axes, or if rows would be short.
        """
        if body.box.layers is not None:
            return str(body.box.layers)
        parts = self.parts
        pressed = [surface for contact in parts.contact for surface in contact.surfaces]
        pressed += [each.surface for each in (*parts.obstacle, *parts.load)]
        axes = {face[0] for name, face in pressed if name == body.name}
        axis = axes.pop() if len(axes) == 1 else "z"
        if axis not in ("x", "y"):
            return "z"
        return axis if row_length(body.box, axis) >= SHORTEST_ROW else "z"

    def _shape(
        self, body: Body, key: str
    ) -> tuple[dict[str, Any], Mesh | Arrays | PartBody | None]:
        """The mesh members of a ``ct_scene_body``, and the object that keeps them alive. The scene itself
        meshes a box without spin."""
        if self.part is not None:
            piece = self.part.bodies[body.name]
            return {"mesh": c_mesh(piece.nodes, piece.elements)}, piece
        if body.shape is None:
            arrays = self._placed(body, self._arrays(body, key))
            return {"mesh": c_mesh(*arrays)}, arrays
        kind = KINDS[str(body.bricks)]
        if body.box is None:
            mesh = mesh_of(body.shape, body.lattice, str(body.bricks))
            members: dict[str, Any] = {"mesh": mesh.pointer}
        else:
            box = c_box(body.box, self.layers(body))
            members = {"kind": kind, "box": box[0]}
            if not (body.spin or body.place or (body.initial and body.initial.displaces)):
                return members, None
            mesh = Mesh(ask("ct_mesh **", lib.ct_mesh_create_box, kind, box))
        if body.place is None:
            return members, mesh
        arrays = self._placed(body, mesh)
        return {"mesh": c_mesh(*arrays)}, arrays

    def _placed(self, body: Body, mesh: Any) -> Any:
        """A mesh with its nodes where the body stands; the one that was given keeps the names of the sides."""
        if body.place is None:
            return mesh
        self._unplaced[body.name] = Mesh.copy(mesh.nodes, mesh.elements)
        return Arrays(body.place.of(mesh.nodes), mesh.elements)

    def _from_file(self, body: Body, key: str) -> tuple[Body, Sets]:
        """A body with the arrays of its mesh file, checked against the other keys, and the sets of the file."""
        path = Path(self.file).parent / body.mesh if self.file else Path(body.mesh)
        plane, extrude = None, body.extrude
        if extrude is not None:  # in the units of the file
            plane = (extrude.height / body.scale, extrude.layers)
        file = self._files.setdefault(path, MeshFile(path))
        found = file.bricks(body.part, body.scale, plane)
        if body.initial is None or not body.initial.displaces:
            file.take(body.name, found.cells, (body.scale, body.place))
        body = replace(body, mesh=None, nodes=found.nodes, elements=found.elements)
        for name, reason in body.refusals():
            raise self._error(f'{reason}, in "{path}"', f"{key.rpartition('.')[0]}.{name}")
        given = (found.node_sets, found.face_sets, found.element_sets)
        counts = len(body.nodes), len(body.elements)
        return body, Sets.of_file(dict(zip(SET_KINDS, given)), *counts, found.outside)

    def _arrays(self, body: Body, key: str) -> Arrays:
        """Nodes and elements of a body, from the scene or its mesh file, and its sets."""
        if body.inertia:
            return Arrays(body.inertia.nodes, np.arange(8, dtype=np.int32)[None])
        if body.mesh is not None:
            body, self._sets[body.name] = self._from_file(body, key)
        else:
            self._sets[body.name] = body.mesh_sets or NO_SETS
        unused = np.flatnonzero(np.bincount(body.elements.ravel(), minlength=len(body.nodes)) == 0)
        if unused.size:
            raise ValueError(f"node {unused[0]} belongs to no element, so it would have no mass")
        return Arrays(body.nodes, body.elements)

    def _add_bodies(self) -> None:
        """Add all bodies and join them. From then on the C scene holds their meshes."""
        self._sets: dict[str, Sets] = dict.fromkeys(self.parts.bodies, NO_SETS)
        self._files: dict[Path, MeshFile] = {}
        # The meshes of bodies with a place, before they were put there.
        self._unplaced: dict[str, Mesh] = {}
        # The number of each element's material, of bodies with several.
        self.material_at: dict[str, Ints] = {}
        for i, body in enumerate(self.parts.bodies.values()):
            for given in self.parts.materials_of(body):
                c1 = speeds(given)[0]
                if not (math.isfinite(c1) and c1 > 0.0):
                    reason = f'material "{given.name}" has the wave speed {c1:g}'
                    raise self._error(reason, f"body[{i}].material")
            self._add_body(i, body)
        self._files.clear()
        joined = ffi.new("const ct_problem **")
        self._call("", lib.ct_scene_join, self._scene, joined)
        self.joined = joined[0]
        self._meshes = {name: self._mesh(i, name) for i, name in enumerate(self._sets)}

    def _mesh(self, i: int, name: str) -> Mesh:
        """The mesh of a joined body."""
        pointer = self.joined.bodies[i].mesh
        if self.part is not None:
            return PartMesh(pointer, self._scene, self.part.bodies[name])
        return Mesh(pointer, self._scene, self._sets[name], self._unplaced.get(name))

    def _add_body(self, i: int, body: Body) -> None:
        """Add a body. An error of its mesh names the key that gives the mesh."""
        key = next(name for name in Body.one[0] if getattr(body, name) is not None)
        key, about = f"body[{i}].{key}", f'body "{body.name}"{self._file_of(body.name)}: '
        try:
            shape, held = self._shape(body, key)
        except SceneError:
            raise
        except (Error, ValueError, MemoryError, OverflowError) as error:
            raise self._error(f"{about}{error}", key) from None
        name = ffi.new("char[]", body.name.encode())
        members = body.c("ct_scene_body", name=name, **shape)
        members["material"] = self.parts.materials_of(body)[0].c("ct_material")
        if body.inertia:
            members["material"]["density"] = body.inertia.density
        if isinstance(body.material, dict):
            members["materials"] = self._by_element(i, body, members["mesh"].element_count)
        if isinstance(held, PartBody) and body.name not in self.parts.rigid_names:
            members["kernel"] = held.kernel
        if body.integration == "reduced":
            members["kernel"] = lib.CT_KERNEL_REDUCED
        damping = self.parts.damping
        if damping is not None and damping.stiffness and acts_on(damping, body.name):
            members["stiffness_damping"] = damping.stiffness
        if body.initial is not None and body.initial.stress is not None:
            members["initial_stress"] = body.initial.stress
        if held is not None:
            members |= self._motion(i, body, held.nodes)
        new = ffi.new("ct_scene_body *", members)
        self._call(key, lib.ct_scene_add_body, self._scene, new, ffi.NULL, about=about)

    def _motion(self, i: int, body: Body, nodes: Floats) -> dict[str, Any]:
        """The displacement and the velocity of each node at the start, as members of a ``ct_scene_body``."""
        out = dict[str, Any]()
        if self.part is not None:
            piece = self.part.bodies[body.name]
            both = {"velocities": piece.velocities, "displacements": piece.displacements}
            return {k: ffi.from_buffer("double[]", v) for k, v in both.items() if v is not None}
        shift = None if body.initial is None else body.initial.at(nodes)
        if shift is not None:
            if shift.shape != nodes.shape:
                reason = f"has {len(shift)} rows, and the body has {len(nodes)} nodes"
                raise self._error(reason, f"body[{i}].initial.displacements")
            out["displacements"] = ffi.from_buffer("double[]", shift)
            nodes = nodes + shift
        if body.spin is not None:
            out["velocities"] = ffi.from_buffer("double[]", _spinning(body, nodes))
        return out

    def _by_element(self, i: int, body: Body, count: int) -> Any:
        """The material of each element (``ct_material[]``) of a body with several."""
        if self.part is None:
            at = self._numbered_materials(i, body, count)
        else:
            at = self.part.bodies[body.name].material_at
        self.material_at[body.name] = at
        rows, _ = table("ct_material", len(body.material_names))
        for k, given in enumerate(self.parts.materials_of(body)):
            for member, value in given.c("ct_material").items():
                rows[member][k] = value
        return ffi.from_buffer("ct_material[]", rows[at])

    def _numbered_materials(self, i: int, body: Body, count: int) -> Ints:
        """The number of each element's material; each element must be in one of the sets."""
        names, sets = body.material_names, self._sets[body.name].elements
        at, of = np.full(count, -1, np.int32), dict[int, str]()
        for k, (name, material) in enumerate(body.material.items()):
            key = f"body[{i}].material.{name}"
            where = f'body "{body.name}"{self._file_of(body.name)}'
            if name not in sets:
                near = suggestion(name, nearest(name, sets), "its sets of elements are ")
                raise self._error(f'{where} has no set of elements "{name}"{near}', key)
            twice = sets[name][at[sets[name]] >= 0]
            if twice.size:
                other = of[int(at[twice[0]])]
                text = f'element {twice[0]} of {where} is in the sets "{other}" and "{name}"'
                raise self._error(f"{text}; each element has one material", key)
            at[sets[name]], of[k] = k, name
        left = np.flatnonzero(at < 0)
        if left.size:
            text = f'element {left[0]} of body "{body.name}"{self._file_of(body.name)} is in none of the sets'
            text = f"{text} {listed(body.material, 'and')}, so it has no material ({left.size} such elements)"
            raise self._error(text, f"body[{i}].material")
        number = [names.index(str(material)) for material in body.material.values()]
        return np.array(number, np.int32)[at]

    def materials_behind(self, surface: tuple[str, str]) -> tuple[Material, ...]:
        """The materials of the elements behind a surface."""
        body, face = surface
        all_of, at = self.parts.materials_of(self.parts.bodies[body]), self.material_at.get(body)
        if at is None:
            return all_of
        return tuple(all_of[k] for k in np.unique(at[self._meshes[body].faces(face)[1]]))

    def _add_contact(self, i: int, contact: Contact) -> list[NDArray[Any]]:
        numbers = {name: n for n, name in enumerate(self.parts.bodies)}
        places = [f"contact[{i}].surfaces[{j}]" for j in (0, 1)]
        faces = [self.on(surface, at) for surface, at in zip(contact.surfaces, places)]
        if contact.with_itself:
            faces = [_together(*faces)] * 2
        options = lib.ct_contact_options_default()
        for name, value in contact.c("ct_contact_options").items():
            setattr(options, name, value)
        new = ffi.new("ct_scene_contact *", contact.c("ct_scene_contact", options=options))
        for side, (body, _), own in zip("ab", contact.surfaces, faces):
            setattr(new, f"body_{side}", numbers[body])
            setattr(new, f"face_count_{side}", len(own))
            setattr(new, f"faces_{side}", ffi.from_buffer("int32_t[]", own))
        of = dict.fromkeys(self._file_of(body) for body, _ in contact.surfaces)
        about = f"{pair_name(contact.surfaces)}{''.join(of)}: "
        self._call(f"contact[{i}]", lib.ct_scene_add_contact, self._scene, new, about=about)
        return faces[:1] if contact.with_itself else faces

    def on(self, surface: tuple[str, str], key: str, nodes: bool = False) -> NDArray[Any]:
        """The faces or the nodes of a surface. A surface that is empty or does not exist is an error, and so is a
        set of a mesh file with the name of a face."""
        body, face = surface
        mesh, name = self._meshes[body], f'"{body}.{face}"'
        self.asked.setdefault((body, nodes), {})[face] = None
        kinds = mesh.sets.kinds(face) if face in FACES else ()
        if kinds and (nodes or kinds != ("elements",)) and face != self.parts.bodies[body].part:
            text = f"{name} is a face that every body has and a set of {kinds[0]}"
            raise self._error(f"{text}{self._file_of(body)}; rename the set in the file", key)
        try:
            found: NDArray[Any] = mesh.face_nodes(face) if nodes else mesh.faces(face)[0]
        except Error as error:
            raise self._error(f"{name}{self._file_of(body)}: {error}", key) from None
        except ValueError as error:
            text = f'{name}: body "{body}"{self._file_of(body)} {error}'
            raise self._error(text, key) from None
        if not len(found):
            what = "nodes" if nodes else "faces"
            reason = f'no outer face of the body lies in that plane; "{body}.outer" has all of them'
            if face not in FACES:
                reason = f'the set is empty in body "{body}"{self._file_of(body)}'
            raise self._error(f"{name} has no {what}: {reason}", key)
        return found

    def _file_of(self, body: str) -> str:
        """The mesh file of a body, for a message."""
        given = self.parts.bodies[body]
        return "" if given.mesh is None else f' of "{given.mesh}"'

    def _add_support(self, i: int, support: Support) -> None:
        nodes = self.on(support.set, f"support[{i}].set", nodes=True)
        new = ffi.new("ct_scene_support *", support.c("ct_scene_support", **_held(support, nodes)))
        new.body = list(self.parts.bodies).index(support.set.body)
        self._call(f"support[{i}]", lib.ct_scene_add_support, self._scene, new)

    def _add_effects(self) -> None:
        """Create the effects other than contacts and supports for the joined bodies: first those of the
        scene's tables, then those of the user."""
        calls = [(added.key, added.given.create) for added in self.parts.effects]
        calls += [(effect.name, effect.create) for effect in self.own]
        paths = [i for i, support in enumerate(self.parts.support) if support.history]
        calls += [(f"support[{i}]", Maker.motion) for i in paths[:1]]
        made = []
        for key, create in calls:
            new = create(Maker(self, self.joined, key))
            for effect in new if isinstance(new, list) else [new]:
                made.append((key, ffi.gc(effect, lib.ct_effect_free)))
        for key, effect in made:
            ffi.gc(effect, None)  # the scene owns it from here on, even if the call fails
            self._call(key, lib.ct_scene_add_effect, self._scene, effect)

    def _build(self, dt: float | None, checked: bool) -> None:
        given, end = self.parts.time, self.end
        name, value = given.step if dt is None else ("dt", dt)
        if not (math.isfinite(end) and end > 0.0):
            raise self._error(f"the end of the run is {end:g}", "time")
        members = {
            "end": end,
            name: value,
            "keep_dt": dt is not None,
            "integrator": given.scheme,
            "assembled": given.stable_step == "assembled",
            "force_tolerance": given.force_tolerance,
        }
        time, self.stable = ffi.new("ct_scene_time *", members), ffi.new("ct_stable_step *")
        problem, count = ffi.new("const ct_problem **"), ffi.new("int64_t *")
        state = ffi.new("ct_state **") if checked else ffi.NULL
        made = problem, count, self.stable if checked else ffi.NULL
        self._call("", lib.ct_scene_start, self._scene, time, *made, state)
        # Freeing a state calls the effects, which these objects keep alive.
        needed = (self._scene, self.kept, self.own)
        self._first: Any = None
        if checked:
            self._first = ffi.gc(state[0], lambda state, needed=needed: lib.ct_state_free(state))
        if not 1 <= count[0] <= MOST_STEPS:
            reason = f"asks for {count[0]} steps; at most {MOST_STEPS:g} are taken"
            raise self._error(reason, f"time.{name}")
        self.pointer, self.step_count = problem[0], count[0]

    def _built_body(self, i: int, name: str) -> BuiltBody:
        body = self.pointer.bodies[i]
        kernel, cost = ffi.new("ct_solid_kernel *"), ffi.new("double[2]")
        call(lib.ct_solid_body_plan, self.pointer.effects[0], i, kernel, cost, cost + 1)
        rows = slice(body.first_node, body.first_node + body.mesh.node_count)
        mesh, materials = self._meshes[name], self.parts.materials_of(self.parts.bodies[name])
        stiffest = max(materials, key=lambda each: speeds(each)[0])
        at = self.material_at.get(name)
        groups = [] if at is None else [np.flatnonzero(at == k) for k in range(len(materials))]
        by_material = tuple(zip(materials, groups))
        kind = word(KERNELS, kernel[0])
        return BuiltBody(name, mesh, stiffest, rows, kind, cost[0], cost[1], by_material)

    def _built_contact(self, i: int, contact: Contact) -> BuiltContact:
        epsilon = ffi.new("double *")
        call(lib.ct_scene_contact_epsilon, self._scene, i, epsilon)
        rule = ffi.new("ct_rule *")
        points = []
        for (body, _), faces in zip(contact.surfaces, self.faces[i]):
            call(lib.ct_rule_face, FACTS[self.bodies[body].mesh.element].face_kind, rule)
            points.append(len(faces) * rule.count)
        first, second = (".".join(surface) for surface in contact.surfaces)
        counts = tuple(len(faces) for faces in self.faces[i])
        return BuiltContact((first, second), contact.with_itself, counts, tuple(points), epsilon[0])


class Maker:
    """
    Helper for the modules of ``libcontact.effects`` that create effects.

    It has the joined ``problem`` (``const ct_problem *``), whose nodes are those of all bodies one
    after another, and the ``parts`` of the scene.
    """

    def __init__(self, built: Problem, joined: Any, key: str):
        self.problem, self.parts, self.key = joined, built.parts, key
        self._built = built

    def keep(self, value: Any) -> Any:
        """Keep an object alive as long as the problem, and return it."""
        self._built.kept.append(value)
        return value

    def error(self, reason: str, key: str = "") -> SceneError:
        """An error of the effect, or of one of its keys."""
        return SceneError(reason, f"{self.key}.{key}" if key else self.key, self._built.file)

    def make(self, name: str, given: Table | None, **members: Any) -> Any:
        """Create the library's effect ``name``. Its struct gets the keys of the table and further
        ``members``."""
        struct = f"ct_{name}_def" if hasattr(lib, f"ct_{name}_def_default") else f"ct_{name}"
        out, definition = ffi.new("ct_effect **"), ffi.new(f"{struct} *")
        if struct.endswith("_def"):
            definition[0] = getattr(lib, f"{struct}_default")()
        for member, value in (given.c(struct, **members) if given else members).items():
            setattr(definition, member, value)
        create = getattr(lib, f"ct_{name}_create_effect")
        self._built._call(self.key, create, definition, self.problem, out)
        return out[0]

    def motion(self) -> Any:
        """Create the one effect of all supports with a prescribed displacement."""
        paths = [(i, each) for i, each in enumerate(self.parts.support) if each.history]
        self._check_motions()
        motions = self.keep(ffi.new("ct_motion[]", len(paths)))
        for motion, (i, support) in zip(motions, paths):
            nodes = self.face_nodes(support.set, f"support[{i}].set")
            members = _held(support, self.keep(nodes))
            members |= {"displacement": support.travel, "amplitude": self.history(support.history)}
            for name, value in members.items():
                setattr(motion, name, value)
        return self.make("motion", None, motions=motions, motion_count=len(paths))

    def _check_motions(self) -> None:
        """Raise an error if a support with a prescribed displacement and another one move a component of a
        common node differently."""
        supports = self.parts.support
        for j, other in enumerate(supports):
            for i, support in enumerate(supports):
                if not support.history or i == j or (other.history and j > i):
                    continue
                if support.set.body != other.set.body:
                    continue
                differs = [
                    k for k in set(support.fix) & set(other.fix) if not _agree(support, other, k)
                ]
                one, two = (self._built.on(each.set, self.key, True) for each in (support, other))
                common = np.intersect1d(one, two)
                if differs and common.size:
                    where = self._built._meshes[support.set.body].nodes[common[0]]
                    place = ", ".join(f"{x:.4g}" for x in where)
                    reason = f'prescribes {min(differs)} of {common.size} nodes that support[{j}] prescribes, too, and moves them differently: node {common[0]} of body "{support.set.body}" at ({place}); leave {min(differs)} out of one "fix", or make the motions equal'
                    raise SceneError(reason, f"support[{i}].fix", self._built.file)

    def history(self, history: History | None) -> dict[str, Any]:
        """The members of a ``ct_amplitude``; without a history the factor is 1 at all times."""
        lists = ([0.0], [0.0]) if history is None else (history.time, history.value)
        time, value = (self.keep(ffi.new("double[]", list(numbers))) for numbers in lists)
        return {"count": 0 if history is None else len(lists[0]), "time": time, "value": value}

    def bodies(self, names: Sequence[str] | None) -> dict[str, Any]:
        """The members ``bodies`` and ``body_count``; a null pointer for all bodies."""
        if names is None:
            return {"bodies": ffi.NULL, "body_count": 0}
        order = list(self.parts.bodies)
        numbers = self.keep(ffi.new("int32_t[]", [order.index(name) for name in names]))
        return {"bodies": numbers, "body_count": len(names)}

    def body(self, name: str) -> Any:
        """The ``ct_body`` with this name."""
        return self.problem.bodies[list(self.parts.bodies).index(name)]

    def materials(self, surface: tuple[str, str]) -> tuple[Material, ...]:
        """The materials of the elements behind a surface."""
        return self._built.materials_behind(surface)

    def body_nodes(self, name: str) -> NDArray[Any]:
        """Numbers in the problem of all nodes of a body (int32); -1 for those that a part of it lacks."""
        body, part = self.body(name), self._built.part
        numbers = np.arange(body.first_node, body.first_node + body.mesh.node_count, dtype=np.int32)
        if part is None:
            return numbers
        whole = np.full(part.bodies[name].node_count, -1, np.int32)
        whole[part.bodies[name].node_numbers] = numbers
        return whole

    def face_nodes(self, surface: tuple[str, str], key: str | None = None) -> NDArray[Any]:
        """Numbers in the problem of the nodes of a surface (body, face), ascending (int32); an empty
        surface is an error of the effect, or of ``key``."""
        nodes = self._built.on(surface, key or self.key, nodes=True)
        return np.ascontiguousarray(nodes + self.body(surface[0]).first_node, np.int32)

    def faces(self, surface: tuple[str, str], key: str = "surface") -> dict[str, Any]:
        """The members ``kind``, ``face_count`` and ``faces`` of a surface (body, face); an empty surface is
        an error of ``key``."""
        body, faces = self.body(surface[0]), self._built.on(surface, f"{self.key}.{key}")
        rows = self.keep(np.ascontiguousarray(faces + body.first_node, np.int32))
        kind = lib.ct_brick_face_kind(body.mesh.kind)
        return {"kind": kind, "face_count": len(rows), "faces": ffi.from_buffer("int32_t[]", rows)}


def _agree(support: Support, other: Support, axis: str) -> bool:
    """Whether a support with a prescribed displacement and another one move a component equally."""
    c = AXES.index(axis)
    if not other.history:
        return support.travel[c] == 0.0 and other.velocity[c] == 0.0
    same = support.travel[c] == other.travel[c]
    return same and (support.travel[c] == 0.0 or support.history == other.history)


def _held(support: Support, nodes: NDArray[Any]) -> dict[str, Any]:
    """The members of C structs with the nodes of a support and their fixed components."""
    fixed = [axis in support.fix for axis in AXES]
    rows = ffi.from_buffer("int32_t[]", nodes)
    return {"nodes": rows, "node_count": len(nodes), "fixed": fixed}


def _together(first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
    """Join two surfaces of one body: the faces of the first, then those that only the second has."""
    both = np.concatenate([first, second])
    _, places = np.unique(both, axis=0, return_index=True)
    return np.ascontiguousarray(both[np.sort(places)])


def tied_points(problem: Problem) -> dict[str, tuple[int, int]]:
    """The numbers of tied points and of all points of each tie, by its key."""
    ties = [effect for effect in problem.made if effect.kind == lib.CT_EFFECT_TIE]
    numbers = ffi.new("int64_t[2]")
    found = {}
    for i, effect in enumerate(ties):
        call(lib.ct_tie_count, effect, numbers, numbers + 1, ffi.new("double *"))
        found[f"tie[{i}]"] = (int(numbers[0]), int(numbers[1]))
    return found


def _contacts(problem: Problem, state: Any) -> Iterator[Any]:
    """The contacts of the problem (``const ct_contact *``) in a state (``ct_state *``)."""
    for k, effect in enumerate(problem.made):
        if effect.kind == lib.CT_EFFECT_CONTACT:
            error = new_error()
            contact = lib.ct_state_contact(problem.pointer, state, k, error)
            if contact == ffi.NULL:
                check(error.code, error)
            yield contact


def contact_points(problem: Problem, state: Any) -> list[NDArray[Any]]:
    """The points of each contact of the problem in a state (``ct_state *``)."""
    out: list[NDArray[Any]] = []
    for contact in _contacts(problem, state):
        points, pointer = point_rows(lib.ct_contact_point_count(contact))
        call(lib.ct_contact_points, contact, pointer)
        out.append(points)
    return out


def contact_pressure(problem: Problem, state: Any) -> dict[str, list[NDArray[Any]]]:
    """Tractions at the nodes of the surfaces of each contact and obstacle in a state (``ct_state *``); see
    ``Run.pressure``."""
    out: dict[str, list[NDArray[Any]]] = {"contact": [], "obstacle": []}
    contacts = _contacts(problem, state)
    for k, effect in enumerate(problem.made):
        if effect.kind == lib.CT_EFFECT_CONTACT:
            contact, built = next(contacts), problem.contacts[len(out["contact"])]
            rubs = bool(problem.parts.contact[len(out["contact"])].friction)
            calls = (lib.ct_contact_traction, lib.ct_contact_friction if rubs else None)
            sides = [
                _node_rows(problem, state, side, *calls, contact, side)
                for side in range(1 if built.with_itself else 2)
            ]
            out["contact"].append(np.concatenate(sides))
        elif effect.kind == lib.CT_EFFECT_OBSTACLE:
            rubs = bool(problem.parts.obstacle[len(out["obstacle"])].friction)
            calls = (lib.ct_obstacle_traction, lib.ct_obstacle_friction if rubs else None)
            asked = (*calls, problem.pointer, state, k)
            out["obstacle"].append(_node_rows(problem, state, 0, *asked))
    return out


def _node_rows(
    problem: Problem, state: Any, side: int, function: Any, rub: Any, *arguments: Any
) -> NDArray[Any]:
    """Rows of NODE for the nodes of one surface, from functions that write their tractions and areas, and those
    of friction (None: there is none)."""
    count, bodies = problem.pointer.node_count, problem.pointer.bodies
    traction, area = np.zeros((count, 3)), np.full(count, np.nan)
    friction, slip = np.zeros((count, 3)), np.zeros(count, np.int32)
    call(function, *arguments, doubles(traction), doubles(area))
    if rub is not None:
        call(rub, *arguments, doubles(friction), ints(slip))
    nodes = np.flatnonzero(~np.isnan(area))
    first = np.array([bodies[b].first_node for b in range(len(problem.bodies))])
    rows = np.zeros(len(nodes), NODE)
    rows["side"], rows["body"] = side, np.searchsorted(first, nodes, "right") - 1
    rows["node"] = nodes - first[rows["body"]]
    places = (problem.rows(problem.pointer.reference), problem.rows(state.displacement))
    rows["position"] = places[0][nodes] + places[1][nodes]
    rows["area"], rows["friction"], rows["slip"] = area[nodes], friction[nodes], slip[nodes]
    rows["traction"] = traction[nodes] + friction[nodes]
    rows["pressure"] = np.linalg.norm(traction[nodes], axis=1)
    return rows


def penetrations(
    problem: Problem, state: Any, asked: Iterable[str] = PLACES
) -> list[dict[str, dict[str, Any]]]:
    """Penetration of the surfaces of each contact and each obstacle in a state (``ct_state *``), at the
    places ``asked``; see ``Run.penetration``."""
    asked = list(asked)
    out: list[dict[str, dict[str, Any]]] = []
    for built, contact in zip(problem.contacts, _contacts(problem, state)):
        there = [place for place in asked if place == "points" or not built.with_itself]
        out.append(
            _depths(built.surfaces, there, partial(call, lib.ct_contact_penetration, contact))
        )
    numbers = [k for k, made in enumerate(problem.made) if made.kind == lib.CT_EFFECT_OBSTACLE]
    for given, k in zip(problem.parts.obstacle, numbers):
        measure = partial(call, lib.ct_obstacle_penetration, problem.pointer, state, k)
        out.append(_depths((".".join(given.surface),), asked, measure))
    return out


def _depths(
    surfaces: Sequence[str], asked: Iterable[str], measure: Callable[..., None]
) -> dict[str, dict[str, Any]]:
    """Penetration at the places ``asked``, from a function of a place and the struct to
    fill."""
    found, table = ffi.new("ct_penetration *"), {}
    for place in asked:
        measure(PLACES[place], found)
        surface = surfaces[found.side] if found.side >= 0 else None
        table[place] = {**depths(found), "surface": surface}
    return table


def new_state(problem: Problem) -> Any:
    """Create a state of the problem at t = 0. The first call returns the state for which the stable step
    was computed. If a value is not finite, the error is one of the scene."""
    state, problem._first = problem._first, None
    try:
        if state is None:
            state = ask("ct_state **", lib.ct_state_create, problem.pointer)
        else:
            ffi.gc(state, None)
    except Error as reason:
        raise SceneError(str(reason), "", problem.file) from None
    # Freeing a state calls the problem's effects, so the state keeps the problem alive.
    return ffi.gc(state, lambda state, free=lib.ct_state_free, problem=problem: free(state))


def _spinning(body: Body, nodes: Floats) -> NDArray[Any]:
    """Velocity of each node of a body with translation and spin, v + ω × (x - centre), from the positions
    x at the start."""
    axis = np.array(body.spin.axis)
    omega = body.spin.rate / math.hypot(*axis) * axis
    return np.ascontiguousarray(np.array(body.velocity) + np.cross(omega, body.spin.arms(nodes)))
