"""Words that the page of names has replaced are in no public name."""

import inspect
import re
from pathlib import Path

import pytest
from libcontact.parts import schema
from libcontact.pictures import drawing, plot

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
TABLE, KEPT = (
    (ROOT / "docs" / "develop" / "naming.rst")
    .read_text(encoding="utf-8")
    .partition("One word for one thing")[2]
    .split("Kept, with the reason")
)
# Names that the page keeps, with their reason.
KEPT_NAMES = {
    name for text in re.findall(r"``(.+?)``", KEPT) for name in re.findall(r"[A-Za-z_]\w*", text)
}


def banned():
    """The words on the left side of the table, without rows that end in a context, and without phrases."""
    rows = re.findall(r"^(\S.*?) {2,}\S", TABLE.partition("was  ")[2], re.M)
    cells = [re.split(r"[,;] *", row) for row in rows if not row.endswith(")")]
    return {word for cell in cells for word in cell if re.fullmatch("[a-z]+", word)}


def found(names):
    """The names of which a part is such a word, and that the page does not keep."""
    parts = {
        name: set(re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower().split("_")) for name in names
    }
    return sorted(name for name in parts if parts[name] & banned() and name not in KEPT_NAMES)


def test_the_table_is_read():
    assert {"kick", "push", "share", "held", "blocks", "quiet", "unsettled"} <= banned()
    assert not {"history", "gauss", "path", "initial"} & banned()
    assert found(["ct_stable_share", "held", "InitialPush", "watch", "shared", "block_count"]) == [
        "InitialPush",
        "block_count",
        "ct_stable_share",
        "held",
    ]


def test_headers():
    texts = [
        re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(encoding="utf-8"), flags=re.S)
        for path in (ROOT / "libcontact" / "include").rglob("*.h")
    ]
    fortran = (ROOT / "libcontact" / "fortran" / "libcontact.f90").read_text(encoding="utf-8")
    texts.append(re.sub(r"!.*", "", fortran))
    assert found({name for text in texts for name in re.findall(r"[A-Za-z_]\w*", text)}) == []


def names_of(thing):
    """The public names of a class, or of a function, with those of the arguments."""
    names = set()
    if inspect.isclass(thing):
        members = [name for name in dir(thing) if not name.startswith("_")]
        names |= {*members, *getattr(thing, "__annotations__", {}), *names_of(thing.__init__)}
        for name in members:
            names |= names_of(getattr(thing, name))
    elif inspect.isroutine(thing) and str(getattr(thing, "__module__", "")).startswith(
        "libcontact"
    ):
        names |= set(inspect.signature(thing).parameters)
    return {name for name in names if not name.startswith("_")}


@pytest.mark.parametrize(
    "module", [ct, ct.exact, drawing, plot], ids=lambda module: module.__name__
)
def test_python(module):
    public = getattr(module, "__all__", [name for name in vars(module) if name[0] != "_"])
    names = set(public).union(*(names_of(getattr(module, name)) for name in public))
    assert len(names) > 5 and ("force_time" in names) == (module is ct) and found(names) == []


def words_of(part):
    """The keys and the words of a schema."""
    if isinstance(part, list):
        return set().union(*map(words_of, part))
    if not isinstance(part, dict):
        return set()
    words = {*part.get("properties", ()), *part.get("enum", ())}
    return words.union(*map(words_of, part.values()))


def test_scene_keys():
    words = words_of(schema())
    assert {"initial_penetration", "force", "young"} <= words and found(words) == []


def test_results():
    run = ct.Scene.load(ct.example("block_on_an_incline")).run(until=1e-3, output=False)
    names = {*run.energy.dtype.names, *run.momentum.dtype.names}
    names = names.union(*(rows.dtype.names for rows in run.probes.values()))
    assert {"kinetic", "time", "friction"} <= names and found(names) == []
