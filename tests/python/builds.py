"""Other builds of the C library, for tests of this one."""

import libcontact as ct
from libcontact import loop, warned


def leave_out_hdf5(monkeypatch):
    """Let runs and warnings see a build without HDF5."""
    for module in (loop, warned):
        monkeypatch.setattr(module, "has", lambda part: part != "hdf5" and ct.has(part))
