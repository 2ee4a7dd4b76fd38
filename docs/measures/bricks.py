"""Bricks: convergence, bending with one point, operations at large strain, and how sharp the stable step is."""

from __future__ import annotations

import itertools

import numpy as np
import solid
import solid_reduced
import steps

import libcontact as ct

from .shared import Numbers, measurement


@measurement
def stress_error() -> Numbers:
    """Errors of the stress with four hex8 per edge, at Gauss points and at centres."""
    found = solid.solved("hex8", 4)
    return {"points": found["Gauss points"], "centre": found["centre"]}


@measurement
def bent_beam() -> Numbers:
    """End deflection over Timoshenko's of cantilevers of cubes, ν = 0.3, and how far those of one point lie from
    eq:reduced-bending."""
    found: Numbers = {"off": 0.0}
    for cells in (1, 2, 4):
        for name, kappa in (("q01", 0.1), ("q03", 0.3), ("q1", 1.0), ("full", None)):
            own = found[f"{name}_{cells}"] = solid_reduced.deflection(cells, kappa, poisson=0.3)
            if kappa is not None:
                found["off"] = max(found["off"], abs(own * (1 - (1 - kappa) / cells**2) - 1))
    return found


@measurement
def locked_beam() -> Numbers:
    """Timoshenko's end deflection over that of cantilevers of hex8, ν = 0: one layer of cubes, four layers of elements
    as long as these, and four of cubes."""
    runs = {"one": (1, 10), "four": (4, 10), "cubes": (4, 40)}
    return {
        name: 1 / solid_reduced.deflection(cells, None, along=along)
        for name, (cells, along) in runs.items()
    }


@measurement
def large_strain() -> Numbers:
    """Operations of an element of hex8 at large strain over those at small strain."""
    count = {}
    for law in ("linear", "st_venant_kirchhoff", "neo_hookean"):
        scene = ct.Scene(title="measured", units=steps.UNITS)
        scene.add_material("own", young=1.0, poisson=0.3, density=1.0, law=law)
        nodes, elements = steps.block("hex8", "distorted by 0.1 h")
        scene.add_body("block", material="own", nodes=nodes, elements=elements)
        body = scene.set_time(end=1.0, fraction=0.5).explain().data["bodies"][0]
        count[law] = body["flops_per_update"]
    return {law: count[law] / count["linear"] for law in ("st_venant_kirchhoff", "neo_hookean")}


SHARP = dict(zip(("cubes", "flat", "stiff", "graded", "off1", "off2"), steps.MESHES))


@measurement
def sharp_steps() -> Numbers:
    """Reported over true step of the meshes of stability/steps.py, by elements and blocks and by the assembled
    matrix."""
    found = {}
    for element, (name, mesh) in itertools.product(("hex8", "hex20"), SHARP.items()):
        plain, whole = (
            steps.problem_of(element, mesh, "central_difference", bound)
            for bound in ("elements", "assembled")
        )
        true = 2 / steps.largest_omega(whole)
        found[f"{element}_{name}"] = plain.stable.dt / true
        found[f"{element}_{name}_assembled"] = whole.stable.dt / true
        if (element, name) == ("hex8", "cubes"):
            found["cube"] = true * np.sqrt(1e8 * 0.7 / (1.3 * 0.4)) * 4  # c₁ Δt/h
    return found
