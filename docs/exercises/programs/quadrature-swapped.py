"""Three Gauss points on the interval from -1 to 1: find the error."""

import numpy as np

POINTS = np.array([0, -np.sqrt(3 / 5), np.sqrt(3 / 5)])
WEIGHTS = np.array([5 / 9, 8 / 9, 5 / 9])


def integral(function):
    return WEIGHTS @ function(POINTS)


if __name__ == "__main__":
    for power in range(7):
        exact = (1 - (-1) ** (power + 1)) / (power + 1)
        print(f"x^{power}: {integral(lambda x: x**power):.4f}, exact {exact:.4f}")
