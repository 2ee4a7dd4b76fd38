"""The cost of the monitor of a run: time of steps with a check after every 1024 of them divided by that
of the same steps without checks, the least of several alternating runs."""

from __future__ import annotations

import time

from libcontact._core import ffi, lib
from libcontact.errors import check, new_error
from libcontact.problem import new_state

import libcontact as ct

STEPS, ROUNDS = 2048, 3


def scene(law: str, element: str) -> ct.Scene:
    """Two blocks that collide."""
    out = ct.Scene(title="blocks", units={"length": "m", "mass": "kg", "time": "s"})
    out.add_material("soft", young=2.0, poisson=0.3, density=1.0, law=law)
    cells = [16, 16, 16] if element == "hex8" else [8, 8, 8]
    for name, x, v in (("left", -1.0, 0.05), ("right", 0.01, -0.05)):
        out.add_body(
            name,
            material="soft",
            box={"origin": [x, 0, 0], "size": [1, 1, 1], "cells": cells},
            element=element,
            velocity=[v, 0, 0],
        )
    return out.add_contact("left.x_max", "right.x_min", beta=1).set_time(end=20.0, fraction=0.5)


def seconds(problem, every: int | None) -> float:
    state, error = new_state(problem), new_error()
    if every is not None:
        options, out = (
            ffi.new("ct_monitor_options *", lib.ct_monitor_options_default()),
            ffi.new("ct_monitor **"),
        )
        options.every = every
        check(lib.ct_monitor_create(problem.pointer, state, options, out, error), error)
    observers = [] if every is None else [lib.ct_monitor_observer(out[0])]
    given = ffi.new("ct_observer[]", observers), len(observers)
    begin = time.perf_counter()
    check(lib.ct_run(problem.pointer, state, STEPS, *given, error), error)
    took = time.perf_counter() - begin
    if every is not None:
        lib.ct_monitor_free(out[0])
    return took


def measure() -> dict:
    result = {}
    for law, element in (("linear", "hex8"), ("neo_hookean", "hex8"), ("neo_hookean", "hex20")):
        problem = scene(law, element)._built(None)
        pairs = [(seconds(problem, None), seconds(problem, 1024)) for _ in range(ROUNDS)]
        plain, watched = (min(times) for times in zip(*pairs))
        result[f"{law} {element}"] = watched / plain - 1.0
    return result


def report(result: dict) -> str:
    return "\n".join(
        [
            "Cost of the monitor, relative to the time of the steps:",
            *(f"  {name}: {share:+.2%}" for name, share in result.items()),
        ]
    )


if __name__ == "__main__":
    print(report(measure()))
