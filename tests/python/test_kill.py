"""A few of the runs of ``make kill``."""

import pytest

import libcontact as ct

kill = pytest.importorskip("kill")


@pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")
def test_runs_that_are_killed_while_they_write_go_on_to_the_same_bits(tmp_path):
    counts = kill.kill_campaign(8, folder=tmp_path)
    assert counts.pop("good") == 8
    assert set(counts) <= {"early", "late"}, counts
