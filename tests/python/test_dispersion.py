"""Waves of a mesh: compared with meshes that numpy assembles, and with the row of the chapter; and the arrays of the
Python interface."""

import contextlib
import importlib.util
import io
import itertools
import runpy
from pathlib import Path

import numpy as np
import pytest

import libcontact as ct

spec = importlib.util.spec_from_file_location(
    "chapter", Path(__file__).resolve().parents[2] / "docs" / "theory" / "dispersion.py"
)
chapter = importlib.util.module_from_spec(spec)
spec.loader.exec_module(chapter)

# -- A periodic mesh, assembled here from polynomials ----------------------------------------------

CORNERS = np.array(list(itertools.product((-1, 1), repeat=3)), float)
MIDDLES = np.array([p for p in itertools.product((-1, 0, 1), repeat=3) if p.count(0) == 1], float)


def places(element):
    return CORNERS if element == "hex8" else np.vstack([CORNERS, MIDDLES])


def monomials(element, xi):
    """The polynomials of the element, and their gradients, at points (n, 3)."""
    degree = 1 if element == "hex8" else 2
    powers = [
        p
        for p in itertools.product(range(degree + 1), repeat=3)
        # Serendipity: superlinear degree at most 2, in which exponents of 1 do not count.
        if element == "hex8" or sum(e for e in p if e > 1) <= 2
    ]
    value = np.array([np.prod(xi ** np.array(p), axis=-1) for p in powers])
    slope = np.zeros((len(powers), 3, len(xi)))
    for i, p in enumerate(powers):
        for d in range(3):
            if p[d]:
                lower = np.array(p) - np.eye(3, dtype=int)[d]
                slope[i, d] = p[d] * np.prod(xi**lower, axis=-1)
    return value, slope


def element_matrices(element, size, poisson, mass):
    """K (3n, 3n) and M (n, n) of a brick with c₁ = ρ = 1, by 4³ Gauss points."""
    mu = 0.5 * (1 - 2 * poisson) / (1 - poisson)
    lam = 1 - 2 * mu
    x, w = np.polynomial.legendre.leggauss(4)
    xi = np.array(list(itertools.product(x, repeat=3)))
    weight = np.array([np.prod(t) for t in itertools.product(w, repeat=3)]) * np.prod(size) / 8
    inverse = np.linalg.inv(monomials(element, places(element))[0])
    value, slope = monomials(element, xi)
    N = inverse @ value
    B = np.einsum("ab,bdq->adq", inverse, slope) * 2 / np.array(size)[None, :, None]
    n = len(N)
    dot = np.einsum("adq,bdq,q->ab", B, B, weight)
    outer = np.einsum("aiq,bjq,q->aibj", B, B, weight)
    K = lam * outer + mu * outer.transpose(0, 3, 2, 1)
    K += mu * np.einsum("ab,ij->aibj", dot, np.eye(3))
    M = np.einsum("aq,bq,q->ab", N, N, weight)
    if mass == "lumped":
        M = np.diag(np.diag(M)) * np.prod(size) / np.trace(M)
    return K.reshape(3 * n, 3 * n), M


def periodic_frequencies(element, size, poisson, mass, cells):
    """All frequencies of a periodic box of bricks."""
    K, M = element_matrices(element, size, poisson, mass)
    local = (places(element) + 1).astype(int)  # in half edges
    numbers = {}
    big, heavy = [], []
    for cell in itertools.product(*map(range, cells)):
        nodes = []
        for p in local:
            at = tuple((2 * np.array(cell) + p) % (2 * np.array(cells)))
            nodes.append(numbers.setdefault(at, len(numbers)))
        big.append(nodes)
    n = len(numbers)
    stiff, heavy = np.zeros((n, 3, n, 3)), np.zeros((n, n))
    per = len(local)
    for nodes in big:
        for a, b in itertools.product(range(per), repeat=2):
            stiff[nodes[a], :, nodes[b], :] += K.reshape(per, 3, per, 3)[a, :, b, :]
            heavy[nodes[a], nodes[b]] += M[a, b]
    L = np.linalg.inv(np.linalg.cholesky(np.kron(heavy, np.eye(3))))
    return np.sort(np.linalg.eigvalsh(L @ stiff.reshape(3 * n, 3 * n) @ L.T))


@pytest.mark.parametrize("mass", ["lumped", "consistent"])
@pytest.mark.parametrize("element, cells", [("hex8", (3, 4, 2)), ("hex20", (2, 3, 2))])
def test_all_waves_of_a_periodic_mesh(element, cells, mass):
    size, poisson = (1.0, 0.7, 1.3), 0.27
    wanted = periodic_frequencies(element, size, poisson, mass, cells)
    steps = [2 * np.pi * np.arange(n) / (n * h) for n, h in zip(cells, size)]
    wave = np.array(list(itertools.product(*steps)))
    got = ct.dispersion(wave, element, size, poisson, mass).omega_mesh ** 2
    assert got.size == wanted.size
    # Round-off of a dense eigenvalue problem.
    assert np.allclose(np.sort(got.ravel()), wanted, rtol=0, atol=1e-12 * wanted[-1])


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
@pytest.mark.parametrize("branch, direction", [(2, (1, 0, 0)), (2, (1, 1, 0)), (0, (1, 0, 0))])
def test_long_waves_of_hex20_with_lumped_mass(poisson, branch, direction):
    """ω ≈ c k (1 - ½ c² k² d·K₀⁺d / m): the errors of the masses move the families against each other
    (eq:hrz-phase)."""
    K, M = element_matrices("hex20", (1, 1, 1), poisson, "lumped")
    consistent = element_matrices("hex20", (1, 1, 1), poisson, "consistent")[1]
    family = np.array([0 if 0 not in p else 1 + p.index(0) for p in places("hex20").tolist()])
    polarization = np.array(direction) / np.linalg.norm(direction)
    if branch == 0:
        polarization = np.array([0.0, 1.0, 0.0])
    zero, wrong = np.zeros((4, 3, 4, 3)), np.zeros((4, 3))
    for a, b in itertools.product(range(20), repeat=2):
        zero[family[a], :, family[b], :] += K.reshape(20, 3, 20, 3)[a, :, b, :]
    for a in range(20):
        wrong[family[a]] += (M[a, a] - consistent[a].sum()) * polarization
    d = wrong.ravel()
    c2 = 1.0 if branch == 2 else 0.5 * (1 - 2 * poisson) / (1 - poisson)
    wanted = 0.5 * c2 * d @ np.linalg.pinv(zero.reshape(12, 12)) @ d
    k = np.array([0.02, 0.04])
    n = np.array(direction) / np.linalg.norm(direction)
    phase = ct.dispersion(k[:, None] * n, "hex20", poisson=poisson).phase[:, branch]
    first, second = (1 - phase / np.sqrt(c2)) / k**2
    assert (4 * first - second) / 3 == pytest.approx(wanted, rel=1e-4)


# -- The row of masses of the chapter --------------------------------------------------------------


@pytest.mark.parametrize("courant", [0.0, 0.125, 0.8])
def test_the_row_of_the_chapter(courant):
    """eq:dispersion-axis, eq:dispersion-leapfrog, eq:dispersion-axis-group: as the waves of bricks along an axis."""
    k = np.linspace(0.05, 3.1, 40)
    omega, group = chapter.row(k, courant)
    waves = ct.dispersion(k[:, None] * [1.0, 0.0, 0.0], courant=courant)
    assert np.allclose(omega, waves.omega[:, 2], rtol=0, atol=1e-12)
    assert np.allclose(group, waves.group[:, 2, 0], rtol=0, atol=1e-12)
    consistent = ct.dispersion(k[:, None] * [1.0, 0.0, 0.0], mass="consistent").omega[:, 2]
    assert np.allclose(chapter.row(k, consistent=True)[0], consistent, rtol=0, atol=1e-12)


def test_the_front_of_the_row():
    """eq:front-row-start, eq:front-row: as the sum of the waves of bricks."""
    place = np.linspace(0.0, 62.0, 125)
    for steps, courant in ((448, 0.125), (50, 0.8)):
        bricks = ct.dispersion_front(steps * courant, distance=place, courant=courant).stress
        assert np.allclose(chapter.row_front(place, steps, courant), bricks, rtol=0, atol=1e-11)


def test_the_front_of_long_waves():
    """eq:front-width, eq:front-airy, eq:dispersion-long: after 2000 elements the row is Airy's curve."""
    place = np.linspace(1980.0, 2010.0, 301)
    for steps, courant in ((4000, 0.5), (2500, 0.8)):
        row = chapter.row_front(place, steps, courant)
        # Terms of higher order in k shift the oscillations; they decrease with the cube root of the distance.
        assert np.allclose(chapter.long_front(place, courant, 2000.0), row, rtol=0, atol=0.02)


# -- Arrays and refusals ---------------------------------------------------------------------------


def test_arrays_keep_their_shape():
    wave = np.random.default_rng(1).uniform(-3, 3, (4, 2, 3))
    for element, nodes in (("hex8", 1), ("hex20", 4)):
        all_of = ct.dispersion(wave, element, courant=0.1)
        assert all_of.omega.shape == all_of.phase.shape == (4, 2, 3 * nodes)
        assert all_of.group.shape == (4, 2, 3 * nodes, 3)
        assert all_of.shape.shape == (4, 2, 3 * nodes, nodes, 3)
        one = ct.dispersion(wave[3, 1].tolist(), element, courant=0.1)
        assert np.array_equal(one.group, all_of.group[3, 1])
        assert np.array_equal(one.shape, all_of.shape[3, 1])
    none = ct.dispersion(np.empty((0, 3)))
    assert none.omega.shape == (0, 3)
    still = ct.dispersion([0, 0, 0])
    assert not still.omega.any() and np.isnan(still.phase).all() and np.isnan(still.group).all()


def test_parameter_of_the_integrator():
    k = [2.0, 0, 0]
    plain = ct.dispersion(k, courant=0.5).omega
    assert np.array_equal(
        ct.dispersion(k, courant=0.5, integrator="chung_lee", parameter=1.0).omega, plain
    )
    assert (ct.dispersion(k, courant=0.5, integrator="chung_lee").omega != plain).any()


def test_places_of_a_front():
    front = ct.dispersion_front(20.03, (2, 2, 0), size=(1.0, 1.0, 2.0), courant=0.5)
    assert np.allclose(np.diff(front.distance), 0.5**0.5) and front.distance[0] == 0.0
    assert front.time == 20.0  # 40 steps of one half: the nearest whole number
    same = ct.dispersion_front(20.0, (1, 1, 0), front.distance, size=(1.0, 1.0, 2.0), courant=0.5)
    assert np.allclose(front.stress, same.stress, rtol=0, atol=1e-12)
    line = ct.Front(np.array([0.0, 1.0, 2.0, 4.0]), np.array([1.0, 1.25, 0.75, 0.25]))
    assert line.half_height == pytest.approx(3.0) and line.overshoot == 0.25
    twice = ct.Front(line.distance, np.array([1.0, 0.25, 0.75, 0.25]))
    assert twice.half_height == pytest.approx(3.0)
    assert np.isnan(ct.Front(line.distance, np.zeros(4)).half_height)


def test_units_and_axes():
    """Bricks twice as long along x: ω_h = (2/2) sin(k), and the Courant number is that of the short edges."""
    for kx in (0.5, np.pi / 2):
        omega_mesh, omega = np.sin(kx), 4 * np.arcsin(0.25 * np.sin(kx))
        waves = ct.dispersion([kx, 0, 0], size=(2.0, 1.0, 1.0), courant=0.5)
        assert waves.omega_mesh[2] == pytest.approx(omega_mesh, rel=1e-12)
        assert waves.omega[2] == pytest.approx(omega, rel=1e-12)
        assert waves.phase[2] == pytest.approx(omega / kx, rel=1e-12)
    for axis in range(3):
        shape = ct.dispersion(1e-3 * np.eye(3)[axis], "hex20").shape[2]
        assert np.allclose(np.abs(shape), np.tile(np.eye(3)[axis], (4, 1)), rtol=0, atol=1e-5)


@pytest.mark.parametrize(
    "wrong, word",
    [
        ({"wave": [1.0, 2.0]}, "shape"),
        ({"wave": [np.nan, 0, 0]}, "nan"),
        ({"element": "tet4"}, "element"),
        ({"size": (1, 0, 1)}, "size"),
        ({"poisson": 0.5}, "poisson"),
        ({"mass": "row"}, "mass"),
        ({"integrator": "euler"}, "integrator"),
        ({"integrator": "chung_lee", "parameter": 2.0}, "beta"),
        ({"courant": -0.1}, "courant"),
    ],
)
def test_impossible_waves_are_refused(wrong, word):
    with pytest.raises(ValueError, match=word):
        ct.dispersion(**({"wave": [1, 0, 0]} | wrong))


@pytest.mark.parametrize(
    "wrong, word",
    [
        ({"normal": (0, 0, 0)}, "normal"),
        ({"normal": (1, 0.5, 0)}, "normal"),
        ({"normal": (17, 1, 0)}, "normal"),
        ({"time": -1.0}, "time"),
        ({"time": np.inf}, "time"),
        ({"time": 1e5}, "planes"),
        ({"distance": [[1.0]]}, "distance"),
        ({"distance": [2.0, 1.0]}, "distance must ascend"),
        ({"size": (0, 1, 1)}, r"size must be positive and finite, not 0\.0"),
        ({"courant": 1.01}, "above the stability limit of central_difference"),
        ({"courant": 0.98, "integrator": "tchamwa_wielgosz"}, "above the stability limit"),
        ({"time": 56.0, "courant": 0.99, "integrator": "chung_lee"}, "above the stability limit"),
        ({"courant": 0.8, "normal": (1, 1, 1), "element": "hex20"}, "above the stability limit"),
    ],
)
def test_impossible_fronts_are_refused(wrong, word):
    with pytest.raises(ValueError, match=word):
        ct.dispersion_front(**({"time": 10.0} | wrong))


def test_the_predictions_of_the_chapter_are_those_of_its_program():
    """eq:front-row, eq:dispersion-leapfrog: docs/theory/front.py prints what the page shows, and a run agrees."""
    program = Path(chapter.__file__).with_name("front.py")
    with contextlib.redirect_stdout(io.StringIO()) as told:
        runpy.run_path(str(program), run_name="__main__")
    assert told.getvalue() == program.with_suffix(".out").read_text(encoding="utf-8")
    front = chapter.column(courant=0.0625)
    assert f"{front.overshoot:.1%}" in told.getvalue().splitlines()[2]
