"""What the module of the pages has to compute, from the library of this machine."""

import functools
import tempfile
import tomllib
from pathlib import Path

import numpy as np

import libcontact as ct

UNITS = 'units = { length = "mm", mass = "t", time = "s" }\n'
STEEL = 'material = [{ name = "steel", young = 2.1e5, poisson = 0.3, density = 7.8e-9 }]\n'
RING = (
    UNITS
    + STEEL
    + """
[[body]]
name = "ring"
ring = { centre = [-1.002, 0, 0], radius = [0.8, 1.0], width = 0.5, cells = [2, 24, 2] }
material = "steel"
velocity = [2e5, 1e5, 0]
[[body]]
name = "block"
box = { origin = [0, -1.5, -0.75], size = [1, 3, 1.5], cells = [4, 12, 6] }
material = "steel"
[[contact]]
surfaces = ["ring.outer", "block.x_min"]
friction = 0.3
[time]
end = 1.5e-6
"""
)
# A turning ring on a graded block with a stress of its own, in a field of gravity, both damped.
TURNING = (
    UNITS
    + STEEL.replace(
        " }]",
        """ },
  { name = "rubber", young = 2e3, poisson = 0.3, density = 1e-9, law = "neo_hookean" }]""",
    )
    + """
[[body]]
name = "ring"
ring = { centre = [-1.002, 0, 0], radius = [0.8, 1.0], width = 0.5, cells = [2, 24, 2] }
material = "rubber"
velocity = [2e5, 0, 0]
spin = { rate = 3e5 }
initial = { displacement = [1e-4, 0, 0] }
[[body]]
name = "block"
material = "steel"
initial = { stress = [10, 0, 0, 2, 0, 0] }
[body.box]
origin = [0, -1.5, -0.75]
size = [1, 3, 1.5]
cells = [4, 12, 6]
grading = [3, 2, 1]
symmetric = ["y"]
[[contact]]
surfaces = ["ring.outer", "block.x_min"]
friction = 0.3
[gravity]
acceleration = [0, -1e9, 0]
[damping]
rate = 1e5
bodies = ["ring"]
[time]
end = 1.5e-6
"""
)
# A block that is stretched, turned and moved at the start.
STRETCHED = (
    UNITS
    + STEEL.replace(" }]", ', law = "neo_hookean" }]')
    + """
[[body]]
name = "block"
box = { size = [1, 2, 3], cells = [2, 3, 4] }
material = "steel"
velocity = [0, 1e3, 0]
spin = { axis = [1, 2, 2], rate = 1e5, centre = [0, 0, 1] }
[body.initial]
displacement = [0.1, 0, 0]
gradient = [[0.01, 0.002, 0], [0, -0.01, 0.003], [0, 0, 0.004]]
angle = 0.7
axis = [1, -1, 0.5]
[time]
end = 1e-7
"""
)
FACE = [
    [-1, -1, 0],
    [1, -1, 0],
    [1, 1, 0],
    [-1, 1, 0.5],
    [0, -1, 0.25],
    [1, 0, 0.125],
    [0, 1, 0.5],
    [-1, 0, 0],
]


def hash_of(array):
    """FNV-1a of its bytes."""
    value = 14695981039346656037
    for byte in np.ascontiguousarray(array, np.float64).tobytes():
        value = (value ^ byte) * 1099511628211 & (2**64 - 1)
    return f"{value:016x}"


def scenes():
    """Texts of scenes: plates with both laws, the second of hex20 on hex8 with another integrator, a bar, a block on an
    incline, a ring with friction, a turning ring on a block, with damping by mass and by stiffness."""
    plates = ct.example("plates").read_text(encoding="utf-8").replace("100, 1, 100", "20, 1, 20")
    default = plates.replace('enforcement = "penalty"', 'enforcement = "energy_controlled"')
    other = default.replace('"central_difference"', '"tchamwa_wielgosz"')
    wall, incline = (
        ct.example(name).read_text(encoding="utf-8")
        for name in ("bar_on_a_wall", "block_on_an_incline")
    )
    stiff = TURNING.replace("rate = 1e5\nbodies", "stiffness = 1e-9\nbodies").replace(
        '["ring"]', '["block"]'
    )
    return [plates, default, other.replace("hex8", "hex20", 1), wall, incline, RING, TURNING, stiff]


def displacement(text):
    """Displacements of all nodes at the end of a scene (n, 3)."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.toml"
        path.write_text(text, encoding="utf-8")
        state = ct.Scene.load(path).run(progress=False, output=False).state
    return np.concatenate(
        [state[body["name"]].displacement for body in tomllib.loads(text)["body"]]
    )


@functools.cache
def hashes():
    """Tasks of the module and the hash of each answer: the scenes, and 10⁴ points projected to a face."""
    tasks = [{"task": "run", "scene": tomllib.loads(text)} for text in scenes()]
    found = [hash_of(displacement(text)) for text in scenes()]
    points = np.random.default_rng(1).uniform(-1.5, 1.5, (10_000, 3))
    closest = ct.project("Q8", np.array(FACE), points)
    tasks.append({"task": "project", "nodes": FACE, "points": points.tolist()})
    found.append(hash_of(np.column_stack([closest.xi, closest.distance])))
    assert len(set(found)) == len(found)
    return tasks, found


def closed_form():
    """A task of the module, and the exact stresses and velocities of the plates at its 500 points (5, 500)."""
    random = np.random.default_rng(2)
    x, z, t = random.uniform([0.0, -1.0, 0.0], [0.8, 1.0, 1.1], (500, 3)).T
    stress, speed = ct.exact.plates(x, z, t)
    rows = np.column_stack([x, z, t, 0 * x, 0 * x])
    return {"task": "exact", "rows": rows.tolist(), "poisson": 0.3}, np.array([*stress, *speed])
