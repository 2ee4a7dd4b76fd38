"""Answers of the exercises of the chapter on bricks and their forces."""

import numpy as np
import pytest
import sympy as sp
import week_plates as plates

NU = sp.Rational(3, 10)
MU = 1 / (2 * (1 + NU))
LAMBDA = NU / ((1 + NU) * (1 - 2 * NU))


def test_solid_square(says):
    """The energy of the element, by the matrix of the chapter on plates, against that of the bent strip."""
    corners = plates.CORNERS
    u = np.column_stack([-corners.prod(axis=1), 0 * corners[:, 0]]).ravel()
    energy = u @ plates.stiffness(2.0) @ u / 2 / plates.YOUNG
    x, z = sp.symbols("x z")
    true = 1 / (1 - NU**2)
    strip = float(sp.integrate(true * z**2 / 2, (x, -1, 1), (z, -1, 1)))
    parts = [float(v) for v in (true, LAMBDA + 2 * MU, MU)]
    says(f"{parts[0]:.4f}", f"{parts[1]:.3f}", f"{parts[2]:.3f}", f"{energy / strip:.3f}")
    says(f"{parts[1] / parts[0]:.3f}", f"{parts[2] / parts[0]:.2f}")


def test_solid_layers(says):
    """The assembled energy of a bent plate of four layers, from the chapter's matrix with ν = 0."""
    x, z, length, T = sp.symbols("x z l T", positive=True)
    shear = sp.integrate(x**2 / 4, (x, -length / 2, length / 2), (z, -T / 2, T / 2))
    bending = sp.integrate(z**2 / 2, (x, -length / 2, length / 2), (z, -T / 2, T / 2))
    assert sp.simplify(shear / bending - (length / T) ** 2 / 2) == 0
    says(str(int(np.ceil(np.sqrt(50)))))


def test_solid_turn(says):
    E, nu = 210e3, 0.3
    mu, first = E / 2.6, E * nu / 0.52
    for degrees in (1, 5):
        phi = np.radians(degrees)
        gradient = np.array([[np.cos(phi), -np.sin(phi)], [np.sin(phi), np.cos(phi)]]) - np.eye(2)
        strain = (gradient + gradient.T) / 2
        stress = first * np.trace(strain) + 2 * mu * strain[0, 0]
        if degrees == 1:
            says(f"{strain[0, 0] * 1e4:.2f}·10⁻⁴", f"{stress:.1f}")
    says(f"{stress:.0f}", f"{np.degrees(np.arccos(1 - 1 / (2 * (first + mu)))):.2f}")


def test_solid_eigenvalues(says):
    found, vectors = np.linalg.eigh(plates.stiffness(1.0) / plates.YOUNG)
    assert np.abs(found[:3]).max() < 1e-12
    says(*(f"{v:.3f}" for v in found[[3, 5, 7]]))
    assert found[5] == pytest.approx(float(2 * MU))
    assert found[7] == pytest.approx(float(2 * (LAMBDA + MU)))
    area = plates.CORNERS.ravel() / np.sqrt(8)
    assert abs(vectors[:, 7] @ area) == pytest.approx(1)


def test_solid_shear(says, run):
    names, told = run()
    assert "symmetric: True" in told
    assert names["K"] @ np.tile([1, 0], 4) == pytest.approx(np.zeros(8), abs=1e-14)
    found = np.linalg.eigvalsh(names["K"])
    assert np.isclose(found, 1.538, atol=1e-3).sum() == 1
    assert np.isclose(found, 0.769, atol=1e-3).sum() == 1
    assert np.isclose(found, 0.705, atol=1e-3).sum() == 2
    names, _ = run(mend=True)
    assert names["K"] == pytest.approx(plates.stiffness(1.0) / plates.YOUNG)
    sheared = np.column_stack([plates.CORNERS[:, 1] / 2, np.zeros(4)]).ravel()
    assert sheared @ names["K"] @ sheared / 2 == pytest.approx(float(MU) / 2)
    says(r"\tfrac12\mu\gamma^2h^2")
