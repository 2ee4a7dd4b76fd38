"""Answers of the exercises of the chapter on two plates."""

import numpy as np
import pytest
import week_plates as plates

# Overlap at rest under the pressure of the plane wave, over h, with the penalty 4 E / h.
REST = plates.DENSITY * plates.C1 * plates.SPEED / (4 * plates.YOUNG)


def zeros(matrix):
    found = np.abs(np.linalg.eigvalsh(matrix))
    return int((found < 1e-12 * found.max()).sum())


def test_squares_modes(says):
    B = plates.strain_matrix(0.0, 0.0, 2.0)
    full, one = zeros(plates.stiffness(2.0)), zeros(B.T @ plates.ELASTIC @ B * 4)
    assert (full, one) == (3, 5)
    says(str(full), str(one))
    pattern = np.kron(plates.CORNERS.prod(axis=1), [1, 0])
    assert np.abs(B @ pattern).max() == 0 and pattern @ plates.stiffness(2.0) @ pattern > 0


def program(old, new):
    """The names of the chapter's program with one of its lines changed."""
    source = open(plates.__file__, encoding="utf-8").read()
    assert source.count(old) == 1
    names = {"__name__": "plates"}
    exec(source.replace(old, new), names)
    return names


def test_squares_plateau(says):
    nu = 0.25
    names = program("2.1e5, 0.3,", f"2.1e5, {nu},")
    row = names["centre_stress"](names["impact"](50)[1], 50)[:, 0, 0]
    says(f"{-(1 - nu) / nu:.0f}", f"{row[10:20].mean():.2f}")


def test_squares_predict(says):
    paper, reference = (
        np.abs(plates.centre_stress(plates.impact(50, **options)[1], 50)[..., 0]).max()
        for options in ({}, {"courant": 0.7, "wall": True})
    )
    says(f"{reference:.2f}", f"{paper:.2f}")
    steps = [round(0.56 * 50 / courant) for courant in (0.125, 0.7)]
    assert 5.5 < steps[0] / steps[1] < 6
    blown = plates.centre_stress(plates.impact(50, courant=0.7)[1], 50)
    says(f"{np.abs(blown[:4, 0, 0]).max():.0f}")
    deep, u = overlap(courant=0.7, beta=0.4)
    assert np.abs(plates.centre_stress(u[1], 50)[..., 0]).max() < 3 and 9 < deep < 12


def overlap(**options):
    """Deepest gap of all Gauss points of a run, over the overlap at rest with β = 4, and the displacements."""
    names = program(
        "        pressure = penalty *",
        "        gaps.append((one * gap[:-1] + other * gap[1:]).min())\n        pressure = penalty *",
    )
    names["gaps"] = gaps = []
    u = names["impact"](50, **options)
    return -min(gaps) / (REST * plates.D / 50), u


def test_squares_overlap(says):
    says(f"{REST * 1e5:.2f}", f"{overlap()[0]:.2f}")


def test_squares_ramp(says):
    """The program with the ramp at the nodes."""
    old = "        f[:, face, 0] += push(u[0, face, 0] + u[1, face, 0], beta * YOUNG / h, h)\n"
    new = """        gap = u[0, face, 0] + u[1, face, 0]
        free = gap + dt * (v + dt * f / mass[:, None])[:, face, 0].sum(axis=0)
        k = beta * YOUNG * np.r_[0.5, np.ones(cells - 1), 0.5]
        before = gap if n == 0 else old
        f[:, face, 0] += np.maximum(0, -free - np.minimum(before, 0)) / (2 / k + 2 * dt**2 / mass[face])
        old = gap
"""
    names = program(old, new)
    largest = [
        np.abs(names["centre_stress"](names["impact"](50, courant=c)[1], 50)).max()
        for c in (0.95, 0.99, 1.02)
    ]
    assert max(largest[:2]) < 4 and largest[2] > 1000
    says("0.95", "0.99", "1.02", "1000")


def test_squares_push(says, run):
    names, told = run()
    gap = names["gap"]
    wrong = np.abs(names["push"](gap, 1.0, 1.0) / names["exact"] - 1).max()
    assert f"{wrong:.0%}" == "40%"
    assert names["push"](-np.ones(4), 1.0, 1.0) == pytest.approx([0.5, 1, 1, 0.5])
    names, _ = run(mend=True)
    assert names["push"](gap, 1.0, 1.0) == pytest.approx(names["exact"], rel=1e-7)
    assert names["push"](-np.ones(4), 1.0, 1.0) == pytest.approx([0.5, 1, 1, 0.5])
    says("Gauss")
