"""A few of the random bodies of :file:`tests/fuzz/open_scenes.py`: contact between parts of skins, and stiff penalties
between closed ones."""

import pytest

open_scenes = pytest.importorskip("open_scenes")


@pytest.mark.parametrize("seed", [2, 4, 7, 8])
def test_bodies_gain_nothing_over_an_open_border(seed):
    found = open_scenes.one("scenes", seed)
    assert found["ended"] == "ok"
    assert found["growth"] <= open_scenes.ALLOWED and found["booked"] <= open_scenes.ALLOWED


def test_a_corner_that_passes_beside_all_points_is_reported():
    """A corner of one side enters the other side between its points: no force, no gain, but a warning that names the
    skins."""
    found = open_scenes.one("scenes", 1023)
    assert found["ended"] == "ok" and "border" in found["told"]


def test_what_a_stiff_contact_stores_is_no_growth():
    """A penalty factor of 4e5 on unlike closed meshes: the booked total rose by 31 %, and the run warned of growth,
    while the bodies had gained nothing (eq:admitted-account)."""
    found = open_scenes.one("stiff", 138)
    assert found["ended"] == "ok" and "energy_growth" not in found["told"]
    assert found["growth"] <= open_scenes.ALLOWED and found["booked"] <= open_scenes.ALLOWED
