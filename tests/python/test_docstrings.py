"""The docstrings of the public names: their examples run, and they describe each parameter and the result."""

import doctest
import importlib
import inspect
import re

import pytest

import libcontact as ct

# The modules whose docstrings have examples that run, and numpydoc's sections.
DESCRIBED = [
    "libcontact.bloch",
    "libcontact.contact",
    "libcontact.exact",
    "libcontact.mesh",
    "libcontact.meshes",
    "libcontact.projection",
]
DESCRIBED += ["libcontact.run", "libcontact.search", "libcontact.state"]


@pytest.mark.parametrize("name", DESCRIBED)
def test_examples_run(name):
    failed, _ = doctest.testmod(importlib.import_module(name))
    assert failed == 0


def public(module):
    """The public functions of a module, and the public methods of its public classes, by name."""
    for name in module.__all__:
        thing = getattr(module, name)
        if inspect.isfunction(thing):
            yield name, thing
        elif inspect.isclass(thing):
            for key, method in vars(thing).items():
                method = getattr(method, "__func__", method)
                if inspect.isfunction(method) and not key.startswith("_"):
                    yield f"{name}.{key}", method


CASES = [
    pytest.param(function, id=f"{name}.{key}")
    for name in DESCRIBED
    for key, function in public(importlib.import_module(name))
]


def sections(text):
    """The sections of a docstring in numpydoc's layout, by their titles."""
    parts = re.split(r"^([A-Z]\w+)\n-+\n", text, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


@pytest.mark.parametrize("function", CASES)
def test_each_parameter_and_what_comes_out_is_described(function):
    found = sections(inspect.getdoc(function) or "")
    heads = re.findall(r"^(\w[\w, ]*?)(?: :.*)?$", found.get("Parameters", ""), flags=re.M)
    described = [name.strip() for head in heads for name in head.split(",")]
    wanted = [
        name for name in inspect.signature(function).parameters if name not in ("self", "cls")
    ]
    assert sorted(described) == sorted(wanted)
    assert ("Returns" in found) == (function.__annotations__["return"] != "None")


def test_every_public_module_is_described():
    """Each name of the package with arguments is in a module that is checked above."""
    homes = {getattr(ct, name).__module__ for name in ct.__all__ if name not in ("exact", "has")}
    assert homes - set(DESCRIBED) <= {"libcontact.errors", "libcontact.scene", "libcontact.schema"}
