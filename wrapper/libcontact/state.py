"""The bodies of a run at one time: their fields and the components of these."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import lib
from .bridge import Floats, Ints, call, doubles
from .mesh import Mesh, c_mesh
from .model import FILTERED, Material, c_material
from .schema import suggestion

__all__ = ["BodyState", "State"]

STRESS = ("xx", "yy", "zz", "xy", "yz", "zx")
PARTS = {"stress": STRESS, "displacement": "xyz", "velocity": "xyz"}


def mises(stress: Floats) -> Floats:
    """Von Mises stresses (n,) of stresses xx yy zz xy yz zx (n, 6), the root of 3/2 s : s of the deviator s."""
    normal, shear = stress[:, :3] - stress[:, :3].mean(axis=1, keepdims=True), stress[:, 3:]
    out: Floats = np.sqrt(1.5 * (normal**2).sum(axis=1) + 3.0 * (shear**2).sum(axis=1))
    return out


def principal(stress: Floats) -> Floats:
    """Principal stresses (n, 3) of stresses (n, 6), their eigenvalues in ascending order; tension is positive."""
    values: Any = np.linalg.eigvalsh(stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]])
    out: Floats = values
    return out


COMPONENTS: dict[str, tuple[str, int | Callable[[Floats], Floats]]] = {
    f"{field}_{part}": (field, i) for field in PARTS for i, part in enumerate(PARTS[field])
}
COMPONENTS |= {
    "contact_pressure": ("contact_pressure", 0),
    "mises": ("stress", mises),
    "pressure": ("stress", lambda stress: -stress[:, :3].mean(axis=1)),
    "principal_max": ("stress", lambda stress: principal(stress)[:, 2]),
    "principal_mid": ("stress", lambda stress: principal(stress)[:, 1]),
    "principal_min": ("stress", lambda stress: principal(stress)[:, 0]),
    "displacement_magnitude": ("displacement", lambda u: np.linalg.norm(u, axis=1)),
    "velocity_magnitude": ("velocity", lambda v: np.linalg.norm(v, axis=1)),
}


class BodyState:
    """One body at one time. All arrays are read-only; reading a field that was not recorded is a
    ValueError.

    Attributes
    ----------
    name : str
        Name of the body.
    mesh : Mesh
        Its reference configuration.
    material : Material or None
        Its material; of several the stiffest. None if it is not known, as for a body of several materials in a
        results file.
    initial_stress : sequence or None
        Its stress without displacement, xx yy zz xy yz zx [stress]; None: 0.
    """

    def __init__(
        self,
        name: str,
        mesh: Mesh,
        material: Material | None,
        initial_stress: Sequence[float] | None = None,
        by_material: Sequence[tuple[Material, NDArray[Any]]] = (),
        **fields: Floats | Callable[[], Floats] | None,
    ):
        """A field is its values, or a function that computes them on first use; ``by_material`` has the elements
        of each of several materials."""
        self.name, self.mesh, self.material, self._fields = name, mesh, material, fields
        self.initial_stress = initial_stress
        self._by_material = tuple(by_material)

    def __getstate__(self) -> dict[str, Any]:
        # A copy or a pickle contains the values, not the functions.
        for name in [name for name, values in self._fields.items() if callable(values)]:
            self._field(name)
        return self.__dict__

    def holds(self, field: str) -> bool:
        """Check whether a field is available.

        Parameters
        ----------
        field : {"displacement", "velocity", "stress", "contact_pressure"}
            The field; stress is available if it was recorded or can be computed.

        Returns
        -------
        bool
            True if the field can be read.
        """
        computed = field == "stress" and self.material is not None
        return self._fields.get(field) is not None or (computed and self.holds("displacement"))

    def _field(self, field: str) -> Floats:
        if not self.holds(field):
            reason = f"{field} was not recorded; name it in [output] fields"
            raise ValueError(f'body "{self.name}": {reason}')
        values = self._fields.get(field)
        if values is None:
            assert self.material is not None
            values = self._fields[field] = np.empty((len(self.elements), 6))
            for material, numbers in self._by_material or ((self.material, slice(None)),):
                elements = np.ascontiguousarray(self.elements[numbers])
                own = np.empty((len(elements), 6))
                given = (c_mesh(self.mesh.nodes, elements), c_material(material))
                call(lib.ct_solid_stress, *given, doubles(self.displacement), doubles(own))
                values[numbers] = own
            if self.initial_stress is not None:
                values += np.array(self.initial_stress)
        if callable(values):
            values = self._fields[field] = values()
        values.flags.writeable = False
        return values

    @property
    def filtered(self) -> BodyState:
        """The body with the filtered fields, :eq:`filter-pass`, instead of the computed ones; requires
        ``[output] filter``."""
        names = [name for name in FILTERED if self._fields.get(name) is not None]
        if not names:
            raise ValueError(f'body "{self.name}": nothing was filtered; set [output] filter')
        fields = {name.removesuffix("_filtered"): self._field(name) for name in names}
        mesh, stress, of = self.mesh, self.initial_stress, self._by_material
        return BodyState(self.name, mesh, self.material, stress, of, **fields)

    @property
    def nodes(self) -> Floats:
        """Reference coordinates [length], shape (nodes, 3)."""
        return self.mesh.nodes

    @property
    def elements(self) -> Ints:
        """Node numbers of the elements, in VTK's order, shape (elements, 8 or 20)."""
        return self.mesh.elements

    @property
    def centres(self) -> Floats:
        """Reference coordinates of the element centres [length], shape (elements, 3)."""
        return self.mesh.centres()

    @property
    def displacement(self) -> Floats:
        """Displacements of the nodes [length], shape (nodes, 3)."""
        return self._field("displacement")

    @property
    def velocity(self) -> Floats:
        """Velocities of the nodes [length / time], shape (nodes, 3)."""
        return self._field("velocity")

    @property
    def positions(self) -> Floats:
        """Current coordinates of the nodes [length], shape (nodes, 3)."""
        return self.nodes + self.displacement

    @property
    def stress(self) -> Floats:
        """Stresses xx yy zz xy yz zx at the element centres [force / length²], shape (elements, 6)."""
        return self._field("stress")

    @property
    def contact_pressure(self) -> Floats:
        """Contact pressure at the nodes [force / length²], shape (nodes,), :eq:`recovered-traction`; 0 away
        from all contact surfaces."""
        return self._field("contact_pressure")

    def component(self, name: str) -> tuple[Floats, bool]:
        """
        Read one component of a field.

        Parameters
        ----------
        name : str
            ``stress_xx``, ``velocity_z``, ``displacement_x`` and the like, ``contact_pressure``, ``mises``,
            ``pressure`` (minus the mean of the normal stresses), ``principal_max``, ``principal_mid``,
            ``principal_min``, ``displacement_magnitude`` or ``velocity_magnitude``.

        Returns
        -------
        values : ndarray, shape (elements,) or (nodes,)
            The component.
        at_elements : bool
            Whether it has one value per element, else one per node.

        Raises
        ------
        ValueError
            No component has this name, or it was not recorded.
        """
        if name not in COMPONENTS:
            raise ValueError(f'no component is named "{name}"' + suggestion(name, COMPONENTS))
        field, part = COMPONENTS[name]
        rows = self._field(field).reshape(-1, len(PARTS.get(field, "p")))
        return part(rows) if callable(part) else rows[:, part], field == "stress"

    def sample(self, name: str, points: Floats) -> Floats:
        """
        Sample a component at points of the reference configuration.

        Parameters
        ----------
        name : str
            As for :meth:`component`.
        points : ndarray, shape (m, 3)
            The points [length].

        Returns
        -------
        ndarray, shape (m,)
            The values, as for :meth:`libcontact.run.Run.line`; NaN outside the body.

        Raises
        ------
        ValueError
            As for :meth:`component`.
        """
        values, at_elements = self.component(name)
        elements, xi = self.mesh.locate(points)
        out = np.full(len(points), np.nan)
        for i in np.flatnonzero(elements >= 0):
            e = elements[i]
            out[i] = values[e] if at_elements else self.mesh.shape(xi[i]) @ values[self.elements[e]]
        return out


class State(dict[str, BodyState]):
    """
    The bodies at one time, by name: ``run.state["right"].displacement``.

    Attributes
    ----------
    time : float
        The time [time].
    step : int
        Number of the step.
    """

    def __init__(self, time: float, step: int, bodies: dict[str, BodyState]):
        super().__init__(bodies)
        self.time, self.step = time, step

    def __missing__(self, name: str) -> BodyState:
        raise KeyError(f'no body is named "{name}"' + suggestion(name, self))

    def __repr__(self) -> str:
        return f"State(time={self.time:g}, step={self.step}, bodies={list(self)})"
