"""The scenes of the zoo: what users build first, each as a function of the options of its run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
import shapes
from stage import Part, Stage, Stuff, Touch, Wall, outer, turned

from libcontact import model

SOFT = Stuff(law="neo_hookean")
STEEL = Stuff(2.1e11, 0.3, 7850.0)
INITIAL = ("keep", "force", "refuse", "remove")
INTEGRATORS = tuple(model.INTEGRATORS)[1:]


@dataclass(frozen=True)
class Options:
    """How a scene of the zoo is run. The defaults are those of the library."""

    element: str = "hex8"  # also "hex20" and "reduced"
    enforcement: str | None = None  # or "penalty"
    beta: float | None = None
    points: str | None = None
    friction: float = 0.0
    dissipation: float | None = None
    initial_penetration: str | None = None
    integrator: str | None = None
    fraction: float | None = None
    law: str | None = None
    ratio: int = 1  # elements of the second body along an edge, for one of the first
    way: int = 0  # a random orientation; 0: as it is built
    size: float = 1.0  # speed, overlap or radius of the scene, over its usual one
    skin: bool = False  # whole skins in place of faces

    def __str__(self) -> str:
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        usual = {f.name: f.default for f in fields(self)}
        told = [f"{name}={value}" for name, value in own.items() if value != usual[name]]
        return ", ".join(told) or "defaults"


# Each option away from its default alone; scenes leave out those that say nothing in them.
ONE_AT_A_TIME = (
    Options(),
    *(Options(element=element) for element in ("hex20", "reduced")),
    Options(enforcement="penalty"),
    *(Options(beta=beta) for beta in (1.0, 100.0, 3e3, 1e6)),
    Options(points="lobatto"),
    *(Options(friction=mu) for mu in (0.1, 0.5)),
    Options(dissipation=0.0),
    *(Options(initial_penetration=word) for word in INITIAL[1:]),
    *(Options(integrator=name) for name in INTEGRATORS),
    *(Options(fraction=fraction) for fraction in (0.3, 0.99)),
    Options(law="neo_hookean"),
    *(Options(ratio=ratio) for ratio in (2, 3)),
    *(Options(way=way) for way in (1, 2)),
    *(Options(size=size) for size in (0.3, 3.0)),
    Options(skin=True),
)


def drawn(seed: int) -> Options:
    """Options at random."""
    random = np.random.default_rng([41, seed])
    return Options(
        element=str(random.choice(["hex8", "hex8", "hex20", "reduced"])),
        beta=[None, None, 1.0, 30.0, 1e3][random.integers(5)],
        points=[None, "lobatto"][random.integers(2)],
        friction=float(random.choice([0.0, 0.0, 0.2, 0.6])),
        dissipation=[None, 0.0, 1.0][random.integers(3)],
        integrator=[None, None, None, *INTEGRATORS, None][random.integers(4 + len(INTEGRATORS))],
        fraction=float(random.choice([0.5, 0.9])),
        law=[None, "neo_hookean"][random.integers(2)],
        ratio=int(random.integers(1, 4)),
        way=int(random.integers(0, 50)),
        size=float(10 ** random.uniform(-1, 0.5)),
        skin=bool(random.integers(2)),
    )


@dataclass(frozen=True)
class Animal:
    """A scene. ``speed``, ``length`` and ``scale`` are its velocity, way and energy by which results are
    compared; ``apart`` lists bodies or obstacles that must stay on their sides: pairs of names with the
    direction from the first one to the second one."""

    stage: Stage
    speed: float
    length: float
    scale: float
    apart: tuple[tuple[str, str, tuple[float, ...]], ...] = ()
    twins: tuple[str, ...] = ("held", "outer", "tiny")
    limit: str = ""  # the limit that the scene exceeds, so that it may be refused
    deep: float = 0.5  # depth that counts as passing, in h; the overlap at the start comes on top
    overlap: float = 0.0
    layers: int = 2  # of elements behind the surface that is hit


def mesh(o: Options, size: Any, cells: Any, at: Any = (0, 0, 0)) -> shapes.Bricks:
    """A box with its centre at a place; hex20 has half the elements along each edge."""
    if o.element == "hex20":
        cells = [max(1, math.ceil(n / 2)) for n in cells]
    bricks = shapes.box(size, cells)
    bricks = bricks[0] + np.array(at), bricks[1]
    return shapes.with_edges(bricks) if o.element == "hex20" else bricks


def part(o: Options, bricks: shapes.Bricks, stuff: Stuff = Stuff(), **more: Any) -> Part:
    """A body with the options' elements and law."""
    if bricks[1].shape[1] == 8 and o.element == "hex20":
        bricks = shapes.with_edges(bricks)
    if o.law is not None and o.element != "reduced":
        stuff = replace(stuff, law=o.law)
    if o.element == "reduced":
        stuff = replace(stuff, law="linear")
    return Part(
        bricks, stuff=stuff, integration="reduced" if o.element == "reduced" else "full", **more
    )


def finished(o: Options, animal: Animal, end: float) -> Animal:
    """The animal with the law, the time and the orientation of the options."""
    given = {
        name: getattr(o, name)
        for name in ("enforcement", "beta", "dissipation")
        if getattr(o, name) is not None
    }
    if o.friction:
        given["friction"] = o.friction
    only = {"points": o.points} if o.points is not None else {}
    if o.initial_penetration is not None:
        given["initial_penetration"] = o.initial_penetration
    if o.initial_penetration == "remove":
        given["removal_time"] = 0.3 * end
    time = {"end": end}
    if o.integrator is not None:
        time["integrator"] = o.integrator
    if o.fraction is not None:
        time["fraction"] = o.fraction
    stage = replace(animal.stage, law=given, only=only, time=time)
    if o.skin or o.way:
        stage = outer(stage)
    if o.way:
        R = shapes.random_rotation(np.random.default_rng([3, o.way]))
        if any(face != "outer" for p in stage.parts.values() for face, _ in p.held):
            # Faces with names, and components of supports, need axes that map to axes.
            R = [np.eye(3)[[1, 2, 0]], np.eye(3)[[2, 0, 1]]][o.way % 2]
        stage = turned(stage, R)
        animal = replace(
            animal, apart=tuple((a, b, tuple(R @ np.array(way))) for a, b, way in animal.apart)
        )
    return replace(animal, stage=stage)


# The scenes.


def part_on_a_floor(o: Options) -> Animal:
    """A steel cube of 1 m at rest, 1 % of an element inside a floor, then under its weight."""
    overlap = 2.5e-3 * o.size
    cube = part(o, mesh(o, (1, 1, 1), (4, 4, 4), (0, 0, 0.5 - overlap)), STEEL)
    g = 10.0
    floor = Wall("cube", "z_min", "plane", (0.0, 0.0, 0.0))
    # Without push the cube only settles; its scale is the energy of a drop by the overlap.
    animal = Animal(
        Stage({"cube": cube}, (floor,), gravity=(0.0, 0.0, -g)),
        speed=math.sqrt(2 * g * overlap),
        length=overlap,
        scale=7850.0 * g * overlap,
        overlap=overlap,
        twins=("held", "outer"),
    )
    return finished(o, animal, 8 / STEEL.speed)


def part_on_a_slab(o: Options) -> Animal:
    """The same cube on a held slab."""
    base = part_on_a_floor(replace(o, way=0, skin=False))
    cube = base.stage.parts["cube"]
    n = 3 * o.ratio
    slab = part(o, mesh(o, (2, 2, 0.5), (n, n, 1), (0, 0, -0.25)), STEEL, held=(("outer", "xyz"),))
    touch = Touch(("cube", "z_min"), ("slab", "z_max"))
    stage = replace(base.stage, parts={"cube": cube, "slab": slab}, walls=(), touches=(touch,))
    return finished(o, replace(base, stage=stage), 8 / STEEL.speed)


def small_body(o: Options) -> Animal:
    """A small fast cube against the middle of large elements of a held plate."""
    speed = 0.1 * SOFT.speed
    side = 0.2 * o.size
    plate = part(o, mesh(o, (3, 3, 1), (3, 3, 1)), held=(("x_min", "xyz"), ("x_max", "xyz")))
    cube = part(
        o,
        mesh(o, (side,) * 3, (2, 2, 2), (0.1, 0.07, 0.55 + side / 2)),
        velocity=(0.0, 0.0, -speed),
    )
    animal = Animal(
        Stage(
            {"plate": plate, "cube": cube}, touches=(Touch(("plate", "outer"), ("cube", "outer")),)
        ),
        speed=speed,
        length=side,
        scale=0.5 * side**3 * speed**2,
        apart=(("plate", "cube", (0, 0, 1)),),
    )
    return finished(o, animal, (0.1 + 2 * side) / speed + 4 * side / SOFT.speed)


def small_sphere(o: Options) -> Animal:
    """A rigid sphere much smaller than the elements moves into the middle of a held plate, where a face has
    no contact point, and against its corner."""
    radius = 0.2 * o.size
    speed = 0.008 * SOFT.speed
    n = 2 * o.ratio
    plate = part(
        o, mesh(o, (2, 2, 0.5), (n, n, 1), (0, 0, -0.25)), held=(("x_min", "xyz"), ("x_max", "xyz"))
    )
    ball = Wall(
        "plate",
        "outer",
        "sphere",
        (0.03, 0.02, radius + 0.01),
        radius=radius,
        velocity=(0, 0, -speed),
    )
    animal = Animal(
        Stage({"plate": plate}, (ball,)),
        speed=speed,
        length=0.1,
        scale=0.5 * 0.1 * speed**2,
        twins=("tiny",),
        limit="a sphere between the contact points" if radius < 0.2 / o.ratio else "",
        deep=0.15,
    )
    return finished(o, animal, 0.2 / speed)


def pushed_ball(o: Options) -> Animal:
    """A large rigid sphere is pressed into a block."""
    speed = 0.02 * SOFT.speed
    n = 4 * o.ratio
    block = part(
        o, mesh(o, (2, 2, 1), (n, n, max(2, n // 2)), (0, 0, -0.5)), held=(("z_min", "xyz"),)
    )
    ball = Wall("block", "z_max", "sphere", (0, 0, 2.01), radius=2.0, velocity=(0, 0, -speed))
    animal = Animal(
        Stage({"block": block}, (ball,)),
        speed=speed,
        length=0.1,
        scale=0.5 * 4 * speed**2,
        twins=("held", "outer", "tiny"),
    )
    return finished(o, animal, 0.1 * min(o.size, 1.5) / speed)


def stack(o: Options) -> Animal:
    """Three blocks fall 0.002 on each other and on a floor. If they touched at the start, rounding would decide which
    points are closed, and with it what they hold: turned scenes would agree to 1e-8 only."""
    g = 1.0
    names = ("low", "mid", "top")
    bodies = {}
    for k, name in enumerate(names):
        n = 2 * (o.ratio if k == 1 else 1)
        at = (0.02 * k, 0, 0.25 + 0.5 * k + 2e-3 * (k + 1))
        bodies[name] = part(o, mesh(o, (1 - 0.1 * k, 1 - 0.1 * k, 0.5), (n, n, 1), at))
    touches = tuple(Touch((a, "z_max"), (b, "z_min")) for a, b in zip(names, names[1:]))
    animal = Animal(
        Stage(bodies, (Wall("low", "z_min", "plane", (0, 0, 0)),), touches, (0, 0, -g * o.size)),
        speed=g * o.size * 3 / SOFT.speed,
        length=0.01,
        scale=1.5 * (g * o.size) ** 2 * 1.5 / 1e4,
        apart=tuple((a, b, (0, 0, 1)) for a, b in zip(names, names[1:])),
        twins=("held", "outer"),
    )
    return finished(o, animal, 20 / SOFT.speed)


def pile(o: Options) -> Animal:
    """Four bricks in any orientation fall on each other and on a floor."""
    random = np.random.default_rng(17)
    bodies, speed, top = {}, 0.05 * SOFT.speed * o.size, 0.0
    for k in range(4):
        R = shapes.random_rotation(random)
        x, y = random.uniform(-0.3, 0.3, 2)
        nodes, elements = mesh(o, (1, 0.7, 0.5), (2, 2, 1))
        nodes = nodes @ R.T
        nodes = nodes + [x, y, top + 0.02 - nodes[:, 2].min()]
        top = nodes[:, 2].max()
        bodies[f"b{k}"] = part(o, (nodes, elements), SOFT, velocity=(0, 0, -speed * (k + 1) / 4))
    names = list(bodies)
    touches = tuple(
        Touch((a, "outer"), (b, "outer")) for i, a in enumerate(names) for b in names[i + 1 : i + 3]
    )
    walls = tuple(Wall(name, "outer", "plane", (0, 0, 0)) for name in names)
    animal = Animal(
        Stage(bodies, walls, touches),
        speed=speed,
        length=0.3,
        scale=0.5 * 0.35 * speed**2,
        twins=("held", "tiny"),
    )
    return finished(o, animal, 0.6 / speed)


def ball_in_a_cup(o: Options) -> Animal:
    """A ball falls into a cup: a box without its middle."""
    speed = 0.05 * SOFT.speed * o.size
    cells = [
        (i, j, k)
        for i in range(5)
        for j in range(5)
        for k in range(3)
        if k == 0 or i in (0, 4) or j in (0, 4)
    ]
    cup = shapes.cubes(cells)
    cup = 0.5 * (cup[0] - [2.5, 2.5, 0]), cup[1]
    ball = mesh(o, (1, 1, 1), (3 * o.ratio,) * 3)
    ball = 1.3 * shapes.rounded(ball[0]) + [0.1, 0.05, 1.2 + 0.02], ball[1]
    bodies = {
        "cup": part(o, cup, SOFT, held=(("z_min", "xyz"),)),
        "ball": part(o, ball, SOFT, velocity=(0.2 * speed, 0.1 * speed, -speed)),
    }
    animal = Animal(
        Stage(bodies, touches=(Touch(("cup", "outer"), ("ball", "outer")),)),
        speed=speed,
        length=0.5,
        scale=0.5 * 1.0 * speed**2,
        apart=(("cup", "ball", (0, 0, 1)),),
        twins=("tiny",),
    )
    return finished(o, animal, 1.0 / speed)


def peg_in_a_hole(o: Options) -> Animal:
    """A peg is driven through a hole that is 1 % wider; its edges start 0.2 % inside the rim with
    ``size`` 3."""
    speed = 0.02 * SOFT.speed
    cells = [(i, j, k) for i in range(3) for j in range(3) for k in range(2) if (i, j) != (1, 1)]
    hole = shapes.cubes(cells, 1)
    hole = hole[0] - [1.5, 1.5, 2.0], hole[1]
    clear = 0.01 * (1.0 if o.size <= 1 else -0.2)
    n = 2 * o.ratio
    peg = mesh(o, (1 - clear, 1 - clear, 1), (n, n, n), (0.0, 0.0, 0.52 if o.size <= 1 else 0.2))
    bodies = {
        "hole": part(o, hole, SOFT, held=(("z_min", "xyz"),)),
        "peg": part(
            o, peg, SOFT, velocity=(0, 0, -speed), held=(("z_max", "xyz"),), drive=(0, 0, -speed)
        ),
    }
    animal = Animal(
        Stage(bodies, touches=(Touch(("hole", "outer"), ("peg", "outer")),)),
        speed=speed,
        length=0.4,
        scale=0.5 * speed**2,
        twins=(),
        overlap=max(0.0, -clear),
    )
    return finished(o, animal, 0.4 / speed)


def sheet_between_rollers(o: Options) -> Animal:
    """A thin sheet is pulled between two rigid rollers, which squeeze it more and more."""
    speed = 0.05 * SOFT.speed * min(o.size, 1.0)
    thick = 0.2
    n = 10 * o.ratio
    sheet = part(
        o,
        mesh(o, (2, 0.6, thick), (n, 2, 1)),
        SOFT,
        velocity=(speed, 0, 0),
        held=(("x_max", "xyz"),),
        drive=(speed, 0, 0),
    )
    R, squeeze = 0.5, 0.05 * speed * o.size
    walls = tuple(
        Wall(
            "sheet",
            "outer",
            "cylinder",
            (0.6, 0, s * (R + thick / 2)),
            (0, 1, 0),
            R,
            velocity=(-speed, 0, -s * squeeze),
        )
        for s in (-1, 1)
    )
    animal = Animal(
        Stage({"sheet": sheet}, walls),
        speed=speed,
        length=0.3,
        layers=1,
        scale=0.5 * 0.24 * speed**2,
        twins=("tiny",),
    )
    return finished(o, animal, 0.6 / speed)


def dropped(o: Options, down: np.ndarray) -> Animal:
    """A soft cube falls with this corner, edge or face first."""
    speed = 0.05 * SOFT.speed * o.size
    n = 3 * o.ratio
    nodes, elements = mesh(o, (1, 1, 1), (n, n, n))
    a, b = down / np.linalg.norm(down), np.array([0, 0, -1.0])
    v, c = np.cross(a, b), a @ b
    K = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    R = np.eye(3) + K + K @ K / (1 + c)
    nodes = nodes @ R.T
    nodes = nodes - [0, 0, nodes[:, 2].min() - 0.01]
    cube = part(o, (nodes, elements), SOFT, velocity=(0, 0, -speed))
    face = "z_min" if np.count_nonzero(down) == 1 else "outer"
    animal = Animal(
        Stage({"cube": cube}, (Wall("cube", face, "plane", (0, 0, 0)),)),
        speed=speed,
        length=0.05,
        scale=0.5 * speed**2,
        deep=0.6,
    )
    return finished(o, animal, 0.012 / speed + 5 / SOFT.speed)


def drop_on_a_face(o: Options) -> Animal:
    """A soft cube falls on a floor with a face first."""
    return dropped(o, np.array([0, 0, -1.0]))


def drop_on_an_edge(o: Options) -> Animal:
    """A soft cube falls on a floor with an edge first."""
    return dropped(o, np.array([1.0, 0, -1]))


def drop_on_a_corner(o: Options) -> Animal:
    """A soft cube falls on a floor with a corner first."""
    return dropped(o, np.array([1.0, 1, -1]))


def block_in_a_box(o: Options) -> Animal:
    """A block rattles between six walls."""
    speed = 0.05 * SOFT.speed * o.size
    n = 2 * o.ratio
    block = part(
        o, mesh(o, (1, 0.9, 0.8), (n, n, n)), SOFT, velocity=(speed, 0.7 * speed, 0.4 * speed)
    )
    gap = 0.05
    walls = []
    for axis, half in enumerate((0.5, 0.45, 0.4)):
        for side in (-1.0, 1.0):
            place, normal = [0.0] * 3, [0.0] * 3
            place[axis], normal[axis] = side * (half + gap), -side
            walls.append(Wall("block", "outer", "plane", tuple(place), tuple(normal)))
    animal = Animal(
        Stage({"block": block}, tuple(walls)),
        speed=speed,
        length=0.3,
        scale=0.5 * 0.72 * speed**2,
        twins=("held", "tiny"),
        deep=0.6,
    )
    return finished(o, animal, 0.5 / speed)


def thin_plates(o: Options) -> Animal:
    """Two plates of one element's thickness hit each other, shifted by parts of an element."""
    speed = 0.02 * SOFT.speed * o.size
    bodies = {}
    for k, name in enumerate(("low", "top")):
        n = 6 * (o.ratio if k else 1)
        bodies[name] = part(
            o,
            mesh(o, (1, 1, 0.04), (n, n, 1), (0.03 * k, 0.02 * k, (k - 0.5) * 0.05)),
            velocity=(0, 0, speed * (0.5 - k)),
        )
    animal = Animal(
        Stage(bodies, touches=(Touch(("low", "z_max"), ("top", "z_min")),)),
        speed=speed,
        length=0.04,
        layers=1,
        scale=0.5 * 0.02 * speed**2,
        apart=(("low", "top", (0, 0, 1)),),
        twins=("outer", "tiny"),
    )
    return finished(o, animal, 0.06 / speed)


def open_faces(o: Options) -> Animal:
    """A block falls on a wider one, shifted beyond its border: only the two open faces are declared."""
    speed = 0.05 * SOFT.speed * o.size
    bodies = {}
    for k, name in enumerate(("low", "top")):
        n = 3 * (o.ratio if k else 1)
        bodies[name] = part(
            o,
            mesh(o, (1, 1, 0.5), (n, n, 2), (0.55 * k, 0.25 * k, (k - 0.5) * 0.52)),
            SOFT,
            velocity=(0.3 * speed * k, 0.1 * speed * k, speed * (0.5 - k)),
        )
    animal = Animal(
        Stage(bodies, touches=(Touch(("low", "z_max"), ("top", "z_min")),)),
        speed=speed,
        length=0.1,
        scale=0.5 * 0.5 * speed**2,
        twins=("outer", "tiny"),
        deep=2.0,
    )
    return finished(o, animal, 0.02 / speed + 12 / SOFT.speed)


def closed_impact(o: Options) -> Animal:
    """Two blocks with closed surfaces meet off their centres."""
    speed = 0.1 * SOFT.speed * o.size
    bodies = {}
    for k, name in enumerate(("left", "right")):
        n = 2 * (o.ratio if k else 1)
        bodies[name] = part(
            o,
            mesh(o, (1, 1, 1), (n, n, n), (1.02 * k, 0.3 * k, 0.2 * k)),
            SOFT,
            velocity=(speed * (0.5 - k), 0, 0),
        )
    animal = Animal(
        Stage(bodies, touches=(Touch(("left", "outer"), ("right", "outer")),)),
        speed=speed,
        length=0.2,
        scale=0.5 * speed**2,
        apart=(("left", "right", (1, 0, 0)),),
        twins=("tiny",),
    )
    return finished(o, animal, 0.02 / speed + 8 / SOFT.speed)


def incline(o: Options) -> Animal:
    """A block slides, or stays, on an inclined plane."""
    g = 2.0 * o.size
    angle = math.radians(20)
    n = 2 * o.ratio
    block = part(o, mesh(o, (1, 1, 0.6), (n, n, n), (0, 0, 0.3)))
    animal = Animal(
        Stage(
            {"block": block},
            (Wall("block", "z_min", "plane", (0, 0, 0)),),
            gravity=(g * math.sin(angle), 0, -g * math.cos(angle)),
        ),
        speed=g * 30 / SOFT.speed,
        length=0.5 * g * (30 / SOFT.speed) ** 2,
        scale=0.6 * g * 0.5 * g * (30 / SOFT.speed) ** 2,
        twins=("held", "outer"),
    )
    return finished(o, animal, 30 / SOFT.speed)


def swing(o: Options) -> Animal:
    """A beam that one held edge lets swing hits a wall. Half of the energy goes through the shortest waves, and near
    four or three steps a period the leapfrog itself makes some (eq:step-resonance): 1.3 % at 0.9 of the step."""
    speed = 0.05 * SOFT.speed * o.size
    n = 6 * o.ratio
    beam = part(
        o, mesh(o, (0.3, 0.4, 2), (1, 1, n)), SOFT, velocity=(speed, 0, 0), held=(("z_max", "xyz"),)
    )
    wall = Wall("beam", "x_max", "plane", (0.2, 0, 0), (-1, 0, 0))
    animal = Animal(
        Stage({"beam": beam}, (wall,)),
        speed=speed,
        length=0.1,
        layers=1,
        scale=0.5 * 0.24 * speed**2,
    )
    return finished(o, animal, 0.15 / speed + 8 / SOFT.speed)


def fork(o: Options) -> Animal:
    """The legs of a fork are pressed onto each other: contact of a body with itself."""
    speed = 0.04 * SOFT.speed * o.size
    nodes, elements = shapes.fork(6, 1, 1, 1, 2, 0.25)
    # Sheared: edges of the legs that meet exactly have two nearest faces, of which rounding would choose one.
    bricks = nodes + 0.1 * nodes[:, 2:] * [0, 1, 0], elements
    body = part(o, bricks, SOFT)
    planes = tuple(
        Wall("fork", "outer", "plane", (0, 0, z), (0, 0, s), velocity=(0, 0, s * speed))
        for z, s in ((-0.01, 1.0), (0.76, -1.0))
    )
    animal = Animal(
        Stage({"fork": body}, planes, (Touch(("fork", "outer"), ("fork", "outer")),)),
        speed=speed,
        length=0.1,
        scale=0.5 * speed**2,
        twins=("tiny",),
    )
    return finished(o, animal, 0.12 / speed)


def fast_soft(o: Options) -> Animal:
    """A body hits a hard one at a third of its own wave speed."""
    speed = 0.3 * SOFT.speed * o.size
    # Off the middle, where points would lie on the border of two faces, as near to one as to the other.
    soft = part(o, mesh(o, (1, 1, 1), (3, 3, 3), (0.02, 0.03, 0.51)), velocity=(0, 0, -speed))
    n = 2 * o.ratio
    hard = part(
        o,
        mesh(o, (2, 2, 1), (n, n, 1), (0, 0, -0.5)),
        Stuff(1e6, 0.3, 10.0),
        held=(("z_min", "xyz"),),
    )
    animal = Animal(
        Stage({"soft": soft, "hard": hard}, touches=(Touch(("soft", "z_min"), ("hard", "z_max")),)),
        speed=speed,
        length=0.2,
        scale=0.5 * speed**2,
        apart=(("hard", "soft", (0, 0, 1)),),
        twins=("outer", "tiny"),
        limit="the body would invert" if o.size > 1 else "",
        deep=1.0,
    )
    return finished(o, animal, 0.01 / speed + 4 / SOFT.speed)


ANIMALS: tuple[Callable[[Options], Animal], ...] = (
    part_on_a_floor,
    part_on_a_slab,
    small_body,
    small_sphere,
    pushed_ball,
    stack,
    pile,
    ball_in_a_cup,
    peg_in_a_hole,
    sheet_between_rollers,
    drop_on_a_face,
    drop_on_an_edge,
    drop_on_a_corner,
    block_in_a_box,
    thin_plates,
    open_faces,
    closed_impact,
    incline,
    swing,
    fork,
    fast_soft,
)


def runs(draws: int) -> Iterator[tuple[Callable[[Options], Animal], Options]]:
    """Every scene with each option alone, and with ``draws`` sets of options at random; all scenes with one
    set of options before the next set."""
    for o in ONE_AT_A_TIME:
        for animal in ANIMALS:
            yield animal, o
    for seed in range(draws):
        for k, animal in enumerate(ANIMALS):
            yield animal, drawn(1000 * k + seed)
