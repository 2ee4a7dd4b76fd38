"""The build: the declarations of the wrapper are the headers, only ct_ symbols are exported, the core needs libc and libm only."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import libcontact as ct
from libcontact._core import lib

ROOT = Path(__file__).resolve().parents[2]
LIBRARIES = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build")) / "lib"
INCLUDE = ROOT / "libcontact" / "include"
ADDON = {"hdf5": "output.h", "gsl": "exact_series.h"}


def test_every_prototype_can_be_called_from_python():
    left_out = {header for part, header in ADDON.items() if not ct.has(part)}
    for header in (INCLUDE / "contact").glob("*.h"):
        names = re.findall(r"^CT_API [^;]*?\b(ct_\w+)\(", header.read_text(), re.M)
        assert names or header.name in ("contact.h",), header
        assert header.name in left_out or {name for name in names if not hasattr(lib, name)} == set()


def test_the_umbrella_includes_every_core_header():
    umbrella = (INCLUDE / "contact.h").read_text()
    for header in (INCLUDE / "contact").glob("*.h"):
        assert (f"<contact/{header.name}>" in umbrella) != (header.name in ADDON.values()), header


def nm(*arguments):
    return subprocess.run(["nm", *arguments], check=True, capture_output=True, text=True).stdout


@pytest.mark.skipif(shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries")
@pytest.mark.parametrize("library", sorted(LIBRARIES.glob("*.so")), ids=lambda path: path.name)
def test_shared_libraries_export_ct_only(library):
    names = {line.split()[-1] for line in nm("-D", "--defined-only", str(library)).splitlines()}
    assert names and all(name.startswith("ct_") for name in names)


@pytest.mark.skipif(shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries")
@pytest.mark.parametrize("library", sorted(LIBRARIES.glob("*.a")), ids=lambda path: path.name)
def test_static_libraries_define_ct_only(library):
    names = {fields[2] for fields in map(str.split, nm("-g", "--defined-only", str(library)).splitlines()) if len(fields) == 3}
    assert names and all(name.startswith("ct_") for name in names)


@pytest.mark.skipif(shutil.which("ldd") is None or not (LIBRARIES / "libcontact.so").exists(), reason="no ldd or no shared library")
def test_the_core_needs_libc_and_libm_only():
    needed = subprocess.run(["ldd", str(LIBRARIES / "libcontact.so")], check=True, capture_output=True, text=True).stdout
    names = {line.split()[0].split("/")[-1] for line in needed.splitlines()}
    allowed = r"linux-vdso\.so.*|libc\.so.*|libm\.so.*|libgomp\.so.*|libpthread\.so.*|libdl\.so.*|ld-linux.*"
    assert {name for name in names if not re.fullmatch(allowed, name)} == set()


def test_no_call_that_ends_or_prints():
    """Nothing exits, aborts or prints inside the library."""
    banned = re.compile(r"\b(exit|abort|printf|fprintf|puts|perror|assert)\s*\(")
    for source in (ROOT / "libcontact" / "src").rglob("*.c"):
        code = re.sub(r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\])*\"", "", source.read_text(), flags=re.S)
        assert not banned.search(code), source
