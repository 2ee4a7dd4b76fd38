"""The contact of a host with its own time loop: a step by hand, rods compared with their closed form, refusals."""

import threading
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scenes import box_of, scene_with

import libcontact as ct

GROUND, BELOW = ({"point": [0, 0, z], "normal": [0, 0, 1]} for z in (0, -2))
SQUARE = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], float)


def test_first_step_by_hand():
    """A face of mass 2 over a wall: λ = K ⟨-½ (g₁ + g₀)⟩ with g₁ = g₀ + Δt (v + ½ Δt f / m) + ½ Δt² λ / m, K = ε A."""
    x, dt, m, K, v = SQUARE + [0, 0, -0.02], 0.01, 2.0, 100.0, -2.0
    contact = ct.Contact(
        ct.Surface("Q4", SQUARE + [0, 0, 0.1], [[0, 3, 2, 1]]),
        ct.Surface("Q4", SQUARE, [[0, 1, 2, 3]]),
        epsilon=50.0,
        dissipation=0.0,
        restitution=0.0,
    )
    velocity, force = np.zeros((4, 3)), np.zeros((4, 3))
    velocity[:, 2], force[:, 2] = v, -3.0 / 4
    contact.step(
        dt,
        (x, SQUARE),
        (velocity, np.zeros((4, 3))),
        (np.full((4, 3), 4 / m), np.zeros((4, 3))),
        (force, np.zeros((4, 3))),
        force_time=dt / 2,
    )
    free = -0.02 + dt * (v - 0.5 * dt * 3.0 / m)
    want = -0.5 * K * (free - 0.02) / (1 + 0.25 * K * dt**2 / m)
    before, floor = force.copy(), np.zeros((4, 3))
    contact.add_force((force, floor))
    assert (force - before)[:, 2].sum() == pytest.approx(want, rel=1e-12)
    assert floor[:, 2].sum() == pytest.approx(-want, rel=1e-12)
    assert contact.resultant[:, 0, 2] == pytest.approx([want, -want], rel=1e-12)
    points = contact.points
    assert len(points) == 8 and (points["gap"] == pytest.approx(-0.02))
    assert (points["raw_pressure"] * points["weight"]).sum() / 2 == pytest.approx(want, rel=1e-12)
    # There is no work yet, and an overlap stores ½ K g².
    held = pytest.approx(0.5 * K * 0.02**2, rel=1e-12)
    assert contact.balance == ct.Balance(held, 0.0, 0.0, 0, 0.0, 0.0)
    assert contact.energy == contact.balance.energy


class Rods:
    """Two rods of square layers with springs between them, E = ρ = A = 1, L = 10, that approach each other with
    ±0.1."""

    def __init__(self, one_array, layers=51):
        self.h = 10 / (layers - 1)
        places = np.concatenate([np.linspace(-10, 0, layers), np.linspace(0, 10, layers)])
        self.X = np.zeros((8 * layers, 3))
        self.X[:, 0] = np.repeat(places, 4)
        self.X[:, 1:] = np.tile([[0, 0], [1, 0], [1, 1], [0, 1]], (2 * layers, 1))
        ends = np.isin(np.arange(2 * layers), [0, layers - 1, layers, 2 * layers - 1])
        mass = np.repeat(0.25 * self.h * np.where(ends, 0.5, 1.0), 4)
        self.inverse_mass = np.repeat(1 / mass[:, None], 3, axis=1)
        self.v = np.zeros_like(self.X)
        self.v[:, 0] = np.repeat([0.1, -0.1], 4 * layers)
        self.middle, self.one_array = 4 * layers, one_array
        left, right = np.arange(4)[None] + self.middle - 4, np.arange(4)[None, ::-1]
        if one_array:
            self.surfaces = [ct.Surface("Q4", self.X, f) for f in (left, right + self.middle)]
        else:
            parts = self.split(self.X)
            self.surfaces = [ct.Surface("Q4", part, f) for part, f in zip(parts, (left, right))]

    def split(self, array):
        return array if self.one_array else (array[: self.middle], array[self.middle :])

    def force(self, x):
        """The springs' forces, and their energy."""
        force, stiffness, energy = np.zeros_like(x), 0.25 / self.h, 0.0
        for part in slice(0, self.middle), slice(self.middle, None):
            stretch = np.diff(x[part, 0].reshape(-1, 4), axis=0) - self.h
            pull = stiffness * stretch.ravel()
            force[part, 0][:-4] += pull
            force[part, 0][4:] -= pull
            energy += 0.5 * stiffness * (stretch**2).sum()
        return force, energy

    def run(self, beta, fraction=0.9, end=30.0, cut=lambda contact: None, restitution=1.0):
        """Total energy and force on the right rod at every step."""
        contact = ct.Contact(
            *self.surfaces, epsilon=beta / self.h, restitution=restitution, travel_time=self.h
        )
        cut(contact)
        x, v, dt, rows = self.X.copy(), self.v.copy(), fraction * self.h, []
        for n in range(int(end / dt)):
            force, strain = self.force(x)
            kick = dt if n else dt / 2
            contact.step(
                dt, *map(self.split, (x, v, self.inverse_mass)), self.split(force), force_time=kick
            )
            contact.add_force(self.split(force))
            after = v + kick * self.inverse_mass * force
            kinetic = 0.5 * (v / self.inverse_mass * (after if n else v)).sum()
            rows.append(
                (kinetic + strain, contact.energy, contact.balance.work, contact.resultant[1, 0, 0])
            )
            v, x = after, x + dt * after
        return dt, np.array(rows), v


@pytest.mark.parametrize("restitution, kept, late", [(0.0, 0.97, 0.5), (1.0, 0.998, 0.8)])
@pytest.mark.parametrize("beta", [1, 10, 40, 100])
def test_rods(beta, restitution, kept, late):
    """At 0.9 of the host's own step the energy never grows; the pressure is ρcv, and the rods part after 2 L / c with
    exchanged velocities. The forces that give the reserve back act for some h / c longer."""
    rods = Rods(one_array=False)
    dt, rows, v = rods.run(beta, restitution=restitution)
    bodies, held, work, force = rows.T
    total = bodies + held
    assert np.diff(total).max() < 1e-12 * total[0]
    assert total[-1] > kept * total[0]
    assert np.abs(bodies - bodies[0] - work).max() < 1e-12 * total[0]
    contact = np.nonzero(force)[0] * dt
    assert contact[-1] == pytest.approx(20, abs=late)
    steady = (np.arange(len(force)) * dt > 5) & (np.arange(len(force)) * dt < 15)
    assert force[steady].mean() == pytest.approx(0.1, rel=5e-3)
    assert v[: rods.middle, 0].mean() == pytest.approx(-0.1, rel=0.02)


class Meeting:
    """Two threads that exchange numbers."""

    def __init__(self):
        self.barrier, self.given = threading.Barrier(2, timeout=60), {}

    def cut(self, piece):
        def exchange(combine):
            def answer(values):
                self.given[piece] = values.copy()
                self.barrier.wait()
                values[:] = combine(self.given[0], self.given[1])
                self.barrier.wait()

            return answer

        masks = ([piece == 0], [piece == 1])
        return lambda contact: contact.set_pieces(masks, exchange(np.add), exchange(np.maximum))


@pytest.mark.parametrize("one_array", [False, True])
def test_two_pieces_have_the_bits_of_one_contact(one_array):
    rods, meeting = Rods(one_array), Meeting()
    whole = rods.run(40, end=12.0)
    with ThreadPoolExecutor(2) as pool:
        runs = [pool.submit(rods.run, 40, 0.9, 12.0, meeting.cut(piece)) for piece in range(2)]
        for run in runs:
            for got, want in zip(run.result(), whole):
                assert np.array_equal(got, want)
    assert whole[1][:, 3].max() > 0.05


def test_pieces_that_are_refused():
    rods = Rods(one_array=False)
    make = lambda: ct.Contact(*rods.surfaces, epsilon=1 / rods.h, travel_time=rods.h)
    keep = lambda values: None
    with pytest.raises(ValueError, match="a pair of masks"):
        make().set_pieces([[True]] * 3, keep, keep)
    with pytest.raises(ValueError, match=r"shape \(2,\); it must be \(1,\)"):
        make().set_pieces(([True, False], [True]), keep, keep)
    with pytest.raises(ValueError, match="face 0 of surface 1 is in 0 pieces"):
        make().set_pieces(([True], [False]), keep, keep)

    def fail(values):
        raise RuntimeError("the network is down")

    with pytest.raises(RuntimeError, match="the network is down"):
        make().set_pieces(([True], [True]), fail, keep)


def test_penalties_and_the_step_that_the_explicit_one_allows():
    rods = Rods(one_array=False)
    explicit = ct.Contact(*rods.surfaces, epsilon=1 / rods.h, enforcement="penalty")
    mass = 1 / rods.inverse_mass[:, 0]
    # One pair of end layers: k = 1 / (4 h), m = h / 8 each, so ω² = 2 k / m = 4 / h².
    assert explicit.stable_step(rods.split(mass)) == pytest.approx(rods.h, rel=1e-12)
    # Friction does not limit the step.
    # An obstacle has k = ε / 4 at each node of mass h / 8.
    both = 2 / (4 / rods.h**2 + 0.5 / 4 / (rods.h / 8)) ** 0.5
    for enforcement, step in ("penalty", both), ("energy_controlled", np.inf):
        rub = ct.Contact(
            *rods.surfaces, epsilon=1 / rods.h, enforcement=enforcement, friction=0.3, tangent=0.2
        )
        rub.add_obstacle(GROUND, epsilon=0.5, friction=0.1, tangent=0.8)
        assert rub.stable_step(rods.split(mass)) == pytest.approx(step, rel=1e-12)
    assert ct.Contact.penalty(7.0, 3.0, 0.5) == 7 * 3.0 / 0.5
    assert ct.Contact.penalty_default(3.0, 0.5) == 40 * 3.0 / 0.5
    assert ct.Contact.penalty_default(3.0, 0.5, "penalty") == 4 * 3.0 / 0.5


def test_the_default_law_has_no_limit():
    rods = Rods(one_array=False)
    contact = ct.Contact(*rods.surfaces, epsilon=1 / rods.h, travel_time=rods.h)
    mass = 1 / rods.inverse_mass[:, 0]
    assert contact.stable_step(rods.split(mass)) == np.inf
    mass[rods.middle] = 0.0
    with pytest.raises(ValueError):
        contact.stable_step(rods.split(mass))


def skins(n):
    """Two unit cubes of n³ bricks with density 1: coordinates, outer faces and masses."""
    scene = scene_with("soft", young=1.0, poisson=0.0, density=1.0)
    for name, z in ("low", 0.0), ("high", 1.0):
        box = box_of([0, 0, z], [1, 1, 1], [n, n, n])
        scene.add_body(name=name, element="hex8", material="soft", box=box)
    problem = scene.set_time(end=1.0)._built(None)
    mass = np.frombuffer(ct._core.ffi.buffer(problem.pointer.mass, 16 * (n + 1) ** 3))
    meshes = [body.mesh for body in problem.bodies.values()]
    return [(m.nodes, m.faces("outer")[0]) for m in meshes], mass.reshape(2, -1)


@pytest.mark.parametrize("turned", [(), (0,), (1,), (0, 1)])
def test_closed_surfaces_that_point_inwards(turned):
    """Both turned inside out, bodies fall through each other without a force."""
    cubes, _ = skins(2)
    surfaces = [
        ct.Surface("Q4", nodes, faces[:, ::-1] if k in turned else faces)
        for k, (nodes, faces) in enumerate(cubes)
    ]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ct.Contact(*surfaces, epsilon=1.0)
    assert [one.message.kind for one in caught] == ["inside_out"] * len(turned)
    for one, k in zip(caught, turned):
        assert f"of the {('first', 'second')[k]} surface" in str(one.message)
    assert [surface.inside_out for surface in surfaces] == [
        0 if k in turned else None for k in (0, 1)
    ]


def test_the_wall_of_a_cavity_may_point_inwards():
    (outer, _), _ = skins(2)
    nodes, faces = outer
    hollow = np.concatenate([nodes, 0.5 + 0.5 * (nodes - 0.5)])
    wall = faces[:, ::-1] + len(nodes)
    body = ct.Surface("Q4", hollow, np.concatenate([faces, wall]))
    assert body.inside_out is None
    # A surface of its own is reported, but not warned of where the other one is inside.
    alone, ball = ct.Surface("Q4", hollow, wall), ct.Surface("Q4", 0.5 + 0.2 * (nodes - 0.5), faces)
    assert alone.inside_out == 0 and ball.inside_out is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ct.Contact(body, ball, epsilon=1.0)
        ct.Contact(ball, alone, epsilon=1.0)
    # An open surface encloses nothing.
    assert ct.Surface("Q4", nodes, faces[1:, ::-1]).inside_out is None


def test_one_array_or_two_give_the_same_bits():
    one, two = Rods(True).run(10)[1], Rods(False).run(10)[1]
    assert (one == two).all()


def test_arrays_are_read_and_written_where_they_stand():
    """Strided or integer arrays are read by a copy, but never written: the sums would be lost."""
    a, b = ct.Surface("Q4", SQUARE, [[0, 3, 2, 1]]), ct.Surface("Q4", SQUARE, [[0, 1, 2, 3]])
    contact = ct.Contact(a, b, epsilon=1.0, restitution=0.0, initial_penetration="force")
    low = np.asfortranarray(SQUARE - [0, 0, 0.01])
    zero, one = np.zeros((4, 3)), np.ones((4, 3), int)
    contact.step(0.1, low, zero, one)
    force = np.zeros((4, 3))
    with pytest.raises(TypeError, match="writable"):
        contact.add_force(np.zeros((4, 3), np.float32))
    with pytest.raises(TypeError, match="writable"):
        contact.add_force(np.zeros((8, 3))[::2])
    with pytest.raises(TypeError, match="writable"):
        contact.add_force(force.tolist())
    shifted = np.zeros(97, np.uint8)[1:].view(np.float64).reshape(4, 3)
    assert not shifted.flags.aligned
    with pytest.raises(TypeError, match="aligned"):
        contact.add_force(shifted)
    one, other = (ct.Contact(a, b, epsilon=1.0, restitution=0.0) for _ in range(2))
    shifted[:] = low
    one.step(0.1, shifted, zero, np.ones((4, 3)))
    other.step(0.1, low, zero, np.ones((4, 3)))
    assert (one.points["gap"] == other.points["gap"]).all()
    force.flags.writeable = False
    with pytest.raises(TypeError, match="writable"):
        contact.add_force(force)


def test_refusals():
    a, b = ct.Surface("Q4", SQUARE, [[0, 3, 2, 1]]), ct.Surface("Q4", SQUARE + 0, [[0, 1, 2, 3]])
    with pytest.raises(ct.ArgumentError, match="penalty epsilon must be positive"):
        ct.Contact(a, b, epsilon=0.0)
    with pytest.raises(ValueError, match="energy_controlled, not 'penalti'"):
        ct.Contact(a, b, epsilon=1.0, enforcement="penalti")
    contact = ct.Contact(a, b, epsilon=1.0, travel_time=1.0)
    pair = (np.zeros((4, 3)), np.zeros((4, 3)))
    with pytest.raises(ct.ArgumentError):
        _ = contact.balance
    with pytest.raises(ValueError, match="x must be a pair"):
        contact.step(0.1, SQUARE, pair, pair)
    with pytest.raises(ValueError, match="velocity must have shape"):
        contact.step(0.1, (SQUARE, SQUARE), (np.zeros((5, 3)), pair[0]), pair)
    with pytest.raises(ct.ArgumentError, match="dt must be positive and finite, not -1"):
        contact.step(-1.0, (SQUARE, SQUARE), pair, pair)
    with pytest.raises(ct.ArgumentError, match="not finite") as refused:
        contact.step(0.1, (SQUARE, SQUARE + [[np.nan, 0, 0]]), pair, pair)
    assert refused.value.body == 1


def square(nodes, face):
    return ct.Surface("Q4", nodes, [face])


def test_numbers_that_are_no_prediction_are_refused_in_the_first_step():
    flat = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    up, low, still, one = flat + [0, 0, 1e-3], flat.copy(), np.zeros((4, 3)), np.ones((4, 3))
    for what in range(3):
        for wrong in (np.nan, np.inf, -1.0):
            if what < 2 and wrong == -1.0:
                continue
            contact = ct.Contact(
                square(up, [0, 3, 2, 1]), square(low, [0, 1, 2, 3]), epsilon=50.0, travel_time=0.1
            )
            velocity, force, inverse = still.copy(), still.copy(), one.copy()
            (velocity, force, inverse)[what][2, 1] = wrong
            with pytest.raises(ct.Error, match="node 2 of surface 0"):
                contact.step(0.01, (up, low), (velocity, still), (inverse, one), (force, still))


def test_one_array_is_one_array_also_where_it_must_be_converted():
    flat = [[0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]]
    nodes = np.array(flat + [[x, y, 0.0] for x, y, _ in flat], np.float32)
    contact = ct.Contact(
        square(nodes, [0, 3, 2, 1]), square(nodes, [4, 5, 6, 7]), epsilon=50.0, travel_time=0.1
    )
    x = nodes.astype(float)
    contact.step(0.01, x, np.zeros_like(x), np.ones_like(x))


@pytest.mark.parametrize("wrong", [None, [], {}, "x", np.nan, [1.0, 2.0]])
def test_nonsense_is_refused_by_name(wrong):
    a = square(SQUARE, [0, 3, 2, 1])
    for name in ("epsilon", "dissipation", "depth", "threads", "friction", "tangent"):
        with pytest.raises((TypeError, ValueError), match=f"{name} must"):
            ct.Contact(a, **{"epsilon": 1.0, name: wrong})
    for name in ("enforcement", "points", "initial_penetration"):
        with pytest.raises(ValueError, match=f"{name} must be one of"):
            ct.Contact(a, **{"epsilon": 1.0, name: wrong})
    with pytest.raises(TypeError, match="needs a Surface"):
        ct.Contact(wrong, epsilon=1.0)
    for modulus, h, name in ((wrong, 1.0, "modulus"), (1.0, wrong, "h")):
        with pytest.raises((TypeError, ValueError), match=f"{name} must"):
            ct.Contact.penalty_default(modulus, h)
    with pytest.raises(ValueError, match="enforcement must be one of"):
        ct.Contact.penalty_default(1.0, 1.0, wrong)
    contact, zero = ct.Contact(a, epsilon=1.0, travel_time=1.0), np.zeros((4, 3))
    with pytest.raises((TypeError, ValueError), match="dt must"):
        contact.step(wrong, SQUARE, zero, zero)
    for name in ("x", "velocity", "inverse_mass", "force", "force_time")[
        : 3 if wrong is None else 5
    ]:
        given = {"x": SQUARE, "velocity": zero, "inverse_mass": zero, name: wrong}
        with pytest.raises((TypeError, ValueError), match=f"{name} must"):
            contact.step(0.1, **given)
    ball = {"centre": [0, 0, -2], "radius": 1.0}
    for name in ("sphere", "velocity", "epsilon", "friction", "history"):
        given = {"sphere": ball, "epsilon": 1.0, name: wrong}
        if name in ("history", "sphere") and (wrong is None or wrong == {}):
            continue
        with pytest.raises((TypeError, ValueError), match=f"{name} must|{name}: is .* must"):
            contact.add_obstacle(**given)
    for name in ball:
        with pytest.raises(ValueError, match=rf"add_obstacle: sphere\.{name}.*: (is|has)"):
            contact.add_obstacle(sphere=ball | {name: wrong}, epsilon=1.0)
    # No refused part was added.
    with pytest.raises(ValueError, match="friction must be positive and finite, not -1"):
        contact.add_obstacle(BELOW, epsilon=1.0, friction=-1.0)
    with pytest.raises(ValueError, match="tangent must be positive and finite, not 0"):
        contact.add_obstacle(BELOW, epsilon=1.0, friction=0.1, tangent=0.0)
    with pytest.raises(ValueError, match="there is no obstacle 0"):
        contact.reaction(0)
    assert contact.add_obstacle(BELOW, epsilon=1.0) == 0


def test_a_step_needs_the_travel_time_or_restitution_0():
    pair = lambda array: (array, array)
    a, b = ct.Surface("Q4", SQUARE, [[0, 3, 2, 1]]), ct.Surface("Q4", SQUARE + 0, [[0, 1, 2, 3]])
    zero, one = np.zeros((4, 3)), np.ones((4, 3))
    step = lambda contact: contact.step(0.1, pair(SQUARE), pair(zero), pair(one))
    need = "travel_time must be positive, not {}: give h / c1, .* or restitution 0"
    with pytest.raises(ct.ArgumentError, match="contact: " + need.format(0)):
        step(ct.Contact(a, b, epsilon=1.0, travel_time=0.0))
    for time in (-2.0, np.nan, np.inf):
        with pytest.raises(ValueError, match=f"travel_time must be .*finite, not {time:g}"):
            ct.Contact(a, b, epsilon=1.0, travel_time=time)
    walled = ct.Contact(a, b, epsilon=1.0, travel_time=1.0)
    walled.add_obstacle(BELOW, epsilon=1.0, travel_time=0.0)
    with pytest.raises(ct.ArgumentError, match="obstacle: " + need.format(0)):
        step(walled)
    for given in ({"restitution": 0.0}, {"enforcement": "penalty"}, {"travel_time": 0.1}):
        step(ct.Contact(a, b, epsilon=1.0, **given))


@pytest.mark.parametrize(
    "given, why",
    [
        ({}, "give one of plane, sphere and cylinder"),
        ({"plane": BELOW, "sphere": {"centre": [0, 0, -2], "radius": 1.0}}, "give one of plane"),
        ({"plane": {"point": [0, 0, -2]}}, "plane.normal: is missing"),
        ({"plane": BELOW | {"normal": [0, 0, 0]}}, "normal"),
        ({"cylinder": BELOW}, "cylinder"),
        ({"shape": "plane", "plane": BELOW}, '"shape" is gone; write "plane={...}, sphere='),
    ],
)
def test_an_obstacle_has_the_tables_of_a_scene(given, why):
    contact = ct.Contact(square(SQUARE, [0, 3, 2, 1]), itself=False, epsilon=1.0)
    with pytest.raises((TypeError, ValueError), match=why):
        contact.add_obstacle(epsilon=1.0, **given)
    assert contact.add_obstacle(plane=BELOW, epsilon=1.0) == 0


def test_an_old_word_answers_what_to_write():
    surface = ct.Surface("Q4", SQUARE, [[0, 1, 2, 3]])
    for gone, now in (
        ({"initial_penetration": "push"}, "force"),
        ({"enforcement": "lagrange"}, "energy_controlled"),
        ({"enforcement": "bipenalty"}, "energy_controlled"),
    ):
        with pytest.raises(ValueError, match=f'is gone.*write "{now}"'):
            ct.Contact(surface, epsilon=1.0, **gone)
    contact = ct.Contact(surface, epsilon=1.0)
    with pytest.raises(TypeError, match='step: "kick" is gone; write "force_time"'):
        contact.step(1e-3, None, None, None, kick=5e-4)


@pytest.mark.parametrize("how", ["keep", "force", "refuse", "remove"])
def test_a_plate_that_begins_inside_a_plane(how):
    contact = ct.Contact(square(SQUARE, [0, 3, 2, 1]), itself=False, epsilon=1.0, restitution=0.0)
    keys = {"initial_penetration": how, "removal_time": 0.02}
    wall = contact.add_obstacle(GROUND | {"point": [0, 0, 0.01]}, epsilon=2e5, **keys)
    with pytest.raises(ValueError, match="there is no obstacle 1"):
        contact.penetration(obstacle=1)
    x, v, free, zero = SQUARE.copy(), np.zeros((4, 3)), np.full((4, 3), 2.0), np.zeros((4, 3))
    if how == "refuse":
        with pytest.raises(ct.GeometryError, match="obstacle: 4 points of its surface are inside"):
            contact.step(1e-3, x, v, free, zero)
        return
    for n in range(60):
        force, kick = zero.copy(), 1e-3 if n else 5e-4
        contact.step(1e-3, x, v, free, force, force_time=kick)
        if n == 0:
            for at in ("points", "corners", "edges"):
                depth = contact.penetration(at, wall)
                assert depth["deepest"] == pytest.approx(0.01) and depth["surface"] == 0
            start = contact.balance
        contact.add_force(force)
        v, x = v + kick * free * force, x + 1e-3 * (v + kick * free * force)
    balance, kinetic = contact.balance, 0.25 * (v * v).sum()
    if how == "keep":
        assert not v.any() and balance.energy == 0.0
    elif how == "force":
        assert start.energy == pytest.approx(0.5 * 2e5 * 2 * 1e-4) and kinetic > 0.5 * start.energy
    else:
        assert 0.0 < kinetic <= 1.002 * balance.removal and v[0, 2] > 0.0
        assert contact.penetration(obstacle=wall)["surface"] is None


def slider(**keys):
    """A plate of mass 2 on a plane, under its weight; v along x."""
    contact = ct.Contact(square(SQUARE, [0, 3, 2, 1]), itself=False, epsilon=1.0, restitution=0.0)
    wall = contact.add_obstacle(GROUND, epsilon=2e5, initial_penetration="force", **keys)
    return contact, wall


def slide(contact, steps, state=None, dt=1e-3):
    low = SQUARE - [0, 0, 10 / (2e5 * 2)]  # in equilibrium with the weight
    x, v, first = state or (low, np.tile([0.5, 0, 0], (4, 1)).astype(float), 0)
    free, weight = np.full((4, 3), 2.0), np.tile([0, 0, -2.5], (4, 1))
    for n in range(first, first + steps):
        force, kick = weight.copy(), dt if n else dt / 2
        contact.step(dt, x, v, free, force, force_time=kick)
        contact.add_force(force)
        v = v + kick * free * force
        x = x + dt * v
    return x, v, first + steps


def test_a_plate_slides_to_rest_on_a_plane():
    """m v' = -μ m g: it stops after v² / (2 μ g), and friction, which begins in the second step, has dissipated ½ m
    v²."""
    contact, wall = slider(friction=0.4)
    x, v, _ = slide(contact, 1500)
    assert (x - SQUARE)[:, 0] == pytest.approx(np.full(4, 0.5**2 / (2 * 0.4 * 5)), rel=5e-3)
    assert np.abs(v).max() < 0.01
    assert contact.balance.friction == pytest.approx(0.5 * 2 * 0.25, rel=5e-3)
    assert contact.balance.motion == 0 == contact.balance.removal
    assert contact.reaction(wall)[0][2] == pytest.approx(-10, rel=1e-9)
    traction, area = contact.traction(obstacle=wall)
    assert (traction * area[:, None]).sum(axis=0)[2] == pytest.approx(10, rel=1e-9)
    with pytest.raises(ValueError, match="no obstacle 1"):
        contact.traction(obstacle=1)


def test_a_plane_that_moves_drags_the_plate_and_does_work():
    """The energy of the bodies plus that dissipated by friction is the work of the plane's motion."""
    contact, wall = slider(friction=0.4, velocity=[-1.0, 0, 0])
    slide(contact, 300)
    # It slides with 1.5 ... against the plane: -μ m g along x, so the plane does μ m g · 1 · t.
    assert contact.reaction(wall)[0][0] == pytest.approx(4, rel=1e-3)
    assert contact.balance.motion == pytest.approx(4 * 0.3, rel=5e-3)


def test_restart():
    contact, _ = slider(friction=0.4, velocity=[0.1, 0, 0])
    want = slide(contact, 200)
    first, second = (
        slider(friction=0.4, velocity=[0.1, 0, 0])[0],
        slider(friction=0.4, velocity=[0.1, 0, 0])[0],
    )
    middle = slide(first, 100)
    second.restore(first.save())
    got = slide(second, 100, middle)
    assert (got[0] == want[0]).all() and (got[1] == want[1]).all()
    assert second.balance == contact.balance
    with pytest.raises(ct.ArgumentError, match="it is another one"):
        second.restore(first.save()[1:])
    with pytest.raises(ct.Error, match="were not written by ct_contact_save"):
        second.restore(np.full_like(first.save(), np.nan))
    with pytest.raises(ct.ArgumentError, match="before the first step"):
        second.add_obstacle(GROUND, epsilon=1.0)
