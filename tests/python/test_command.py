"""The command line: exit codes, output on stdout and stderr, and no traceback after a mistake of the user."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from libcontact._core import lib
from libcontact.command import main
from libcontact.run import RunError

import libcontact as ct

SCENES = Path(__file__).parents[2] / "tutorials" / "scenes"
needs_hdf5 = pytest.mark.skipif(not ct.has("hdf5"), reason="built without HDF5")


@pytest.fixture
def scene(tmp_path, monkeypatch):
    """A plate of 20 x 1 x 20 cells that hits a wall, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    text = (SCENES / "plates_reference.toml").read_text()
    text = text.replace("[100, 1, 100]", "[20, 1, 20]").replace("every = 50", "every = 20")
    Path("scene.toml").write_text(text)
    return "scene.toml"


def test_version_is_that_of_the_library(capsys):
    from libcontact._core import ffi

    assert main(["--version"]) == 0
    assert capsys.readouterr().out == f"libcontact {ffi.string(lib.ct_version()).decode()}\n"


@pytest.mark.parametrize(
    "arguments",
    [
        [],
        ["walk"],
        ["run"],
        ["run", "a.toml", "--until", "soon"],
        ["run", "a.toml", "--threads", "x"],
    ],
)
def test_a_wrong_command_line_is_bad_input(arguments, capsys):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert not out and "usage: libcontact" in err


def test_explain_prints_to_stdout(scene, capsys):
    assert main(["explain", scene]) == 0
    out, err = capsys.readouterr()
    assert "400 hex8" in out and "c1 = 6.02" in out and not err


@needs_hdf5
def test_run_writes_the_file_and_reports_on_stderr(scene, capsys):
    assert main(["run", scene, "-o", "out.vtkhdf"]) == 0
    out, err = capsys.readouterr()
    assert not out and "out.vtkhdf" in err and "work balance" in err
    assert sorted(os.listdir()) == ["out.vtkhdf", "scene.toml"]
    assert main(["run", scene, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "") and os.path.exists("plates_reference.vtkhdf")


@needs_hdf5
def test_a_stopped_run_is_continued_to_the_same_end(scene, capsys):
    from libcontact.run import Run

    assert main(["run", scene, "-o", "whole.vtkhdf"]) == 0
    assert main(["run", scene, "-o", "first.vtkhdf", "--until", "1e-7"]) == 0
    assert (
        main(["run", scene, "-o", "rest.vtkhdf", "--restart", "first.vtkhdf", "--threads", "2"])
        == 0
    )
    whole, rest = Run.load("whole.vtkhdf"), Run.load("rest.vtkhdf")
    assert whole.state["right"].displacement.tobytes() == rest.state["right"].displacement.tobytes()
    assert Run.load("first.vtkhdf").time[-1] == pytest.approx(1e-7, rel=0.05)


@needs_hdf5
def test_plot_draws_a_picture(scene, capsys):
    pytest.importorskip("matplotlib")
    assert main(["run", scene, "-o", "out.vtkhdf", "--until", "1e-7", "--quiet"]) == 0
    assert main(["plot", "out.vtkhdf"]) == 0
    assert (
        main(["plot", "out.vtkhdf", "-o", "v.png", "--field", "principal_min", "--scale", "10"])
        == 0
    )
    for name in ("out.png", "v.png"):
        assert (
            Path(name).read_bytes().startswith(b"\x89PNG")
            and name in capsys.readouterr().err + name
        )
    assert main(["plot", "out.vtkhdf", "--field", "stress_xq"]) == 2
    assert "did you mean" in capsys.readouterr().err
    assert main(["plot", "out.vtkhdf", "-o", "none/v.png"]) == 2


@pytest.mark.parametrize("file", ["out.vtkhdf", None])
def test_run_with_plot_gives_a_picture_in_one_command(file, scene, capsys):
    """Beside the results file, or, if a scene writes none, named after the scene in this folder."""
    image = pytest.importorskip("matplotlib.image")
    if file is None:
        text = Path(scene).read_text()
        Path(scene).write_text("\n".join(x for x in text.splitlines() if "vtkhdf" not in x))
    elif not ct.has("hdf5"):
        pytest.skip("built without HDF5")
    output = ["-o", file] if file else []
    more = ["--plot", "--field", "velocity_x", "--scale", "100"]
    assert main(["run", scene, "--until", "1e-7", *output, *more]) == 0
    name = "out.png" if file else "scene.png"
    assert re.search(rf'picture in ".*{name}"', capsys.readouterr().err)
    pixels = image.imread(name)
    assert min(pixels.shape[:2]) > 1000 and pixels.std() > 0.05


@pytest.mark.parametrize(
    "wrong",
    [
        ["--field", "stress_xq"],
        ["--field", "velocity"],
        ["--scale", "inf"],
        ["--view", "above"],
        ["--view", "x_min+x_max"],
        ["--instants", "0"],
    ],
)
def test_run_refuses_a_picture_that_cannot_be_before_it_computes(wrong, scene, capsys):
    pytest.importorskip("matplotlib")
    assert main(["run", scene, "--plot", *wrong]) == 2
    assert "error: " in capsys.readouterr().err and os.listdir() == ["scene.toml"]


def test_run_draws_before_it_reports_a_file_that_was_not_written(scene, capsys, monkeypatch):
    """A wheel has no HDF5: the picture is drawn, and the exit code reports the missing file."""
    pytest.importorskip("matplotlib")
    monkeypatch.setattr("libcontact.loop.has", lambda part: False)
    monkeypatch.setattr("libcontact.warned.has", lambda part: False)
    assert main(["run", scene, "--plot", "--until", "1e-7", "-o", "out.vtkhdf"]) == 3
    assert Path("scene.png").read_bytes().startswith(b"\x89PNG")
    err = capsys.readouterr().err
    assert err.index("scene.png") < err.index("was not written")


@needs_hdf5
def test_plot_draws_what_there_is(scene, capsys):
    pytest.importorskip("matplotlib")
    Path(scene).write_text(
        Path(scene).read_text().replace('["displacement", "velocity", "stress"]', '["stress"]')
    )
    assert main(["run", scene, "-o", "out.vtkhdf", "--until", "1e-7", "--quiet"]) == 0
    assert main(["plot", "out.vtkhdf"]) == 0
    assert main(["plot", "out.vtkhdf", "--field", "velocity_x"]) == 2
    assert "velocity was not recorded" in capsys.readouterr().err


@pytest.mark.parametrize(
    "arguments, words",
    [
        (["run", "none.toml"], "none.toml"),
        (["explain", "none.toml"], "none.toml"),
        (["run", "scene.toml", "-o", "none/out.vtkhdf"], "output.file"),
        (["run", "scene.toml", "--until", "-1"], "until"),
        (["run", "scene.toml", "--until", "1"], "until"),
        (["run", "scene.toml", "--threads", "0"], "threads"),
        (["run", "scene.toml", "--restart", "none.vtkhdf"], "none.vtkhdf"),
        (["plot", "none.vtkhdf"], "none.vtkhdf"),
        (["plot", "scene.toml"], "scene.toml"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(scene, arguments, words, capsys):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert not out and words in err and "Traceback" not in err and err.startswith("error: ")


def test_what_may_never_end_is_not_read(scene, capsys):
    """Devices, pipes and files that are too large, as scenes and as meshes: an error that names them, before anything is read (4 GB are available)."""
    resource = pytest.importorskip("resource")
    os.mkfifo("pipe.toml")
    with open("large.toml", "wb") as file:
        file.truncate(300_000_000)
    text = Path(scene).read_text()
    box = next(line for line in text.splitlines() if line.startswith("box ="))
    Path("mesh.toml").write_text(text.replace(box, 'mesh = "pipe.toml"'))
    for path, words in (
        ("/dev/zero", "not a regular file"),
        ("pipe.toml", "not a regular file"),
        ("large.toml", "300 MB; at most 256 MB"),
        ("mesh.toml", "pipe.toml"),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "libcontact", "explain", path],
            capture_output=True,
            text=True,
            timeout=60,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30)),
        )
        assert (
            done.returncode == 2
            and words in done.stderr
            and path in done.stderr
            and len(done.stderr.splitlines()) == 1
        )
    assert main(["plot", "pipe.toml"]) == 2 and "not a regular file" in capsys.readouterr().err


def test_a_run_that_fails_has_exit_code_3(scene, capsys, monkeypatch):
    def fail(*_):
        raise RunError("the motion stopped being finite")

    monkeypatch.setattr("libcontact.loop.Loop._advance", fail)
    assert main(["run", scene]) == 3
    assert "the run failed: " in capsys.readouterr().err


def test_a_warning_that_python_makes_an_error_is_one_line_and_exit_code_3(scene):
    """Before the first step, as with wrong units, and so without a file."""
    Path(scene).write_text(Path(scene).read_text().replace("young = 2.1e5", "young = 1e-9"))
    for flag, code in (("error", 3), ("default", 0)):
        done = subprocess.run(
            [
                sys.executable,
                "-W",
                flag,
                "-m",
                "libcontact",
                "run",
                scene,
                "--quiet",
                "--until",
                "1e-9",
            ],
            capture_output=True,
            text=True,
            timeout=60,
        )
        told = [line for line in done.stderr.splitlines() if "c1 = " in line]
        assert done.returncode == code and len(told) == 1 and "Traceback" not in done.stderr
        assert ("the run failed" in told[0]) == (code == 3)


def test_ctrl_c_has_exit_code_130_and_keeps_the_file(scene):
    Path(scene).write_text(
        Path(scene)
        .read_text()
        .replace("end_c1t_over = { length = 2.5, value = 0.56 }", "end = 1.0")
    )
    # A shell starts background jobs that ignore Ctrl-C, and children inherit this: handle it again.
    process = subprocess.Popen(
        [sys.executable, "-m", "libcontact", "run", scene, "-o", "out.vtkhdf"],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    if ct.has("hdf5"):
        while process.poll() is None and not os.path.exists("out.vtkhdf"):
            time.sleep(0.001)
    else:
        time.sleep(5.0)
    process.send_signal(signal.SIGINT)
    try:
        _, err = process.communicate(timeout=60)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert "interrupted at t = " in err and "Traceback" not in err
    if ct.has("hdf5"):
        from libcontact.run import Run

        kept = Run.load("out.vtkhdf").time
        assert f"interrupted at t = {kept[-1]:.6g}; {len(kept)} records are kept" in err


def test_ctrl_c_among_the_imports_has_exit_code_130_and_says_one_word(tmp_path):
    """A numpy whose first line is interrupted simulates the moment."""
    (tmp_path / "numpy.py").write_text("raise KeyboardInterrupt")
    place = {**os.environ, "PYTHONPATH": str(tmp_path)}
    for arguments in (["run", "scene.toml"], ["explain", "scene.toml"]):
        done = subprocess.run(
            [sys.executable, "-m", "libcontact", *arguments],
            capture_output=True,
            text=True,
            env=place,
        )
        assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_the_command_of_the_shell_is_that_of_the_package():
    import importlib.metadata

    (command,) = (
        e
        for e in importlib.metadata.distribution("libcontact").entry_points
        if e.group == "console_scripts"
    )
    assert command.value == "libcontact.__main__:main"


def test_every_name_of_the_package_is_there():
    import libcontact as ct

    for name in ct.__all__:
        assert getattr(ct, name) is not None and name in dir(ct)
    with pytest.raises(AttributeError, match="scnee"):
        ct.scnee


@needs_hdf5
def test_a_full_disk_fails_the_run_and_keeps_what_was_written(scene):
    """A limit on the size of files simulates a full disk: the system refuses the bytes in the same way."""
    import resource

    Path(scene).write_text(Path(scene).read_text().replace("every = 20", "every = 1"))
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
    command = [sys.executable, "-m", "libcontact", "run", scene, "-o", "out.vtkhdf"]
    done = subprocess.run(command, check=False, stderr=subprocess.PIPE, text=True, preexec_fn=limit)
    assert done.returncode == 3, done.stderr
    assert "the run failed: " in done.stderr and "Traceback" not in done.stderr
    from libcontact.run import Run

    kept = Run.load("out.vtkhdf")
    assert 1 < len(kept.time) < 80 and f"{len(kept.time)} records" in done.stderr


@needs_hdf5
def test_a_disk_with_room_for_the_file_and_a_margin_takes_all_of_it(scene):
    """A step reserves space for the chunks that it begins, not for one chunk of each table."""
    import resource

    Path(scene).write_text(Path(scene).read_text().replace("every = 20", "every = 1"))
    command = [sys.executable, "-m", "libcontact", "run", scene, "-o", "out.vtkhdf"]
    subprocess.run(command, check=True, capture_output=True)
    most = Path("out.vtkhdf").stat().st_size + 300_000
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    done = subprocess.run(command, check=False, capture_output=True, text=True, preexec_fn=limit)
    assert done.returncode == 0, done.stderr


def test_a_closed_pipe_is_no_error(scene):
    command = f"{sys.executable} -m libcontact explain {scene} | head -n 1"
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {command}"], check=False, capture_output=True, text=True
    )
    assert "Traceback" not in done.stderr and "BrokenPipe" not in done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", [["explain", "scene.toml"], ["schema"], ["--version"]])
def test_an_output_that_takes_no_text_is_one_line_and_exit_code_2(scene, arguments):
    """Also where Python itself notices it at its end only, as for the text of an option."""
    place = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    with open("/dev/full", "w") as full:
        command = [sys.executable, "-m", "libcontact", *arguments]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True, env=place)
    assert done.returncode == 2 and done.stderr == "error: No space left on device\n"


def test_the_schema_is_written_for_editors(capsys):
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    poisson = schema["properties"]["material"]["items"]["properties"]["poisson"]
    assert (poisson["exclusiveMinimum"], poisson["exclusiveMaximum"]) == (-1, 0.5)
    assert poisson["description"].startswith("Poisson's ratio")
