"""From a mesh file to a picture: scenes of at most 20 lines in tests/data, run by the command; and what they are
refused for."""

import re
import shutil
import zipfile
from pathlib import Path

import numpy as np
import pytest
from libcontact.command import main
from libcontact.meshes import read_mesh

import libcontact as ct

DATA = Path(__file__).resolve().parents[1] / "data"
SCENES = sorted(path.stem for path in DATA.glob("*.toml"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """The scenes of tests/data beside their mesh files."""
    path = tmp_path_factory.mktemp("scenes")
    with zipfile.ZipFile(DATA / "meshes.zip") as archive:
        archive.extractall(path)
    for file in [*DATA.glob("*.toml"), *DATA.glob("*.inp")]:
        shutil.copy(file, path)
    return path


def changed(folder, name, old, new):
    """A scene with a changed text."""
    text = (folder / f"{name}.toml").read_text()
    assert old in text
    path = folder / f"{name}_changed.toml"
    path.write_text(text.replace(old, new))
    return ct.Scene.load(path)


def test_there_is_a_scene_of_each_kind():
    assert SCENES == ["assembly", "blocks", "gears", "notch", "rings"]


@pytest.mark.parametrize("name", SCENES)
def test_from_a_file_to_a_picture_without_python(folder, name, capsys, monkeypatch):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(folder)
    assert len((folder / f"{name}.toml").read_text().splitlines()) <= 20
    assert main(["run", f"{name}.toml", "--plot"]) == 0
    assert f'picture in "{name}.png"' in capsys.readouterr().err
    assert (folder / f"{name}.png").stat().st_size > 10_000


@pytest.mark.parametrize("name", SCENES)
def test_a_mesh_file_brings_no_energy(folder, name):
    """Bodies that touch at t = 0 store none, at rest they stay at rest, and the energy of a run is conserved: to
    round-off with the linear law, and with the leapfrog's 1e-3 at large strain."""
    scene = ct.Scene.load(folder / f"{name}.toml")
    run = scene.run(output=False)
    start = run.energy[0]
    moving = start["kinetic"] + np.abs(run.energy["external"]).max()
    stored = {"strain", "contact"} & set(run.energy.dtype.names)
    assert all(abs(start[name]) <= 1e-25 * moving for name in stored)
    if name == "assembly":
        assert np.abs(run.energy["total"]).max() == moving == 0.0
        return
    bound = 1e-3 if name == "gears" else 1e-10
    assert np.abs(run.energy["total"] - start["total"]).max() <= bound * moving


def test_rings_and_gears_touch(folder):
    """Momentum goes from one body to the other, and none is lost."""
    for name, (one, two) in (("rings", ("outer", "inner")), ("gears", ("big", "small"))):
        run = ct.Scene.load(folder / f"{name}.toml").run(output=False)
        p, q = (run.body_momentum(body)["p"][:, :2] for body in (one, two))
        size = max(np.abs(p).max(), np.abs(q).max())
        assert np.abs(p[-1] - p[0]).max() > 0.1 * size
        assert np.abs(p + q - p[0] - q[0]).max() < 1e-12 * size


@pytest.mark.parametrize(
    "name, old, new, key, words",
    [
        ("blocks", 'part = "right"', 'part = "left"', "body[1].mesh", 'blocks.g": element 101 is in the bodies "left" and "right"'),
        ("blocks", 'part = "right"', "scale = 1.0", "body[1].mesh", 'element 101 is in the bodies "left" and "right", 1 in all'),
        ("assembly", '"UPPER"', '"BLOCK"', "body[1].mesh", 'element 1 of "LOWER" is in the bodies'),
        ("blocks", '"left.x_max"', '"left.front"', "contact[0].surfaces[0]", "part that is read has no members of this set"),
        ("blocks", 'part = "left"', 'part = "lft"', "body[0].mesh", 'named "lft"; did you mean "left"?'),
        ("notch", "rubber =", "rubbr =", "body[0].material.rubbr", 'did you mean "rubber"?'),
        ("notch", '"block.rubber_end"', '"block.rubber"', "load[0].surface", "this is a set of elements"),
        ("gears", "big.big_outer", "big.big_uoter", "contact[0].surfaces[0]", 'did you mean "big_outer"?'),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told(folder, name, old, new, key, words):
    with pytest.raises(ct.SceneError) as error:
        changed(folder, name, old, new).explain()
    assert error.value.key == key and words in error.value.reason, error.value.reason


def test_one_part_of_another_size_or_place_is_another_body(folder):
    """A ring twice, once half as large; a block twice, once beside itself."""
    smaller = 'part = "outer"\nscale = 0.5'
    text = (folder / "rings.toml").read_text().replace("inner.inner_out", "inner.outer_out")
    (folder / "two.toml").write_text(text.replace('part = "inner"', smaller))
    bodies = ct.Scene.load(folder / "two.toml").run(output=False).state
    assert (bodies["inner"].nodes == 0.5 * bodies["outer"].nodes).all()
    moved = 'part = "left"\ninitial = { displacement = [1, 0, 0] }'
    changed(folder, "blocks", 'part = "right"', moved).explain()


def test_names_of_bodies_and_sets_may_have_dots(folder):
    """ "b.left.side_set_8" is the set "side_set_8" of the body "b.left", "b.LOWER.BELOW" one of "b"."""
    text = (folder / "blocks.toml").read_text().replace('"left"\nmesh', '"b.left"\nmesh')
    (folder / "dotted.toml").write_text(text.replace('"left.x_max"', '"b.left.side_set_8"'))
    scene = ct.Scene.load(folder / "dotted.toml")
    assert scene.explain().data["sets"][0]["name"] == "b.left.side_set_8"
    scene.run(output=False).plot()
    scene = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"}, file=folder / "b.toml")
    scene.add_material("soft", young=1.0, poisson=0.2, density=1.0)
    scene.add_body("b", material="soft", mesh="assembly.inp").set_time(end=1.0)
    scene.add("load", surface="b.LOWER.BELOW", pressure=1e-3)
    assert scene.explain().data["sets"][0]["name"] == "b.LOWER.BELOW"


def test_a_set_may_have_the_name_of_a_face_until_it_is_used(folder):
    """``rings.msh`` has the sets of elements "outer" and "inner"."""
    faces = ct.Scene.load(folder / "rings.toml").explain().data["sets"]
    assert {each["name"] for each in faces} == {"outer.outer_in", "inner.inner_out"}
    whole = changed(folder, "rings", 'part = "outer"\n', "scale = 2.0\n")
    whole.explain()
    whole.add_support("outer.outer", fix="x")
    with pytest.raises(ct.SceneError, match="is a face that every body has and a set of elements"):
        whole.explain()
    skin = ct.Scene.load(folder / "rings.toml").add_support("outer.outer", fix="x")
    nodes = skin.explain().data["bodies"][0]["nodes"]
    assert nodes == len(read_mesh(folder / "rings.msh", part="outer").nodes)


def test_of_many_names_the_nearest_are_listed():
    """The cam has 34 sets of faces, 30 of them numbered by Gmsh."""
    scene = ct.Scene.load(ct.example("cam"))
    data = scene.data
    data["obstacle"][0]["surface"] = "cam.outer_cam"
    with pytest.raises(ct.SceneError) as error:
        ct.Scene(data, file=scene.file).explain()
    assert {"cam_outer", "cam_hole"} <= set(re.findall(r'"(\w+)"', error.value.reason))
    assert "and 14 more" in error.value.reason


def test_a_file_of_several_bodies_is_read_once(folder, monkeypatch):
    from libcontact import meshes

    count = []
    read = meshes.FORMATS[".msh"]
    monkeypatch.setitem(meshes.FORMATS, ".msh", lambda reading: count.append(1) or read(reading))
    ct.Scene.load(folder / "gears.toml").explain()
    assert len(count) == 1
