"""The first programs of the book."""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from .shared import DOCS, Numbers, measurement


@measurement
def first_run() -> Numbers:
    """The program of the page: the plateau behind the plane wave, its closed form -ρ c₁ v₀, and the lowest stress on
    the line [MPa]."""
    program: dict[str, Any] = {}
    exec(
        compile(
            (DOCS / "start" / "first_run.py")
            .read_text()
            .replace("progress=True", "progress=False, output=False"),
            "first_run.py",
            "exec",
        ),
        {"print": lambda *_: None},
        program,
    )
    E, nu, rho = 2.1e5, 0.3, 7.8e-9
    c1 = np.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu) * rho))
    return {
        "plateau": program["plateau"],
        "exact": -rho * c1 * 1000.0,
        "lowest": program["stress"].min(),
    }


@measurement
def ball() -> Numbers:
    """From what ball.py printed (a test runs it anew): how far the pressures of its meshes lie apart, and above
    Hertz's."""
    text = (DOCS / "start" / "ball.out").read_text()
    found = re.findall(r"^(\d+) cells, (beta = 2|default penalty): ([\d.]+) MPa", text, re.M)
    soft, default = (
        [float(value) for _, law, value in found if law == name]
        for name in ("beta = 2", "default penalty")
    )
    hertz = float(re.search(r"Hertz: ([\d.]+)", text)[1])  # type: ignore[index]
    return {
        "soft": soft[-1] / soft[0] - 1,
        "spread": max(default) / min(default) - 1,
        "above": default[-1] / hertz - 1,
    }


@measurement
def wall() -> Numbers:
    """The largest speed of the mass after the impact on a plain penalty, with steps of 1.5/ω, from 200 starts."""
    program: dict[str, Any] = {}
    exec(compile((DOCS / "week" / "wall.py").read_text(), "wall.py", "exec"), program)
    return {"fastest": program["rebound"](1.5).max()}
