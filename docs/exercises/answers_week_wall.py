"""Answers of the exercises of the chapter on the wall."""

import numpy as np
import sympy as sp
import week_wall as wall


def test_wall_depth(says):
    t, k, v = sp.symbols("t k v", positive=True)
    g = sp.Function("g")
    motion = sp.dsolve(
        g(t).diff(t, 2) + k * g(t), g(t), ics={g(0): 0, g(t).diff(t).subs(t, 0): -v}
    ).rhs
    ends = sp.solve(sp.sin(sp.sqrt(k) * t), t)[0]  # the first zero after the start
    values = {k: 10**4, v: 1}
    depth = -motion.subs(t, ends / 2).subs(values)
    says(f"{float(depth):.2f}", f"{float(ends.subs(values)):.4f}")
    assert sp.solve(sp.Eq(2 * motion.subs(t, ends / 2).subs(v, 1), -1 / sp.sqrt(25)), k) == [100]
    says("4")


def test_wall_predict(says):
    soft, stiff = (wall.bounce(k, dt)[0].min() for k, dt in ((1e2, 0.01), (1e4, 0.001)))
    assert abs(soft / stiff - 10) < 0.02
    plain, controlled = (wall.bounce(100.0, 0.25, controlled=c)[1][-1] for c in (False, True))
    assert plain == -1 + 100 * 0.25 * 0.25
    says(f"{plain:.2f}", f"{controlled:.3f}")


def test_wall_exact(says):
    steps = [2 * np.sin(np.pi / (2 * n)) for n in (2, 3, 5)]
    for step in steps:
        assert np.abs(wall.rebound(step) - 1).max() < 1e-12
    says(*(f"{step:.3f}" for step in steps[::2]), given=(f"{steps[1]:.3f}",))


def test_wall_gain(says):
    """Speeds after the impact, of starts that lie between two steps."""
    largest = [wall.rebound(step, samples=300).max() for step in np.arange(0.02, 0.2975, 0.005)]
    assert max(largest[:-1]) < 1.01 < largest[-1]
    gap, v, dt, k = sp.symbols("g v dt k", positive=True)
    surplus = k * gap * (v * dt - gap) / 2
    most = surplus.subs(gap, sp.solve(sp.diff(surplus, gap), gap)[0])
    assert sp.simplify(most / (v**2 / 2) - k * dt**2 / 4) == 0
    says("0.29", f"{float(sp.sqrt(sp.Rational(8, 100))):.3f}")


def test_wall_ramp(says, run):
    names, _ = run()
    starts = np.linspace(0, 1, 400)
    gains = [max(names["rebound"](h, 1 + h * part) for part in starts) - 1 for h in (0.5, 1.0)]
    assert [f"{gain:.1%}" for gain in gains] == ["2.8%", "7.4%"]
    names, _ = run(mend=True)
    rebounds = [names["rebound"](0.5, 1 + 0.5 * part) for part in starts]
    assert max(rebounds) < 1
    says(f"{max(rebounds):.3f}")


def test_wall_rigid(says):
    gaps, velocities = wall.bounce(1e15, 0.1, gap=0.33, controlled=True)
    first = int(np.argmax(gaps < 1e-9))
    assert np.abs(gaps[first : first + 2]).max() < 1e-12 and abs(velocities[-1]) < 1e-10
    says("0", "1 %")
