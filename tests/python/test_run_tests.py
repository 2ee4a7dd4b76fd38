"""How ``make test`` counts: a check once, however many builds of its program ran."""

import sys
from pathlib import Path

import pytest
from commands import captured

RUNNER = Path(__file__).resolve().parents[1] / "run_tests.py"

PASS = "echo 'ok 1 - sum'; echo 'ok 2 - product off by 1e-16'; echo 1..2"
PASS_WITH_ANOTHER_TEXT = PASS.replace("1e-16", "2e-16")
SKIP = "echo 'ok 1 - sum'; echo 'ok 2 - product # SKIP no GSL'; echo 1..2"
FAIL = "echo 'ok 1 - sum'; echo 'not ok 2 - product'; echo 1..2; exit 1"
CRASH = "echo 'ok 1 - sum'; kill -SEGV $$"
SHORT = "echo 'ok 1 - sum'; echo 1..2"
LIE = "echo 'not ok 1 - sum'; echo 1..1"

BOTH = "run plain and under sanitizers"
TWO = f"2 checks in 1 programs, {BOTH}"
HOST = "2 checks in 1 host programs, built as c static, cxx static"


@pytest.mark.parametrize(
    "programs, ran, last",
    [
        ({"test_a": PASS}, "2 checks in 1 programs, run plain", "2 passed, 0 failed, 0"),
        (
            {"test_a": PASS, "test_b": PASS, "asan_a": PASS_WITH_ANOTHER_TEXT, "asan_b": PASS},
            f"4 checks in 2 programs, {BOTH}",
            "4 passed, 0 failed, 0",
        ),
        ({"test_a": PASS, "asan_a": FAIL}, TWO, "1 passed, 1 failed, 0"),
        ({"test_a": FAIL, "asan_a": PASS}, TWO, "1 passed, 1 failed, 0"),
        ({"test_a": FAIL, "asan_a": FAIL}, TWO, "1 passed, 1 failed, 0"),
        ({"test_a": SKIP, "asan_a": PASS}, TWO, "2 passed, 0 failed, 0"),
        (
            {"test_a": SKIP, "asan_a": SKIP},
            f"1 checks in 1 programs, {BOTH}",
            "1 passed, 0 failed, 1",
        ),
        ({"test_a": PASS, "asan_a": CRASH}, TWO, "2 passed, 1 failed, 0"),
        ({"test_a": SHORT}, "1 checks in 1 programs, run plain", "1 passed, 1 failed, 0"),
        ({"test_a": LIE}, "1 checks in 1 programs, run plain", "0 passed, 2 failed, 0"),
        (
            {"embed_host_c_static": PASS, "embed_host_cxx_static": PASS},
            HOST,
            "2 passed, 0 failed, 0",
        ),
    ],
)
def test_counts(tmp_path, programs, ran, last):
    for name, script in programs.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{script}\n")
        (tmp_path / name).chmod(0o755)
    done = captured(
        [sys.executable, RUNNER, tmp_path, "--no-pytest", "--skip", "no compiler"]
        + [tmp_path / name for name in programs]
    )
    passed_and_failed, skipped = last.rsplit(" ", 1)
    last = f"{passed_and_failed} {int(skipped) + 1} skipped"  # one more by --skip
    assert done.stdout.splitlines()[-2:] == [ran, last]
    assert done.returncode == (" 0 failed" not in last)


def test_c_programs_wait_without_spinning(tmp_path):
    program = tmp_path / "test_a"
    program.write_text('#!/bin/sh\n[ "$OMP_WAIT_POLICY" = passive ] && echo ok 1 - a\necho 1..1\n')
    program.chmod(0o755)
    done = captured([sys.executable, RUNNER, tmp_path, "--no-pytest", program])
    assert done.returncode == 0, done.stdout
