"""Answers of the exercises of the chapter on the planner."""

import numpy as np
from scipy.optimize import fsolve


def test_planner_three(says):
    """The three equations, solved without the closed form."""
    limit, factor, q = fsolve(
        lambda v: [v[0] + v[1] * h ** v[2] - f for h, f in ((4, 120), (2, 108), (1, 103))],
        [100, 3, 1],
    )
    error = (103 - limit) / limit
    finer = (error / 0.01) ** (1 / q)
    says(f"{q:.2f}", f"{limit:.2f}", f"{100 * error:.1f} %", f"{finer:.2f}", f"{finer**4:.0f}")


def test_planner_sure(says):
    F = np.array([100.0, 104.0])
    mean = F.mean()
    says(f"{mean:.0f}", f"{np.sqrt((1 + (F - mean) ** 2).mean()):.2f}", f"{np.sqrt(0.5):.2f}")
