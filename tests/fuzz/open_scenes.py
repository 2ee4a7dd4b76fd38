"""
Random bodies whose contact is between parts of their skins: ``open_scenes.py FAMILY FIRST COUNT``, FAMILY ``scenes``,
``hosts``, ``stiff`` or ``stiff_hosts``.

Over the border of an open surface a point suddenly lies inside. The oracle is the energy of the bodies, kinetic and
strain, not the total that contains what the contact stores: it must not exceed that of the start by more than 0.2 %.
``stiff``, ``stiff_hosts``: closed skins, with penalty factors of 1 ... 1e6, of bodies that turn.
"""

from __future__ import annotations

import json
import sys
import warnings

import numpy as np
from libcontact.run import RunError

import libcontact as ct

ALLOWED = 0.002
AXES = "xyz"


def turned(chance: np.random.Generator) -> np.ndarray:
    """A random rotation."""
    turn, _ = np.linalg.qr(chance.normal(size=(3, 3)))
    return turn * np.sign(np.linalg.det(turn))


def _body(chance: np.random.Generator, name: str, origin, size, velocity, most: int) -> dict:
    kind = str(chance.choice(["hex8", "hex8", "hex20"]))
    cells = chance.integers(1, (most if kind == "hex8" else 2) + 1, 3).tolist()
    body = {
        "name": name,
        "material": name,
        "element": kind,
        "box": {"origin": list(map(float, origin)), "size": list(map(float, size)), "cells": cells},
        "velocity": list(map(float, velocity)),
    }
    if chance.random() < 0.5:
        rate = float(chance.uniform(0.02, 0.3))
        body["spin"] = {"rate": rate, "axis": chance.normal(size=3).tolist()}
    return body


def _scene(chance: np.random.Generator, bodies: list[dict], contact: dict) -> dict:
    materials = [
        {
            "name": name,
            "young": float(10 ** chance.uniform(-0.5, 0.5)),
            "poisson": float(chance.uniform(0.0, 0.4)),
            "density": float(10 ** chance.uniform(-0.5, 0.5)),
            "law": "st_venant_kirchhoff",
        }
        for name in "ab"
    ]
    time = {"end": 1e9, "fraction": float(chance.uniform(0.3, 0.95))}
    units = {"length": "m", "mass": "kg", "time": "s"}
    return {
        "units": units,
        "material": materials,
        "body": bodies,
        "contact": [contact],
        "time": time,
        "output": {"every": 1},
    }


def open_scene(seed: int) -> tuple[dict, float]:
    """Two boxes that slide over, past or onto each other, with one side of each in contact."""
    chance = np.random.default_rng(seed)
    axis = int(chance.integers(3))
    sizes = chance.uniform(0.4, 1.6, (2, 3))
    origin = np.zeros(3)
    # The second box is above the first one, more or less beside it.
    origin[axis] = sizes[0, axis] * (1.0 + chance.choice([0.0, 0.02, 0.1, -0.05, -0.3]))
    for c in {0, 1, 2} - {axis}:
        origin[c] = chance.uniform(-1.2, 1.2) * sizes[:, c].mean()
    speed = 10 ** chance.uniform(-2.5, -0.8)
    velocity = chance.normal(size=3)
    velocity[axis] = -abs(velocity[axis])
    velocity -= 0.7 * origin * (np.arange(3) != axis)
    velocity *= speed / np.linalg.norm(velocity)
    bodies = [
        _body(chance, "a", np.zeros(3), sizes[0], np.zeros(3), 3),
        _body(chance, "b", origin, sizes[1], velocity, 3),
    ]
    contact = {"surfaces": [f"a.{AXES[axis]}_max", f"b.{AXES[axis]}_min"]}
    if chance.random() < 0.3:
        contact["points"] = "lobatto"
    scene = _scene(chance, bodies, contact)
    way = float(sizes.mean() * chance.uniform(0.5, 2.0))
    return scene, way / speed


def stiff_scene(seed: int) -> tuple[dict, float]:
    """Two closed boxes of unlike meshes that meet obliquely, with a penalty factor of 1 ... 1e6."""
    chance = np.random.default_rng(seed)
    sizes = chance.uniform(0.6, 1.4, (2, 3))
    origin = np.array([sizes[0, 0] + 0.02, *chance.uniform(-0.5, 0.5, 2)])
    velocity = np.array([-1.0, *chance.uniform(-1, 1, 2)]) * 10 ** chance.uniform(-2.0, -0.6)
    bodies = [
        _body(chance, "a", np.zeros(3), sizes[0], np.zeros(3), 4),
        _body(chance, "b", origin, sizes[1], velocity, 4),
    ]
    beta = float(10 ** chance.uniform(0.0, 6.0))
    contact = {"surfaces": ["a.outer", "b.outer"], "beta": beta}
    if chance.random() < 0.3:
        contact["points"] = "lobatto"
    return _scene(chance, bodies, contact), 2.5 / float(np.linalg.norm(velocity))


def run_scene(made: tuple[dict, float], most: int = 6000) -> dict:
    """Run a scene; what its bodies gained, and what was told."""
    data, end = made
    data["time"]["end"] = end
    told: list[str] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            scene = ct.Scene(data)
            steps = scene._built(None).step_count
            if steps > most:
                data["time"]["end"] = end * most / steps
                scene = ct.Scene(data)
            run = scene.run(progress=False, output=False)
            ended = "ok"
        except ct.SceneError as error:
            return {"ended": "refused", "text": str(error)[:200], "told": []}
        except RunError as error:
            run, ended = error.run, type(error).__name__
            told.append(str(error)[:160])
    told += [getattr(each.message, "kind", type(each.message).__name__) for each in caught]
    rows = run.energy
    own = rows["kinetic"] + rows["strain"] - rows["external"]
    first = rows["total"][0]
    return {
        "ended": ended,
        "growth": float(own.max() / first - 1.0),
        "step": float(np.diff(own).max() / first) if len(own) > 1 else 0.0,
        "booked": float(rows["total"].max() / first - 1.0),
        "end": float(own[-1] / first),
        "contact": float(rows["contact"].max() / first),
        "told": sorted(set(told)),
    }


FACES = np.array(
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]]
)
CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)


def _element(size: np.ndarray, young: float, poisson: float) -> np.ndarray:
    """Stiffness of a rectangular hex8, eight Gauss points."""
    K = np.zeros((24, 24))
    C = np.zeros((6, 6))
    C[:3, :3] = poisson
    C[range(3), range(3)] = 1.0 - poisson
    C[range(3, 6), range(3, 6)] = 0.5 - poisson
    C *= young / (1.0 + poisson) / (1.0 - 2.0 * poisson)
    signs = 2.0 * CORNERS - 1.0
    for at in signs / np.sqrt(3.0):
        one = 1.0 + signs * at
        dN = np.stack([signs[:, 0] * one[:, 1] * one[:, 2], signs[:, 1] * one[:, 0] * one[:, 2],
                       signs[:, 2] * one[:, 0] * one[:, 1]], 1) / 8.0 * (2.0 / size)  # fmt: skip
        B = np.zeros((6, 24))
        for c in range(3):
            B[c, c::3] = dN[:, c]
        for row, (c, d) in zip((3, 4, 5), ((0, 1), (1, 2), (2, 0)), strict=True):
            B[row, c::3], B[row, d::3] = dN[:, d], dN[:, c]
        K += B.T @ C @ B * np.prod(size) / 8.0
    return K


class Block:
    """A box of linear hex8 elements of a host, turned and moved."""

    def __init__(self, chance: np.random.Generator, size, centre, velocity, spin=0.0):
        n = chance.integers(1, 4, 3)
        h = size / n
        grid = np.stack(np.meshgrid(*[np.arange(k + 1) for k in n], indexing="ij"), -1)
        number = np.arange(grid[..., 0].size).reshape(n + 1)
        cells = np.array(
            [[number[i + a, j + b, k + c] for a, b, c in CORNERS] for i, j, k in np.ndindex(*n)]
        )
        turn = turned(chance)
        young, density = 10 ** chance.uniform(-0.5, 0.5, 2)
        poisson = chance.uniform(0.0, 0.4)
        self.x0 = (grid.reshape(-1, 3) * h - size / 2) @ turn.T + centre
        T = np.kron(np.eye(8), turn)
        element = T @ _element(h, young, poisson) @ T.T
        count = self.x0.size
        self.K = np.zeros((count, count))
        self.m = np.zeros(len(self.x0))
        for cell in cells:
            dofs = (3 * cell[:, None] + np.arange(3)).ravel()
            self.K[np.ix_(dofs, dofs)] += element
            self.m[cell] += density * np.prod(h) / 8.0
        m3 = np.repeat(self.m, 3)
        self.step = 2.0 / np.sqrt(np.linalg.eigvalsh(self.K / np.sqrt(np.outer(m3, m3)))[-1])
        self.modulus = young * (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
        self.h = h.min()
        self.travel_time = self.h / np.sqrt(self.modulus / density)
        self.u = np.zeros_like(self.x0)
        turning = spin * np.random.default_rng(cells.size).normal(size=3)
        self.v = velocity + np.cross(turning, self.x0 - self.x0.mean(0))
        skin = [cell[face] for cell in cells for face in FACES]
        met: dict[tuple, int] = {}
        for face in skin:
            key = tuple(sorted(face))
            met[key] = met.get(key, 0) + 1
        self.skin = np.array([face for face in skin if met[tuple(sorted(face))] == 1])

    def part(self, chance: np.random.Generator) -> np.ndarray:
        """Some faces of the skin: half of the sides, or faces at random."""
        if chance.random() < 0.5:
            axis, level = chance.normal(size=3), chance.uniform(-0.3, 0.3)
            middle = self.x0[self.skin].mean(1) - self.x0.mean(0)
            chosen = middle @ axis > level * np.linalg.norm(axis) * np.ptp(self.x0)
        else:
            chosen = chance.random(len(self.skin)) < 0.6
        return self.skin[chosen] if chosen.any() else self.skin


def run_host(seed: int, factor: float = 40.0, steps: int = 1500, closed: bool = False) -> dict:
    """A leapfrog of our own about a `ct.Contact` of parts of two closed skins."""
    chance = np.random.default_rng(seed)
    speed = 10 ** chance.uniform(-2.5, -0.8)
    way = chance.normal(size=3)
    way /= np.linalg.norm(way)
    sizes = chance.uniform(0.4, 1.4, (2, 3))
    start = way * 0.5 * np.linalg.norm(sizes.sum(0)) * chance.uniform(0.8, 1.05)
    aside = np.cross(way, chance.normal(size=3)) * chance.uniform(0.0, 0.6)
    spin = 0.08 if closed else 0.0
    a = Block(chance, sizes[0], np.zeros(3), np.zeros(3), spin)
    b = Block(chance, sizes[1], start + aside, -way * speed, -spin)
    dt = float(chance.uniform(0.3, 0.95)) * min(a.step, b.step)
    modulus = min(a.modulus, b.modulus)
    options = {
        "epsilon": factor * modulus / min(a.h, b.h),
        "restitution": float(seed % 2),
        "travel_time": min(a.travel_time, b.travel_time),
        "points": str(chance.choice(["gauss", "gauss", "lobatto"])),
        "initial_penetration": "keep",
    }
    faces = [body.skin if closed else body.part(chance) for body in (a, b)]
    surfaces = [ct.Surface("Q4", body.x0, face) for body, face in zip((a, b), faces, strict=True)]
    contact = ct.Contact(*surfaces, **options)
    first, most, jump, last, booked = None, 0.0, 0.0, None, 0.0
    steps = min(steps, int(1.5 * np.linalg.norm(start + sizes.mean(0)) / speed / dt) + 1)
    free = [np.repeat(1.0 / body.m, 3).reshape(-1, 3) for body in (a, b)]
    for step in range(steps):
        force = [-(body.K @ body.u.ravel()).reshape(-1, 3) for body in (a, b)]
        kick = dt if step else dt / 2
        x = tuple(body.x0 + body.u for body in (a, b))
        try:
            contact.step(dt, x, (a.v, b.v), tuple(free), tuple(force), force_time=kick)
        except (ct.Error, ValueError) as error:
            return {"ended": "refused", "text": str(error)[:200], "growth": most, "told": []}
        added = tuple(np.zeros_like(f) for f in force)
        contact.add_force(added)
        energy, begun = 0.0, 0.0
        for body, f, g, inverse in zip((a, b), force, added, free, strict=True):
            # The energy half a step later: that of t_n falls below it by what the forces of t_n
            # accelerate against themselves, and rises above it where they act against each other.
            if first is None:
                begun += 0.5 * float((body.m[:, None] * body.v**2).sum())
            body.v = body.v + kick * inverse * (f + g)
            next_u = body.u + dt * body.v
            energy += 0.5 * float((body.m[:, None] * body.v**2).sum())
            energy += 0.5 * float(body.u.ravel() @ body.K @ next_u.ravel())
            body.u = next_u
        if first is None:
            first = last = begun
        most, jump, last = max(most, energy / first - 1), max(jump, (energy - last) / first), energy
        balance = contact.balance
        booked = max(booked, (balance.work + balance.energy) / first)
    return {
        "ended": "ok", "growth": most, "step": jump, "booked": booked, "end": last / first,
        "contact": 1.0 - last / first, "told": [],
    }  # fmt: skip


def one(family: str, seed: int) -> dict:
    if family == "hosts":
        return run_host(seed)
    if family == "stiff_hosts":
        factor = float(10 ** np.random.default_rng(seed).uniform(0.0, 6.0))
        return run_host(seed, factor=factor, closed=True)
    return run_scene((open_scene if family == "scenes" else stiff_scene)(seed))


def main() -> None:
    family, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    found = []
    for seed in range(first, first + count):
        got = one(family, seed) | {"seed": seed}
        found.append(got)
        print(json.dumps(got), flush=True)
    ran = [each for each in found if "growth" in each]
    grown = [each for each in ran if each["growth"] > ALLOWED]
    print(
        f"{count} {family}: {sum(e['ended'] == 'refused' for e in found)} refused, {sum(e['ended'] not in ('ok', 'refused') for e in found)} ended early, "
        f"{len(grown)} grow by more than {ALLOWED}, {sum(not e['told'] for e in grown)} of them silently, "
        f"largest {max((e['growth'] for e in ran), default=0):.3g}, in one step {max((e.get('step', 0) for e in ran), default=0):.3g}, "
        f"booked {max((e.get('booked', 0) for e in ran), default=0):.3g}, "
        f"with contact {sum(e.get('contact', 0) > 1e-3 for e in ran)}"
    )


if __name__ == "__main__":
    main()
