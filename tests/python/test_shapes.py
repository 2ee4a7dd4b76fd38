"""Balls, shells and cylinders in a scene; their meshes are tested in tests/c/test_shapes.c."""

import math

import numpy as np
import pytest
from libcontact.model import SHAPES

import libcontact as ct

METRES = {"length": "m", "mass": "kg", "time": "s"}
TABLES = {
    "box": {"size": [2, 1, 1], "cells": [4, 2, 3]},
    "ring": {"radius": [0.5, 1.0], "width": 0.4, "cells": [2, 12, 3]},
    "cylinder": {"radius": 1.0, "width": 0.4, "cells": [3, 16, 2]},
    "ball": {"radius": 1.0, "cells": [3, 16]},
    "shell": {"radius": [0.5, 1.0], "cells": [2, 16]},
}


def of(shape, element="hex8", **changes):
    scene = ct.Scene(units=METRES)
    scene.add_material("soft", young=1e6, poisson=0.3, density=1000.0)
    scene.add_body("b", material="soft", element=element, **{shape: TABLES[shape] | changes})
    return scene.set_time(end=1e-3, fraction=0.5)


@pytest.mark.parametrize("element", ["hex8", "hex20"])
@pytest.mark.parametrize("shape", SHAPES)
def test_sizes_are_known_before_the_mesh_is_made(shape, element):
    """Elements, and corners by the faces that they share: the count that the check of the memory uses."""
    problem = of(shape, element)._built(None)
    mesh = problem.bodies["b"].mesh
    corners = np.unique(mesh.elements[:, :8])
    assert problem.parts.bodies["b"].lattice.counts() == (len(mesh.elements), len(corners))
    assert mesh.element == element


@pytest.mark.parametrize(
    "shape, volume",
    [
        ("cylinder", math.pi * 0.4),
        ("ball", 4 / 3 * math.pi),
        ("shell", 4 / 3 * math.pi * (1 - 0.5**3)),
    ],
)
def test_a_body_has_the_mass_of_its_shape(shape, volume):
    scene = of(shape, "hex20", centre=[1, 2, 3])
    assert scene._built(None).bodies["b"].mesh.nodes.mean(axis=0) == pytest.approx([1, 2, 3])
    data = scene.data
    data["body"][0]["velocity"] = [2.0, 0.0, 0.0]
    kinetic = ct.Scene(data).run().energy["kinetic"][0]
    assert kinetic == pytest.approx(0.5 * 1000.0 * volume * 2.0**2, rel=2e-3)


def test_a_ball_and_a_shell_collide_along_a_line():
    """Both are symmetric about the x axis, so the ball's momentum stays on it, to round-off; and that of both
    together is kept."""
    scene = of("ball", cells=[1, 8])
    shell = {"centre": [2.001, 0, 0], "radius": [0.5, 1.0], "cells": [1, 8]}
    scene.add_body("s", material="soft", shell=shell, velocity=[-1, 0, 0])
    scene.add_contact("b.outer", "s.outer")
    scene.set_time(end=0.5, fraction=0.4)
    run = scene.run()
    ball, shell = (run.momentum["p"][run.momentum["body"] == body] for body in (0, 1))
    assert ball[-1, 0] < -0.5 * abs(shell[0, 0])
    assert np.abs(ball[:, 1:]).max() < 1e-12 * abs(shell[0, 0])
    assert np.abs(ball + shell - shell[0]).max() < 1e-12 * abs(shell[0, 0])


@pytest.mark.parametrize(
    "shape, change, key, reason",
    [
        ("ball", {"radius": 0}, "radius", "above 0"),
        ("ball", {"cells": [0, 8]}, "cells[0]", "at least 1"),
        ("ball", {"cells": [1, 10]}, "cells[1]", "multiple of 4"),
        ("shell", {"radius": [1.0, 0.5]}, "radius[1]", "above the inner"),
        ("shell", {"cells": [1, 8, 1]}, "cells", "2"),
        ("shell", {"cells": [10000, 100000]}, "cells", "GB"),
        ("cylinder", {"cells": [1, 6, 1]}, "cells[1]", "multiple of 4"),
        ("cylinder", {"width": 0}, "width", "above 0"),
        ("cylinder", {"height": 1}, "height", "unknown"),
    ],
)
def test_what_is_no_shape_is_refused(shape, change, key, reason):
    with pytest.raises(ct.SceneError, match=reason) as error:
        of(shape, **change).run()
    assert error.value.key == f"body[0].{shape}.{key}"


@pytest.mark.parametrize("element", ["hex8", "hex20"])
@pytest.mark.parametrize(
    "cells, grading, symmetric, x",
    [
        (3, 4.0, [], [0, 2 / 7, 6 / 7, 2]),
        (3, 0.25, [], [0, 8 / 7, 12 / 7, 2]),
        (4, 2.0, ["x"], [0, 2 / 3, 1, 4 / 3, 2]),
        (5, 4.0, ["x"], [0, 8 / 13, 12 / 13, 14 / 13, 18 / 13, 2]),
        (3, 0.5, ["x"], [0, 0.5, 1.5, 2]),
    ],
)
def test_a_graded_box(element, cells, grading, symmetric, x, tmp_path):
    """Sizes 1, 2, 4; 4, 2, 1; 2, 1, 1, 2; 4, 2, 1, 2, 4; 1, 2, 1. The shortest edge decides about the step, and mass
    does not depend on the grading."""
    box = {"cells": [cells, 1, 1], "grading": [grading, 1, 1]}
    if symmetric:
        box["symmetric"] = symmetric
    scene = of("box", element, **box)
    scene.save(tmp_path / "graded.toml")
    scene = ct.Scene.load(tmp_path / "graded.toml")
    mesh = scene._built(None).bodies["b"].mesh
    found = np.unique(mesh.nodes[np.unique(mesh.elements[:, :8]), 0])
    assert found == pytest.approx(x, abs=1e-15)
    assert mesh.shortest_edge == pytest.approx(np.diff(x).min(), rel=1e-14)
    data = scene.data
    data["body"][0]["velocity"] = [2.0, 0.0, 0.0]
    run = ct.Scene(data).run()
    assert run.energy["kinetic"] == pytest.approx(0.5 * 1000.0 * 2.0 * 2.0**2, rel=1e-12)


@pytest.mark.parametrize(
    "keys, key", [({"grading": [0, 1, 1]}, "grading[0]"), ({"symmetric": []}, "symmetric")]
)
def test_a_wrong_grading_is_refused_with_its_key(keys, key):
    with pytest.raises(ct.SceneError) as found:
        of("box", **keys)
    assert found.value.key == f"body[0].box.{key}"


def test_a_finer_box_keeps_its_grading():
    lattice = of("box", cells=[4, 2, 3], grading=[3, 1, 1])._built(None).parts.bodies["b"].lattice
    assert lattice.scaled(2.0).cells == (8, 4, 6) and lattice.scaled(2.0).grading == (3.0, 1.0, 1.0)
