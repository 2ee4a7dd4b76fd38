"""Answers of the exercises of the chapter on the impact of plates."""

import numpy as np
import sympy as sp

import libcontact as ct


def test_plates_units(says):
    for E, nu, rho, v, d in ((70e9, 0.33, 2700, 2, 5e-3), (210e9, 0.3, 7800, 1, 2.5e-3)):
        c1 = np.sqrt(E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / rho)
        says(f"{rho * c1 * v / 1e6:.1f}", f"{0.56 * d / c1 * 1e6:.3f}", f"{-(1 - nu) / nu:.2f}")


def test_plates_rayleigh(says):
    chi = sp.symbols("chi")
    c22 = sp.Rational(1, 3)
    roots = sp.solve(chi**3 - 8 * chi**2 + (24 - 16 * c22) * chi - 16 * (1 - c22), chi)
    small = [root for root in roots if root < 1]
    assert len(small) == 1 and sp.simplify(small[0] - 2 + 2 / sp.sqrt(3)) == 0
    speed = float(sp.sqrt(small[0]))
    library = ct.exact.speeds(0.25)
    assert abs(library.c_r / library.c2 - speed) < 1e-12
    says(f"{float(small[0]):.3f}", f"{speed:.4f}", f"{np.degrees(np.arcsin(library.c2)):.1f}")


def first_shear(x, depth, c2):
    """Shortest time of all ways along the face with c1 = 1 and then with c2."""
    along = np.linspace(0, x, 20_001)
    return (along + np.hypot(x - along, depth) / c2).min()


def test_plates_arrivals(says):
    c2 = ct.exact.speeds(0.3).c2
    says(
        *(
            f"{t:.3f}"
            for t in (np.hypot(0.8, 0.2), first_shear(0.8, 0.2, c2), np.hypot(0.8, 0.2) / c2)
        )
    )
    says(f"{np.hypot(0.8, 0.8):.3f}", f"{np.hypot(0.8, 1.2):.3f}")
    says(f"{first_shear(0.8, 0.8, c2):.3f}", f"{np.hypot(0.8, 0.8) / c2:.3f}")


def test_plates_touch(says):
    c2 = ct.exact.speeds(0.3).c2
    says(f"{np.sqrt(1 - c2**2) / c2:.2f}", "0.25", "2.25")
    assert first_shear(0.8, 0.2, c2) < np.hypot(0.8, 0.2) / c2 - 0.1
    assert abs(first_shear(0.4, 0.9, c2) - np.hypot(0.4, 0.9) / c2) < 1e-12


def test_plates_fig5(says):
    """The stresses of the library: unchanged up to the P circle, a kink of their slope at the head wave."""
    z = np.linspace(0, 0.999, 4000)
    stress = ct.exact.plates(0.4, z, 0.56, nu=0.2).stress.sigma_z
    front = z[np.argmax(np.abs(stress + 1) > 1e-9)]
    kink = z[1:-1][np.abs(np.diff(stress, 2))[z[1:-1] > 0.7].argmax() + (z[1:-1] <= 0.7).sum()]
    c2 = ct.exact.speeds(0.2).c2
    says(f"{c2:.4f}", f"{c2 * 0.56:.3f}", f"{1 - 0.16 / np.sqrt(1 / c2**2 - 1):.4f}", "-4")
    assert abs(front - 0.6081) < 1e-3 and abs(kink - 0.8761) < 2e-3
    says(given=("0.6081",))


def test_plates_head(says, run):
    names, told = run()
    assert "1.184" in told and first_shear(0.8, 0.2, ct.exact.speeds(0.3).c2) < 1.17
    names, told = run(mend=True)
    c2 = ct.exact.speeds(0.3).c2
    for x, depth in ((0.8, 0.2), (1.1, 0.4)):
        assert abs(names["arrivals"](x, depth)[1] - first_shear(x, depth, c2)) < 1e-7
    says(f"{names['arrivals'](0.8, 0.2)[1]:.3f}")
