"""CITATION.cff, the page "How to cite" and the changelog have the version of base.h."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
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
    assert re.search(rf"^{re.escape(VERSION)}\n-+$", (ROOT / "CHANGELOG.rst").read_text(), re.M)


def test_paper_is_cited_alike():
    bib = (ROOT / "docs" / "references.bib").read_text()
    title = re.search(r"@inproceedings\{Gabriel2012,.*?title\s*= \{(.+?)\}", bib, re.S)[1]
    assert title in CFF and title in (ROOT / "docs" / "reference" / "cite.rst").read_text()
