"""The parts of the book: which chapters they have, in which order, and one count of chapters through all of them.

A part is a page whose toctree is ``:numbered:``, or whose toctree has such pages, the groups of the part; the parts
stand in the toctree of ``index.rst``. Sphinx begins each numbered toctree with 1 again. Here the numbers go on where
those of the toctree before it end.
"""

from __future__ import annotations

import posixpath
import re
from pathlib import Path

TOCTREE = re.compile(r"^\.\. toctree::\n((?:   .*\n|\n)*)", re.M)


def entries(page: Path, option: str = "") -> list[str]:
    """Names of the pages in the toctrees of a page that have the option, from the folder of the page."""
    blocks = [block for block in TOCTREE.findall(page.read_text() + "\n") if option in block]
    return [name for block in blocks for name in re.findall(r"^   (?!:)(\S+)$", block, re.M)]


def chapters(docs: Path, page: str) -> list[str]:
    """The numbered pages of a page: names as in ``theory/mass``."""
    folder, path = posixpath.dirname(page), docs / f"{page}.rst"
    names = entries(path, ":numbered:") if path.exists() else []
    return [posixpath.join(folder, name).lstrip("/") for name in names]


def groups(docs: Path) -> dict[str, list[str]]:
    """The pages that have chapters, parts and groups of parts, in their order."""
    found: dict[str, list[str]] = {}
    for part in entries(docs / "index.rst"):
        path, folder = docs / f"{part}.rst", posixpath.dirname(part)
        below = [f"{folder}/{name}" for name in entries(path)] if path.exists() else []
        found |= {page: own for page in (part, *below) if (own := chapters(docs, page))}
    return found


def parts(docs: Path) -> dict[str, list[str]]:
    """The parts in their order, each with its chapters."""
    found: dict[str, list[str]] = {}
    for page, own in groups(docs).items():
        above = (part for part in entries(docs / "index.rst") if page.startswith(part))
        found.setdefault(next(above, page), []).extend(own)
    return found


def needs(page: Path) -> list[str]:
    """Pages that the field "You need" of a chapter links to."""
    field = re.search(r"^:You need:(.*(?:\n +\S.*)*)", page.read_text(), re.M)
    links = re.findall(r":doc:`(?:[^`<]*<)?([^`>]+)>?`", field[1]) if field else []
    root = page.parent.parent
    return [
        link[1:] if link[0] == "/" else (page.parent / link).relative_to(root).as_posix()
        for link in links
    ]


def shift(env, chapter: str, by: int) -> None:
    """Raise the numbers of a chapter and its sections."""
    from docutils import nodes

    numbers = env.toc_secnumbers[chapter]
    for anchor, number in numbers.items():
        if number:
            numbers[anchor] = (number[0] + by, *number[1:])
    for node in [env.titles[chapter], *env.tocs[chapter].findall(nodes.reference)]:
        if number := node.get("secnumber"):
            node["secnumber"] = [number[0] + by, *number[1:]]


def setup(app):
    from sphinx.environment.collectors.toctree import TocTreeCollector

    sphinx_numbers = TocTreeCollector.assign_section_numbers

    def number_through(collector, env):
        """Sphinx's count, and then each part goes on from the part before. Returns the pages whose numbers changed."""
        before = env.toc_secnumbers
        sphinx_numbers(collector, env)
        count = 0
        for part in env.toctree_includes.get(env.config.root_doc, []):
            for page in (part, *env.toctree_includes.get(part, [])):
                if page in env.numbered_toctrees:
                    for chapter in env.toctree_includes[page]:
                        shift(env, chapter, count)
                    count += len(env.toctree_includes[page])
        return [page for page, numbers in env.toc_secnumbers.items() if before.get(page) != numbers]

    if (
        sphinx_numbers.__name__ != number_through.__name__
    ):  # once, also for several books in one process
        TocTreeCollector.assign_section_numbers = number_through
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
