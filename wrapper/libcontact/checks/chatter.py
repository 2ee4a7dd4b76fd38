"""Limits of penalty and step beyond which contact is known to add energy to the bodies, because
points open and close with every step (chapter "Enforcement", tutorial "Choosing a penalty")."""

from __future__ import annotations

from collections.abc import Iterator

from .._core import lib
from ..errors import SceneWarning
from ..model import modulus
from ..problem import Problem
from ..surfaces import contact_tables

# Pairs (β, largest fraction of the stable step), measured on the bar on a wall for different initial
# gaps: within these limits its energy grows by less than 1 %. These integrators allow a stiffer
# penalty.
DAMPING = (lib.CT_CHUNG_LEE, lib.CT_NOH_BATHE, lib.CT_TCHAMWA_WIELGOSZ)
PENALTY, DAMPED_PENALTY = ((4.0, 0.4), (30.0, 0.25)), ((50.0, 0.4),)
DEFAULT = 4.0  # default of the explicit penalty in ρ c₁² / h (eq:penalty-default); β is in E / h


def chatter(problem: Problem) -> Iterator[SceneWarning]:
    """Warn of each contact and obstacle whose enforcement, penalty and step are known to add energy."""
    for key, who, given in contact_tables(problem.parts):
        surfaces = [given.surface] if key.startswith("obstacle") else given.surfaces
        bodies = [problem.bodies[name] for name, _ in surfaces]
        materials = [m for each in surfaces for m in problem.materials_behind(each)]
        young = min(m.young for m in materials)
        wave = min(map(modulus, materials))
        beta = given.beta or DEFAULT * wave / young
        if given.epsilon:
            beta = given.epsilon * min(body.mesh.shortest_edge for body in bodies) / young
        fraction = problem.dt / problem.stable.dt
        if given.enforcement == "penalty" and _makes_energy(problem, beta, fraction):
            yield SceneWarning(
                "chatter",
                f'{who}: enforcement = "{given.enforcement}" with beta = {beta:.3g} at '
                f"{fraction:.2g} of the stable step is known to feed energy into the bodies; take "
                'a smaller step, a smaller beta, or enforcement = "energy_controlled"',
                key,
            )


def _makes_energy(problem: Problem, beta: float, fraction: float) -> bool:
    own = problem.pointer.integrator
    default = lib.ct_integrator_default(own.scheme).parameter
    damped = own.scheme in DAMPING and own.parameter == default
    limits = DAMPED_PENALTY if damped else PENALTY
    return any(beta >= least and fraction > most for least, most in limits)
