"""Parts of a scene that contradict each other are refused with file, key and reason; ``explain`` lists the assumptions of the scene."""

import tomllib

import pytest

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
            "a list of 2; it must be a text",
        ),
    ],
)
def test_a_conflict_is_refused_with_file_key_and_reason(more, key, reason, tmp_path):
    path = tmp_path / "conflict.toml"
    path.write_text(SCENE + more)
    with pytest.raises(ct.SceneError) as refused:
        ct.Scene.load(path)
    assert refused.value.key.startswith(key) and reason in refused.value.reason
    assert str(refused.value).startswith(f"{path}: {refused.value.key}: ")


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
    assert "oscillations" in assumed("") and "oscillations" not in assumed("[damping]\nrate = 1\n")
