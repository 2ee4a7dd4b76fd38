"""Small books of tests, built in the process of the test, which spares each of them the start of Sphinx."""

import contextlib
import io
import os
from types import SimpleNamespace


def write(folder, files):
    """Write the files of a book, by their names; one that has this text keeps its time."""
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def build(folder, *options, source=".", out="out", builder="html"):
    """Build the book in ``folder`` as ``python -m sphinx`` does there: its exit code, output and messages."""
    from sphinx.cmd.build import main

    output, messages, before = io.StringIO(), io.StringIO(), os.getcwd()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(messages):
            status = main([*options, "-b", builder, str(source), str(out)])
    finally:
        os.chdir(before)
    return SimpleNamespace(returncode=status, stdout=output.getvalue(), stderr=messages.getvalue())
