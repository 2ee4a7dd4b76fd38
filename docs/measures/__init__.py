"""
Numbers that the pages quote, computed. Each module has those of some chapters: a function computes the numbers of one
passage and returns them by name; its docstring says what is computed and on what.
"""

import importlib
import sys

from .shared import DOCS, MEASUREMENTS, ROOT

# Programs that measurements share with chapters and campaigns.
for folder in (ROOT / "stability", DOCS / "theory", DOCS / "benchmarks"):
    sys.path.append(str(folder))

import problems as benchmarks  # noqa: E402

MEASUREMENTS |= benchmarks.CASES
# In the order of measured.json.
for name in "start laboratory bricks effects surfaces penalty pressure multipliers waves plates meshfiles".split():
    importlib.import_module(f"{__name__}.{name}")
