"""Hosts find the library by CMake, Meson and pkg-config: an installed copy, and the sources as a part of their own."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from commands import captured

ROOT = Path(__file__).resolve().parents[2]
STAGE = Path(os.environ.get("LIBCONTACT_BUILD", "build")).resolve() / "stage"
BESIDE = Path(sys.executable).parent
HOST = ROOT / "tests/embed/project.c"  # a program that tests the closest points it gets
installed = pytest.mark.skipif(
    not STAGE.is_dir(), reason="no installed copy: make build/stage/.done"
)


def tool(name):
    """The program of the environment, or of the machine."""
    return shutil.which(name, path=str(BESIDE)) or shutil.which(name)


def needs(*names):
    missing = [name for name in names if tool(name) is None]
    return pytest.mark.skipif(bool(missing), reason=f"no {', '.join(missing)}")


def run(command, folder, **more):
    environment = {**os.environ, "MAKEFLAGS": "", "PATH": f"{BESIDE}:{os.environ['PATH']}", **more}
    done = captured([str(word) for word in command], cwd=folder, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def passes(program):
    said = run([program], program.parent)
    assert "not ok" not in said and said.count("ok") >= 8


def cmake(folder, find, target, *options):
    """Configure, build and run a host of a few lines."""
    (folder / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.14)\nproject(host C)\n"
        f"{find}\nadd_executable(host {HOST})\n"
        f"target_include_directories(host PRIVATE {ROOT}/tests/c)\n"
        f"target_link_libraries(host PRIVATE {target})\n"
    )
    run([tool("cmake"), "-S", ".", "-B", "build", "-G", "Ninja", *options], folder)
    run([tool("cmake"), "--build", "build"], folder)
    passes(folder / "build/host")


@installed
@needs("cmake", "ninja")
@pytest.mark.parametrize("target", ["core", "static"])
def test_cmake_finds_an_installed_copy(target, tmp_path):
    found = "find_package(libcontact 0.2 REQUIRED)"
    cmake(tmp_path, found, f"libcontact::{target}", f"-DCMAKE_PREFIX_PATH={STAGE}")
    linked = captured(["ldd", str(tmp_path / "build/host")]).stdout
    assert ("libcontact.so.0.2" in linked) == (target == "core")


@installed
@needs("cmake", "ninja")
@pytest.mark.parametrize("wanted", ["0.1", "0.3", "0.2.9", "1"])
def test_cmake_refuses_another_interface(wanted, tmp_path):
    """Before 1.0 a minor version may change it."""
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.14)\nproject(host NONE)\n"
        f"find_package(libcontact {wanted} REQUIRED)\n"
    )
    command = [tool("cmake"), "-S", ".", "-B", "build", f"-DCMAKE_PREFIX_PATH={STAGE}"]
    done = captured(command, cwd=tmp_path)
    assert done.returncode != 0 and "libcontact" in done.stderr


# The core once more, as fast as it compiles: this tests the build, not its speed.
FAST = "-O0 -g0 -DCT_NO_CLONES"


@needs("cmake", "ninja")
def test_cmake_fetches_and_installs_the_sources(tmp_path):
    fetch = (
        f"include(FetchContent)\nFetchContent_Declare(libcontact SOURCE_DIR {ROOT})\n"
        "FetchContent_MakeAvailable(libcontact)"
    )
    inside = tmp_path / "inside"
    inside.mkdir()
    options = ("-DCMAKE_BUILD_TYPE=Debug", f"-DCMAKE_C_FLAGS={FAST}")
    cmake(inside, fetch, "libcontact::core", *options, f"-DCMAKE_INSTALL_PREFIX={tmp_path}/prefix")
    run([tool("cmake"), "--install", "build"], inside)
    outside = tmp_path / "outside"
    outside.mkdir()
    found = "find_package(libcontact 0.2 REQUIRED)"
    cmake(outside, found, "libcontact::core", f"-DCMAKE_PREFIX_PATH={tmp_path}/prefix")


@needs("meson", "ninja")
def test_meson_takes_the_sources(tmp_path):
    (tmp_path / "subprojects").mkdir()
    (tmp_path / "subprojects/libcontact").symlink_to(ROOT)
    meson(tmp_path, "dependency('libcontact', fallback: 'libcontact')", f"-Dc_args={FAST}")


@installed
@needs("meson", "ninja", "pkg-config")
def test_meson_finds_an_installed_copy(tmp_path):
    path = STAGE / "lib/pkgconfig"
    meson(tmp_path, "dependency('libcontact', version: '>=0.2')", f"-Dpkg_config_path={path}")


def meson(folder, dependency, *options):
    (folder / "meson.build").write_text(
        "project('host', 'c', default_options: ['c_std=c99', 'default_library=static'])\n"
        f"parts = [{dependency}, meson.get_compiler('c').find_library('m')]\n"
        f"executable('host', '{HOST.name}', include_directories: 'c', dependencies: parts)\n"
    )
    shutil.copy(HOST, folder)
    shutil.copytree(
        ROOT / "tests/c", folder / "c", ignore=lambda _, names: [n for n in names if n != "tap.h"]
    )
    run([tool("meson"), "setup", "build", *options], folder)
    run([tool("ninja"), "-C", "build"], folder)
    passes(folder / "build/host")


@installed
def test_an_installed_copy_has_one_header_at_the_top_of_one_folder():
    assert sorted(path.name for path in (STAGE / "include").iterdir()) == [
        "libcontact",
        "libcontact.h",
    ]


@pytest.mark.skipif(shutil.which("make") is None, reason="no make")
def test_folders_of_a_distribution(tmp_path):
    """Debian and Fedora have other folders for libraries: all that names one follows it."""
    folders = [
        f"prefix={tmp_path}/usr",
        f"libdir={tmp_path}/usr/lib64",
        f"mandir={tmp_path}/usr/man",
    ]
    said = run(["make", "-n", "install", "BOOTSTRAP=no", *folders], ROOT)
    assert f"{tmp_path}/usr/lib64/pkgconfig" in said and f"{tmp_path}/usr/lib64/cmake" in said
    assert f"{tmp_path}/usr/lib/" not in said and f"{tmp_path}/usr/share" not in said


@installed
def test_files_of_an_installed_copy_name_their_folders():
    for path in [*STAGE.rglob("*.pc"), *STAGE.rglob("*.cmake"), *STAGE.rglob("*.3")]:
        assert not re.search(r"@\w+@", path.read_text()), path


@installed
@pytest.mark.skipif(shutil.which("man") is None, reason="no man")
def test_the_manual_page_is_shown_without_a_warning():
    page = STAGE / "share/man/man3/libcontact.3"
    done = subprocess.run(
        ["man", "--warnings", "-l", str(page)],
        capture_output=True,
        text=True,
        env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8"},
    )
    assert done.returncode == 0 and done.stderr == "" and "find_package(libcontact)" in done.stdout


@installed
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_the_example_of_the_manual_page_runs(tmp_path):
    page = (STAGE / "share/man/man3/libcontact.3").read_text()
    source, program = tmp_path / "example.c", tmp_path / "example"
    source.write_text(page.split(".nf\n")[1].split(".fi")[0].replace(r"\en", r"\n"))
    flags = [f"-I{STAGE}/include", f"-L{STAGE}/lib", "-lcontact", f"-Wl,-rpath,{STAGE}/lib"]
    run(["cc", "-std=c99", source, *flags, "-o", program], tmp_path)
    assert run([program], tmp_path).startswith(
        "ok: distance 0.853007"
    )  # as in tutorials/c/03_projection.out
