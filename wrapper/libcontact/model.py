"""The tables of a scene with their keys: type, unit, default and meaning of each. The reader with
its messages, the calls of ``Scene``, the JSON Schema, and the tables of the book are derived from
this module and from ``libcontact.effects``.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .bridge import GONE, names
from .errors import new_error
from .mesh import FACTS, WIDTH
from .schema import (
    VECTOR,
    ByName,
    Choice,
    Each,
    FileName,
    Indices,
    Many,
    Name,
    Nested,
    Number,
    OneOrByName,
    PartKey,
    Reference,
    Rows,
    Surface,
    Table,
    Whole,
    key,
    word,
)
from .sets import Sets

LUMPINGS = names("ct_lumping")
LAWS = names("ct_law")
LARGE = " or ".join(f'"{law}"' for law in LAWS if law != "linear")
KERNELS = names("ct_solid_kernel")
METHODS = names("ct_method")
ENFORCEMENTS = names("ct_enforcement")
# Whether an enforcement can feed energy into the bodies. Such a law stores the energy of an impact and
# returns it; the others dissipate a part of it.
FEEDS = {"penalty": True, "energy_controlled": False}
POINTS = names("ct_contact_rule")
INITIAL = names("ct_initial")
INTEGRATORS = names("ct_scheme")
LAYERS = names("ct_layers")
# Keys of run.savings, and their names in the C library.
OPTIMISATIONS = {"quiet": "sleep", "plane_strain": "plane_strain", "congruent": "shared_stiffness"}
SAVINGS = tuple(OPTIMISATIONS)
FIELDS = ("displacement", "velocity", "stress", "contact_pressure")
FILTERED = tuple(f"{name}_filtered" for name in FIELDS[:3])
AXES = ("x", "y", "z")
# Quantities that a probe can record, by its place; the first ones are the default.
QUANTITIES = names("ct_quantity")
TAKEN = {
    "point": ("displacement", "velocity", "acceleration", "stress", "pressure"),
    "surface": ("displacement", "velocity", "acceleration"),
    "resultant": ("force", "moment"),
}
USUAL = ("displacement", "velocity", "force")
# Defaults of the C library.
CONTACT = lib.ct_contact_options_default()
POSITIVE = Number(above=0.0)
FORWARD = Number(least=0.0)
GRADING = Number(least=1e-6, most=1e6)
ORIGIN = (0.0, 0.0, 0.0)
# Cells around what stands on a core of cells with four sides.
QUARTERS = Whole(4, step=4)
ONE = "one of these seven"

Vector = Sequence[float] | NDArray[Any]


def without(known: Mapping[str, int], *left_out: str) -> dict[str, int]:
    """The words of an enum, except those that scenes do not allow."""
    return {name: value for name, value in known.items() if name not in left_out}


class Material(Table):
    r"""A material.

    Attributes
    ----------
    name
        Name by which bodies refer to it.
    young
        Young's modulus :math:`E`.
    poisson
        Poisson's ratio :math:`\nu`. At ½ a material is incompressible: :math:`c_1` is infinite, and
        no explicit step is stable.
    density
        Density :math:`\rho`.
    law
        ``"linear"``: small strain and rotation, :eq:`hooke`; ``"st_venant_kirchhoff"``
        (:eq:`st-venant-kirchhoff`): any rotation, moderate strain; ``"neo_hookean"``
        (:eq:`neo-hookean`): any rotation, large strain. All agree where strain is small.
    """

    name: str = key(Name(), kw_only=False)
    young: float = key(POSITIVE, unit="stress")
    poisson: float = key(Number(", where a material stops changing volume", above=-1.0, below=0.5))
    density: float = key(POSITIVE, unit="mass / length³")
    law: str = key(Choice(LAWS), default=word(LAWS, lib.CT_LINEAR))


def c_material(material: Material) -> Any:
    """A ``ct_material *`` of a material."""
    return ffi.new("ct_material *", material.c("ct_material"))


def speeds(material: Material) -> tuple[float, float]:
    """Speeds c₁ and c₂ of a material's waves, in the units of the scene."""
    c = ffi.new("double[2]")
    lib.ct_material_speeds(c_material(material), c, c + 1)
    return c[0], c[1]


def modulus(material: Material) -> float:
    """The modulus ρ c₁² of a material's dilatational wave."""
    return float(material.density * speeds(material)[0] ** 2)


class Shape(Table):
    """A body that the library meshes."""

    #: The cells around, ``cells[1]``, come in multiples of this number; 0: none are around.
    step: ClassVar[int] = 1

    def counts(self) -> tuple[int, int]:
        """Numbers of elements and of their corners."""
        x, y, z = getattr(self, "cells")
        return x * y * z, (x + 1) * (y if self.step else y + 1) * (z + 1)

    def scaled(self, scale: float, around: int = 3) -> Any:
        """The shape with elements that are ``scale`` times smaller; a single cell stays one. At least
        ``around`` cells remain around it, or as many as there are."""
        steps, cells = (1, self.step, 1), list(getattr(self, "cells"))
        for i, n in enumerate(cells if scale != 1.0 else ()):
            if n > 1:
                step = max(steps[i], 1)
                fewest = min(n, around) if i == 1 and self.step else 1
                cells[i] = step * max(-(-fewest // step), round(n * scale / step))
        shape: Any = self
        return replace(shape, cells=tuple(cells))


class Box(Shape):
    """
    A rectangular box of elements that are equal or graded.

    Attributes
    ----------
    origin
        The corner with the smallest coordinates.
    size
        Lengths of its edges.
    cells
        Numbers of elements along x, y and z.
    layers
        The axis along which elements are numbered layer by layer. Results do not depend on it, but
        speed does (:doc:`/theory/savings`). By default this is the axis normal to the faces with a
        contact, an obstacle or a load, if there is one such axis and rows get at least 32 cells;
        otherwise z.
    grading
        Along x, y and z the size of the last element over that of the first. The sizes between form
        a geometric series, :eq:`mesh-grading`.
    symmetric
        Axes along which ``grading`` is the size of the elements at both ends over that in the middle.
    """

    step = 0
    origin: Vector = key(VECTOR, unit="length", default=ORIGIN)
    size: Vector = key(Each(POSITIVE, POSITIVE, POSITIVE), unit="length")
    cells: tuple[int, int, int] = key(Each(Whole(), Whole(), Whole()))
    layers: str | None = key(Choice(sorted(LAYERS)), default=None, says="see text")
    grading: Vector = key(Each(GRADING, GRADING, GRADING), default=(1.0, 1.0, 1.0))
    symmetric: Sequence[str] = key(
        Many(Choice(AXES), 'name at least one of "x", "y", "z"', distinct=True),
        default=(),
        says="none",
    )

    @property
    def equal(self) -> bool:
        """Whether all elements are equal."""
        return self.grading == (1.0, 1.0, 1.0)


class Ring(Shape):
    """
    A ring about an axis along z.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Inner and outer radius.
    width
        Its length along z.
    cells
        Numbers of elements along the radius, around and across.
    """

    centre: Vector = key(VECTOR, unit="length", default=ORIGIN)
    radius: Vector = key(Each(POSITIVE, POSITIVE), unit="length")
    width: float = key(POSITIVE, unit="length")
    cells: tuple[int, int, int] = key(Each(Whole(), Whole(3), Whole()))

    def refusals(self) -> Iterator[tuple[str, str]]:
        inner, outer = self.radius
        if outer <= inner:
            why = f"the outer radius must be above the inner one, {inner:g}"
            yield "radius[1]", f"is {outer:g}; {why}"


class Cylinder(Shape):
    """
    A solid cylinder about an axis along z, such as a disc: a square core, and layers up to the circle,
    :eq:`mesh-blocks`.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Its radius.
    width
        Its length along z.
    cells
        Numbers of elements along the radius between core and surface, around (a multiple of 4) and across.
    """

    step = 4
    centre: Vector = key(VECTOR, unit="length", default=ORIGIN)
    radius: float = key(POSITIVE, unit="length")
    width: float = key(POSITIVE, unit="length")
    cells: tuple[int, int, int] = key(Each(Whole(), QUARTERS, Whole()))

    def counts(self) -> tuple[int, int]:
        layers, around, across = self.cells
        n = around // 4
        return (n * n + around * layers) * across, ((n + 1) ** 2 + around * layers) * (across + 1)


class Ball(Shape):
    """
    A solid ball: a core that is a cube with bulging sides, and layers up to the sphere,
    :eq:`mesh-blocks`.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Its radius.
    cells
        Numbers of elements along the radius between core and surface, and around a great circle (a
        multiple of 4).
    """

    step = 4
    centre: Vector = key(VECTOR, unit="length", default=ORIGIN)
    radius: float = key(POSITIVE, unit="length")
    cells: tuple[int, int] = key(Each(Whole(), QUARTERS))

    def counts(self) -> tuple[int, int]:
        layers, n = self.cells[0], self.cells[1] // 4
        return n**3 + 6 * n * n * layers, (n + 1) ** 3 + (6 * n * n + 2) * layers


class Shell(Shape):
    """
    The shell between two spheres about one centre.

    Attributes
    ----------
    centre
        Its centre.
    radius
        Inner and outer radius.
    cells
        Numbers of elements through the shell and around a great circle (a multiple of 4).
    """

    step = 4
    centre: Vector = key(VECTOR, unit="length", default=ORIGIN)
    radius: Vector = key(Each(POSITIVE, POSITIVE), unit="length")
    cells: tuple[int, int] = key(Each(Whole(), QUARTERS))

    def counts(self) -> tuple[int, int]:
        layers, n = self.cells[0], self.cells[1] // 4
        return 6 * n * n * layers, (6 * n * n + 2) * (layers + 1)

    refusals = Ring.refusals


SHAPES = {"box": Box, "ring": Ring, "cylinder": Cylinder, "ball": Ball, "shell": Shell}


class Axis(Table):
    """
    An axis of rotation.

    Attributes
    ----------
    axis
        The axis of rotation.
    centre
        A point of the axis, which stays where it is.
    """

    axis: Vector = key(VECTOR, default=(0.0, 0.0, 1.0))
    centre: Vector | None = key(
        VECTOR, unit="length", default=None, says="the middle of its bounds"
    )

    def refusals(self) -> Iterator[tuple[str, str]]:
        if not any(self.axis):
            yield "axis", "is 0; it must have a direction"

    def arms(self, nodes: NDArray[Any]) -> NDArray[Any]:
        """The nodes (n, 3), seen from the centre."""
        middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
        arms: NDArray[Any] = nodes - (middle if self.centre is None else np.array(self.centre))
        return arms


class Spin(Axis):
    """
    A rotation at the start.

    Attributes
    ----------
    rate
        Angular velocity.
    """

    rate: float = key(Number(), unit="1 / time")


class Turn(Axis):
    """
    A rotation of a body by an angle.

    Attributes
    ----------
    angle
        Angle of rotation in radians.
    """

    angle: float = key(Number(), default=0.0)

    def change(self, arms: NDArray[Any]) -> NDArray[Any]:
        """What the rotation adds to these vectors (n, 3)."""
        e = np.array(self.axis) / np.linalg.norm(self.axis)
        # 2 sin²(φ/2) in place of 1 - cos φ: small angles keep their digits.
        across = np.cross(e, arms)
        turned: NDArray[Any] = math.sin(self.angle) * across
        turned += 2.0 * math.sin(0.5 * self.angle) ** 2 * np.cross(e, across)
        return turned


class Placement(Turn):
    """
    Where a body is built: its mesh is turned by ``angle`` about ``axis``, and moved. It is free of
    stress there, whatever its law, and its sides keep the names that they had before.

    Attributes
    ----------
    move
        Displacement of the mesh, after the rotation.
    """

    move: Vector = key(VECTOR, unit="length", default=ORIGIN)

    def refusals(self) -> Iterator[tuple[str, str]]:
        yield from super().refusals()
        if not self.angle and not any(self.move):
            yield "", "gives no angle and no move"

    def of(self, nodes: NDArray[Any]) -> NDArray[Any]:
        """The nodes (n, 3) of the mesh in this place."""
        return np.ascontiguousarray(nodes + self.change(self.arms(nodes)) + np.array(self.move))


class Initial(Turn):
    """
    The state of a body at the start: a point X begins at centre + R (1 + gradient) (X - centre) +
    displacement, where R turns by ``angle`` about ``axis`` (:eq:`initial-displacement`). The law ``"linear"``
    does not allow an angle.

    Attributes
    ----------
    displacement
        Displacement of the whole body.
    gradient
        Displacement gradient: three rows with the derivatives of one component along x, y and z.
    displacements
        Instead of all these, the displacement of each node (n, 3); meant for Python.
    stress
        Stress that the body has without displacement: xx yy zz xy yz zx (:eq:`initial-stress`), for
        the law ``"linear"``.
    """

    displacement: Vector = key(VECTOR, unit="length", default=ORIGIN)
    gradient: Any = key(Each(VECTOR, VECTOR, VECTOR), default=None, says="0")
    displacements: Any = key(Rows(3), unit="length", default=None, says="none")
    stress: Any = key(Each(*[Number()] * 6), unit="stress", default=None, says="0")

    @property
    def moves(self) -> bool:
        """Whether it gives a displacement by the formula."""
        return bool(any(self.displacement) or self.gradient is not None or self.angle)

    @property
    def displaces(self) -> bool:
        """Whether it gives a displacement."""
        return self.moves or self.displacements is not None

    def refusals(self) -> Iterator[tuple[str, str]]:
        yield from super().refusals()
        if self.displacements is not None and self.moves:
            yield "displacements", "cannot stand beside displacement, gradient or angle"
        if self.stress is None and not self.displaces:
            yield "", "gives no displacement, gradient, angle, displacements or stress"

    def at(self, nodes: NDArray[Any]) -> NDArray[Any] | None:
        """Displacements (n, 3) of the nodes (n, 3) of the body; None: there are none."""
        if self.displacements is not None or not self.moves:
            return self.displacements  # type: ignore[no-any-return]
        r = self.arms(nodes)
        stretched = r if self.gradient is None else r @ np.array(self.gradient).T
        stretched = stretched if self.gradient is None else stretched + r
        turned = self.change(stretched)
        return np.ascontiguousarray((stretched - r) + turned + np.array(self.displacement))


class Inertia(Table):
    """
    A rigid body that is given by its mass instead of a mesh: a brick of one element whose lumped masses have these
    moments (:eq:`inertia-brick`).

    Attributes
    ----------
    mass
        Its mass; the density of the material does not count.
    moments
        Its moments of inertia about axes through the centre along x, y and z. None may reach the sum of the
        others. A solid sphere has 2/5 of mass times radius squared.
    centre
        Its centre of mass.
    """

    mass: float = key(POSITIVE, unit="mass")
    moments: Vector = key(Each(POSITIVE, POSITIVE, POSITIVE), unit="mass · length²")
    centre: Vector = key(VECTOR, unit="length", default=ORIGIN)

    def refusals(self) -> Iterator[tuple[str, str]]:
        for k, moment in enumerate(self.moments):
            others = sum(self.moments) - moment
            if moment >= others:
                yield (
                    f"moments[{k}]",
                    f"is {moment:g}; it must be below the sum of the others, {others:g}",
                )

    @property
    def edges(self) -> NDArray[Any]:
        """Lengths of the edges of the brick (3,)."""
        others = sum(self.moments) - np.array(self.moments)
        # -- m a² / 4 = ½ (I_y + I_z - I_x) (eq:inertia-brick)
        edges: NDArray[Any] = np.sqrt(2.0 * (others - self.moments) / self.mass)
        return edges

    @property
    def density(self) -> float:
        """Density of the brick."""
        return float(self.mass / np.prod(self.edges))

    @property
    def nodes(self) -> NDArray[Any]:
        """Corners of the brick (8, 3), in VTK's order."""
        x, y, z = 0.5 * self.edges
        corners = [(a, b, c) for c in (-z, z) for a, b in ((-x, -y), (x, -y), (x, y), (-x, y))]
        return np.add(corners, self.centre)


class Extrude(Table):
    """
    The third dimension of a plane mesh of quadrilaterals and triangles.

    Attributes
    ----------
    height
        Height of the body along z.
    layers
        Number of elements along z.
    """

    height: float = key(POSITIVE, unit="length")
    layers: int = key(Whole(), default=1)


class MeshSet(Table):
    """
    A named set of nodes, faces or elements of a body that is given by arrays.

    Attributes
    ----------
    nodes
        Node numbers.
    faces
        Rows (element, side); the sides 0 to 5 of an element are ξ = -1, ξ = 1, η = -1, η = 1, ζ = -1, ζ = 1.
    elements
        Element numbers.
    """

    one = (("nodes", "faces", "elements"),)

    nodes: Any = key(Indices(), default=None, says="one of three")
    faces: Any = key(Rows(2, whole=True), default=None, says="one of three")
    elements: Any = key(Indices(), default=None, says="one of three")

    @property
    def kind(self) -> str:
        """What it is a set of."""
        return next(name for name in self.one[0] if getattr(self, name) is not None)


class Body(Table):
    """
    A body: a ``box``, ``ring``, ``cylinder``, ``ball`` or ``shell``, a ``mesh`` file, or ``nodes``
    (n, 3) with ``elements`` (cells, 8 or 20); the arrays are copied.

    Attributes
    ----------
    name
        Name of the body in results and messages, at most 63 bytes.
    material
        Name of a material; or, for several in one body, names by sets of elements, such as
        ``{rim = "steel", hub = "brass"}``, in which every element is once.
    box
        A rectangular box.
    ring
        A ring about an axis along z.
    cylinder
        A solid cylinder about an axis along z.
    ball
        A solid ball.
    shell
        The shell between two spheres.
    mesh
        A mesh file of Gmsh, Abaqus, Exodus or VTK (:doc:`/start/meshes`); the path is relative to the
        folder of the scene file.
    part
        Name of a set of elements of the mesh file, which alone are the body; by default all elements are.
    scale
        Factor of the coordinates in the mesh file, such as 1000 for metres in a scene in millimetres.
    extrude
        Height and layers of a plane mesh of quadrilaterals and triangles.
    inertia
        Mass and moments of inertia of a rigid body that needs no mesh, because it carries an obstacle.
    place
        Rotation and displacement of the mesh before everything else: where the body stands.
    nodes
        Coordinates (n, 3); meant for Python.
    elements
        Node numbers (cells, 8 or 20) in VTK's order, counted from 0; with ``nodes``.
    sets
        Named sets of ``nodes``, ``faces`` or ``elements`` of these arrays, such as
        ``{"left": {"faces": [[0, 0], [3, 0]]}}``. The scene uses them as those of a mesh file, in
        ``"body.left"``.
    element
        Kind of its elements.
    velocity
        Velocity at t = 0.
    spin
        Rotation at t = 0, in addition to ``velocity``. The law ``"linear"`` does not allow it,
        because there a rotation causes false strain, unless the body is rigid.
    initial
        Displacement, rotation and stress at t = 0 (:doc:`/theory/initial`).
    lumping
        How the mass matrix is made diagonal; hex20 does not allow row sum.
    kernel
        How element forces are computed: ``"general"`` integrates with Gauss points, ``"box"`` uses
        closed forms for elements that are equal boxes along the axes, ``"plane"`` one layer of hex8
        boxes in two dimensions (:doc:`/theory/plane_strain`), ``"auto"`` selects the cheapest one
        that can compute the body.
    integration
        ``"reduced"``: one point per element, for hex8 of any shape and small strain
        (:doc:`/theory/solid_reduced`).
    hourglass
        Coefficient of the hourglass control; only with ``integration = "reduced"``.
    """

    one = ((*SHAPES, "mesh", "inertia", "nodes"),)
    needs = {"elements": "nodes", "nodes": "elements", "sets": "nodes"}
    needs |= dict.fromkeys(("part", "scale", "extrude"), "mesh")
    belongs = {"kernel": ("integration", "full"), "hourglass": ("integration", "reduced")}

    name: str = key(Name(), kw_only=False)
    material: Any = key(OneOrByName(Reference("material")))
    box: Any = key(Nested(Box), default=None, says=ONE)
    ring: Any = key(Nested(Ring), default=None, says=ONE)
    cylinder: Any = key(Nested(Cylinder), default=None, says=ONE)
    ball: Any = key(Nested(Ball), default=None, says=ONE)
    shell: Any = key(Nested(Shell), default=None, says=ONE)
    mesh: Any = key(FileName(), default=None, says=ONE)
    inertia: Any = key(Nested(Inertia), default=None, says=ONE)
    part: str | None = key(Name(), default=None, says="all elements")
    scale: float = key(POSITIVE, default=1.0)
    extrude: Any = key(Nested(Extrude), default=None, says="none")
    place: Any = key(Nested(Placement), default=None, says="as its mesh is given")
    nodes: Any = key(Rows(3), unit="length", default=None, says=ONE)
    elements: Any = key(Rows(*WIDTH.values(), whole=True), default=None, says="with ``nodes``")
    sets: Any = key(ByName(Nested(MeshSet)), default=None, says="none")
    element: str | None = key(
        Choice(FACTS), default=None, says='``"hex8"``, or what the mesh holds'
    )
    velocity: Vector = key(VECTOR, unit="length / time", default=ORIGIN)
    spin: Any = key(Nested(Spin), default=None, says="none")
    initial: Any = key(Nested(Initial), default=None, says="none")
    lumping: str | None = key(
        Choice(without(LUMPINGS, "default")),
        default=None,
        says='``"row_sum"`` for hex8, ``"hrz"`` for hex20',
    )
    kernel: str = key(
        Choice(without(KERNELS, "reduced", "rigid")), default=word(KERNELS, lib.CT_KERNEL_AUTO)
    )
    integration: str = key(Choice(("full", "reduced")), default="full")
    hourglass: float | None = key(POSITIVE, default=None, says="1")

    @property
    def shape(self) -> str | None:
        """The key of what the library meshes, ``"box"`` and so on; None with a mesh of its own."""
        return next((name for name in SHAPES if getattr(self, name)), None)

    @property
    def lattice(self) -> Any:
        """The table of this key, or None."""
        return self.shape and getattr(self, self.shape)

    @property
    def bricks(self) -> str | None:
        """The kind of the elements, or None as long as a mesh file has not been read."""
        if self.elements is not None:
            return next(name for name in WIDTH if WIDTH[name] == self.elements.shape[1])
        return self.element or (None if self.mesh else "hex8")

    @property
    def material_names(self) -> tuple[str, ...]:
        """Names of its materials, each once."""
        names = self.material.values() if isinstance(self.material, dict) else [self.material]
        return tuple(dict.fromkeys(map(str, names)))

    @cached_property
    def mesh_sets(self) -> Sets | None:
        """The named sets of its mesh; None as long as a mesh file has not been read."""
        if self.mesh is not None:
            return None
        given: dict[str, dict[str, Any]] = {}
        for name, each in (self.sets or {}).items():
            given.setdefault(each.kind, {})[name] = getattr(each, each.kind)
        counts = (0, 0) if self.elements is None else (len(self.nodes), len(self.elements))
        return Sets.read(given, *counts)

    def refusals(self) -> Iterator[tuple[str, str]]:
        yield from super().refusals()
        try:
            _ = self.mesh_sets
        except ValueError as error:
            yield "sets", str(error)
        if isinstance(self.material, dict):
            if self.shape:
                yield (
                    "material",
                    f"names sets of elements, but a {self.shape} has none; give one name",
                )
            if self.kernel in ("box", "plane"):
                yield "kernel", f'"{self.kernel}" is for a body of one material'
            if self.initial and self.initial.stress is not None:
                yield "initial.stress", "is for a body of one material"
        if self.elements is not None:
            most, (_, width) = len(self.nodes) - 1, self.elements.shape
            bad = np.flatnonzero((self.elements > most).any(axis=1))
            if bad.size:
                row = self.elements[bad[0]].tolist()
                yield "elements", f"row {bad[0]} names a node outside 0 ... {most}: {row}"
            if self.element not in (None, self.bricks):
                there = f'"elements" has {width} nodes per row ({self.bricks})'
                yield "element", f'is "{self.element}", but {there}'
        if self.bricks and not FACTS[self.bricks].row_sum:
            yield from self._chosen(ROW_SUM)
        if self.bricks and not FACTS[self.bricks].trilinear:
            yield from self._chosen(TRILINEAR_ONLY)

    def small_strain_only(self, material: Material) -> Iterator[tuple[str, str]]:
        """Keys of the body that its material's law does not allow."""
        other = f'material "{material.name}" has the law "{material.law}"'
        if material.law != "linear":
            for key, reason in self._chosen(
                dict.fromkeys(SMALL_STRAIN_ONLY, "is for small strain")
            ):
                yield key, f"{reason}; {other}"
            if self.initial is not None and self.initial.stress is not None:
                why = f"is for small strain; {other}, so give the gradient that causes the stress"
                yield "initial.stress", why

    def _chosen(self, words: Mapping[tuple[str, str], str]) -> Iterator[tuple[str, str]]:
        """The ones among the given words that the body uses, each with the reason against it."""
        for (name, chosen), why in words.items():
            if getattr(self, name) == chosen:
                yield name, f'"{chosen}" {why}'


# Options that some elements and laws of large strain lack: the key, its word, and the reason.
ROW_SUM = {("lumping", "row_sum"): 'gives nodes of this element a negative mass; use "hrz"'}
TRILINEAR_ONLY = {
    ("kernel", "plane"): 'is for hex8; hex20 has the kernels "general" and "box"',
    ("integration", "reduced"): "with hourglass control is for hex8; hex20 is integrated in full",
}
SMALL_STRAIN_ONLY = (("integration", "reduced"), ("kernel", "box"), ("kernel", "plane"))


class History(Table):
    """A piecewise linear function of time, constant before the first and after the last point.

    Attributes
    ----------
    time
        Times of the points, ascending.
    value
        Values at the points.
    """

    time: Sequence[float] = key(Many(Number(), "give at least one time"), unit="time")
    value: Sequence[float] = key(Many(Number(), "give at least one value"))

    def refusals(self) -> Iterator[tuple[str, str]]:
        here, there = len(self.value), len(self.time)
        if here != there:
            yield "value", f"has {here} entries, and time has {there}; both need as many"
        for i, (before, after) in enumerate(zip(self.time, self.time[1:])):
            if after < before:
                yield f"time[{i + 1}]", f"is {after:g}, before {before:g}"


class ContactLaw(Table):
    r"""Keys that a contact and an obstacle have in common: penalty, enforcement, friction, and the
    treatment of overlaps at the start.

    Attributes
    ----------
    beta
        Penalty as a factor of :math:`E / h`, :eq:`penalty-factor`, with the smaller E and the
        shortest edge of the two bodies. Without it the penalty is 40 :math:`\rho c_1^2 / h` for
        the energy-controlled penalty and 4 :math:`\rho c_1^2 / h` for the others,
        :eq:`penalty-default`.
    epsilon
        The penalty itself; instead of ``beta``.
    enforcement
        Law by which forces follow from gaps (:doc:`/theory/enforcement`); the explicit penalty
        reduces the stable step, the others do not.
    dissipation
        Damping ratio of the surface mode, for the energy-controlled penalty, :eq:`surface-damping`.
        With 0, energy is conserved while contact lasts.
    restitution
        Share of the energy lost at closing that the contact holds and gives back when it opens, for
        the energy-controlled penalty, :eq:`impact-reserve`. With 1 the impact of elastic bodies
        loses almost nothing, so what bounces comes to rest only by damping; with 0 it stops the layer of nodes at
        the surface, and a body of n layers loses about 1 / (2n) of the energy of the impact, :eq:`thin-loss`.
        In a scene with dynamic ``relaxation``, or with an integrator other than the leapfrog, the default is 0.
    friction
        Coefficient of Coulomb's friction (:doc:`/theory/friction`).
    tangent
        Stiffness of the tangential spring over that of the penalty, :eq:`slip-law`; only with ``friction``.
        Without it the spring is as stiff as the penalty, but if a body deforms at most 4 :math:`\rho c_1^2 / h`,
        with which the forces converge in fewer rounds. A point that sticks shifts by at most :math:`\mu` times its
        normal force over the stiffness of this spring. It does not limit the step.
    adjust
        Distance within which gaps and overlaps at the start count as touching,
        :eq:`initial-adjust`; at most the ``depth`` of a contact. For meshes of fitting parts, such as a shaft in
        its hole, use a value slightly above the sag :eq:`sag` of the coarser mesh.
    initial_penetration
        Treatment of points that penetrate by more than ``adjust`` at the start,
        :eq:`initial-shift`. ``"keep"`` measures their gaps from the initial value until they open,
        which adds no energy; ``"force"`` applies the contact force at once, which adds energy;
        ``"refuse"`` ends the run; ``"remove"`` separates them gradually. The run warns of such an
        overlap unless it is removed (:doc:`/theory/warnings`).
    removal_time
        Time in which ``"remove"`` separates the surfaces.
    points
        Positions of the contact points: ``"gauss"`` inside the faces, ``"lobatto"`` at corners, on
        edges and inside, so that the penetration of every corner is detected, :eq:`unseen`.
    """

    rivals = (("beta", "epsilon"),)
    belongs = {
        "dissipation": ("enforcement", "energy_controlled"),
        "restitution": ("enforcement", "energy_controlled"),
        "removal_time": ("initial_penetration", "remove"),
    }

    beta: float | None = key(POSITIVE, default=None, says="by enforcement")
    epsilon: float | None = key(POSITIVE, unit="stress / length", default=None, says="none")
    enforcement: str = key(
        Choice(ENFORCEMENTS, GONE["enforcement"]), default=word(ENFORCEMENTS, CONTACT.enforcement)
    )
    dissipation: float = key(Number(least=0.0, most=1.0), default=CONTACT.dissipation)
    restitution: float = key(Number(least=0.0, most=1.0), default=CONTACT.restitution)
    friction: float = key(FORWARD, default=0.0)
    tangent: float | None = key(POSITIVE, default=None, says="1 or less")
    adjust: float = key(FORWARD, unit="length", default=CONTACT.adjust)
    initial_penetration: str = key(
        Choice(INITIAL, GONE["initial_penetration"]),
        default=word(INITIAL, CONTACT.initial_penetration),
    )
    removal_time: float | None = key(POSITIVE, unit="time", default=None, says="none")
    points: str = key(Choice(POINTS), default=word(POINTS, CONTACT.points))

    def refusals(self) -> Iterator[tuple[str, str]]:
        yield from super().refusals()
        if self.tangent and not self.friction:
            yield "tangent", 'belongs to friction; give "friction" too'
        if self.initial_penetration == "remove" and self.removal_time is None:
            yield "removal_time", 'is missing; initial_penetration = "remove" needs it'


class ContactKeys(ContactLaw):
    """All keys of a contact except its surfaces.

    Attributes
    ----------
    method
        Method that finds closest points, one of :doc:`/theory/projection_methods`; an
        unconstrained one, such as ``"newton"``, misses points whose closest point lies on an edge.
    tolerance
        Tolerance of the search, in half-widths of a face.
    depth
        Search distance D from a point to the other surface. A point that is first found deeper than
        D below a face is not in contact with it, :eq:`point-status`; and in one step the surfaces
        may approach each other by at most D. By default D is the size of the largest face at the
        start, and afterwards the width of the narrowest face or three quarters of the smallest
        thickness, but at least twice ``adjust``, :eq:`contact-near`.
    """

    method: str = key(Choice(METHODS), default=word(METHODS, CONTACT.method))
    tolerance: float | None = key(POSITIVE, default=None, says="the library's")
    depth: float | None = key(POSITIVE, unit="length", default=None, says="see text")


class Contact(ContactKeys):
    """A contact of two surfaces. Two surfaces of one body are joined to one surface in contact with
    itself, because only then can neighbouring faces and the opposite side of a thin body be
    excluded.

    Attributes
    ----------
    surfaces
        Two faces or sets of faces, ``["left.x_max", "right.x_min"]``; each is slave in one pass and master in
        the other, so their order does not matter.
    """

    surfaces: tuple[tuple[str, str], tuple[str, str]] = key(Each(Surface(), Surface()))

    @property
    def with_itself(self) -> bool:
        """Whether both surfaces belong to one body."""
        return self.surfaces[0][0] == self.surfaces[1][0]


class Support(Table):
    """Prescribed velocity (0 by default) of the nodes of a face in the directions ``fix``, or
    prescribed displacement: ``travel`` times ``history``.

    Attributes
    ----------
    set
        The nodes of a face, ``"right.z_min"``, or of a set of nodes, faces or elements, ``"right.base"``.
    fix
        Components that are prescribed.
    velocity
        Their velocity; 0 for a fixed end or a plane of symmetry.
    travel
        Instead of a velocity: the displacement is the travel times the history
        (:doc:`/theory/motion`).
    history
        A piecewise linear factor in time (:eq:`amplitude`).
    """

    needs = {"travel": "history", "history": "travel"}

    set: Any = key(Surface(), kw_only=False)
    fix: Sequence[str] = key(
        Many(Choice(AXES), 'name at least one of "x", "y", "z"', distinct=True)
    )
    velocity: Vector = key(VECTOR, unit="length / time", default=ORIGIN)
    travel: Vector = key(VECTOR, unit="length", default=ORIGIN, says="none")
    history: Any = key(Nested(History), default=None, says="none")

    def refusals(self) -> Iterator[tuple[str, str]]:
        if self.history and any(self.velocity):
            why = "a support prescribes a velocity or a path"
            yield "velocity", f'cannot stand beside "travel": {why}'
        for name, vector in (("velocity", self.velocity), ("travel", self.travel)):
            for i, axis in enumerate(AXES):
                if vector[i] != 0.0 and axis not in self.fix:
                    yield f"{name}[{i}]", f'is {vector[i]:g}, but "{axis}" is not in fix'


class Probe(Table):
    """A history of a point, a surface or a resultant, recorded at every step, :doc:`/theory/probe`.

    Attributes
    ----------
    name
        Name of the history in ``run.probes``.
    body
        The body of the ``point``; or, for a contact's resultant, the body on which the force acts,
        by default that of the contact's first surface.
    point
        A point of the body in the reference configuration: motion is that of its nearest node,
        stress and pressure are those at the centre of the element that contains it.
    surface
        A face such as ``"bar.x_max"`` or a set, whose mean motion is that of the centre of mass of its
        nodes, :eq:`probe-mean`.
    resultant
        ``"contact"``, ``"obstacle"`` or ``"support"``, with a number where there are several, as
        in ``"contact[1]"``, counted from 0 as in error messages: the sum of its forces on the
        body, friction included, :eq:`probe-resultant`.
    quantities
        Recorded quantities: ``displacement``, ``velocity`` and ``acceleration`` of a point or a
        surface, ``stress`` and ``pressure`` of a point, ``force`` and ``moment`` (about the origin)
        of a resultant.
    every
        Steps between two rows.
    """

    one = (tuple(TAKEN),)
    needs = {"point": "body"}

    name: str = key(Name(), kw_only=False)
    body: str | None = key(Reference("body"), default=None, says="see text")
    point: Vector | None = key(VECTOR, unit="length", default=None, says="one of three")
    surface: Any = key(Surface(), default=None, says="one of three")
    resultant: Any = key(
        PartKey("contact", "obstacle", "support"), default=None, says="one of three"
    )
    quantities: Sequence[str] | None = key(
        Many(Choice(without(QUANTITIES, "time")), "name at least one"),
        default=None,
        says='``["displacement", "velocity"]``, or ``["force"]``',
    )
    every: int = key(Whole(most=2**53), default=1)

    @property
    def where(self) -> str:
        """The key that gives the place of the probe."""
        return next(name for name in TAKEN if getattr(self, name) is not None)

    @property
    def taken(self) -> tuple[str, ...]:
        """The quantities in the order of a row."""
        chosen = self.quantities or [name for name in USUAL if name in TAKEN[self.where]]
        return tuple(name for name in QUANTITIES if name in chosen)

    def refusals(self) -> Iterator[tuple[str, str]]:
        yield from super().refusals()
        if "/" in self.name or self.name == ".":
            yield (
                "name",
                f'"{self.name}" has a slash or is a dot, and a results file can\'t have a table of this name',
            )
        if self.body is not None and self.surface is not None:
            yield "body", f'cannot stand beside "surface", which names the body "{self.surface[0]}"'
        for i, name in enumerate(self.quantities or ()):
            if name not in TAKEN[self.where]:
                words = ", ".join(TAKEN[self.where])
                yield (
                    f"quantities[{i}]",
                    f'"{name}" is not recorded of a {self.where}, which has {words}',
                )


class FrontTime(Table):
    """A time, given by the distance that a plane wave travels.

    Attributes
    ----------
    length
        A length l.
    value
        :math:`c_1 t / l`.
    """

    length: float = key(POSITIVE, unit="length")
    value: float = key(POSITIVE)


class Time(Table):
    r"""End, step and integrator of the run. Only an end is required. At most one of ``courant``,
    ``fraction`` and ``dt`` sets the step; by default it is 0.9 of the stable one, at large strain
    0.7 (see :doc:`/theory/accuracy` for the accuracy).

    Attributes
    ----------
    end
        End of the run.
    end_c1t_over
        The end is :math:`t = v\,l/c_1` for the ``length`` l and the ``value`` v, with the
        fastest :math:`c_1` of the scene.
    courant
        :math:`c_1 \Delta t / h`, with the body where :math:`h / c_1` is smallest and h its
        shortest edge.
    fraction
        :math:`\Delta t` divided by the stable step that the library computes, including contact
        (:eq:`step-bound`). The default is 0.7 where an elastic body has a law for large strain,
        because short waves of four steps a period would gain energy there (:eq:`step-resonance`).
    dt
        :math:`\Delta t` itself.
    integrator
        All but ``"central_difference"`` damp oscillations of single elements
        (:doc:`/theory/integrator`).
    integrator_parameter
        Its parameter; the table of :doc:`/theory/integrator` has the ranges and the usual values.
    stable_step
        How the stable step is bounded. By default by single elements (:eq:`element-bound`), in
        boxes of equal hex8 by blocks of elements (:eq:`block-bound`). ``"assembled"`` bounds linear
        bodies as a whole (:eq:`assembled-bound`); on distorted or graded meshes it may allow a
        larger step, at the cost of about 70 force evaluations.
    force_tolerance
        Tolerance of the contact forces of a step, which are solved for together: the largest change
        by a further round, as a fraction of the largest force. The energy does not grow whatever it
        is (:eq:`energy-stop`). In a scene with dynamic ``relaxation`` the default is 1e-6, because
        there the errors of thousands of steps add up at points that are about to slip.
    until_static
        The run ends before ``end`` as soon as all histories have ended and its residual
        (:eq:`residual`) is not above this number. A run that does not come to rest issues a
        warning.
    energy_limit
        The run fails if spurious energy exceeds this fraction (:eq:`energy-appears`); above 0.2 % it
        warns (:eq:`energy-growth`).
    look_every
        Steps between two checks for faults (:doc:`/theory/faults`); the results do not depend on
        it.
    """

    one = (("end", "end_c1t_over"),)
    rivals = (("courant", "fraction", "dt"),)

    end: float | None = key(POSITIVE, unit="time", default=None, says="one of two", free=True)
    end_c1t_over: Any = key(Nested(FrontTime), default=None, says="one of two", free=True)
    courant: float | None = key(POSITIVE, default=None, says="see text")
    fraction: float | None = key(POSITIVE, default=0.9, says="0.9; at large strain 0.7")
    dt: float | None = key(POSITIVE, unit="time", default=None, says="see text")
    integrator: str = key(
        Choice(INTEGRATORS, GONE["integrator"]),
        default=word(INTEGRATORS, lib.CT_CENTRAL_DIFFERENCE),
    )
    integrator_parameter: float | None = key(Number(), default=None, says="by integrator")
    stable_step: str = key(Choice(("elements", "assembled")), default="elements")
    force_tolerance: float = key(Number(least=1e-12, most=0.1), default=CONTACT.force_tolerance)
    until_static: float | None = key(Number(least=1e-12), default=None, says="none", free=True)
    energy_limit: float = key(POSITIVE, default=1.0, free=True)
    look_every: int = key(Whole(most=2**53), default=1024, free=True)

    @property
    def step(self) -> tuple[str, float]:
        """The key that sets the step, and its value."""
        values = ((name, getattr(self, name)) for name in self.rivals[0])
        return next((name, value) for name, value in values if value is not None)

    @property
    def scheme(self) -> dict[str, Any]:
        """The members of a ``ct_integrator``."""
        return {"scheme": INTEGRATORS[self.integrator], "parameter": self.parameter}

    @property
    def parameter(self) -> float:
        """The parameter of the integrator, by default the integrator's own."""
        usual: float = lib.ct_integrator_default(INTEGRATORS[self.integrator]).parameter
        return usual if self.integrator_parameter is None else self.integrator_parameter

    @property
    def is_leapfrog(self) -> bool:
        """Whether the integrator moves as the leapfrog, by its name or by its parameter, :eq:`leapfrog`."""
        stage = ffi.new("ct_stage[2]")
        count = lib.ct_integrator_stages(ffi.new("ct_integrator *", self.scheme), stage)
        return (count, stage[0].tau, stage[0].c, stage[0].r, stage[0].l) == (1, 1.0, 1.0, 1.0, 0.0)

    def refusals(self) -> Iterator[tuple[str, str]]:
        error = new_error()
        if lib.ct_integrator_check(ffi.new("ct_integrator *", self.scheme), error) != lib.CT_OK:
            yield "integrator_parameter", ffi.string(error.text).decode()


class Output(Table):
    """
    The results file, its fields, and when to record: ``every`` n steps, or at the steps nearest
    to ``times``.

    Attributes
    ----------
    file
        Results file (VTKHDF). The path is relative to the current folder, unlike paths of meshes,
        which are relative to the folder of the scene. So a scene in a read-only folder can be run,
        and two runs of one scene in two folders write different files. Without this key the results
        stay in memory.
    fields
        Fields that are written for each node and element. ``contact_pressure``, which scenes without
        contacts and obstacles leave out by default, is recovered at the nodes of all surfaces in
        contact, :eq:`recovered-traction`, and 0 elsewhere.
    every
        Number of steps between two records.
    times
        Instead of ``every``: record at the steps nearest to these times.
    filter
        Number of passes of the zero-phase filter (:doc:`/theory/filter`). Each recorded
        displacement, velocity and stress gets a second field ``…_filtered`` without the short waves
        that the mesh cannot represent. The motion and the computed fields do not change.
    """

    rivals = (("every", "times"),)

    file: Any = key(FileName(), default=None, says="none", kw_only=False)
    fields: Sequence[str] | None = key(Many(Choice(FIELDS)), default=None, says="all fields")
    every: int | None = key(
        Whole(most=2**53),
        default=None,
        says="about 100 records, fewer if they would cost more than the steps",
    )
    times: Sequence[float] | None = key(Many(FORWARD), unit="time", default=None, says="none")
    filter: int = key(Whole(0, most=8), default=0)


class Run(Table):
    """How the scene is computed; results do not depend on it.

    Attributes
    ----------
    threads
        Number of threads; the results have the same bits for any number. A child of ``fork``
        computes with one thread if its parent has used several, because OpenMP's threads do not
        exist after a fork.
    savings
        Optimisations, which do not change results (:doc:`/theory/savings`).
    """

    threads: int = key(Whole(most=1024), default=1)
    savings: Sequence[str] = key(Many(Choice(SAVINGS, GONE["savings"])), default=SAVINGS)
