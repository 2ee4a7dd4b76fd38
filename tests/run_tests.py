"""Run every test and count: ``run_tests.py BUILD PROGRAM...`` runs the C programs, then pytest over the Python, tutorial and docs tests.

The last line is ``N passed, M failed, K skipped``; the exit code is not 0 exactly when something failed. Used by ``make test``.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SECONDS = 1200  # a program that hangs is a failure
TAP = re.compile(r"^(not )?ok\b(.*)$")


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
    environment = {**os.environ, "ASAN_OPTIONS": "detect_leaks=1", "UBSAN_OPTIONS": "print_stacktrace=1:halt_on_error=1"}
    try:
        done = subprocess.run([program], capture_output=True, text=True, errors="replace", timeout=SECONDS, env=environment, stdin=subprocess.DEVNULL)
        code, output = done.returncode, done.stdout + done.stderr
    except subprocess.TimeoutExpired as late:
        code, output = -1, f"{(late.stdout or b'').decode(errors='replace')}\nended after {SECONDS} s"
    return Path(program).name, code, output, time.perf_counter() - start


def count_tap(count: Count, name: str, code: int, output: str) -> None:
    """Add the lines of one program; a program that crashed or printed no plan counts as one failure more."""
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
    broken = code != (1 if failed else 0) or not plan or int(plan[-1]) != passed + skipped + len(failed)
    count.passed += passed
    count.skipped += skipped
    for line in failed:
        count.fail(f"{name}: {line}")
    if broken:
        count.fail(f"{name}: ended with code {code} after {passed + skipped + len(failed)} lines")
        print(output[-6000:])


def run_programs(programs: list[str], count: Count) -> None:
    with ThreadPoolExecutor(max_workers=os.cpu_count() or 1) as pool:
        for name, code, output, seconds in pool.map(run_program, programs):
            before = count.failed
            count_tap(count, name, code, output)
            lines = [line for line in output.splitlines() if line.startswith("not ok")]
            print(f"{'FAILED' if count.failed > before else 'ok':6} {name} ({seconds:.1f} s)", *lines, sep="\n    " if lines else "", flush=True)


def run_pytest(build: Path, count: Count) -> None:
    """pytest over tests/python and tests/docs, counted from its report."""
    report = build / "tests" / "pytest.xml"
    report.unlink(missing_ok=True)
    command = [sys.executable, "-m", "pytest", "-q", "-n", str(os.cpu_count() or 1), "--dist", "loadfile", f"--junitxml={report}",
               "-p", "no:cacheprovider", "tests/python", "tests/docs"]
    environment = {**os.environ, "MPLBACKEND": "Agg", "LIBCONTACT_BUILD": str(build.resolve()), "OMP_WAIT_POLICY": "passive"}
    code = subprocess.run(command, cwd=ROOT, env=environment).returncode
    if not report.exists():
        count.fail(f"pytest ended with code {code} and without a report")
        return
    for case in ElementTree.parse(report).iter("testcase"):
        kinds = {child.tag for child in case}
        if kinds & {"failure", "error"}:
            count.fail(f"{case.get('classname')}::{case.get('name')}")
        elif "skipped" in kinds:
            count.skipped += 1
        else:
            count.passed += 1
    if code not in (0, 1) and not count.names:
        count.fail(f"pytest ended with code {code}")


def main() -> int:
    build, count = Path(sys.argv[1]), Count()
    run_programs(sys.argv[2:], count)
    sys.stdout.flush()
    run_pytest(build, count)
    if count.names:
        print("\nfailed:", *count.names, sep="\n  ")
    print(f"{count.passed} passed, {count.failed} failed, {count.skipped} skipped", flush=True)
    return int(count.failed > 0)


if __name__ == "__main__":
    sys.exit(main())
