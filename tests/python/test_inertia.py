"""The inertia of lumped masses, as ``explain`` prints it."""

import numpy as np
import pytest
from scenes import box_of, scene_with


@pytest.mark.parametrize("element, a", [("hex8", 2.0), ("hex20", 38 / 31)])
@pytest.mark.parametrize("cells", [[1, 1, 1], [3, 2, 1], [4, 5, 6]])
def test_explain_prints_the_ratio(element, a, cells):
    """The closed form of boxes (eq:lumped-inertia)."""
    size = np.array([3.0, 2.0, 1.0])
    scene = scene_with("m", young=1e4, poisson=0.3, density=1.0)
    scene.add_body("box", material="m", element=element, box=box_of([0, 0, 0], size, cells))
    told = scene.set_time(end=0.1, fraction=0.5).explain()
    second, lumped = size**2 / 12, size**2 / 12 * (1 + a / np.array(cells) ** 2)
    want = (lumped.sum() - lumped) / (second.sum() - second)
    np.testing.assert_allclose(told.data["bodies"][0]["inertia"], want, rtol=1e-12)
    assert "inertia of these masses over that of the body" in told
