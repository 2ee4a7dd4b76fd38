"""The letters of the labelled equations, and the table of notation that is made from ``reference/notation.toml``.

A symbol is a letter with its style: ``\\sigma`` and ``\\boldsymbol\\sigma`` are two symbols, subscripts make no new
one. The file has for each part its symbols with meaning, unit and the chapter that defines them. Where a chapter uses a
symbol in another sense than its part, the file says so under ``other``; these rows are to become fewer.

Of the parts in ``CLOSED`` a row has a fifth cell: the chapters whose labelled equations use the symbol. Whoever writes
a letter into another chapter adds it there and reads its meaning. In these parts ``other`` is empty, more letters
count, and all formulas are read, also those in a line of text.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

LETTERS = (
    "kappa sigma varepsilon epsilon xi lambda beta zeta theta alpha gamma rho varrho omega".split()
)
LETTERS += list("WAJsphTgk")
# Parts where each of the letters has one sense in all formulas, and the letters that count there besides.
CLOSED = ("week/index", "theory/index")
MORE = [*"eta chi tau delta".split(), *"PVELwtmb"]
EQUATION = re.compile(r"\.\. math::\n((?:   .*\n|\n)+)")
STYLED = (
    r"\\(mathbf|boldsymbol|mathcal)\s*(?:\{\s*(\\[a-zA-Z]+|[a-zA-Z])\s*\}|(\\[a-zA-Z]+|[a-zA-Z]))"
)
GROUP = r"\{(?:[^{}]|\{(?:[^{}]|\{[^{}]*\})*\})*\}"


def letters(formula: str, part: str = "") -> set[str]:
    """Symbols of a formula that have one of the letters that count in a part; subscripts, words and units do not
    count."""
    count = LETTERS + MORE if part in CLOSED else LETTERS
    text = re.sub(
        r"\\(?:text|mathrm|operatorname|label|begin|end|mathsf|hspace)(?![a-z])\*?\s*(?:"
        + GROUP
        + r"|\w)",
        " ",
        formula,
    )
    text = re.sub(r"_\s*(?:" + GROUP + r"|\\[a-zA-Z]+(?:\s*" + GROUP + r")?|.)", " ", text)
    found = set()
    for style, group, name in re.findall(STYLED, text):
        found.add((style, group or name))
    text = re.sub(r"\\(?:mathbf|boldsymbol|mathcal)\s*(?:" + GROUP + r"|\\[a-zA-Z]+|\w)", " ", text)
    found.update(("", name) for name in re.findall(r"\\[a-zA-Z]+", text))
    found.update(("", name) for name in re.findall(r"[a-zA-Z]", re.sub(r"\\[a-zA-Z]+", " ", text)))
    return {
        (f"\\{style} " if style else "") + name
        for style, name in found
        if name.lstrip("\\") in count and (name[0] == "\\" or len(name) == 1)
    }


def used(page: Path, part: str = "") -> dict[str, list[str]]:
    """Symbols of the labelled equations of a page, each with the labels of its equations."""
    found: dict[str, list[str]] = {}
    for block in EQUATION.findall(page.read_text()):
        label = re.search(r"^\s+:label: (\S+)$", block, re.M)
        if label:
            formula = re.sub(r"^\s+:\w+:.*$", "", block, flags=re.M)
            for symbol in letters(formula, part):
                found.setdefault(symbol, []).append(label[1])
    return found


def written(page: Path, part: str) -> dict[str, list[str]]:
    """Symbols of all formulas of a page outside its boxes "later", each with its formulas."""
    text = re.sub(r"^\.\. admonition:: Later\n(?:   .*\n|\n)+", "", page.read_text(), flags=re.M)
    formulas = re.findall(r":math:`([^`]*)`", text)
    formulas += [re.sub(r"^\s+:\w+:.*$", "", block, flags=re.M) for block in EQUATION.findall(text)]
    found: dict[str, list[str]] = {}
    for formula in formulas:
        for symbol in letters(formula, part):
            found.setdefault(symbol, []).append(" ".join(formula.split()))
    return found


def names(row: list) -> list[str]:
    """The symbols of a row without their subscripts."""
    return list(dict.fromkeys(name.split("_")[0].strip() for name in row[0].split(",")))


def notation(docs: Path) -> dict[str, dict]:
    """The file: for each part ``symbol``, a list of rows, and ``other``, a list of exceptions."""
    return tomllib.loads((docs / "reference" / "notation.toml").read_text())


def exceptions(docs: Path, part: str) -> list[list[str]]:
    """Rows of ``other`` of a part that still hold: symbol, chapter, meaning."""
    rows = notation(docs)[part]["other"]
    pages = {page: docs / f"{page}.rst" for _, page, _ in rows}
    found = {page: used(path) if path.exists() else {} for page, path in pages.items()}
    return [row for row in rows if row[0] in found[row[1]]]


def table(widths: str, head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    """A list table in reST; the first cell of a row is a formula, the last one a page."""
    lines = [".. list-table::", "   :header-rows: 1", f"   :widths: {widths}", ""]
    cells = [head, *((f":math:`{row[0]}`", *row[1:-1], f":doc:`/{row[-1]}`") for row in rows)]
    for row in cells:
        lines += [f"   {'*' if i == 0 else ' '} - {cell}" for i, cell in enumerate(row)]
    return "\n".join(lines) + "\n\n"


def directive():
    """``.. notation:: theory/index``: the tables of a part. Tests, which only read the file, need no Sphinx."""
    from sphinx.util.docutils import SphinxDirective

    class Table(SphinxDirective):
        required_arguments = 1

        def run(self):
            docs, part = Path(self.env.srcdir), self.arguments[0]
            self.env.note_dependency(str(docs / "reference" / "notation.toml"))
            head = ("symbol", "meaning", "unit", "chapter")
            rows = [row[:4] for row in notation(docs)[part]["symbol"]]
            text = table("14 52 12 22", head, rows)
            other = [(symbol, meaning, page) for symbol, page, meaning in exceptions(docs, part)]
            if other:
                text += "These chapters still use a symbol in another sense:\n\n"
                text += table("14 52 34", ("symbol", "meaning there", "chapter"), other)
            return self.parse_text_to_nodes(text)

    return Table


def setup(app):
    app.add_directive("notation", directive())
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
