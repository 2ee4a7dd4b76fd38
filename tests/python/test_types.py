"""The types of the package: mypy --strict finds no error, and a user's program is checked against them."""

import sys
from pathlib import Path

import pytest
from commands import captured

ROOT = Path(__file__).resolve().parents[2]
pytest.importorskip("mypy")


def check(*arguments):
    """The output of mypy for these files, with the settings of pyproject.toml."""
    command = [sys.executable, "-m", "mypy", "--config-file", "pyproject.toml", *arguments]
    done = captured(command, cwd=ROOT)
    return done.stdout + done.stderr


def test_the_package_has_types_throughout():
    assert check().startswith("Success: no issues found")


def test_a_program_is_told_of_its_mistakes(tmp_path):
    """The names of the package that are imported when first used have the types of their modules."""
    program = tmp_path / "program.py"
    program.write_text(
        "import libcontact as ct\n"
        'found = ct.project("Q4", [[0, 0, 0]], [[0, 0, 0]], tolerance="small")\n'
        "found.distanse\n"
        "ct.Status.FINE\n"
        'run: int = ct.Run.load("plates.vtkhdf")\n'
        "ct.nothing\n"
    )
    lines = check(str(program)).splitlines()
    for line, words in [
        (2, '"tolerance" to "project" has incompatible type "str"'),
        (3, 'has no attribute "distanse"'),
        (4, 'has no attribute "FINE"'),
        (5, 'type "Run", variable has type "int"'),
        (6, 'Module has no attribute "nothing"'),
    ]:
        assert any(f"program.py:{line}: " in found and words in found for found in lines), lines
    assert len(lines) == 6
