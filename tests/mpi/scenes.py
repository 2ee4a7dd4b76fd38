"""Scenes for the comparison of pieces, each with probes of all kinds: those of the tutorials, and those that follow.
A body in contact with itself comes into contact late, so a scene has the part of its end at which the comparison
begins."""

import sys
from pathlib import Path

import numpy as np
from libcontact.mesh import Mesh

import libcontact as ct

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "stability"))
TUTORIALS = ("plates", "hertz", "block_on_an_incline", "cam", "bent_plate", "spinning_ring")
LATE = {"cam": 0.25, "block_on_an_incline": 0.05, "bent_plate": 0.06, "plates": 0.01, "hertz": 0.1}
SOFT = {"name": "soft", "young": 900, "poisson": 0.3, "density": 1}


def box(name, origin, size, cells, **more):
    return {
        "name": name,
        "box": {"origin": origin, "size": size, "cells": cells},
        "material": "soft",
        **more,
    }


def blocks(**more):
    """Two blocks with unlike faces, of which the upper one flies and slides."""
    return {
        "title": "two blocks",
        "units": {"length": "m", "mass": "kg", "time": "s"},
        "material": [SOFT],
        "body": [
            box("low", [0, 0, -1], [3, 1, 1], [7, 3, 3]),
            box("up", [0.1, 0.05, 0.005], [1, 0.9, 1], [3, 2, 3], velocity=[2, 0, -3]),
        ],
        "contact": [{"surfaces": ["low.z_max", "up.z_min"], "friction": 0.3}],
        "time": {"end": 1.0, "fraction": 0.8},
        **more,
    }


def unlike():
    """The upper block is of hex20."""
    data = blocks()
    data["body"][1]["element"] = "hex20"
    return ct.Scene(data), 0.0


def rigid():
    """The upper block is rigid and turns."""
    data = blocks(rigid=[{"body": "up"}])
    data["body"][1]["spin"] = {"axis": [0, 1, 0], "rate": 3}
    return ct.Scene(data), 0.0


def pulled(view):
    """Springs between the nodes and their mean."""
    return -50.0 * (view.displacement - view.displacement.mean(axis=0))


def tied():
    """The blocks are tied, and slide on a plane; springs of Python pull the top together."""
    data = blocks(contact=[], tie=[{"surfaces": ["low.z_max", "up.z_min"]}])
    data["obstacle"] = [
        {
            "surface": "low.z_min",
            "plane": {"point": [0, 0, -1], "normal": [0, 0, 1]},
            "friction": 0.2,
        }
    ]
    data["body"][0]["velocity"] = [0, 0, -1]
    scene = ct.Scene(data).add_effect("springs", "up", "z_max", pulled, omega_squared=2e4)
    return scene.add_effect("spring", "low", [3, 100], pulled, omega_squared=2e4), 0.0


def crushed_strip():
    """A hairpin whose legs are moved together."""
    import folding

    name, bricks, drive, *values = folding.strips()[13]
    made, end = drive(bricks, *values)
    return made.set_time(end=end, fraction=0.6), 0.5


def crushed_ring():
    """A ring between two plates, until its inner walls touch."""
    import folding
    import shapes

    made, end = folding.pressed(shapes.ring(0.4, 0.08, (32, 1, 2), 0.06), 0.36, 0.36)
    return made.set_time(end=end, fraction=0.6), 0.75


def cradle():
    """Three plates of one material, the middle one of one layer; within the first one a core is stiffer, which pieces
    without it can't know (:eq:`release-passed`)."""
    elastic = {"restitution": 1.0}
    pairs = ("l.z_max", "m.z_min"), ("m.z_max", "u.z_min")
    data = blocks(contact=[{"surfaces": pair, **elastic} for pair in pairs])
    mesh = Mesh.box("hex8", [0, 0, -5], [4, 4, 5], [4, 4, 5])
    core = (abs(mesh.nodes[mesh.elements].mean(axis=1) - [2, 2, -2.5]) < 1).all(axis=1)
    sets = {"core": {"elements": np.flatnonzero(core)}, "skin": {"elements": np.flatnonzero(~core)}}
    arrays = {"nodes": mesh.nodes, "elements": mesh.elements, "sets": sets}
    stuff = {"core": "hard", "skin": "soft"}
    data["material"].append({**SOFT, "name": "hard", "young": 9900, "density": 10})
    data["body"] = [
        {"name": "l", **arrays, "material": stuff, "velocity": [0, 0, 0.3]},
        box("m", [0, 0, 0], [4, 4, 1], [4, 4, 1]),
        box("u", [0, 0, 1], [4, 4, 1], [4, 4, 1]),
    ]
    return ct.Scene(data), 0.0


def carried():
    """A block falls on a plane that a small rigid body carries, whose nodes are far from where it touches."""
    data = blocks(contact=[], rigid=[{"body": "small"}])
    small = {
        "name": "small",
        "inertia": {"mass": 4, "moments": [0.1, 0.1, 0.1]},
        "material": "soft",
    }
    data["body"] = [data["body"][0], {**small, "place": {"move": [0, 0.5, -2]}}]
    data["body"][0]["velocity"] = [0, 0, -1]
    plane = {"point": [0, 0, -1.001], "normal": [0, 0, 1]}
    data["obstacle"] = [{"surface": "low.outer", "plane": plane, "carrier": "small"}]
    return ct.Scene(data), 0.0


MADE = (unlike, rigid, tied, crushed_strip, crushed_ring, cradle, carried)
NAMES = TUTORIALS + tuple(each.__name__ for each in MADE)


def probed(scene):
    """The scene with probes of a point, a surface, and of each kind of resultant that it has."""
    data = scene.data
    name = data["body"][0]["name"]
    mesh = scene._built(None).bodies[name].mesh
    point = mesh.nodes[mesh.elements[0]].mean(axis=0)
    moves = ["displacement", "velocity", "acceleration"]
    given = [
        {"name": "point", "body": name, "point": point.tolist(), "quantities": [*moves, "stress"]},
        {"name": "surface", "surface": f"{name}.outer", "quantities": moves},
    ]
    for table in ("contact", "obstacle", "support"):
        alone = table == "contact" and len(data["body"]) == 1  # its forces have no resultant
        if data.get(table) and not alone:
            first = f"{table}[0]" if len(data[table]) > 1 else table
            given.append({"name": table, "resultant": first, "quantities": ["force", "moment"]})
    for probe in given:
        scene.add_probe(**probe)
    return scene


def scene_of(name):
    """A scene with probes, and the part of its end at which the comparison begins."""
    if name in TUTORIALS:
        path = ROOT / "tutorials" / "scenes" / f"{name}.toml"
        changes = {"body[0].mesh": str(path.with_suffix(".inp"))} if name == "cam" else {}
        return probed(ct.Scene.load(path, changes)), LATE.get(name, 0.0)
    scene, begin = next(each for each in MADE if each.__name__ == name)()
    return probed(scene), begin


def tables(run, whole=True):
    """All numbers of a run: energies, momenta, probes, and of a ``whole`` one states, stresses and contact points."""
    for table in (run.energy, run.momentum, *run.probes.values()):
        yield from dict(table.columns()).values()
    for body in run.state.values() if whole else ():
        yield from (body.displacement, body.velocity, body.stress)
    for points in run.contact if whole else ():
        yield from (points[name] for name in points.dtype.names)


def touches(run):
    """Whether a contact or an obstacle has pushed, at the end or in a step that probes have seen."""
    forces = [run.probes[name]["force"] for name in ("contact", "obstacle") if name in run.probes]
    return any(map(np.any, [*forces, *(points["raw_pressure"] for points in run.contact)]))


def same(one, other):
    """Equal as numbers and, but for the sign of zeros, to the last bit. On all processes but the first, the run of
    several has no state."""
    whole = one.state is not None
    pairs = list(zip(tables(one, whole), tables(other, whole), strict=True))
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)
