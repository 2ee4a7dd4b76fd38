"""Parts of a scene that contradict each other are refused with file, key and reason; ``explain`` lists the assumptions
of the scene."""

import re
import tomllib

import numpy as np
import pytest
from scenes import box_of, scene_with

import libcontact as ct

SCENE = """
units = { length = "m", mass = "kg", time = "s" }
material = [{ name = "soft", young = 900, poisson = 0.3, density = 1 }]
time = { end = 0.01, fraction = 0.5 }
[[body]]
name = "a"
material = "soft"
box = { origin = [0, 0, 0], size = [1, 1, 1], cells = [2, 2, 2] }
[[body]]
name = "b"
material = "soft"
box = { origin = [1, 0, 0], size = [1, 1, 1], cells = [2, 2, 2] }
"""
PAIR = '[[contact]]\nsurfaces = ["a.x_max", "b.x_min"]\n'
PRIAP = '[[contact]]\nsurfaces = ["b.x_min", "a.x_max"]\n'
ABSORB = '[[absorb]]\nsurface = "a.x_min"\n'
HELD = '[[support]]\nset = "a.x_min"\nfix = {}\n'


@pytest.mark.parametrize(
    "more, key, reason",
    [
        (PAIR + PAIR, "contact[1].surfaces", "the pair of contact[0]"),
        (PAIR + PRIAP, "contact[1].surfaces", "the pair of contact[0]"),
        (ABSORB + ABSORB, "absorb[1].surface", "absorbs already (absorb[0])"),
        (
            ABSORB + HELD.format('["x", "y", "z"]'),
            "absorb[0].surface",
            "what does not move absorbs nothing",
        ),
        (
            ABSORB + HELD.format('["x"]') + HELD.format('["y", "z"]'),
            "absorb[0].surface",
            "held along x, y and z",
        ),
        ("[damping]\nrate = 1\nrelaxation = true\n", "damping", "cannot stand beside"),
        (
            '[[load]]\nsurface = "a.x_min"\npressure = 1\nhistory = { time = [0, 2, 1], value = [0, 1, 2] }\n',
            "load[0].history.time[2]",
            "is 1, before 2",
        ),
        ("[[friction]]\ncoefficient = 0.3\n", "friction", "no friction without a pressure"),
        (
            '[[body]]\nname = "a"\nmaterial = "soft"\nbox = { size = [1, 1, 1], cells = [1, 1, 1] }\n',
            "body[2].name",
            '"a" is used twice',
        ),
        (
            '[[body]]\nname = "c"\nelement = "hex20"\nintegration = "reduced"\nmaterial = "soft"\nbox = { size = [1, 1, 1], cells = [1, 1, 1] }\n',
            "body[2].integration",
            "hex20 is integrated in full",
        ),
        (
            '[[body]]\nname = "c"\nkernel = "plane"\nmaterial = "soft"\nbox = { origin = [5, 0, 0], size = [1, 1, 1], cells = [2, 1, 2] }\n'
            '[[support]]\nset = "c.y_min"\nfix = ["y"]\n[[load]]\nsurface = "c.x_max"\ntraction = [0, 1, 0]\n',
            "load[0]",
            "the thickness of its plane strain",
        ),
        (
            '[[body]]\nname = "c"\nmaterial = ["soft", "soft"]\nbox = { size = [1, 1, 1], cells = [1, 1, 1] }\n',
            "body[2].material",
            "a list of 2; it must be the name of a [[material]]",
        ),
    ],
)
def test_a_conflict_is_refused_with_file_key_and_reason(more, key, reason, tmp_path):
    path = tmp_path / "conflict.toml"
    path.write_text(SCENE + more)
    with pytest.raises(ct.SceneError) as refused:
        ct.Scene.load(path)
    assert refused.value.key.startswith(key) and reason in refused.value.reason
    assert str(refused.value).startswith(f"{path}:{refused.value.line}: {refused.value.key}: ")
    assert refused.value.line > 0


@pytest.mark.parametrize(
    "more",
    [
        PAIR,
        ABSORB,
        ABSORB + HELD.format('["x"]'),
        PAIR + '[[contact]]\nsurfaces = ["a.y_max", "b.y_max"]\n',
    ],
)
def test_what_only_looks_like_a_conflict_is_taken(more, tmp_path):
    ct.Scene(tomllib.loads(SCENE + more)).explain()


STILL = '[[support]]\nset = "a.z_min"\nfix = ["z"]\n'
PATH = "history = {{ time = [0, 0.01], value = [0, {}] }}\n"
PULL = '[[support]]\nset = "a.x_max"\nfix = ["x", "z"]\ntravel = [0.01, 0, {}]\n' + PATH.replace(
    "{}", "1"
)


@pytest.mark.parametrize("turned", [False, True])
def test_a_face_that_travels_beside_one_that_is_held_still(turned):
    """Both prescribe 0 along z at their edge. The edge follows the path, and the motion is that of a path of 0 for
    both."""
    parts = [STILL, PULL.format(0)]
    path = STILL + "travel = [0, 0, 0]\n" + PATH.format("3")
    runs = []
    for each in (parts[::-1] if turned else parts, [path, PULL.format(0)]):
        scene = ct.Scene(tomllib.loads(SCENE + "".join(each)))
        run = scene.run(output=False)
        assert abs(np.ptp(run.energy["total"])) <= 1e-2 * run.energy["external"][-1]
        runs.append(run.state["a"].displacement)
    edge = [n for n, x in enumerate(run.state["a"].mesh.nodes) if x[0] == 1.0 and x[2] == 0.0]
    assert runs[0][edge, 0] == pytest.approx(0.01, rel=1e-9) and not runs[0][edge, 2].any()
    assert np.abs(runs[0] - runs[1]).max() < 1e-12


@pytest.mark.parametrize(
    "more, key",
    [
        (STILL + PULL.format(0.01), "support[1].fix"),
        (PULL.format(0.01) + STILL, "support[0].fix"),
        (STILL + "velocity = [0, 0, 1]\n" + PULL.format(0), "support[1].fix"),
        (
            STILL + "travel = [0, 0, 0.01]\n" + PATH.format("2") + PULL.format(0.01),
            "support[1].fix",
        ),
    ],
)
def test_faces_that_move_their_edge_differently(more, key):
    with pytest.raises(ct.SceneError) as refused:
        ct.Scene(tomllib.loads(SCENE + more)).explain()
    assert refused.value.key == key
    assert re.search(
        r'moves them differently: node \d+ of body "a" at \(1, 0, 0\)', str(refused.value)
    )


def assumed(more):
    return " / ".join(ct.Scene(tomllib.loads(SCENE + more)).explain().data["assumptions"])


def test_the_assumptions_are_those_of_the_scene():
    load = '[[load]]\nsurface = "a.x_min"\npressure = 1\n'
    for more, words in (
        (PAIR, "by a penalty"),
        (load, "undeformed surface"),
        ("[damping]\nrelaxation = true\n", "only the state of rest has a meaning"),
    ):
        assert words in assumed(more) and words not in assumed("")
    assert "undeformed surface" not in assumed(load + "following = true\n")
    bounces, damped = "does not come to rest", "[damping]\nrate = 1\n"
    assert bounces in assumed(PAIR) and bounces not in assumed(PAIR + damped) + assumed("")
    part = assumed(PAIR + "restitution = 0.5\n")
    assert bounces not in part and "restitution below 1: an impact loses" in part
    assert "loses" not in assumed(PAIR) + assumed(PAIR + 'enforcement = "penalty"\n')
    assert "oscillations" in assumed("") and "oscillations" not in assumed("[damping]\nrate = 1\n")


def test_a_plate_of_hex8_is_as_stiff_in_bending_as_it_is_told():
    """A cantilever with a force F at its end bends by F L³ / 3 E I, of hex8 by less: as explain tells, with one layer
    across and with four (ν = 0). Hex20, short elements, and a plate that is held across are not told of."""

    def plate(cells, held="x_min", fix="xyz", **more):
        scene = scene_with("soft", young=1e4, poisson=0.0, density=1.0)
        box = box_of([0, 0, 0], [20, 2, 1], cells)
        scene.add_body("plate", material="soft", box=box, **more)
        scene.add_support(f"plate.{held}", fix=fix).set_time(end=100.0)
        scene.add("load", surface="plate.x_max", traction=[0, 0, -1e-3])
        return scene.add("damping", rate=0.7)

    def told(scene):
        lines = [line for line in scene.explain().data["assumptions"] if "does not bend" in line]
        return [float(re.search(r"are (\S+) times", line)[1]) for line in lines]

    for layers in (1, 4):
        scene = plate([10, 1, layers])
        run = scene.run(output=False)
        sags = -run.state["plate"].displacement[:, 2].min() / (2e-3 * 20**3 / 3 / (1e4 * 2 / 12))
        assert told(scene) == [pytest.approx(1 / sags, rel=0.01)]
    assert told(plate([10, 1, 4], element="hex20")) == told(plate([60, 6, 4])) == []
    assert told(plate([10, 1, 1], held="z_min", fix="z")) == []


@pytest.mark.parametrize(
    "surfaces, refused",
    [
        ('"a.outer", "b.outer"', True),
        ('"b.outer", "a.x_max"', True),
        ('"a.x_max", "b.y_min"', False),
        ('"a.y_max", "b.x_min"', False),
        ('"a.outer", "a.outer"', False),
    ],
)
def test_two_contacts_that_have_faces_of_both_surfaces(surfaces, refused, tmp_path):
    """The faces at x = 1 are those of the elements 1, 3, 5, 7 of "a" and 0, 2, 4, 6 of "b"."""
    path = tmp_path / "scene.toml"
    path.write_text(f"{SCENE}{PAIR}[[contact]]\nsurfaces = [{surfaces}]\n")
    scene = ct.Scene.load(path)
    if not refused:
        scene.explain()
        return
    with pytest.raises(ct.SceneError, match=r"contact\[0\] has faces of both") as found:
        scene.explain()
    assert found.value.key == "contact[1]" and str(found.value).startswith(f"{path}:")
    for body, elements in {"a": "1357", "b": "0246"}.items():
        place = re.search(
            rf'element (\d) of "{body}" \(face at 1, 0\.[27]5, 0\.[27]5\)', str(found.value)
        )
        assert place and place[1] in elements
