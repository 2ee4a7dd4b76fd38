"""
Is the reported step safe, and how sharp is it? For each mesh the true limit comes from a power iteration with the forces of the library itself, and each integrator
runs below the reported step and above the true one (chapter "Integrator").
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import libcontact as ct
from libcontact._core import ffi, lib
from libcontact.errors import check, new_error
from libcontact.parts import INTEGRATORS
from libcontact.problem import new_state

UNITS = {"length": "m", "mass": "kg", "time": "s"}
REGULAR = ("regular", "flat", "nearly incompressible")
BELOW, ABOVE, BLOWN = 0.999, 1.02, 1e3


@dataclass
class Row:
    """One mesh with one integrator: the reported Ω over the limit, the true step, and the growth of the velocity below and above."""

    element: str
    mesh: str
    integrator: str
    reported: float
    true: float
    below: float
    above: float

    @property
    def sharpness(self) -> float:
        return self.reported / self.true

    @property
    def good(self) -> bool:
        return self.sharpness <= 1.0 + 1e-6 and self.below < BLOWN < self.above and (self.mesh not in REGULAR or self.sharpness >= 0.9)


def body(element: str, mesh: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Nodes, elements and Poisson's ratio of a small block."""
    cells, size, poisson = (4, 4, 4), [1.0, 1.0, 1.0], 0.3
    if mesh == "flat":
        size = [1.0, 1.0, 0.2]
    if mesh == "nearly incompressible":
        poisson = 0.49
    made = ct.Mesh.box([0, 0, 0], size, cells, element=element)
    nodes = np.array(made.nodes)
    random, h = np.random.default_rng(7), 0.25
    if mesh == "graded":
        nodes[:, 0] = (np.exp(1.5 * nodes[:, 0]) - 1.0) / (np.exp(1.5) - 1.0)
    if mesh.startswith("distorted"):
        # Corners move at random, mid-sides stay in the middle of their corners.
        amount = 0.1 if mesh == "distorted 0.1" else 0.2
        elements = np.asarray(made.elements)
        corners = np.unique(elements[:, :8])
        shift = np.zeros_like(nodes)
        inside = corners[np.all((nodes[corners] > 1e-9) & (nodes[corners] < 1 - 1e-9), axis=1)]
        shift[inside] = random.uniform(-amount * h, amount * h, (len(inside), 3))
        if element == "hex20":
            pairs = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
            for k, (a, b) in enumerate(pairs):
                shift[elements[:, 8 + k]] = 0.5 * (shift[elements[:, a]] + shift[elements[:, b]])
        nodes += shift
    return nodes, np.asarray(made.elements), poisson


def scene(element: str, mesh: str, integrator: str, fraction: float = 0.5) -> ct.Scene:
    nodes, elements, poisson = body(element, mesh)
    made = ct.Scene(title="block", units=UNITS)
    made.add_material("soft", young=1e6, poisson=poisson, density=1.0)
    made.add_body("block", nodes=nodes, elements=elements, element=element, material="soft")
    return made.set_time(end=1.0, fraction=fraction, integrator=integrator).set_output(fields=[])


def array(pointer, count: int) -> np.ndarray:
    return np.frombuffer(ffi.buffer(pointer, 8 * count), np.float64)
