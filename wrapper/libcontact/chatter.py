"""When a penalty is known to feed energy into the bodies as its points come and go (chapter "Enforcement", tutorial "Choosing a penalty")."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ._core import lib
from .problem import Problem

# Measured on the bar on a wall, over ways to meet the wall: within these limits its energy grows by less than 1 %. (β, largest fraction of the stable step)
# Integrators that damp single elements bear a stiffer penalty.
PENALTY, DAMPED_PENALTY = ((4.0, 0.4), (30.0, 0.25)), ((50.0, 0.4),)
BIPENALTY_BETA, BIPENALTY_PRODUCT = 3.0, 1.5


class ChatterWarning(UserWarning):
    """A penalty is so stiff for the step that points which come and go with every step feed energy into the bodies."""


def chatter(problem: Problem) -> list[str]:
    """A sentence for each contact and obstacle whose enforcement, penalty and step are known to make energy."""
    return [sentence for who, enforcement, beta in _enforced(problem) if (sentence := _warn(who, enforcement, beta, problem))]


def contact_name(contact: Any) -> str:
    """A contact by its surfaces."""
    return "contact " + " with ".join(".".join(surface) for surface in contact.surfaces)


def obstacle_name(obstacle: Any) -> str:
    """An obstacle by the surface that it stands before."""
    return "obstacle at " + ".".join(obstacle.given.surface)


def _enforced(problem: Problem) -> Iterator[tuple[str, str, float]]:
    """Name, enforcement and β of every contact and obstacle."""
    bodies = problem.bodies

    def factor(given, names) -> float:
        if given.beta is not None:
            return given.beta
        return given.epsilon * min(bodies[name].mesh.shortest_edge for name in names) / min(bodies[name].material.young for name in names)

    for contact in problem.parts.contacts:
        names = [body for body, _ in contact.surfaces]
        yield contact_name(contact), contact.enforcement, factor(contact, names)
    for effect in problem.parts.effects:
        if effect.name == "obstacle":
            yield obstacle_name(effect), effect.given.enforcement, factor(effect.given, effect.given.surface[:1])


def _warn(who: str, enforcement: str, beta: float, problem: Problem) -> str:
    stable = problem.stable.dt if enforcement == "penalty" else problem.stable.dt_without_contact
    fraction = problem.dt / stable
    own = problem.pointer.integrator
    damped = own.scheme != lib.CT_CENTRAL_DIFFERENCE and own.parameter == lib.ct_integrator_default(own.scheme).parameter
    stiff = {"penalty": any(beta >= least and fraction > most for least, most in (DAMPED_PENALTY if damped else PENALTY)),
             "bipenalty": beta >= BIPENALTY_BETA and beta * fraction > BIPENALTY_PRODUCT}
    if not stiff.get(enforcement, False):
        return ""
    return (f'{who}: enforcement = "{enforcement}" with beta = {beta:.3g} at {fraction:.2g} of the stable step is known to feed energy into the bodies; '
            'take a smaller step, a smaller beta, or enforcement = "energy_controlled"')
