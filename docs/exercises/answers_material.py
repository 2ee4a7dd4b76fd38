"""Answers of the exercises of the chapter on materials, by the compliance of Hooke's law."""

import numpy as np
import pytest


def speeds(E, nu, rho):
    """Of a plane wave along x, from the inverse of the compliance matrix."""
    compliance = (np.eye(3) * (1 + nu) - nu) / E
    return np.sqrt(np.linalg.inv(compliance)[0, 0] / rho), np.sqrt(E / (2 * (1 + nu)) / rho)


def test_material_aluminium(says):
    c1, c2 = speeds(70e9, 0.33, 2700)
    says(f"{c1**2 * 2700 / 1e9:.1f}", f"{c2**2 * 2700 / 1e9:.1f}", f"{c1:.0f}", f"{c2:.0f}")
    says(f"{2700 * c1 * 10 / 1e6:.0f}", f"{7800 * speeds(210e9, 0.3, 7800)[0] * 10 / 1e6:.0f}")


def test_material_quarter(says):
    c1, c2 = speeds(1.0, 0.25, 1.0)
    assert c1**2 - 2 * c2**2 == pytest.approx(c2**2)  # Λ = μ
    c1_0, c2_0 = speeds(1.0, 0.0, 1.0)
    assert c1_0 / c2_0 == pytest.approx(np.sqrt(2)) and c1_0 == pytest.approx(1)
    says(f"{c1 / c2:.3f}")


def test_material_rubber(says):
    E, K, rho = 3e6, 2e9, 1000
    nu = 0.5 - E / (6 * K)
    assert np.ones(3) @ np.linalg.inv((np.eye(3) * (1 + nu) - nu) / E) @ np.ones(3) / 9 == (
        pytest.approx(K)
    )
    c1, c2 = speeds(E, nu, rho)
    thick = c2 * 1e-3
    step = 0.9 * thick / 10 / c1
    says(f"{nu:.5f}", f"{c1:.0f}", f"{c2:.1f}", f"{step * 1e6:.2f}", f"{1e-3 / step:.0f}")
    c1, c2 = speeds(E, 0.3, rho)
    says(str(int(np.ceil(1e-3 / (0.9 * c2 * 1e-3 / 10 / c1)))), given=(f"{c1 / c2:.2f}",))


def test_material_incompressible(says):
    moduli = [speeds(1.0, nu, 1.0)[0] ** 2 for nu in (0.3, 0.49, 0.499)]
    says(f"{moduli[0]:.3f}", f"{moduli[1]:.2f}", f"{moduli[2]:.1f}")
    says(*(f"{np.sqrt(b / a):.2f}" for a, b in zip(moduli, moduli[1:])))


def test_material_plane_stress(says, run):
    names, _ = run()
    right = speeds(210e9, 0.3, 7800)
    assert f"{1 - names['c1'] / right[0]:.1%}" == "9.6%" and names["c2"] == pytest.approx(right[1])
    first, shear = names["lame"](1.0, 0.3)
    says(f"{first / (2 * (first + shear)):.3f}")
    names, _ = run(mend=True)
    assert names["c1"] == pytest.approx(right[0])
    says(f"{names['c1']:.0f}")
