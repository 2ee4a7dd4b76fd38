"""Numbers that the chapters on bricks, masses and time steps take from their pictures (docs/figures/solid.py)."""

import runpy
from pathlib import Path

import numpy as np
import pytest

DRAWN = runpy.run_path(str(Path(__file__).resolve().parents[2] / "docs" / "figures" / "solid.py"))
NODES, moduli, stiffness = (DRAWN[name] for name in ("NODES", "moduli", "stiffness"))


@pytest.mark.parametrize(
    "kind, points, zero", [("hex8", 1, 18), ("hex8", 2, 6), ("hex20", 2, 12), ("hex20", 3, 6)]
)
def test_motions_without_energy(kind, points, zero):
    """The stiffness of a cube has as many zero eigenvalues as the page counts (eq:stiffness)."""
    w = np.linalg.eigvalsh(stiffness(kind, NODES[kind], points, moduli(1, 0.3)))
    assert (np.abs(w) < 1e-12).sum() == zero and w.min() > -1e-12


@pytest.mark.parametrize("r", [1, 4])
def test_hex8_is_too_stiff_in_bending(r):
    for kind, factor in (("hex8", 1 + r**2 / 2), ("hex20", 1)):
        nodes = NODES[kind] * [r, 1, 1]
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
