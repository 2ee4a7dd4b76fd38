"""Answers of the exercises of the chapter on two bars."""

import numpy as np
import sympy as sp
import week_bar as bar


def test_bar_steel(says):
    E, rho, L, v = 210e9, 7800.0, 0.2, 5.0
    c = np.sqrt(E / rho)
    stress = E * v / c  # the strain v/c, by Hooke's law
    says(f"{c:.0f}", f"{stress / 1e6:.0f}", f"{2e6 * L / c:.1f}", f"{stress / E * L * 1e3:.3f}")


def test_bar_density(says):
    """The conditions at the contact, and a run."""
    w, F = sp.symbols("w F")
    found = sp.solve([F - (1 - w), F - sp.sqrt(2) * (1 + w)], [w, F])
    force, velocity = float(found[F]), float(found[w])
    left, right = 1 - 2 * force, -1 + force
    says(f"{force:.4f}", f"{velocity:.4f}", f"{left:.3f}", f"{right:.4f}")

    names = dict(vars(bar))
    source = open(bar.__file__, encoding="utf-8").read()
    exec(source.replace("    u, v = np", "    mass[first:] *= 2\n    u, v = np"), names)
    times, _, forces, v = names["impact"](courant=0.7)
    assert abs(forces[(times > 0.2) & (times < 1.9)].mean() - force) < 0.002
    assert abs(times[forces > 0].max() - 2) < 0.05
    means = [part.mean() for part in np.split(v, 2)]
    assert np.abs(np.array(means) - [left, right]).max() < 0.005


def test_bar_consistent(says):
    """The largest eigenvalue of a long bar with the consistent mass."""
    n = 120
    K = 2 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    M = (4 * np.eye(n) + np.eye(n, k=1) + np.eye(n, k=-1)) / 6
    root = np.linalg.inv(np.linalg.cholesky(M))
    largest = np.linalg.eigvalsh(root @ K @ root.T).max()
    assert abs(2 / np.sqrt(largest) - 1 / np.sqrt(3)) < 4e-4
    says(f"{2 / np.sqrt(largest):.3f}")


def overlap(**options):
    """Largest overlap and largest stress of a run of the chapter's program."""
    _, stresses, forces, _ = bar.impact(courant=0.9, **options)
    return forces.max(), np.abs(stresses).max()


def test_bar_penalty(says):
    _, blown = overlap(controlled=False)
    assert 138 < blown < 139
    says("138")
    assert all(overlap(controlled=False, penalty=k)[1] < 10 for k in range(40, 51))
    assert all(overlap(controlled=False, penalty=k)[1] > 10 for k in (51, 70))
    h = 0.01
    # Chapter "stable": Co = sqrt(2 / (1 + sqrt(1 + 4 b²))), solved for the spring b = k h.
    b = sp.symbols("b", positive=True)
    limit = sp.nsolve(sp.sqrt(2 / (1 + sp.sqrt(1 + 4 * b**2))) - 0.9, b, 0.5)
    says("50", f"{float(limit):.3f}", f"{float(limit) / h:.1f}")
    soft = overlap(controlled=False, penalty=30)[0] / 30
    # The ramp's gap follows from its force: the gap of each step is the free one and W times the force.
    names = dict(vars(bar))
    source = open(bar.__file__, encoding="utf-8").read()
    exec(source.replace("before = gap\n", "before = gap; lowest.append(gap)\n"), names)
    names["lowest"] = []
    names["impact"](courant=0.9)
    says(f"{soft:.4f}", f"{soft / -min(names['lowest']):.1f}")


def test_bar_ends(says, run):
    names, told = run()
    assert "lowest stress -1.082, mean velocity of the right bar 0.9913" in told
    assert abs(names["mass"].sum() - 2.02) < 1e-12
    names, told = run(mend=True)
    assert "mean velocity of the right bar 0.9995" in told and abs(names["mass"].sum() - 2) < 1e-12
    says(f"{names['lowest']:.3f}", "2.02")


def test_bar_before(says, run):
    names, told = run()
    assert "lowest stress -1.971" in told and "kinetic energy 1.024" in told
    names, told = run(mend=True)
    energy = 0.5 * names["mass"] @ names["v"] ** 2
    assert energy < 1
    says(f"{names['lowest']:.3f}", f"{energy:.3f}")
