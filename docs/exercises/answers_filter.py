"""Answers of the exercises of the chapter on the filter."""

import numpy as np


def passes(u, count, q=1.0):
    for _ in range(count):
        u = u + q / 4 * (np.roll(u, 1) - 2 * u + np.roll(u, -1))
    return u


def factor(length, count, q=1.0):
    wave = np.cos(2 * np.pi * np.arange(40) / length)
    return passes(wave, count, q)[0]


def test_filter_factors(says):
    says("0", *(f"{factor(n, 2):.3g}" for n in (4, 8, 20)))
    says(
        *(f"{factor(n, 2, 0.9):{f}}" for n, f in ((2, ".2f"), (4, ".4f"), (8, ".3f"), (20, ".3f")))
    )


def test_filter_passes(says):
    count = next(n for n in range(50) if factor(4, n) < 0.01)
    says(str(count), f"{100 * factor(20, count):.0f} %")
    step = passes(np.repeat([1.0, 0.0], 20), count)[5:35]
    wide = np.interp([-0.9, -0.1], -step, np.arange(len(step)))
    says(f"{np.sqrt(count / 2):.2f}", f"{2.563 * np.sqrt(count / 2):.1f}")
    assert abs(np.diff(wide)[0] - 4.8) < 0.15
