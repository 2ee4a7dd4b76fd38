"""Answers of the exercises of the chapter on hard cases."""

import numpy as np


def test_stability_rules(says):
    scale = max(10, 40)
    says(f"{100 * 0.35 / scale:.2g} %", f"{100 * 0.5 / scale:.2f} %", "half an edge")


def test_stability_rounding(says):
    says(f"{4e5 * 2.0**-53 * 1e11:.1f}·10⁻¹¹", f"{np.sqrt(1e5) * 2.0**-53 * 1e14:.1f}·10⁻¹⁴")
