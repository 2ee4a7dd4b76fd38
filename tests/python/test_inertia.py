"""The inertia of lumped masses: what ``explain`` prints, and how a body turns."""

import numpy as np
import pytest
from scenes import METRES, box_of

import libcontact as ct


def box(size, cells, element="hex8", **keys):
    scene = ct.Scene(units=METRES)
    scene.add_material("m", young=1e4, poisson=0.3, density=1.0, law="st_venant_kirchhoff")
    middle = [-0.5 * length for length in size]
    return scene.add_body(
        "box", material="m", element=element, box=box_of(middle, size, cells), **keys
    )


@pytest.mark.parametrize("element, a", [("hex8", 2.0), ("hex20", 38 / 31)])
@pytest.mark.parametrize("cells", [[1, 1, 1], [3, 2, 1], [4, 5, 6]])
def test_explain_prints_the_ratio(element, a, cells):
    """The closed form of boxes (eq:lumped-inertia)."""
    size = np.array([3.0, 2.0, 1.0])
    told = box(size.tolist(), cells, element).set_time(end=0.1, fraction=0.5).explain()
    second, lumped = size**2 / 12, size**2 / 12 * (1 + a / np.array(cells) ** 2)
    want = (lumped.sum() - lumped) / (second.sum() - second)
    np.testing.assert_allclose(told.data["bodies"][0]["inertia"], want, rtol=1e-12)
    assert "inertia of these masses over that of the body" in told


def test_a_box_precesses_with_the_inertia_of_its_masses():
    """A square prism in flight: its axis turns about the angular momentum L by L t / I, with the moment I across
    the axis. The prism is stiff, and rotation stretches it by 1e-4 only."""
    tilt, rate = 0.4, 0.4
    axis, size, cells = [np.sin(tilt), 0, np.cos(tilt)], [1.0, 1.0, 2.0], [1, 1, 2]
    scene = box(size, cells, spin={"axis": axis, "rate": rate})
    run = scene.set_time(end=8.0, fraction=0.9).run()
    L = run.momentum["L"][-1]
    np.testing.assert_allclose(L, run.momentum["L"][0], atol=1e-12)
    across, along = (3 * 1 + 1.5 * 4) / 12 * 2, 2 * 3 / 12 * 2
    np.testing.assert_allclose(
        L, rate * np.array([across * axis[0], 0, along * axis[2]]), rtol=1e-3, atol=1e-9
    )
    body = run.state["box"]
    ends = [body.positions[body.mesh.face_nodes(face)].mean(axis=0) for face in ("z_min", "z_max")]
    n = L / np.linalg.norm(L)
    now, before = ends[1] - ends[0], np.array([0, 0, 1.0])
    now, before = (v - n * (v @ n) for v in (now, before))
    angle = np.arctan2(np.cross(before, now) @ n, before @ now)
    turned = np.linalg.norm(L) * run.time[-1] / across
    assert (angle - turned + np.pi) % (2 * np.pi) - np.pi == pytest.approx(0, abs=2e-3)
    exact = np.linalg.norm(L) * run.time[-1] / (5 / 12 * 2)
    assert abs(exact - turned) > 0.5
