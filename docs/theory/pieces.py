"""What pieces compute and exchange: counts of a cube, the same in closed form, and a model of larger ones."""

from math import prod
from pathlib import Path

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


def block(edges, parts):
    """Elements that a block computes, and nodes that it receives, if so many blocks lie along each edge."""
    elements = [a + (k > 1) for a, k in zip(edges, parts)]
    own = [a + (k < 3) for a, k in zip(edges, parts)]
    return prod(elements), prod(e + 1 for e in elements) - prod(own)


print(f"a cube of {EDGE}^3   elements of a piece   received nodes   in closed form")
for parts in ((1, 1, 1), (2, 1, 1), (2, 2, 1), (2, 2, 2), (4, 4, 4)):
    count = prod(parts)
    rows = planned(problem, new_state(problem), count, "coordinates")
    told = block([EDGE // k for k in parts], parts)
    print(
        f"{count:6} pieces {rows['elements'].max():18} {rows['received'].max():16} {told[0]:12} {told[1]:6}"
    )

ELEMENTS, CORES, SPEED, BANDWIDTH, SUM, SUMS = 1e9, 64, 20e6, 1e10, 1e-5, 74
# Two surfaces of 10^6 faces: at each node the force so far, its contact force in two parts, a count of rows.
SURFACE = 2e6 * 8 * (3 + 6 + 1) / BANDWIDTH
# Bytes of the problem for a node and an element: ten numbers and the coordinates of the mesh; nodes of elements.
PROBLEM = 8 * (10 + 3) + 4 * 8
# Measured bytes of another process for an element of its share, and for a face of the surfaces.
LINES = Path(__file__).with_name("pieces_memory.out").read_text().splitlines()
ELEMENT, FACE = map(float, LINES[-1].split()[-2:])
whole = memory_estimate(int(ELEMENTS), int(ELEMENTS), 8) / 1e9
print(
    "\n10^9 elements     compute  messages     sums   surface  efficiency   GB of the first, of another machine"
)
for machines in (10, 100, 1000):
    edge = (ELEMENTS / machines) ** (1 / 3)
    elements, received = block([edge] * 3, (3, 3, 3))
    compute = elements / (CORES * SPEED)
    messages, sums = 24 * received / BANDWIDTH, SUMS * SUM
    efficiency = ELEMENTS / machines / (CORES * SPEED) / (compute + messages + sums + SURFACE)
    first = whole + (whole - PROBLEM) / machines
    other = ELEMENT * ELEMENTS / machines / 1e9 + FACE * 2e6 / 1e9
    print(
        f"{machines:5} machines {1e3 * compute:8.2f} ms {1e3 * messages:6.2f} ms {1e3 * sums:5.2f} ms"
        f" {1e3 * SURFACE:6.2f} ms {efficiency:9.0%} {first:10.0f} {other:8.1f}"
    )
