"""Equations of faces, bricks, rules and closest points, written again from the pages and compared with the library."""

import numpy as np
import pytest
from executes import executes
from libcontact._core import ffi, lib
from numpy.polynomial import legendre
from scenes import EDGES

import libcontact as ct

RNG = np.random.default_rng(17)
CORNERS = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
# A bent face, and points over it.
Q4 = np.array([[-1.0, -1.1, 0.2], [1.2, -0.9, -0.1], [1.1, 1.3, 0.3], [-0.8, 0.9, -0.2]])
Q8 = np.vstack([Q4, (Q4 + np.roll(Q4, -1, axis=0)) / 2 + RNG.uniform(-0.1, 0.1, (4, 3))])
POINT = np.array([0.3, -0.2, 0.45])


def close(found, expected, tolerance=1e-13):
    np.testing.assert_allclose(found, expected, rtol=tolerance, atol=tolerance)


def c_array(values):
    return ffi.new("double[]", [float(value) for value in np.ravel(values)])


# -- Shape functions


def shape_q4(xi):
    return np.array([(1 + a * xi[0]) * (1 + b * xi[1]) / 4 for a, b in CORNERS])


def shape_q8(xi):
    x, y = xi
    corners = [(1 + a * x) * (1 + b * y) * (a * x + b * y - 1) / 4 for a, b in CORNERS]
    # The coordinate along the side, and the one across, 1 on it.
    sides = [(x, -y), (y, x), (x, y), (y, -x)]
    return np.array(corners + [(1 - along**2) * (1 + across) / 2 for along, across in sides])


def shape_t3(xi):
    return np.array([1 - xi[0] - xi[1], xi[0], xi[1]])


def shape_t6(xi):
    L = shape_t3(xi)
    return np.array([*(L * (2 * L - 1)), *(4 * L * np.roll(L, -1))])


SHAPES = {"Q4": shape_q4, "Q8": shape_q8, "T3": shape_t3, "T6": shape_t6}
NODES = {"Q4": Q4, "Q8": Q8, "T3": Q4[:3], "T6": np.vstack([Q4[:3], Q8[4:6], Q8[7:] - 0.3])}


@pytest.mark.parametrize("kind", SHAPES)
@executes("segment-q4", "segment-q8", "segment-triangle", "segment-point")
def test_points_of_a_face(kind):
    xi = RNG.uniform(-1, 1, (20, 2))
    expected = [SHAPES[kind](each) @ NODES[kind] for each in xi]
    close(ct.face_points(kind, NODES[kind], xi), expected)


def shape_hex8(xi, corner):
    return np.prod(1 + corner * xi, axis=-1) / 8


def shape_hex20(xi, place):
    """Of a corner, whose coordinates are ±1, or of the middle of the edge along the axis with 0."""
    if np.all(place != 0):
        return np.prod(1 + place * xi) * (np.sum(place * xi) - 2) / 8
    a = np.flatnonzero(place == 0)[0]
    return (1 - xi[a] ** 2) * np.prod(np.delete(1 + place * xi, a)) / 4


# The corners of a brick in VTK's order, then the middles of its edges.
BRICK = np.array(
    [
        (-1, -1, -1),
        (1, -1, -1),
        (1, 1, -1),
        (-1, 1, -1),
        (-1, -1, 1),
        (1, -1, 1),
        (1, 1, 1),
        (-1, 1, 1),
    ]
)
BRICK20 = np.vstack([BRICK, [(BRICK[a] + BRICK[b]) // 2 for a, b in EDGES]])


@executes("brick-hex8", "brick-hex20")
def test_shape_functions_of_bricks_and_their_gradients():
    for kind, places, shape in (
        (lib.CT_HEX8, BRICK, shape_hex8),
        (lib.CT_HEX20, BRICK20, shape_hex20),
    ):
        values = ffi.new("double[20]")
        slopes = ffi.new("double[20][3]")
        for xi in RNG.uniform(-1, 1, (10, 3)):
            lib.ct_brick_shape(kind, c_array(xi), values)
            lib.ct_brick_gradient(kind, c_array(xi), slopes)
            for i, place in enumerate(places):
                close(values[i], shape(xi, place))
                for a, step in enumerate(1e-5 * np.eye(3)):
                    quotient = (shape(xi + step, place) - shape(xi - step, place)) / 2e-5
                    close(slopes[i][a], quotient, 1e-9)


# -- Rules


def gauss(n):
    """Zeros of Legendre's polynomial, and the weights of the page."""
    P = legendre.Legendre.basis(n)
    x = np.sort(P.roots().real)
    return x, 2 / ((1 - x**2) * P.deriv()(x) ** 2)


def rule(kind):
    out = ffi.new("ct_rule *")
    assert lib.ct_rule_face(kind, out, ffi.NULL) == lib.CT_OK
    xi = np.array([[out.xi[q][a] for a in range(2)] for q in range(out.count)])
    return xi, np.array([out.weight[q] for q in range(out.count)])


def in_order(xi, weight):
    rows = np.column_stack([xi, weight])
    return rows[np.lexsort(np.round(rows[:, :2].T, 9))]


@pytest.mark.parametrize("kind, n", [(lib.CT_Q4, 2), (lib.CT_Q8, 3)])
@executes("quadrature-gauss", "quadrature-product", "quadrature-rule")
def test_gauss_rule_of_quadrilaterals(kind, n):
    x, w = gauss(n)
    xi = [(a, b) for a in x for b in x]
    weight = [a * b for a in w for b in w]
    close(in_order(*rule(kind)), in_order(xi, weight))
    # The rule integrates x^2 y^2 over the square: (2/3)^2.
    found, weights = rule(kind)
    close(weights @ (found[:, 0] ** 2 * found[:, 1] ** 2), 4 / 9)


@executes("quadrature-orbit", "quadrature-triangle")
def test_rules_of_triangles():
    orbit = lambda a: [(a, a), (1 - 2 * a, a), (a, 1 - 2 * a)]
    close(in_order(*rule(lib.CT_T3)), in_order(orbit(1 / 6), [1 / 6] * 3))
    root = np.sqrt(38 - 44 * np.sqrt(2 / 5))
    last = np.sqrt(213125 - 53320 * np.sqrt(10))
    a = [(8 - np.sqrt(10) + sign * root) / 18 for sign in (1, -1)]
    w = [(620 + sign * last) / 7440 for sign in (1, -1)]
    # Degree 4: of the two ways to pair a and w, one integrates x^4 = 2 · 4! / 6! ... 1/30.
    xi, weight = rule(lib.CT_T6)
    close(weight @ xi[:, 0] ** 4, 1 / 30)
    close(sorted(set(np.round(weight, 14))), sorted(w), 1e-12)
    pairs = {round(v, 12): u for u, v in zip(a, w)}
    expected = np.vstack([orbit(pairs[round(v, 12)]) for v in w])
    close(in_order(xi, weight), in_order(expected, np.repeat(w, 3)))


@executes("quadrature-lobatto", "segment-area")
def test_weights_of_contact_points():
    """Points of a parallelogram and of a triangle over a floor; their weights are w J with J = |t1 x t2|."""
    floor = ct.Surface("Q4", [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2, 3]])
    edges = np.array([[1.2, 0.1, 0], [0.3, 0.9, 0]])
    area = np.linalg.norm(np.cross(*edges))
    up = np.array([0, 0, 0.1])
    quad = np.array([up, up + edges[1], up + edges.sum(axis=0), up + edges[0]])
    tri = np.array([up, up + edges[1], up + edges[0]])
    quads = np.repeat([1 / 9, 4 / 9, 16 / 9], [4, 4, 1]) * area / 4
    triangles = np.repeat([1 / 40, 1 / 15, 9 / 40], [3, 3, 1]) * area
    for kind, nodes, expected in (("Q4", quad, quads), ("T3", tri, triangles)):
        surface = ct.Surface(kind, nodes, [range(len(nodes))])
        contact = ct.Contact(surface, floor, epsilon=1.0, points="lobatto", travel_time=0.1)
        still = (np.zeros_like(nodes), np.zeros((4, 3)))
        places = (nodes - [0, 0, 0.11], floor_nodes())
        contact.step(0.1, places, still, (np.ones_like(nodes), np.zeros((4, 3))))
        points = contact.points
        close(np.sort(points["weight"][points["side"] == 0]), np.sort(expected))


def floor_nodes():
    return np.array([[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], float)


# -- The closest point


class Look:
    """f of a point over a Q8 face, its gradient, Hessian and tangents at a place; the derivatives of the shape
    functions by differences that are exact for their degree."""

    def __init__(self, xi, nodes=Q8, point=POINT):
        self.xi = np.asarray(xi, float)
        y = lambda a, b: shape_q8(self.xi + [a, b]) @ nodes
        s = 0.5
        e = s * np.eye(2)
        # Along one axis y is a parabola, and y,1 is one along the other: central differences have no error.
        self.d = y(0, 0) - point
        self.t = np.array([(y(*a) - y(*-a)) / (2 * s) for a in e])
        second = [(y(*a) - 2 * y(0, 0) + y(*-a)) / s**2 for a in e]
        mixed = (y(s, s) - y(s, -s) - y(-s, s) + y(-s, -s)) / (4 * s * s)
        self.tt = np.array([[second[0], mixed], [mixed, second[1]]])

    @property
    def f(self):
        return self.d @ self.d

    @property
    def g(self):
        return 2 * self.t @ self.d

    @property
    def H(self):
        return 2 * (self.t @ self.t.T + self.tt @ self.d)

    @property
    def normal(self):
        n = np.cross(*self.t)
        return n / np.linalg.norm(n)


def iterates(method, start, **options):
    path, _ = ct.project_path("Q8", Q8, POINT, method=method, start=start, **options)
    return path


START = np.array([0.15, -0.35])


@executes("projection-f", "projection-gradient", "projection-hessian", "projection-newton")
def test_newton_step():
    at = Look(START)
    determinant = at.H[0, 0] * at.H[1, 1] - at.H[0, 1] ** 2
    s = [at.H[0, 1] * at.g[1] - at.H[1, 1] * at.g[0], at.H[0, 1] * at.g[0] - at.H[0, 0] * at.g[1]]
    path = iterates("newton", START)
    close(path[1], START + np.array(s) / determinant, 1e-12)
    # g and H are derivatives of f.
    for a, step in enumerate(1e-5 * np.eye(2)):
        ahead, behind = Look(START + step), Look(START - step)
        close(at.g[a], (ahead.f - behind.f) / 2e-5, 1e-9)
        close(at.H[a], (ahead.g - behind.g) / 2e-5, 1e-9)


@executes(
    "projection-stationary",
    "projection-minimum",
    "projection-convex",
    "projection-signed",
    "segment-tangents",
    "segment-normal",
)
def test_closest_point():
    for side in (1, -1):
        point = POINT * [1, 1, side]
        found = ct.project("Q8", Q8, [point], method="certified")
        at = Look(found.xi[0], point=point)
        close(at.t @ at.d, [0, 0], 1e-9)
        assert at.H[0, 0] + at.H[1, 1] > 0 and np.linalg.det(at.H) > 0
        grid = np.linspace(-1, 1, 41)
        lowest = min(Look((a, b), point=point).f for a in grid for b in grid)
        assert found.distance[0] ** 2 <= lowest and found.certified[0]
        sign = 1 if -at.d @ at.normal >= 0 else -1
        close(found.signed_distance[0], sign * np.linalg.norm(at.d), 1e-12)
        close(found.point[0], point + at.d, 1e-12)


@executes(
    "simplex-start",
    "simplex-high",
    "simplex-low",
    "simplex-centre",
    "simplex-reflection",
    "simplex-halving",
    "simplex-age",
)
def test_simplex_of_the_paper():
    """The rolling triangle written again: the lowest vertices of all its iterations."""
    e = np.array([(-1 / 2, -np.sqrt(3) / 6), (1 / 2, -np.sqrt(3) / 6), (0, np.sqrt(3) / 3)])
    value = lambda xi: Look(xi).f
    x = START + 1 * e
    f, age, lowest = np.array([value(each) for each in x]), np.zeros(3), []
    for _ in range(60):
        h, low = np.argmax(f), np.argmin(f)
        reflected = []
        for i in (h, 3 - h - low):
            centre = x[np.arange(3) != i].sum(axis=0) / 2
            reflected.append(centre + 1 * (centre - x[i]))
        # If the image of the highest vertex is no lower, the second highest is reflected.
        other = value(reflected[0]) >= f[h]
        moved = 3 - h - low if other else h
        x[moved], age = reflected[int(other)], age + 1
        f[moved], age[moved] = value(x[moved]), 0
        low = np.argmin(f)
        lowest.append(x[low].copy())
        if age[low] >= 1.65 * 2 + 0.05 * 2**2:
            x = x[low] + (x - x[low]) / 2
            f, age = np.array([value(each) for each in x]), np.zeros(3)
    close(iterates("simplex", START)[:60], lowest, 1e-12)


@executes("projection-gauss-newton")
def test_gauss_newton_step():
    at = Look(START)
    close(
        iterates("least_squares", START)[1], START - np.linalg.solve(at.t @ at.t.T, at.g / 2), 1e-12
    )


@executes("steepest-length")
def test_step_of_steepest_descent():
    at = Look(START)
    slope, bend = np.linalg.norm(at.g), at.g @ at.H @ at.g
    length = min(slope**3 / bend, 1) if bend > 0 else 1
    close(iterates("steepest_descent", START)[1], START - length * at.g / slope, 1e-12)


@executes("broyden-step", "broyden-update")
def test_steps_of_broyden():
    path = iterates("broyden", START)
    H, before = Look(START).H, Look(START)
    for k in range(1, 4):
        s = -np.linalg.solve(H, before.g)
        after = Look(before.xi + s)
        close(path[k], after.xi, 1e-11)
        H = H + np.outer(after.g - before.g - H @ s, s) / (s @ s)
        before = after


@executes("bfgs-step", "bfgs-update", "bfgs-scale")
def test_steps_of_bfgs():
    path = iterates("bfgs", START)
    # The first step is checked by its effect: D is scaled with it.
    looks = [Look(each) for each in path[:5]]
    s, y = looks[1].xi - looks[0].xi, looks[1].g - looks[0].g
    D = (s @ y) / (y @ y) * np.eye(2)
    for k in range(1, 4):
        s, y = looks[k].xi - looks[k - 1].xi, looks[k].g - looks[k - 1].g
        left = np.eye(2) - np.outer(s, y) / (s @ y)
        D = left @ D @ left.T + np.outer(s, s) / (s @ y)
        close(looks[k + 1].xi, looks[k].xi - D @ looks[k].g, 1e-10)


def frame(at):
    """The frame of the page, the components of the point in it, and the curvatures of the face."""
    e1 = at.t[0] / np.linalg.norm(at.t[0])
    e2 = np.cross(at.normal, e1)
    R11, R12, R22 = at.t[0] @ e1, at.t[1] @ e1, at.t[1] @ e2
    b = at.tt @ at.normal
    kappa11 = b[0, 0] / R11**2
    kappa12 = (b[0, 1] - R12 / R11 * b[0, 0]) / (R11 * R22)
    kappa22 = b[1, 1] - 2 * R12 / R11 * b[0, 1] + R12**2 / R11**2 * b[0, 0]
    kappa22 /= R22**2
    r = -np.array([at.d @ e1, at.d @ e2, at.d @ at.normal])
    pull_back = lambda w: np.array([(w[0] - R12 * w[1] / R22) / R11, w[1] / R22])
    return np.array([[kappa11, kappa12], [kappa12, kappa22]]), r, pull_back


@executes(
    "projection-frame",
    "projection-curvatures",
    "projection-pull-back",
    "sphere-curvature",
    "sphere-closest",
)
def test_step_on_the_sphere():
    K, r, pull_back = frame(Look(START))
    kappa = r[:2] @ K @ r[:2] / (r[:2] @ r[:2])
    m = np.sqrt((1 - kappa * r[2]) ** 2 + kappa**2 * (r[:2] @ r[:2]))
    close(iterates("sphere", START)[1], START + pull_back(r[:2] / m), 1e-12)


@executes("torus-principal", "torus-turn", "torus-closest")
def test_step_on_the_torus():
    K, r, pull_back = frame(Look(START))
    mean = (K[0, 0] + K[1, 1]) / 2
    root = np.sqrt((K[0, 0] - K[1, 1]) ** 2 / 4 + K[0, 1] ** 2)
    kappa = np.array([mean + root, mean - root])
    _, directions = np.linalg.eigh(K)
    directions = directions[:, ::-1].T  # the larger one first, as mean + root
    if abs(kappa[0]) < abs(kappa[1]):
        kappa, directions = kappa[::-1], directions[::-1]
    r_I, r_II = directions @ r[:2]
    m = np.sqrt((1 - kappa[1] * r[2]) ** 2 + kappa[1] ** 2 * r_II**2)
    height = (1 - m) / kappa[1]
    w = np.array([r_I / np.sqrt((1 - kappa[0] * height) ** 2 + kappa[0] ** 2 * r_I**2), r_II / m])
    close(iterates("torus", START)[1], START + pull_back(w @ directions), 1e-11)
