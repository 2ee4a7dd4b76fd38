"""How large the project is: ``make count`` or ``python tools/count.py [REVISION]...``, a column each; without one, the
working tree.

Every revision is laid out by the formatters of this checkout first. A line of code is one that is not blank, not a
comment and not a docstring. Rooms are the folders of ``libcontact/src``, and a file beside them is a room of its own.
"""

from __future__ import annotations

import argparse
import ast
import io
import re
import subprocess
import sys
import tarfile
import tempfile
import tokenize
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# What a file of the C library is for, by the beginning of its path under src/ or of its name; the first that fits.
TOPICS = (
    ("files", ("hdf5/",)),
    (
        "speed",
        """solid/box solid/call solid/kernel solid/ring solid/part solid/plane solid/quiet solid/rows solid/sleep
        solid/blocks solid/mean solid/modes solid/hex projection/batch gap/warm base/bits base/lanes base/threads
        base/tree bits. lanes. threads. tree.""".split(),
    ),
    (
        "further physics",
        """effect/ absorb. damping. stiffness_damping. initial_stress. friction. gravity. history. load. motion. obstacle. rigid. rotation. tie. viscosity. amplitude.
        contact/friction contact/obstacle solid/large solid/reduced integrator. step/integrator refine. step/refine
        step/subdivide""".split(),
    ),
)


def topic(path: str) -> str:
    for name, beginnings in TOPICS:
        if any(path.startswith(b) or path.split("/")[-1].startswith(b) for b in beginnings):
            return name
    return "paper"


def c_lines(text: str) -> int:
    """Lines of C without comments and blanks."""
    literal = r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\''
    bare = re.sub(
        rf"({literal})|/\*.*?\*/|//[^\n]*",
        lambda m: m[1] or "\n" * m[0].count("\n"),
        text,
        flags=re.S,
    )
    return sum(1 for line in bare.splitlines() if line.strip())


def python_lines(text: str) -> int:
    """Lines of Python without comments, docstrings and blanks."""
    skipped = (tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)
    lines = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in skipped and token.string:
            lines.update(range(token.start[0], token.end[0] + 1))
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)):
            if ast.get_docstring(node, clean=False) is not None:
                doc = node.body[0]
                lines -= set(range(doc.lineno, doc.end_lineno + 1))
    return len(lines)


def laid_out(revision: str | None, folder: Path) -> Path:
    """A copy of a revision (None: of the working tree), laid out by the formatters of this checkout."""
    if revision is None:
        listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
        for name in listed.stdout.splitlines():
            if (ROOT / name).is_file():
                (folder / name).parent.mkdir(parents=True, exist_ok=True)
                (folder / name).write_bytes((ROOT / name).read_bytes())
    else:
        packed = subprocess.run(["git", "archive", revision], cwd=ROOT, capture_output=True)
        tarfile.open(fileobj=io.BytesIO(packed.stdout)).extractall(folder, filter="data")
    for name in (".clang-format", "pyproject.toml"):
        (folder / name).write_bytes((ROOT / name).read_bytes())
    bin = Path(sys.executable).parent
    c = [str(p) for p in folder.rglob("*.[ch]")]
    subprocess.run([str(bin / "clang-format"), "-i", *c], check=True)
    subprocess.run([str(bin / "ruff"), "format", "-q", str(folder)], check=True)
    return folder


def struct_members(text: str, name: str) -> int:
    """Members of a struct of plain members; a function pointer counts as one."""
    found = re.search(rf"typedef struct {name} \{{(.*?)\n\}} {name};", text, re.S)
    bare = re.sub(r"/\*.*?\*/", "", found[1], flags=re.S) if found else ""
    parts = [re.sub(r"\([^()]*\)", "", part) for part in bare.split(";") if part.strip()]
    return sum(1 + re.sub(r"\[[^\]]*\]", "", part).count(",") for part in parts)


def rooms(folder: Path) -> tuple[int, int, int]:
    """Rooms, arrows between them, and arrows against one another (a pair that includes both ways)."""
    source = folder / "libcontact" / "src"
    public = next(
        p
        for p in (folder / f"libcontact/include/{n}" for n in ("libcontact", "contact"))
        if p.is_dir()
    )
    found, arrows = set(), set()

    def room(path: Path) -> str:
        parts = path.relative_to(source).parts
        return parts[0] if len(parts) > 1 else path.stem

    for file in source.rglob("*.[ch]"):
        found.add(room(file))
        for name in re.findall(r'^#include "(.*?)"', file.read_text(), re.M):
            other = room((file.parent / name).resolve())
            if other != room(file):
                arrows.add((room(file), other))
        for name in re.findall(rf"^#include <{public.name}/(\w+)\.h>", file.read_text(), re.M):
            if name != room(file) and (source / name).exists():
                arrows.add((room(file), name))
    return len(found), len(arrows), sum((b, a) in arrows for a, b in arrows) // 2


def measure(folder: Path) -> dict[str, int]:
    library = folder / "libcontact"
    sources = [*(library / "src").rglob("*.[ch]")]
    headers = [p for p in (library / "include").rglob("*.h") if p.parent.name != "include"]
    text = "\n".join(header.read_text() for header in headers)
    counts: dict[str, int] = {}
    total = 0
    for name in ("paper", "further physics", "speed", "files"):
        own = [p for p in sources if topic(p.relative_to(library / "src").as_posix()) == name]
        counts[f"C, {name}"] = sum(c_lines(p.read_text()) for p in own)
        total += counts[f"C, {name}"]
    counts["C, public headers"] = sum(c_lines(p.read_text()) for p in headers)
    counts["C, together"] = total + counts["C, public headers"]
    counts["C files"] = len(sources) + len(headers)
    counts["rooms"], counts["arrows between rooms"], counts["arrows both ways"] = rooms(folder)
    counts["public headers"] = len(headers)
    counts["public functions"] = len(re.findall(r"^CT_API ", text, re.M))
    counts["public types"] = len(
        re.findall(r"^(?:typedef (?:struct|enum) \w+ \w+;|\} \w+;)", text, re.M)
    )
    counts["members of ct_view"] = struct_members(text, "ct_view")
    counts["members of ct_effect"] = struct_members(text, "ct_effect")
    step = next((library / "src").rglob("step.c"))
    counts["step.c"] = c_lines(step.read_text())
    counts["Python package"] = sum(
        python_lines(p.read_text()) for p in (folder / "wrapper").rglob("*.py")
    )
    tests = folder / "tests"
    counts["tests in C"] = sum(c_lines(p.read_text()) for p in tests.rglob("*.[ch]"))
    counts["tests in Python"] = sum(python_lines(p.read_text()) for p in tests.rglob("*.py"))
    product = counts["C, together"] + counts["Python package"]
    written = counts["tests in C"] + counts["tests in Python"]
    counts["tests, % of the product"] = round(100 * written / product)
    return counts


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("revision", nargs="*")
    names = parser.parse_args().revision or [None]
    columns = []
    for name in names:
        with tempfile.TemporaryDirectory() as folder:
            columns.append(measure(laid_out(name, Path(folder))))
    print(f"{'':24}" + "".join(f"{(name or 'working tree')[:14]:>16}" for name in names))
    for row in columns[0]:
        print(f"{row:24}" + "".join(f"{column[row]:16}" for column in columns))


if __name__ == "__main__":
    main()
