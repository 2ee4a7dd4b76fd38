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
        ("conda-forge/recipe.yaml", r'  version: "(.*)"'),
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
    """As conda-forge's own tool reads it, for a Python with tomllib and one without."""
    conda = pytest.importorskip("rattler_build")
    linux = (
        'c_compiler: [gcc]\nc_stdlib: [sysroot]\npython: ["3.10.* *_cpython", "3.13.* *_cp313"]\n'
    )
    recipe = conda.Stage0Recipe.from_file(RECIPES / "conda-forge/recipe.yaml")
    old, new = (
        each.recipe.to_dict() for each in recipe.render(conda.VariantConfig.from_yaml(linux))
    )
    wanted = [re.sub(r"\s*;.*", "", one).replace(">=", " >=") for one in PROJECT["dependencies"]]
    assert old["requirements"]["run"] == ["python", *wanted]
    assert new["requirements"]["run"] == ["python", *wanted[:-1]] and "tomli >" in wanted[-1]
    assert new["about"]["license"] == PROJECT["license"]
