"""The HDF5 with which the C library writes and reads files: built in, or the one that h5py has loaded."""

from __future__ import annotations

import contextlib
import ctypes
from functools import cache
from typing import Any

from ._core import ffi, lib

# What to do in a build without HDF5.
ADVICE = "pip install h5py (with HDF5 1.14 or newer), which brings it"


@cache
def lock() -> contextlib.AbstractContextManager[Any] | None:
    """What a thread holds during a call of HDF5, whose copy in h5py is not made for several; None without HDF5."""
    if lib.ct_output_close(ffi.NULL, ffi.NULL) != lib.CT_ERROR_UNSUPPORTED:
        return contextlib.nullcontext()
    try:
        from h5py import _objects, h5f
    except ImportError:
        return None
    # A name is also looked up in the libraries with which h5py's module is linked.
    module = ctypes.CDLL(h5f.__file__)

    def find(name: Any) -> Any:
        address: Any = getattr(module, ffi.string(name).decode(), None)
        return ffi.cast("void *", ctypes.cast(address, ctypes.c_void_p).value or 0)

    ffi.def_extern(name="hdf5_find")(find)
    held: contextlib.AbstractContextManager[Any] = _objects.phil
    return held if lib.ct_hdf5_load(lib.hdf5_find) else None


class Files:
    """The functions ``ct_output_*`` of the C library, one call at a time."""

    def __getattr__(self, name: str) -> Any:
        function = getattr(lib, name)

        def alone(*arguments: Any) -> Any:
            with lock() or contextlib.nullcontext():
                return function(*arguments)

        return alone


files = Files()
