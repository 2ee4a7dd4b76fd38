"""libcontact: explicit finite-element contact-impact. The numbers come from the C library; this package adds comfort.

>>> import libcontact as ct
>>> run = ct.Scene.load("plates.toml").run()
>>> run.energy["total"]

A name is imported when it is first asked for. So the command line starts at once, and Ctrl-C finds somebody who minds it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import exact
    from .errors import (
        ArgumentError,
        BlowupError,
        ChatterWarning,
        EnergyError,
        EnergyGrowth,
        Error,
        FileError,
        GeometryError,
        InsideOutWarning,
        NeverMeetWarning,
        NotAtRest,
        NotBuiltIn,
        NotSettled,
        OutputWarning,
        OverlapWarning,
        RotationWarning,
        SamePlaceWarning,
        SceneWarning,
        StepError,
        ThinWarning,
        UnitsWarning,
    )
    from .projection import (
        Projection,
        RayHits,
        Status,
        face_points,
        project,
        project_path,
        project_ray,
    )
    from .run import EnergyBlowup, InvertedElement, NotFinite, Run, RunError, StepTooLarge
    from .scene import Scene, example
    from .schema import SceneError
    from .search import Nearest, Surface, nearest

__all__ = [
    "ArgumentError",
    "BlowupError",
    "ChatterWarning",
    "EnergyBlowup",
    "EnergyError",
    "EnergyGrowth",
    "Error",
    "FileError",
    "GeometryError",
    "InsideOutWarning",
    "InvertedElement",
    "Nearest",
    "NeverMeetWarning",
    "NotAtRest",
    "NotBuiltIn",
    "NotFinite",
    "NotSettled",
    "OutputWarning",
    "OverlapWarning",
    "Projection",
    "RayHits",
    "RotationWarning",
    "Run",
    "RunError",
    "SamePlaceWarning",
    "Scene",
    "SceneError",
    "SceneWarning",
    "Status",
    "StepError",
    "StepTooLarge",
    "Surface",
    "ThinWarning",
    "UnitsWarning",
    "exact",
    "example",
    "face_points",
    "has",
    "nearest",
    "project",
    "project_path",
    "project_ray",
]

# Where each name lives.
_HOME = {
    **dict.fromkeys(
        (
            "ArgumentError",
            "BlowupError",
            "ChatterWarning",
            "EnergyError",
            "EnergyGrowth",
            "Error",
            "FileError",
            "GeometryError",
            "InsideOutWarning",
            "NeverMeetWarning",
            "NotAtRest",
            "NotBuiltIn",
            "NotSettled",
            "OutputWarning",
            "OverlapWarning",
            "RotationWarning",
            "SamePlaceWarning",
            "SceneWarning",
            "StepError",
            "ThinWarning",
            "UnitsWarning",
        ),
        "errors",
    ),
    **dict.fromkeys(
        (
            "Projection",
            "RayHits",
            "Status",
            "face_points",
            "project",
            "project_path",
            "project_ray",
        ),
        "projection",
    ),
    **dict.fromkeys(
        ("EnergyBlowup", "InvertedElement", "NotFinite", "Run", "RunError", "StepTooLarge"), "run"
    ),
    **dict.fromkeys(("Nearest", "Surface", "nearest"), "search"),
    **dict.fromkeys(("Scene", "example"), "scene"),
    "SceneError": "schema",
}


def __getattr__(name: str) -> Any:
    if name in _HOME:
        value = getattr(import_module("." + _HOME[name], __name__), name)
    elif name == "exact":
        value = import_module(".exact", __name__)
    elif name == "__version__":
        from ._core import ffi, lib

        value = ffi.string(lib.ct_version()).decode()
    else:
        raise AttributeError(f'module "libcontact" has no attribute "{name}"')
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, "__version__"})


def has(part: str) -> bool:
    """Whether an optional part was built in: "hdf5" (results files), "gsl" (the modal series), "openmp" (threads)."""
    from ._core import ffi, lib

    # What is not built in refuses every call, also one that has nothing to do.
    nothing, series = ffi.NULL, ffi.new("ct_exact_series **")
    parts = {
        "hdf5": lib.ct_output_close(nothing, nothing) != lib.CT_ERROR_UNSUPPORTED,
        "gsl": lib.ct_exact_series_create(0.3, 0, 1.0, series, nothing) != lib.CT_ERROR_UNSUPPORTED,
        "openmp": bool(lib.ct_has_openmp()),
    }
    if part not in parts:
        raise ValueError(f'there is no part "{part}"; the parts are {", ".join(parts)}')
    return parts[part]
