"""Answers of the exercises of the chapter on the initial state."""

import numpy as np


def test_initial_release(says):
    """A row of masses, run at its longest step, where it is exact."""
    n, s = 200, 1e-3
    c = np.sqrt(210e9 / 7800)
    u = s * (np.arange(n + 1) / n - 0.5)
    mass = np.r_[0.5, np.ones(n - 1), 0.5]
    v, states = np.zeros(n + 1), []
    for step in range(n):
        force = np.diff(np.diff(u), prepend=0, append=0)
        v += force / mass * (1 if step else 0.5)
        if step == 1:
            speed = -v[-1] * n * c
        u += v
        states.append(np.diff(u) * n * 210e9)
    says(f"{speed:.2f}", f"{1e6 / (2 * c):.1f}")
    assert np.abs(states[n // 2 - 1]).max() < 1 and np.allclose(states[n - 1], -210e6)


def test_initial_strain_of(says):
    compliance = (np.eye(3) * 1.3 - 0.3) / 210e3
    one, all_three = compliance @ [100, 0, 0], compliance @ [-100, -100, -100]
    says(*(f"{e * 1e4:.2f}·10⁻⁴" for e in (one[0], one[1], all_three[0])))
