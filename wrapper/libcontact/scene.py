"""Scenes: what a run computes. Read from TOML, given as a dictionary, or built step by step; then explained and run."""

from __future__ import annotations

import copy
import math
import os
import tomllib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from . import effects
from . import parts as scene_parts
from .effects.own import Own, View
from .errors import NotBuiltIn
from .explain import Explanation, explain
from .loop import execute, record_count, schedule
from .plan import Cost, predict, table
from .problem import Problem
from .run import ENERGY, IN_ENERGY, Run
from .schema import SceneError, check_file, describe, suggestion

# What may differ between a scene and the one whose run it continues: whole tables, and keys of [time].
FREE_ON_RESTART = ("title", "output", "run", "units")
# The largest scene file that is read.
MOST_BYTES = 256e6
STEPS = ("courant", "fraction", "dt")
FREE_TIME_ON_RESTART = ("end", "end_c1t_over", "until_static", "energy_limit", "look_every")


def example(name: str) -> Path:
    """
    File of a scene that comes with the package: "plates", "hertz" and the others of the tutorials (``tutorials/scenes`` in the repository).

    >>> scene = Scene.load(example("plates"))
    """
    folder = Path(__file__).parent / "scenes"
    names = sorted(path.stem for path in folder.glob("*.toml"))
    if name not in names:
        raise ValueError(f'there is no example "{name}"; the examples are {", ".join(names)}')
    return folder / f"{name}.toml"


class Scene:
    """
    A scene: units, materials, bodies, effects, time and output, with the keys of the scene file (docs: "The scene file").

    >>> scene = Scene.load("plates.toml")                      # from a file
    >>> scene = Scene({"units": {...}, "material": [...], ...})  # from the same tables in Python
    >>> scene = Scene(title="...", units={"length": "mm", "mass": "t", "time": "s"})   # or piece by piece
    >>> scene.add_material("steel", young=2.1e5, poisson=0.3, density=7.8e-9)

    Every piece is checked when it comes in; what is wrong is a SceneError with file, key and reason.
    """

    def __init__(
        self,
        data: dict[str, Any] | None = None,
        *,
        title: str | None = None,
        units: dict[str, str] | None = None,
        file: str | Path | None = None,
    ):
        if data is not None and (title is not None or units is not None):
            raise TypeError("give either the whole data or title and units")
        self.file = None if file is None else str(file)
        self._problem: Problem | None = None
        self._own: list[Own] = []
        whole = data is not None
        if data is None:
            data = {"title": title or "", "units": units}
            if units is None:
                raise SceneError("is missing; give length, mass and time", "units", self.file)
        self._parts = scene_parts.read(data, self.file, whole)
        self._data = _plain(data)

    def __getstate__(self) -> dict[str, Any]:
        """What a pickle of the scene holds: its tables, and the Python functions of its effects by name, as pickle has it."""
        for own in self._own:
            own.check_pickle()
        return {
            "data": self._data,
            "file": None if self.file is None else os.path.abspath(self.file),
            "own": self._own,
        }

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.file, self._data, self._own, self._problem = (
            state["file"],
            state["data"],
            state["own"],
            None,
        )
        self._parts = scene_parts.read(self._data, self.file, whole=False)

    def __copy__(self) -> Scene:
        return self._copied(copy.copy)

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self._copied(lambda own: copy.deepcopy(own, memo))

    def _copied(self, of: Callable[[Own], Own]) -> Scene:
        """Another scene with the same tables, which share nothing that either can change, and with effects that are copied by ``of``."""
        new = object.__new__(type(self))
        new.__setstate__(
            {"file": self.file, "data": self.data, "own": [of(own) for own in self._own]}
        )
        return new

    @property
    def data(self) -> dict[str, Any]:
        """A copy of the scene's tables, to be changed at will and made into another ``Scene(data)``."""
        return copy.deepcopy(self._data)

    @classmethod
    def load(cls, path: str | Path) -> Scene:
        """Read a scene file (TOML, UTF-8) of at most 256 MB; larger meshes belong into a file of their own."""
        path = str(path)
        try:
            check_file(path, MOST_BYTES)
            text = Path(path).read_bytes().decode("utf-8")
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
            raise SceneError(f"can't be read: {reason}", "", path) from None
        try:
            data = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise SceneError(f"is no TOML: {error}", "", path) from None
        except (RecursionError, ValueError) as error:
            raise SceneError(f"can't be understood: {error}", "", path) from None
        return cls(data, file=path)

    def save(self, path: str | Path) -> None:
        """Write the scene as TOML; arrays of nodes and elements are written out, and paths of meshes count from the new folder."""
        self._whole()
        if self._own:
            raise SceneError(
                "is a Python function, which a scene file can't hold", self._own[0].name, self.file
            )
        old, new = (
            Path(file).resolve().parent if file else Path.cwd() for file in (self.file, path)
        )
        data = self.data
        for body in data["body"]:
            if old != new and "mesh" in body and not Path(body["mesh"]).is_absolute():
                body["mesh"] = os.path.relpath(old / body["mesh"], new)
        Path(path).write_text(_toml(data), encoding="utf-8")

    def toml(self, arrays: bool = True) -> str:
        """The scene as TOML; without ``arrays`` nodes and elements are named only (the results file holds them anyway)."""
        return _toml(self.data, arrays)

    # Building step by step.

    def add_material(
        self, name: str, *, young: float, poisson: float, density: float, law: str | None = None
    ) -> Scene:
        """Add a material; ``law`` is "linear" (small strain, the default), "st_venant_kirchhoff" or "neo_hookean"."""
        return self._add(
            "material", name=name, young=young, poisson=poisson, density=density, law=law
        )

    def add_body(
        self,
        name: str,
        *,
        material: str,
        box: Any = None,
        ring: Any = None,
        mesh: Any = None,
        nodes: Any = None,
        elements: Any = None,
        element: str | None = None,
        velocity: Any = None,
        spin: Any = None,
        lumping: str | None = None,
        kernel: str | None = None,
        integration: str | None = None,
        hourglass: float | None = None,
    ) -> Scene:
        """Add a body: a ``box``, a ``ring``, a ``mesh`` file, or ``nodes`` (n, 3) with ``elements`` (cells, 8 or 20); the arrays are copied."""
        mesh = os.fspath(mesh) if isinstance(mesh, os.PathLike) else mesh
        return self._add(
            "body",
            name=name,
            box=box,
            ring=ring,
            mesh=mesh,
            nodes=nodes,
            elements=elements,
            element=element,
            material=material,
            velocity=velocity,
            spin=spin,
            lumping=lumping,
            kernel=kernel,
            integration=integration,
            hourglass=hourglass,
        )

    def add_contact(
        self,
        a: str,
        b: str,
        *,
        beta: float | None = None,
        epsilon: float | None = None,
        method: str | None = None,
        tolerance: float | None = None,
        depth: float | None = None,
        friction: float | None = None,
        tangent: float | None = None,
        enforcement: str | None = None,
        dissipation: float | None = None,
        points: str | None = None,
        initial_penetration: str | None = None,
        removal_time: float | None = None,
        adjust: float | None = None,
    ) -> Scene:
        """
        Add the contact of two surfaces such as ``"left.x_max"`` and ``"right.x_min"``; beta is 4 if no penalty is given. A surface that is named
        twice, or two of one body, can meet itself: ``scene.add_contact("ring.outer", "ring.outer")``. ``adjust`` is the distance within which gaps and
        overlaps at the start are taken as touching.
        """
        return self._add(
            "contact",
            surfaces=[a, b],
            beta=beta,
            epsilon=epsilon,
            method=method,
            tolerance=tolerance,
            depth=depth,
            friction=friction,
            tangent=tangent,
            enforcement=enforcement,
            dissipation=dissipation,
            points=points,
            initial_penetration=initial_penetration,
            removal_time=removal_time,
            adjust=adjust,
        )

    def add_support(
        self, set: str, *, fix: Any, velocity: Any = None, travel: Any = None, history: Any = None
    ) -> Scene:
        """
        Prescribe the velocity (0 by default) of the nodes of a face such as ``"right.z_min"``, in the directions ``fix``, or their path: ``travel`` times
        ``history={"time": [...], "value": [...]}``.
        """
        return self._add(
            "support",
            set=set,
            fix=list(fix) if isinstance(fix, (str, tuple)) else fix,
            velocity=velocity,
            travel=travel,
            history=history,
        )

    def add(self, effect: str, **entries: Any) -> Scene:
        """Add an effect of ``libcontact.effects`` with the keys of its table: ``scene.add("gravity", acceleration=[0, 0, -9810])``."""
        module = next(
            (module for module in effects.MODULES if effects.name_of(module) == effect), None
        )
        if module is None:
            known = [effects.name_of(module) for module in effects.MODULES]
            raise SceneError(
                f'no effect is named "{effect}"' + suggestion(effect, known), "", self.file
            )
        if not module.MANY and effect in self._data:
            raise SceneError("stands twice; a scene has it once", effect, self.file)
        return self._add(effect, **entries) if module.MANY else self._set(effect, **entries)

    def add_effect(
        self,
        name: str,
        body: str,
        nodes: Any,
        force: Callable[[View], Any],
        *,
        energy: Callable[[View], float] | None = None,
        omega_squared: float = 0.0,
        rate: float = 0.0,
    ) -> Scene:
        """
        Add an effect of your own, a Python function. ``force(view)`` answers the forces (n, 3) on ``nodes`` of a body: numbers, or a face such as ``"x_max"``; ``view`` has
        ``time``, ``reference``, ``displacement`` and ``velocity`` of these nodes (``effects.own.View``). ``energy(view)`` is what it stores; without it its work counts as from outside. Tell the
        largest ω² [1/time²] of a stiffness (k / m of a spring on a node), and the largest c / m [1/time] of a dashpot as ``rate``, so that the stable step knows them.
        The ledger has a column ``name``. What the function raises ends the run with a RunError that names
        the effect; SystemExit, KeyboardInterrupt and their like go on through ``run``. Forces and energies must be real numbers, integers or floats; others are refused.

        >>> scene.add_effect("spring", "bar", "x_max", lambda view: -k * view.displacement, energy=lambda view: k / 2 * np.sum(view.displacement**2), omega_squared=k / m)
        """
        own = Own(name, body, nodes, force, energy, omega_squared, rate)
        if (
            name in IN_ENERGY
            or name in ENERGY.names
            or any(other.name == name for other in self._own)
        ):
            raise SceneError("is the name of something else in the ledger", name, self.file)
        self._own.append(own)
        self._problem = None
        return self

    def set_time(
        self,
        *,
        end: float | None = None,
        end_c1t_over: Any = None,
        courant: float | None = None,
        fraction: float | None = None,
        dt: float | None = None,
        integrator: str | None = None,
        integrator_parameter: float | None = None,
        stable_step: str | None = None,
        until_static: float | None = None,
        energy_limit: float | None = None,
        look_every: int | None = None,
    ) -> Scene:
        """
        Give the end of the run and exactly one of ``courant``, ``fraction`` and ``dt``; ``integrator`` is "central_difference", "chung_lee", "noh_bathe" or
        "tchamwa_wielgosz" with its one ``integrator_parameter``, and ``stable_step`` "elements" or "assembled" how its limit is found (chapter "Integrator"); ``until_static`` ends it earlier, at rest (chapter "Damping"). The run is
        looked at after every ``look_every`` steps and fails when a share of ``energy_limit`` has appeared from nothing (chapter "Faults").
        """
        return self._set(
            "time",
            end=end,
            end_c1t_over=end_c1t_over,
            courant=courant,
            fraction=fraction,
            dt=dt,
            integrator=integrator,
            integrator_parameter=integrator_parameter,
            stable_step=stable_step,
            until_static=until_static,
            energy_limit=energy_limit,
            look_every=look_every,
        )

    def set_output(
        self, file: Any = None, *, fields: Any = None, every: int | None = None, times: Any = None
    ) -> Scene:
        """Name the results file, its fields, and when to record: ``every`` n steps, or at the steps nearest to ``times``."""
        file = os.fspath(file) if isinstance(file, os.PathLike) else file
        return self._set("output", file=file, fields=fields, every=every, times=times)

    def _add(self, key: str, **entries: Any) -> Scene:
        new = {name: value for name, value in entries.items() if value is not None}
        return self._change({**self._data, key: [*self._data.get(key, []), new]})

    def _set(self, key: str, **entries: Any) -> Scene:
        return self._change(
            {
                **self._data,
                key: {name: value for name, value in entries.items() if value is not None},
            }
        )

    def _change(self, data: dict[str, Any]) -> Scene:
        self._parts = scene_parts.read(data, self.file, whole=False)
        self._data = _plain(data)
        self._problem = None
        return self

    # What a scene is for.

    def explain(self) -> Explanation:
        """What will be computed, what will not, and why: a text, with the same facts as a dictionary in its ``data``."""
        problem = self._built(None)
        return explain(problem, schedule(problem)[0], record_count(problem))

    def costs(self, run: Run | None = None) -> list[Cost]:
        """
        What each effect of the scene will cost, predicted from a trial of a few steps, and, where a ``run`` of it is given, what it did cost. ``print(scene.cost_table(run))``
        shows the same.
        """
        problem = self._built(None)
        plan = predict(problem, record_count(problem) if run is None else len(run.steps)).costs
        if run is None:
            return list(plan)
        return [
            replace(
                cost,
                measured=run.costs.get(cost.name),
                done=run.computed if cost.name == "solid" else None,
            )
            for cost in plan
        ]

    def cost_table(self, run: Run | None = None) -> str:
        """The costs as a table."""
        return table(self.costs(run), self._built(None).stable.dt)

    def run(
        self,
        progress: bool | str = True,
        restart: str | Path | None = None,
        until: float | None = None,
        output: str | Path | bool | None = None,
        threads: int | None = None,
        watch: Callable[[Run], object] | None = None,
    ) -> Run:
        """
        Compute the scene.

        ``progress`` shows a bar where stderr is a terminal ("always": everywhere). ``restart`` continues from the newest record
        of a results file with the same bits and the same step, also to a later end than the file's scene had; or, where this scene asks for a smaller step, with a whole part of the file's.
        ``until`` ends earlier without changing the step. ``output`` names another file than the scene does;
        False writes none. The first Ctrl-C ends the run after a last record, and the Run says ``interrupted``.
        ``watch`` is called at every record with a Run of this record alone (copy the arrays that you want to keep).
        What is wrong with the input is a SceneError before the first step; what fails later is a RunError.
        """
        if threads is not None and (
            isinstance(threads, bool) or not isinstance(threads, int) or not 1 <= threads <= 1024
        ):
            raise SceneError(
                f"is {describe(threads)}; it must be a whole number from 1 to 1024",
                "run.threads",
                self.file,
            )
        parts = self._whole()
        path = parts.output.file if output is None else (output or None)
        if path is not None:
            self._check_output(path, restart)
        dt, parts = (None, 1) if restart is None else self._check_restart(restart, threads)
        coarse = None if parts == 1 else self._built(threads, dt)
        return execute(
            self._built(threads, dt if dt is None else dt / parts),
            self.toml(arrays=False),
            progress=progress,
            restart=restart,
            until=until,
            output=path,
            watch=watch,
            coarse=coarse,
        )

    def _whole(self) -> scene_parts.Parts:
        """The parts of a scene that is complete; else the error that says what is missing."""
        if self._parts.time is None or not self._parts.bodies:
            self._parts = scene_parts.read(self._data, self.file)
        return self._parts

    def _built(self, threads: int | None, dt: float | None = None) -> Problem:
        """The C problem, kept as long as nothing changes; ``dt`` is the step of a run that is continued."""
        parts = self._whole()
        wanted = parts.threads if threads is None else threads
        if dt is not None:
            return Problem(parts, self.file, wanted, self._own, dt)
        if self._problem is None or self._problem.threads != wanted:
            self._problem = Problem(parts, self.file, wanted, self._own)
        return self._problem

    def _check_output(self, path: Any, restart: Any) -> None:
        """Refuse a results file that can't be written, before anything is computed."""
        if not isinstance(path, (str, os.PathLike)):
            raise SceneError(f"is {describe(path)}; it must be a path", "output.file", self.file)
        path = Path(path)
        try:
            reason = self._why_not_written(path, restart)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or str(error)
        if reason:
            raise SceneError(f'"{path}" can\'t be written: {reason}', "output.file", self.file)

    def _why_not_written(self, path: Path, restart: Any) -> str | None:
        folder = path.parent
        if "\0" in str(path):
            return "its name holds a zero character"
        if not folder.is_dir():
            return f'there is no folder "{folder}"'
        if path.is_dir():
            return "is a folder"
        if not os.access(path if path.exists() else folder, os.W_OK):
            return "permission denied"
        if not path.exists():
            return None
        if restart is not None and Path(restart).exists() and path.samefile(restart):
            return "is the file that the restart is read from; name another one, or its earlier records would be lost"
        for body in self._parts.bodies.values():
            mesh = (
                None
                if body.mesh is None
                else (Path(self.file).parent if self.file else Path()) / body.mesh
            )
            if mesh is not None and mesh.exists() and path.samefile(mesh):
                return f'is the mesh of body "{body.name}"'
        if path.is_file() and path.stat().st_size and _first_bytes(path) != b"\x89HDF":
            return "is there already and is no results file; name another one, or remove it"
        return None

    def _check_restart(self, path: Any, threads: int | None) -> tuple[float | None, int]:
        """Refuse to continue the run of another scene; the step that the run had, and in how many parts this scene divides it."""
        try:
            run = Run.load(path)
            before = tomllib.loads(run.scene)
        except NotBuiltIn:
            return (
                None,
                1,
            )  # without h5py the C library's own comparison of bodies, effects, step and nodes has to do
        except (ValueError, TypeError) as error:
            raise SceneError(str(error), "restart", self.file) from None
        now = tomllib.loads(self.toml(arrays=False))
        step = [{key: scene.get("time", {}).get(key) for key in STEPS} for scene in (before, now)]
        for scene in (before, now):
            scene["time"] = {
                key: value
                for key, value in scene.get("time", {}).items()
                if key not in FREE_TIME_ON_RESTART + STEPS
            }
        for key in dict.fromkeys([*before, *now]):
            if key not in FREE_ON_RESTART and before.get(key) != now.get(key):
                raise SceneError(
                    f'"{path}" comes from another scene: [{key}] differs', "restart", self.file
                )
        return run.dt, 1 if step[0] == step[1] else self._step_parts(path, run.dt, threads)

    def _step_parts(self, path: Any, dt: float, threads: int | None) -> int:
        """In how many parts the step of a file is divided, so that it is not above the one that this scene asks for."""
        asked = self._built(threads).dt
        if asked > dt * (1.0 + 1e-9):
            raise SceneError(
                f'"{path}" was written with the step {dt:.6g}; this scene asks for {asked:.6g}, and only a smaller one can be taken',
                "restart",
                self.file,
            )
        return math.ceil(dt / asked * (1.0 - 1e-9))

    def __repr__(self) -> str:
        return f"<Scene {self._parts.title!r}: {', '.join(self._parts.bodies) or 'no bodies yet'}>"


def _toml(data: dict[str, Any], arrays: bool = True) -> str:
    import tomli_w

    for body in data.get("body", []):
        for key in ("nodes", "elements"):
            if key in body:
                body[key] = body[key].tolist() if arrays else f"array of shape {body[key].shape}"
    return tomli_w.dumps(data)


def _first_bytes(path: Path) -> bytes:
    with open(path, "rb") as file:
        return file.read(4)


def _plain(value: Any) -> Any:
    """A deep copy in plain Python types (TOML's), with the arrays of nodes and elements kept as arrays of their own."""
    if isinstance(value, dict):
        return {
            str(key): np.array(item) if key in ("nodes", "elements") else _plain(item)
            for key, item in value.items()
        }
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    return str(value) if isinstance(value, str) else value
