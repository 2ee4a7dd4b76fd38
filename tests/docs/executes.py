"""The decorator of a test that executes equations: it writes them again in Python, from the page and not from the
code."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[2] / "docs"
LABELS = {
    label
    for page in DOCS.rglob("*.rst")
    for label in re.findall(r"^ +:label: +(\S+)$", page.read_text(encoding="utf-8"), re.M)
}


def executes(*labels):
    """Decorate a test with the labels of its equations, which must exist in the book."""
    if unknown := set(labels) - LABELS:
        raise ValueError(f"no page defines the equations {', '.join(sorted(unknown))}")
    return lambda test: test
