"""What the scenes of many tests consist of, the names of their energies, and whether runs have the same bits."""

import libcontact as ct

METRES = {"length": "m", "mass": "kg", "time": "s"}
MILLIMETRES = {"length": "mm", "mass": "t", "time": "s"}
STEEL = {"name": "steel", "young": 2.1e5, "poisson": 0.3, "density": 7.8e-9}  # in mm, t, s
# Names of the energies of a run.
ENERGY = tuple("time kinetic strain contact reserve external total balance".split())
# Ends of the edges of a brick, in the order of the mid-side nodes of hex20.
EDGES = [divmod(ends, 10) for ends in (1, 12, 23, 30, 45, 56, 67, 74, 4, 15, 26, 37)]


def box_of(origin, size, cells):
    """The table of a box, as in a scene file."""
    return {"origin": origin, "size": size, "cells": cells}


def scene_with(name, units=METRES, title=None, **entries):
    """A scene with a material, to which the rest is added."""
    return ct.Scene(title=title, units=units).add_material(name, **entries)


def same_state(one, other):
    """Whether two runs end at the same time with the same bits."""
    fields = ("displacement", "velocity", "stress")
    return (one.state.step, one.state.time) == (other.state.step, other.state.time) and all(
        getattr(one.state[name], field).tobytes() == getattr(other.state[name], field).tobytes()
        for name in one.state
        for field in fields
    )


def continued(scene, folder, until):
    """The run of a scene that is stopped, and continued from its file."""
    half, rest = folder / "half.vtkhdf", folder / "rest.vtkhdf"
    scene.run(output=half, until=until)
    return scene.run(restart=half, output=rest)
