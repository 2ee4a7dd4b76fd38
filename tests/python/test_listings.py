"""Programs in the README, the book and ``tutorials/c``: each compiles against an installed copy and prints the quoted
output."""

import os
import re
import shlex
import shutil
import sys
import textwrap
from pathlib import Path

import pytest
from commands import captured

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
STAGE = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build")).resolve() / "stage"
CC = shlex.split(os.environ.get("CC", "cc"))
PKG_CONFIG = os.environ.get("PKG_CONFIG", "pkg-config")
PROGRAMS = sorted((ROOT / "tutorials" / "c").glob("*.c"))
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.rst"))]
BLOCK = {
    ".md": re.compile(r"^```c\n(.*?)^```$", re.M | re.S),
    ".rst": re.compile(r"^ *\.\. code-block:: c\n\n((?:(?: {2,}\S.*)?\n)+)", re.M),
}

needs_a_copy = pytest.mark.skipif(
    shutil.which(CC[0]) is None or shutil.which(PKG_CONFIG) is None or not STAGE.is_dir(),
    reason="no C compiler, no pkg-config or no installed copy",
)


def listings():
    """The whole programs among the C listings, by page."""
    for page in PAGES:
        for block in BLOCK[page.suffix].findall(page.read_text(encoding="utf-8")):
            if "int main(" in block:
                yield pytest.param(textwrap.dedent(block), id=str(page.relative_to(ROOT)))


def output_of(source, folder):
    """Compile as a user does, with all warnings, and run."""
    environment = {**os.environ, "PKG_CONFIG_PATH": str(STAGE / "lib" / "pkgconfig")}
    found = [PKG_CONFIG, "--cflags", "--libs", "libcontact"]
    flags = captured(found, check=True, env=environment)
    warnings = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", f"-I{ROOT / 'tests/c'}"]
    link = [*flags.stdout.split(), f"-Wl,-rpath,{STAGE / 'lib'}", "-lm"]
    program = folder / "program"
    command = [*CC, *warnings, str(source), *link, "-o", str(program)]
    done = captured(command)
    assert done.returncode == 0, done.stderr
    done = captured([str(program)], cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@needs_a_copy
@pytest.mark.parametrize("source", PROGRAMS, ids=lambda path: path.name)
def test_a_program_prints_what_stands_beside_it(source, tmp_path):
    assert output_of(source, tmp_path) == source.with_suffix(".out").read_text()


def test_the_same_effect_in_python_prints_the_same():
    script = ROOT / "tutorials" / "c" / "02_effect.py"
    done = captured([sys.executable, str(script)])
    assert done.stdout == script.with_suffix(".out").read_text(), done.stderr


def test_the_number_of_the_reader_in_a_hurry(tmp_path):
    """``docs/start/ball.py`` prints the output on the page, and the page's statements about it are true."""
    script = ROOT / "docs" / "start" / "ball.py"
    command = [sys.executable, str(script)]
    done = captured(command, cwd=tmp_path)
    assert done.stdout == script.with_suffix(".out").read_text(), done.stderr
    hertz, *found = (float(x) for x in re.findall(r"([\d.]+) MPa", done.stdout))
    soft, default = found[::2], found[1::2]
    assert abs(soft[2] / soft[0] - 1.17) < 0.01
    assert max(default) / min(default) < 1.02 and abs(default[2] / hertz - 1.06) < 0.01


def test_the_part_of_the_readme_comes_back(tmp_path):
    """The scene of the README runs: its part leaves the floor with the speed that its vibration leaves it, and
    momentum and energy agree with its impact."""
    (scene,) = re.findall(
        r"^```toml\n(.*?)^```$", PAGES[0].read_text(encoding="utf-8"), re.M | re.S
    )
    (tmp_path / "drop.toml").write_text(scene, encoding="utf-8")
    run = ct.Scene.load(tmp_path / "drop.toml").run(output=False)
    mass, speed = 7800 * 0.1 * 0.1 * 0.02, run.body_momentum("part")["p"][:, 2]
    assert speed[0] == pytest.approx(-mass) and 0.5 * mass < speed[-1] <= mass
    kept = run.energy["kinetic"][-1] + run.energy["strain"][-1]
    assert kept == pytest.approx(0.5 * mass, rel=1e-3)


def commands_of(page):
    """The lines after ``$`` on a page."""
    text = (ROOT / "docs" / "start" / page).read_text()
    return re.findall(r"^   \$ (.*)$", text, re.M)


@needs_a_copy
def test_the_commands_for_a_c_programmer_compile_and_run_as_they_stand(tmp_path):
    """In the folder of the sources, with the installed copy of the tests as the prefix; the programs go to another
    folder."""
    environment = {**os.environ, "PKG_CONFIG_PATH": str(STAGE / "lib" / "pkgconfig")}
    lines = [x for x in commands_of("reading.rst") if x.startswith(("gcc", "./"))]
    assert len(lines) == 6
    printed = []
    for line in lines:
        line = line.replace("$HOME/.local", str(STAGE)).replace("gcc", shlex.join(CC), 1)
        line = line.replace("-o ", f"-o {tmp_path}/").replace("./", f"{tmp_path}/")
        line = line.replace("pkg-config", PKG_CONFIG)
        done = captured(line, shell=True, cwd=ROOT, env=environment)
        assert done.returncode == 0 and not done.stderr, line + done.stderr
        printed.append(done.stdout)
    programs = ("03_projection", "01_impact", "04_own_loop")
    for shown, program in zip(printed[1::2], programs):
        assert shown == (ROOT / "tutorials" / "c" / f"{program}.out").read_text()


def test_the_commands_for_a_number_run_as_they_stand(tmp_path):
    pytest.importorskip("matplotlib")
    lines = [x for x in commands_of("reading.rst") if "hertz" in x]
    assert len(lines) == 3 and "--plot" in lines[2]
    lines[0] = lines[0].replace("tutorials", str(ROOT / "tutorials"))
    for line in lines:
        line = (
            line.replace("libcontact ", f"{shlex.quote(sys.executable)} -m libcontact ", 1)
            if line.startswith("libcontact")
            else line
        )
        done = captured(line, shell=True, cwd=tmp_path)
        assert done.returncode == 0, line + done.stderr
    assert (tmp_path / "hertz.png").stat().st_size > 10_000


@needs_a_copy
@pytest.mark.parametrize("text", list(listings()))
def test_a_listing_of_a_page_compiles_and_runs(text, tmp_path):
    source = tmp_path / "listing.c"
    source.write_text(text)
    assert "not ok" not in output_of(source, tmp_path)


@pytest.mark.parametrize("name, most", [("01_impact.c", 30), ("05_host.c", 40)])
def test_the_shortest_programs_are_short(name, most):
    program = next(path for path in PROGRAMS if path.name == name)
    text = re.sub(r"/\*.*?\*/", "", program.read_text(), flags=re.S)
    assert sum(map(bool, map(str.strip, text.split("\n")))) <= most
