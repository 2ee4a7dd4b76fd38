"""Numbers that are typed: percentages, ratios and decimals in sentences and tables, that no role computes.

A *measured* number, the result of a run, comes from ``measured.json`` (``measured.py``). What a page may type is
listed in ``typed.toml``, page by page: data of a scene, a limit, a value of the literature, a step of a derivation. A
number that the list does not have is a warning, so with ``-W`` the build fails; so is one of the list that the page no
longer has. The sections "How we know that it is right" state tolerances of tests and are not read.
"""

from __future__ import annotations

import re
import tomllib
from collections import Counter
from pathlib import Path

TEXTS = ("admonition", "drawn", "dropdown", "figure", "glossary", "moving", "note", "rubric")
TABLE = re.compile(r"^\s*=+( +=+)+\s*$|^\s*[+]-|^\s*[*] - ", re.M)
ROLE = re.compile(r":[\w:+.-]+:`[^`]*`|``[^`]*``|`[^`]*`_")
NUMBER = re.compile(
    r"(?<![\w.^{/-])\d*\.?\d+(?: ?(?:…|to) ?\d*\.?\d+)?[ \N{NO-BREAK SPACE}]?(?:%|per cent|times(?= as| the| more| less| smaller| larger| its| wider| longer))"
)
DECIMAL = re.compile(r"(?<![\w.])[−-]?\d*\.\d+(?: ?%)?(?![\w.]*\.\d)")
SENTENCE = re.compile(f"{NUMBER.pattern}|{DECIMAL.pattern}")
UNREAD = "How we know that it is right"


def blocks(text: str) -> list[str]:
    """Paragraphs and tables of a page; not its directives, but those whose body is text."""
    text = re.sub(rf"^{UNREAD}\n-+\n.*?(?=^[^\n]+\n-+\n|\Z)", "", text, flags=re.M | re.S)
    found: list[str] = []
    skipped = -1
    for block in re.split(r"\n\s*\n", text):
        first = block.lstrip("\n")
        indent = len(first) - len(first.lstrip())
        if 0 <= skipped < indent:
            continue
        name = re.match(r"\s*\.\. ([\w-]+)::", first)
        read = not name or name[1] in (*TEXTS, "list-table")
        skipped = -1 if read else indent
        if read and not (name and name[1] == "list-table"):
            found.append(first)
    return found


def typed(text: str) -> list[str]:
    """The typed numbers of a page, in its order."""
    found: list[str] = []
    for block in blocks(text):
        words = ROLE.sub("`", block)
        pattern = DECIMAL if TABLE.search(block) else SENTENCE
        found += [re.sub(r"\s+", " ", one) for one in pattern.findall(" ".join(words.split()))]
    return found


def check(name: str, text: str, table: dict) -> list[str]:
    """What is wrong on a page."""
    listed, found = Counter(table.get(name, [])), Counter(typed(text))
    new = [f'"{one}" is typed' for one in (found - listed).elements()]
    return new + [
        f'typed.toml lists "{one}", which is not there' for one in (listed - found).elements()
    ]


def setup(app):
    from sphinx.util import logging

    logger = logging.getLogger(__name__)
    app.add_config_value("typed_file", "typed.toml", "env")

    def read(app, name, source):
        if name.startswith("tutorials/"):  # made of programs that assert their claims
            return
        path = Path(app.srcdir) / app.config.typed_file
        for problem in check(name, source[0], tomllib.loads(path.read_text(encoding="utf-8"))):
            logger.warning("typed: %s: %s", name, problem, location=name, type="typed")

    app.connect("source-read", read)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
