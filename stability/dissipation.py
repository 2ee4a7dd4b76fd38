"""
Influence of the damping ratio ``dissipation`` of the energy-controlled penalty on the bar on a wall
(chapter "Enforcement"): errors of force, impulse, release and energy, the largest for five positions of
the impact between two steps. Restitution is 0, so that nothing hides what the dashpot does.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np

import libcontact as ct

CASES = [
    ("energy_controlled", s, beta) for s in (0.0, 0.15, 0.5, 1.0) for beta in (4.0, 100.0, 1e4)
] + [("penalty", None, 1.0)]
LANDINGS = (0, 0.2, 0.4, 0.6, 0.8)
YOUNG, LENGTH, SPEED, ELEMENTS = 900.0, 10.0, 10.0, 100
H, C, PRESSURE, DURATION = LENGTH / ELEMENTS, 30.0, 300.0, 2 * 10.0 / 30.0


def thrown(
    enforcement: str,
    beta: float,
    landing: float = 0.0,
    dissipation: float | None = None,
    end: float = 1.4,
    **step: Any,
) -> ct.Run:
    """
    The bar of Doyen, Ern and Piperno thrown at a rigid wall, with every step recorded.

    ``landing`` is the position of the impact between two steps; ``step`` are entries of [time]. The energy
    limit is raised, because some of these runs are expected to exceed it.
    """
    data = ct.Scene.load(ct.example("bar_on_a_wall")).data
    data["body"][0]["box"]["origin"][0] += landing * 0.9 * H / C * SPEED
    data["obstacle"][0] |= {"enforcement": enforcement, "beta": beta}
    data["obstacle"][0] |= {} if dissipation is None else {"dissipation": dissipation}
    data["obstacle"][0] |= {} if enforcement == "penalty" else {"restitution": 0.0}
    data["time"] = {"end": end, "energy_limit": 100, **step}
    scene = ct.Scene(data | {"output": {"every": 1, "fields": []}})
    return scene.add_probe("wall", resultant="obstacle").run(progress=False)


def bar(
    enforcement: str, dissipation: float | None, beta: float, landing: float, fraction: float = 0.9
) -> tuple[float, float, float, float]:
    """Root mean square error of the force over 0.1 ... 0.6 after the impact, error of the impulse, delay of
    the release in steps, energy lost."""
    step = {"fraction": fraction} if enforcement == "penalty" else {"dt": fraction * H / C}
    run = thrown(enforcement, beta, landing, dissipation, **step)
    time, p, force = run.time, run.momentum["p"][:, 0], run.probes["wall"]["force"][:, 0] / H**2
    begin = 0.5 + landing * 0.9 * H / C
    held = (time >= begin + 0.1) & (time <= begin + 0.6)
    pushed = time[np.abs(force) > 1e-9 * PRESSURE]
    return (
        float(np.sqrt(np.mean((force[held] / PRESSURE - 1) ** 2))),
        abs((p[-1] - p[0]) / H**2 / (PRESSURE * DURATION) - 1),
        abs(pushed[-1] - begin - DURATION) / (time[1] - time[0]),
        1 - run.energy["total"][-1] / run.energy["total"][0],
    )


def worst(enforcement: str, dissipation: float | None, beta: float) -> np.ndarray:
    """The four errors, each the largest of five landings."""
    return np.max([bar(enforcement, dissipation, beta, landing) for landing in LANDINGS], axis=0)


def main() -> None:
    argparse.ArgumentParser(description=__doc__).parse_args()
    print("enforcement          ratio     beta   force rms   impulse   release   energy lost")
    for enforcement, dissipation, beta in CASES:
        force, impulse, release, lost = worst(enforcement, dissipation, beta)
        share = "     " if dissipation is None else f"{dissipation:5.2f}"
        print(
            f"{enforcement:<20} {share} {beta:8g}  {100 * force:8.3f} %  {100 * impulse:6.2f} %  {release:8.1f}  {100 * lost:10.2f} %"
        )


if __name__ == "__main__":
    main()
