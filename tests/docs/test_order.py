"""The order of the book: parts, one count of chapters, and references ahead in Parts I and II only in boxes "Later"."""

import re
from pathlib import Path

import pytest
from parts import entries, needs, parts

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"

BOOK = parts(DOCS)
ORDER = [page for part in BOOK.values() for page in part]
COURSE = [page for part in list(BOOK)[:2] for page in BOOK[part]]
ROLE = re.compile(r":(doc|eq|ref|numref):`(?:[^`<]*<)?([^`<>]+)>?`")
LABEL = re.compile(r"^\s+:(?:label|name): (\S+)$|^\.\. _([^:]+):$", re.M)


def outside_later(text):
    """The text without its boxes "Later"."""
    kept, box = [], None
    for line in text.splitlines():
        indent = len(line) - len(line.lstrip())
        if box is not None and line.strip() and indent <= box:
            box = None
        if box is None and re.match(r"\s*\.\. admonition:: Later\s*$", line):
            box = indent
        if box is None:
            kept.append(line)
    return "\n".join(kept)


def homes(texts):
    """Where each label of an equation, figure or section is defined."""
    return {a or b: page for page, text in texts.items() for a, b in LABEL.findall(text)}


def ahead(page, texts, order):
    """References of a page to pages that come later in the order."""
    home = homes(texts)
    found = []
    for role, target in ROLE.findall(outside_later(texts[page])):
        if role == "doc":
            folder = page.rpartition("/")[0]
            there = target[1:] if target[0] == "/" else f"{folder}/{target}"
        else:
            there = home.get(target)
        if there in order and order.index(there) > order.index(page):
            found.append(f":{role}:`{target}`")
    return found


TEXTS = {page: (DOCS / f"{page}.rst").read_text() for page in ORDER}


def test_parts_have_all_chapters():
    assert list(BOOK) == ["week/index", "theory/index", "theory/deeper", "theory/fast"]
    pages = [path.relative_to(DOCS).with_suffix("").as_posix() for path in DOCS.rglob("*.rst")]
    theory = {page for page in pages if re.match(r"(theory|week)/(?!index|deeper|fast)", page)}
    reference = {page[1:] for page in entries(DOCS / "reference" / "index.rst") if page[0] == "/"}
    assert theory - set(ORDER) == reference - {"api/index"} and len(ORDER) == len(set(ORDER))


@pytest.mark.parametrize("page", COURSE)
def test_courses_point_ahead_only_in_boxes(page):
    found = ahead(page, TEXTS, ORDER)
    print(f"{page}: {len(found)} references ahead outside boxes: {' '.join(found)}")
    assert found == []


@pytest.mark.parametrize("part", BOOK)
def test_chapters_need_only_those_before(part):
    """In Parts I and II no chapter needs a later one; in the others, no later one of its own part."""
    others = ORDER if BOOK[part][0] in COURSE else BOOK[part]
    assert [
        (page, need)
        for page in BOOK[part]
        for need in needs(DOCS / f"{page}.rst")
        if need in others and others.index(need) >= others.index(page)
    ] == []


def test_a_reference_ahead_is_found_and_a_box_hides_it():
    box = ".. admonition:: Later\n\n   :doc:`b` and :eq:`second`.\n\n"
    texts = {"t/a": box + "See :doc:`b` and :eq:`second <x>`.\n", "t/b": "   :label: x\n"}
    assert ahead("t/a", texts, ["t/a", "t/b"]) == [":doc:`b`", ":eq:`x`"]
    assert ahead("t/a", texts, ["t/b", "t/a"]) == []


@pytest.fixture
def tiny(tmp_path):
    """A tiny book of two parts with two chapters each, and a third one with two groups."""
    pytest.importorskip("sphinx")
    from sphinx.application import Sphinx
    from sphinx.util.docutils import docutils_namespace

    tree = ".. toctree::\n   :numbered:\n\n   {}\n   {}\n"
    pages = {
        "index": "Book\n====\n\n.. toctree::\n\n   p/index\n   q/index\n   r/index\n",
        "p/index": "P\n=\n\n" + tree.format("a", "b"),
        "q/index": "Q\n=\n\n" + tree.format("c", "d"),
        "r/index": "R\n=\n\n.. toctree::\n\n   one\n   two\n",
        "r/one": "One\n===\n\n.. toctree::\n   :numbered:\n\n   e\n",
        "r/two": "Two\n===\n\nGroup\n-----\n\n.. toctree::\n   :numbered:\n\n   f\n",
    }
    for name in ("p/a", "p/b", "q/c", "q/d", "r/e", "r/f"):
        label = name[2]
        pages[name] = f"{label}\n=\n\nS\n-\n\n.. math::\n   :label: {label}\n\n   x\n"
    for name, text in pages.items():
        path = tmp_path / f"{name}.rst"
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
    settings = {"extensions": ["parts", "navigation"], "numfig": True, "math_numfig": True}
    out = tmp_path / "out"
    with docutils_namespace():
        app = Sphinx(tmp_path, None, out, out, "dummy", settings, None, None)
        app.build()
        yield app


def test_numbers_go_on_from_part_to_part(tiny):
    """The chapters have the numbers 1 to 6, and so have their equations."""
    env = tiny.env
    numbers = {name: env.titles[name]["secnumber"] for name in ("p/a", "p/b", "q/c", "q/d")}
    assert list(numbers.values()) == [[1], [2], [3], [4]]
    assert [env.titles[name]["secnumber"] for name in ("r/e", "r/f")] == [[5], [6]]
    assert env.toc_secnumbers["q/d"]["#s"] == (4, 1)
    assert env.toc_fignumbers["q/d"]["displaymath"]["equation-d"] == (4, 1)


@pytest.mark.parametrize("page", ("index", "p/index", "q/d", "r/two", "r/f"))
def test_titles_beside_a_page_are_those_of_the_whole_contents(tiny, page):
    import navigation
    from sphinx.environment.adapters.toctree import global_toctree_for_doc

    def whole(**options):
        tree = global_toctree_for_doc(tiny.env, page, tiny.builder, tags=tiny.tags, **options)
        return tree.pformat()

    context, contents = {"toctree": whole}, tiny.env.tocs
    navigation.cut(tiny, page, "", context, None)
    for only in (True, False):
        options = {"titles_only": only, "maxdepth": -1, "includehidden": True}
        tree = whole(**options)
        assert context["toctree"](**options) == tree and ("Group" in tree) != only
    assert tiny.env.tocs is contents
    assert "Group" not in navigation.titles_of(tiny.env)["r/two"].astext()
