"""CITATION.cff, the page "How to cite" and the changelog have the version of base.h; the changelog has a day."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CHANGES = (ROOT / "CHANGELOG.rst").read_text()
CFF = (ROOT / "CITATION.cff").read_text()
HEADER = (ROOT / "libcontact" / "include" / "libcontact" / "base.h").read_text()
VERSION = ".".join(
    re.search(rf"CT_VERSION_{part} = (\d+)", HEADER)[1] for part in ("MAJOR", "MINOR", "PATCH")
)


def test_citation_has_what_the_format_requires():
    keys = re.findall(r"^([a-z-]+):", CFF, re.M)
    assert {"cff-version", "message", "title", "authors"} <= set(keys) and len(keys) == len(
        set(keys)
    )
    assert re.search(r"^cff-version: 1\.2\.0$", CFF, re.M)
    assert re.search(r"^authors:\n  - name: .+", CFF, re.M)


def test_one_version():
    page = (ROOT / "docs" / "reference" / "cite.rst").read_text()
    assert re.search(r"^version: (.+)$", CFF, re.M)[1] == VERSION
    assert re.search(r"version = \{(.+)\}", page)[1] == VERSION


def test_the_changelog_begins_with_this_version_and_its_day():
    version, day = re.search(r"^(\d\S+) \((.+)\)\n-+$", CHANGES, re.M).groups()
    assert version == VERSION and re.fullmatch(r"\d{4}-\d\d-\d\d|unreleased", day)
    released = re.search(r"^date-released: (.+)$", CFF, re.M)[1]
    assert day in (released, "unreleased")


def test_what_leaves_is_on_the_page_of_upgrades():
    page = (ROOT / "docs" / "reference" / "upgrade.rst").read_text()
    before, now = page.split("\n")[0].split()[1::2]
    assert VERSION.startswith(f"{now}.") and re.search(rf"^{re.escape(before)}\.", CHANGES, re.M)
    removed = CHANGES.split("\nRemoved\n")[1].split("~~~\n")[1]
    words = set(re.findall(r"``((?:ct|CT)_\w+|[a-z]\w+)``", removed))
    assert len(words) > 5 and [word for word in sorted(words) if word not in page.lower()] == []


def test_paper_is_cited_alike():
    bib = (ROOT / "docs" / "references.bib").read_text()
    title = re.search(r"@inproceedings\{Gabriel2012,.*?title\s*= \{(.+?)\}", bib, re.S)[1]
    assert title in CFF and title in (ROOT / "docs" / "reference" / "cite.rst").read_text()
