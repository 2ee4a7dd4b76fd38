"""Answers of the exercises of the chapter on a contact force that adds no energy."""

from fractions import Fraction

import numpy as np
from answers_energy import energies


def test_controlled_step(says):
    def stored(gap):
        return min(gap, 0) ** 2 / 2

    old, now, new = -0.2, -0.1, 0.05
    force = max(0.0, -(new + old) / 2)
    work = force * (new - old) / 2
    fall = (stored(old) + stored(now)) / 2 - (stored(now) + stored(new)) / 2
    says(f"{force:.3f}", f"{work:.6f}", f"{fall:.2f}", f"{fall - work:.6f}")


def test_controlled_mass(says):
    gaps, forces = [Fraction(2, 5), Fraction(1, 10)], []
    while not forces or gaps[-1] < 0:
        free, before = 2 * gaps[-1] - gaps[-2], min(gaps[-2], 0)
        forces.append(max(Fraction(0), -(free + before) / 3))
        gaps.append(free + forces[-1])
        assert forces[-1] == max(0, -(gaps[-1] + before) / 2)
    says(*(f"{float(gap):.4f}" for gap in gaps[2:]), *(f"{float(force):.4f}" for force in forces))
    speed = float(gaps[-1] - gaps[-2]) / 0.3
    says(f"{speed:.3f}", f"{speed**2:.3f}")


def test_controlled_growth(says):
    beta, n = 10, 50
    limit = np.sqrt(2 / (1 + np.sqrt(1 + 4 * beta**2)))
    grown = [
        energies(n, fraction * limit, beta * n, controlled=False, end=6)[-1] - 1
        for fraction in (0.3, 0.5, 0.7, 0.9)
    ]
    says(*(f"{value:.1%}".replace("%", " %") for value in grown[:3]))
    says(f"{grown[3]:.0%}".replace("%", " %"))


def test_controlled_present(says, run):
    names, told = run()
    assert "0.1 / ω: the mass keeps 0.923" in told

    def lost(step):
        return 1 - np.mean([names["rebound"](step, 1 + step * p) for p in np.linspace(0, 1, 100)])

    orders = [np.log2(lost(0.1) / lost(0.05))]
    names, told = run(mend=True)
    orders.append(np.log2(lost(0.1) / lost(0.05)))
    assert abs(orders[0] - 1) < 0.1 and abs(orders[1] - 2) < 0.1
    assert "keeps 0.99" in told.splitlines()[1]
    says("first")
