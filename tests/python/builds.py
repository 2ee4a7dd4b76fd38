"""Other builds of the C library, for tests of this one."""

from libcontact._core import lib

from libcontact import loop, warned


class WithoutHdf5:
    """The C library of a build without HDF5."""

    def __getattr__(self, name):
        if name.startswith("ct_output"):
            raise AttributeError(name)
        return getattr(lib, name)


def leave_out_hdf5(monkeypatch):
    """Let runs and warnings see a build without HDF5."""
    for module in (loop, warned):
        monkeypatch.setattr(module, "lib", WithoutHdf5())
