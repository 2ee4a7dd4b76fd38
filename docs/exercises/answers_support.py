"""Answers of the exercises of the chapter on supports."""

import sympy as sp


def test_support_wall(says):
    rho, length, c, v = 7800, 2.5e-3, 6020, 1.0
    impulse, time = 2 * rho * length * v, 2 * length / c
    assert abs(impulse / time - rho * c * v) < 1e-6
    says(f"{impulse:.1f}", f"{time * 1e6:.3f}", f"{impulse / time / 1e6:.1f}", "3.9·10⁻⁵")


def test_support_push(says):
    E, rho, A, V, c, x, t = sp.symbols("E rho A V c x t", positive=True)
    u = V * (t - x / c)  # behind the front
    kinetic = sp.integrate(rho * A * u.diff(t) ** 2 / 2, (x, 0, c * t))
    strain = sp.integrate(E * A * u.diff(x) ** 2 / 2, (x, 0, c * t)).subs(E, rho * c**2)
    work = rho * c * A * V * V * t
    assert sp.simplify(kinetic - strain) == 0 and sp.simplify(kinetic + strain - work) == 0
    says("Half")
