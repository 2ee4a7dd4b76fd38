"""Stand-ins for other builds of the C library."""

from libcontact.checks import warned

import libcontact as ct
from libcontact import loop


def leave_out_hdf5(monkeypatch):
    """Make runs and warnings behave as in a build without HDF5."""
    for module in (loop, warned):
        monkeypatch.setattr(module, "has", lambda part: part != "hdf5" and ct.has(part))
