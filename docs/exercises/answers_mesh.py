"""Answers of the exercises of the chapter on meshes."""

import itertools

import numpy as np
import sympy as sp
from libcontact.mesh import Mesh


def test_mesh_counts(says):
    box = Mesh.box("hex8", [0, 0, 0], [10, 5, 2], [10, 5, 2])
    faces = sum(
        len(box.faces(side)[0]) for side in ("x_min", "x_max", "y_min", "y_max", "z_min", "z_max")
    )
    glued = faces * 2 - 2 * len(box.faces("z_max")[0])
    says(str(len(box.nodes)), str(3 * len(box.nodes)), str(faces), str(glued))


def test_mesh_midside(says):
    xi, m, h = sp.symbols("xi m h", positive=True)
    x = xi * (xi + 1) / 2 * h + (1 - xi**2) * m
    slope = sp.diff(x, xi)
    assert [sp.solve(slope.subs(xi, end), m)[0] / h for end in (-1, 1)] == [
        sp.Rational(1, 4),
        sp.Rational(3, 4),
    ]
    assert sp.expand(x.subs(m, h / 4) - h * ((1 + xi) / 2) ** 2) == 0
    says("1/4", "3/4")


def test_mesh_corner(says):
    a, x, y = sp.symbols("a x y")
    corners = [(-1, -1), (1, -1), (a, a), (-1, 1)]
    signs = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    place = sum(
        (sp.Matrix(c) * (1 + i * x) * (1 + j * y) / 4 for c, (i, j) in zip(corners, signs)),
        sp.zeros(2, 1),
    )
    det = sp.expand(place.jacobian([x, y]).det())
    assert sp.expand(det.subs({x: 1, y: 1}) - a) == 0 and det.subs({x: -1, y: -1}) == 1
    assert sp.Poly(det, x, y).total_degree() == 1
    gauss = det.subs({x: 1 / sp.sqrt(3), y: 1 / sp.sqrt(3)})
    assert sp.simplify(gauss - (1 + a) / 2 + (1 - a) / (2 * sp.sqrt(3))) == 0
    says(f"{float(sp.solve(gauss, a)[0]):.3f}")


def test_mesh_mirror(says):
    for n in (50, 200):
        i, h = np.arange(n + 1), 2.5 / n
        plain = (i * h)[::-1] != -(-2.5 + i * h)
        lattice = ((n - i) * 0.0 + i * 2.5) / n
        mirrored = ((n - i) * -2.5 + i * -0.0) / n
        assert not (lattice[::-1] != -mirrored).any()
        says(str(plain.sum()), str(n + 1))


def test_mesh_order(says, run):
    names, told = run()
    assert told == "volumes: [0. 0. 0. 0.]\n"
    corners = np.array(list(itertools.product((-1, 1), repeat=3)))
    signs = {np.sign(names["determinant"](names["brick"](0), c).round(9)) for c in corners}
    assert signs == {-1, 1}
    names, told = run(mend=True)
    assert told == "volumes: [1. 1. 1. 1.]\n"
    says("1")
