"""Answers of the exercises of the chapter on damping."""

import numpy as np


def test_damping_rate(says):
    """From the roots of the damped oscillator."""
    w, zeta = 2 * np.pi * 1000, 0.05
    alpha, beta = 2 * zeta * w, 2 * zeta / w
    for d in (alpha, beta * w**2):
        root = np.roots([1, d, w * w])[0]
        assert abs(-root.real / abs(root) - zeta) < 1e-12
    says(f"{alpha:.0f}", f"{beta * 1e5:.2f}·10⁻⁵", f"{np.log(100) / -root.real * 1e3:.1f}")
    fast = [-np.roots([1, d, 100 * w * w])[0].real / (10 * w) for d in (alpha, beta * 100 * w * w)]
    says(f"{100 * fast[0]:.1f} %", f"{100 * fast[1]:.0f} %")


def test_damping_step(says):
    w = 2 * 5190 / 0.01
    beta, alpha = 0.1 / (2 * np.pi * 1000), 0.1 * 2 * np.pi * 1000
    says(f"{w / 1e6:.3f}·10⁶", f"{beta * w / 2:.2f}")
    x = np.linspace(
        0.01, 2, 40_000
    )  # ωΔt: the largest with both roots of one step within the unit circle
    for d, shown in ((beta * w, True), (alpha / w, False)):
        stable = np.abs(1 - d * x) <= 1, np.abs(2 - d * x - x * x) <= 2 - d * x + 1e-12
        limit = x[stable[0] & stable[1]].max() / 2
        if shown:
            says(f"{np.sqrt(1 + (d / 2) ** 2) - d / 2:.4f}", f"{1 / limit:.0f}")
            assert abs(limit - np.sqrt(1 + (d / 2) ** 2) + d / 2) < 1e-4
        else:
            says(f"{d / 2 * 1e4:.1f}·10⁻⁴")
            assert abs(limit - 1) < 1e-3
