"""Scenes of one elastic body, runs of them, and what can be read off a motion."""

import warnings

import numpy as np

import libcontact as ct


def scene_of(young=1.0, poisson=0.0, density=1.0, **law):
    """A scene with one material, "elastic", and no body yet."""
    scene = ct.Scene(title="picture", units={"length": "m", "mass": "kg", "time": "s"})
    return scene.add_material("elastic", young=young, poisson=poisson, density=density, **law)


def bar(scene, cells=100, length=1.0, **keys):
    """A bar along x of cubes, one across; its sides are held, so that it is a row of masses and springs."""
    edge = length / cells
    box = {"origin": [0, 0, 0], "size": [length, edge, edge], "cells": [cells, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, **keys)
    for face in ("y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"bar.{face}", fix="yz")
    return scene


def bar_on_wall(cells=40, at=0.02, **law):
    """A bar of unit length and wave speed that flies with unit speed at a wall x = 0, from x = `at`."""
    scene = scene_of()
    box = {"origin": [at, 0, 0], "size": [1, 0.05, 0.05], "cells": [cells, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, velocity=[-1, 0, 0])
    plane = {"point": [0, 0, 0], "normal": [1, 0, 0]}
    scene.add("obstacle", surface="bar.x_min", plane=plane, **law)
    return scene.set_output(every=1, fields=[])


def done(scene):
    """The run of a scene, without its warnings and files."""
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore"
        )  # of coarse steps and of growth, which the pictures are to show
        return scene.run(progress=False, output=False)


def found_roots(u, count):
    """Factors of the motion per step, from the recurrence u_{n+count} = Σ c_i u_{n+i} that the steps obey."""
    rows = np.stack([u[i : len(u) - count + i] for i in range(count)], axis=1)
    c = np.linalg.lstsq(rows, u[count:], rcond=1e-11)[0]
    return np.roots(np.concatenate([[1.0], -c[::-1]]))
