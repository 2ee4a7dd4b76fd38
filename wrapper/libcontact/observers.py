"""What a run checks after some of its steps."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any

from .bridge import index
from .errors import SceneWarning
from .problem import Problem


class Observer:
    """
    What a run checks after some of its steps. The run itself calls the observers of the C library,
    monitor and probes, within ``ct_run``.

    Parameters
    ----------
    problem : Problem
        The problem of the run.
    every : int
        Steps between two checks; 0: no own steps.
    """

    #: Whether it also checks each state that is recorded.
    at_records = False

    def __init__(self, problem: Problem, every: int = 0):
        self._problem, self.every = problem, every

    def divide(self, problem: Problem, parts: int) -> None:
        """Continue with a problem whose step is divided by ``parts``."""
        self._problem, self.every = problem, parts * self.every

    def next(self, step: int) -> float:
        """The next step that it checks."""
        return (step // self.every + 1) * self.every if self.every else math.inf

    def is_due(self, step: int, recorded: bool) -> bool:
        """Whether it checks this step."""
        return (recorded and self.at_records) or (self.every > 0 and step % self.every == 0)

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        """Check a state (``ct_state *``), and yield a warning for each thing that is found."""
        raise NotImplementedError


def spread(problem: Problem, times: int, least: int) -> int:
    """Steps between two checks: ``times`` checks in a run, but not more often than every ``least``
    steps."""
    return max(least, problem.step_count // times)


class Own(Observer):
    """A function of the user, which is called with each ``State`` that it checks."""

    def __init__(
        self, problem: Problem, every: int, function: Callable[[Any], object], state_of: Any
    ):
        super().__init__(problem, every)
        self._function, self._state_of, self._time = function, state_of, -math.inf

    def warnings(self, state: Any) -> Iterator[SceneWarning]:
        if state.time != self._time:
            self._time = state.time
            self._function(self._state_of(state))
        return iter(())


def own(
    problem: Problem, given: Iterable[Any], state_of: Callable[[Any], Any]
) -> Iterator[Observer]:
    """The observers that a user gives to a run: pairs of a function and the steps between two of its calls.
    ``state_of`` returns the State of a ``ct_state *``."""
    for i, pair in enumerate(given):
        if not isinstance(pair, tuple) or len(pair) != 2 or not callable(pair[0]):
            raise TypeError(f"observers[{i}] must be a pair of a function and a number of steps")
        function, every = pair[0], index(f"observers[{i}][1]", pair[1])
        if every < 1:
            raise ValueError(f"observers[{i}][1] must be 1 or more, not {every}")
        yield Own(problem, every, function, state_of)
