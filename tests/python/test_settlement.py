"""MOOSE's case ``settlement`` of explicit contact: a soft block falls on a floor and comes to rest with damping
in proportion to stiffness, against the gold values of MOOSE (``gold/settlement_out.csv``)."""

import numpy as np
from scenes import METRES, box_of

import libcontact as ct

# Largest strain energy and its time; largest force after the first blow; both at the end of the run.
PEAK, PEAK_TIME, FORCE, LATE_ENERGY, LATE_FORCE = 0.38863, 0.0066, 1481.3, 0.15557, 978.63


def settlement(**damping):
    scene = ct.Scene(units=METRES)
    scene.add_material("soft", young=1e6, poisson=0.0, density=10.0)
    scene.add_material("stiff", young=1e10, poisson=0.0, density=1e6)
    scene.add_body("block", material="soft", box=box_of([4.5, 4.5, 1e-4], [1, 1, 1], [3, 3, 3]))
    scene.add_body("base", material="stiff", box=box_of([0, 0, -2], [10, 10, 2], [2, 2, 2]))
    scene.add_contact("block.z_min", "base.z_max")
    scene.add_support("block.z_max", fix="xy").add_support("base.z_min", fix="xyz")
    scene.add_support("base.z_max", fix="z")
    scene.add("gravity", acceleration=[0, 0, -98.1], bodies=["block"])
    if damping:
        scene.add("damping", **damping)
    scene.add_probe("force", resultant="contact", body="block")
    return scene.set_time(end=0.05, dt=1e-4).set_output(every=1)


def test_settlement_of_moose():
    """MOOSE stops the nodes that touch, and we have a penalty with a dashpot, so the two agree to 2 % only."""
    run = settlement(stiffness=1e-3).run(progress=False)
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
    run = settlement().run(progress=False)
    assert run.energy["strain"].max() > 1.5 * PEAK
