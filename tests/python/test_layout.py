"""All tracked C and Python files have the layout that ``make format`` writes, and no line of prose exceeds 120."""

import re
import sys
from pathlib import Path

import pytest
from commands import captured

ROOT = Path(__file__).resolve().parents[2]
TOOLS = Path(sys.executable).parent  # those of wrapper/requirements/test.txt, with their versions


def tracked(*patterns):
    """Files of the repository in the working tree."""
    try:
        done = captured(["git", "ls-files", "-z", *patterns], cwd=ROOT)
    except OSError:
        pytest.skip("no git")
    if done.returncode != 0:
        pytest.skip("not a git checkout")
    files = [name for name in done.stdout.split("\0") if name and (ROOT / name).exists()]
    assert files
    return files


@pytest.mark.parametrize(
    "command, patterns",
    [
        (("clang-format", "--dry-run", "-Werror"), ("*.c", "*.h")),
        (("ruff", "format", "--check", "--no-cache", "-q", "--diff"), ("*.py",)),
        (("ruff", "check", "--no-cache", "-q", "--output-format=concise"), ("*.py",)),
    ],
    ids=("clang-format", "ruff-format", "ruff-check"),
)
def test_sources_have_the_layout_of_make_format(command, patterns):
    tool, *options = command
    if not (TOOLS / tool).exists():
        pytest.skip(f"no {tool} in {TOOLS.name}/ beside this Python (make build/venv/.test)")
    files = tracked(*patterns)
    done = captured([TOOLS / tool, *options, *files], cwd=ROOT)
    assert done.returncode == 0, f"make format writes:\n{done.stdout}{done.stderr}"[:4000]


WIDTH = 120  # of comments and docstrings, too: max-doc-length in pyproject.toml
# Directives whose body is text; of the others it is code, data or a formula.
BODIES = r"admonition|drawn|dropdown|figure|glossary|grid|grid-item-card|list-table|moving|note|rubric|warning"
DIRECTIVE = re.compile(r"\s*(?:[-*] )*\.\. (?:\|.*?\| )?([\w:-]+)::")
BORDER = re.compile(r"(=+ +)+=+|[+][-=+]+")
MARK = re.compile(r"\s*(?:(?:[-*+]|\d+\.|#\.)\s+)*(?::[\w -]+:\s+)?")
TIED = re.compile(r"(?::[\w:+-]+:)?(`+)[^`]+?\1_?_?")


def prose(text):
    """Lines of a page that are prose, with their numbers: no code, formula, table, directive or comment."""
    quoted, table, fence = None, False, False
    for number, line in enumerate(text.splitlines(), 1):
        bare = line.strip()
        indent = len(line) - len(line.lstrip())
        fence ^= bare.startswith("```")
        table = bool(bare) and (table or BORDER.fullmatch(bare) is not None)
        if not bare or fence or table or quoted is not None and indent > quoted:
            continue
        directive = DIRECTIVE.match(line)
        body = directive and not re.fullmatch(BODIES, directive[1])
        quoted = indent if body or not directive and bare.endswith("::") else None
        if not bare.startswith((".. ", "|")) and not directive:
            yield number, line


def too_long(text):
    """Numbers of the lines of prose beyond WIDTH that have a blank before it, outside roles and literals."""
    for number, line in prose(text):
        tied = TIED.sub(lambda found: re.sub(r"\s", "_", found[0]), line)
        if len(line) > WIDTH and " " in tied[MARK.match(line).end() : WIDTH + 1]:
            yield number


def test_lines_of_prose_are_short():
    long = [
        f"{name}:{number}"
        for name in tracked("*.rst", "*.md")
        for number in too_long((ROOT / name).read_text(encoding="utf-8"))
    ]
    assert long == [], f"lines of prose of more than {WIDTH} columns"


@pytest.mark.parametrize(
    "text, found",
    [
        ("word " * 30, [1]),
        ("- " + "word " * 30, [1]),
        ("* - " + "x" * 130, []),
        (":Do: " + "word " * 30, [1]),
        ("A literal ``" + "word " * 30 + "``", [1]),
        ("``" + "word " * 30 + "``", []),
        (".. math::\n\n   " + "x + " * 40, []),
        ("Listing::\n\n   " + "word " * 30 + "\n\n" + "word " * 30, [5]),
        (".. admonition:: Later\n\n   " + "word " * 30, [3]),
        ("=== ===\na   " + "word " * 30 + "\n=== ===\n\n" + "word " * 30, [5]),
        ("```\n" + "word " * 30 + "\n```\n" + "word " * 30, [4]),
    ],
)
def test_long_lines_are_found(text, found):
    assert list(too_long(text)) == found
