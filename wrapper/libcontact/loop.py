"""The time loop of a run: chunks of C steps, records, progress, Ctrl-C, and the handling of
errors."""

from __future__ import annotations

import contextlib
import math
import os
import signal
import threading
import time as clock
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from ._core import ffi, lib
from .bridge import Floats, Rows, ask, call, copied, doubles, has
from .errors import (
    ArgumentError,
    EnergyGrowth,
    Error,
    NotBuiltIn,
    SceneWarning,
    StepDivided,
    StepError,
    bare,
    issue,
    new_error,
    place,
    raise_held,
    text_of,
)
from .hdf5 import ADVICE, files
from .mesh import view
from .model import FEEDS, FIELDS, FILTERED
from .observers import Observer, own
from .pieces import Pieces
from .probes import Histories
from .problem import Problem, contact_points, contact_pressure, new_state, penetrations
from .problem_part import Part
from .progress import bar
from .results import Records, write_tables
from .run import FAULTS, Run, RunError, StepTooLarge
from .schema import Place, SceneError, is_number, listed
from .state import BodyState, State
from .surfaces import contact_tables, whole_skin
from .tables import ENERGY, MOMENTUM, as_table, energy_table
from .timing import computed_fraction, measured, step_seconds

# Defaults of the recording interval: the number of records, the least number of steps between them in
# a problem of many nodes, and bounds on the recorded values (records times nodes).
MOST_RECORDS, STEPS_A_RECORD, FEW_VALUES, MOST_VALUES = 100, 4, 10**6, 10**8
# Values of displacements, velocities and pressures that a run without a file keeps in memory.
KEPT_VALUES, VALUES_A_NODE = 3 * 10**6, 7
CHUNK_SECONDS = 0.1
# Shortest chunk in steps: each chunk first finds the sleeping elements, at the cost of 2 to 3 steps.
CHUNK_STEPS = 16
REST_STEPS = 20
# Largest number of parts into which a run divides the step with which it began.
MOST_PARTS = 1024


def schedule(problem: Problem) -> tuple[int, Sequence[int]]:
    """Recording interval in steps, and the steps that are recorded before the last one."""
    output, count = problem.parts.output, problem.step_count
    if output.times is not None:
        return count, sorted({0, *(_step_of(t, problem) for t in output.times)} - {count})
    every = output.every or default_interval(count, problem.pointer.node_count)
    return every, range(0, count, every)


def default_interval(steps: int, nodes: int) -> int:
    """Default number of steps between two records; computed from counts only, so that files are
    equal on every machine."""
    # Steps over the number of records (eq:default-records)
    most = max(steps // STEPS_A_RECORD, FEW_VALUES // nodes)
    return max(1, math.ceil(steps / max(1, min(MOST_RECORDS, most, max(10, MOST_VALUES // nodes)))))


def record_count(problem: Problem) -> int:
    """Number of records of the whole run, the first and the last state included."""
    return len(schedule(problem)[1]) + 1


def _step_of(t: float, problem: Problem) -> int:
    if not t / problem.dt <= problem.step_count + 0.5:
        reason = f"{t:g} is after the end of the run, {problem.end:g}"
        raise SceneError(reason, "output.times", problem.file)
    return min(round(t / problem.dt), problem.step_count)


def last_step(problem: Problem, until: Any) -> int:
    """The first step that is not before ``until`` (None: the end)."""
    if until is None:
        return problem.step_count
    at = Place("until", problem.file)
    if not is_number(until) or not until > 0.0:
        raise at.error(f"is {until!r}; it must be a time above 0")
    if until > problem.end * (1.0 + 1e-12):
        raise at.error(f"{until:g} is after the end of the run, {problem.end:g}")
    return min(max(math.ceil(float(until) / problem.dt * (1.0 - 1e-12)), 1), problem.step_count)


def _divided(due: Sequence[int], factor: int) -> Sequence[int]:
    """Numbers of steps, counted in steps that are ``factor`` times as short."""
    if isinstance(due, range):
        return range(due.start * factor, due.stop * factor, due.step * factor)
    return [factor * step for step in due]


class Loop:
    """One run of a problem, from its first record to its last.

    ``built`` returns the problem with another step. With it a run divides its step where the step is
    too large, :eq:`step-change`; without it such a run ends.
    """

    def __init__(
        self,
        problem: Problem,
        scene_text: str,
        watch: Any = None,
        until: Any = None,
        built: Callable[[float], Problem] | None = None,
        checks: Iterable[Observer] = (),
        observers: Iterable[Any] = (),
        pieces: Pieces | None = None,
    ):
        self.problem, self.scene_text, self.watch = problem, scene_text, watch
        # The step with which the run begins, its present number of parts, and the changes so far.
        self.first, self.parts, self.built = problem, 1, built
        self.divisions: list[tuple[float, int]] = []
        self.last, self.due = last_step(problem, until), schedule(problem)[1]
        self.end_step, self.recorded = problem.step_count, -1
        self.time: Any = problem.parts.time
        self.state = new_state(problem)
        # On several processes, of which this is the first, those, and the piece that this one steps.
        self.pieces = pieces
        self.piece: Any = None
        self.probes = Histories(problem)
        self.observers = list(checks)
        self.observers += own(problem, observers, lambda state: self._state(state, state))
        self.filter = self._filter(problem.parts.output.filter)
        self.monitor: Any = None
        self.output: Any = None
        self.path: Path | None = None
        self.is_open = False
        # One entry per record in each, after empty tables.
        self.steps: list[int] = []
        self.kept: list[State] = []
        self.keep_every = self._keep_every()
        none = np.empty((0, len(problem.effects)))
        self.energy = [energy_table(np.empty(0, ENERGY), problem.effects, none)]
        self.momentum: list[Rows] = [np.empty(0, MOMENTUM)]
        # The first chunk is limited by the number of nodes, later ones by the time of earlier ones.
        self.interrupted, self.chunk = False, max(1, FEW_VALUES // problem.pointer.node_count)
        # Ratio of the last warning of spurious energy; 0: none yet.
        self.grown = 0.0
        self.seconds = self.output_seconds = 0.0

    def __deepcopy__(self, memo: Any) -> Loop:
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        # A pickled run has no loop.
        return type(None), ()

    # Output.

    def _input(self, key: str, function: Any, *arguments: Any) -> Any:
        """Call a function; an error of the C library becomes an error of the input."""
        try:
            return function(*arguments)
        except Error as error:
            raise SceneError(f"{error}{self._changed(error)}", key, self.problem.file) from None

    def _changed(self, error: Error) -> str:
        """The reason why a results file belongs to another problem although the scene is the same."""
        if "another problem" not in str(error):
            return ""
        bodies = list(self.problem.parts.bodies.values())
        bodies = bodies if error.body is None else bodies[error.body : error.body + 1]
        files = dict.fromkeys(str(body.mesh) for body in bodies if body.mesh is not None)
        return f"; the mesh file {listed(files)} has changed since then" if files else ""

    def _filter(self, passes: int) -> Any:
        """The filter of the recorded fields; None without passes."""
        if passes == 0:
            return None
        given = self.problem.pointer, passes
        made = self._input("output.filter", ask, "ct_filter **", lib.ct_filter_create, *given)
        return ffi.gc(made, lambda own, problem=self.problem: lib.ct_filter_free(own))

    def _keep_every(self) -> int:
        """Number of records per state that a run without a file keeps for pictures."""
        room: int = KEPT_VALUES // (VALUES_A_NODE * self.problem.pointer.node_count)
        return math.ceil((len(self.due) + 1) / max(1, room))

    def restart(self, path: str | Path, asked: int = 1) -> None:
        """Continue from the newest restart record of a file, whose run began with ``asked`` times the step of
        this run."""
        if not has("hdf5"):
            raise NotBuiltIn(f"this build has no HDF5, so it can't read a restart: {ADVICE}")
        name, dt = os.fsencode(path), ffi.new("double *")
        found = (name, self.problem.pointer, self.state, dt)
        self._input("restart", call, files.ct_output_restart_step, *found)
        # The run has divided its step by `ran`, and this one divides it by a multiple of that.
        ran = round(asked * self.first.dt / dt[0])
        if self._divide(max(self.parts, ran // math.gcd(ran, asked))):
            self.state = new_state(self.problem)
        coarse, state = self.problem, self.state
        if dt[0] != self.problem.dt:
            coarse = self._with_step(dt[0])
            state = new_state(coarse)
        self._input("restart", call, files.ct_output_restart, name, coarse.pointer, state)
        if state is not self.state:
            fine = (self.problem.pointer, state, self.state)
            self._input("restart", call, lib.ct_state_subdivide_step, *fine)
        if self.probes:
            given = (name, self.state, self.probes.pointer)
            self._input("restart", call, files.ct_output_restart_probes, *given)

    def _create(self, path: str | Path) -> Any:
        text, output = ffi.new("char[]", self.scene_text.encode()), self.problem.parts.output
        options = ffi.new("ct_output_options *", lib.ct_output_options_default())
        for name in FIELDS:
            setattr(options, name, name in self.problem.parts.fields)
        options.scene, options.probes, options.filter = text, self.probes.pointer, output.filter
        pointer = self.first.pointer
        return ask("ct_output **", files.ct_output_create, os.fsencode(path), pointer, options)

    def open(self, path: str | Path) -> None:
        """Create the results file. Without HDF5 the results stay in memory, and ``known`` has warned."""
        if has("hdf5"):
            self.output = self._input("output.file", self._create, path)
            self.path, self.is_open = Path(path).absolute(), True

    def close(self) -> None:
        """Close the results file, if there is one."""
        if self.is_open:
            self.is_open = False
            self._end_file()

    def _end_file(self) -> None:
        output, self.output, error = self.output, None, new_error()
        if output is not None and files.ct_output_close(output, error) != lib.CT_OK:
            raise RunError(text_of(error.code, error), self.result())

    def abandon(self) -> None:
        """Close the file after a failure; earlier records stay readable."""
        with contextlib.suppress(RunError):
            self.close()

    def write(self, run: Run, path: Path) -> None:
        """Save a run that has no file: its last state through the C library, and all rows of its tables."""
        if not has("hdf5"):
            raise NotBuiltIn(f"this build has no HDF5, so it can't save a run: {ADVICE}")
        try:
            self.output = self._create(path)
            self._call(files.ct_output_append, self.output, self.problem.pointer, self.state)
            self._end_file()
        except Error as reason:
            with contextlib.suppress(RunError):
                self._end_file()
            raise OSError(str(reason)) from None
        write_tables(path, run.steps, run.energy, run.momentum)

    def fail(self, error: RunError) -> None:
        """After a fault: record the last good state if it is newer than the last record, close the
        file, and return advice on how to continue."""
        good = self.monitor and (lib.ct_monitor_good(self.monitor) or None)
        if good is not None and self.steps and good.step > self.recorded:
            with contextlib.suppress(RunError):
                self._write_record(good)
        path = self.path if self.is_open and self.steps else None
        self.abandon()
        error.time, error.step, error.checkpoint = self.state.time, self.state.step, path
        state = None if good is None else self._state(good, self.monitor)
        kept = [*self.kept, *([state] if state is not None else [])]
        states = kept if self.path is None else self._states()
        error.run = self.result(state=state, states=states)
        if good is not None:
            error.args = (f"{bare(str(error))}. {self._advice(good, path)}",)

    def _advice(self, good: Any, path: Path | None) -> str:
        """Advice: whether the step of the run exceeds the stable one of the last good state, and
        how to continue from it."""
        text, stable = "", ffi.new("ct_stable_step *")
        if lib.ct_stable(self.problem.pointer, good, stable, ffi.NULL) != lib.CT_OK:
            raise_held()
        elif self.problem.dt > stable.dt * (1.0 + 1e-9):
            text = f"The stable step has decreased to {stable.dt:.6g}, and the run uses {self.problem.dt:.6g}: choose a smaller step. "
        where = f"The last good state, t = {good.time:.6g} (step {good.step}), is "
        if path is None:
            return f"{text}{where}run.state of this error; without a results file nothing can be restarted"
        if good.step > self.recorded:  # the file takes no more
            last = f"t = {self.energy[-1]['time'][0]:.6g} (step {self.recorded})"
            where = f"{len(self.steps)} records are kept, the last one, {last}, "
        return (
            f'{text}{where}in "{path}"; scene.run(restart="{path}", output="...") continues from it'
        )

    def record(self, checked: bool) -> None:
        """Record one row of each table, and one step of the file, for a state that may have been
        ``checked`` just now."""
        begin = clock.perf_counter() - step_seconds(self.problem, self.state).sum()
        if not checked:
            self._call(lib.ct_monitor_check, self.monitor, self.state)
        if self.probes:
            self._call(lib.ct_probes_sample, self.probes.pointer, self.state)
        self._write_record(self.state)
        if not self.is_open and (len(self.steps) - 1) % self.keep_every == 0:
            self.kept.append(self._state(self.state, self.state, pressure=True))
        if self.watch is not None:
            self.watch(self.result(records=1))
        # A record evaluates the forces of the next step, which then reuses them.
        forces = step_seconds(self.problem, self.state).sum()
        self.output_seconds += clock.perf_counter() - forces - begin

    def _write_record(self, state: Any) -> None:
        """Record one row of each table, and one step of the file, for the last good state of the
        monitor."""
        problem, ledger = self.problem, lib.ct_monitor_ledger(self.monitor)
        if self.is_open:
            self._call(files.ct_output_append_row, self.output, problem.pointer, state, ledger)
        row = ffi.addressof(ledger, "energy")
        # A column for the energy or the work of each further effect.
        done = copied("ct_effect_energy", ledger.effects, len(problem.effects))
        values = np.where(problem.stores, done["stored"], done["work"])[np.newaxis]
        self.energy.append(energy_table(copied("ct_energy", row, 1), problem.effects, values))
        momentum = copied("ct_momentum", ledger.momentum, len(problem.bodies))
        self.momentum.append(momentum.astype(MOMENTUM))
        self.steps.append(state.step)
        self.recorded = state.step

    # Time loop.

    def run(self, progress: Any, path: str | Path | None = None) -> Run:
        """Step to the end and record as the scene says, into a file if a path is given. An error is
        a RunError with the run so far."""
        begin = clock.perf_counter()
        try:
            # From here on Ctrl-C waits, so that the file of an interrupted run has a record.
            with _ctrl_c() as stop:
                if path is not None:
                    self.open(path)
                self._steps(progress, stop)
            self.seconds = clock.perf_counter() - begin
        except RunError as error:
            self.fail(error)
            raise
        else:
            self.close()
        finally:
            self.abandon()
        self.monitor = None  # gives the last good state back
        return self.result()

    def _steps(self, progress: Any, stop: list[int]) -> None:
        last, state = self.last, self.state
        if state.step > last:
            reason = f"the restart is at step {state.step}, after the last step {last}"
            raise SceneError(reason, "restart", self.problem.file)
        self.start_monitor()
        shown = {"total": last // self.parts, "initial": state.step // self.parts, "unit": " steps"}
        with bar(progress, **shown) as advanced:
            self.record(checked=True)
            self._observe(at_end=True)
            while not self._goes_to_the_end(advanced.update, stop):
                pass
        self._observe(at_end=True)
        state = self.state
        self.interrupted = bool(stop) and state.step < self.last
        at_end = self.last == self.end_step and not stop
        if self.time.until_static is not None and at_end and not self._at_rest():
            text = f"the run ends at t = {state.time:g} before it comes to rest: residual {self._residual():.2g}, "
            text += f"until_static = {self.time.until_static:g}; set a later end, or more [damping]"
            issue(SceneWarning("not_at_rest", text, "time.until_static"))
        if state.unconverged:
            text = f"the contact forces did not converge to their tolerance in {min(state.unconverged, state.step)} of {state.step} steps; "
            issue(SceneWarning("unconverged", text + "choose a smaller step or a smaller beta"))

    def _goes_to_the_end(self, advanced: Any, stop: list[int]) -> bool:
        """Step to the end, to rest or to a Ctrl-C, and record. False if the step was divided and the run must
        go on."""
        try:
            while self.state.step < self.last and not stop and not self._at_rest():
                at = bisect_right(self.due, self.state.step)
                due = min([*self.due[at : at + 1], self.last])
                checks = (observer.next(self.state.step) for observer in self.observers)
                target = int(min(due, self._next_rest(), *checks))
                self._advance(target, due, advanced, stop)
                if self.state.step == due:
                    self.record(checked=True)
                self._observe()
            if self.state.step > self.recorded:
                self.record(checked=False)
        except StepError as fault:
            self._divide_after(fault)
            return False
        return True

    # A smaller step.

    def begin(self) -> None:
        """Divide the step until the forces at t = 0 can be computed with it."""
        while self.state.step == 0 and self._is_refused() and self._divide(2 * self.parts):
            self.state = new_state(self.problem)
            self._note_division("the first step is too large")

    def _is_refused(self) -> bool:
        """Whether an effect refuses the step at the present state."""
        given = self.problem.pointer, self.state, ffi.new("ct_energy *"), ffi.NULL
        status = lib.ct_energy_of(*given)
        raise_held()
        return bool(status == lib.CT_ERROR_STEP)

    def _with_step(self, dt: float) -> Problem:
        assert self.built is not None
        return self.built(dt)

    def _divide(self, parts: int) -> bool:
        """Continue with the problem of the first step divided by ``parts``, a multiple of the present number.
        The caller replaces the state. False if that is the present step, or too short."""
        factor = parts // self.parts
        if self.built is None or factor == 1 or parts > MOST_PARTS:
            return False
        try:
            problem = self._with_step(self.first.dt / parts)
        except SceneError:  # more steps than are possible
            return False
        if self.probes:
            self.probes.divide(problem, factor)
        for observer in self.observers:
            observer.divide(problem, factor)
        self.problem, self.parts, self.piece = problem, parts, None
        self.last, self.end_step = factor * self.last, factor * self.end_step
        self.due, self.recorded = _divided(self.due, factor), factor * self.recorded
        return True

    def _divide_after(self, fault: StepError) -> None:
        """
        Continue with a divided step after ``fault``.

        If an effect refuses the step, the run goes back to the state before this step, which does not
        depend on records. If the monitor has found the fault, maybe some steps late, the run goes back to
        the last good state.
        """
        state, problem, good = self.state, self.problem, lib.ct_monitor_good(self.monitor)
        before = good.step
        if state.time != state.step * problem.dt:  # within a step
            before = state.step
        elif self._is_refused():
            before = max(before, state.step - 1)
        if not self._divide(2 * self.parts):
            if not isinstance(fault, RunError):
                fault = StepTooLarge(bare(str(fault)), lib.CT_ERROR_STEP)
            if self.parts > 1:
                fault.args = (
                    f"{bare(str(fault))}; the step {self.first.dt:.6g} was already divided by {self.parts}",
                )
            raise fault
        self._call(lib.ct_state_copy, problem.pointer, good, state)
        self._call(lib.ct_run, problem.pointer, state, before - good.step, ffi.NULL, 0)
        # At t = 0 there is no step to convert.
        status, error = lib.CT_OK, new_error()
        self.state = to = new_state(self.problem)
        while state.step > 0:
            status = lib.ct_state_subdivide_step(self.problem.pointer, state, to, error)
            if status != lib.CT_ERROR_STEP or not self._divide(2 * self.parts):
                break
            self.state = to = new_state(self.problem)
        self._check(status, error)
        _add_counts(state, to)
        self._note_division(bare(str(fault)))
        self._warn_of_growth()
        self.start_monitor()

    def _note_division(self, reason: str) -> None:
        """Count a division of the step, and warn of the first one."""
        self.divisions.append((self.state.time, self.parts))
        if len(self.divisions) > 1:
            return
        text = f"from t = {self.state.time:.6g} on the time step {self.first.dt:.6g} is divided by {self.parts}, and further where that is not enough: "
        reason = reason.removesuffix(". Take a smaller step")
        issue(StepDivided(text + reason, "time", self.state.time, self.parts))

    def start_monitor(self) -> None:
        """Start the monitor of the state; an error at this point is an error of the input."""
        options, time = ffi.new("ct_monitor_options *", lib.ct_monitor_options_default()), self.time
        options.every, options.energy_limit = time.look_every, time.energy_limit
        options.stable = self.problem.stable.dt
        if self.monitor is not None:  # the total of a divided step is another one
            options.first_total = self.energy[1]["total"][0]
        given, free = (self.problem.pointer, self.state, options), lib.ct_monitor_free
        monitor = self._input("", ask, "ct_monitor **", lib.ct_monitor_create, *given)
        self.monitor = ffi.gc(monitor, lambda watch, problem=self.problem: free(watch))

    def _warn_of_growth(self, at_end: bool = False) -> None:
        """Warn of spurious energy growth, :eq:`energy-growth`: of the first, and at the end of the largest if that
        is more than twice as large."""
        growth = lib.ct_monitor_growth(self.monitor)
        due = at_end or not self.grown
        if not (due and growth.largest > 2.0 * self.grown):
            return
        who, key, advice = self._grower(growth)
        ratio = growth.largest if self.grown else growth.ratio
        much = "energy where the bodies should have none"
        if math.isfinite(ratio):
            much = f"{100.0 * ratio:.3g} % more energy than the bodies should have"
        when = f"by t = {growth.time:.6g} (step {growth.step})"
        text = f"there is {much} {when}, most of it from {who}: {advice}"
        if self.grown:
            text = f"the energy has grown further: there was {much} at most"
        self.grown = ratio
        issue(EnergyGrowth(text, key, ratio, growth.time, who))

    def _observe(self, at_end: bool = False) -> None:
        """Call the observers that check this state, all of them ``at_end`` and at the start."""
        step = self.state.step
        for observer in self.observers:
            if at_end or observer.is_due(step, step == self.recorded):
                for warning in observer.warnings(self.state):
                    issue(warning)
        self._warn_of_growth(at_end)

    def _grower(self, growth: Any) -> tuple[str, str, str]:
        """The cause of spurious energy growth, its key in the scene, and advice."""
        effects = self.problem.pointer.effects
        *before, kind = (effects[k].kind for k in range(growth.effect + 1))
        step = "take a smaller step (time.fraction)"
        if kind == lib.CT_EFFECT_SOLID:
            who, key = f'body "{list(self.problem.bodies)[growth.body]}"', f"body[{growth.body}]"
            name, value = self.time.step
            advice = f"at large strain steps keep energy to second order only; {name} = {value / 2:.3g} leaves a quarter of it or less"
            return who, key, advice
        words = {lib.CT_EFFECT_CONTACT: "contact ", lib.CT_EFFECT_OBSTACLE: "obstacle at "}
        if kind not in words:
            advice = f"{step}, and compare its stored energy with the work of its force"
            return f'effect "{self.problem.effects[growth.effect]}"', "", advice
        name, nth = words[kind].split()[0], before.count(kind)
        alike = [each for each in contact_tables(self.problem.parts) if each[0].startswith(name)]
        key, who, given = alike[nth]
        advice = f"points penetrate that did not pass the surface, as at an edge or in a fold; {step}, a finer mesh there, or a smaller beta"
        if FEEDS[given.enforcement]:
            advice = f'{step}, a smaller beta, or enforcement = "energy_controlled"'
        if len(getattr(given, "surfaces", ())) == 2:
            advice += whole_skin(given.surfaces)
        return words[kind] + who, key, advice

    def _residual(self) -> float:
        value = ffi.new("double *")
        self._call(lib.ct_energy_residual, self.problem.pointer, self.state, value)
        return float(value[0])

    def _next_rest(self) -> int:
        """The next step at which rest is checked; these steps do not depend on the speed of the
        machine."""
        if self.time.until_static is None:
            return self.end_step
        return int((self.state.step // REST_STEPS + 1) * REST_STEPS)

    def _at_rest(self) -> bool:
        """Whether the run may end here: histories have ended and the bodies are at rest."""
        wanted, step = self.time.until_static, self.state.step
        if wanted is None or step == 0 or step % REST_STEPS:
            return False
        return self.state.time >= self.problem.settled and bool(self._residual() <= wanted)

    def _advance(self, target: int, due: int, advanced: Any, stop: list[int]) -> None:
        """
        Step to ``target`` in chunks of about a tenth of a second, or of 16 steps if these take longer.

        Ctrl-C and the progress bar are served between chunks. A state that is ``due`` to be recorded is
        checked in the same call.
        """
        if self.pieces is not None:
            self._advance_pieces(target, due, advanced, stop)
            return
        while self.state.step < target and not stop:
            count = min(self.chunk, target - self.state.step)
            begin = clock.perf_counter()
            observers = self._observers(self.state.step + count == due)
            given = self.problem.pointer, self.state, count, observers, len(observers)
            self._call(lib.ct_run, *given)
            took = clock.perf_counter() - begin
            advanced(count / self.parts)
            next_count = (
                2 * self.chunk if took < CHUNK_SECONDS / 2 else count * CHUNK_SECONDS / took
            )
            self.chunk = min(max(CHUNK_STEPS, int(next_count)), 10**6)

    def _advance_pieces(self, target: int, due: int, advanced: Any, stop: list[int]) -> None:
        """The same on several processes: each steps its piece up to the next check of the whole state, in chunks
        whose length this one, the first, chooses; a Ctrl-C of one of them counts for all."""
        pieces, problem, looks = self.pieces, self.problem, self.time.look_every
        assert pieces is not None
        if self.piece is None:
            pieces.tell("cut", (problem.dt, self.scene_text, problem.effects))
            pieces.divide(problem)
            self.piece = pieces.cut(problem, self.state)
        piece = self.piece
        while piece.step < target and not stop:
            end = min(target, (piece.step // looks + 1) * looks)
            count, begin = min(self.chunk, end - piece.step), clock.perf_counter()
            pieces.tell("run", count)
            try:
                _run_piece(pieces, problem, piece, count, self.probes, stop)
            except RunError:
                self._collect()
                raise
            if pieces.interrupted and not stop:
                stop.append(0)
            took = clock.perf_counter() - begin
            advanced(count / self.parts)
            self.chunk = max(CHUNK_STEPS, int(count * min(2.0, CHUNK_SECONDS / max(took, 1e-9))))
            if piece.step % looks == 0 or piece.step in (target, due):
                self._collect()
            if self.state.step == piece.step and (piece.step % looks == 0 or piece.step == due):
                self._call(lib.ct_monitor_check, self.monitor, self.state)
        if self.state.step < piece.step:
            self._collect()

    def _collect(self) -> None:
        """Collect the whole state; not within a step that has failed."""
        assert self.pieces is not None
        self.pieces.tell("collect")
        with contextlib.suppress(ArgumentError):
            call(lib.ct_state_collect, self.piece, self.state)

    def _observers(self, last: bool) -> Any:
        """The observers of the C library; the monitor also checks the ``last`` state."""
        monitor = lib.ct_monitor_observer(self.monitor)
        monitor.last = last
        probes = [lib.ct_probes_observer(self.probes.pointer)] if self.probes else []
        return ffi.new("ct_observer[]", [monitor, *probes])

    def _call(self, function: Any, *arguments: Any) -> None:
        """Call the C library during a run; an error becomes a RunError of its kind, with the body's
        name."""
        error = new_error()
        self._check(function(*arguments, error), error)

    def _check(self, status: int, error: Any) -> None:
        _check(self.problem, status, error)

    # Results.

    def result(self, records: int = 0, **fault: Any) -> Run:
        """The run so far, or its last records; after a fault with the given state."""
        problem = self.problem
        return Run(
            bodies=list(problem.bodies),
            units=problem.parts.units,
            steps=np.array(self.steps[-records:], np.int64),
            energy=as_table(np.concatenate(self.energy[-records:])),
            momentum=as_table(np.concatenate(self.momentum[-records:])),
            path=self.path,
            scene=self.scene_text,
            interrupted=self.interrupted,
            seconds=self.seconds,
            costs=measured(problem, self.state, self.output_seconds),
            computed=computed_fraction(self.state),
            dt=problem.dt,
            divisions=list(self.divisions),
            probes=self.probes.tables(last=bool(records)),
            **(fault or self._last(bool(records))),
        )

    def _last(self, watched: bool) -> dict[str, Any]:
        """The results that a run has for its last state only."""
        problem, state = self.problem, self.state
        impulse: dict[str, Any] = {}
        for k, name in enumerate(problem.effects[1:], start=1):
            given = np.zeros(3)
            self._call(lib.ct_energy_impulse, problem.pointer, state, k, doubles(given))
            impulse[name] = impulse.get(name, 0.0) + given
        known = {
            "state": self._state(state, state, at_once=watched),
            "states": [] if watched else self._states(),
            "writer": self,
            "impulse": impulse,
        }
        known["penetration"] = [] if watched else penetrations(problem, state)
        known["pressure"] = {} if watched else contact_pressure(problem, state)
        return {**known, "contact": contact_points(problem, state)}

    def _states(self) -> Sequence[State]:
        """The recorded states: of the file, or those kept and the last one."""
        if self.path is not None:
            return Records(self.path, len(self.steps))
        if self.kept and self.kept[-1].step == self.state.step:
            return list(self.kept)
        return [*self.kept, self._state(self.state, self.state, at_once=False, pressure=True)]

    def _state(self, state: Any, owner: Any, at_once: bool = True, pressure: bool = False) -> State:
        """A state with its fields; ``owner`` keeps its memory alive. A state that will change is copied,
        with all fields computed ``at_once``, otherwise on first use. The contact ``pressure`` is a
        field also where the output does not name it."""
        problem = self.problem
        u = view(state.displacement, (state.node_count, 3), np.float64, (owner, problem))
        u = u.copy() if at_once else u
        made = {"velocity": cache(partial(_made, u.shape, lib.ct_state_velocity, problem, state))}
        touched = pressure and next(contact_tables(problem.parts), None) is not None
        if touched or "contact_pressure" in problem.parts.fields:
            recovered = partial(_made, len(u), lib.ct_state_pressure, problem, state)
            made["contact_pressure"] = cache(recovered)
        if self.filter is not None:
            for name in FILTERED[:2]:
                made[name] = cache(partial(_smooth, u.shape, self.filter, state, name))
        if at_once:
            for values in made.values():
                values()
        bodies = {}
        for name, body in problem.bodies.items():
            fields: dict[str, Any] = {"displacement": u[body.nodes]}
            fields |= {field: partial(_rows, values, body.nodes) for field, values in made.items()}
            if body.kernel == "rigid":
                fields["stress"] = np.zeros((len(body.mesh.elements), 6))
            initial = problem.parts.bodies[name].initial
            stress, of = initial and initial.stress, body.by_material
            bodies[name] = BodyState(name, body.mesh, body.material, stress, of, **fields)
        return State(state.time, state.step, bodies)


def _check(problem: Problem, status: int, error: Any) -> None:
    """Raise the RunError of a status other than CT_OK."""
    if status == lib.CT_OK:
        return
    text, names = text_of(status, error), list(problem.bodies)
    name = names[error.body] if 0 <= error.body < len(names) else None
    if name is not None and name not in text:
        text = f'body "{name}": {text}'
    at: dict[str, Any] = place(error)
    if problem.part is not None:
        text, at = problem.part.told(text, at)
    fault = FAULTS.get(status, RunError)(text, code=status, **at)
    fault.body_name = name
    raise fault


def _run_piece(
    pieces: Pieces, problem: Problem, piece: Any, count: int, probes: Histories, stop: list[int]
) -> None:
    """Steps of a piece, the same number on all processes."""
    observers = [lib.ct_probes_observer(probes.pointer)] if probes else []
    given = problem.pointer, piece, count, ffi.new("ct_observer[]", observers), len(observers)
    error = new_error()
    pieces.alike(lambda: _check(problem, lib.ct_run(*given, error), error), stop)


def follow(pieces: Pieces, built: Callable[[float, str, list[str], Part | None], Problem]) -> Run:
    """The part of a process other than the first one in a run: it steps its piece as that one tells, and has no
    whole state. ``built`` returns a part of the problem, with a step, if the first process has the same scene. Returns
    the Run, without states."""
    problem: Any = None
    piece: Any = None
    probes: Any = None
    with _ctrl_c() as stop:
        while True:
            what, value = pieces.told()
            if what == "end":
                return pieces.ended(*value)
            try:
                if what == "cut":
                    problem = piece = probes = None  # whose memory is free for the next ones
                    problem = pieces.built(partial(built, *value))
                    probes, piece = Histories(problem), pieces.cut(problem)
                elif what == "run":
                    _run_piece(pieces, problem, piece, value, probes, stop)
                else:
                    call(lib.ct_state_collect, piece, ffi.NULL)
            except Exception as error:
                if not pieces.is_common(error):
                    raise  # the first process raises all others, too


def _add_counts(of: Any, to: Any) -> None:
    """Add the times and counts of the steps of one state to those of another one."""
    effects = of.problem.effect_count + 1
    for values, more, count in (
        (to.effect_seconds, of.effect_seconds, effects),
        (to.element_updates, of.element_updates, 2),
    ):
        for i in range(count):
            values[i] += more[i]
    to.unconverged += of.unconverged
    to.constraint_rounds += of.constraint_rounds


def _made(shape: Any, function: Any, problem: Problem, state: Any) -> Floats:
    """An array that a function of the library fills from a state."""
    out = np.empty(shape)
    call(function, problem.pointer, state, doubles(out))
    return out


def _smooth(shape: Any, smooth: Any, state: Any, name: str) -> Floats:
    """A filtered field of the nodes."""
    out = np.empty(shape)
    given = (doubles(out), ffi.NULL) if name == FILTERED[0] else (ffi.NULL, doubles(out))
    call(lib.ct_filter_apply, smooth, state, *given)
    return out


def _rows(values: Callable[[], Floats], rows: slice) -> Floats:
    return values()[rows]


@contextlib.contextmanager
def _ctrl_c() -> Iterator[list[int]]:
    """A list that is empty until the first Ctrl-C; the second one interrupts as usual."""
    stop: list[int] = []

    def handler(number: int, frame: Any) -> None:
        if stop:
            raise KeyboardInterrupt
        stop.append(number)

    before = signal.getsignal(signal.SIGINT)
    main = threading.current_thread() is threading.main_thread()
    ours = main and before not in (None, signal.SIG_IGN)
    if ours:
        signal.signal(signal.SIGINT, handler)
    try:
        yield stop
    finally:
        if ours:
            signal.signal(signal.SIGINT, before)
