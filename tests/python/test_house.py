"""Rules of docs/develop: rooms include only lower ones, one prefix, and the same headers for all users."""

import re
import shutil
from pathlib import Path

import floors
import pytest
from commands import captured
from libcontact._core import ffi

ROOT = Path(__file__).resolve().parents[2]

ARCHIVES = sorted((ROOT / "build" / "lib").glob("*.a"))


def test_every_folder_is_a_room():
    folders = {path.name for path in (ROOT / floors.SOURCES).iterdir() if path.is_dir()}
    assert folders == set(floors.FLOOR)
    headers = {floors.room_of_header(path.stem) for path in (ROOT / floors.HEADERS).glob("*.h")}
    assert headers == set(floors.FLOOR) - floors.WITHOUT_HEADER


def test_no_include_looks_up():
    assert floors.upward() == []


def test_an_include_that_looks_up_is_found(tmp_path):
    for folder in ("base", "scene"):
        (tmp_path / floors.SOURCES / folder).mkdir(parents=True)
    (tmp_path / floors.SOURCES / "base" / "low.c").write_text('#include "../scene/high.h"\n')
    (tmp_path / floors.SOURCES / "scene" / "high.h").write_text("#include <libcontact/base.h>\n")
    assert floors.upward(tmp_path) == [("libcontact/src/base/low.c", "base", "scene")]


@pytest.mark.skipif(shutil.which("nm") is None or not ARCHIVES, reason="no nm or no archives")
def test_every_symbol_has_the_prefix():
    for archive in ARCHIVES:
        listed = captured(["nm", "-g", "--defined-only", str(archive)], check=True).stdout
        names = set(re.findall(r"^[0-9a-f]+ [A-Zi] (\S+)$", listed, re.M))
        assert names, archive
        # target_clones adds its own endings to a name, no other beginnings.
        assert {name for name in names if not name.startswith("ct_")} == set(), archive


def test_integrators_elements_and_laws_are_rows_and_not_compared_by_name():
    """Outside their tables, sources read the facts of a row; else a new row would run as another one."""
    values = [
        name
        for enum in ("ct_scheme", "ct_brick_kind", "ct_law", "ct_enforcement")
        for name in ffi.typeof(enum).elements.values()
        if not name.endswith("_COUNT") and name != "CT_LINEAR"  # all others are for large strain
    ]
    compared = re.compile(rf"(?:[=!]=|\bcase)\s*(?:{'|'.join(values)})\b")
    tables = {"step/integrator.c", "shape/brick.c", "solid/point.h", "constraint/law.c"}
    sources = (ROOT / floors.SOURCES).rglob("*.[ch]")
    found = [
        (path.relative_to(ROOT / floors.SOURCES).as_posix(), match.group())
        for path in sources
        for match in compared.finditer(path.read_text())
    ]
    assert [place for place in found if place[0] not in tables] == []


def test_every_public_function_has_a_user():
    """Outside the library and its tests: the wrapper, a host, a page, or an add-on, which uses only public
    functions."""
    headers = "".join(path.read_text() for path in (ROOT / floors.HEADERS).glob("*.h"))
    public = set(re.findall(r"^CT_API [^;(]*?\b(ct_\w+)\(", headers, re.M))
    folders = "wrapper bench docs stability tutorials tests/embed libcontact/fortran".split()
    folders += [f"{floors.SOURCES}/hdf5", f"{floors.SOURCES}/gsl"]
    endings = (".c", ".py", ".rst", ".f90")
    users = [
        path for name in folders for path in (ROOT / name).rglob("*") if path.suffix in endings
    ]
    called = set(re.findall(r"\bct_\w+", "\n".join(path.read_text() for path in users)))
    assert public - called == set()


def test_every_header_has_both_languages():
    for header in (ROOT / floors.HEADERS).glob("*.h"):
        text = header.read_text()
        assert text.count("CT_BEGIN_DECLS") >= 1 and text.count("CT_END_DECLS") >= 1, header


def included_by(header, found):
    """Add the public headers that a header brings in."""
    for name in re.findall(r"^#include <(libcontact/\w+\.h)>", header.read_text(), re.M):
        path = ROOT / "libcontact" / "include" / name
        if path not in found:
            found.add(path)
            included_by(path, found)
    return found


def test_a_host_reads_at_most_a_thousand_lines():
    """<libcontact/contact.h> has what a host's own time loop needs, and neither a problem nor a state."""
    contact = ROOT / "libcontact" / "include" / "libcontact" / "contact.h"
    headers = included_by(contact, {contact})
    text = "".join(path.read_text() for path in headers)
    assert "ct_contact_step" in text and "ct_project(" in text
    assert len(text.splitlines()) <= 1000
    assert not re.search(r"\bct_(problem|state|effect)\b", text)


def test_every_call_that_can_fail_can_say_why():
    headers = "".join(path.read_text() for path in (ROOT / floors.HEADERS).glob("*.h"))
    calls = re.findall(r"^CT_API ct_status (ct_\w+)\(([^;]*)\);", headers, re.M)
    assert calls and [name for name, last in calls if not last.endswith("ct_error *error")] == []


def test_the_contract_of_an_effect_fits_on_a_page():
    """An effect is a table of calls and what the loop must know; the page lists all of it."""
    effect, *tables = (
        [name for name, _ in ffi.typeof(f"ct_effect{part}").fields]
        for part in ("", "_calls", "_bounds", "_constraints", "_pieces")
    )
    assert len(effect) <= 12 and all(len(table) <= 8 for table in tables)
    page = (ROOT / "docs" / "theory" / "effect.rst").read_text()
    named = set(re.findall(r"``(?:bounds\.|constraints\.|pieces\.)?(\w+)``", page))
    assert {*effect, *sum(tables, [])} - named == {"bounds", "constraints", "pieces"}


def test_settings_of_a_run_are_given_once():
    """Threads and clock: in the settings of a run, and where there is no run."""
    headers = "".join(path.read_text() for path in (ROOT / floors.HEADERS).glob("*.h"))
    structs = re.findall(r"^typedef struct (\w+) \{\n(.*?)^\} ", headers, re.M | re.S)
    threads = {name for name, text in structs if re.search(r"^  int threads;", text, re.M)}
    clocks = {name for name, text in structs if "(*clock)" in text}
    assert threads == {"ct_run_settings", "ct_search_options", "ct_contact_options"}
    assert clocks == {"ct_run_settings"}


def in_circles(needs):
    """Keys that reach themselves."""

    def reach(name):
        seen, left = set(), [name]
        while left:
            new = needs[left.pop()] - seen
            seen |= new
            left += new
        return seen

    return {name for name in needs if name in reach(name)}


@pytest.mark.skipif(shutil.which("nm") is None or not ARCHIVES, reason="no nm or no archives")
@pytest.mark.parametrize("room", sorted(floors.FLOOR))
def test_no_files_of_a_room_need_each_other_in_a_circle(room):
    """By the functions that they call; the circle of contact, host, friction and obstacle had nine files."""
    gives, takes = {}, {}
    for source in (ROOT / floors.SOURCES / room).glob("*.c"):
        path = ROOT / "build" / "obj" / room / source.with_suffix(".o").name
        if not path.exists():  # an add-on that is not built
            continue
        listed = captured(["nm", str(path)]).stdout
        gives[source.stem] = set(re.findall(r"^[0-9a-f]+ [TDRBi] (\S+)$", listed, re.M))
        takes[source.stem] = set(re.findall(r"^ +U (\S+)$", listed, re.M))
    needs = {a: {b for b in gives if b != a and takes[a] & gives[b]} for a in gives}
    assert in_circles(needs) == set()


def test_a_circle_is_found():
    assert in_circles({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": {"a"}}) == {"b", "c"}
