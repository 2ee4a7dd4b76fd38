"""A scene turned by any angle, and with its surfaces swapped."""

import numpy as np
import pytest
from libcontact.mesh import Mesh
from scenes import METRES, box_of

import libcontact as ct


def oblique(rotation, swapped=False):
    """Two blocks with unlike meshes that collide off their centres, all of it turned. No edge of one crosses an edge of
    the other, where the partner may change with the last bit."""
    made = ct.Scene(units=METRES)
    made.add_material("m", young=100.0, poisson=0.3, density=1.0, law="st_venant_kirchhoff")
    for name, origin, wide, n, speed in (
        ("low", [0, 0, 0], 1.0, [3, 3, 2], [0, 0, 0.4]),
        ("high", [0.1, 0.107, 1.05], 0.8137, [2, 2, 2], [0.1, 0, -0.4]),
    ):
        mesh = Mesh.box("hex8", *box_of(origin, [wide, wide, 1], n).values())
        made.add_body(
            name,
            material="m",
            nodes=mesh.nodes @ rotation.T,
            elements=mesh.elements,
            velocity=(rotation @ speed).tolist(),
        )
    pair = ("high.outer", "low.outer") if swapped else ("low.outer", "high.outer")
    made.add_contact(*pair)
    run = (
        made.set_time(end=0.5, dt=2e-3, force_tolerance=1e-12)
        .set_output(every=10**9)
        .run(progress=False)
    )
    return np.concatenate([run.state[b].displacement for b in ("low", "high")]), run


@pytest.mark.parametrize("seed", range(3))
def test_a_turned_scene(seed):
    """Turned by any angle about any axis, the displacements turn with it, to 1e-12 of the largest."""
    q, r = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    q *= np.sign(np.diag(r))
    q[:, 0] *= np.linalg.det(q)
    here, run = oblique(np.eye(3))
    there, _ = oblique(q)
    assert run.energy["strain"].max() > 0.05 * run.energy["kinetic"][0]
    assert np.abs(there - here @ q.T).max() < 1e-12 * np.abs(here).max()


def test_swapped_surfaces_have_the_same_bits():
    assert np.array_equal(oblique(np.eye(3))[0], oblique(np.eye(3), swapped=True)[0])
