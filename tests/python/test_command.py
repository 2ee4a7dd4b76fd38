"""The command line: exit codes, output on stdout and stderr, and no traceback after a mistake of the user."""

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commands import captured
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
    monkeypatch.setattr("libcontact.checks.warned.has", lambda part: False)
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
    """Devices, pipes and files that are too large, as scenes and as meshes: an error that names them, before anything
    is read (4 GB are available)."""
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
        done = captured(
            [sys.executable, "-m", "libcontact", "explain", path],
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
        done = captured(
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
        assert "from which --restart continues" in err


def test_ctrl_c_among_the_imports_has_exit_code_130_and_says_one_word(tmp_path):
    """A numpy whose first line is interrupted simulates the moment."""
    (tmp_path / "numpy.py").write_text("raise KeyboardInterrupt")
    place = {**os.environ, "PYTHONPATH": str(tmp_path)}
    for arguments in (["run", "scene.toml"], ["explain", "scene.toml"]):
        done = captured([sys.executable, "-m", "libcontact", *arguments], env=place)
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
    assert "Traceback" not in done.stderr
    # One message, of what is in the file.
    (told,) = [line for line in done.stderr.splitlines() if "energy" not in line]
    assert told.startswith("the run failed: ") and "last good state" not in told
    from libcontact.run import Run

    kept = Run.load("out.vtkhdf")
    assert 1 < len(kept.time) < 80 and f"{len(kept.time)} records" in told
    assert f"t = {kept.time[-1]:.6g} (step {kept.steps[-1]})" in told


@needs_hdf5
def test_a_disk_with_room_for_the_file_and_a_margin_takes_all_of_it(scene):
    """A step reserves space for the chunks that it begins, not for one chunk of each table."""
    import resource

    Path(scene).write_text(Path(scene).read_text().replace("every = 20", "every = 1"))
    command = [sys.executable, "-m", "libcontact", "run", scene, "-o", "out.vtkhdf"]
    subprocess.run(command, check=True, capture_output=True)
    most = Path("out.vtkhdf").stat().st_size + 300_000
    limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    done = captured(command, check=False, preexec_fn=limit)
    assert done.returncode == 0, done.stderr


def test_a_closed_pipe_is_no_error(scene):
    command = f"{sys.executable} -m libcontact explain {scene} | head -n 1"
    done = captured(["bash", "-c", f"set -o pipefail; {command}"], check=False)
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


# Information and exports.


@pytest.fixture
def run_file(scene):
    """The results file of the scene, with a probe."""
    probe = '\n[[probe]]\nname = "a wall"\nsurface = "right.x_min"\nquantities = ["velocity"]\n'
    Path(scene).write_text(Path(scene).read_text() + probe)
    assert main(["run", scene, "-o", "out.vtkhdf", "--until", "4e-8", "--quiet"]) == 0
    return "out.vtkhdf"


@needs_hdf5
def test_info_tells_what_is_in_a_file(run_file, scene, capsys):
    """Of results, of a scene, and of a mesh, for readers and for programs."""
    run = ct.Run.load(run_file)
    assert main(["info", run_file, "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    (body,) = facts["bodies"]
    assert (body["name"], body["element"], body["elements"], body["nodes"]) == (
        "right",
        "hex8",
        400,
        882,
    )
    assert facts["kind"] == "results" and facts["version"] == ct.__version__
    assert facts["records"] == len(run.steps) and facts["steps"] == run.steps[[0, -1]].tolist()
    assert facts["times"] == run.time[[0, -1]].tolist() and facts["bytes"] == os.path.getsize(
        run_file
    )
    assert facts["fields"] == ["displacement", "velocity", "stress"]
    (probe,) = facts["probes"]
    assert probe["rows"] == len(run.probes["a wall"]) and "velocity_x" in probe["columns"]
    assert main(["info", scene, run_file]) == 0
    out, err = capsys.readouterr()
    assert "400 hex8, 882 nodes" in out and f"libcontact {ct.__version__}" in out
    assert "steps    0 to " in out and out.count("time ") == 2
    assert main(["info", "none.vtkhdf"]) == 2 and "none.vtkhdf" in capsys.readouterr().err


def test_json_goes_to_stdout_and_messages_to_stderr(scene, capsys):
    assert main(["run", scene, "--until", "2e-8", "--json"]) == 0
    out, err = capsys.readouterr()
    facts, run = json.loads(out), ct.Scene.load(scene).run(output=False, until=2e-8)
    assert facts["exit"] == 0 and facts["energy"]["total"] == run.energy["total"][-1]
    assert facts["steps"] == run.steps[-1] and "work balance" in err
    assert main(["explain", scene, "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["bodies"][0]["elements"] == 400 and facts["plan"][0]["name"] == "solid"
    assert main(["explain", scene, "--json", "--set", "time.end=-1"]) == 2
    facts = json.loads(capsys.readouterr().out)
    assert facts["exit"] == 2 and "time.end" in facts["error"]


def test_a_report_has_the_largest_contact_pressure(tmp_path, monkeypatch, capsys):
    """Recovered, with its place, and the energy of the obstacle; in JSON, too, and only if something touches."""
    monkeypatch.chdir(tmp_path)
    hertz = ct.example("hertz")
    run = ct.Scene.load(hertz).run(output=False, until=2e-5)
    (nodes,) = run.pressure["obstacle"]
    most = nodes[nodes["pressure"].argmax()]
    assert main(["run", str(hertz), "--until", "2e-5", "--json"]) == 0
    out, err = capsys.readouterr()
    facts = json.loads(out)["contact_pressure"]
    assert facts["pressure"] == most["pressure"] > 0 and facts["position"] == [*most["position"]]
    assert facts["node"] == most["node"] and facts["body"] == "block"
    assert f"pressure at the end: {most['pressure']:.6g} MPa at (" in err
    assert f"obstacle {run.energy['obstacle'][-1]:.6g}," in err and "contact 0" not in err
    data = ct.Scene.load(hertz).data
    del data["obstacle"]
    ct.Scene(data).save("free.toml")
    assert main(["run", "free.toml", "--until", "1e-6", "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["contact_pressure"] is None and "pressure" not in err


@pytest.mark.parametrize("until, touched", [("0.9", False), ("3", True)])
def test_a_report_says_if_nothing_touched(until, touched, tmp_path, monkeypatch, capsys):
    """A bar falls from 5 m at 10 m/s² on a wall: its contact lasts from 1 s to 1 + 2 L / c = 1.67 s."""
    monkeypatch.chdir(tmp_path)
    assert main(["run", str(ct.example("bouncing_bar")), "--until", until]) == 0
    assert ("nothing touched" not in capsys.readouterr().err) is touched


def test_json_has_no_numbers_that_json_lacks():
    from libcontact.command import _json

    assert json.loads(_json({"a": float("nan"), "b": [float("inf"), 1.5], "c": (True, None)})) == {
        "a": None,
        "b": [None, 1.5],
        "c": [True, None],
    }


def test_several_scenes_in_one_call(scene, capsys):
    """Each has its own results; a wrong one does not keep the others from running, and the worst exit code counts."""
    text = Path(scene).read_text()
    Path("other.toml").write_text(text.replace("plates_reference.vtkhdf", "other.vtkhdf"))
    Path("wrong.toml").write_text("title = 3\n")
    assert main(["run", "wrong.toml", scene, "other.toml", "--until", "1e-8", "--quiet"]) == 2
    assert "wrong.toml" in capsys.readouterr().err
    if ct.has("hdf5"):
        assert Path("other.vtkhdf").exists() and Path("plates_reference.vtkhdf").exists()
    assert main(["explain", scene, "other.toml", "--json"]) == 0
    names = [json.loads(line)["scene"] for line in capsys.readouterr().out.splitlines()]
    assert names == [scene, "other.toml"]


def test_several_scenes_do_not_share_a_file(scene, capsys):
    Path("other.toml").write_text(Path(scene).read_text())
    assert main(["run", scene, "other.toml"]) == 2
    assert "both write" in capsys.readouterr().err
    assert main(["run", scene, "other.toml", "-o", "x.vtkhdf"]) == 2
    assert sorted(os.listdir()) == ["other.toml", "scene.toml"]


def test_set_replaces_values_of_the_scene(scene, capsys):
    change = ["--set", "time.end_c1t_over.value=0.1", "--set", "body.0.box.cells=[10, 1, 10]"]
    assert main(["explain", scene, "--json", *change, "--set", "output.every=7"]) == 0
    facts = json.loads(capsys.readouterr().out)
    data = ct.Scene.load(scene).data
    data["time"]["end_c1t_over"]["value"], data["output"]["every"] = 0.1, 7
    data["body"][0]["box"]["cells"] = [10, 1, 10]
    wanted = ct.Scene(data).explain().data
    assert facts["time"]["steps"] == wanted["time"]["steps"] and facts["output"]["every"] == 7
    assert facts["bodies"][0]["elements"] == wanted["bodies"][0]["elements"] == 100


@pytest.mark.parametrize(
    "change, words",
    [
        ("time.edn=1", "time.edn: unknown key"),
        ("body.3.velocity=[0, 0, 0]", "body[3] does not exist"),
        ("contact.0.beta=3", "there is no [[contact]]"),
        ("title.x=3", "title is not a table"),
        ("time.end", "KEY=VALUE"),
        ("time.end=[1", "no value of TOML"),
        ("body[0].element=hex21", 'body[0].element: "hex21"'),
    ],
)
def test_a_wrong_set_names_its_key(scene, change, words, capsys):
    assert main(["explain", scene, "--set", change]) == 2
    err = capsys.readouterr().err
    # A value that is not of the file has no line in it.
    assert words in err and "Traceback" not in err and "scene.toml:1" not in err


@pytest.mark.parametrize("name", ["x.vtu", "x.csv", "x.xdmf", "x.PNG", "x.vthdf"])
def test_results_are_not_written_under_the_name_of_another_format(scene, name, capsys):
    assert main(["run", scene, "-o", name]) == 2
    assert "x.vtkhdf" in capsys.readouterr().err and os.listdir() == ["scene.toml"]


@needs_hdf5
def test_export_to_csv_has_all_rows(run_file):
    assert main(["export", run_file, "--to", "csv", "-o", "tables"]) == 0
    run = ct.Run.load(run_file)
    assert sorted(os.listdir("tables")) == ["energy.csv", "momentum.csv", "probe_a_wall.csv"]
    rows = list(csv.DictReader(open("tables/momentum.csv")))
    assert [float(row["p_x"]) for row in rows] == run.momentum["p"][:, 0].tolist()
    assert {row["body"] for row in rows} == {"right"}
    rows = list(csv.DictReader(open("tables/probe_a_wall.csv")))
    assert [float(row["velocity_x"]) for row in rows] == run.probes["a wall"]["velocity"][
        :, 0
    ].tolist()


@needs_hdf5
def test_export_to_vtu_and_xdmf_is_read_back(run_file):
    """By meshio's own readers: the last record, and all of them."""
    meshio = pytest.importorskip("meshio")
    run = ct.Run.load(run_file)
    assert main(["export", run_file, "--to", "vtu"]) == 0
    grid, state = meshio.read("out.vtu"), run.state["right"]
    assert (grid.points == state.nodes).all() and (grid.cells[0].data == state.elements).all()
    assert (grid.point_data["velocity"] == state.velocity).all()
    assert (grid.cell_data["stress"][0] == state.stress).all()
    Path("folder").mkdir()
    assert main(["export", run_file, "--to", "xdmf", "-o", "folder/all.xdmf"]) == 0
    assert sorted(os.listdir("folder")) == ["all.h5", "all.xdmf"]
    with meshio.xdmf.TimeSeriesReader("folder/all.xdmf") as reader:
        points, cells = reader.read_points_cells()
        assert reader.num_steps == len(run.steps) and (points == state.nodes).all()
        for k in range(reader.num_steps):
            time, at_points, at_cells = reader.read_data(k)
            now = ct.Run.load(run_file, k).state
            assert time == now.time
            assert (at_points["displacement"] == now["right"].displacement).all()
    assert main(["export", run_file, "--to", "xdmf", "-o", "out.xdmf"]) == 0
    os.rename("out.vtkhdf", "run.h5")
    before = Path("run.h5").read_bytes()
    assert main(["export", "run.h5", "--to", "xdmf", "-o", "run.xdmf"]) == 2
    assert Path("run.h5").read_bytes() == before


@needs_hdf5
@pytest.mark.parametrize(
    "module, arguments, told",
    [
        ("meshio", ["export", "out.vtkhdf", "--to", "vtu"], "-m pip install"),
        ("shtab", ["completion", "bash"], "-m pip install"),
    ],
)
def test_a_missing_extra_is_named(run_file, module, arguments, told, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, module, None)
    assert main(arguments) == 2
    said = " ".join(capsys.readouterr().err.split())
    assert told in said and module in said.partition(told)[2]


@needs_hdf5
def test_animate_draws_the_records(run_file, capsys):
    image = pytest.importorskip("PIL.Image")
    pytest.importorskip("matplotlib")
    assert main(["animate", run_file, "--instants", "3", "--field", "velocity_x"]) == 0
    film = image.open("out.gif")
    assert film.n_frames == 3
    frames = []
    for k in range(3):
        film.seek(k)
        frames.append(film.convert("RGB").tobytes())
    assert len(set(frames)) == 3
    assert main(["plot", run_file, "--field", "velocity_x", "--movie", "same.gif"]) == 0
    assert image.open("same.gif").n_frames > 3
    assert main(["animate", run_file, "-o", "out.avi"]) == 2
    assert ".gif and .mp4" in capsys.readouterr().err


def test_completion_knows_every_command(capsys):
    pytest.importorskip("shtab")
    assert main(["completion", "bash"]) == 0
    text = capsys.readouterr().out
    for word in ("explain", "animate", "--restart", "--set"):
        assert word in text
    done = captured(["bash", "-n"], input=text)
    assert (done.returncode, done.stderr) == (0, "")


def test_tables_become_those_of_pandas(scene):
    """One column per number: vectors and stresses are split, and nothing is lost."""
    pytest.importorskip("pandas")
    text = Path(scene).read_text()
    probe = '\n[[probe]]\nname = "p"\nbody = "right"\npoint = [1.2, 0.01, 0.1]\nquantities = ["velocity", "stress"]\n'
    Path(scene).write_text(text + probe)
    run = ct.Scene.load(scene).run(output=False, until=2e-8)
    energy, momentum = run.energy.to_pandas(), run.momentum.to_pandas()
    assert (run.momentum["p_x"] == run.momentum["p"][:, 0]).all()
    with pytest.raises(ValueError, match='no field is named "p_w"; did you mean "p_'):
        run.momentum["p_w"]
    assert list(energy) == list(run.energy.dtype.names) and len(energy) == len(run.steps)
    assert (momentum["p_x"] == run.momentum["p"][:, 0]).all()
    assert {"L_z", "contact_impulse_y", "body"} <= {*momentum}
    history = run.probes["p"].to_pandas()
    assert (history["stress_zx"] == run.probes["p"]["stress"][:, 5]).all()
    assert type(run.energy["total"]) is np.ndarray and len(run.body_momentum("right").to_pandas())


@pytest.mark.parametrize(
    "change, where",
    [
        (("young = 2.1e5", "yuong = 2.1e5"), "yuong"),
        (("poisson = 0.3", "poisson = 0.7"), "poisson"),
        (('element = "hex8"', 'element = "hex9"'), "element"),
        (("[time]", "[time"), "[time"),
        (("[-1000, 0, 0]", "[-1000,\n  0, 0, 1]"), "velocity"),
    ],
)
def test_a_wrong_key_is_told_with_its_line(scene, change, where, capsys):
    """Also behind values of several lines, and in tables that are given several times."""
    head = '# A "comment" with [brackets]\ntitle = """\n[[body]]\n"""\n'
    text = re.sub(r"^title.*\n", "", Path(scene).read_text(), flags=re.M)
    assert change[0] in text
    Path(scene).write_text(head + text.replace(*change))
    assert main(["explain", scene]) == 2
    lines = Path(scene).read_text().splitlines()
    number = int(re.search(r"scene\.toml:(\d+): ", capsys.readouterr().err)[1])
    assert where in lines[number - 1]


def test_places_of_keys():
    from libcontact.source import places

    text = 'a = 1 # [x]\n[t]\nb.c = [1,\n [2], # ]\n]\n"d e" = \'#[\'\n[[m]]\nn = 1\n[[m]]\nn = """\nq = 2\n"""\no = {p = 1}\n[m.z]\nw = 1\n'
    assert dict(places(text)) == {
        "a": 1,
        "t": 2,
        "t.b.c": 3,
        "t.b": 3,
        "t.d e": 6,
        "m[0]": 7,
        "m[0].n": 8,
        "m[1]": 9,
        "m[1].n": 10,
        "m[1].o": 13,
        "m[1].z": 14,
        "m[1].z.w": 15,
    }
