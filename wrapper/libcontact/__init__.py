"""libcontact: explicit finite-element contact-impact. The C library computes; this package reads
scenes, runs them, and handles their results.

>>> import libcontact as ct
>>> run = ct.Scene.load("plates.toml").run()  # doctest: +SKIP
>>> run.energy["total"]  # doctest: +SKIP

Modules are imported when a name is first used, so that the command line starts quickly and handles
Ctrl-C from the beginning.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import exact as exact
    from .bloch import *
    from .bridge import has as has
    from .contact import *
    from .errors import *
    from .projection import *
    from .run import *
    from .scene import Scene as Scene
    from .scene import example as example
    from .schema import SceneError as SceneError
    from .search import *
    from .state import *

    __version__: str

# The modules whose public names, those of their __all__, are names of the package; and where other names live.
_PUBLIC = ("bloch", "contact", "errors", "projection", "run", "search", "state")
_HOME = {"Scene": "scene", "example": "scene", "SceneError": "schema", "has": "bridge"}


def _module(home: str) -> Any:
    return import_module("." + home, __name__)


if not TYPE_CHECKING:  # A type checker knows the names that are imported above, and no others.

    def __getattr__(name: str) -> Any:
        value: Any
        if name == "__version__":
            value = _module("_core").ffi.string(_module("_core").lib.ct_version()).decode()
        elif name == "__all__":
            public = [_module(home).__all__ for home in _PUBLIC]
            value = sorted({"exact", *_HOME}.union(*public))
        elif name == "exact":
            value = _module("exact")
        else:
            candidates = () if name.startswith("_") else _PUBLIC
            home = _HOME.get(name) or next(
                (h for h in candidates if name in _module(h).__all__), None
            )
            if home is None:
                unknown = f'module "libcontact" has no attribute "{name}"'
                raise AttributeError(_module("errors").gone(name) or unknown)
            value = getattr(_module(home), name)
        globals()[name] = value
        return value

    def __dir__() -> list[str]:
        return [*__getattr__("__all__"), "__version__"]
