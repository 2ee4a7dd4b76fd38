"""Run every test and count: ``run_tests.py BUILD [--no-pytest] [--skip REASON]... PROGRAM...``, used by ``make test`` and ``make check-c``.

The C programs run first, then pytest over the Python, tutorial and docs tests. ``--skip`` counts what could not be built here. The last line is
``N passed, M failed, K skipped``; the exit code is not 0 exactly when something failed.
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
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 1200  # a program that hangs is a failure
PYTEST_SECONDS = 3600
TAP = re.compile(r"^(not )?ok\b(.*)$")
SHOWN = 6000  # characters of a failed program's output


class Count:
    """Passed, failed and skipped tests, and the names of the failed ones."""

    def __init__(self) -> None:
        self.passed = self.failed = self.skipped = 0
        self.names: list[str] = []

    def fail(self, name: str) -> None:
        self.failed += 1
        self.names.append(name)


def run_program(program: str) -> tuple[str, int, str, float]:
    """One test program: its name, exit code, output and seconds."""
    start = time.perf_counter()
    environment = {
        **os.environ,
        "ASAN_OPTIONS": "detect_leaks=1",
        "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1",
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


def count_tap(count: Count, name: str, code: int, output: str) -> None:
    """Add the lines of one program; a program that crashed or whose plan is not what it printed counts as one failure more."""
    failed, passed, skipped = [], 0, 0
    for line in output.splitlines():
        match = TAP.match(line)
        if match and match[1]:
            failed.append(line)
        elif match and "# SKIP" in line:
            skipped += 1
        elif match:
            passed += 1
    plan = re.findall(r"^1\.\.(\d+)$", output, re.M)
    total = passed + skipped + len(failed)
    count.passed += passed
    count.skipped += skipped
    for line in failed:
        count.fail(f"{name}: {line}")
    if code != (1 if failed else 0):
        count.fail(f"{name}: {how_it_ended(code)} after {total} tests")
    elif not plan or int(plan[-1]) != total:
        count.fail(
            f"{name}: printed {total} tests and {f'planned {plan[-1]}' if plan else 'no plan'}"
        )


def run_programs(programs: list[str], count: Count) -> None:
    """Run the C programs, as many at a time as there are processors; of a failed one, show everything but its passed tests."""
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        for name, code, output, seconds in pool.map(run_program, programs):
            before = count.failed
            count_tap(count, name, code, output)
            print(
                f"{'FAILED' if count.failed > before else 'ok':6} {name} ({seconds:.1f} s)",
                flush=True,
            )
            if count.failed > before:
                lines = [line for line in output.splitlines() if not line.startswith("ok ")]
            else:
                lines = [
                    line for line in output.splitlines() if TAP.match(line) and "# SKIP" in line
                ]
            if lines:
                print("    " + "\n    ".join(lines)[-SHOWN:], flush=True)


def run_pytest(build: Path, count: Count) -> None:
    """pytest over tests/python and tests/docs, counted from its report."""
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
    ]
    environment = {
        **os.environ,
        "MPLBACKEND": "Agg",
        "LIBCONTACT_BUILD": str(build.resolve()),
        "OMP_WAIT_POLICY": "passive",
    }
    before = count.failed
    try:
        code = subprocess.run(command, cwd=ROOT, env=environment, timeout=PYTEST_SECONDS).returncode
    except subprocess.TimeoutExpired:
        count.fail(f"pytest did not end within {PYTEST_SECONDS} s")
        return
    if not report.exists():
        count.fail(f"pytest {how_it_ended(code)} and without a report")
        return
    for case in ElementTree.parse(report).iter("testcase"):
        kinds = {child.tag for child in case}
        if kinds & {"failure", "error"}:
            count.fail(f"{case.get('classname')}::{case.get('name')}")
        elif "skipped" in kinds:
            count.skipped += 1
        else:
            count.passed += 1
    if code != 0 and count.failed == before:
        count.fail(f"pytest {how_it_ended(code)}")


def main() -> int:
    parser = argparse.ArgumentParser(description="Run every test and count.")
    parser.add_argument("build", type=Path)
    parser.add_argument("--no-pytest", action="store_true")
    parser.add_argument("--skip", action="append", default=[], metavar="REASON")
    parser.add_argument("programs", nargs="*")
    options, count = parser.parse_intermixed_args(), Count()
    for reason in options.skip:
        count.skipped += 1
        print(f"skip   {reason}")
    run_programs(options.programs, count)
    sys.stdout.flush()
    if not options.no_pytest:
        run_pytest(options.build, count)
    if count.names:
        print("\nfailed:", *count.names, sep="\n  ")
    print(f"{count.passed} passed, {count.failed} failed, {count.skipped} skipped", flush=True)
    return int(count.failed > 0)


if __name__ == "__main__":
    sys.exit(main())
