"""Subjects of commits begin with a room and have at most 72 characters (docs/develop/contributing.rst)."""

import re
from pathlib import Path

import pytest
from commands import captured

ROOT = Path(__file__).resolve().parents[2]
SINCE = (
    "eea0352"  # the rule holds after this revision; one that was pushed against it becomes SINCE
)


def fits(subject):
    return len(subject) <= 72 and re.match(r"[a-z][\w./-]*(, [a-z][\w./-]*)*: \S", subject)


def test_subjects_of_commits_fit():
    log = ["git", "log", "--no-merges", "--format=%s", f"{SINCE}..HEAD"]
    try:
        done = captured(log, cwd=ROOT)
    except OSError:
        pytest.skip("no git")
    if done.returncode != 0:
        pytest.skip("no git checkout, or one without its history")
    assert [subject for subject in done.stdout.splitlines() if not fits(subject)] == []


@pytest.mark.parametrize(
    "subject, is_right",
    [
        ("contact: a law without a row is refused before its row is read", True),
        ("step, host: one loop takes the stages", True),
        ("A law without a row is refused", False),
        ("contact: " + 64 * "x", False),
    ],
)
def test_the_rule(subject, is_right):
    assert bool(fits(subject)) == is_right
