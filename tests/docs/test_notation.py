"""A symbol has one meaning in a part of the book: equations use no letter that reference/notation.toml does not have,
and in closed parts no letter in a chapter that its row does not name."""

from pathlib import Path

import pytest
from parts import parts
from symbols import CLOSED, exceptions, letters, names, notation, used, written

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

BOOK, TABLES = parts(DOCS), notation(DOCS)
CHAPTERS = [(part, page) for part in BOOK for page in BOOK[part]]
ORDER = [page for _, page in CHAPTERS]
# Symbols with a meaning beside that of their part, in all chapters together. The number may only shrink.
MOST = 91


def symbols(part):
    """The symbols of a part's table."""
    return [name for row in TABLES[part]["symbol"] for name in names(row)]


@pytest.mark.parametrize("part", TABLES)
def test_one_meaning(part):
    found = symbols(part)
    assert len(found) == len(set(found))
    cells = 5 if part in CLOSED else 4
    assert all(len(row) == cells and all(row[:4]) for row in TABLES[part]["symbol"])
    twice = [(row[0], row[1]) for row in TABLES[part]["other"]]
    assert len(twice) == len(set(twice))


@pytest.mark.parametrize("part, page", CHAPTERS)
def test_equations_use_symbols_of_the_table(part, page):
    other = {symbol for symbol, chapter, _ in TABLES[part]["other"] if chapter == page}
    unknown = {
        symbol: labels
        for symbol, labels in used(DOCS / f"{page}.rst", part).items()
        if symbol not in other and symbol not in symbols(part)
    }
    assert unknown == {}, "not in docs/reference/notation.toml"


@pytest.mark.parametrize("part", CLOSED)
def test_one_sense(part):
    """No chapter has a sense of its own. The row of a symbol names the chapters whose labelled equations use it, and
    the first of them comes after its definition."""
    assert TABLES[part]["other"] == []
    pages = BOOK[part]
    at = {page: used(DOCS / f"{page}.rst", part) for page in pages}
    for row in TABLES[part]["symbol"]:
        tracked = [name for name in names(row) if name in letters(name, part)]
        using = [page for page in pages if any(name in at[page] for name in tracked)]
        assert not tracked or row[4] == [page.split("/")[1] for page in using], row[0]
        assert all(ORDER.index(page) >= ORDER.index(row[3]) for page in using), row[0]


@pytest.mark.parametrize("part, page", [chapter for chapter in CHAPTERS if chapter[0] in CLOSED])
def test_formulas_in_text_use_symbols_of_the_table(part, page):
    found = written(DOCS / f"{page}.rst", part)
    unknown = {symbol: found[symbol] for symbol in found if symbol not in symbols(part)}
    assert unknown == {}, "not in docs/reference/notation.toml"
    early = {
        symbol: row[3]
        for row in TABLES[part]["symbol"]
        for symbol in names(row)
        if symbol in found and ORDER.index(row[3]) > ORDER.index(page)
    }
    assert early == {}, "used before it is defined"


def test_other_meanings_become_fewer():
    count = 0
    for part in TABLES:
        left = exceptions(DOCS, part)
        gone = [row[:2] for row in TABLES[part]["other"] if row not in left]
        print(f"{part}: {len(left)} symbols with a second meaning; rows that may go: {gone}")
        count += len(left)
    assert count <= MOST


def test_chapters_of_the_tables_exist():
    pages = {row[3] for table in TABLES.values() for row in table["symbol"]}
    assert [page for page in sorted(pages) if not (DOCS / f"{page}.rst").exists()] == []


def test_letters_of_a_formula():
    formula = r"\sigma_{ij} = \boldsymbol\sigma : \mathbf{K}^{\mathsf T} + \tfrac12 h\, g_n \sin k_x \text{ for } \hat\omega"
    assert letters(formula) == {r"\sigma", r"\boldsymbol \sigma", "h", "g", "k", r"\omega"}
    assert letters(r"\textstyle\sum_i \delta_{ij} w_i", "theory/index") == {r"\delta", "w"}
