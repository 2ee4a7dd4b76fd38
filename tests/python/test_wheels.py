"""What a wheel brings and what it must not; what its messages tell; its metadata."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from libcontact.errors import install
from libcontact.older import tomllib

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = PROJECT["optional-dependencies"]
WHEELS = sorted((ROOT / "build/wheels").glob("*.whl"))
built = pytest.mark.skipif(not WHEELS, reason="no wheels: make wheels")
each_wheel = pytest.mark.parametrize("wheel", WHEELS, ids=lambda path: path.name.split("-")[-1])


@pytest.mark.parametrize("extra", EXTRAS)
def test_a_command_installs_what_an_extra_needs(extra):
    """Whatever index or folder the package came from: the command names the packages, not the extra."""
    words = subprocess.run(
        ["sh", "-c", "printf '%s\\n' " + install(extra)], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    assert words[:4] == [sys.executable, "-m", "pip", "install"]
    assert sorted(words[4:]) == sorted(EXTRAS[extra])


def test_every_extra_that_a_message_names_exists():
    calls = [
        name
        for path in (ROOT / "wrapper/libcontact").rglob("*.py")
        for name in re.findall(r"install\([\"'](\w+)[\"']\)", path.read_text())
    ]
    assert len(calls) >= 7 and set(calls) <= set(EXTRAS)


def test_metadata_are_complete():
    for key in ("description", "readme", "license", "license-files", "keywords", "classifiers"):
        assert PROJECT[key]
    assert (ROOT / "wrapper/libcontact/py.typed").exists()
    limited = re.search(r'"py_limited_api": "cp3(\d+)"', (ROOT / "setup.py").read_text())[1]
    assert PROJECT["requires-python"] == f">=3.{limited}"


def unpacked(wheel, folder):
    import zipfile

    zipfile.ZipFile(wheel).extractall(folder)
    (core,) = [path for path in (folder / "libcontact").glob("_core.*") if path.suffix != ".pyi"]
    return core


@built
@each_wheel
def test_a_wheel_is_small_and_holds_no_part_of_gsl_or_hdf5(wheel, tmp_path):
    """GSL's licence (GPL) and HDF5's 30 libraries stay out: their names are in no extension."""
    assert wheel.stat().st_size <= 1.2e6
    core = unpacked(wheel, tmp_path).read_bytes()
    assert not re.search(rb"gsl_\w+|libgsl|libhdf5", core)
    asked = (ROOT / "libcontact/src/hdf5/loaded/hdf5.h").read_bytes()  # for names of h5py's HDF5
    assert all(name in asked for name in re.findall(rb"H5[A-Z]\w+", core))
    (info,) = tmp_path.glob("*.dist-info")
    tags = re.findall(r"Tag: (\S+)", (info / "WHEEL").read_text())
    assert tags and all(tag.startswith("cp310-abi3-") for tag in tags)
    assert (tmp_path / "libcontact/py.typed").exists()
    metadata = (info / "METADATA").read_text()
    texts = {"LICENSE", "LICENSE.zig"}  # what is linked inside
    if "win" in wheel.name.split("-")[-1]:
        texts |= {"LICENSE.mingw-w64", "LICENSE.musl", "LICENSE.winpthreads"}
    assert set(re.findall(r"^License-File: (\S+)", metadata, re.M)) == texts
    assert all((info / "licenses" / name).read_text().strip() for name in texts)
    assert f"Version: {ct.__version__}\n" in metadata and "Requires-Python: >=3.10" in metadata


@built
@each_wheel
def test_a_wheel_uses_the_limited_interface_only(wheel):
    pytest.importorskip("abi3audit")
    done = subprocess.run(
        [sys.executable, "-m", "abi3audit", "--strict", str(wheel)], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr


@built
@each_wheel
def test_a_wheel_keeps_the_promise_of_its_tag(wheel, tmp_path):
    """manylinux and musllinux: only the libraries, and the versions of their symbols, that the tag allows."""
    if "linux" not in wheel.name:
        pytest.skip("auditwheel knows Linux only")
    if "musllinux" in wheel.name:  # auditwheel needs musl's own loader
        said = subprocess.run(
            ["readelf", "-d", unpacked(wheel, tmp_path)], capture_output=True, text=True, check=True
        ).stdout
        assert re.findall(r"NEEDED.*\[(.*)\]", said) == ["libc.so"]
        return
    pytest.importorskip("auditwheel")
    tag = wheel.name.removesuffix(".whl").split("-")[-1]
    said = subprocess.run(
        [sys.executable, "-m", "auditwheel", "show", str(wheel)], capture_output=True, text=True
    )
    consistent = re.search(r'platform tag:\s+"(\w+)"', said.stdout.replace("\n", " "))
    assert consistent and consistent[1] in tag, said.stdout + said.stderr


@built
@each_wheel
def test_the_index_would_take_a_wheel(wheel):
    pytest.importorskip("twine")
    done = subprocess.run(
        [sys.executable, "-m", "twine", "check", "--strict", str(wheel)],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_row_is_made_again_when_its_files_change(tmp_path, monkeypatch):
    """`make wheels` and `make check-cross` go on where they were stopped."""
    monkeypatch.syspath_prepend(ROOT / "tools")
    from check_cross import kept

    program, store = tmp_path / "program", tmp_path / "row.json"
    for text, row, expected in ((b"a", "1", "1"), (b"a", "2", "1"), (b"b", "3", "3")):
        program.write_bytes(text)
        assert kept(store, [program], lambda row=row: ("equal", row)) == ("equal", expected)


def test_the_recipe_tries_each_wheel():
    """packaging/ci: a real machine for each target, the oldest and the newest Python."""
    recipe = (ROOT / "packaging/ci/wheels.yml").read_text()
    targets = re.findall(
        r'^    "([\w-]+)": Target\(', (ROOT / "tools/build_wheels.py").read_text(), re.M
    )
    assert len(targets) == 7 and targets == re.findall(r"target: ([\w-]+)", recipe)
    assert f'"{PROJECT["requires-python"].removeprefix(">=")}"' in recipe
    for path in re.findall(r"\b(?:tests|build)/[\w/.]+\b", recipe):
        assert path.startswith("build/") or (ROOT / path).exists(), path
