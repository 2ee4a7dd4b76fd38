"""Every target that ``make help`` lists starts: what its recipe names is there, from an empty build folder."""

import os
import re
import sys
from pathlib import Path

import pytest
from commands import captured

ROOT = Path(__file__).resolve().parents[2]
# Runs the top level of each script, with the modules beside it, and forgets these before the next one. A package of
# wrapper/requirements may be absent.
START = """
import pathlib, runpy, sys
wanted = "".join(path.read_text() for path in pathlib.Path("wrapper/requirements").glob("*.txt"))
for script in sys.argv[1:]:
    path, known = list(sys.path), set(sys.modules)
    sys.path.insert(0, str(pathlib.Path(script).parent))
    try:
        runpy.run_path(script, run_name="started")
    except ModuleNotFoundError as error:
        if error.name not in wanted:
            raise
    sys.path[:] = path
    for name in set(sys.modules) - known:
        if "site-packages" not in (getattr(sys.modules[name], "__file__", None) or "site-packages"):
            del sys.modules[name]
"""


def make(*words):
    alone = {**os.environ, "MAKEFLAGS": ""}  # not those of the make that runs this test
    done = captured(["make", *words], cwd=ROOT, env=alone)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def commands(tmp_path_factory):
    """What all targets would run, the programs that they build from nothing, and those that they run."""
    targets = re.findall(r"^make (\S+) ", make("-s", "help"), re.M)
    assert len(targets) > 20
    build = tmp_path_factory.mktemp("targets")
    tools = ("CC=true", "CXX=true", "FC=true", "BOOTSTRAP=no")
    text = make("-n", *targets, *tools, f"BUILD={build}", f"prefix={build}/prefix")
    text = text.replace("\\\n", " ")
    for loop, name, values in re.findall(r"(for (\w+) in ([^;]+); do .*)", text):
        text += "".join(f"\n{loop.replace(f'${name}', value)}" for value in values.split())
    program = rf"{build}/\S*/(?:test|asan|embed|random|libfuzzer|host)_\w+(?![\w./$])"
    return text, set(re.findall(rf"-o ({program})", text)), set(re.findall(program, text))


def test_programs_of_all_targets_are_built(commands):
    _, built, run = commands
    assert len(built) > 100 and run - built == set()


def test_scripts_and_files_of_all_targets_exist(commands):
    folders = "accuracy|bench|docs|libcontact|stability|tests|tutorials|wrapper"
    named = set(re.findall(rf"(?<![\w/.-])(?:{folders})/[\w./]+\.\w+", commands[0]))
    assert len(named) > 100
    assert [path for path in sorted(named) if not (ROOT / path).exists()] == []


def test_scripts_of_all_targets_start(commands):
    """The tutorial that draws the figures has no main part: test_tutorials.py runs it."""
    scripts = set(re.findall(r"python3? (\w+/\S+\.py)", commands[0]))
    assert len(scripts) > 10
    scripts = [name for name in sorted(scripts) if "__main__" in (ROOT / name).read_text()]
    done = captured([sys.executable, "-c", START, *scripts], cwd=ROOT)
    assert done.returncode == 0, done.stderr
