"""The build: the declarations of the wrapper are the headers, only ct_ symbols are exported, the core needs libc and
libm only."""

import os
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest
from commands import captured
from libcontact._core import ffi, lib

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("LIBCONTACT_BUILD", ROOT / "build"))
LIBRARIES = BUILD / "lib"
STAGE = BUILD / "stage"
CC = shlex.split(os.environ.get("CC", "cc"))
CXX = shlex.split(os.environ.get("CXX", "c++"))
PKG_CONFIG = os.environ.get("PKG_CONFIG", "pkg-config")
INCLUDE = ROOT / "libcontact" / "include"
ADDON = {"hdf5": "output.h", "gsl": "series.h"}


def test_every_prototype_can_be_called_from_python():
    for header in (INCLUDE / "libcontact").glob("*.h"):
        names = re.findall(r"^CT_API [^;]*?\b(ct_\w+)\(", header.read_text(), re.M)
        assert names or "typedef" in header.read_text(), header
        assert {name for name in names if not hasattr(lib, name)} == set()


def test_every_header_begins_with_its_room_and_its_threads():
    for header in (INCLUDE / "libcontact").glob("*.h"):
        assert re.match(
            r"/\* [A-Z][^/]*?\.\n \* Threads: [^/]*?\.\s+\*/\n#ifndef ", header.read_text()
        ), header


def test_headers_library_and_packages_have_one_version():
    version = f"{lib.CT_VERSION_MAJOR}.{lib.CT_VERSION_MINOR}.{lib.CT_VERSION_PATCH}"
    assert ffi.string(lib.ct_version()).decode() == version
    assert tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"] == version
    for package in (STAGE / "lib" / "pkgconfig").glob("*.pc"):
        assert f"\nVersion: {version}\n" in package.read_text(), package


def test_fortran_has_the_members_and_arguments_of_c():
    """Also where there is no Fortran compiler to run tests/embed/host.f90."""
    text = (ROOT / "libcontact" / "fortran" / "libcontact.f90").read_text()
    text = re.sub(r"&\n\s*|!.*", "", text)
    for name, body in re.findall(r"type, bind\(C\) :: (\w+)\n(.*?)end type", text, re.S):
        rows = "".join(
            re.sub(r"\(.*?\)", "", row.partition("::")[2]) + "," for row in body.split("\n")
        )
        members = [word.partition("=")[0].strip() for word in rows.split(",") if word.strip()]
        assert members == [name for name, _ in ffi.typeof(name).fields], name
    calls = re.findall(r"(?:function|subroutine) (\w+)\((.*?)\) bind\(C(?:, name=\"(\w+)\")?", text)
    for name, arguments, other in calls:
        count = len([word for word in arguments.split(",") if word.strip()])
        assert count == len(ffi.typeof(getattr(lib, other or name)).args), name


def test_fortran_has_the_values_of_c():
    text = (ROOT / "libcontact" / "fortran" / "libcontact.f90").read_text()
    enums = re.findall(r"! (ct_\w+)\n +integer\(c_int\), parameter :: ((?:.*&\n)*.*)", text)
    assert "ct_enforcement" in dict(enums)
    for enum, rows in enums:
        found = {name: int(value) for name, value in re.findall(r"(\w+) = (\d+)", rows)}
        values = {name: number for number, name in ffi.typeof(enum).elements.items()}
        assert found == {name: values[name] for name in values if "_COUNT" not in name}, enum


def test_every_definition_and_all_options_begin_with_a_cookie():
    text = "".join(path.read_text() for path in (INCLUDE / "libcontact").glob("*.h"))
    names = re.findall(r"^typedef struct (ct_\w+_(?:def|options)) ", text, re.M)
    assert len(names) > 15
    for name in names:
        assert ffi.typeof(name).fields[0][0] == "cookie", name
        assert getattr(lib, f"{name}_default")().cookie != 0, name


def without_default(name):
    """All options of the default, but the cookie of a struct that was only set to zero."""
    options = ffi.new(f"{name} *", getattr(lib, f"{name}_default")())
    options.cookie = 0
    return options


def test_options_without_their_default_are_refused(tmp_path):
    error, scene = ffi.new("ct_error *"), ffi.new("ct_scene **")
    face, point = ffi.new("ct_face *"), ffi.new("double[3]")
    face.node = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]] + 4 * [[0, 0, 0]]
    nodes, quad = ffi.new("double[192]"), ffi.new("int32_t[4]", [0, 1, 2, 3])
    corners = ffi.new("double[12]", [0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0])
    surface = ffi.new("ct_surface *", [lib.CT_Q4, 4, 1, quad, corners])
    search, problem = ffi.new("ct_search **"), ffi.new("ct_problem *")
    assert lib.ct_search_create(surface, search, error) == lib.CT_OK
    assert lib.ct_scene_create(scene, error) == lib.CT_OK
    state, contact = ffi.new("ct_state *", {"problem": problem}), ffi.new("ct_scene_contact *")
    bare = without_default("ct_contact_options")
    bare.epsilon = 1.0
    project = without_default("ct_project_options")
    monitor, out = without_default("ct_monitor_options"), ffi.new("ct_projection *")
    calls = {
        "ct_project": (face, point, project, out),
        "ct_project_points": (face, 1, point, project, ffi.NULL, out),
        "ct_project_batch": (0, 1, nodes, nodes, ffi.NULL, project, ffi.new("ct_batch_closest *")),
        "ct_search_nearest": (
            search[0],
            1,
            point,
            ffi.NULL,
            without_default("ct_search_options"),
            ffi.new("ct_nearest *"),
        ),
        "ct_contact_create": (surface, surface, bare, ffi.new("ct_contact **")),
        "ct_scene_add_contact": (scene[0], contact),
        "ct_monitor_create": (problem, state, monitor, ffi.new("ct_monitor **")),
    }
    if ct.has("hdf5"):
        output = without_default("ct_output_options"), ffi.new("ct_output **")
        calls["ct_output_create"] = (bytes(tmp_path / "x.vtkhdf"), problem, *output)
    for name, arguments in calls.items():
        assert getattr(lib, name)(*arguments, error) == lib.CT_ERROR_ARGUMENT, name
        text = ffi.string(error.text).decode()
        assert re.search(r"do not start from ct_\w+_options_default", text), (name, text)
    lib.ct_search_free(search[0])
    lib.ct_scene_free(scene[0])


def test_the_umbrella_includes_every_core_header():
    umbrella = (INCLUDE / "libcontact.h").read_text()
    for header in (INCLUDE / "libcontact").glob("*.h"):
        assert (f"<libcontact/{header.name}>" in umbrella) != (header.name in ADDON.values()), (
            header
        )


@pytest.mark.skipif(shutil.which(CC[0]) is None, reason="no C compiler")
def test_every_header_compiles_alone(tmp_path):
    """Each header alone, as C99 with all warnings."""
    for header in sorted((INCLUDE / "libcontact").glob("*.h")):
        source = tmp_path / "alone.c"
        source.write_text(f"#include <libcontact/{header.name}>\nint main(void) {{ return 0; }}\n")
        done = captured(
            [
                *CC,
                "-std=c99",
                "-Wall",
                "-Wextra",
                "-Wpedantic",
                "-Werror",
                f"-I{INCLUDE}",
                "-fsyntax-only",
                str(source),
            ]
        )
        assert done.returncode == 0, done.stderr


@pytest.mark.skipif(
    shutil.which(CXX[0]) is None or not LIBRARIES.is_dir(),
    reason="no C++ compiler or no built libraries",
)
def test_every_header_alone_links_from_cxx(tmp_path):
    """A C++ program of one file a header, which includes this header alone and takes the address of each of its
    functions."""
    calls = []
    for header in sorted((INCLUDE / "libcontact").glob("*.h")):
        names = re.findall(r"^CT_API [^;]*?\b(ct_\w+)\(", header.read_text(), re.M)
        addresses = "".join(f"reinterpret_cast<void *>(&{name}), " for name in names)
        (tmp_path / f"{header.stem}.cc").write_text(
            f"#include <libcontact/{header.name}>\n\nint count_{header.stem}()\n{{\n  void *volatile known[] = {{{addresses}nullptr}};\n"
            "  int count = 0;\n  while (known[count] != nullptr) count++;\n  return count;\n}\n"
        )
        calls.append((f"count_{header.stem}()", len(names)))
    declared = "".join(f"int {call.removesuffix('()')}();\n" for call, _ in calls)
    (tmp_path / "all_of_them.cc").write_text(
        declared
        + f"int main() {{ return {' + '.join(call for call, _ in calls)} == {sum(count for _, count in calls)} ? 0 : 1; }}\n"
    )
    libraries = [str(path) for path in sorted(LIBRARIES.glob("*.so"))]
    done = captured(
        [
            *CXX,
            "-std=c++11",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            f"-I{INCLUDE}",
            *map(str, sorted(tmp_path.glob("*.cc"))),
            *libraries,
            f"-Wl,-rpath,{LIBRARIES.resolve()}",
            "-o",
            str(tmp_path / "all"),
        ]
    )
    assert done.returncode == 0, done.stderr
    assert subprocess.run([str(tmp_path / "all")]).returncode == 0


# System headers that the standard ones may include: on macOS <stdlib.h> includes <sys/wait.h>.
SYSTEM = """
    sys/wait sys/stat sys/socket sys/time sys/mman unistd fcntl signal poll pthread sched
    time wchar strings
""".split()


@pytest.mark.skipif(
    shutil.which(CC[0]) is None or sys.platform == "win32", reason="no C compiler, or no POSIX"
)
def test_no_name_of_the_core_is_one_of_the_systems():
    """Every source of the core compiles with the headers of POSIX before it, and all that they declare."""
    sources = [
        str(path)
        for path in sorted((ROOT / "libcontact" / "src").rglob("*.c"))
        if path.parent.name not in ADDON
    ]
    ahead = [word for name in SYSTEM for word in ("-include", f"{name}.h")]
    done = captured(
        [
            *CC,
            "-w",
            "-std=gnu99",
            "-D_GNU_SOURCE",
            f"-I{INCLUDE}",
            *ahead,
            "-fsyntax-only",
            *sources,
        ]
    )
    assert done.returncode == 0, done.stderr


USES = {
    "gsl": "#include <libcontact/series.h>\n"
    "int main(void) { double x = 1.0, z = 0.0, t = 0.5, f[5] = {0}; size_t bad; ct_error e;\n"
    "  return f[0] == f[0] ? (int)ct_exact_plates_series(1, &x, &z, &t, 0.3, 10, f, &bad, &e) : 99; }\n",
    "hdf5": "#include <libcontact/output.h>\n"
    "int main(void) { ct_error e; return (int)ct_output_close(NULL, &e); }\n",
}


@pytest.mark.skipif(
    shutil.which(PKG_CONFIG) is None or not STAGE.is_dir(),
    reason="no pkg-config or no installed copy",
)
@pytest.mark.parametrize("part", USES)
def test_an_installed_addon_is_found_by_pkg_config(part, tmp_path):
    environment = {**os.environ, "PKG_CONFIG_PATH": str(STAGE / "lib" / "pkgconfig")}
    flags = captured(
        [PKG_CONFIG, "--cflags", "--libs", f"libcontact-{part}"], check=True, env=environment
    )
    source, program = tmp_path / "use.c", tmp_path / "use"
    source.write_text(USES[part])
    subprocess.run(
        [
            *CC,
            "-std=c99",
            str(source),
            "-o",
            str(program),
            *flags.stdout.split(),
            f"-Wl,-rpath,{STAGE / 'lib'}",
        ],
        check=True,
    )
    wanted = lib.CT_OK if ct.has(part) else lib.CT_ERROR_UNSUPPORTED
    assert subprocess.run([str(program)]).returncode == wanted


@pytest.mark.skipif(
    shutil.which(CC[0]) is None or not LIBRARIES.is_dir(),
    reason="no C compiler or no built libraries",
)
@pytest.mark.parametrize("part", ADDON)
def test_an_addon_without_its_package_refuses_every_call(part, tmp_path):
    """For any build: the source that replaces a missing add-on, with each prototype of its header called with zeros."""
    text = (INCLUDE / "libcontact" / ADDON[part]).read_text()
    calls = re.findall(r"^CT_API ct_status (ct_\w+)\(([^;]*)\);", text, re.M)
    assert len(calls) == text.count("CT_API ct_status ")
    source, program = tmp_path / "refused.c", tmp_path / "refused"
    source.write_text(
        f"#include <libcontact/{ADDON[part]}>\n"
        "static int refused(ct_status status, const ct_error *e) { return status == CT_ERROR_UNSUPPORTED && e->code == status && e->text[0] != 0; }\n"
        "int main(void)\n{\n  int good = 1;\n"
        + "".join(
            f"  {{ ct_error e = {{0}}; ct_status s = {name}({'0, ' * arguments.count(',')}&e); good = good && refused(s, &e); }}\n"
            for name, arguments in calls
        )
        + "  return !good;\n}\n"
    )
    missing = ROOT / "libcontact" / "src" / part / "missing.c"
    command = [*CC, "-std=c99", f"-I{INCLUDE}", source, missing, LIBRARIES / "libcontact.a"]
    openmp = ["-fopenmp"] if ct.has("openmp") else []
    subprocess.run([*map(str, command), *openmp, "-lm", "-o", str(program)], check=True)
    assert subprocess.run([str(program)]).returncode == 0


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """A function that calls a Python program with the package that `pip install .` makes from an sdist: without
    Makefile and libraries."""
    pytest.importorskip("setuptools")
    if shutil.which(CC[0]) is None:
        pytest.skip("no C compiler")
    tmp_path = tmp_path_factory.mktemp("plain")
    tree = tmp_path / "tree"
    tree.mkdir()
    for name in ("libcontact", "wrapper", "tutorials/scenes"):
        shutil.copytree(
            ROOT / name,
            tree / name,
            ignore=shutil.ignore_patterns("*.egg-info", "__pycache__", "*.so"),
        )
    for name in ("pyproject.toml", "setup.py", "MANIFEST.in", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, tree)
    fast = tmp_path / "cc"  # this tests the list of files, not their speed
    fast.write_text(f'#!/bin/sh\nexec {shlex.join(CC)} "$@" -O0 -g0\n')
    fast.chmod(0o755)
    environment = {
        name: value for name, value in os.environ.items() if not name.startswith("LIBCONTACT_")
    } | {"CC": str(fast)}
    make = "from setuptools import build_meta as b; import sys; print(b.build_sdist(sys.argv[1]))"
    done = captured([sys.executable, "-c", make, str(tmp_path)], cwd=tree, env=environment)
    assert done.returncode == 0, done.stderr
    done = captured(
        [
            sys.executable,
            "-m",
            "pip",
            "wheel",
            "-q",
            "--no-deps",
            "--no-index",
            "--no-build-isolation",
            "-w",
            str(tmp_path),
            str(next(tmp_path.glob("*.tar.gz"))),
        ],
        cwd=tmp_path,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    wheel = next(tmp_path.glob("*.whl"))
    assert "-abi3-" in wheel.name
    assert "libcontact/py.typed" in zipfile.ZipFile(wheel).namelist()
    zipfile.ZipFile(wheel).extractall(tmp_path / "installed")
    environment["PYTHONPATH"] = os.pathsep.join(
        [str(tmp_path / "installed"), str(ROOT / "stability")]
    )

    def call(program, *arguments):
        begin = f"import sys, libcontact as ct; assert ct.__file__.startswith({str(tmp_path)!r})\n"
        command = [sys.executable, "-c", begin + program, *map(str, arguments)]
        done = captured(command, cwd=tmp_path, env=environment)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return call


def test_a_package_of_the_sources_builds_the_core_alone(plain):
    """GSL's licence does not apply; files are there with an h5py whose HDF5 is new enough, and the advice is to get one
    where it is missing."""
    use = """
f = ct.project('Q4', [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], [[0,0,2]])
print(f.distance[0], ct.has('gsl'), ct.has('hdf5'))
"""
    try:
        from h5py.version import hdf5_version_tuple as version
    except ImportError:
        version = (0,)
    assert plain(use).split() == ["2.0", "False", str(version >= (1, 14))]
    without = """
sys.modules['h5py'] = None
from kill import scene
print(ct.has('hdf5'))
try: scene().run(output=False).save('a.vtkhdf')
except ct.NotBuiltIn as error: print(error)
"""
    assert re.fullmatch(r"False\n.*no HDF5.*pip install h5py.*\n", plain(without))


def contents(path):
    """Every object and attribute of a file: type, shape, chunks and bytes."""
    import h5py

    out = {}

    def visit(name, item):
        out[name] = None
        for key, value in item.attrs.items():
            kind = item.attrs.get_id(key).get_type().encode()
            out[name, key] = kind, np.shape(value), np.asarray(value).tobytes()
        if isinstance(item, h5py.Dataset):
            kind, value = item.id.get_type().encode(), np.asarray(item[()], item.id.dtype).tobytes()
            out[name] = kind, item.shape, item.maxshape, item.chunks, value

    with h5py.File(path) as file:
        file.visititems(visit)
    return out


RUN = """
from kill import scene
s = scene().add_probe("tip", body="left", point=[0, 1, 1], quantities=["velocity", "stress"])
s.add_probe("push", resultant="contact", body="left").set_output(every=10)
path, until, restart = sys.argv[1:]
s.run(output=path, until=float(until), restart=restart or None)
"""


@pytest.fixture
def borrowed(plain):
    if plain("print(ct.has('hdf5'))") == "False\n" or not ct.has("hdf5"):
        pytest.skip("no h5py with HDF5 1.14, or built without HDF5")
    return plain


def test_the_hdf5_of_h5py_writes_the_file_of_the_linked_one(borrowed, tmp_path):
    """The file has the same objects with the same bytes, also after a restart from the other's file."""
    linked, loaded, half, rest = (tmp_path / f"{name}.vtkhdf" for name in "abcd")
    subprocess.run(
        [sys.executable, "-c", f"import sys{RUN}", linked, "6", ""],
        check=True,
        env={**os.environ, "PYTHONPATH": str(ROOT / "stability")},
    )
    borrowed(RUN, loaded, 6, "")
    assert len(contents(linked)) > 80 and contents(loaded) == contents(linked)
    borrowed(RUN, half, 3, "")
    borrowed(RUN, rest, 6, half)
    for name in ("VTKHDF/PointData/displacement", "VTKHDF/PointData/velocity"):
        last = [contents(path)[name][4][-54 * 24 :] for path in (rest, linked)]
        assert last[0] == last[1]


def test_a_run_with_the_hdf5_of_h5py_may_be_killed_and_its_disk_be_full(borrowed, tmp_path):
    killed = "import pathlib, kill; print(sorted(kill.kill_campaign(4, folder=pathlib.Path(sys.argv[1])).items()))"
    assert "('good', 4)" in borrowed(killed, tmp_path)
    full = """
import resource, signal
from kill import scene
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (600000, 600000))
try: scene().run(output=sys.argv[1])
except ct.RunError as error: print("large" in str(error), 0 < len(ct.Run.load(sys.argv[1]).steps) < 300)
"""
    assert borrowed(full, tmp_path / "full.vtkhdf") == "True True\n"


@pytest.mark.skipif(not ct.has("hdf5"), reason="no HDF5")
def test_the_declarations_for_a_loaded_hdf5_are_those_of_hdf5(tmp_path):
    """The constants of our header, and the types of its calls, against the header of an installed HDF5."""
    flags = next(
        (
            f
            for n in ("hdf5-serial", "hdf5")
            if (f := captured([PKG_CONFIG, "--cflags", n])).returncode == 0
        ),
        None,
    )
    if flags is None or shutil.which(CC[0]) is None:
        pytest.skip("no C compiler, or no HDF5 development files")
    own = (ROOT / "libcontact/src/hdf5/loaded/hdf5.h").read_text()
    values = dict(re.findall(r"^ +(H5\w+) = (-?\d+),?$", own, re.M))
    assert len(values) > 20
    calls = re.findall(r"CALL\(([^,]+), (H5\w+), (\(.*?\))\)", own.replace("\\\n", ""))
    assert len(calls) == own.count(" CALL(") > 60
    source = tmp_path / "same.c"
    lines = [
        "#include <hdf5.h>",
        "#undef H5OPEN",
        "#define H5OPEN",
        "#undef H5CHECK",
        "#define H5CHECK",
        "#define ASSERT(name, x) typedef char name[(x) ? 1 : -1];",
    ]
    lines += [f"ASSERT(is_{name}, (long)({name}) == {value})" for name, value in values.items()]
    lines += ["ASSERT(unlimited, H5S_UNLIMITED == UINT64_MAX && HADDR_UNDEF == UINT64_MAX)"]
    lines += [
        "ASSERT(sizes, sizeof(hid_t) == 8 && sizeof(hsize_t) == 8 && sizeof(haddr_t) == 8 && sizeof(herr_t) == 4 && sizeof(hbool_t) == 1)"
    ]
    lines += ["int main(void) {"]
    for kind, name, arguments in calls:
        given = [] if arguments == "(void)" else arguments[1:-1].split(",")
        asked = f"{name}({', '.join(f'*(({each}*)0)' for each in given)})"
        kind = kind.replace("*", " *")
        lines += [
            f"{{ ASSERT(one, sizeof({asked}) == sizeof({kind})) {kind} back = {asked}; (void)back; }}"
        ]
    source.write_text("\n".join(lines) + "\nreturn 0; }\n")
    options = [
        "-std=c99",
        "-fsyntax-only",
        "-Werror=incompatible-pointer-types",
        "-Werror=int-conversion",
    ]
    done = captured([*CC, *options, *flags.stdout.split(), str(source)])
    assert done.returncode == 0, done.stderr


@pytest.fixture
def machine(tmp_path):
    """A function that runs the set-up step for a command of make on a machine without g++: what it says, and what it
    asks of apt-get."""
    tools, log = tmp_path / "bin", tmp_path / "log"
    tools.mkdir()
    (tools / "sh").symlink_to(shutil.which("sh"))

    def set_up(command, user=0, **variables):
        log.write_text("")
        asks = f'echo "$*" >> {log}'  # apt-get is called through env
        programs = {
            "id": f"echo {user}",
            "apt-get": asks,
            "env": asks,
            "python": "",
            "pkg-config": "",
        }
        for name, text in programs.items():
            (tools / name).write_text(f"#!/bin/sh\n{text}\n")
            (tools / name).chmod(0o755)
        done = captured(
            ["sh", str(ROOT / "wrapper" / "bootstrap.sh"), command],
            env={"PATH": str(tools), "PYTHON": "python", "PKG_CONFIG": "pkg-config", **variables},
            stdin=subprocess.DEVNULL,
        )
        assert done.returncode == 0
        return done.stderr, log.read_text()

    return set_up


@pytest.mark.skipif(os.name != "posix", reason="no POSIX shell")
@pytest.mark.parametrize(
    "packages, command",
    [
        ("valgrind libc6-dbg", "memory"),
        ("valgrind libc6-dbg", "bench"),
        ("chromium", "pdf"),
        ("chromium firefox-esr nodejs", "test-page"),
        ("qemu-user wine", "wheels"),
        ("qemu-user wine", "check-cross"),
    ],
)
def test_the_set_up_step_installs_what_one_command_wants(machine, packages, command):
    assert re.search(rf"install {packages}$", machine(command)[1], re.M)


@pytest.mark.skipif(os.name != "posix", reason="no POSIX shell")
def test_the_set_up_step_installs_what_the_tests_want(machine):
    """A C++ compiler for `make test` alone, with the rights to install; without them, and with BOOTSTRAP=no, it is
    named and left out."""
    told, asked = machine("test")
    assert re.search(r"install g\+\+$", asked, re.M)
    assert machine("figures") == ("", "")
    for refused in ({"user": 1000}, {"BOOTSTRAP": "no"}):
        told, asked = machine("test", **refused)
        assert told == "not found, and left out: g++\nto get everything: apt-get install g++\n"
        assert asked == ""


def nm(*arguments):
    return captured(["nm", *arguments], check=True).stdout


@pytest.mark.skipif(
    shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries"
)
@pytest.mark.parametrize("library", sorted(LIBRARIES.glob("*.so")), ids=lambda path: path.name)
def test_shared_libraries_export_ct_only(library):
    names = {line.split()[-1] for line in nm("-D", "--defined-only", str(library)).splitlines()}
    assert names and all(name.startswith("ct_") for name in names)


@pytest.mark.skipif(
    shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries"
)
@pytest.mark.parametrize("library", sorted(LIBRARIES.glob("*.a")), ids=lambda path: path.name)
def test_static_libraries_define_ct_only(library):
    names = {
        fields[2]
        for fields in map(str.split, nm("-g", "--defined-only", str(library)).splitlines())
        if len(fields) == 3
    }
    assert names and all(name.startswith("ct_") for name in names)


@pytest.mark.skipif(
    shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries"
)
def test_all_memory_of_the_core_goes_through_one_source():
    """Only memory.o, where a host may set its allocator, calls malloc and its relatives."""
    callers, member = set(), ""
    for line in nm("-u", str(LIBRARIES / "libcontact.a")).splitlines():
        if line.endswith(".o:"):
            member = line.rstrip(":")
        elif re.search(r" (\w*alloc|free|posix_memalign|strn?dup)$", line):
            callers.add(member)
    assert callers == {"memory.o"}


@pytest.mark.skipif(
    shutil.which("nm") is None or not LIBRARIES.is_dir(), reason="no nm or no built libraries"
)
def test_either_all_kernels_or_none_are_compiled_for_several_machines():
    """A source that includes lanes.h before any header of libc would lose its fast versions without a warning."""
    names = {
        line.split()[-1]
        for line in nm(str(LIBRARIES / "libcontact.a")).splitlines()
        if line.strip()
    }
    kernels = {name for name in names if re.fullmatch(r"ct_solid_\w+_(batches|energies)", name)}
    cloned = {name.removesuffix(".avx2") for name in names if name.endswith(".avx2")} & kernels
    assert len(kernels) >= 3 and cloned in (set(), kernels)


@pytest.mark.skipif(
    shutil.which("ldd") is None or not (LIBRARIES / "libcontact.so").exists(),
    reason="no ldd or no shared library",
)
def test_the_core_needs_libc_and_libm_only():
    needed = captured(["ldd", str(LIBRARIES / "libcontact.so")], check=True).stdout
    names = {line.split()[0].split("/")[-1] for line in needed.splitlines()}
    allowed = r"linux-vdso\.so.*|libc\.so.*|libm\.so.*|libgomp\.so.*|libpthread\.so.*|libdl\.so.*|ld-linux.*"
    assert {name for name in names if not re.fullmatch(allowed, name)} == set()


def test_no_call_that_ends_or_prints():
    """Nothing exits, aborts or prints inside the library."""
    banned = re.compile(r"\b(exit|abort|printf|fprintf|puts|perror|assert)\s*\(")
    for source in (ROOT / "libcontact" / "src").rglob("*.c"):
        code = re.sub(
            r"/\*.*?\*/|//[^\n]*|\"(?:\\.|[^\"\\])*\"", "", source.read_text(), flags=re.S
        )
        assert not banned.search(code), source
