"""Numbers that the chapters on bricks, masses and time steps take from their pictures (docs/figures)."""

import runpy
from pathlib import Path

import numpy as np
import pytest
from libcontact.loop import default_interval
from shared.bricks import BRICKS, moduli, stiffness

FIGURES = Path(__file__).resolve().parents[2] / "docs" / "figures"
DRAWN = runpy.run_path(str(FIGURES / "solid.py"))


@pytest.mark.parametrize(
    "kind, points, zero", [("hex8", 1, 18), ("hex8", 2, 6), ("hex20", 2, 12), ("hex20", 3, 6)]
)
def test_motions_without_energy(kind, points, zero):
    """The stiffness of a cube has as many zero eigenvalues as the page counts (eq:stiffness)."""
    w = np.linalg.eigvalsh(stiffness(kind, BRICKS[kind], points, moduli(1, 0.3)))
    assert (np.abs(w) < 1e-12).sum() == zero and w.min() > -1e-12


@pytest.mark.parametrize("r", [1, 4])
def test_hex8_is_too_stiff_in_bending(r):
    for kind, factor in (("hex8", 1 + r**2 / 2), ("hex20", 1)):
        nodes = BRICKS[kind] * [r, 1, 1]
        u = np.column_stack(
            [-nodes[:, 0] * nodes[:, 1], nodes[:, 0] ** 2 / 2, 0 * nodes[:, 0]]
        ).ravel()
        energy = u @ stiffness(kind, nodes, 3, moduli()) @ u / 2
        assert energy == pytest.approx(factor * r * 8 / 3 / 2)


def test_orders_of_the_stress():
    for kind, gauss, centre in (("hex8", 1.0, 2.0), ("hex20", 2.0, 2.0)):
        coarse, fine = DRAWN["solved"](kind, 2), DRAWN["solved"](kind, 4)
        assert np.log2(coarse["Gauss points"] / fine["Gauss points"]) == pytest.approx(
            gauss, abs=0.2
        )
        assert np.log2(coarse["centre"] / fine["centre"]) == pytest.approx(centre, abs=0.2)
        if kind == "hex8":
            assert fine["Gauss points"] == pytest.approx(0.11, abs=0.005)
            assert fine["centre"] == pytest.approx(0.011, abs=0.0005)


@pytest.mark.parametrize(
    "steps, nodes, records",
    [
        (10, 1000, 10),
        (400, 10**5, 100),
        (400, 10**8, 10),
        (40, 10**6, 10),
        (10**6, 10**6, 100),
        (10**6, 5 * 10**6, 20),
    ],
)
def test_records_where_a_scene_names_none(steps, nodes, records):
    """min(100, max(S / 4, 10⁶ / N), max(10, 10⁸ / N)) records (eq:default-records), here by hand."""
    assert steps / default_interval(steps, nodes) == pytest.approx(records, rel=0.01)


def test_growth_beyond_the_limit():
    """At ωΔt = 2.05 a step multiplies the motion by 1.56 (eq:stability-limit), and 20 steps by 7500."""
    growth = np.abs(np.roots([1, -(2 - 2.05**2), 1])).max()
    assert growth == pytest.approx(1.56, abs=0.005) and growth**20 == pytest.approx(7500, rel=0.01)


def test_a_large_step_by_hand():
    """The mass on a spring of the chapters step and energy: back after six steps (eq:step-oscillator), with a constant
    energy."""
    u, v, energies = [1.0], [0.5], []
    for _ in range(6):
        v.append(v[-1] - u[-1])
        energies.append((v[-2] * v[-1] + u[-1] ** 2) / 2)
        u.append(u[-1] + v[-1])
    assert u == [1, 0.5, -0.5, -1, -0.5, 0.5, 1] and energies == [0.375] * 6


def test_orders_of_a_plain_sum_and_of_the_grids():
    runpy.run_path(str(FIGURES / "sum.py"))[
        "orders"
    ]()  # asserts that all orders have the same bits
