"""Answers of the exercises of the chapter on boundaries that absorb."""

import numpy as np


def test_absorb_mismatch(says):
    R = np.linalg.solve([[1.0]], [(1 - 0.9) / (1 + 0.9)])[0]
    says(f"{R:.4f}", f"{100 * R * R:.2f}")


def reflected(theta, c2):
    """Energy of both waves, by the stresses of plane waves at x = 0 (ρ = c₁ = ω = 1)."""
    mu, lam = c2**2, 1 - 2 * c2**2

    def wave(direction, motion, slowness):
        k = slowness * np.array(direction)
        G = 1j * np.outer(motion, k)
        s = lam * np.trace(G) * np.eye(2) + mu * (G + G.T)
        v = -1j * np.array(motion)
        return s[:, 0] + v * [1, c2]  # traction plus dashpots

    cos, sin = np.cos(theta), np.sin(theta)
    st = c2 * sin
    ct = np.sqrt(1 - st**2)
    come = wave((cos, sin), (cos, sin), 1)
    back = wave((-cos, sin), (-cos, sin), 1)
    shear = wave((-ct, st), (st, ct), 1 / c2)
    P, S = np.linalg.solve(np.column_stack([back, shear]), -come)
    return abs(P) ** 2, abs(S) ** 2 * c2 * ct / cos


def test_absorb_angle(says):
    c2, parts = 1 / np.sqrt(3), []
    for degrees in (0, 30, 60, 80):
        t = np.radians(degrees)
        ts = np.arcsin(c2 * np.sin(t))
        a, b = 1 - 2 * c2**2 * np.sin(t) ** 2, c2**2 * np.sin(2 * t)
        P, S = np.linalg.solve(  # eq:absorb-oblique
            [
                [a + np.cos(t), -c2 * np.sin(2 * ts) - np.sin(ts)],
                [-b - c2 * np.sin(t), -c2 * np.cos(2 * ts) - c2 * np.cos(ts)],
            ],
            [np.cos(t) - a, c2 * np.sin(t) - b],
        )
        parts.append((P**2, S**2 * c2 * np.cos(ts) / np.cos(t)))
        assert np.allclose(parts[-1], reflected(t, c2))
    says("0 %", *(f"{100 * sum(p):.{d}f} %" for p, d in zip(parts[1:], (2, 1, 0))))
    assert abs(parts[2][0] / parts[2][1] - 1) < 1e-9 and parts[3][0] > 5 * parts[3][1]
