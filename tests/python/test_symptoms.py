"""Errors and warnings end with the address of their entry on the page "Symptoms"; each entry quotes a message that
exists."""

import copy
import pickle
import re
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


CLASSES = sorted(
    (
        kind
        for kind in family(errors.Error) | family(errors.SceneWarning)
        if kind.__module__.partition(".")[0] == "libcontact"
    ),
    key=lambda kind: kind.__name__,
)


@cache
def words():
    """The sources of the package and of the C library with their strings joined across lines."""
    paths = [*(ROOT / "wrapper").rglob("*.py"), *(ROOT / "libcontact" / "src").rglob("*.c")]
    text = "\n".join(path.read_text() for path in paths)
    return re.sub(r'"\s*\n\s*f?"', "", text)


def test_every_class_has_an_entry_and_every_entry_a_class():
    assert len(CLASSES) > 20
    assert {kind.__name__ for kind in CLASSES} == set(ENTRIES)


@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_text_ends_with_the_address(kind):
    text = str(kind("what was found"))
    found = re.search(r"what was found \[docs: reference/symptoms\.html#(\w+)\]$", text)
    assert found and found[1] in {name.lower() for name in ENTRIES}


@pytest.mark.parametrize("name", ENTRIES)
def test_entry_has_message_causes_and_remedy(name):
    assert re.findall(r"^:(\w+):", ENTRIES[name], re.M) == ["Message", "Causes", "Do"]


@pytest.mark.parametrize("name", [name for name in ENTRIES if name != "SceneWarning"])
def test_messages_are_those_of_the_sources(name):
    quoted = re.findall(r"``([^`]+)``", re.search(r":Message:(.*)", ENTRIES[name])[1])
    source = words()
    quoted = [text for text in quoted if not text.startswith("body[")]
    assert quoted and [text for text in quoted if text not in source] == []


def test_every_status_of_c_is_on_the_page():
    header = (ROOT / "libcontact" / "include" / "libcontact" / "base.h").read_text()
    codes = set(re.findall(r"^  (CT_\w+) = \d+", header.split("} ct_status;")[0], re.M))
    assert len(codes) == 13 and codes <= set(re.findall(r"``(CT_\w+)``", PAGE))


def test_one_address_also_when_an_error_tells_another_one():
    inner = errors.GeometryError("the element is inverted")
    outer = schema.SceneError(f"bad mesh: {inner}", "body[0]")
    assert outer.reason == "bad mesh: the element is inverted"
    assert str(outer).count("[docs:") == 1 and str(outer).endswith("#sceneerror]")


def test_copies_say_the_same():
    for told in (errors.ChatterWarning("a", "b"), run.StepTooLarge("a"), ct.SceneError("a", "b")):
        assert str(copy.copy(told)) == str(told) == str(pickle.loads(pickle.dumps(told)))


def test_a_scene_that_is_refused_prints_the_address():
    with pytest.raises(ct.SceneError, match=r"symptoms\.html#sceneerror\]$"):
        ct.Scene({"title": "none"})
