"""The rolling simplex on the squared distance from a flat face: find the error."""

import numpy as np


def search(f, start, edge=1.0, tolerance=1e-10):
    """Lowest vertex and number of values."""
    corners = np.array([[-0.5, -np.sqrt(3) / 6], [0.5, -np.sqrt(3) / 6], [0.0, -np.sqrt(3) / 6]])
    x = start + edge * corners
    values, age, count = np.array([f(v) for v in x]), np.zeros(3, int), 3
    while True:
        low, second, high = np.argsort(values)
        for moved in (high, second):
            image = x.sum(axis=0) - 2 * x[moved]
            value = f(image)
            count += 1
            if value < values[moved] or moved == second:
                break
        x[moved], values[moved] = image, value
        age += 1
        age[moved] = 0
        low = np.argmin(values)
        if age[low] >= 4:
            if edge < tolerance:
                return x[low], count
            x = x[low] + (x - x[low]) / 2
            edge /= 2
            values = np.array([f(v) for v in x])
            age[:] = 0
            count += 2


if __name__ == "__main__":
    for place in np.random.default_rng(1).uniform(-1, 1, (5, 2)):
        found, count = search(lambda x: ((x - place) ** 2).sum() + 1e-8, np.zeros(2))
        print(f"{count} values, errors {np.abs(found - place)}")
