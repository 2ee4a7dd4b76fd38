"""What Python has only since 3.11."""

from __future__ import annotations

import sys

if sys.version_info >= (3, 11):
    import tomllib
    from typing import dataclass_transform
else:
    import tomli as tomllib

    def dataclass_transform(**_options):
        """Only type checkers read it."""
        return lambda decorated: decorated


__all__ = ["dataclass_transform", "tomllib"]
