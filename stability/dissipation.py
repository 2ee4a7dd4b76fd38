"""
What the share ``dissipation`` of the energy-controlled penalty does to the bar on a wall (chapter "Enforcement"): errors of force, impulse, release and energy,
the worst of five ways to meet the wall between two steps.
"""

from __future__ import annotations

import numpy as np

import libcontact as ct

CASES = [("energy_controlled", s, beta) for s in (0.0, 0.1, 0.5, 1.0) for beta in (4.0, 100.0, 1e4)] + [("lagrange", None, 4.0), ("penalty", None, 1.0)]
YOUNG, LENGTH, SPEED, ELEMENTS = 900.0, 10.0, 10.0, 100
C, PRESSURE, DURATION = 30.0, 300.0, 2 * 10.0 / 30.0


def bar(enforcement: str, dissipation: float | None, beta: float, shift: float, fraction: float = 0.9) -> tuple[float, float, float, float]:
    """Root mean square error of the force over 0.1 ... 0.6 after the impact, error of the impulse, steps of the release after its time, energy lost."""
    scene = ct.Scene(title="bar", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("bar", young=YOUNG, poisson=0.0, density=1.0)
    h = LENGTH / ELEMENTS
    dt = fraction * h / C
    gap = 5.0 + shift * dt * SPEED
    scene.add_body("bar", material="bar", velocity=[-SPEED, 0, 0], box={"origin": [gap, 0, 0], "size": [LENGTH, h, h], "cells": [ELEMENTS, 1, 1]})
    share = {} if dissipation is None else {"dissipation": dissipation}
    scene.add("obstacle", surface="bar.x_min", plane={"point": [0, 0, 0], "normal": [1, 0, 0]}, beta=beta, enforcement=enforcement, **share)
    scene.set_time(end=1.4, dt=dt if enforcement != "penalty" else None, fraction=None if enforcement != "penalty" else fraction)
    run = scene.set_output(every=1, fields=[]).run(progress=False)
    time, p, area = run.time, run.momentum["p"][:, 0], h * h
    step = time[1] - time[0]
    # The table's momentum is the mean of the two half steps around t_n; from one to the next the force of t_n acts.
    half = np.empty(len(p) + 1)
    half[0] = p[0]
    for n, mean in enumerate(p):
        half[n + 1] = 2 * mean - half[n]
    force = np.diff(half) / step / area
    begin = gap / SPEED
    held = (time >= begin + 0.1) & (time <= begin + 0.6)
    pushed = time[np.abs(force) > 1e-9 * PRESSURE]
    return (float(np.sqrt(np.mean((force[held] / PRESSURE - 1) ** 2))), abs((p[-1] - p[0]) / area / (PRESSURE * DURATION) - 1),
            abs(pushed[-1] - begin - DURATION) / step, 1 - run.energy["total"][-1] / run.energy["total"][0])


def main() -> None:
    print("enforcement          share     beta   force rms   impulse   release   energy lost")
    for enforcement, dissipation, beta in CASES:
        force, impulse, release, lost = np.max([bar(enforcement, dissipation, beta, shift) for shift in (0, 0.2, 0.4, 0.6, 0.8)], axis=0)
        share = "     " if dissipation is None else f"{dissipation:5.1f}"
        print(f"{enforcement:<20} {share} {beta:8g}  {100 * force:8.3f} %  {100 * impulse:6.2f} %  {release:8.1f}  {100 * lost:10.2f} %")


if __name__ == "__main__":
    main()
