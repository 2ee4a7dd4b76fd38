"""Try the wheels of ``make wheels``, each as far as this machine can, and print one table.

``try_wheels.py build/cross build/wheels linux-x86_64=x86_64-linux-gnu.2.17 ...`` installs a wheel with its extra into a
fresh environment and runs ``tests/cross/wheel.py`` there: for this machine with each Python from 3.10 on that is found,
for ARM with Debian's Python under QEMU. Of the other machines the C library runs ``tests/cross/cross.c``, as far as
their emulator is here. Other bits than those of the first end the command with 1. TABLE names a file that gets the
table, too.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import check_cross
from build_wheels import PYTHON, TARGETS, run

TRIAL = check_cross.ROOT / "tests/cross/wheel.py"
HEAD = ("machine", "wheel", "MB", "tried", "bits")
ARM_PYTHON = "3.11"  # of Debian 12
ARM_TAGS = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64")


def clean(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def trial(python: list[str], results: Path) -> tuple[str, str]:
    """What the program did in a Python, and the bits of its results."""
    done, bits = run(*python, TRIAL, clean(results)).splitlines()[-2:]
    return done, bits


def try_here(wheel: Path, work: Path) -> tuple[str, str]:
    """A fresh environment for each Python."""
    found, done, versions = set(), "", []
    names = [f"python{PYTHON[0]}.{minor}" for minor in range(PYTHON[1], 20)]
    for name in [name for name in names if shutil.which(name)]:
        if subprocess.run([name, "-c", "import venv"], capture_output=True).returncode:
            continue  # a name without its Python
        environment = clean(work / "fresh")
        run(name, "-m", "venv", environment)
        python = str(environment / "bin/python")
        run(python, "-m", "pip", "install", "-q", f"libcontact[plot] @ {wheel.as_uri()}")
        done, bits = trial([python, "-I"], work / "results")
        found.add(bits)
        versions.append(name.removeprefix("python"))
    return f"Python {', '.join(versions)}: {done}", " ".join(sorted(found))


def arm_python(work: Path) -> list[str]:
    """Debian's Python for ARM under QEMU, downloaded by apt and not installed; empty where that is not possible."""
    root, state = work / "debian", work / "apt"
    python = root / f"usr/bin/python{ARM_PYTHON}"
    if not python.exists() and all(map(shutil.which, ("qemu-aarch64", "apt-get", "dpkg-deb"))):
        for folder in ("lists/partial", "archives/partial"):
            (state / folder).mkdir(parents=True, exist_ok=True)
        (state / "status").touch()
        apt = ["apt-get", "-qq", "-y", "--no-install-recommends", "--download-only"]
        apt += ["-oAPT::Architecture=arm64", "-oAPT::Architectures=arm64", f"-oDir::Cache={state}"]
        apt += [f"-oDir::State={state}", f"-oDir::State::status={state}/status"]
        for words in (["update"], ["install", f"python{ARM_PYTHON}", "libstdc++6"]):
            subprocess.run([*apt, *words], stderr=subprocess.DEVNULL)
        for package in (state / "archives").glob("*.deb"):
            run("dpkg-deb", "-x", package, root)
    return ["qemu-aarch64", "-L", str(root), str(python)] if python.exists() else []


def try_arm(wheel: Path, work: Path) -> tuple[str, str] | None:
    """With its results file; pictures are left out, because they take minutes there."""
    python = arm_python(work)
    if not python:
        return None
    packages = clean(work / "packages")
    install = [sys.executable, "-m", "pip", "install", "-q", "--only-binary=:all:"]
    install += [f"--platform={tag}" for tag in ARM_TAGS]
    install += [f"--python-version={ARM_PYTHON}", "--target", str(packages)]
    run(*install, f"libcontact[files] @ {wheel.as_uri()}")
    os.environ["PYTHONPATH"] = str(packages)
    try:
        done, bits = trial(python, work / "results")
    finally:
        del os.environ["PYTHONPATH"]
    return f"Python {ARM_PYTHON} under QEMU: {done}", bits


def try_library(
    target: check_cross.Target, native: check_cross.Target, work: Path
) -> tuple[str, str]:
    """The C library in a program, by one thread and two, against that of this machine."""
    if not target.runs():
        return "built only", ""
    hashes = []
    for each in (native, target):
        program = check_cross.build(each, work / "cross.exe")
        hashes += [check_cross.run(each, program, "60", threads)[0] for threads in ("1", "2")]
    how = f"C library under {target.emulator}" if target.emulator else "C library"
    return how, "equal" if all(one == hashes[0] for one in hashes) else "DIFFER"


def main(build_folder: str, compiler: str, *targets: str) -> int:
    build = Path(build_folder).resolve()
    cross = build / "cross"
    native = check_cross.Target(compiler.split(), build / "lib/libcontact.a")
    rows, first = [], ""
    for name, triple in (each.split("=") for each in targets):
        print(f"  try {name}", file=sys.stderr, flush=True)
        tag = TARGETS[name].tag.split(".")[0]
        (wheel,) = (build / "wheels").glob(f"*{tag}*.whl")
        tried = None
        if name == "linux-x86_64":
            tried = try_here(wheel, cross / name)
            first = tried[1]
        elif name == "linux-aarch64":
            tried = try_arm(wheel, cross / name)
        if tried is None:
            tried = try_library(check_cross.target_of(name, triple, cross), native, cross / name)
        elif first:
            tried = tried[0], first[:10] if tried[1] == first else "DIFFER"
        rows.append((name, tag, f"{wheel.stat().st_size / 1e6:.2f}", *tried))
    check_cross.write(HEAD, rows)
    return any("DIFFER" in line for line in rows)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
