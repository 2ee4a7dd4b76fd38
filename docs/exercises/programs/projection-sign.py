"""Gaps of points from a square, positive outside: find the error."""

import numpy as np

CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])  # counter-clockwise


def gap(point):
    """Distance from the nearest side, with the sign of its outward normal."""
    best = np.inf
    for start, end in zip(CORNERS, np.roll(CORNERS, -1, axis=0)):
        along = end - start
        normal = np.array([along[1], -along[0]])
        part = np.clip((point - start) @ along / (along @ along), 0, 1)
        closest = start + part * along
        distance = np.linalg.norm(point - closest)
        if distance < best:
            best, vector = distance, point - closest
    return np.copysign(best, vector @ normal)


if __name__ == "__main__":
    points = np.random.default_rng(1).uniform(-3, 3, (3000, 2))
    gaps = np.array([gap(point) for point in points])
    inside = np.abs(points).max(axis=1) < 1
    print("wrong signs:", np.mean((gaps < 0) != inside))
