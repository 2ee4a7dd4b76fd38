"""Arrivals of the waves from the edge of a plate, in units with c₁ = 1: find the error."""

import numpy as np


def arrivals(x, depth, nu=0.3):
    """Times of the P circle, the head wave and the S circle."""
    c2 = np.sqrt((1 - 2 * nu) / (2 - 2 * nu))
    angle = np.arcsin(c2)  # between the head wave and the face
    along = x - depth / np.tan(angle)
    head = along + depth / np.sin(angle) / c2
    return np.hypot(x, depth), head, np.hypot(x, depth) / c2


if __name__ == "__main__":
    print("P circle, head wave, S circle: {:.3f} {:.3f} {:.3f}".format(*arrivals(0.8, 0.2)))
