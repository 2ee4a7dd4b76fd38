"""Phase velocity in a row of masses, in units of c: find the error."""

import numpy as np


def speed(elements, consistent):
    """Of a wave with a number of elements per wave length."""
    k = 2 * np.pi / elements
    omega = 2 * np.sin(k / 2)
    if consistent:
        omega *= np.sqrt((2 + np.cos(k)) / 3)
    return omega / k


if __name__ == "__main__":
    for elements in (3, 6, 12, 24):
        print(f"{elements} elements: {speed(elements, False):.3f} {speed(elements, True):.3f}")
