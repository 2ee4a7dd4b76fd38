"""A run on several processes: which of them computes which elements, and what they exchange through MPI (chapter
"Pieces")."""

from __future__ import annotations

import contextlib
import copy
import importlib.util
import os
import pickle
import sys
import traceback
import warnings
from collections.abc import Callable, Iterator, Sized
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

from ._core import ffi, lib
from .bridge import Ints, Rows, ask, call, copied, ints
from .contact import exchanged
from .cutting import can_be_parted, parts_of
from .errors import Error, NotBuiltIn, SceneWarning, held, install
from .mesh import side_nodes
from .problem import Problem
from .problem_part import Part

if TYPE_CHECKING:
    from .run import Run

# Fewest elements per piece for METIS.
FEW_ELEMENTS = 8
# Where launchers of MPI say how many processes there are, and which one this is.
SIZES = ("PMI_SIZE", "OMPI_COMM_WORLD_SIZE", "MPI_LOCALNRANKS", "PMIX_SIZE")
RANKS = ("PMI_RANK", "OMPI_COMM_WORLD_RANK", "MPI_LOCALRANKID", "PMIX_RANK")
T = TypeVar("T")


def launched() -> tuple[int, int]:
    """Number of processes that a launcher of MPI has started, and that of this one; 1 and 0 without one."""
    size, rank = (max(int(os.environ.get(name, "0")) for name in names) for names in (SIZES, RANKS))
    return max(size, 1), rank


def world() -> Any:
    """The communicator of a program that MPI has started on several processes; None on one."""
    if launched()[0] <= 1:
        return None
    try:
        from mpi4py import MPI
    except (ImportError, RuntimeError) as reason:
        raise NotBuiltIn(
            f"a run on several processes needs mpi4py: {install('mpi')} ({reason})"
        ) from None
    return MPI.COMM_WORLD if MPI.COMM_WORLD.size > 1 else None


def elements_of(problem: Problem) -> int:
    """The number of elements of all bodies."""
    return sum(len(body.mesh.elements) for body in problem.bodies.values())


def bisect(problem: Problem, count: int) -> Ints:
    """The piece of each element, cut by coordinates."""
    owners = np.empty(elements_of(problem), np.int32)
    call(lib.ct_piece_bisect, problem.pointer, count, ffi.NULL, ints(owners))
    return owners


def metis(problem: Problem, count: int) -> Ints:
    """The piece of each element by METIS: few shared sides, and equal numbers."""
    import pymetis

    pairs, first = [], 0
    for body in problem.bodies.values():
        cells = body.mesh.elements[:, :8]
        sides = np.sort(cells[:, side_nodes("hex8")].reshape(-1, 4), axis=1)
        owner = first + np.repeat(np.arange(len(cells)), 6)
        order = np.lexsort(sides.T)
        same = np.flatnonzero((sides[order][1:] == sides[order][:-1]).all(axis=1))
        pairs.append(np.stack([owner[order[same]], owner[order[same + 1]]]))
        first += len(cells)
    one, other = np.concatenate(pairs, axis=1)
    begin, end = np.concatenate([one, other]), np.concatenate([other, one])
    order = np.lexsort((end, begin))
    starts = np.searchsorted(begin[order], np.arange(first + 1))
    graph = {"xadj": starts.tolist(), "adjncy": end[order].tolist()}
    return np.array(pymetis.part_graph(count, **graph)[1], np.int32)


def owners_of(problem: Problem, count: int, partition: Any) -> Ints:
    """The piece of each element of all bodies, one body after another, as ``partition`` says: "metis",
    "coordinates", an array, or None for the best that is installed. METIS does not cut a small mesh, which is cut
    by coordinates."""
    has_metis = importlib.util.find_spec("pymetis") is not None
    wanted = elements_of(problem)
    if partition is None:
        partition = "metis" if has_metis else "coordinates"
    if isinstance(partition, str):
        if partition not in ("metis", "coordinates"):
            raise ValueError(
                f'there is no partition "{partition}"; it is "metis", "coordinates" or an array'
            )
        if partition == "metis" and not has_metis:
            raise NotBuiltIn(f'partition = "metis" needs pymetis: {install("mpi")}')
        small = wanted < FEW_ELEMENTS * count
        return (bisect if small or partition == "coordinates" else metis)(problem, count)
    owners = np.ascontiguousarray(partition, np.int32)
    if owners.shape != (wanted,):
        raise ValueError(f"the partition has shape {owners.shape}, and there are {wanted} elements")
    return owners


def common_nodes(problem: Problem) -> Ints:
    """The nodes that probes read: in every piece. Those of contacts and obstacles are anyway."""
    found = [np.empty(0, np.int32)]
    for probe in problem.probes:
        table = probe.given.resultant and probe.given.resultant.table
        found.append(probe.nodes if table in (None, "support") else found[0])
        element = probe.members.get("element", -1)
        if element >= 0:
            body = list(problem.bodies.values())[probe.members["body"]]
            found.append(body.mesh.elements[element] + body.nodes.start)
    return np.unique(np.concatenate(found)).astype(np.int32)


def _definition(problem: Problem, owners: Ints, number: int, count: int) -> tuple[Any, Any]:
    """A ``ct_piece_def *`` without its functions, and what it points to."""
    new = ffi.new("ct_piece_def *", lib.ct_piece_def_default())
    common = common_nodes(problem)
    new.number, new.count = number, count
    new.owners, new.common, new.common_count = ints(owners), ints(common), len(common)
    part = problem.part
    if part is None:
        return new, common
    new.part = held = ffi.new("ct_piece_part *", {"node_count": part.node_count})
    held.nodes, held.owners = ints(part.numbers), ints(part.node_owners)
    return new, (common, held)


def _counts(state: Any) -> Rows:
    """The ``ct_piece_counts`` of a piece, shape (1,)."""
    counts = ffi.new("ct_piece_counts *")
    call(lib.ct_piece_counts_of, state, counts)
    return copied("ct_piece_counts", counts, 1)


def planned(problem: Problem, state: Any, count: int, partition: Any = None) -> Rows:
    """What each of ``count`` pieces would compute and exchange, a row per piece; nothing is exchanged."""
    owners, rows = owners_of(problem, count, partition), []
    alone, nobody = exchanged(lambda values: None), _transfer(lambda *given: None)
    for number in range(count):
        new, _kept = _definition(problem, owners, number, count)
        new.join.sum, new.join.largest, new.exchange = alone, alone, nobody
        piece = ask("ct_state **", lib.ct_state_cut, state, new)
        rows.append(_counts(piece))
        lib.ct_state_free(piece)
    return np.concatenate(rows)


def piece_lines(rows: Rows) -> list[str]:
    """Lines that tell what each piece computes and exchanges in a step."""
    lines = ["  piece   elements   of which own    own nodes   forces received   sent   neighbours"]
    for number, row in enumerate(rows):
        numbers = (row["elements"], row["own_elements"], row["nodes"], row["received"], row["sent"])
        lines.append(
            "{:7} {:10} {:14} {:12} {:17} {:6} {:12}".format(number, *numbers, row["neighbours"])
        )
    return lines


def _transfer(function: Callable[..., None]) -> Any:
    """A function ``exchange`` of ``ct_piece_def`` that calls one of Python; what it raises ends the step."""

    def answer(data: Any, send: Any, send_count: Any, receive: Any, receive_count: Any) -> int:
        try:
            function(send, send_count, receive, receive_count)
        except BaseException as reason:
            held.reason = reason
            return 1
        return 0

    given = "int(void *, const double *, const int32_t *, double *, const int32_t *)"
    return ffi.callback(given, answer)


def _sendable(error: Exception | None) -> Exception | None:
    """An error that other processes can read."""
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        return Error(f"{type(error).__name__}: {error}")
    return error


def _light(run: Run) -> Run:
    """A Run without what only the first process has: states, and what belongs to the last one."""
    run = copy.copy(run)
    run.state, run.writer, run.contact, run.pressure = None, None, [], {}
    run.states = run.states if run.path is not None else []
    return run


def _without_states(error: Exception) -> Exception:
    """An error whose Run has none."""
    if getattr(error, "run", None) is not None:
        error = copy.copy(error)
        error.run = _light(error.run)  # type: ignore[attr-defined]
    return error


class Pieces:
    """The processes of one run. The first one has the whole state and decides; the others do what it tells."""

    def __init__(self, comm: Any, partition: Any):
        self.comm, self.rank, self.size = comm, int(comm.rank), int(comm.size)
        self.partition = partition
        from mpi4py import MPI

        self._sum = exchanged(lambda values: comm.Allreduce(MPI.IN_PLACE, values, MPI.SUM))
        self._largest = exchanged(lambda values: comm.Allreduce(MPI.IN_PLACE, values, MPI.MAX))
        self._exchange = _transfer(self._send)
        # Of the elements, on the first process, if the others have parts.
        self._owners: Ints | None = None
        self._common: BaseException | None = None  # the last error that all processes raise
        # Whether a process was asked to stop before the last call of `alike`.
        self.interrupted = False

    def _send(self, send: Any, send_count: Any, receive: Any, receive_count: Any) -> None:
        there = [
            (_numbers(count, self.size), to)
            for count, to in ((send_count, send), (receive_count, receive))
        ]
        buffers = [
            (np.frombuffer(ffi.buffer(to, 8 * int(count.sum())), np.float64), count)
            for count, to in there
        ]
        self.comm.Alltoallv(*map(list, buffers))

    def tell(self, what: str, value: Any = None) -> None:
        """Let the other processes do something; the first one calls."""
        self.comm.bcast((what, value))

    def told(self) -> tuple[str, Any]:
        """What the first process tells; the others call."""
        what, value = self.comm.bcast(None)
        return what, value

    def divide(self, problem: Problem) -> None:
        """Give each other process its part of the problem; the first one calls."""
        self._owners = None
        if self.comm.bcast(can_be_parted(problem)):
            owners = self.first(lambda: owners_of(problem, self.size, self.partition), tell=False)
            self._owners = owners
            self.alike(lambda: self._send_parts(problem, owners))
        else:
            self.alike(lambda: None)

    def _send_parts(self, problem: Problem, owners: Ints) -> None:
        made, error = parts_of(problem, owners, self.size, common_nodes(problem)), None
        for number in range(1, self.size):
            part = None
            try:
                part = next(made) if error is None else None
            except Exception as reason:
                error = reason
            self.comm.send((part, _sendable(error)), number)
        if error is not None:
            raise error

    def built(self, build: Callable[[Part | None], Problem]) -> Problem:
        """The problem of another process than the first one, of the part that this one sends, or the whole."""
        part, error = None, None
        if self.comm.bcast(None):
            self.first(lambda: None)  # who owns what
            part, error = self.comm.recv(source=0)

        def made() -> Problem:
            if error is not None:
                raise error
            return build(part)

        return self.alike(made)

    def cut(self, problem: Problem, state: Any = None) -> Any:
        """The piece that this process steps of a state (``ct_state *``), which the first process has."""
        owners = self._owners if problem.part is None else problem.part.owners
        if owners is None:
            owners = self.first(lambda: owners_of(problem, self.size, self.partition))
        new, _kept = self.alike(lambda: _definition(problem, owners, self.rank, self.size))
        new.join.sum, new.join.largest, new.exchange = self._sum, self._largest, self._exchange
        given = (
            (lib.ct_state_receive, problem.pointer) if state is None else (lib.ct_state_cut, state)
        )
        made = self.alike(lambda: ask("ct_state **", *given, new))
        return ffi.gc(made, lambda piece, free=lib.ct_state_free, problem=problem: free(piece))

    def first(self, function: Callable[[], T], tell: bool = True) -> T:
        """What a function returns on the first process, on all of them, or unless they are to be told on that one;
        what it raises there is raised on all."""
        both: Any = (None, None)
        if self.rank == 0:
            try:
                both = function(), None
            except Exception as reason:
                both = None, reason
        result, error = self.comm.bcast((both[0] if tell else None, _sendable(both[1])))
        if error is not None:
            self._common = error
            raise error
        return cast(T, result if tell else both[0])

    def alike(self, function: Callable[[], T], stop: Sized = ()) -> T:
        """What a function returns that all processes call; if it raises on one, the same is raised on all: the
        error of the process that names a reason. ``stop`` is empty until this process is asked to end the run."""
        result, error = None, None
        try:
            result = function()
        except Exception as reason:
            error = reason
        both = self.comm.allgather((_sendable(error), len(stop)))
        self.interrupted = any(count for _, count in both)
        told = [each for each, _ in both if each is not None]
        if told:
            self._common = min(told, key=lambda each: "in another piece" in str(each))
            raise self._common
        return cast(T, result)

    def is_common(self, error: BaseException) -> bool:
        """Whether all processes raise an error: one that follows from the scene or from the whole state."""
        return error is self._common or isinstance(error, (Error, SceneWarning))

    def lead(self, function: Callable[[], Run]) -> Run:
        """A run of the first process, and its end for the others."""
        try:
            run = function()
        except Exception as error:
            if self.is_common(error):
                self.tell("end", (None, _sendable(_without_states(error))))
            raise
        self.tell("end", (_light(run), None))
        return run

    def ended(self, run: Run, error: BaseException | None) -> Run:
        """The Run of the other processes; or they raise the error of the first one."""
        if error is not None:
            self._common = error
            raise error
        return run

    @contextlib.contextmanager
    def together(self) -> Iterator[None]:
        """A run of all processes, of which the first one warns. An error that is not common to all ends all of
        them with its message."""
        try:
            with warnings.catch_warnings():
                if self.rank > 0:
                    warnings.simplefilter("ignore")
                yield
        except BaseException as error:
            if not self.is_common(error):
                print(f"process {self.rank} of {self.size} ends the run:", file=sys.__stderr__)
                traceback.print_exception(error, file=sys.__stderr__)
                self.comm.Abort(1)
            raise

    def counts(self, piece: Any) -> Rows:
        """What each process computes and exchanges (``ct_piece_counts``), a row per process."""
        return np.concatenate(self.comm.allgather(_counts(piece)))


def _numbers(pointer: Any, count: int) -> Ints:
    """An array of C (int32) for MPI."""
    return np.frombuffer(ffi.buffer(pointer, 4 * count), np.int32)
