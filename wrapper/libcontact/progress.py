"""Progress bars in a terminal and in a notebook, and tables as text."""

from __future__ import annotations

import contextlib
import io
import sys
import warnings
from collections.abc import Iterator
from typing import Any


def in_notebook() -> bool:
    """Whether this process is the kernel of a notebook."""
    shell = getattr(sys.modules.get("IPython"), "get_ipython", lambda: None)()
    return shell is not None and "IPKernelApp" in shell.config


class Silent:
    """A bar that is not shown."""

    def update(self, count: float = 1) -> None:
        """Advance by so much."""

    def set_description(self, text: str) -> None:
        """Set the text before the bar."""


@contextlib.contextmanager
def bar(progress: Any, **settings: Any) -> Iterator[Any]:
    """A progress bar where somebody can see it: with ``progress`` true in a terminal or a notebook, with
    "always" everywhere. Without a bar tqdm, whose settings follow, is not imported."""
    terminal = getattr(sys.stderr, "isatty", bool)()
    if not progress or (progress != "always" and not terminal and not in_notebook()):
        yield Silent()
        return
    with warnings.catch_warnings():
        # Without ipywidgets the bar of a notebook is a line of text.
        warnings.simplefilter("ignore")
        from tqdm.auto import tqdm
    with tqdm(file=sys.stderr, dynamic_ncols=True, **settings) as shown:
        yield shown


def table_text(table: Any) -> str:
    """The lines of a table of rich."""
    from rich.console import Console

    text = io.StringIO()
    # In a notebook a console would display the table instead of writing it.
    Console(file=text, width=200, color_system=None, force_jupyter=False).print(table)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())
