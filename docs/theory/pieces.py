"""What pieces compute and exchange: counts of a cube, a bound in closed form, and a model of larger ones."""

from libcontact.pieces import planned
from libcontact.problem import memory_estimate, new_state

import libcontact as ct

EDGE = 24
cube = ct.Scene(
    {
        "title": "a cube",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [{"name": "steel", "young": 2.1e11, "poisson": 0.3, "density": 7800.0}],
        "body": [
            {
                "name": "cube",
                "material": "steel",
                "box": {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [EDGE] * 3},
            }
        ],
        "time": {"end": 1e-3},
    }
)
problem = cube._built(None)

print(f"a cube of {EDGE}^3   elements of a piece   received nodes   bounds")
for count in (1, 8, 64):
    rows = planned(problem, new_state(problem), count, "coordinates")
    edge = EDGE / count ** (1 / 3)
    bounds = (edge + 2) ** 3, 6 * edge**2 + 12 * edge + 8
    most = rows["elements"].max(), rows["received"].max()
    print(f"{count:6} pieces {most[0]:18} {most[1]:16} {bounds[0]:12.0f} {bounds[1]:6.0f}")

ELEMENTS, CORES, SPEED, BANDWIDTH, SUM, SUMS = 1e9, 64, 20e6, 1e10, 1e-5, 100
print("\n10^9 elements     compute  messages     sums  efficiency   GB a machine, now and in parts")
for machines in (10, 100, 1000):
    edge = (ELEMENTS / machines) ** (1 / 3)
    compute = (edge + 2) ** 3 / (CORES * SPEED)
    messages, sums = 24 * (6 * edge**2) / BANDWIDTH, SUMS * SUM
    efficiency = ELEMENTS / machines / (CORES * SPEED) / (compute + messages + sums)
    memory = [memory_estimate(n, n, 8) / 1e9 for n in (int(ELEMENTS), int(edge**3))]
    print(
        f"{machines:5} machines {1e3 * compute:8.2f} ms {1e3 * messages:6.2f} ms {1e3 * sums:5.2f} ms"
        f" {efficiency:9.0%} {memory[0]:10.0f} {memory[1]:8.1f}"
    )
