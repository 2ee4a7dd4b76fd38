"""Answers of the exercises of the chapter on energy."""

import numpy as np
import sympy as sp


def test_energy_third(says):
    u, v = sp.Integer(1), sp.Rational(1, 2)
    rows = []
    for _ in range(4):
        after = v - u
        rows.append((v * after / 2, u**2 / 2, ((v + after) / 2) ** 2 / 2 + u**2 / 2))
        v, u = after, u + after
    assert [row[:2] for row in rows[2:]] == [
        (sp.Rational(1, 4), sp.Rational(1, 8)),
        (-sp.Rational(1, 8), sp.Rational(1, 2)),
    ]
    says(f"{float(rows[2][2]):.3f}", f"{float(rows[3][2]):.1f}", given=(str(sum(rows[2][:2])),))


def test_energy_negative(says):
    for x in (0.2, 1.0, 2.0):
        half = x * x / 2  # v before and after the turning point at u = 1, in units of 1/dt
        says(f"{100 * (-half * half / 2) / (x * x / 2):.0f} %")


def energies(elements, courant, penalty, controlled=True, end=4):
    """Total energy of each step of two bars that collide; the program of Part I with its balance."""
    import week_wall as wall

    h = 1 / elements
    dt = courant * h
    last, first = elements, elements + 1
    mass = np.full(2 * elements + 2, h)
    mass[[0, last, first, -1]] /= 2
    u, v = np.zeros_like(mass), np.repeat([1.0, -1.0], elements + 1)
    W, before, found = 2 * dt**2 / (h / 2), 0.0, []
    for _ in range(round(end / dt)):
        stress = np.diff(u) / h
        stress[last] = 0
        force = np.diff(stress, prepend=0, append=0)
        free = u + dt * (v + dt * force / mass)
        gap = u[first] - u[last]
        if controlled:
            contact = wall.ramp(free[first] - free[last], before, W, penalty)
        else:
            contact = penalty * max(0.0, -gap)
        before = gap
        force[last] -= contact
        force[first] += contact
        after = v + dt * force / mass
        held = 0.0 if controlled else penalty * min(gap, 0) ** 2 / 2
        found.append(mass @ (v * after) / 2 + h * stress @ stress / 2 + held)
        v, u = after, u + dt * after
    return np.array(found)


def test_energy_layer(says):
    losses = [1 - energies(n, 0.5, 40 * n)[-1] for n in (10, 20, 40)]
    for n, loss in zip((10, 20, 40), losses):
        assert abs(loss * 2 * n - 1) < 0.05
    others = [1 - energies(10, courant, 400)[-1] for courant in (0.9, 0.1)]
    says(*(f"{loss:.1%}".replace("%", " %") for loss in losses + others))


def test_energy_entry(says):
    s = sp.symbols("s")
    loss = s * (1 - s)  # of ½ k v² Δt²; over ½ m v² with ω²Δt²
    mean, most = sp.integrate(loss, (s, 0, 1)), loss.subs(s, sp.Rational(1, 2))
    says(*(f"{float(part) * 9:.3g} %" for part in (mean, most)))


def test_energy_velocity(says, run):
    names, _ = run()
    found = names["energies"]()
    assert abs(found.max() - 0.5) < 1e-12 and found.min() > 0.4
    assert abs(found.max() / found.min() - 1.23) < 0.01
    names, _ = run(mend=True)
    assert np.abs(names["energies"]() - 0.375).max() < 1e-15
    says("0.375")
