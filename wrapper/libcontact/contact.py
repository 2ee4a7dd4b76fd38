"""The contact of a host with its own time loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ._core import ffi, lib
from .bridge import Floats, Rows, ask, call, doubles, names, real, row
from .errors import check
from .search import Surface

__all__ = ["Balance", "Contact"]


@dataclass(frozen=True)
class Balance:
    """Energy balance of the steps of a contact; ``energy + work - removal`` never grows, for steps of one length in which gaps are linear in the motion."""

    #: Energy that the contact holds at t_n [energy].
    energy: float
    #: Work that its forces have done on the bodies from t_0 to t_n [energy].
    work: float
    #: Work that start gaps have done while they fade [energy].
    removal: float
    #: Number of steps in which the forces did not converge.
    unconverged: int


class Contact:
    """
    The contact of two surfaces, or of one with itself, in a time loop of your own: one call per step.

    The coordinates that the surfaces were made with are the reference shape. Surfaces that were made with the same array
    number their nodes in one array, and the calls below take one array for both. For two arrays the calls take a
    pair of them, the first surface's first. Arrays of float64 in C order cross to C without a copy.

    Parameters
    ----------
    first : Surface
        A surface of the host's bodies.
    second : Surface, optional
        The surface that it meets; without it the first one meets itself.
    epsilon : float
        Penalty [stress / length]; see :meth:`penalty`.
    enforcement : {"energy_controlled", "penalty", "bipenalty"}
        How gaps give forces.
    dissipation : float
        Damping ratio of the surface mode, 0 ... 1; for ``"energy_controlled"``.
    points : {"gauss", "lobatto"}
        Where the faces have contact points.
    initial_penetration : {"keep", "push", "refuse", "remove"}
        What becomes of points that are inside in the first step.
    removal_time : float
        Time in which ``"remove"`` parts the surfaces [time].
    adjust : float
        Gaps and overlaps at the start up to this are taken as touching [length].
    depth : float
        How far points look for the other surface [length]; 0: as far as the size of a face.
    threads : int
        Number of threads; it changes no bit.

    Raises
    ------
    TypeError, ValueError
        An argument is impossible.

    Examples
    --------
    A plate of mass 1 falls on one that is held:

    >>> import numpy as np
    >>> import libcontact as ct
    >>> floor = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> x = floor + [0, 0, 0.1]
    >>> plate = ct.Surface("Q4", x, [[0, 3, 2, 1]])
    >>> contact = ct.Contact(plate, ct.Surface("Q4", floor, [[0, 1, 2, 3]]), epsilon=1e3)
    >>> v = np.zeros_like(x)
    >>> v[:, 2] = -1.0
    >>> dt, free, held = 0.01, np.full_like(x, 4.0), np.zeros_like(x)
    >>> for step in range(30):
    ...     force = np.zeros_like(x)
    ...     kick = dt if step else dt / 2
    ...     contact.step(dt, (x, floor), (v, held), (free, held), kick=kick)
    ...     contact.add_force((force, np.zeros_like(x)))
    ...     v += kick * free * force
    ...     x += dt * v
    >>> bool(v[0, 2] > 0.6)
    True
    >>> bool(contact.balance.work <= 0)
    True
    """

    def __init__(
        self,
        first: Surface,
        second: Surface | None = None,
        *,
        epsilon: float,
        enforcement: str = "energy_controlled",
        dissipation: float = 0.15,
        points: str = "gauss",
        initial_penetration: str = "keep",
        removal_time: float = 0.0,
        adjust: float = 0.0,
        depth: float = 0.0,
        threads: int = 1,
    ):
        options = ffi.new("ct_contact_options *", lib.ct_contact_options_default())
        options.epsilon, options.dissipation = epsilon, dissipation
        options.removal_time, options.adjust = removal_time, adjust
        options.depth, options.threads = depth, threads
        options.enforcement = _number("enforcement", "ct_enforcement", enforcement)
        options.points = _number("points", "ct_contact_rule", points)
        options.initial_penetration = _number(
            "initial_penetration", "ct_initial", initial_penetration
        )
        surfaces = [first] if second is None else [first, second]
        other = first.given
        if second is not None:
            other = ffi.new("ct_surface *", second.given[0])
            if second.asked is first.asked:  # one array of nodes, also where it was converted twice
                other.reference = first.given.reference
        made = ask("ct_contact **", lib.ct_contact_create, first.given, other, options)
        self._contact = ffi.gc(made, lib.ct_contact_free)
        self._counts = [surface.given.node_count for surface in surfaces]
        self._pair = other.reference != first.given.reference

    @staticmethod
    def penalty(modulus: float, h: float, enforcement: str = "energy_controlled") -> float:
        """
        The penalty that suits an enforcement.

        Parameters
        ----------
        modulus : float
            The smaller modulus ρ c₁² of the two materials [stress].
        h : float
            The shortest edge of their elements [length].
        enforcement : str
            As for the contact.

        Returns
        -------
        float
            ε [stress / length].

        Raises
        ------
        ValueError
            There is no such enforcement.
        """
        number = _number("enforcement", "ct_enforcement", enforcement)
        return float(lib.ct_contact_penalty_default(number, modulus, h))

    def step(
        self,
        dt: float,
        x: Any,
        velocity: Any,
        inverse_mass: Any,
        force: Any = None,
        *,
        kick: float | None = None,
        increment: Any = None,
    ) -> None:
        """
        Find the contact forces of the coming step v_{n+1/2} = v_{n-1/2} + kick f / m, x_{n+1} = x_n + dt v_{n+1/2}.

        Call it once per step, with all forces but those of the contact; then :meth:`add_force`.

        Parameters
        ----------
        dt : float
            Length of the coming step [time].
        x : array_like, shape (n, 3), or a pair of them
            Coordinates x_n [length].
        velocity : array_like, shape (n, 3), or a pair of them
            Velocities v_{n-1/2} [length / time]; in the first step v_0.
        inverse_mass : array_like, shape (n, 3), or a pair of them
            Inverse masses of all components [1 / mass]; 0 where the motion is prescribed.
        force : array_like, shape (n, 3), or a pair of them, optional
            Sum of all other forces at t_n [force].
        kick : float, optional
            Time for which the forces change the velocity [time]: dt, if not given; half of it in the first step, which begins with v_0; the
            mean of two steps where they differ.
        increment : array_like, shape (n, 3), or a pair of them, optional
            Displacement increments x_{n+1} - x_n without the contact [length], in place of those of the step above; for
            prescribed motions, damping and other integrators.

        Raises
        ------
        TypeError, ValueError
            An argument is impossible, or a coordinate not finite.
        GeometryError
            Surfaces overlap at the start, and ``"refuse"`` was chosen.
        StepError
            The last step may have brought the surfaces through each other.
        BlowupError
            Forces are not finite.
        """
        given = {
            "x": x,
            "velocity": velocity,
            "force": force,
            "inverse_mass": inverse_mass,
            "increment": increment,
        }
        prediction = ffi.new("ct_contact_prediction *")
        prediction.dt, prediction.kick = dt, dt if kick is None else kick
        arrays = []  # what C is given lives until the call returns
        for name, values in given.items():
            if values is None and name in ("force", "increment"):
                continue
            for side, (part, count) in enumerate(zip(self._parts(name, values), self._counts)):
                arrays.append(doubles(real(name, part, (count, 3))))
                setattr(prediction, f"{name}_{'ab'[side]}", arrays[-1])
        call(lib.ct_contact_step, self._contact, prediction)

    def add_force(self, force: Any) -> None:
        """
        Add the contact forces of the last step.

        Parameters
        ----------
        force : ndarray of float64 in C order, shape (n, 3), or a pair of them
            Forces of the host, in which the sums are written [force].

        Raises
        ------
        TypeError, ValueError
            An array is not of this kind, so that nothing could be written into it.
        """
        arrays = []
        for part, count in zip(self._parts("force", force), self._counts):
            if not (
                isinstance(part, np.ndarray)
                and part.dtype == np.float64
                and part.flags.c_contiguous
                and part.flags.writeable
            ):
                raise TypeError("force must be a writable array of float64 in C order")
            arrays.append(doubles(real("force", part, (count, 3))))
        check(lib.ct_contact_add_force(self._contact, arrays[0], arrays[-1]))

    @property
    def energy(self) -> float:
        """Energy that the contact holds at t_n [energy]."""
        return float(lib.ct_contact_energy(self._contact))

    @property
    def balance(self) -> Balance:
        """Energy balance since the first step."""
        out = ffi.new("ct_contact_balance *")
        check(lib.ct_contact_balance_of(self._contact, out))
        return Balance(out.energy, out.work, out.removal, out.unconverged)

    @property
    def points(self) -> Rows:
        """All contact points of the last step, a row each, with the members of ``ct_contact_point``."""
        count = lib.ct_contact_point_count(self._contact)
        rows = np.empty(count, row("ct_contact_point"))
        check(lib.ct_contact_points(self._contact, ffi.from_buffer("ct_contact_point[]", rows)))
        return rows

    @property
    def resultant(self) -> Floats:
        """Resultant force on each surface and its moment about the origin, shape (surfaces, 2, 3) [force, force · length]."""
        out = np.zeros((2, 2, 3))
        check(lib.ct_contact_resultant(self._contact, *map(doubles, out.reshape(4, 3))))
        return out[: len(self._counts)]

    def stable_step(self, mass: Any) -> float:
        """
        Largest stable step of the contact alone, for ``"penalty"``; the other enforcements do not limit the step.

        Parameters
        ----------
        mass : array_like, shape (n,), or a pair of them
            Masses of the nodes [mass].

        Returns
        -------
        float
            2 / ω [time]; with the host's own limit it gives 1 / sqrt(1 / dt² + 1 / dt_host²).

        Raises
        ------
        ValueError
            A mass is not positive.
        """
        parts = zip(self._parts("mass", mass), self._counts)
        arrays = [doubles(real("mass", part, (count,))) for part, count in parts]
        dt = ffi.new("double *")
        check(lib.ct_contact_stable_step(self._contact, arrays[0], arrays[-1], dt))
        return float(dt[0])

    def _parts(self, name: str, values: Any) -> list[Any]:
        """What a call is given of each surface: a pair, or one array for both."""
        if not self._pair:
            return [values] * len(self._counts)
        if not isinstance(values, (tuple, list)) or len(values) != 2:
            raise ValueError(f"{name} must be a pair of arrays, one of each surface")
        return list(values)


def _number(name: str, enum: str, word: str) -> int:
    words = names(enum)
    if word not in words:
        raise ValueError(f'{name} must be one of {", ".join(words)}, not "{word}"')
    return words[word]
