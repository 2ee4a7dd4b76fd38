"""The effect of 02_effect.c in Python: a spring from each node of a cube to its place of t = 0."""

import numpy as np

import libcontact as ct

k, node_mass = 0.125, 0.125


def force(view):
    return -k * view.displacement


def energy(view):
    return k / 2 * np.sum(view.displacement**2)


scene = ct.Scene(units={"length": "m", "mass": "kg", "time": "s"})
scene.add_material("soft", young=1, poisson=0, density=1)
cube = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
scene.add_body("cube", material="soft", box=cube, velocity=[1, 0, 0])
scene.add_effect("springs", "cube", range(8), force, energy=energy, omega_squared=k / node_mass)
scene.set_time(end=np.pi / 2, fraction=0.01)
run = scene.run()
displacement, stored = run.state["cube"].displacement[0, 0], run.energy["springs"][-1]
print(f"displacement {displacement:.3f}, energy of the springs {stored:.3f}")
