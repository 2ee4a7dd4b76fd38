"""Statements of the book about itself and the code, and the files that it names."""

import re
from pathlib import Path

import pytest
from csource import Source
from parts import parts

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

PAGES = {
    page.relative_to(ROOT).as_posix(): page.read_text()
    for page in [*DOCS.rglob("*.rst"), ROOT / "README.md"]
    if page.parent.name != "tutorials"
}
HEADERS = {
    header.name: header.read_text()
    for header in (ROOT / "libcontact" / "include" / "libcontact").glob("*.h")
}
PATH = re.compile(
    r"(?:``|:file:`)((?:tests|libcontact|wrapper|docs|bench|stability|tutorials)/[\w./-]+)`"
)


# Folders that a build of the book makes, and that a fresh clone does not have.
MADE = {
    line.rstrip("/")
    for line in (ROOT / ".gitignore").read_text().splitlines()
    if line.startswith("docs/")
}


def test_named_files_exist():
    named = [(page, path) for page, text in PAGES.items() for path in PATH.findall(text)]
    assert len(named) > 80
    assert [
        (page, path)
        for page, path in named
        if not (ROOT / path).exists() and path.rstrip("/") not in MADE
    ] == []


def chapters():
    """Names of the chapters of all parts in their order, with their texts."""
    return {name: PAGES[f"docs/{name}.rst"] for part in parts(DOCS).values() for name in part}


def equations_without_code():
    defined = {
        label for text in PAGES.values() for label in re.findall(r"^\s+:label: (\S+)$", text, re.M)
    }
    sources = [path for path in (ROOT / "libcontact").rglob("*") if path.suffix in (".c", ".h")]
    named = {label for path in sources for label, _, _ in Source(path.read_text()).labels()}
    return defined - named


def references_ahead():
    order = list(chapters())
    home = {
        label: name
        for name, text in chapters().items()
        for label in re.findall(r"^\s+:label: (\S+)$", text, re.M)
    }
    return [
        (name, label)
        for name, text in chapters().items()
        for label in re.findall(r":eq:`([^`<]+)`", text)
        if label in home and order.index(home[label]) > order.index(name)
    ]


def members_that_show_others():
    return [
        name
        for name in ("total", "read", "constraints")
        if re.search(rf"\*{name};", HEADERS["problem.h"])
    ]


# A claim that was false, and its counterexample. If the second is empty, the claim may return.
FALSE = {
    r"every equation beside": equations_without_code,
    r"needs only those before": references_ahead,
    r"no link can rot": equations_without_code,
    r"does not (?:see|know) (?:the )?other": members_that_show_others,
}


@pytest.mark.parametrize("claim", FALSE)
def test_claims_that_were_false_are_gone(claim):
    assert FALSE[claim]()
    assert [page for page, text in PAGES.items() if re.search(claim, " ".join(text.split()))] == []


# Advice that holds for the explicit penalty alone says so, in its own paragraph.
EXPLICIT = {
    "docs/theory/contact_bound.rst": (
        r"\\beta \\le 1",
        r"\\beta` between 3 and 5",
        r"\\beta \\ge 5",
        r"stiffer system needs a smaller step",
        r"\*\*Too stiff\*\*",
    ),
    "docs/theory/stable.rst": (
        r"recommends a margin",
        r":eq:`contact-bound`\. ?|:eq:`contact-bound`;",
        r"penalty acts like a spring of the stiffness :math:`\\beta EA/h`",
    ),
}


@pytest.mark.parametrize(
    "page, advice", [(page, advice) for page, all_of_it in EXPLICIT.items() for advice in all_of_it]
)
def test_advice_on_penalty_and_step_has_its_scope(page, advice):
    paragraphs = [" ".join(paragraph.split()) for paragraph in PAGES[page].split("\n\n")]
    found = [paragraph for paragraph in paragraphs if re.search(advice, paragraph)]
    assert found and all("explicit penalty" in paragraph for paragraph in found)


def test_contact_advises_stresses_of_elements_on_unlike_meshes():
    text = " ".join(PAGES["docs/theory/contact_bound.rst"].split())
    assert "report tractions at Gauss points" not in text and "unlike_meshes.8_11_4_point" in text


def test_benchmark_of_the_bent_face_is_credited():
    """The benchmark is of 2004 (the plates) and 2010 (the comparison), not of 2012."""
    text = (ROOT / "tutorials" / "02_closest_point.py").read_text()
    assert {"Gabriel2004", "Gabriel2010"} <= set(
        re.findall(r":cite:[tp]:`(\w+)`", text)
    ) and "Gabriel2012" not in text


def test_the_page_on_0_2_names_what_there_is():
    """Calls and options on the right of its table are in the headers; its list of calls is in them, too."""
    page = PAGES["docs/reference/upgrade.rst"]
    table = re.findall(r"^``(.+?)  ``(.+)$", page, re.M)
    known = set(re.findall(r"\bct_\w+", "".join(HEADERS.values())))
    new = set(re.findall(r"\bct_\w+", " ".join(right for _, right in table)))
    assert len(table) > 10 and new - known == set()
    listed = page[page.index("New at this place") : page.index("Fortran\n---")]
    assert set(re.findall(r"\bct_\w+", listed)) - known == set()
