"""The table of the courses: its names exist, and no week takes longer than its hours."""

import re
from pathlib import Path

import course
import pytest
from parts import parts

DOCS = Path(__file__).resolve().parents[2] / "docs"

TABLE = course.table()
TEXTS = {name: (DOCS / f"{name}.rst").read_text() for name in course.chapters(TABLE)}


def test_the_long_course_has_all_chapters_in_their_order():
    book = parts(DOCS)
    named = [name for week in TABLE["twelve"]["weeks"] for name in week["chapters"]]
    assert named == [*book["week/index"], *book["theory/index"], "theory/enforcement"]


@pytest.mark.parametrize("kind", ["skipped", "curious"])
def test_marked_sections_exist(kind):
    for chapter, titles in TABLE[kind].items():
        own = [section.title for section in course.sections(TEXTS[chapter])]
        assert set(titles) <= set(own), chapter
    assert not any(
        set(titles) & set(TABLE["curious"].get(chapter, ()))
        for chapter, titles in TABLE["skipped"].items()
    )


@pytest.mark.parametrize("name", ["six", "twelve"])
def test_no_week_takes_longer_than_its_hours(name):
    for number, week in enumerate(course.weeks(name), 1):
        print(f"week {number}: {week.reading:.0f} min of reading, {week.minutes:.0f} in all")
        assert 120 < week.minutes <= 60 * TABLE[name]["hours"], (
            f"week {number} of the course {name!r}: mark a new section in docs/course.toml, or take an exercise less"
        )
        own = {label for chapter in week.chapters for label in course.exercises(DOCS, chapter)}
        assert set(week.exercises) <= own and len(week.exercises) >= 5


def test_sections_are_counted():
    page = (
        "Title\n=====\n\nOne two.\n\nFirst\n-----\n\nThree.\n\n.. math::\n\n   a\n\n"
        ".. weave:: x y\n\nSecond\n------\n\nFour five six.\n\n.. include:: /exercises/x.rst\nno\n"
    )
    assert [tuple(section) for section in course.sections(page)] == [
        ("", 3, 0, 0),
        ("First", 2, 1, 1),
        ("Second", 4, 0, 0),
    ]


def test_marks():
    assert course.mark(TABLE, "theory/brick", "Sides") == "may be skipped"
    assert course.mark(TABLE, "theory/mesh", "Rings") == "for the curious"
    assert course.mark(TABLE, "theory/mesh", "Further reading") == "for the curious"
    assert course.mark(TABLE, "theory/mesh", "Nodes and elements") == "course"
    assert re.search(r"syllabus:: six", (DOCS / "start" / "course.rst").read_text())
