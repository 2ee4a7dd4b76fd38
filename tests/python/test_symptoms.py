"""Errors and warnings end with the address of their entry on the page "Symptoms", if there is one; each
entry quotes a message that exists."""

import copy
import pickle
import re
import warnings
from functools import cache
from pathlib import Path

import pytest

import libcontact as ct
from libcontact import errors, run, schema

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "reference" / "symptoms.rst").read_text()
ENTRIES = dict(re.findall(r"^(\w+)\n~+\n\n((?:.+\n|\n(?=[: ]))*)", PAGE, re.M))


def family(kind):
    """The class and its subclasses."""
    return {kind}.union(*(family(other) for other in kind.__subclasses__()))


CLASSES = {
    kind.__name__: kind
    for kind in family(errors.Error)
    if kind.__module__.partition(".")[0] == "libcontact"
}


def made(name):
    """An error of a class, or a warning of a kind."""
    return CLASSES[name]("found") if name in CLASSES else errors.SceneWarning(name, "found")


@cache
def words():
    """The sources of the package and of the C library with their strings joined across lines."""
    paths = [*(ROOT / "wrapper").rglob("*.py"), *(ROOT / "libcontact" / "src").rglob("*.c")]
    text = "\n".join(path.read_text() for path in paths)
    return re.sub(r'"\s*\n\s*f?"', "", text)


def test_every_class_and_kind_has_an_entry_and_every_entry_one():
    assert len(CLASSES) > 10
    assert {*CLASSES, *errors.KINDS} == set(ENTRIES)


def test_the_chapter_on_warnings_has_a_row_for_each_kind():
    chapter = (ROOT / "docs" / "theory" / "warnings.rst").read_text(encoding="utf-8")
    assert set(re.findall(r"^   \* - ``(\w+)``", chapter, re.M)) == set(errors.KINDS)


def test_the_kinds_are_those_of_the_sources():
    used = re.findall(r'SceneWarning\(\s*"(\w+)"|super\(\).__init__\("(\w+)", text, key\)', words())
    assert {kind for pair in used for kind in pair if kind} == set(errors.KINDS)
    assert all(
        f"``{kind}``: {found}" in ct.SceneWarning.__doc__ for kind, found in errors.KINDS.items()
    )


@pytest.mark.parametrize("name", [*sorted(CLASSES), *errors.KINDS])
def test_text_ends_with_the_address_of_the_book(name, monkeypatch):
    monkeypatch.setenv("LIBCONTACT_DOCS", "https://example.org/book/")
    found = re.search(
        r"found \[docs: https://example.org/book/reference/symptoms\.html#([\w-]+)\]$",
        str(made(name)),
    )
    assert found and found[1] in {entry.lower().replace("_", "-") for entry in ENTRIES}


def test_no_address_without_a_book(monkeypatch, tmp_path):
    monkeypatch.delenv("LIBCONTACT_DOCS", raising=False)
    monkeypatch.setattr("sys.prefix", str(tmp_path))
    assert str(made("thin")) == "thin: found" and str(made("Error")) == "found"
    copy = tmp_path / "share" / "doc" / "libcontact"
    copy.mkdir(parents=True)
    (copy / "index.html").touch()
    assert str(made("thin")).endswith(f"[docs: {copy.as_uri()}/reference/symptoms.html#thin]")


def test_one_kind_is_chosen_by_its_beginning():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warnings.filterwarnings("ignore", "thin:")
        for kind in errors.KINDS:
            errors.issue(errors.SceneWarning(kind, "found", "body[0]"))
    assert [one.message.kind for one in caught] == [kind for kind in errors.KINDS if kind != "thin"]


@pytest.mark.parametrize(
    "old, kind",
    [("ThinWarning", "thin"), ("InsideOutWarning", "inside_out"), ("NotSettled", "unconverged")],
)
def test_a_class_that_is_gone_says_what_to_write(old, kind):
    with pytest.raises(
        AttributeError, match=rf'"{old}" is gone; .* kind "{kind}", as in .*\("ignore", "{kind}:"\)'
    ):
        getattr(ct, old)


@pytest.mark.parametrize("name", ENTRIES)
def test_entry_has_message_causes_and_remedy(name):
    assert re.findall(r"^:(\w+):", ENTRIES[name], re.M) == ["Message", "Causes", "Do"]


@pytest.mark.parametrize("name", ENTRIES)
def test_messages_are_those_of_the_sources(name):
    quoted = re.findall(r"``([^`]+)``", re.search(r":Message:(.*)", ENTRIES[name])[1])
    source = words()
    quoted = [text for text in quoted if not text.startswith("body[")]
    assert quoted and [text for text in quoted if text not in source] == []


def test_every_status_of_c_is_on_the_page():
    header = (ROOT / "libcontact" / "include" / "libcontact" / "base.h").read_text()
    codes = set(re.findall(r"^  (CT_\w+) = \d+", header.split("} ct_status;")[0], re.M))
    assert len(codes) == 13 and codes <= set(re.findall(r"``(CT_\w+)``", PAGE))


def test_one_address_also_when_an_error_tells_another_one(monkeypatch):
    monkeypatch.setenv("LIBCONTACT_DOCS", "book")
    inner = errors.GeometryError("the element is inverted")
    outer = schema.SceneError(f"bad mesh: {inner}", "body[0]")
    assert outer.reason == "bad mesh: the element is inverted"
    assert str(outer).count("[docs:") == 1 and str(outer).endswith("#sceneerror]")


def test_copies_say_the_same():
    for told in (
        errors.SceneWarning("thin", "a", "b"),
        run.StepTooLarge("a"),
        ct.SceneError("a", "b"),
    ):
        assert str(copy.copy(told)) == str(told) == str(pickle.loads(pickle.dumps(told)))


def test_a_scene_that_is_refused_prints_the_address(monkeypatch):
    monkeypatch.setenv("LIBCONTACT_DOCS", "book")
    with pytest.raises(ct.SceneError, match=r"symptoms\.html#sceneerror\]$"):
        ct.Scene({"title": "none"})
