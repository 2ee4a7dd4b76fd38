"""
Your own mesh
=============

A cam was meshed with Gmsh and written as an Abaqus file. Here it hits a wall. The file,
``cam.inp``, comes with the package, beside the scene that names it (:doc:`/start/meshes`).

The program computes for about 2 s of one core. Each claim is followed by an ``assert``, so it
fails where a claim is wrong.
"""

import os
from pathlib import Path

import numpy as np

import libcontact as ct

folder = Path(os.environ.get("LIBCONTACT_FIGURES", "."))
folder.mkdir(parents=True, exist_ok=True)

scene = ct.Scene.load(ct.example("cam"))
run = scene.run(progress=False, output=False)
run.plot().savefig(folder / "own_mesh.png", dpi=150)

# %%
# Without Python the same is ``libcontact run cam.toml --plot``. The scene has 15 lines:

print(ct.example("cam").read_text())

# %%
# What is in the file?
# --------------------
# ``libcontact mesh cam.inp`` lists the sets that a scene may name; ``read_mesh`` returns them. The
# cam has 80 bricks and 32 wedges. Each wedge stays one element, a brick with one side collapsed to
# an edge. So the volume is that of the polygons that were meshed: an outline of 20 facets, without
# a hole of 8.

from libcontact.meshes import read_mesh

mesh = read_mesh(ct.example("cam").with_name("cam.inp"))
print(mesh.report.read, "gave", len(mesh.elements), "elements")
print({name: len(mesh.face_sets[name]) for name in ("cam_outer", "cam_hole", "bottom", "top")})

section = 10 * 1.2 * np.sin(np.pi / 10) - 4 * 0.35**2 * np.sin(np.pi / 4)  # n/2 a b sin(2 π/n)
mass = 7800 * 0.5 * section
energy = run.energy
print(f"kinetic energy at the start {energy['kinetic'][0]:.6g} J, m v² / 2 = {200 * mass:.6g} J")
assert mesh.report.read == {"hex8": 80, "wedge6": 32} and len(mesh.elements) == 112
assert abs(energy["kinetic"][0] / (200 * mass) - 1) < 1e-12

# %%
# The impact
# ----------
# The lowest corner of the outline touches the wall at the start, which stores no energy. The wall
# turns the cam back, and the total energy is conserved. The cam leaves slower than it came: the
# rest of the energy is in its rotation and vibration.

total = energy["total"]
speed = run.body_momentum("cam")["p"][:, 1] / mass
drift = np.max(np.abs(total / total[0] - 1))
print(f"velocity of the centre {speed[0]:.3f} m/s before, {speed[-1]:.3f} m/s after")
print(f"total energy within {drift:.1e}")
assert energy["strain"][0] == 0 and energy["obstacle"][0] == 0
assert 15 < speed[-1] < 20 and drift < 1e-3

# %%
# A name that does not exist
# --------------------------
# A typing error in a name costs no search: the message lists the names that exist.

data = scene.data
data["obstacle"][0]["surface"] = "cam.cam_out"
try:
    ct.Scene(data, file=scene.file).explain()
except ct.SceneError as error:
    reason = error.reason
print(reason.partition(" There are")[0])
assert 'did you mean "cam_outer"?' in reason and '"cam_hole"' in reason

# %%
# Predict, then unfold
# --------------------
# Write down each prediction before you unfold the answer; the lines below run the changes.
#
# 1. Write ``scale = 0.5`` into the body, and half the distance of the wall and half the end. What
#    are the velocities, and when?
#
#    .. answer::
#
#       The same velocities at half the times: elasticity has no length of its own.
#
# 2. Put the cam at rest, ``velocity = [0, 0, 0]``. What moves?
#
#    .. answer::
#
#       Nothing: a mesh that touches the wall has no energy.


def changed(velocity, scale):
    """The velocity of the centre and the energies of the scene with another velocity and scale."""
    data = scene.data
    data["body"][0] |= {"velocity": [0, velocity, 0], "scale": scale}
    data["obstacle"][0]["plane"]["point"][1] *= scale
    data["time"]["end"] *= scale
    found = ct.Scene(data, file=scene.file).run(progress=False, output=False)
    return found.body_momentum("cam")["p"][:, 1] / (mass * scale**3), found.energy


half, _ = changed(-20, 0.5)
_, rest = changed(0, 1.0)
print(f"half as large: {half[-1]:.3f} m/s after; at rest: energy {rest['total'][-1]:.1e} J")
assert len(half) == len(speed) and np.abs(half - speed).max() < 1e-9
assert rest["kinetic"].max() == 0 and rest["obstacle"].max() == 0
