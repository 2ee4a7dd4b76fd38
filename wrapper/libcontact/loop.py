"""The time loop of a run: chunks of C steps, records, progress, Ctrl-C, and what happens when something fails."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import sys
import threading
import time as clock
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from . import has
from ._core import ffi, lib
from .errors import (
    EnergyGrowth,
    NotAtRest,
    NotBuiltIn,
    NotSettled,
    check,
    issue,
    new_error,
    raise_held,
    text_of,
)
from .mesh import view
from .plan import measured
from .problem import Problem, contact_points, new_state, penetrations
from .rehearsal import computed_share
from .run import ENERGY, FAULTS, MOMENTUM, BodyState, Run, RunError, State, energy_dtype
from .schema import SceneError, is_number
from .surfaces import obstacle_name, pair_name
from .warned import known, turned

DEFAULT_RECORDS = 100
CHUNK_SECONDS = 0.1
LOOK_STEPS = 20
# The same rows with the padding of the C struct.
C_MOMENTUM = np.dtype(MOMENTUM.descr, align=True)


def schedule(problem: Problem) -> tuple[int, list[int] | None]:
    """Recording interval in steps, and the steps of ``times`` (nearest to each) when the scene names times."""
    output = problem.parts.output
    if output.times is not None:
        return problem.step_count, sorted({_step_of(t, problem) for t in output.times})
    return output.every or max(1, math.ceil(problem.step_count / DEFAULT_RECORDS)), None


def record_count(problem: Problem) -> int:
    """Number of records of the whole run, the first and the last state included."""
    every, steps = schedule(problem)
    if steps is not None:
        return len({0, problem.step_count, *steps})
    return -(-problem.step_count // every) + 1


def _step_of(t: float, problem: Problem) -> int:
    step = t / problem.dt
    if not step <= problem.step_count + 0.5:
        raise SceneError(
            f"{t:g} is after the end of the run, {problem.end:g}", "output.times", problem.file
        )
    return round(step)


def last_step(problem: Problem, until: Any) -> int:
    """The first step that is not before ``until`` (None: the end)."""
    if until is None:
        return problem.step_count
    if not is_number(until) or not until > 0.0:
        raise SceneError(f"is {until!r}; it must be a time above 0", "until", problem.file)
    if until > problem.end * (1.0 + 1e-12):
        raise SceneError(
            f"{until:g} is after the end of the run, {problem.end:g}", "until", problem.file
        )
    return min(max(math.ceil(until / problem.dt * (1.0 - 1e-12)), 1), problem.step_count)


class Loop:
    """One run of a problem, from its first record to its last."""

    def __init__(self, problem: Problem, scene_text: str):
        self.problem, self.scene_text = problem, scene_text
        self.state = new_state(problem)
        self.guard: Any = None
        self.output: Any = None
        self.path: Path | None = None
        self.steps: list[int] = []
        self.energy: list[np.ndarray] = []
        self.momentum: list[np.ndarray] = []
        self.interrupted = False
        self.issued: set[str] = set()
        self.watch: Any = None
        self.seconds = self.output_seconds = 0.0

    # What is written.

    def restart(self, path: str | Path, coarse: Problem | None = None) -> None:
        """Continue from the newest restart record of a file; ``coarse`` is the same problem with the file's step, where that is larger."""
        if not has("hdf5"):
            raise NotBuiltIn("this build has no HDF5, so it can't read a restart")
        error, problem = new_error(), coarse or self.problem
        state = self.state if coarse is None else new_state(coarse)
        if lib.ct_output_restart(os.fsencode(path), problem.pointer, state, error) != lib.CT_OK:
            raise SceneError(text_of(error.code, error), "restart", self.problem.file)
        if (
            coarse is not None
            and lib.ct_state_refine(self.problem.pointer, state, self.state, error) != lib.CT_OK
        ):
            raise SceneError(text_of(error.code, error), "restart", self.problem.file)

    def open(self, path: str | Path) -> None:
        """Create the results file; without HDF5, of which ``known`` warns, the results stay in memory."""
        if not has("hdf5"):
            return
        fields = self.problem.parts.output.fields
        text = ffi.new("char[]", self.scene_text.encode())
        options = ffi.new(
            "ct_output_options *",
            {name: name in fields for name in ("displacement", "velocity", "stress")},
        )
        options.scene = text
        out, error = ffi.new("ct_output **"), new_error()
        if (
            lib.ct_output_create(os.fsencode(path), self.problem.pointer, options, out, error)
            != lib.CT_OK
        ):
            raise SceneError(text_of(error.code, error), "output.file", self.problem.file)
        self.output, self.path = out[0], Path(path).absolute()

    def close(self) -> None:
        if self.output is None:
            return
        output, self.output = self.output, None
        error = new_error()
        if lib.ct_output_close(output, error) != lib.CT_OK:
            raise RunError(text_of(error.code, error))

    def abandon(self) -> None:
        """Close the file after a failure; what was written before stays readable."""
        with contextlib.suppress(RunError):
            self.close()

    def fail(self, error: RunError) -> None:
        """After a fault: record the last good state if it is newer than the last record, close the file, and tell how to go on."""
        good = None if self.guard is None else lib.ct_watch_good(self.guard)
        if good is not None and self.steps and good.step > self.steps[-1]:
            with contextlib.suppress(RunError):
                self._write_record(good)
        path = self.path if self.output is not None and self.steps else None
        self.abandon()
        error.time, error.step, error.checkpoint = self.state.time, self.state.step, path
        error.run = self.result(failed=True)
        if good is not None:
            error.args = (f"{error}. {self._stable_note(good)}{self._how_to_go_on(good, path)}",)

    def _stable_note(self, good: Any) -> str:
        """Whether the step of the run is above the stable one of the last good state."""
        stable = ffi.new("ct_stable_step *")
        if lib.ct_stable(self.problem.pointer, good, stable, ffi.NULL) != lib.CT_OK:
            raise_held()
            return ""
        if self.problem.dt <= stable.dt * (1.0 + 1e-9):
            return ""
        return f"The stable step had come down to {stable.dt:.6g}, and the run's is {self.problem.dt:.6g}: take a smaller one. "

    def _how_to_go_on(self, good: Any, path: Path | None) -> str:
        at = f"The last good state, t = {good.time:.6g} (step {good.step}), is "
        if path is None:
            return at + "run.state of this error; without a results file nothing can be restarted"
        return at + f'in "{path}"; scene.run(restart="{path}", output="...") goes on from it'

    def record(self) -> None:
        """One row of each table, and one step of the file."""
        begin = clock.perf_counter() - self._effect_seconds()
        self._record()
        if self.watch is not None:
            self.watch(self.result(records=1))
        # The forces that a record asks for are those of the next step, which has them then.
        self.output_seconds += clock.perf_counter() - self._effect_seconds() - begin

    def _effect_seconds(self) -> float:
        return math.fsum(self.state.effect_seconds[k] for k in range(len(self.problem.effects) + 1))

    def _record(self) -> None:
        self._call(lib.ct_watch_look, self.guard, self.state)
        self._write_record(self.state)

    def _write_record(self, state: Any) -> None:
        energy, momentum = ffi.new("ct_energy *"), ffi.new("ct_momentum *")
        problem = self.problem.pointer
        self._call(lib.ct_energy_of, problem, state, energy)
        rows = []
        for body in range(len(self.problem.bodies)):
            self._call(lib.ct_momentum_of, problem, state, body, momentum)
            rows.append(np.frombuffer(ffi.buffer(momentum), C_MOMENTUM).astype(MOMENTUM))
        energies = self._energies(state, np.frombuffer(ffi.buffer(energy), ENERGY))
        if not np.isfinite(energies.view(np.float64)).all():
            raise FAULTS[lib.CT_ERROR_BLOWUP](
                f"the energy stopped being finite by t = {state.time:g} (step {state.step})",
                code=lib.CT_ERROR_BLOWUP,
            )
        if self.output is not None:
            self._call(lib.ct_output_append, self.output, problem, state)
        self.energy.append(energies)
        self.momentum += rows
        self.steps.append(state.step)

    def _energies(self, state: Any, row: np.ndarray) -> np.ndarray:
        """A row of the ledger with the columns of all effects."""
        out = np.zeros(1, energy_dtype(self.problem.effects))
        for name in ENERGY.names:
            out[name] = row[name]
        value = ffi.new("double *")
        for k, (name, stores) in enumerate(zip(self.problem.effects, self.problem.stores)):
            if name in out.dtype.names and name not in ENERGY.names:
                self._call(
                    lib.ct_energy_stored if stores else lib.ct_energy_work,
                    self.problem.pointer,
                    state,
                    k,
                    value,
                )
                out[name] += value[0]
        return out

    # The loop.

    def run(self, until: Any, progress: Any) -> None:
        """Step to the end (or ``until``), recording as the scene says."""
        last = last_step(self.problem, until)
        if self.state.step > last:
            raise SceneError(
                f"the restart stands at step {self.state.step}, after the last step {last}",
                "restart",
                self.problem.file,
            )
        begin = clock.perf_counter()
        self.start_guard()
        with _progress(progress, self.state.step, last) as advanced, _ctrl_c() as stop:
            self._record_and_look()
            while self.state.step < last and not stop and not self._at_rest():
                due = min(self._next_record(), last)
                self._advance(min(due, self._next_look()), advanced, stop)
                if self.state.step > self.steps[-1] and (
                    self.state.step == due or stop or self._at_rest()
                ):
                    self._record_and_look()
                self._warn_of_growth()
        self.interrupted = bool(stop) and self.state.step < last
        if (
            self.problem.parts.time.until_static is not None
            and last == self.problem.step_count
            and not stop
            and not self._at_rest()
        ):
            issue(
                NotAtRest(
                    f"the run ends at t = {self.state.time:g} before it comes to rest: unrest {self._unrest():.2g}, "
                    f"until_static = {self.problem.parts.time.until_static:g}; a later end helps, or more [damping]",
                    "time.until_static",
                )
            )
        if self.state.unsettled:
            issue(
                NotSettled(
                    f"the contact forces did not settle to their tolerance in {self.state.unsettled} of {self.state.step} steps; a smaller step helps, or a smaller beta"
                )
            )
        self.seconds = clock.perf_counter() - begin

    def start_guard(self) -> None:
        """Watch the state from here on; what is wrong with it already is an error of the input."""
        options, out, error = (
            ffi.new("ct_watch_options *", lib.ct_watch_options_default()),
            ffi.new("ct_watch **"),
            new_error(),
        )
        time = self.problem.parts.time
        options.every, options.energy_limit, options.stable = (
            time.look_every,
            time.energy_limit,
            self.problem.stable.dt,
        )
        if lib.ct_watch_create(self.problem.pointer, self.state, options, out, error) != lib.CT_OK:
            raise SceneError(text_of(error.code, error), "", self.problem.file)
        self.guard = ffi.gc(
            out[0], lambda watch, free=lib.ct_watch_free, problem=self.problem: free(watch)
        )

    def _warn_of_growth(self) -> None:
        """Warn once when energy has appeared, :eq:`energy-growth`."""
        growth = lib.ct_watch_growth(self.guard)
        if "growth" in self.issued or not growth.share > 0.0:
            return
        self.issued.add("growth")
        who, key, advice = self._grower(growth)
        much = (
            f"{100.0 * growth.share:.3g} % more energy than there should be"
            if math.isfinite(growth.share)
            else "energy where there should be none"
        )
        text = f"there is {much} by t = {growth.time:.6g} (step {growth.step}), most of it from {who}: {advice}"
        issue(EnergyGrowth(text, key, growth.share, growth.time, who))

    def _grower(self, growth: Any) -> tuple[str, str, str]:
        """What the energy of a growth came from, its key in the scene, and what can be done."""
        problem, effect = self.problem, growth.effect
        name = problem.effects[effect]
        nth = problem.effects[:effect].count(name)
        step = "take a smaller step (time.fraction)"
        if name == "solid":
            return (
                f'body "{list(problem.bodies)[growth.body]}"',
                f"body[{growth.body}]",
                f'{step}; a body that turns needs the law "neo_hookean" or "st_venant_kirchhoff"',
            )
        if name not in ("contact", "obstacle"):
            return (
                f'effect "{name}"',
                "",
                f"{step}, and compare what it stores with the work of its force",
            )
        if name == "contact":
            given = problem.parts.contacts[nth]
            who, key = f"contact {pair_name(given.surfaces)}", f"contact[{nth}]"
        else:
            obstacle = [added for added in problem.parts.effects if added.name == "obstacle"][nth]
            given, who, key = obstacle.given, f"obstacle at {obstacle_name(obstacle)}", obstacle.key
        if given.enforcement in ("penalty", "bipenalty"):
            return who, key, f'{step}, a smaller beta, or enforcement = "energy_controlled"'
        return (
            who,
            key,
            f"points have come to lie inside without passing the surface, as at an edge or in a fold; {step}, a finer mesh there, or a smaller beta",
        )

    def _record_and_look(self) -> None:
        """A record, and a warning for each body that has turned too far for its law; one for each body is enough."""
        self.record()
        for warning in turned(self.problem, self.state):
            if warning.key not in self.issued:
                self.issued.add(warning.key)
                issue(warning)

    def _unrest(self) -> float:
        value = ffi.new("double *")
        self._call(lib.ct_energy_unrest, self.problem.pointer, self.state, value)
        return value[0]

    def _next_look(self) -> int:
        """The next step at which rest is looked for; which steps these are does not depend on how fast the run is."""
        if self.problem.parts.time.until_static is None:
            return self.problem.step_count
        return (self.state.step // LOOK_STEPS + 1) * LOOK_STEPS

    def _at_rest(self) -> bool:
        """Whether the run may end here: histories are over and nothing moves."""
        wanted, step = self.problem.parts.time.until_static, self.state.step
        if (
            wanted is None
            or step == 0
            or step % LOOK_STEPS
            or self.state.time < self.problem.settled
        ):
            return False
        return self._unrest() <= wanted

    def _next_record(self) -> int:
        every, steps = schedule(self.problem)
        now = self.state.step
        if steps is not None:
            return next((step for step in steps if step > now), self.problem.step_count)
        return (now // every + 1) * every

    def _advance(self, target: int, advanced: Any, stop: list) -> None:
        """Steps to ``target`` in chunks of about a tenth of a second, so that Ctrl-C and the progress bar get their turn."""
        chunk = 1
        while self.state.step < target and not stop:
            count = min(chunk, target - self.state.step)
            begin = clock.perf_counter()
            self._call(lib.ct_watch_steps, self.guard, self.state, count)
            took = clock.perf_counter() - begin
            advanced(count)
            chunk = int(
                min(
                    max(chunk * 2, 1)
                    if took < CHUNK_SECONDS / 2
                    else max(1, count * CHUNK_SECONDS / took),
                    10**6,
                )
            )

    def _call(self, function: Any, *arguments: Any) -> None:
        """Call the C library in the middle of a run; what it refuses is a RunError of its kind, with the body's name."""
        error = new_error()
        status = function(*arguments, error)
        if status == lib.CT_OK:
            return
        names = list(self.problem.bodies)
        text, named = text_of(error.code, error), 0 <= error.body < len(names)
        place = {
            key: int(value) if value >= 0 else None
            for key, value in (
                ("body", error.body),
                ("element", error.element),
                ("point", error.point),
            )
        }
        fault = FAULTS.get(status, RunError)(
            f'body "{names[error.body]}": {text}'
            if named and names[error.body] not in text
            else text,
            code=status,
            **place,
        )
        fault.body_name = names[error.body] if named else None
        raise fault

    # What comes out.

    def result(self, failed: bool = False, records: int = 0) -> Run:
        """The run so far, or its last records; after a failure with the last state that was recorded."""
        problem = self.problem
        energy, momentum = self.energy[-records:], self.momentum[-records * len(problem.bodies) :]
        state = self._last_good() if failed else self._state(self.state, self.state)
        return Run(
            bodies=list(problem.bodies),
            units=problem.parts.units,
            steps=self.steps[-records:],
            energy=np.concatenate(energy or [np.empty(0, energy_dtype(problem.effects))]),
            momentum=np.concatenate(momentum or [np.empty(0, MOMENTUM)]),
            state=state,
            path=self.path,
            scene=self.scene_text,
            interrupted=self.interrupted,
            seconds=self.seconds,
            costs=measured(problem, self.state, self.output_seconds),
            computed=computed_share(self.state),
            writer=None if failed else self._write,
            contact=[] if failed else contact_points(problem, self.state),
            impulse={} if failed else self._impulses(),
            dt=problem.dt,
            penetration=[] if failed or records else penetrations(problem, self.state),
        )

    def _impulses(self) -> dict[str, np.ndarray]:
        """The impulse of each effect but the solid on all bodies together, effects of one name added up."""
        out: dict[str, np.ndarray] = {}
        for k, name in enumerate(self.problem.effects[1:], start=1):
            impulse = np.zeros(3)
            self._call(
                lib.ct_energy_impulse,
                self.problem.pointer,
                self.state,
                k,
                ffi.from_buffer("double[3]", impulse),
            )
            out[name] = out.get(name, 0.0) + impulse
        return out

    def _last_good(self) -> State | None:
        return (
            None if self.guard is None else self._state(lib.ct_watch_good(self.guard), self.guard)
        )

    def _state(self, state: Any, owner: Any) -> State:
        """A state for people; ``owner`` is what keeps its memory alive."""
        problem, error = self.problem, new_error()
        velocity = np.empty((problem.pointer.node_count, 3))
        check(
            lib.ct_state_velocity(
                problem.pointer, state, ffi.from_buffer("double[]", velocity), error
            ),
            error,
        )
        velocity.flags.writeable = False
        displacement = view(state.displacement, velocity.shape, np.float64, (owner, problem))
        bodies = {
            body.name: BodyState(
                body.name, body.mesh, body.material, displacement[body.nodes], velocity[body.nodes]
            )
            for body in problem.bodies.values()
        }
        return State(state.time, state.step, bodies)

    def _write(self, run: Run, path: Path) -> None:
        """Save a run that has no file: its last state through the C library, and all rows of its tables."""
        if not has("hdf5"):
            raise NotBuiltIn("this build has no HDF5, so it can't save a run")
        from .results import write_tables

        try:
            self.open(path)
        except SceneError as error:
            raise OSError(error.reason) from None
        error = new_error()
        written = lib.ct_output_append(self.output, self.problem.pointer, self.state, error)
        output, self.output, self.path = self.output, None, None
        closed = lib.ct_output_close(output, error if written == lib.CT_OK else new_error())
        if written != lib.CT_OK or closed != lib.CT_OK:
            raise OSError(text_of(error.code, error))
        write_tables(path, run.steps, run.energy, run.momentum)


def execute(
    problem: Problem,
    scene_text: str,
    *,
    progress: Any,
    restart: Any,
    until: Any,
    output: Any,
    watch: Any = None,
    coarse: Problem | None = None,
) -> Run:
    """Run a problem. Errors of the input are SceneErrors, before the first step; what fails later is a RunError with the run so far."""
    last_step(problem, until)
    schedule(problem)
    for warning in known(problem, output):
        issue(warning)
    loop = Loop(problem, scene_text)
    loop.watch = watch
    if restart is not None:
        loop.restart(restart, coarse)
    if output is not None:
        loop.open(output)
    try:
        loop.run(until, progress)
    except RunError as error:
        try:
            loop.fail(error)
        finally:
            loop.abandon()
        raise
    except BaseException:
        loop.abandon()
        raise
    try:
        loop.close()
    except RunError as error:
        error.run = loop.result()
        raise
    return loop.result()


@contextlib.contextmanager
def _progress(wanted: Any, start: int, last: int) -> Iterator[Any]:
    """A progress bar on stderr. True: where stderr is a terminal; "always": everywhere; False: nowhere."""
    if not wanted or (wanted != "always" and not sys.stderr.isatty()):
        yield lambda count: None
        return
    from tqdm import tqdm

    with tqdm(total=last, initial=start, unit=" steps", file=sys.stderr, dynamic_ncols=True) as bar:
        yield bar.update


@contextlib.contextmanager
def _ctrl_c() -> Iterator[list]:
    """A list that stops being empty at the first Ctrl-C; the second one interrupts as usual."""
    stop: list = []

    def handler(number: int, frame: Any) -> None:
        if stop:
            raise KeyboardInterrupt
        stop.append(number)

    if threading.current_thread() is not threading.main_thread() or signal.getsignal(
        signal.SIGINT
    ) in (None, signal.SIG_IGN):
        yield stop
        return
    before = signal.signal(signal.SIGINT, handler)
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, before)
