"""libcontact: explicit finite-element contact-impact. The numbers come from the C library; this package adds comfort.

>>> import libcontact as ct
>>> run = ct.Scene.load("plates.toml").run()
>>> run.energy["total"]
"""

from . import exact
from ._core import ffi, lib
from .errors import ArgumentError, BlowupError, Error, FileError, GeometryError, NotBuiltIn, StepError
from .projection import Projection, RayHits, Status, project, project_ray
from .run import Run, RunError
from .scene import Scene
from .schema import SceneError
from .search import Nearest, Surface, nearest

__all__ = ["ArgumentError", "BlowupError", "Error", "FileError", "GeometryError", "Nearest", "NotBuiltIn", "Projection", "RayHits", "Run",
           "RunError", "Scene", "SceneError", "Status", "StepError", "Surface", "exact", "has", "nearest", "project", "project_ray"]

__version__ = ffi.string(lib.ct_version()).decode()


def has(part: str) -> bool:
    """Whether an optional part was built in: "hdf5" (results files), "gsl" (the modal series), "openmp" (threads)."""
    parts = {
        "hdf5": hasattr(lib, "ct_output_create"),
        "gsl": hasattr(lib, "ct_exact_plates_series"),
        "openmp": bool(lib.ct_has_openmp()),
    }
    if part not in parts:
        raise ValueError(f'there is no part "{part}"; the parts are {", ".join(parts)}')
    return parts[part]
