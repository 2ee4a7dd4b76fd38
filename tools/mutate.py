"""Does a test notice when the line of its equation changes? ``mutate.py [--draw 40] [--seed 1] [label or page ...]``.

Draws computed equations of the book (the rows of ``trace.html``), changes a sign or factor in the quoted line, builds
what the tests of the row need, and runs them. All of that happens in a copy of the tree, ``build/mutate``; the tree
itself is only read. Prints a line per equation: the change, and the test that failed or that none did.
"""

import argparse
import filecmp
import functools
import importlib.util
import os
import random
import re
import shutil
import subprocess
import sys
from fnmatch import fnmatch
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COPY = ROOT / "build" / "mutate"
sys.path.insert(0, str(ROOT / "docs" / "_ext"))
from tracing import book  # noqa: E402

# Without the part for HDF5, which would take the place of h5py's own; the test of its equation compiles it.
LIBRARIES = [f"build/lib/libcontact{part}.so" for part in ("", "-gsl")]
SECONDS = 600  # a change that makes a test hang is noticed


def another(value):
    """A whole value that is another one, or itself of a tuple and where only a condition in it counts."""
    outer = value
    while outer != (outer := re.sub(r"\([^()]*\)", "", outer)):
        pass
    if "," in outer or re.fullmatch(r"0(\.0)?", value) or re.search(r"\? -?\w+ : -?\w+$", value):
        return value
    truth = re.search(r"[<>]|[=!]=|&&|\|\|", value.replace("->", ".")) and "?" not in value
    return f"!({value})" if truth else f"3 * ({value})"


# What changes in a statement, and into what: a sign, a factor, a divisor, a comparison, a whole value. No index,
# exponent, arrow or pointer.
CHANGES = (
    (r"[\w)\]]\s([+-])\s?[\w(.-]", lambda sign: "-" if sign == "+" else "+"),
    (r"[\w)\]]\s(\*)\s?[\w(.-]", lambda sign: "* 1.5 *"),
    (r"[\w)\]]\s(/)\s?[\w(.-]", lambda sign: "/ 1.5 /"),
    (r"[=(,?:]\s*(-)[\w(]", lambda sign: ""),
    (r"[\w)\]]\s([<>]=?)\s[\w(.-]", lambda sign: sign.translate(str.maketrans("<>", "><"))),
    (r"[\w)\]]\s([=!]=)\s", lambda sign: "!=" if sign == "==" else "=="),
    (r"(?:\breturn|[^=!<>]=)\s((?:[^;=]|[=!<>]=|(?<=\w)=(?=\S))+?)\s*(?:;|$)", another),
)
# Where a statement has none of these: a number of a table, the condition of a jump, a call that is left out.
ELSE = (
    (r"(?<![\w.])(\d+\.\d*[1-9]\d*|[1-9]\d*\.0)(?![\w.])", lambda number: f"1.5 * {number}"),
    (r"\bif\s(\(.*\))\s\w", lambda condition: f"(!{condition})"),
    (r"^\s*(?:for \([^;]*;[^;]*;[^)]*\) )?(\w+\(.*\));\s*$", lambda call: ""),
)


# A factor like (1 + 16 * DBL_EPSILON) or a term like 64.0 * DBL_EPSILON * size covers rounding, + 0j makes a number
# complex; none stands in an equation.
ROUNDING = r"\(1(\.0)? [-+] [^()]*(EPSILON|1e-\d+)\)|[-+] ([\d.]+ \* DBL_EPSILON \* \w+|0j)"


def changed(statement):
    """Versions of a statement, each with one change; what stands in brackets is an index, and comments and strings
    stay."""
    hide = lambda pattern, text: re.sub(pattern, lambda m: re.sub(r"\S", "_", m[0]), text)  # noqa: E731
    code = re.sub(r"//.*|/\*.*?\*/|#.*", lambda m: " " * len(m[0]), statement)
    hidden = hide(r"\[[^\[\]]*\]", hide(r"\"[^\"\n]*\"", hide(ROUNDING, code)))
    head = re.match(r"\s*for \([^;]*;[^;]*;[^)]*\)|", hidden).end()
    begin = re.compile(r"=|\breturn\b|\bif\b|\(").search(hidden, head)
    start = begin.start() if begin else head
    jump = re.match(r"\s*if \(", hidden)  # its value is a status
    found = []
    if hidden[start - 1 : start] in ("+", "-") and hidden[start : start + 1] == "=":  # += and -=
        found.append((start - 1, start, "-" if hidden[start - 1] == "+" else "+"))
    for changes, at in ((CHANGES, max(start - 1, 0)), (ELSE, 0)):
        for pattern, new in changes if not found or changes is CHANGES else ():
            for match in re.finditer(f"(?={pattern})", hidden[at:]):
                first, end = at + match.start(1), at + match.end(1)
                if new(statement[first:end]) != statement[first:end] and not (
                    jump and hidden[:first].endswith("return ")
                ):
                    found.append((first, end, new(statement[first:end])))
    for first, end, new in found:
        yield statement[:first] + new + statement[end:]


def is_program(path, text):
    """Whether a changed Python file still is one."""
    try:
        return path.suffix != ".py" or bool(compile(text, str(path), "exec"))
    except SyntaxError:
        return False


def run(command, **variables):
    """Exit status and output of a command in the copy."""
    env = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": str(COPY / "wrapper"), **variables}
    env["PYTHONDONTWRITEBYTECODE"] = "1"  # a change within a second of the last one is one
    known = {"cwd": COPY, "env": env, "timeout": SECONDS}
    try:
        done = subprocess.run(command, **known, capture_output=True, text=True, errors="replace")
    except subprocess.TimeoutExpired:
        return 1, "not ok: it does not end"
    return done.returncode, done.stdout + done.stderr


def make_copy():
    (COPY / "build").mkdir(parents=True, exist_ok=True)
    for name in subprocess.check_output(["git", "ls-files"], cwd=ROOT, text=True).split("\n"):
        old, new = COPY / name, ROOT / name
        if new.is_file() and not (old.is_file() and filecmp.cmp(new, old, shallow=False)):
            # What replaces a file is newer than all that was made of that.
            old.parent.mkdir(parents=True, exist_ok=True)
            (shutil.copy if old.is_file() else shutil.copy2)(new, old)
    for name in ("obj", "lib", "tests", "flags"):
        if (ROOT / "build" / name).exists() and not (COPY / "build" / name).exists():
            subprocess.run(["cp", "-a", ROOT / "build" / name, COPY / "build" / name], check=True)
    shutil.copy2(importlib.util.find_spec("libcontact._core").origin, COPY / "wrapper/libcontact")
    scenes = COPY / "wrapper/libcontact/scenes"  # as in the installed package
    shutil.copytree(COPY / "tutorials/scenes", scenes, dirs_exist_ok=True)


def failing(path, function):
    """Build and run a test: None if it can't be built, else what failed, or nothing."""
    if path.endswith(".c"):
        program = f"build/tests/{Path(path).stem}"
        if run(["make", "BOOTSTRAP=no", program])[0]:
            return None
        status, text = run([program])
    else:  # the package's compiled part takes its functions from libraries that are loaded before it
        if run(["make", "BOOTSTRAP=no", *LIBRARIES])[0]:
            return None
        loaded = " ".join(str(COPY / library) for library in LIBRARIES)
        pytest = [sys.executable, "-m", "pytest", "-q", "-x", "-k", function, path]
        status, text = run(pytest, LD_PRELOAD=loaded)
    found = re.findall(r"^(?:not ok|FAILED|ERROR).*", text, re.M)
    return (found or [f"status {status}"])[0] if status else ""


# Whether a test passes as long as nothing is changed.
passes = functools.cache(lambda path, function: failing(path, function) == "")


def try_equation(equation, dice):
    """A change of the line, and the test that noticed it, nothing if none did."""
    path, first, last = COPY / equation.code.path, equation.code.first - 1, equation.code.last
    text = path.read_text(encoding="utf-8")
    lines = text.splitlines(keepends=True)
    statement = "".join(lines[first:last])
    options = list(changed(statement))
    tests = {(t.path, t.function if t.path.endswith(".py") else ""): 0 for t in equation.tests}
    tests = [test for test in tests if passes(*test)]
    if not tests:
        return "no test passes as the line is", ""
    dice.shuffle(options)
    try:
        for option in options:
            new = "".join([*lines[:first], option, *lines[last:]])
            if not is_program(path, new):
                continue
            path.write_text(new, encoding="utf-8")
            results = []
            while len(results) < len(tests) and not any(results) and None not in results:
                results.append(failing(*tests[len(results)]))
            if None not in results:
                noticed = [f"\n    {result}" for result in results if result]
                return difference(statement, option), "".join(noticed)
    finally:
        path.write_text(text, encoding="utf-8")
    return "no change can be built", ""


def difference(before, after):
    """The lines that a change has touched."""
    lines = zip(before.split("\n"), after.split("\n"), strict=False)
    return " ".join(new.strip() for old, new in lines if old != new) or after.strip()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("which", nargs="*", default=["*"], help="patterns of labels or pages")
    parser.add_argument("--draw", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rows = [e for e in book(ROOT)[0].values() if e.kind == "computed" and e.code and e.tests]
    rows = [e for e in rows if any(fnmatch(n, w) for n in (e.label, e.page) for w in given.which)]
    dice, missed = random.Random(given.seed), 0
    make_copy()
    for equation in dice.sample(rows, min(given.draw, len(rows))):
        change, noticed = try_equation(equation, dice)
        missed += not noticed
        where = f"{equation.code.path}:{equation.code.first}"
        print(equation.label, where, change, noticed or "\n    NO TEST NOTICED", flush=True)
    print(f"{missed} missed")
    return missed > 0


if __name__ == "__main__":
    sys.exit(main())
