"""Wheels for other machines, with the cross compiler of the Python index (``ziglang``).

``make wheels`` calls it with the folder in which make has built the library, and with names of targets and what the
compiler calls them: ``build_wheels.py build linux-x86_64=x86_64-linux-gnu.2.17 ...``. The package is
the same in all wheels but for its one extension, which uses Python's limited interface (abi3), so that one wheel serves
all versions of Python.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import NamedTuple

import ziglang

ROOT = Path(__file__).resolve().parents[1]
PYTHON = (3, 10)
LARGEST = 1_200_000  # bytes


class Target(NamedTuple):
    tag: str
    link: tuple[str, ...] = ("-shared",)
    extension: str = "_core.abi3.so"


# The names of functions of Python stay open in an extension; on Windows they are named with their library.
OPEN = ("-shared", "-Wl,-undefined,dynamic_lookup")
TARGETS = {
    "linux-x86_64": Target("manylinux_2_17_x86_64.manylinux2014_x86_64"),
    "linux-aarch64": Target("manylinux_2_17_aarch64.manylinux2014_aarch64"),
    "musl-x86_64": Target("musllinux_1_2_x86_64"),
    "musl-aarch64": Target("musllinux_1_2_aarch64"),
    "windows-x86_64": Target("win_amd64", extension="_core.pyd"),
    "macos-x86_64": Target("macosx_11_0_x86_64", OPEN),
    "macos-arm64": Target("macosx_11_0_arm64", OPEN),
}


def run(*command: str | Path, cwd: Path = ROOT, env: dict[str, str] | None = None) -> str:
    """What a command prints; its failure ends the program."""
    words = [str(word) for word in command]
    done = subprocess.run(words, cwd=cwd, env=env, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def zig(*arguments: str | Path) -> str:
    return run(sys.executable, "-m", "ziglang", *arguments)


def python_headers(work: Path) -> Path:
    """Python's headers, with a description of the other machines in place of this one's."""
    headers = work / "python"
    shutil.copytree(sysconfig.get_path("include"), headers, dirs_exist_ok=True)
    shutil.copy(ROOT / "tools/pyconfig.h", headers)
    return headers


def python_library(work: Path, objects: Path) -> Path:
    """The import library of ``python3.dll`` for the names that an object needs."""
    names = re.findall(r"(?:__imp_)?(_?Py\w+)", run("nm", "-u", objects))
    definition, library = work / "python3.def", work / "libpython3.a"
    definition.write_text("LIBRARY python3.dll\nEXPORTS\n" + "\n".join(sorted(set(names))) + "\n")
    zig("dlltool", "-m", "i386:x86-64", "-d", definition, "-l", library)
    return library


def build_extension(
    name: str, triple: str, source: Path, headers: Path, cross: Path, work: Path
) -> Path:
    """Compile what cffi wrote, and link it with the archives of the target."""
    target = TARGETS[name]
    work.mkdir(parents=True, exist_ok=True)
    compiler = ("cc", "-target", triple)
    limited = f"-DPy_LIMITED_API=0x{PYTHON[0]:02x}{PYTHON[1]:02x}0000"
    flags = (
        "-std=gnu99",
        "-ffp-contract=off",
        "-w",
        "-Oz",
        "-g0",
        "-fno-asynchronous-unwind-tables",
        "-fno-unwind-tables",
        "-fPIC",
        "-fvisibility=hidden",
        "-fno-sanitize=all",
        limited,
    )
    core = work / "_core.o"
    zig(*compiler, *flags, f"-I{headers}", "-Ilibcontact/include", "-c", source, "-o", core)
    libraries = [cross / name / "lib" / f"libcontact{a}.a" for a in ("-gsl", "-hdf5", "")]
    if target.extension.endswith(".pyd"):
        libraries.append(python_library(work, core))
    extension = work / target.extension
    # -Os: what the linker adds of the compiler's runtime is of its small build, too.
    link = ("-Os", "-s", core, *libraries, "-lm", "-lpthread")
    zig(*compiler, *target.link, *link, "-o", extension)
    return extension


def add_licences(name: str, info: Path) -> None:
    """The texts of what the compiler links inside: of its own runtime and, on Windows, of the C library's."""
    here = Path(ziglang.__file__).parent
    texts = {"zig": (here / "LICENSE").read_text()}
    if "windows" in name:
        libc = here / "lib/libc"
        texts |= {"mingw-w64": (libc / "mingw/COPYING").read_text()}
        texts |= {"musl": (libc / "musl/COPYRIGHT").read_text()}
        threads = (libc / "mingw/winpthreads/thread.c").read_text()
        texts |= {"winpthreads": threads[threads.index("/*") + 2 : threads.index("*/")]}
    metadata = (info / "METADATA").read_text()
    for part, text in texts.items():
        (info / f"licenses/LICENSE.{part}").write_text(text)
        metadata = metadata.replace(
            "License-File: ", f"License-File: LICENSE.{part}\nLicense-File: ", 1
        )
    (info / "METADATA").write_text(metadata)


def pack(name: str, package: Path, extension: Path, work: Path, out: Path) -> Path:
    """The wheel: the package with this extension, and a tag for each machine that can take it."""
    tree = work / "tree"
    shutil.rmtree(tree, ignore_errors=True)
    shutil.copytree(package, tree)
    shutil.copy(extension, tree / "libcontact")
    (info,) = tree.glob("*.dist-info")
    python = "cp" + "".join(map(str, PYTHON))
    tags = "".join(f"Tag: {python}-abi3-{tag}\n" for tag in TARGETS[name].tag.split("."))
    add_licences(name, info)
    (info / "WHEEL").write_text(
        f"Wheel-Version: 1.0\nGenerator: libcontact\nRoot-Is-Purelib: false\n{tags}"
    )
    said = run(sys.executable, "-m", "wheel", "pack", tree, "--dest-dir", work)
    for old in out.glob(f"*{TARGETS[name].tag.split('.')[0]}*.whl"):
        old.unlink()
    said = run(sys.executable, "-m", "wheel", "pack", tree, "--dest-dir", out)
    return out / re.search(r"(libcontact-\S+\.whl)", said)[1]


def package_tree(work: Path) -> Path:
    """The package without its extension, and its metadata."""
    tree = work / "package"
    shutil.rmtree(tree, ignore_errors=True)
    run(sys.executable, "setup.py", "-q", "build_py", "--build-lib", tree)
    for left in tree.rglob("_core.*"):
        if left.suffix != ".pyi":
            left.unlink()
    metadata = "import sys; from setuptools import build_meta; build_meta.prepare_metadata_for_build_wheel(sys.argv[1])"
    run(sys.executable, "-c", metadata, tree)
    for left in tree.glob("*.egg-info"):
        shutil.rmtree(left)
    return tree


def write_source(work: Path) -> Path:
    """What cffi writes for the public headers."""
    source = work / "_core.c"
    write = (
        "import runpy, sys; runpy.run_path('wrapper/build_core.py')['ffi'].emit_c_code(sys.argv[1])"
    )
    run(sys.executable, "-c", write, source)
    return source


def main(build: str, *targets: str) -> None:
    wheels, work = Path(build).resolve() / "wheels", Path(build).resolve() / "cross"
    wheels.mkdir(exist_ok=True)
    os.environ["SOURCE_DATE_EPOCH"] = "1577836800"  # the same bytes each time
    package, source, headers = package_tree(work), write_source(work), python_headers(work)
    for name, triple in (each.split("=") for each in targets):
        extension = build_extension(name, triple, source, headers, work, work / name / "wheel")
        wheel = pack(name, package, extension, work / name / "wheel", wheels)
        if wheel.stat().st_size > LARGEST:
            sys.exit(f"{wheel.name} has {wheel.stat().st_size} bytes, more than {LARGEST}")
        print(f"written: {wheel}")


if __name__ == "__main__":
    main(*sys.argv[1:])
