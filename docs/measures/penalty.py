"""The explicit penalty: a bar on a wall, a lone mass and a block at the border of a plate."""

from __future__ import annotations

import warnings
from typing import Any

import dissipation
import numpy as np

from .shared import Numbers, measurement, scene_of

# -- Integrators and the explicit penalty ----------------------------------------------------------


def explicit_bar(
    beta: float, fraction: float = 0.9, landings: int = 5, **step: Any
) -> list[Numbers]:
    """
    The bar on a wall with the explicit penalty, for landings that divide the step into equal parts: largest and last
    energy over the first, root mean square error of the pressure amid the contact (from the energy of the spring), and
    largest pressure, both over the exact one.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "chatter:")
        dt = dissipation.thrown("penalty", beta, fraction=fraction, end=0.1, **step).dt
        runs = [
            dissipation.thrown(
                "penalty",
                beta,
                part / landings * dt / (0.9 * dissipation.H / dissipation.C),
                fraction=fraction,
                **step,
            )
            for part in range(landings)
        ]
    found = []
    for part, run in enumerate(runs):
        total = run.energy["total"] / run.energy["total"][0]
        stiffness = beta * dissipation.YOUNG / dissipation.H
        pressure = (
            np.sqrt(2 * stiffness * np.maximum(run.energy["obstacle"], 0))
            / dissipation.H
            / dissipation.PRESSURE
        )
        time = run.time - part / landings * dt
        held = (time > 0.55) & (time < 1.12)
        found.append(
            {
                "most": total.max(),
                "last": total[-1],
                "rms": np.sqrt(np.mean((pressure[held] - 1) ** 2)),
                "peak": pressure.max(),
            }
        )
    return found


def most(found: list[Numbers], name: str) -> float:
    return max(one[name] for one in found)


INTEGRATORS = {
    "leapfrog": {},
    "chung_lee": {"integrator": "chung_lee"},
    "noh_bathe": {"integrator": "noh_bathe"},
    "tchamwa_wielgosz": {"integrator": "tchamwa_wielgosz"},
}


@measurement
def integrator() -> Numbers:
    """The bar on a wall at 0.9 of the reported step: β = 1, error of the force and loss, worst of 5 landings; β = 10,
    growth of the energy over 20 landings."""
    found = {}
    for name, step in INTEGRATORS.items():
        soft, stiff = (
            explicit_bar(1.0, **step),
            [one["most"] for one in explicit_bar(10.0, landings=20, **step)],
        )
        found |= {
            f"{name}_rms": most(soft, "rms"),
            f"{name}_loss": 1 - min(one["last"] for one in soft),
            f"{name}_growth": max(stiff) - 1,
        }
        if name == "leapfrog":
            found |= {"leapfrog_least": min(stiff), "leapfrog_most": max(stiff)}
    return found


@measurement
def explicit() -> Numbers:
    """The bar on a wall with the leapfrog, worst of 5 landings: change of the energy at 0.9 and 0.5 of the reported
    step; largest pressure at 0.1."""
    found = {
        f"peak_{name}": most(explicit_bar(beta, 0.1, landings=1), "peak")
        for name, beta in (("05", 0.5), ("1", 1.0), ("5", 5.0), ("10", 10.0))
    }
    for name, betas in (("soft", (0.5, 1.0)), ("five", (5.0,)), ("ten", (10.0,))):
        found[f"{name}_limit"] = max(most(explicit_bar(beta, 0.9), "last") for beta in betas) - 1
        if name != "soft":
            found[f"{name}_half"] = most(explicit_bar(betas[0], 0.5), "last") - 1
    return found


# -- One point and the explicit penalty ------------------------------------------------------------


def blow(fraction: float, landing: float) -> tuple[float, float, float]:
    """
    A mass m = Δt = 1 meets a spring k = 4 f² with the speed 1, at the gap ``landing`` one step before it is inside. Its
    kinetic energy after the blow, what the ledger loses on entry and what it gains on exit.
    """
    k, before, g, v = 4 * fraction**2, landing, landing - 1, -1.0
    entry = 0.5 * k * -g * before
    while g <= 0:
        v += -k * g
        before, g = g, g + v
    return 0.5 * v * v, entry, 0.5 * k * -before * g


@measurement
def rest() -> Numbers:
    """A cube of 4 x 4 x 4 unit elements falls by 0.02 on a floor and stays there: energy of the fall that is left after
    300 time units."""
    found, weight = {}, 64 * 1e-4
    for name, law in (("inelastic", {"restitution": 0.0}), ("elastic", {})):
        scene = scene_of(poisson=0.3)
        box = {"origin": [0, 0, 0.02], "size": [4, 4, 4], "cells": [4, 4, 4]}
        scene.add_body("cube", material="elastic", box=box)
        scene.add("gravity", acceleration=[0, 0, -1e-4])
        floor = {"point": [0, 0, 0], "normal": [0, 0, 1]}
        scene.add("obstacle", surface="cube.z_min", plane=floor, **law)
        run = scene.set_time(end=300.0, fraction=0.9).run(progress=False, output=False)
        total = run.energy["total"]
        found[f"{name}_kept"] = 1 + (total[-1] - total[0]) / (0.02 * weight)
    return found


@measurement
def one_blow() -> Numbers:
    """Means over 4000 landings of a lone mass at 0.3 and 0.9 of its stable step, over its kinetic energy: loss on entry
    and gain on exit."""
    landings = (np.arange(4000) + 0.5) / 4000
    found = {}
    for name, fraction in (("3", 0.3), ("9", 0.9)):
        after, entry, leave = np.array([blow(fraction, landing) for landing in landings]).T
        assert np.allclose(after - 0.5, leave - entry, atol=1e-12)
        found |= {f"entry_{name}": 2 * entry.mean(), f"exit_{name}": 2 * leave.mean()}
    return found


# -- Open border -----------------------------------------------------------------------------------


def growth_of_thrown(part: str, enforcement: str, fraction: float) -> float:
    """Growth of the energy, over the kinetic energy at the start, when a block that hangs down beside a plate by h/5 is
    thrown onto it at a fifth of the speed of sound."""
    plate = {"origin": [0, 0, -2], "size": [8, 2, 2], "cells": [8, 2, 2]}
    block = {"origin": [-4, 0, -0.2], "size": [4, 2, 2], "cells": [4, 2, 2]}
    surfaces = ["plate.outer", "block.outer"] if part == "outer" else ["plate.z_max", "block.z_min"]
    run = (
        scene_of()
        .add_body("plate", material="elastic", box=plate)
        .add_body("block", material="elastic", box=block, velocity=[0.2, 0, 0])
        .add_support("plate.z_min", fix="xyz")
        .add_contact(*surfaces, beta=4.0, enforcement=enforcement)
        .set_time(end=15.0, fraction=fraction)
        .set_output(every=1)
        .run(progress=False, output=False)
    )
    return (run.energy["total"].max() - run.energy["total"][0]) / run.energy["kinetic"][0]


@measurement
def border() -> Numbers:
    """Growth with closed surfaces for the penalty, at 0.9 and 0.1 of the stable step. The default law adds nothing
    there, and no law does at open surfaces."""
    for part, enforcement in (
        ("outer", "energy_controlled"),
        ("top", "energy_controlled"),
        ("top", "penalty"),
    ):
        assert growth_of_thrown(part, enforcement, 0.9) < 1e-12
    return {
        "closed": growth_of_thrown("outer", "penalty", 0.9),
        "closed_short": growth_of_thrown("outer", "penalty", 0.1),
    }
