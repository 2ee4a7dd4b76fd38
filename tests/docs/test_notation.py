"""A symbol has one meaning in a part of the book: the labelled equations use no letter that reference/notation.toml does not have."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
sys.path.insert(0, str(DOCS / "_ext"))
from parts import parts  # noqa: E402
from symbols import exceptions, letters, notation, used  # noqa: E402

BOOK, TABLES = parts(DOCS), notation(DOCS)
CHAPTERS = [(part, page) for part in BOOK for page in BOOK[part]]
# Symbols with a meaning beside that of their part, in all chapters together. The number may only shrink.
MOST = 124


def names(part):
    """The symbols of a part's table."""
    return [name.strip() for row in TABLES[part]["symbol"] for name in row[0].split(",")]


@pytest.mark.parametrize("part", TABLES)
def test_one_meaning(part):
    found = names(part)
    assert len(found) == len(set(found))
    assert all(len(row) == 4 and all(row) for row in TABLES[part]["symbol"])
    twice = [(row[0], row[1]) for row in TABLES[part]["other"]]
    assert len(twice) == len(set(twice))


@pytest.mark.parametrize("part, page", CHAPTERS)
def test_equations_use_symbols_of_the_table(part, page):
    other = {symbol for symbol, chapter, _ in TABLES[part]["other"] if chapter == page}
    unknown = {
        symbol: labels
        for symbol, labels in used(DOCS / f"{page}.rst").items()
        if symbol not in other and symbol not in names(part)
    }
    assert unknown == {}, "not in docs/reference/notation.toml"


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
