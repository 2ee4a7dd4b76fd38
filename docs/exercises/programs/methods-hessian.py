"""The closest point of the parabola z = x²/2 by Newton's method: find the error."""

import numpy as np


def newton(point, x=0.1, tolerance=1e-10):
    """Place of the closest point, and the number of steps."""
    for step in range(1, 200):
        d = np.array([x, x * x / 2]) - point
        tangent = np.array([1.0, x])
        g = 2 * d @ tangent
        H = 2 * (tangent @ tangent)
        x -= g / H
        if abs(g / H) < tolerance:
            break
    return x, step


if __name__ == "__main__":
    for height in (0.5, 0.9):
        x, steps = newton(np.array([0.0, height]))
        print(f"point at {height}: x = {x:.1e} after {steps} steps")
