"""Distances of points from a chain of edges: find the error."""

import numpy as np

CHAIN = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(np.pi, 0, 7)])


def distance(point):
    """Distance from the nearest edge."""
    found = []
    for start, end in zip(CHAIN[:-1], CHAIN[1:]):
        along = end - start
        part = (point - start) @ along / (along @ along)
        if 0 <= part <= 1:
            found.append(np.linalg.norm(point - start - part * along))
    return min(found, default=np.inf)


if __name__ == "__main__":
    angles = np.linspace(0.1, np.pi - 0.1, 1000)
    gaps = np.array([distance(1.5 * np.array([np.cos(a), np.sin(a)])) for a in angles])
    print(f"points without a gap: {np.isinf(gaps).mean():.2f}")
