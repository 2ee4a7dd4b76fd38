"""Meshes of the stability laboratory: shapes of cubes, strips, coils, balls, wedges; also with moved
nodes, rotated, and as hex20."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from libcontact.mesh import EDGE_ENDS as EDGES

# VTK's corners of a brick.
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
# Each of these has a re-entrant edge or corner.
CONCAVE: dict[str, list[tuple[int, int, int]]] = {
    "L": [(i, 0, 0) for i in range(4)] + [(0, j, 0) for j in range(1, 4)],
    "T": [(i, 2, 0) for i in range(5)] + [(2, 0, 0), (2, 1, 0)],
    "stairs": [(i, j, 0) for i in range(3) for j in range(3 - i)],
    "U": [(i, 0, 0) for i in range(3)] + [(i, j, 0) for i in (0, 2) for j in (1, 2)],
    "plus": [(1, 1, 0), (0, 1, 0), (2, 1, 0), (1, 0, 0), (1, 2, 0)],
    "ring": [(i, j, 0) for i in range(3) for j in range(3) if (i, j) != (1, 1)],
    "Z": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (2, 1, 0)],
    "corner": [
        (i, j, k) for i in range(2) for j in range(2) for k in range(2) if (i, j, k) != (1, 1, 1)
    ],
}

Bricks = tuple[np.ndarray, np.ndarray]


def joined(corners: np.ndarray) -> Bricks:
    """Nodes and elements of bricks from the integer coordinates of their corners (cells, 8, 3)."""
    nodes, numbers = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    return nodes.astype(float), numbers.reshape(len(corners), 8).astype(np.int32)


def cubes(cells: Sequence[tuple[int, int, int]], parts: int = 1) -> Bricks:
    """Unit cubes at these places, each of ``parts`` elements along an edge."""
    inner = np.stack(np.meshgrid(*[np.arange(parts)] * 3, indexing="ij"), -1).reshape(-1, 3)
    places = (parts * np.array(cells)[:, None] + inner).reshape(-1, 3)
    nodes, elements = joined(places[:, None] + CORNERS)
    return nodes / parts, elements


def moved(bricks: Bricks, amount: float, random: np.random.Generator) -> Bricks:
    """Move each node at random by up to ``amount`` along each axis."""
    nodes, elements = bricks
    return nodes + random.uniform(-amount, amount, nodes.shape), elements


def with_edges(
    bricks: Bricks, onto: Callable[[np.ndarray], np.ndarray] = lambda middle: middle
) -> Bricks:
    """Make hex20 of hex8: a node in the middle of each edge, which ``onto`` maps to its place."""
    nodes, elements = bricks
    pairs = np.sort(elements[:, EDGES], axis=2)
    edges, numbers = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    more = numbers.reshape(len(elements), 12) + len(nodes)
    return np.concatenate([nodes, onto(nodes[edges].mean(1))]), np.hstack([elements, more]).astype(
        np.int32
    )


def turned(bricks: Bricks, rotation: np.ndarray) -> Bricks:
    return bricks[0] @ rotation.T, bricks[1]


def random_rotation(random: np.random.Generator) -> np.ndarray:
    q = random.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


# Strips: a box (length, width, thickness) bent along a curve in the plane of x and z.


def bent(
    cells: Sequence[int],
    width: float,
    thickness: float,
    curve: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    closed: bool = False,
) -> Bricks:
    """
    A strip about the middle line ``curve(s)``, 0 <= s <= 1, which returns points and unit normals (n, 2) in
    the plane of x and z. The line of a ``closed`` strip ends at its start.
    """
    places = (
        np.stack(np.meshgrid(*[np.arange(n) for n in cells], indexing="ij"), -1).reshape(-1, 1, 3)
        + CORNERS
    )
    if closed:
        places[..., 0] %= cells[0]
    lattice, elements = joined(places)
    s, y, off = (lattice / np.array(cells)).T
    point, normal = curve(s)
    place = point + thickness * (off - 0.5)[:, None] * normal
    return np.stack([place[:, 0], width * y, place[:, 1]], -1), elements


def hairpin(leg: float, thickness: float, gap: float, cells: Sequence[int], width: float) -> Bricks:
    """A U: two legs along x, the first below the other, and half a ring between them at the larger x."""
    radius = 0.5 * (thickness + gap)
    whole = 2 * leg + np.pi * radius

    def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        along = whole * s
        angle = np.clip((along - leg) / radius, 0.0, np.pi)
        x = np.where(along < leg, along, np.where(along > whole - leg, whole - along, leg))
        normal = np.stack([-np.sin(angle), np.cos(angle)], -1)
        return np.stack([x, np.zeros_like(x)], -1) - radius * normal, normal

    return bent(cells, width, thickness, curve)


def fork(legs: int, through: int, gap: int, base: int, wide: int, h: float) -> Bricks:
    """A U with corners: two legs along x of ``through`` elements, ``gap`` elements apart, on a base of ``base``
    elements at the smaller x; elements are cubes of edge h."""
    high = 2 * through + gap
    cells = [
        (i, j, k)
        for i in range(-base, legs)
        for j in range(wide)
        for k in range(high)
        if i < 0 or not through <= k < through + gap
    ]
    nodes, elements = cubes(cells)
    return nodes * h, elements


def spiral(
    inner: float, pitch: float, turns: float, thickness: float, cells: Sequence[int], width: float
) -> Bricks:
    """A strip wound about y: the radius of its middle line grows from ``inner`` by ``pitch`` a turn."""

    def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # Equal elements: the square of the radius grows as the length does.
        outer = inner + pitch * turns
        radius = np.sqrt(inner**2 + s * (outer**2 - inner**2))
        angle = 2 * np.pi * (radius - inner) / pitch
        out = np.stack([np.cos(angle), np.sin(angle)], -1)
        normal = np.stack([-out[:, 0], -out[:, 1]], -1)
        return radius[:, None] * out, normal

    return bent(cells, width, thickness, curve)


def coil(
    inner: float, pitch: float, turns: int, thickness: float, cells: Sequence[int], width: float
) -> Bricks:
    """A strip wound about y, whose outer end leaves the coil along x, at its lowest point."""
    outer = inner + pitch * turns
    wound, straight = 0.5 * (outer**2 - inner**2) * 2 * np.pi / pitch, 1.3 * outer

    def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        along = s * (wound + straight)
        radius = np.sqrt(inner**2 + np.minimum(along / wound, 1.0) * (outer**2 - inner**2))
        # The winding ends at the angle of -90 degrees.
        angle = 2 * np.pi * (radius - outer) / pitch - 0.5 * np.pi
        out = np.stack([np.cos(angle), np.sin(angle)], -1)
        return radius[:, None] * out + np.maximum(along - wound, 0.0)[:, None] * np.array(
            [1.0, 0.0]
        ), -out

    return bent(cells, width, thickness, curve)


def ring(radius: float, thickness: float, cells: Sequence[int], width: float) -> Bricks:
    """A closed ring about y with this middle radius."""

    def curve(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        out = np.stack([np.cos(2 * np.pi * s), np.sin(2 * np.pi * s)], -1)
        return radius * out, -out

    return bent(cells, width, thickness, curve, closed=True)


# Bodies of about the size 1 about the origin, for impacts at random.


def box(size: Sequence[float], cells: Sequence[int]) -> Bricks:
    places = (
        np.stack(np.meshgrid(*[np.arange(n) for n in cells], indexing="ij"), -1).reshape(-1, 1, 3)
        + CORNERS
    )
    lattice, elements = joined(places)
    return (lattice / np.array(cells) - 0.5) * np.array(size), elements


def rounded(x: np.ndarray, share: float = 0.6) -> np.ndarray:
    """A cube about the origin whose surface is moved towards a sphere. A full sphere would flatten the edges
    of the cube, and bricks there would collapse."""
    length = np.linalg.norm(x, axis=1, keepdims=True)
    onto = x * np.abs(x).max(1, keepdims=True) / np.where(length > 0, length, 1.0)
    return (1 - share) * x + share * onto


def tapered(x: np.ndarray) -> np.ndarray:
    """Map a box about the origin to a wedge."""
    return x * np.stack(
        [1 - 0.8 * (x[:, 2] / np.ptp(x[:, 2]) + 0.5), np.ones(len(x)), np.ones(len(x))], -1
    )


def least_jacobian(bricks: Bricks, parts: int = 4) -> float:
    """The smallest det J of hex8 or hex20 on a regular grid of points in each element, with the corners."""
    nodes, elements = bricks
    at = np.linspace(-1, 1, parts + 1)
    xi = np.stack(np.meshgrid(at, at, at, indexing="ij"), -1).reshape(-1, 1, 3)
    own = 2.0 * CORNERS - 1.0
    t = 1 + own * xi
    slope = np.stack([own[:, k] * np.delete(t, k, 2).prod(2) / 8 for k in range(3)], -1)
    if elements.shape[1] == 20:
        # Serendipity: N = (1 + x)(1 + y)(1 + z)(x + y + z - 2) / 8 at corners and (1 - x^2)(1 + y)(1 + z) / 4 on edges,
        # with the signs of the node.
        slope = slope * ((own * xi).sum(2) - 2)[..., None] + own * (t.prod(2) / 8)[..., None]
        middle = 0.5 * (own[EDGES[:, 0]] + own[EDGES[:, 1]])
        factor = np.where(middle == 0, 1 - xi**2, 1 + middle * xi)
        change = np.where(middle == 0, -2 * xi, middle + 0 * xi)
        slope = np.concatenate(
            [
                slope,
                np.stack(
                    [change[..., k] * np.delete(factor, k, 2).prod(2) / 4 for k in range(3)], -1
                ),
            ],
            axis=1,
        )
    return float(np.linalg.det(np.einsum("gnk,enj->egjk", slope, nodes[elements])).min())


def any_body(kind: str, element: str, random: np.random.Generator) -> Bricks:
    """A box, a box with moved nodes, a ball or a wedge with random size, mesh and orientation, without
    inverted elements."""
    while True:
        cells = random.integers(2, 4, 3) if element == "hex8" else random.integers(1, 3, 3)
        bricks = box(random.uniform(0.6, 1.2, 3), cells)
        h = float((np.ptp(bricks[0], axis=0) / cells).min())
        if element == "hex20":
            bricks = with_edges(bricks)
        if kind == "moved":
            # This bends the edges of hex20.
            bricks = moved(bricks, (0.15 if element == "hex8" else 0.1) * h, random)
        nodes, elements = bricks
        nodes = {"ball": rounded, "wedge": tapered}.get(kind, lambda x: x)(nodes)
        if least_jacobian((nodes, elements)) > 0:
            return turned((nodes, elements), random_rotation(random))
