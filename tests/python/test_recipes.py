"""Recipes of distributions agree with the library: version, license, dependencies."""

import re
from pathlib import Path

import pytest
from libcontact.older import tomllib

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
RECIPES = ROOT / "packaging"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


@pytest.mark.parametrize(
    "name, pattern",
    [
        ("conda-forge/meta.yaml", r'set version = "(.*)"'),
        ("spack/package.py", r'version\("(.*?)"'),
        ("debian/changelog", r"libcontact \((.*)-1\)"),
        ("../meson.build", r"version: '(.*)'"),
    ],
)
def test_recipes_have_the_version_of_the_library(name, pattern):
    assert re.search(pattern, (RECIPES / name).read_text())[1] == ct.__version__


def test_the_debian_package_has_the_name_of_the_shared_library():
    soname = ".".join(ct.__version__.split(".")[:2])
    assert f"Package: libcontact{soname}\n" in (RECIPES / "debian/control").read_text()
    assert (RECIPES / f"debian/libcontact{soname}.install").exists()


def test_the_conda_recipe_has_the_dependencies_of_the_package():
    text = (RECIPES / "conda-forge/meta.yaml").read_text()
    run = re.search(r"  run:\n((?:    - .*\n)+)", text)[1]
    wanted = [re.sub(r"\s*;.*", "", one).replace(">=", " >=") for one in PROJECT["dependencies"]]
    assert re.findall(r"- (?!python\b)(.*?)(?:  #.*)?\n", run) == wanted
    assert "license: MIT" in text and PROJECT["license"] == "MIT"
