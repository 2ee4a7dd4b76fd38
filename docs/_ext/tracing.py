"""Which line computes an equation, and which test would notice if it were wrong: the page ``trace.html``.

A labelled equation is a *definition* or a *step* of a derivation, which its directive says (``:class: definition``,
``:class: step``), or it is *computed*. Then a listing on its own page quotes the line that computes it, with
``(eq:label)`` in a comment on this line or above it, and a test names it: ``eq:label`` in a comment or docstring of the
test, or the decorator ``@executes("label")``. The build warns of an equation without a line and of a class of another
name (``trace.code``), and of an equation without a test and of a test that names an equation which no page defines
(``trace.test``).

``python docs/_ext/tracing.py theory/mass`` prints what a chapter lacks, in a second and without Sphinx; without
arguments it prints a row per chapter.
"""

from __future__ import annotations

import ast
import io
import re
import sys
import tokenize
from collections import Counter
from dataclasses import dataclass, field
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

from csource import LABEL, Source, Span, WeaveError

KINDS = ("computed", "definition", "step")
DIRECTIVE = re.compile(
    r"^(?P<indent>[ ]*)\.\. (?P<name>math|weave|literalinclude)::(?P<rest>[^\n]*)\n(?P<options>(?:(?P=indent)[ ]+:[^\n]*\n)*)",
    re.MULTILINE,
)
# Lines above the one that computes: a loop, a brace, the head of a function, a declaration without a value.
PREPARES = re.compile(
    r"^\s*(for\b[^;]*(;[^;]*){2}|for\b[^;=]*:|else|do|[{}\s]*|def .*|@.*|(static|inline|const|void|CT_INLINE)[^=;]*|#pragma.*|(?!\s*return)[\w\s*,\[\]]+;)\s*$"
)


@dataclass(frozen=True)
class Place:
    """Lines of a file, counted from 1, with their text in one line, and the function around them."""

    path: str
    first: int
    last: int
    text: str = ""
    function: str = ""


@dataclass
class Equation:
    label: str
    page: str
    line: int
    kind: str = "computed"
    code: Place | None = None
    tests: list[Place] = field(default_factory=list)
    executed: list[Place] = field(default_factory=list)

    @property
    def faults(self) -> list[tuple[str, str]]:
        """What is missing: subtype of the warning and its text."""
        if self.kind not in KINDS:
            return [("code", f"has the class {self.kind}, and not definition or step")]
        found = []
        if self.kind == "computed" and not self.code:
            found.append(("code", "has no line in a listing on its page, and no class"))
        if self.kind == "computed" and not self.tests:
            found.append(("test", "is named by no test"))
        return found


class PythonSource:
    """A Python file, with what ``Source`` has of a C file: lines, code without comments, labels, functions."""

    def __init__(self, text: str):
        self.lines = text.splitlines()
        tree = ast.parse(text)
        blank = [
            (token.start, token.end)
            for token in tokenize.generate_tokens(io.StringIO(text).readline)
            if token.type == tokenize.COMMENT
        ]
        self.functions, self.executes = [], []
        for node in ast.walk(tree):
            kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
            if isinstance(node, (ast.Module, *kinds)) and ast.get_docstring(node) is not None:
                doc = node.body[0]
                blank.append(((doc.lineno, doc.col_offset), (doc.end_lineno, doc.end_col_offset)))
            if isinstance(node, kinds):
                first = min([node.lineno, *(mark.lineno for mark in node.decorator_list)])
                self.functions.append(Span(node.name, first, node.end_lineno, node.name))
                for mark in node.decorator_list:
                    if isinstance(mark, ast.Call) and getattr(mark.func, "id", "") == "executes":
                        self.executes += [(label.value, node.lineno) for label in mark.args]
        code, self.named = list(self.lines), []
        for (first, begin), (last, end) in blank:
            for i in range(first, last + 1):
                line = self.lines[i - 1]
                left, right = begin if i == first else 0, end if i == last else len(line)
                self.named += [
                    (match["label"], i, match["role"] is not None)
                    for match in LABEL.finditer(line, left, right)
                ]
                code[i - 1] = code[i - 1][:left] + " " * (right - left) + code[i - 1][right:]
        self.code = "\n".join(code)

    def labels(self, first: int = 1, last: int = 2**31) -> list[tuple[str, int, bool]]:
        return [found for found in self.named if first <= found[1] <= last]

    def quote(self, options: dict[str, str]) -> Span:
        """What ``literalinclude`` shows with these options."""
        if "pyobject" in options:
            name = options["pyobject"].split(".")[-1]
            return next((f for f in self.functions if f.name == name), Span(name, 1, 0))
        within = lambda key: next(
            i for i, line in enumerate([*self.lines, options[key]], 1) if options[key] in line
        )  # noqa: E731
        first = within("start-at") if "start-at" in options else 1
        last = within("end-at") if "end-at" in options else len(self.lines)
        if "end-before" in options:
            last = within("end-before") - 1
        return Span("", first, last)


def read_source(path: Path) -> Source | PythonSource:
    return parse(path.read_text(encoding="utf-8"), path.suffix == ".py")


@cache
def parse(text: str, python: bool) -> Source | PythonSource:
    """A source, parsed once however many listings quote it."""
    return PythonSource(text) if python else Source(text)


def statement(source: Source | PythonSource, line: int, last: int) -> tuple[int, int] | None:
    """
    Lines of the statement that a comment in this line is about: the one before the comment, else the first below that
    computes.

    It is looked for down to ``last`` and to the next comment that names an equation or is a heading. Of a comment above
    a function, in its body.
    """
    # Of a preprocessor line, which is blank in the code, the source itself.
    text = [
        raw if raw.lstrip().startswith("#") and isinstance(source, Source) else code
        for raw, code in zip(source.lines, source.code.splitlines(), strict=False)
    ]
    if text[line - 1].strip():
        return line, _end(source, text, line, last)
    stops = [at for _, at, _ in source.labels(line + 1, last) if not text[at - 1].strip()]
    stops += [heading.first for heading in getattr(source, "headings", []) if heading.first > line]
    after = [at for at in stops if any(row.strip() for row in text[line : at - 1])]
    first, last = line + 1, min([last, *(at - 1 for at in after)])
    if not any(f.first <= line <= f.last for f in source.functions):
        heads = [f.first for f in source.functions if first <= f.first <= last]
        body = [i for i in range(min(heads, default=last), last + 1) if "{" in text[i - 1]]
        if body and not text[body[0] - 1].rstrip().endswith("}"):
            first = body[0] + 1
    rows = [i for i in range(first, last + 1) if not PREPARES.match(text[i - 1])]
    found = next((i for i in rows if _computes(text[i - 1])), rows[0] if rows else None)
    return found and (found, _end(source, text, found, last))


def _computes(text: str) -> bool:
    """Whether there is an operator beside the assignment, more than a sign, and no mere index."""
    if re.match(r"\s*(const )?(int|int32_t|int64_t|size_t|ct_status)\b", text):
        return False
    right = text = text.replace("->", ".")
    if not re.match(r"\s*(}\s*)?(else )?if\b", text):
        right = re.split(r"(?<![=<>!])=(?!=)|\breturn\b", text, maxsplit=1)[-1]
    operator = r"[\w)\]]\s*([-+*/%?<>]|[=!<>]=)\s*[\w(!&.-]"
    return bool(re.search(operator, right) or re.search(r"[-+*/]=", text))


def _end(source: Source | PythonSource, text: list[str], first: int, last: int) -> int:
    """Last line of the statement that begins in this line."""
    level = 0
    for i in range(first, last + 1):
        level += len(re.findall(r"[(\[]", text[i - 1])) - len(re.findall(r"[)\]]", text[i - 1]))
        done = isinstance(source, PythonSource) or re.search(r"[;{}]\s*$|^\s*#", text[i - 1])
        if level <= 0 and done:
            return i
    return last


def listings(page: Path, text: str, root: Path):
    """The parts of sources that a page quotes: file, its source, first and last line."""
    for match in DIRECTIVE.finditer(text):
        options = dict(re.findall(r":([\w-]+):[ ]*(.*)", match["options"]))
        rest = match["rest"].strip()
        try:
            if match["name"] == "weave":
                name, what = rest.split(maxsplit=1)
                source = read_source(path := root / name)
                span = source.quote(what, "doc" in options)
            elif match["name"] == "literalinclude" and rest.endswith(".py"):
                source = read_source(path := (page.parent / rest).resolve())
                span = source.quote(options)
            else:
                continue
        except (OSError, ValueError, WeaveError):
            continue  # the directive itself reports it
        yield path, source, span.first, span.last


def read_page(name: str, page: Path, root: Path) -> list[Equation]:
    """The labelled equations of a page, each with the line that the page quotes for it."""
    text = page.read_text(encoding="utf-8")
    found = {}
    for match in DIRECTIVE.finditer(text):
        options = dict(re.findall(r":([\w-]+):[ ]*(.*)", match["options"]))
        if match["name"] == "math" and "label" in options:
            label = options["label"].strip()
            line = text.count("\n", 0, match.start()) + 1
            found[label] = Equation(label, name, line, options.get("class", "computed").strip())
    near: dict[str, int] = {}
    for path, source, first, last in listings(page, text, root):
        for label, line, role in source.labels(first, last):
            where = None if role or label not in found else statement(source, line, last)
            # The nearer to its comment, the surer it is the line that is meant.
            if where and where[0] - line < near.get(label, 1000):
                near[label] = where[0] - line
                found[label].code = place(path, source, *where, root)
    return list(found.values())


def place(path: Path, source: Source | PythonSource, first: int, last: int, root: Path) -> Place:
    code = source.code.splitlines()[first - 1 : last]
    if not "".join(code).strip():
        code = source.lines[first - 1 : last]
    text = " ".join(" ".join(code).split())
    around = [f.name for f in source.functions if f.first <= first <= f.last]
    name = path.relative_to(root).as_posix()
    return Place(name, first, last, text, around[-1] if around else "")


def test_names(root: Path, folders: list[str]):
    """What the tests name: label, place, and whether the test executes the equation."""
    for path in sorted(f for folder in folders for f in (root / folder).glob("test_*.*")):
        if path.suffix not in (".c", ".py"):
            continue
        source = read_source(path)
        executes = getattr(source, "executes", [])
        named = [(label, line) for label, line, _ in source.labels()]
        for label, line in named + executes:
            # The function around the line, of nested ones the test; else the one below, whose comment it is.
            around = [f for f in source.functions if f.first <= line <= f.last]
            below = [f for f in source.functions if f.first > line]
            tests = [f for f in around if f.name.startswith("test")]
            function = (tests or around[-1:] or sorted(below, key=lambda f: f.first) or [None])[0]
            name = function.name if function else ""
            where = Place(path.relative_to(root).as_posix(), line, line, function=name)
            yield label, where, (label, line) in executes


def trace(pages: dict[str, Path], root: Path, folders: list[str]):
    """All equations by their labels, and the places in tests that name no equation."""
    found = {
        equation.label: equation
        for name, path in pages.items()
        for equation in read_page(name, path, root)
    }
    lost = []
    for label, where, executes in test_names(root, folders):
        if label not in found:
            lost.append((label, where))
            continue
        found[label].tests.append(where)
        if executes:
            found[label].executed.append(where)
    return found, lost


def counts(equations: list[Equation]) -> Counter:
    """How many equations there are of each kind, how many of the computed ones a test names, and how many a test
    executes."""
    count = Counter(equation.kind for equation in equations)
    computed = [equation for equation in equations if equation.kind == "computed"]
    count["computed"] = sum(equation.code is not None for equation in computed)
    count["tested"] = sum(bool(equation.code and equation.tests) for equation in computed)
    count["executed"] = sum(bool(equation.executed) for equation in equations)
    return count


COLUMNS = (*KINDS, "tested", "executed")
FOLDERS = ["tests/c", "tests/python", "tests/docs"]


def book(root: Path):
    """The equations of the book, read without Sphinx."""
    docs = root / "docs"
    pages = {
        path.relative_to(docs).with_suffix("").as_posix(): path for path in docs.rglob("*.rst")
    }
    return trace(dict(sorted(pages.items())), root, FOLDERS)


def main(patterns: list[str]):
    found, lost = book(Path(__file__).resolve().parents[2])
    pages: dict[str, list[Equation]] = {}
    for equation in found.values():
        pages.setdefault(equation.page, []).append(equation)
    rows = {
        name: equations
        for name, equations in pages.items()
        if not patterns or any(fnmatch(name, p) for p in patterns)
    }
    print(f"{'':30}" + "".join(f"{title:>13}" for title in COLUMNS))
    for name, equations in [*rows.items(), ("all", [e for row in rows.values() for e in row])]:
        print(f"{name:30}" + "".join(f"{counts(equations)[title]:13}" for title in COLUMNS))
    for equation in [e for row in rows.values() for e in row] if patterns else []:
        code = equation.code and f"{equation.code.path}:{equation.code.first}: {equation.code.text}"
        tests = [f"{t.path}:{t.first} {t.function}()" for t in equation.tests]
        print(f"\n{equation.label} ({equation.kind})")
        for text in [code, *tests, *(f"! {text}" for _, text in equation.faults)]:
            if text and equation.kind not in KINDS[1:]:
                print(f"    {text}")
    for label, where in lost:
        print(f"! {where.path}:{where.first} names {label}, which no page defines")


if __name__ == "__main__":
    main(sys.argv[1:])
