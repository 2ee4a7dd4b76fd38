"""Run every test and count: ``run_tests.py BUILD [--no-pytest] [--skip REASON]... PROGRAM...``.

``make test`` and ``make check-c`` call it. The C programs run first, then pytest over the Python,
tutorial, docs and exercise tests. ``--skip`` counts what could not be built here. The line before the last
counts different checks: one that ran plain and under sanitizers is one check. The last line is
``N passed, M failed, K skipped``; a check fails if it fails in any build of its program. The exit
code is not 0 exactly when something failed.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 1200  # a program that hangs is a failure
PYTEST_SECONDS = 3600
TAP = re.compile(r"^(not )?ok (\d+)(.*)$")
PLAIN, SANITIZED, PYTHON = "plain", "under sanitizers", "pytest"
SHOWN = 6000  # characters of a failed program's output


class Count:
    """Results by check; a check is the same in each build of its program and counts once."""

    def __init__(self) -> None:
        self.results: dict[tuple[str, object], str] = {}  # by program and number, or name
        self.ways: dict[str, set[str]] = {}  # how each program was built
        self.names: list[str] = []  # of what failed
        self.endings = 0  # programs that did not end as their checks say
        self.left_out = 0  # what could not be built here

    def add(self, program: str, check: object, result: str) -> None:
        """The worst result of all builds; skipped only where every build skips."""
        worse = ("skipped", "passed", "failed")
        known = self.results.get((program, check), "skipped")
        self.results[program, check] = max(known, result, key=worse.index)

    def fail(self, name: str) -> None:
        self.endings += 1
        self.names.append(name)

    def number(self, result: str, programs: Iterable[str] | None = None) -> int:
        """How many checks, of these programs or of all, have this result."""
        return sum(
            found == result and (programs is None or program in programs)
            for (program, _), found in self.results.items()
        )

    def run(self, programs: Iterable[str]) -> int:
        return self.number("passed", programs) + self.number("failed", programs)


def run_program(program: str) -> tuple[str, int, str, float]:
    """One test program: its name, exit code, output and seconds."""
    start = time.perf_counter()
    environment = {
        **os.environ,
        "ASAN_OPTIONS": "detect_leaks=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
        "OMP_WAIT_POLICY": "passive",
    }
    try:
        done = subprocess.run(
            [program],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=SECONDS,
            env=environment,
            stdin=subprocess.DEVNULL,
        )
        code, output = done.returncode, done.stdout
    except subprocess.TimeoutExpired as late:
        code, output = (
            -signal.SIGKILL,
            f"{(late.stdout or b'').decode(errors='replace')}\nended after {SECONDS} s",
        )
    except OSError as error:
        code, output = 127, str(error)
    return Path(program).name, code, output, time.perf_counter() - start


def how_it_ended(code: int) -> str:
    try:
        return (
            f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with code {code}"
        )
    except ValueError:
        return f"was ended by signal {-code}"


def program_and_way(name: str) -> tuple[str, str]:
    """``test_x`` and ``asan_x`` are builds of one program x, ``embed_x_c_static`` one of embed_x."""
    kind, _, topic = name.partition("_")
    if kind == "embed":
        program, language, library = name.rsplit("_", 2)
        return program, f"{language} {library}"
    return topic, {"test": PLAIN, "asan": SANITIZED}[kind]


def count_tap(count: Count, name: str, code: int, output: str) -> None:
    """Add the checks of one build; a crash or a plan that does not match is one failure more."""
    program, way = program_and_way(name)
    count.ways.setdefault(program, set()).add(way)
    lines = [match for match in map(TAP.match, output.splitlines()) if match]
    failed = [match[0] for match in lines if match[1]]
    for match in lines:
        result = "failed" if match[1] else "skipped" if "# SKIP" in match[3] else "passed"
        count.add(program, int(match[2]), result)
    count.names += [f"{name}: {line}" for line in failed]
    plan = re.findall(r"^1\.\.(\d+)$", output, re.M)
    if code != (1 if failed else 0):
        count.fail(f"{name}: {how_it_ended(code)} after {len(lines)} checks")
    elif not plan or int(plan[-1]) != len(lines):
        planned = f"planned {plan[-1]}" if plan else "no plan"
        count.fail(f"{name}: printed {len(lines)} checks and {planned}")


def run_programs(programs: list[str], count: Count) -> None:
    """Run the C programs, as many at a time as there are processors; of a failed one, show everything but its passed
    tests."""
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        for name, code, output, seconds in pool.map(run_program, programs):
            before = len(count.names)
            count_tap(count, name, code, output)
            failed = len(count.names) > before
            print(f"{'FAILED' if failed else 'ok':6} {name} ({seconds:.1f} s)", flush=True)
            if failed:
                lines = [line for line in output.splitlines() if not line.startswith("ok ")]
            else:
                lines = [
                    line for line in output.splitlines() if TAP.match(line) and "# SKIP" in line
                ]
            if lines:
                print("    " + "\n    ".join(lines)[-SHOWN:], flush=True)


def run_pytest(build: Path, count: Count) -> None:
    """pytest over tests/python, tests/docs and docs/exercises, counted from its report."""
    report = build / "tests" / "pytest.xml"
    report.unlink(missing_ok=True)
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-n",
        str(os.cpu_count() or 1),
        "--dist",
        "loadfile",
        f"--junitxml={report}",
        "-p",
        "no:cacheprovider",
        "tests/python",
        "tests/docs",
        "docs/exercises",
    ]
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        "LIBCONTACT_BUILD": str(build.resolve()),
        "OMP_WAIT_POLICY": "passive",
    }
    before = len(count.names)
    try:
        code = subprocess.run(command, cwd=ROOT, env=environment, timeout=PYTEST_SECONDS).returncode
    except subprocess.TimeoutExpired:
        count.fail(f"pytest did not end within {PYTEST_SECONDS} s")
        return
    if not report.exists():
        count.fail(f"pytest {how_it_ended(code)} and without a report")
        return
    for case in ElementTree.parse(report).iter("testcase"):
        name = f"{case.get('classname')}::{case.get('name')}"
        kinds = {child.tag for child in case}
        if kinds & {"failure", "error"}:
            count.names.append(name)
            count.add(PYTHON, name, "failed")
        else:
            count.add(PYTHON, name, "skipped" if "skipped" in kinds else "passed")
    if code != 0 and len(count.names) == before:
        count.fail(f"pytest {how_it_ended(code)}")


def what_ran(count: Count) -> str:
    """The line before the last: how many different checks, in how many programs, run how."""
    parts = []
    tests = {name for name, ways in count.ways.items() if ways & {PLAIN, SANITIZED}}
    if tests:
        ways = [way for way in (PLAIN, SANITIZED) if any(way in count.ways[t] for t in tests)]
        parts.append(
            f"{count.run(tests)} checks in {len(tests)} programs, run {' and '.join(ways)}"
        )
    hosts = {name: ways for name, ways in count.ways.items() if name not in tests}
    if hosts:
        ways = sorted(set().union(*hosts.values()))
        parts.append(
            f"{count.run(hosts)} checks in {len(hosts)} host programs, built as {', '.join(ways)}"
        )
    python = count.run({PYTHON})
    return "; ".join([*parts, f"{python} Python tests"] if python else parts)


def main() -> int:
    parser = argparse.ArgumentParser(description="Run every test and count.")
    parser.add_argument("build", type=Path)
    parser.add_argument("--no-pytest", action="store_true")
    parser.add_argument("--skip", action="append", default=[], metavar="REASON")
    parser.add_argument("programs", nargs="*")
    options, count = parser.parse_intermixed_args(), Count()
    for reason in options.skip:
        count.left_out += 1
        print(f"skip   {reason}")
    run_programs(options.programs, count)
    sys.stdout.flush()
    if not options.no_pytest:
        run_pytest(options.build, count)
    if count.names:
        print("\nfailed:", *count.names, sep="\n  ")
    failed = count.number("failed") + count.endings
    skipped = count.number("skipped") + count.left_out
    print(what_ran(count))
    print(f"{count.number('passed')} passed, {failed} failed, {skipped} skipped", flush=True)
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
