"""Hard cases for the closest point, with their true distances: ``python tests/data/corpus.py`` writes corpus.npz beside
this file.

Truth uses nothing of the library. The polynomial of a face is made of exact fractions. Along each edge the squared
distance is a polynomial of one variable, and its stationary points are its roots; the corners are looked at; inside,
Newton's method with a modified Hessian starts from each point of a fine grid. All that these find near the lowest value
is followed down in 40 digits, and the lowest end is the truth.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import mpmath as mp
import numpy as np

FILE = Path(__file__).with_name("corpus.npz")
KINDS = ("Q4", "Q8", "T3", "T6")
CASES = 150  # of each category, and of these pairs half as many each
HALVES = {"aspect_1e3", "aspect_1e6", "size_1e_9", "size_1e9", "on_edge", "on_corner"}
DIGITS = 40
GRID = 17

QUADRILATERAL = np.array(
    [[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], float
)
TRIANGLE = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5]])
REFERENCE = {"Q4": QUADRILATERAL[:4], "Q8": QUADRILATERAL, "T3": TRIANGLE[:3], "T6": TRIANGLE}
POWERS = {
    "Q4": [(0, 0), (1, 0), (0, 1), (1, 1)],
    "Q8": [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
    "T3": [(0, 0), (1, 0), (0, 1)],
    "T6": [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
}


# -- The categories -------------------------------------------------------------------------------------------------
def flat(kind):
    """The reference face in the plane z = 0; triangles are moved to the middle and made as wide as squares."""
    xy = REFERENCE[kind] if kind[0] == "Q" else 2 * REFERENCE[kind] - 2 / 3
    return np.column_stack([xy, np.zeros(len(xy))])


def rotation(rng):
    q, r = np.linalg.qr(rng.normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    return q if np.linalg.det(q) > 0 else -q


def at(kind, nodes, xi):
    """The point of the face at xi, in double precision."""
    A = np.array([[x**i * y**j for i, j in POWERS[kind]] for x, y in REFERENCE[kind]])
    return np.array([xi[0] ** i * xi[1] ** j for i, j in POWERS[kind]]) @ np.linalg.solve(A, nodes)


def somewhere(rng, kind):
    """Reference coordinates at random."""
    if kind[0] == "Q":
        return rng.uniform(-1, 1, 2)
    return rng.dirichlet([1, 1, 1])[:2]


def normal(kind, nodes, xi):
    """The unit normal at xi. The tangents are those of the polynomial: a difference quotient would keep ten digits, and
    others on another machine."""
    A = np.array([[x**i * y**j for i, j in POWERS[kind]] for x, y in REFERENCE[kind]])
    along = np.array(
        [
            [i * xi[0] ** max(i - 1, 0) * xi[1] ** j, j * xi[0] ** i * xi[1] ** max(j - 1, 0)]
            for i, j in POWERS[kind]
        ]
    )
    n = np.cross(*(along.T @ np.linalg.solve(A, nodes)))
    return n / np.linalg.norm(n)


def curved(rng, kind, bend, noise):
    """A face over z = (p x² + q y²) / 2 + r xy with |p|, |q|, |r| <= bend, its nodes shaken by `noise`."""
    nodes = flat(kind)
    p, q, r = rng.uniform(-bend, bend, 3)
    nodes += rng.uniform(-noise, noise, nodes.shape)
    nodes[:, 2] += (
        0.5 * (p * nodes[:, 0] ** 2 + q * nodes[:, 1] ** 2) + r * nodes[:, 0] * nodes[:, 1]
    )
    return nodes


def near(rng, kind, nodes, gap=0.3):
    """A point at most `gap` above or below a random place of the face, and a little aside."""
    return at(kind, nodes, somewhere(rng, kind)) + rng.uniform(-gap, gap, 3)


def any_kind(rng):
    return KINDS[rng.integers(4)]


def ordinary(rng):
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.4, 0.1)
    return kind, nodes, near(rng, kind, nodes)


def distorted(rng):
    """Nodes far from where they belong."""
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.4, 0.3)
    return kind, nodes, near(rng, kind, nodes, 0.6)


def warped_q4(rng):
    nodes = flat("Q4") + rng.uniform(-0.3, 0.3, (4, 3))
    nodes[:, 2] += rng.uniform(0.2, 0.8) * np.array([1, -1, 1, -1])
    return "Q4", nodes, rng.uniform(-1.5, 1.5, 3)


def collapsed_q4(rng):
    nodes = flat("Q4") + rng.uniform(-0.3, 0.3, (4, 3))
    form = rng.integers(3)
    if form == 0:
        nodes[3] = nodes[2]
    elif form == 1:
        nodes[3] = nodes[2] + 10 ** rng.uniform(-10, -3) * rng.normal(size=3)
    else:
        nodes[2] = 0.5 * (nodes[1] + nodes[3]) + rng.choice([0, 1e-6, 1e-3]) * rng.normal(size=3)
    return "Q4", nodes, rng.uniform(-1.5, 1.5, 3)


def quarter_point_q8(rng):
    """The mid-sides next to corner 0 stand at the quarter point of their edges, or beyond it: there the face folds
    over."""
    nodes = curved(rng, "Q8", 0.3, 0.05)
    fraction = 0.25 if rng.random() < 0.5 else rng.uniform(0.1, 0.25)
    for side, other in ((4, 1), (7, 3)):
        nodes[side] = (
            nodes[0]
            + fraction * (nodes[other] - nodes[0])
            + rng.choice([0, 0.02]) * rng.normal(size=3)
        )
    target = nodes[0] if rng.random() < 0.4 else at("Q8", nodes, somewhere(rng, "Q8"))
    return "Q8", nodes, target + rng.uniform(-0.3, 0.3, 3)


def on_cylinder(xy, radius, skew):
    """Points of the plane, sheared, laid on a cylinder about the y axis."""
    s = xy[:, 0] + skew * xy[:, 1]
    return np.column_stack(
        [radius * np.sin(s / radius), xy[:, 1], radius * (np.cos(s / radius) - 1)]
    )


def cylinder(rng):
    kind = ("Q8", "T6")[rng.integers(2)]
    nodes = (
        on_cylinder(flat(kind)[:, :2], rng.uniform(0.9, 3), rng.uniform(-0.7, 0.7))
        @ rotation(rng).T
    )
    nodes += rng.uniform(-0.03, 0.03, nodes.shape)
    return kind, nodes, near(rng, kind, nodes, 0.5)


def saddle(rng):
    kind = ("Q8", "T6", "Q4")[rng.integers(3)]
    nodes = flat(kind) + rng.uniform(-0.05, 0.05, (len(REFERENCE[kind]), 3))
    a, b = rng.uniform(0.2, 0.6, 2)
    x, y = nodes[:, :2].T
    nodes[:, 2] += a * x * y if kind == "Q4" else a * x**2 - b * y**2
    return kind, nodes, near(rng, kind, nodes, 0.5) * [1, 1, rng.uniform(0.5, 3)]


def stretched(rng, ratio):
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.3, 0.1)
    point = near(rng, kind, nodes)
    scale = np.array([1, 1 / ratio, 1 / ratio if rng.random() < 0.5 else 1])
    turn = rotation(rng)
    return kind, (nodes * scale) @ turn.T, turn @ (point * scale)


def aspect_1e3(rng):
    return stretched(rng, 1e3)


def aspect_1e6(rng):
    return stretched(rng, 1e6)


def resized(rng, factor):
    kind, nodes, point = ordinary(rng)
    return kind, factor * nodes, factor * point


def size_1e_9(rng):
    return resized(rng, 1e-9)


def size_1e9(rng):
    return resized(rng, 1e9)


def offset_1e6(rng):
    kind, nodes, point = ordinary(rng)
    offset = 1e6 * rng.normal(size=3)
    return kind, nodes + offset, point + offset


def centre_of_curvature(rng):
    kind = ("Q8", "T6")[rng.integers(2)]
    radius = rng.uniform(1.2, 3)
    xy = flat(kind)[:, :2]
    if rng.random() < 0.5:
        nodes, centre = on_cylinder(xy, radius, 0), np.array([0, rng.uniform(-0.5, 0.5), -radius])
    else:
        nodes, centre = (
            np.column_stack([xy, np.sqrt(radius**2 - 0.25 * np.sum(xy**2, axis=1))])
            * [0.5, 0.5, 1],
            np.zeros(3),
        )
    return kind, nodes, centre + 10 ** rng.uniform(-8, -2) * rng.normal(size=3)


def two_lobes(rng):
    """A trough or an arch with the point nearly as far from one flank as from the other."""
    kind = ("Q8", "T6")[rng.integers(2)]
    nodes = flat(kind)
    steep = rng.uniform(0.8, 2)
    nodes[:, 2] = steep * nodes[:, 0] ** 2
    aside = rng.choice([-1, 1]) * 10 ** rng.uniform(-6, -1)
    return (
        kind,
        nodes + rng.choice([0, 0.01]) * rng.normal(size=nodes.shape),
        np.array([aside, rng.uniform(-0.5, 0.5), rng.uniform(0.7, 2.5) * steep]),
    )


def far_away(rng):
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.4, 0.1)
    direction = rng.normal(size=3)
    return kind, nodes, 10 ** rng.uniform(1.5, 6) * direction / np.linalg.norm(direction)


def on_surface(rng):
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.4, 0.1)
    return kind, nodes, at(kind, nodes, somewhere(rng, kind))


def on_boundary(rng, along):
    """The foot is on an edge or a corner, exactly or nearly, with the point on, above or below it."""
    kind = any_kind(rng)
    nodes = curved(rng, kind, 0.4, 0.1)
    corners = REFERENCE[kind][: 4 if kind[0] == "Q" else 3]
    i = rng.integers(len(corners))
    xi = corners[i] + along * (corners[(i + 1) % len(corners)] - corners[i])
    return kind, nodes, at(kind, nodes, xi) + rng.choice([0, -0.2, 0.2]) * normal(kind, nodes, xi)


def on_edge(rng):
    return on_boundary(rng, rng.random())


def on_corner(rng):
    return on_boundary(rng, 0)


def needle_triangle(rng):
    kind = ("T3", "T6")[rng.integers(2)]
    nodes = flat(kind) + 0.05 * rng.normal(size=(len(REFERENCE[kind]), 3))
    thin = 10 ** rng.uniform(-3, -0.5)
    point = near(rng, kind, nodes)
    scale = np.array([1, thin, thin])
    return kind, nodes * scale, point * rng.choice([1, thin], 3)


def curved_t6(rng):
    nodes = flat("T6")
    nodes[3:] += rng.uniform(-0.5, 0.5, (3, 3))
    return "T6", nodes, rng.uniform(-1.2, 1.2, 3)


CATEGORIES = (
    ordinary,
    distorted,
    warped_q4,
    collapsed_q4,
    quarter_point_q8,
    cylinder,
    saddle,
    aspect_1e3,
    aspect_1e6,
    size_1e_9,
    size_1e9,
    offset_1e6,
    centre_of_curvature,
    two_lobes,
    far_away,
    on_surface,
    on_edge,
    on_corner,
    needle_triangle,
    curved_t6,
)


def generate():
    """All cases as (category, kind, nodes, point); the same ones every time."""
    cases = []
    for number, category in enumerate(CATEGORIES):
        rng = np.random.default_rng([2012, number])
        cases += [
            (category.__name__, *category(rng))
            for _ in range(CASES // 2 if category.__name__ in HALVES else CASES)
        ]
    return cases


# -- The truth ------------------------------------------------------------------------------------------------------
def coefficients(kind, nodes, point):
    """y(xi) - point as a polynomial: one row of exact fractions for each of POWERS[kind]."""
    rows = [
        [Fraction(float(x)) ** i * Fraction(float(y)) ** j for i, j in POWERS[kind]]
        for x, y in REFERENCE[kind]
    ]
    right = [
        [Fraction(float(v)) - Fraction(float(p)) for v, p in zip(node, point)] for node in nodes
    ]
    n = len(rows)
    for i in range(n):
        pivot = next(r for r in range(i, n) if rows[r][i])
        rows[i], rows[pivot], right[i], right[pivot] = rows[pivot], rows[i], right[pivot], right[i]
        for r in range(n):
            if r != i and rows[r][i]:
                factor = rows[r][i] / rows[i][i]
                rows[r] = [a - factor * b for a, b in zip(rows[r], rows[i])]
                right[r] = [a - factor * b for a, b in zip(right[r], right[i])]
    return [[v / rows[i][i] for v in right[i]] for i in range(n)]


def derivatives(kind, c, x, y):
    """f, gradient and Hessian for coefficients c[j][k]; any number type, arrays too."""
    d, t1, t2, t11, t22, t12 = ([0, 0, 0] for _ in range(6))
    for (i, j), row in zip(POWERS[kind], c):
        xi, yj = x**i, y**j
        dx, dy = i * x ** max(i - 1, 0), j * y ** max(j - 1, 0)
        for k in range(3):
            d[k] = d[k] + row[k] * (xi * yj)
            t1[k] = t1[k] + row[k] * (dx * yj)
            t2[k] = t2[k] + row[k] * (xi * dy)
            t11[k] = t11[k] + row[k] * (i * (i - 1)) * yj
            t22[k] = t22[k] + row[k] * (j * (j - 1)) * xi
            t12[k] = t12[k] + row[k] * (dx * dy)

    def dot(a, b):
        return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]

    return (
        dot(d, d),
        2 * dot(d, t1),
        2 * dot(d, t2),
        2 * (dot(t1, t1) + dot(d, t11)),
        2 * (dot(t2, t2) + dot(d, t22)),
        2 * (dot(t1, t2) + dot(d, t12)),
    )


def newton_step(g1, g2, h11, h22, h12, sqrt):
    """Newton's step with the Hessian's eigenvalues made positive; so it always leads down."""
    mean, half = (h11 + h22) / 2, (h11 - h22) / 2
    radius = sqrt(half * half + h12 * h12)
    low, high = abs(mean - radius), abs(mean + radius)
    floor = (
        (low + high) * type(low + high)(1e-25)
        if isinstance(low, mp.mpf)
        else (low + high) * 1e-14 + 1e-300
    )
    low, high = low + floor, high + floor
    # |H|⁻¹ g = (a + b (H - mean)) g, which has 1/high along the upper eigenvector and 1/low along the lower one.
    a = (1 / high + 1 / low) / 2
    b = (1 / high - 1 / low) / 2 / (radius + floor)
    return -(a * g1 + b * (half * g1 + h12 * g2)), -(a * g2 + b * (h12 * g1 - half * g2))


def descend_from_grid(kind, c):
    """Ends of the descents from a grid of starts, in double precision: (xi (m, 2), f (m,)) sorted by f."""
    if kind[0] == "Q":
        x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(-1, 1, GRID)]))
    else:
        x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0, 1, GRID)]))
        x, y = x[x + y <= 1], y[x + y <= 1]
    alpha = np.ones_like(x)
    now = derivatives(kind, c, x, y)
    for _ in range(60):
        sx, sy = newton_step(*now[1:], np.sqrt)
        reach = np.maximum(np.maximum(abs(sx), abs(sy)) / 0.5, 1)
        nx, ny = x + alpha * sx / reach, y + alpha * sy / reach
        if kind[0] == "Q":
            nx, ny = np.clip(nx, -1, 1), np.clip(ny, -1, 1)
        else:
            nx, ny = np.clip(nx, 0, 1), np.clip(ny, 0, 1)
            over = np.maximum(nx + ny - 1, 0) / 2
            nx, ny = np.clip(nx - over, 0, 1), np.clip(ny - over, 0, 1)
        trial = derivatives(kind, c, nx, ny)
        better = trial[0] < now[0]
        alpha = np.where(better, np.minimum(2 * alpha, 1), alpha / 3)
        x, y = np.where(better, nx, x), np.where(better, ny, y)
        now = tuple(np.where(better, new, old) for new, old in zip(trial, now))
    order = np.argsort(now[0])
    return np.column_stack([x, y])[order], now[0][order]


def follow_down(kind, c, xi):
    """In many digits from xi to a stationary point inside; None when it leaves the face."""
    x, y = (mp.mpf(float(v)) for v in xi)
    now = derivatives(kind, c, x, y)
    for _ in range(1000):
        step = newton_step(*now[1:], mp.sqrt)
        alpha = mp.mpf(1)
        while alpha > 1e-9:
            nx, ny = x + alpha * step[0], y + alpha * step[1]
            trial = derivatives(kind, c, nx, ny)
            if trial[0] < now[0]:
                break
            alpha /= 4
        else:
            break
        x, y, now = nx, ny, trial
        if not is_inside(kind, x, y):
            return None
        if alpha * max(abs(step[0]), abs(step[1])) < 1e-25:
            break
    return now[0], x, y


def is_inside(kind, x, y):
    return -1 <= x <= 1 and -1 <= y <= 1 if kind[0] == "Q" else x >= 0 and y >= 0 and x + y <= 1


def edge_ends(kind, c):
    """(f, x, y) at the corners and at every stationary point of f along the edges."""
    corners = REFERENCE[kind][: 4 if kind[0] == "Q" else 3]
    for i, corner in enumerate(corners):
        step = corners[(i + 1) % len(corners)] - corner
        # d(t) = a + b t + e t² on 0 <= t <= 1 from three of its values
        values = []
        for t in (0, Fraction(1, 2), 1):
            x, y = (Fraction(float(u)) + t * Fraction(float(v)) for u, v in zip(corner, step))
            values.append(
                [
                    sum(row[k] * x**p * y**q for (p, q), row in zip(POWERS[kind], c))
                    for k in range(3)
                ]
            )
        a = values[0]
        e = [2 * (u - 2 * v + w) for u, v, w in zip(*values)]
        b = [w - u - v for u, w, v in zip(values[0], values[2], e)]
        slope = [
            sum(u * v for u, v in zip(p, q)) for p, q in ((a, b), (b, b), (b, e), (a, e), (e, e))
        ]
        slope = [slope[0], slope[1] + 2 * slope[3], 3 * slope[2], 2 * slope[4]]  # f' / 2
        top = max(map(abs, slope))
        places = [mp.mpf(0), mp.mpf(1)]
        if top:
            for root in np.roots([float(v / top) for v in reversed(slope)]):
                places.append(root_of(slope, min(max(mp.mpf(float(root.real)), 0), 1)))
        for t in places:
            x, y = (mp.mpf(float(u)) + t * mp.mpf(float(v)) for u, v in zip(corner, step))
            yield x, y


def root_of(slope, t):
    """Newton in many digits, held on 0 <= t <= 1; an end is an answer as well, for f there is f of a point of the
    face."""
    s = [mp.mpf(v.numerator) / v.denominator for v in slope]
    for _ in range(12):
        value, first = (
            s[0] + t * (s[1] + t * (s[2] + t * s[3])),
            s[1] + t * (2 * s[2] + 3 * t * s[3]),
        )
        if first == 0:
            break
        step = value / first
        t = min(max(t - step, mp.mpf(0)), mp.mpf(1))
        if abs(step) < 1e-30:
            break
    return t


def truth(kind, nodes, point):
    """The distance, the reference coordinates of the foot, and its distance from the nearest edge in xi."""
    exact = coefficients(kind, nodes, point)
    scale = Fraction(2) ** int(
        np.ceil(np.log2(max(abs(float(v)) for row in exact[1:] for v in row)))
    )
    exact = [[v / scale for v in row] for row in exact]
    with mp.workdps(DIGITS):
        many = [[mp.mpf(v.numerator) / v.denominator for v in row] for row in exact]
        ends = [(derivatives(kind, many, x, y)[0], x, y) for x, y in edge_ends(kind, exact)]
        xi, f = descend_from_grid(kind, np.array([[float(v) for v in row] for row in exact]))
        lowest = min(f[0], float(min(ends)[0]))
        limit = (np.sqrt(lowest) + 1e-2 * max(np.sqrt(lowest), 1)) ** 2
        starts = []
        for place, value in zip(xi, f):
            if (
                value <= limit
                and len(starts) < 5
                and all(np.max(abs(place - other)) > 1e-3 for other in starts)
            ):
                starts.append(place)
        for start in starts:
            end = follow_down(kind, many, start)
            if end is not None:
                ends.append(end)
        f, x, y = min(ends)
        margin = min(1 - abs(x), 1 - abs(y)) if kind[0] == "Q" else min(x, y, 1 - x - y)
        size = mp.mpf(scale.numerator) / scale.denominator
        return float(mp.sqrt(f) * size), (float(x), float(y)), float(margin)


def face_size(nodes):
    """Half the largest distance between two nodes."""
    return 0.5 * np.max(np.linalg.norm(nodes[:, None] - nodes[None], axis=-1))


def load():
    """The stored corpus as a list of dictionaries."""
    with np.load(FILE) as data:
        names, kinds = [str(n) for n in data["names"]], data["kind"]
        table = {
            key: data[key] for key in ("category", "nodes", "point", "distance", "xi", "margin")
        }
    return [
        {
            "category": names[table["category"][i]],
            "kind": KINDS[kinds[i]],
            "nodes": table["nodes"][i, : len(REFERENCE[KINDS[kinds[i]]])],
            **{key: table[key][i] for key in ("point", "distance", "xi", "margin")},
        }
        for i in range(len(kinds))
    ]


def main():
    cases = generate()
    names = [category.__name__ for category in CATEGORIES]
    nodes = np.zeros((len(cases), 8, 3))
    answers = []
    for i, (_, kind, own, point) in enumerate(cases):
        nodes[i, : len(own)] = own
        answers.append(truth(kind, own, point))
        if i % 100 == 99:
            print(f"{i + 1} of {len(cases)}", flush=True)
    distance, xi, margin = (np.array(column) for column in zip(*answers))
    np.savez_compressed(
        FILE,
        names=names,
        category=np.array([names.index(c[0]) for c in cases], np.int8),
        kind=np.array([KINDS.index(c[1]) for c in cases], np.int8),
        nodes=nodes,
        point=np.array([c[3] for c in cases]),
        distance=distance,
        xi=xi,
        margin=margin,
    )


if __name__ == "__main__":
    main()
