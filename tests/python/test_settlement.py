"""MOOSE's case ``settlement`` of explicit contact: a soft block falls on a floor and comes to rest with damping
in proportion to stiffness, against the gold values of MOOSE (``gold/settlement_out.csv``)."""

import tomllib
from pathlib import Path

import numpy as np

import libcontact as ct

# Largest strain energy and its time; largest force after the first blow; both at the end of the run.
PEAK, PEAK_TIME, FORCE, LATE_ENERGY, LATE_FORCE = 0.38863, 0.0066, 1481.3, 0.15557, 978.63


def settlement():
    """The tables of the scene of the page."""
    path = Path(__file__).parents[2] / "docs" / "benchmarks" / "settlement.toml"
    return tomllib.loads(path.read_text(encoding="utf-8"))


def test_settlement_of_moose():
    """MOOSE stops the nodes that touch, and we have a penalty with a dashpot, so the two agree to 2 % only."""
    run = ct.Scene(settlement()).run()
    strain, force = run.energy["strain"], run.probes["force"]["force"][:, 2]
    first = np.argmax(strain)
    assert abs(run.energy["time"][first] - PEAK_TIME) <= 1.01e-4
    np.testing.assert_allclose(strain[first], PEAK, rtol=0.02)
    np.testing.assert_allclose(force[run.probes["force"]["time"] > 0.003].max(), FORCE, rtol=0.02)
    np.testing.assert_allclose(strain[-1], LATE_ENERGY, rtol=0.005)
    np.testing.assert_allclose(force[-1], LATE_FORCE, rtol=0.002)
    assert run.energy["damping"][-1] < 0
    np.testing.assert_allclose(run.energy["total"], run.energy["total"][0], atol=2e-4)


def test_settlement_without_damping_is_another_motion():
    data = settlement()
    del data["damping"]
    run = ct.Scene(data).run()
    assert run.energy["strain"].max() > 1.5 * PEAK
