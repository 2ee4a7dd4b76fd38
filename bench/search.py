"""The nearest face of a surface of 10^5 faces to a cloud of points near it: flat triangles and curved Q8
faces, compared with libigl's tree of triangles."""

from __future__ import annotations

import statistics
import time

import numpy as np

import libcontact as ct

RUNS = 7
POINTS = 100_000
TRIANGLES, QUADRILATERALS = (
    224,
    317,
)  # cells per side: 2 * 224^2 triangles, 317^2 Q8 faces, both about 10^5


def bumpy_torus(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Points of a closed surface with bumps."""
    r = 0.8 + 0.1 * np.sin(3 * u) * np.cos(5 * v)
    return np.stack(
        [(2 + r * np.cos(v)) * np.cos(u), (2 + r * np.cos(v)) * np.sin(u), r * np.sin(v)], -1
    )


def triangles(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and 2 n^2 flat triangles."""
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    nodes = bumpy_torus(2 * np.pi * i / n, 2 * np.pi * j / n).reshape(-1, 3)
    a, b = i * n + j, (i + 1) % n * n + j
    c, d = (i + 1) % n * n + (j + 1) % n, i * n + (j + 1) % n
    return nodes, np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)


def quadrilaterals(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and n^2 Q8 faces; all nodes lie on the surface."""
    m = 2 * n
    i, j = np.meshgrid(np.arange(m), np.arange(m), indexing="ij")
    nodes = bumpy_torus(2 * np.pi * i / m, 2 * np.pi * j / m).reshape(-1, 3)
    p, q = np.meshgrid(np.arange(0, m, 2), np.arange(0, m, 2), indexing="ij")
    corners = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    faces = np.stack([(p + k) % m * m + (q + l) % m for k, l in corners], -1).reshape(-1, 8)
    used, numbers = np.unique(faces, return_inverse=True)
    return nodes[used], numbers.reshape(faces.shape)


def morton_order(points: np.ndarray) -> np.ndarray:
    """Points in Morton order: along the curve through the cells of a 1024^3 grid by interleaved digits."""
    cell = ((points - points.min(0)) / (np.ptp(points, axis=0).max() * (1 + 1e-12)) * 1024).astype(
        np.int64
    )
    for shift, mask in ((16, 0x30000FF), (8, 0x300F00F), (4, 0x30C30C3), (2, 0x9249249)):
        cell = (cell | cell << shift) & mask
    return points[np.argsort(cell[:, 0] | cell[:, 1] << 1 | cell[:, 2] << 2)]


def cloud() -> np.ndarray:
    """Points at a distance of about a face's edge from the surface, in Morton order."""
    rng = np.random.default_rng(2012)
    u, v = rng.uniform(0, 2 * np.pi, (2, POINTS))
    return morton_order(bumpy_torus(u, v) + rng.normal(scale=0.02, size=(POINTS, 3)))


def timed(call) -> tuple[float, object]:
    """CPU seconds of one call, all threads together, and its result."""
    start = time.process_time()
    result = call()
    return time.process_time() - start, result


def libigl_tree(nodes: np.ndarray, faces: np.ndarray):
    """libigl's tree of triangles; None if it is not installed."""
    try:
        import igl
    except ImportError:
        return None
    tree = igl.AABB()
    tree.init(nodes, faces.astype(np.int64))
    return tree


def measure() -> dict:
    """All figures. Our runs and libigl's alternate, so that a slower machine affects both."""
    flat, curved, points = triangles(TRIANGLES), quadrilaterals(QUADRILATERALS), cloud()
    surfaces = {"T3": ct.Surface("T3", *flat), "Q8": ct.Surface("Q8", *curved)}
    peer = libigl_tree(*flat)
    rows: dict[str, list[float]] = {
        key: []
        for key in (
            "T3",
            "Q8",
            "T3 build",
            "Q8 build",
            "T3 refit",
            "Q8 refit",
            "libigl",
            "libigl build",
        )
    }
    answers = {}
    for _ in range(RUNS):
        for kind, (nodes, faces) in (("T3", flat), ("Q8", curved)):
            seconds, answers[kind] = timed(lambda: surfaces[kind].nearest(points))
            rows[kind].append(1e6 * seconds / POINTS)
            rows[f"{kind} build"].append(
                1e9 * timed(lambda: ct.Surface(kind, nodes, faces))[0] / len(faces)
            )
            rows[f"{kind} refit"].append(
                1e9 * timed(lambda: surfaces[kind].move(nodes))[0] / len(faces)
            )
        if peer is not None:
            long = flat[1].astype(np.int64)
            seconds, answers["libigl"] = timed(lambda: peer.squared_distance(flat[0], long, points))
            rows["libigl"].append(1e6 * seconds / POINTS)
            rows["libigl build"].append(1e9 * timed(lambda: libigl_tree(*flat))[0] / len(flat[1]))
    result = {
        "faces": {"T3": len(flat[1]), "Q8": len(curved[1])},
        "points": POINTS,
        "median": {key: statistics.median(row) for key, row in rows.items() if row},
    }
    if peer is not None:
        ratios = {
            kind: sorted(theirs / ours for theirs, ours in zip(rows["libigl"], rows[kind]))
            for kind in ("T3", "Q8")
        }
        result["times_faster_than_libigl"] = {
            kind: {"median": statistics.median(row), "range": [row[0], row[-1]]}
            for kind, row in ratios.items()
        }
        result["largest_difference"] = float(
            np.abs(answers["T3"].distance - np.sqrt(answers["libigl"][0])).max()
        )
    return result


def report(result: dict) -> str:
    median = result["median"]
    lines = [
        f"nearest face for {result['points']} points near a surface, in Morton order, one thread, CPU time:"
    ]
    for kind in ("T3", "Q8"):
        lines.append(
            f"  {result['faces'][kind]} {kind} faces: {median[kind]:.3f} µs per point; build {median[kind + ' build']:.0f} ns per face, "
            f"refit {median[kind + ' refit']:.0f} ns per face"
        )
    if "libigl" not in median:
        lines.append("  libigl: not installed here")
        return "\n".join(lines)
    lines.append(
        f"  libigl, {result['faces']['T3']} triangles: {median['libigl']:.3f} µs per point; build {median['libigl build']:.0f} ns per face; "
        f"distances differ by {result['largest_difference']:.1g} at most"
    )
    for kind, row in result["times_faster_than_libigl"].items():
        lines.append(
            f"  {kind}: {row['median']:.2f} times as fast as libigl on triangles ({row['range'][0]:.2f} to {row['range'][1]:.2f} in {RUNS} pairs)"
        )
    return "\n".join(lines)
