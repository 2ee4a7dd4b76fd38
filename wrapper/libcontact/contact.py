"""The contact of a host with its own time loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from ._core import ffi, lib
from .bridge import (
    Floats,
    Rows,
    ask,
    call,
    chosen,
    doubles,
    finite,
    index,
    names,
    point_rows,
    positive,
    real,
)
from .effects.obstacle import Obstacle
from .errors import SceneWarning, came_in_late, held, issue, renamed
from .schema import Place
from .search import Surface

__all__ = ["Balance", "Contact"]


@dataclass(frozen=True)
class Balance:
    """
    Energy balance of the steps of a contact.

    ``energy + work - removal - motion`` never grows, for steps of one length in which gaps are linear
    in the motion. Where they are not, it may grow again after a loss; without obstacles it stays below its value at the
    start.
    """

    #: Energy stored at t_n in contact, obstacles, and the elastic springs of friction [energy].
    energy: float
    #: Work of its forces on the bodies from t_0 to t_n [energy].
    work: float
    #: Work of the decreasing start gaps [energy].
    removal: float
    #: Number of steps in which the forces did not converge.
    unconverged: int
    #: Energy dissipated by friction [energy].
    friction: float
    #: Work of moving obstacles on the bodies [energy].
    motion: float
    #: Number of points that were found inside without having come in through the surface, as over the
    #: border of an open surface.
    late: int = 0
    #: Largest of their depths [length].
    late_depth: float = 0.0


PLACES = {"points": lib.CT_AT_POINTS, "corners": lib.CT_AT_CORNERS, "edges": lib.CT_AT_EDGES}


def depths(found: Any) -> dict[str, Any]:
    """The members of a ``ct_penetration`` but its surface."""
    numbers = ("inside", "buried", "deepest", "face", "touching", "late", "late_depth")
    return {name: getattr(found, name) for name in numbers} | {"position": tuple(found.position)}


def _initial(name: str) -> int:
    """The number of a treatment of overlaps at the start."""
    return chosen("initial_penetration", name, names("ct_initial"))


def _warn_of_inside_out(surfaces: Sequence[Surface]) -> None:
    """Warn of closed surfaces whose faces point inwards, unless the other surface is within, as in a
    cavity."""
    boxes = [surface.bounds for surface in surfaces]
    for k, surface in enumerate(surfaces):
        face, (low, high) = surface.inside_out, boxes[k]
        within = any(
            (low <= lower).all() and (upper <= high).all()
            for lower, upper in boxes[:k] + boxes[k + 1 :]
        )
        if face is not None and not within:
            who = "the surface" if len(surfaces) == 1 else f"the {('first', 'second')[k]} surface"
            issue(
                SceneWarning(
                    "inside_out",
                    f"face {face} of {who} and the faces around it point inwards: they enclose a negative "
                    "volume, so no contact force acts and bodies pass through each other; list the "
                    "corners of each face counter-clockwise from outside",
                )
            )


def exchanged(function: Callable[[Floats], None]) -> Any:
    """A function of ``ct_pieces`` that calls one of Python; what it raises ends the step."""

    def answer(data: Any, values: Any, count: int) -> int:
        try:
            function(np.frombuffer(ffi.buffer(values, 8 * count), np.float64))
        except BaseException as reason:  # whatever the user's function raises
            held.reason = reason
            return 1
        return 0

    return ffi.callback("int(void *, double *, int64_t)", answer)


def shape_of(given: dict[str, Any]) -> tuple[str, Any]:
    """The name of the one shape that is given, and its table, checked as in a scene."""
    there = [name for name, table in given.items() if table is not None]
    if len(there) != 1:
        example = 'plane={"point": [0, 0, 0], "normal": [0, 0, 1]}'
        raise TypeError(f"add_obstacle: give one of plane, sphere and cylinder, such as {example}")
    kind = Obstacle.keys()[there[0]].metadata["kind"]
    return there[0], kind.read(given[there[0]], Place(there[0], "add_obstacle"))


class Contact:
    """Contact of two surfaces, or of one with itself, and with rigid obstacles, in a host's own
    time loop: one call per step.

    The coordinates with which the surfaces were created are the reference shape. If both surfaces
    were created from one array of nodes, the calls below take one array for both; otherwise they
    take a pair of arrays, that of the first surface first. Arrays of float64 in C order are passed
    to C without a copy.

    Parameters
    ----------
    first : Surface
        A surface of the host's bodies.
    second : Surface, optional
        The other surface. Without it the first one is in contact with itself, or with
        ``itself=False`` only with obstacles.
    epsilon : float
        Penalty [stress / length]; see :meth:`penalty` and :meth:`penalty_default`.
    enforcement : {"energy_controlled", "penalty"}
        Law by which forces follow from gaps.
    dissipation : float
        Damping ratio of the surface mode, 0 ... 1; for ``"energy_controlled"``.
    restitution : float
        Share of the energy lost at closing that is held and given back at opening, 0 ... 1; for
        ``"energy_controlled"``. With 1 an elastic impact loses almost nothing; with 0 it stops the
        layer of nodes at the surface.
    travel_time : float
        Time h / c1 in which a wave crosses an element at the surface [time], :eq:`travel-time` if
        the bodies differ. :meth:`step` refuses 0 if ``restitution`` is above 0.
    points : {"gauss", "lobatto"}
        Positions of the contact points on a face.
    initial_penetration : {"keep", "force", "refuse", "remove"}
        Treatment of points that penetrate in the first step.
    removal_time : float
        Time in which ``"remove"`` separates the surfaces [time].
    adjust : float
        Gaps and overlaps at the start up to this value count as touching [length].
    depth : float
        Search distance from a point to the other surface [length]; 0: the size of a face.
    force_tolerance : float
        Tolerance of the forces of :meth:`step`, as a fraction of the largest one.
    threads : int
        Number of threads; results do not depend on it.
    friction : float
        Coefficient of Coulomb friction between the surfaces; 0: none.
    tangent : float
        Stiffness of the tangential spring of this friction over that of the penalty; it does not limit the step.
    itself : bool
        Whether a single surface is in contact with itself.

    Raises
    ------
    TypeError, ValueError
        An argument is invalid.

    Examples
    --------
    A plate of mass 1 falls on one that is held:

    >>> import numpy as np
    >>> import libcontact as ct
    >>> floor = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    >>> x = floor + [0, 0, 0.1]
    >>> plate = ct.Surface("Q4", x, [[0, 3, 2, 1]])
    >>> ground = ct.Surface("Q4", floor, [[0, 1, 2, 3]])
    >>> contact = ct.Contact(plate, ground, epsilon=1e3, travel_time=0.05)
    >>> v = np.zeros_like(x)
    >>> v[:, 2] = -1.0
    >>> dt, free, held = 0.01, np.full_like(x, 4.0), np.zeros_like(x)
    >>> for step in range(30):
    ...     force = np.zeros_like(x)
    ...     tau = dt if step else dt / 2
    ...     contact.step(dt, (x, floor), (v, held), (free, held), force_time=tau)
    ...     contact.add_force((force, np.zeros_like(x)))
    ...     v += tau * free * force
    ...     x += dt * v
    >>> bool(v[0, 2] > 0.98)
    True
    >>> bool(abs(contact.balance.work) < 1e-12)
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
        restitution: float = 1.0,
        travel_time: float = 0.0,
        points: str = "gauss",
        initial_penetration: str = "keep",
        removal_time: float = 0.0,
        adjust: float = 0.0,
        depth: float = 0.0,
        force_tolerance: float = 1e-4,
        threads: int = 1,
        friction: float = 0.0,
        tangent: float = 1.0,
        itself: bool = True,
    ):
        surfaces = [first] if second is None else [first, second]
        if not all(isinstance(surface, Surface) for surface in surfaces):
            raise TypeError("a contact needs a Surface, or two of them")
        options = ffi.new("ct_contact_options *", lib.ct_contact_options_default())
        numbers = {
            "epsilon": epsilon,
            "dissipation": dissipation,
            "restitution": restitution,
            "travel_time": travel_time,
            "removal_time": removal_time,
            "adjust": adjust,
            "depth": depth,
            "force_tolerance": force_tolerance,
        }
        for name, value in numbers.items():
            setattr(options, name, finite(name, value))
        options.threads = index("threads", threads)
        options.enforcement = chosen("enforcement", enforcement, names("ct_enforcement"))
        options.points = chosen("points", points, names("ct_contact_rule"))
        options.initial_penetration = _initial(initial_penetration)
        other = first.given if itself or second is not None else ffi.NULL
        if second is not None:
            other = ffi.new("ct_surface *", second.given[0])
            if second.asked is first.asked:  # one array of nodes, also where it was converted twice
                other.reference = first.given.reference
        made = ask("ct_contact **", lib.ct_contact_create, first.given, other, options)
        if itself or second is not None:
            _warn_of_inside_out(surfaces)
        self._contact = ffi.gc(made, lib.ct_contact_free)
        self._counts = [surface.given.node_count for surface in surfaces]
        self._faces = [surface.given.face_count for surface in surfaces]
        self._pair = second is not None and other.reference != first.given.reference
        self._enforcement, self._sides, self._told = enforcement, list[int](), False
        self._restitution, self._travel_time = restitution, travel_time
        self._add_friction(-1, *self._rubbing(friction, tangent))

    @staticmethod
    def penalty(beta: float, young: float, h: float) -> float:
        """Penalty β E / h, :eq:`penalty-factor`, as a scene has it by its key ``beta``.

        Parameters
        ----------
        beta : float
            The factor.
        young : float
            The smaller Young's modulus of the two materials [stress].
        h : float
            The shortest edge of their elements [length].

        Returns
        -------
        float
            ε [stress / length].
        """
        given = {"beta": beta, "young": young, "h": h}
        sizes = (positive(name, finite(name, size)) for name, size in given.items())
        return float(lib.ct_contact_penalty(*sizes))

    @staticmethod
    def penalty_default(modulus: float, h: float, enforcement: str = "energy_controlled") -> float:
        """Default penalty of an enforcement, as a scene has it without ``beta`` and ``epsilon``.

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
            Unknown enforcement.
        """
        number = chosen("enforcement", enforcement, names("ct_enforcement"))
        sizes = (
            positive(name, finite(name, size)) for name, size in (("modulus", modulus), ("h", h))
        )
        return float(lib.ct_contact_penalty_default(number, *sizes))

    @renamed(shape="plane={...}, sphere={...} or cylinder={...}")
    def add_obstacle(
        self,
        plane: Any = None,
        sphere: Any = None,
        cylinder: Any = None,
        *,
        epsilon: float,
        velocity: Any = (0.0, 0.0, 0.0),
        travel: Any = (0.0, 0.0, 0.0),
        history: tuple[Any, Any] | None = None,
        dissipation: float = 0.15,
        restitution: float | None = None,
        travel_time: float | None = None,
        points: str = "gauss",
        initial_penetration: str = "keep",
        removal_time: float = 0.0,
        adjust: float = 0.0,
        friction: float = 0.0,
        tangent: float = 1.0,
        surface: int = 0,
    ) -> int:
        """Add a rigid obstacle, before the first step. It uses the enforcement of the contact.

        Parameters
        ----------
        plane, sphere, cylinder : dict
            One of the three, with the keys that it has in a scene: ``plane={"point": p, "normal": n}``,
            ``sphere={"centre": c, "radius": r}``, ``cylinder={"centre": c, "radius": r, "axis": a}`` in the first
            step [length]. The normal points out of the obstacle.
        epsilon : float
            Penalty [stress / length].
        velocity : array_like, shape (3,)
            Its constant velocity [length / time].
        travel : array_like, shape (3,)
            Its displacement when the factor of the history is 1 [length].
        history : pair of array_like, optional
            Times, from the first step on, and factors.
        dissipation : float
            Damping ratio, as for :class:`Contact`.
        restitution, travel_time : float, optional
            As for :class:`Contact`, whose values they are without them.
        points, initial_penetration : str
            As for :class:`Contact`.
        removal_time, adjust, friction, tangent : float
            As for :class:`Contact`.
        surface : int
            The surface in contact with it, 0 or 1.

        Returns
        -------
        int
            Its number, for :meth:`reaction` and :meth:`traction`.

        Raises
        ------
        TypeError, ValueError
            An argument is invalid, or a step was already taken.
        """
        definition = ffi.new("ct_obstacle_def *", lib.ct_obstacle_def_default())
        name, shape = shape_of({"plane": plane, "sphere": sphere, "cylinder": cylinder})
        definition.shape, definition.radius = names("ct_obstacle_shape")[name], shape.radius
        definition.enforcement = chosen("enforcement", self._enforcement, names("ct_enforcement"))
        definition.points = chosen("points", points, names("ct_contact_rule"))
        definition.initial_penetration = _initial(initial_penetration)
        definition.point, definition.axis = shape.point, shape.axis
        for name, values in {"velocity": velocity, "travel": travel}.items():
            setattr(definition, name, real(name, values, (3,)).tolist())
        for name, value in {
            "epsilon": epsilon,
            "dissipation": dissipation,
            "restitution": self._restitution if restitution is None else restitution,
            "travel_time": self._travel_time if travel_time is None else travel_time,
            "removal_time": removal_time,
            "adjust": adjust,
        }.items():
            setattr(definition, name, finite(name, value))
        pair = ((), ()) if history is None else history
        if not isinstance(pair, (tuple, list, np.ndarray)) or len(pair) != 2:
            raise ValueError(f"history must be a pair of times and factors, not {history!r}")
        arrays = [real("history", part, ("n",)) for part in pair]
        if len(arrays[0]) != len(arrays[1]):
            raise ValueError("history must be a pair of times and as many factors")
        definition.amplitude.count = len(arrays[0])
        definition.amplitude.time, definition.amplitude.value = map(doubles, arrays)
        side, number = index("surface", surface), len(self._sides)
        rubbing = self._rubbing(
            friction, tangent
        )  # invalid friction must not leave an obstacle behind
        call(lib.ct_contact_add_obstacle, self._contact, side, definition)
        self._sides.append(side)
        self._add_friction(number, *rubbing)
        return number

    def set_pieces(
        self, owned: Any, add: Callable[[Floats], None], largest: Callable[[Floats], None]
    ) -> None:
        """Let this contact be one piece of several, each with its own contact of the same surfaces.

        Each piece computes the points of its own faces, and passes and gets the arrays of a host
        without pieces, with the same bits. From here on all pieces make the same calls at the same
        time. Call it before the first step.

        Parameters
        ----------
        owned : array_like of bool, shape (number of faces), or a pair of them
            The faces of each surface that are this piece's; each face has one piece.
        add : callable
            Replaces the numbers of an array by their sums over all pieces, as with mpi4py
            ``lambda a: comm.Allreduce(MPI.IN_PLACE, a, MPI.SUM)``.
        largest : callable
            Replaces them by the largest of all pieces, as with ``MPI.MAX``.

        Raises
        ------
        ValueError
            A mask of another shape, a face that has no piece or several, or a step was taken.
        """
        pair = owned if len(self._faces) == 2 else (owned,)
        if len(pair) != len(self._faces):
            raise ValueError("two surfaces need a pair of masks")
        masks = []
        for given, count in zip(pair, self._faces):
            mask = np.ascontiguousarray(given, np.uint8)
            if mask.shape != (count,):
                raise ValueError(f"a mask has shape {mask.shape}; it must be ({count},)")
            masks.append(ffi.from_buffer("uint8_t *", mask))
        self._exchange = [exchanged(add), exchanged(largest)]
        pieces = ffi.new("ct_pieces *", [ffi.NULL, *self._exchange])
        second = masks[1] if len(masks) == 2 else ffi.NULL
        call(lib.ct_contact_set_pieces, self._contact, masks[0], second, pieces)

    @staticmethod
    def _rubbing(friction: float, tangent: float) -> tuple[float, float]:
        """Check coefficient and tangential ratio, and return them."""
        mu, ratio = finite("friction", friction), finite("tangent", tangent)
        return mu and positive("friction", mu), mu and positive("tangent", ratio)

    def _add_friction(self, on: int, coefficient: float, ratio: float) -> None:
        """Friction of an obstacle, or of the surfaces with -1, unless the coefficient is 0."""
        if coefficient != 0.0:
            call(lib.ct_contact_add_friction, self._contact, on, coefficient, ratio)

    @renamed(kick="force_time")
    def step(
        self,
        dt: float,
        x: Any,
        velocity: Any,
        inverse_mass: Any,
        force: Any = None,
        *,
        force_time: float | None = None,
        increment: Any = None,
    ) -> None:
        """Compute the contact forces of the next step v_{n+1/2} = v_{n-1/2} + force_time f / m, x_{n+1} =
        x_n + dt v_{n+1/2}.

        Call it once per step, with all forces but those of the contact; then :meth:`add_force`.

        Parameters
        ----------
        dt : float
            Length of the next step [time].
        x : array_like, shape (n, 3), or a pair of them
            Coordinates x_n [length].
        velocity : array_like, shape (n, 3), or a pair of them
            Velocities v_{n-1/2} [length / time]; in the first step v_0.
        inverse_mass : array_like, shape (n, 3), or a pair of them
            Inverse masses of all components [1 / mass]; 0 where the motion is prescribed.
        force : array_like, shape (n, 3), or a pair of them, optional
            Sum of all other forces at t_n [force].
        force_time : float, optional
            Time for which the forces change the velocity [time]: dt by default; half of it in the
            first step, which begins with v_0; the mean of two steps of different length.
        increment : array_like, shape (n, 3), or a pair of them, optional
            Displacement increments x_{n+1} - x_n without the contact [length], instead of those of
            the step above; for prescribed motions, damping and other integrators.

        Raises
        ------
        TypeError, ValueError
            An argument is invalid, or a coordinate is not finite.
        GeometryError
            Surfaces overlap at the start, and ``"refuse"`` was chosen.
        StepError
            The surfaces may have passed through each other in the last step.
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
        prediction.dt = finite("dt", dt)
        prediction.force_time = (
            prediction.dt if force_time is None else finite("force_time", force_time)
        )
        arrays = []  # the arrays passed to C must exist until the call returns
        for name, values in given.items():
            if values is None and name in ("force", "increment"):
                continue
            for side, (part, count) in enumerate(zip(self._parts(name, values), self._counts)):
                arrays.append(doubles(real(name, part, (count, 3))))
                setattr(prediction, f"{name}_{'ab'[side]}", arrays[-1])
        call(lib.ct_contact_step, self._contact, prediction)
        if not self._told and self.balance.late:
            self._told = True
            issue(SceneWarning("border", came_in_late(self.balance.late, self.balance.late_depth)))

    def add_force(self, force: Any) -> None:
        """
        Add the forces of the last step: contact, obstacles, friction.

        Parameters
        ----------
        force : ndarray of float64 in C order, shape (n, 3), or a pair of them
            Forces of the host, to which the contact forces are added [force].

        Raises
        ------
        TypeError, ValueError
            An array is not of this kind.
        """
        arrays = []
        for part, count in zip(self._parts("force", force), self._counts):
            if not (
                isinstance(part, np.ndarray) and part.dtype == np.float64 and part.flags.carray
            ):
                raise TypeError("force must be a writable, aligned array of float64 in C order")
            arrays.append(doubles(real("force", part, (count, 3))))
        call(lib.ct_contact_add_force, self._contact, arrays[0], arrays[-1])

    @property
    def energy(self) -> float:
        """Energy stored by the contact at t_n [energy]."""
        return float(lib.ct_contact_energy(self._contact))

    @property
    def balance(self) -> Balance:
        """Energy balance since the first step."""
        out = ffi.new("ct_contact_balance *")
        call(lib.ct_contact_balance_of, self._contact, out)
        return Balance(*(getattr(out, each.name) for each in fields(Balance)))

    def save(self) -> Floats:
        """The memory of the contact, with which a run continues with the same bits.

        Returns
        -------
        ndarray
            The numbers, for :meth:`restore` of a contact with the same definition.
        """
        memory = np.zeros(lib.ct_contact_save(self._contact, ffi.NULL))
        lib.ct_contact_save(self._contact, doubles(memory))
        return memory

    def restore(self, memory: Any) -> None:
        """Continue from the memory that :meth:`save` returned. The next call must be a step.

        Parameters
        ----------
        memory : array_like
            The numbers.

        Raises
        ------
        TypeError, ValueError
            They do not come from a contact with the same definition.
        """
        numbers = real("memory", memory, ("n",))
        call(lib.ct_contact_restore, self._contact, doubles(numbers), len(numbers))

    def reaction(self, obstacle: int) -> tuple[Floats, float]:
        """
        Force of the bodies on an obstacle in the last step.

        Parameters
        ----------
        obstacle : int
            Its number.

        Returns
        -------
        force : ndarray, shape (3,)
            The force, including friction [force].
        work : float
            Work of the obstacle's motion on the bodies [energy].

        Raises
        ------
        ValueError
            Unknown obstacle, or the last call was not a successful step.
        """
        force, work = np.zeros(3), ffi.new("double *")
        number = index("obstacle", obstacle)
        if not 0 <= number < len(self._sides):
            raise ValueError(f"there is no obstacle {obstacle!r}")
        call(lib.ct_contact_reaction, self._contact, number, doubles(force), work)
        return force, float(work[0])

    def penetration(self, at: str = "points", obstacle: int | None = None) -> dict[str, Any]:
        """
        Depth of the two surfaces inside each other, or of a surface in an obstacle, by true distances.

        Parameters
        ----------
        at : {"points", "corners", "edges"}
            Places of the faces; a surface in contact with itself has only ``"points"``.
        obstacle : int, optional
            An obstacle, after a step.

        Returns
        -------
        dict
            The numbers ``inside`` and ``buried`` (inside, but not in contact because they never came
            from outside); ``deepest`` [length], ``surface`` (0, 1, or None when nothing is inside),
            ``face`` and ``position`` of the deepest place; and ``touching``, the depth [length] that
            counts as touching.

        Raises
        ------
        ValueError
            Unknown place or obstacle, or the last call was not a successful step.
        """
        place, found = chosen("at", at, PLACES), ffi.new("ct_penetration *")
        if obstacle is None:
            call(lib.ct_contact_penetration, self._contact, place, found)
            return depths(found) | {"surface": found.side if found.side >= 0 else None}
        number = index("obstacle", obstacle)
        if not 0 <= number < len(self._sides):
            raise ValueError(f"there is no obstacle {obstacle!r}")
        call(lib.ct_contact_obstacle_penetration, self._contact, number, place, found)
        return depths(found) | {"surface": self._sides[number] if found.side >= 0 else None}

    def traction(self, surface: int = 0, obstacle: int | None = None) -> tuple[Floats, Floats]:
        """
        Tractions at the nodes of a surface, recovered from the forces of the last step, without friction.

        Parameters
        ----------
        surface : int
            The surface, 0 or 1.
        obstacle : int, optional
            An obstacle; returns its tractions on this surface instead of those of the other
            surface.

        Returns
        -------
        traction : ndarray, shape (n, 3)
            Force on the surface per reference area [stress]; its magnitude is the pressure.
        area : ndarray, shape (n,)
            The part of the faces around each node that takes its force [area].

        Raises
        ------
        ValueError
            Unknown surface or obstacle.
        """
        side = index("surface", surface)
        if not 0 <= side < len(self._counts):
            raise ValueError(f"there is no surface {surface!r}")
        traction, area = np.zeros((self._counts[side], 3)), np.zeros(self._counts[side])
        which = side if obstacle is None else 2 + index("obstacle", obstacle)
        if obstacle is not None and self._sides[which - 2 : which - 1] != [side]:
            raise ValueError(f"surface {side} meets no obstacle {obstacle!r}")
        call(lib.ct_contact_traction, self._contact, which, doubles(traction), doubles(area))
        return traction, area

    @property
    def points(self) -> Rows:
        """All contact points of the last step, one per row, with the members of
        ``ct_contact_point``. Their ``raw_pressure`` [stress] is uneven from point to point; ``traction`` has the
        pressure to show."""
        rows, pointer = point_rows(lib.ct_contact_point_count(self._contact))
        call(lib.ct_contact_points, self._contact, pointer)
        return rows

    @property
    def resultant(self) -> Floats:
        """Resultant force on each surface and its moment about the origin, without obstacles and friction, shape
        (surfaces, 2, 3) [force, force · length]."""
        out = np.zeros((2, 2, 3))
        call(lib.ct_contact_resultant, self._contact, *map(doubles, out.reshape(4, 3)))
        return out[: len(self._counts)]

    def stable_step(self, mass: Any) -> float:
        """
        Largest stable step of :meth:`step` for the contact alone. Only ``"penalty"`` limits it.

        Parameters
        ----------
        mass : array_like, shape (n,), or a pair of them
            Masses of the nodes [mass].

        Returns
        -------
        float
            2 / ω [time], infinite without ``"penalty"``; with the host's own limit it gives
            1 / sqrt(1 / dt² + 1 / dt_host²).

        Raises
        ------
        ValueError
            A mass is not positive.
        """
        parts = zip(self._parts("mass", mass), self._counts)
        arrays = [doubles(real("mass", part, (count,))) for part, count in parts]
        dt = ffi.new("double *")
        call(lib.ct_contact_stable_step, self._contact, arrays[0], arrays[-1], dt)
        return float(dt[0])

    def _parts(self, name: str, values: Any) -> list[Any]:
        """The argument of a call for each surface: a pair, or one array for both."""
        if not self._pair:
            return [values] * len(self._counts)
        if not isinstance(values, (tuple, list)) or len(values) != 2:
            raise ValueError(f"{name} must be a pair of arrays, one of each surface")
        return list(values)
