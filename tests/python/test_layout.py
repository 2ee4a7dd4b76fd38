"""All tracked C and Python files have the layout that ``make format`` writes."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TOOLS = Path(sys.executable).parent  # those of wrapper/requirements/test.txt, with their versions


def tracked(*patterns):
    """Files of the repository in the working tree."""
    try:
        done = subprocess.run(
            ["git", "ls-files", "-z", *patterns], cwd=ROOT, capture_output=True, text=True
        )
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
    done = subprocess.run(
        [TOOLS / tool, *options, *files], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, f"make format writes:\n{done.stdout}{done.stderr}"[:4000]
