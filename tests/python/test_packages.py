"""The modules of the Python package import each other without a circle, and no package one above it; dir() of
the package shows what users call."""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "wrapper" / "libcontact"
# The floors from below, each a package or modules beside them; all others are on the first, with physics and scenes.
FLOORS = {
    "pictures": ("pictures.",),
    "a run": ("run", "loop", "export"),
    "checks": ("checks.",),
    "planning": ("planning.",),
    "what users call": ("scene", "info", "mesh_info", "command", "__main__", "__init__"),
}
# Imports within functions, which keep a start or a run from waiting for modules that it does not need.
LATE = {
    ("__main__", "command"): "Ctrl-C is handled before anything is imported",
    ("command", ""): "help, completion and wrong words need none of the package",
    ("scene", "planning."): "a run needs no planning (one eighth of the time to import scenes)",
    ("run", "pictures."): "a run draws nothing",
}


def modules():
    """Each module of the package by its name, such as ``checks.touch``."""
    files = {path.relative_to(PACKAGE).with_suffix(""): path for path in PACKAGE.rglob("*.py")}
    names = {".".join(name.parts): path for name, path in files.items()}
    return {name.removesuffix(".__init__"): path for name, path in names.items()}


def imports(name, source, known):
    """The modules that a module imports, each with whether it is imported within a function. What is imported
    for annotations only is no import."""
    package = name if (PACKAGE / name.replace(".", "/")).is_dir() else name.rpartition(".")[0]
    nodes = [(node, False) for node in ast.parse(source).body]
    while nodes:
        node, late = nodes.pop()
        if isinstance(node, ast.If) and getattr(node.test, "id", "") == "TYPE_CHECKING":
            continue
        late = late or isinstance(node, ast.FunctionDef)
        nodes += [(child, late) for child in ast.iter_child_nodes(node)]
        if isinstance(node, ast.ImportFrom) and node.level:
            above = package.split(".")[: -node.level + 1 or None] if package else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{base}.{alias.name}".strip(".")
                found = inner if inner in known else base or "__init__"
                if found != "_core":
                    yield found, late


def floor(name):
    """The number of the floor of a module, and its name."""
    for number, (title, starts) in enumerate(FLOORS.items(), start=1):
        if any(
            name == start or start.endswith(".") and f"{name}.".startswith(start)
            for start in starts
        ):
            return number, title
    return 0, "physics and scenes"


def circle(found):
    """A circle of imports, empty if there is none."""
    try:
        TopologicalSorter(found).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def upwards(found):
    """The imports of a module on a floor above."""
    return [(a, b) for a, others in found.items() for b in others if floor(b) > floor(a)]


# The imports of each module, late ones included.
ALL = {
    name: dict(imports(name, path.read_text(encoding="utf-8"), modules()))
    for name, path in modules().items()
}


def test_no_circle_of_modules():
    assert circle(ALL) == []


def test_no_import_upwards():
    assert upwards(ALL) == []


def test_late_imports_have_a_reason():
    late = {(a, b) for a, others in ALL.items() for b, within in others.items() if within}
    kept = {
        (a, b): why
        for a, b in late
        for (of, what), why in LATE.items()
        if a == of and b.startswith(what)
    }
    assert late == set(kept)
    used = {(of, what) for of, what in LATE if any(a == of and b.startswith(what) for a, b in late)}
    assert used == set(LATE)


def test_each_floor_has_its_modules():
    assert {name for starts in FLOORS.values() for name in starts if not name.endswith(".")} <= set(
        ALL
    )
    assert {floor(name)[1] for name in ALL} == {"physics and scenes", *FLOORS}


@pytest.mark.parametrize(
    "change",
    [
        {"mesh": "def f():\n    from .problem import Problem\n"},  # late
        {"checks.touch": "from ..planning.plan import predict\n"},
        {"errors": "from . import scene\n"},
        {"effects.gravity": "from . import obstacle\nfrom ..loop import Loop\n"},
    ],
    ids=str,
)
def test_a_circle_and_an_import_upwards_are_found(change):
    (name, more), *_ = change.items()
    text = modules()[name].read_text(encoding="utf-8") + more
    found = ALL | {name: dict(imports(name, text, ALL))}
    assert circle(found) or upwards(found)


def test_dir_shows_the_interface_only():
    """Classes, functions, the exact solution and the version, also after modules were imported."""
    import libcontact.loop  # noqa: F401

    import libcontact as ct

    assert set(dir(ct)) == {*ct.__all__, "__version__"} and len(dir(ct)) == len(set(dir(ct)))
    values = {name: getattr(ct, name) for name in dir(ct)}
    odd = {
        name
        for name, value in values.items()
        if not getattr(value, "__doc__", None) or not callable(value)
    }
    assert odd - {"METHODS"} == {"exact", "__version__"}
    assert all(
        value.__module__.startswith("libcontact.") for value in values.values() if callable(value)
    )
