"""When a penalty is known to feed energy into the bodies as its points come and go (chapter "Enforcement", tutorial "Choosing a penalty")."""

from __future__ import annotations

from collections.abc import Iterator

from ._core import lib
from .errors import ChatterWarning
from .problem import Problem
from .surfaces import obstacle_name, pair_name

# Measured on the bar on a wall, over ways to meet the wall: within these limits its energy grows by less than 1 %. (β, largest fraction of the stable step)
# Integrators that damp single elements bear a stiffer penalty.
PENALTY, DAMPED_PENALTY = ((4.0, 0.4), (30.0, 0.25)), ((50.0, 0.4),)
BIPENALTY_BETA, BIPENALTY_PRODUCT = 3.0, 1.5


def chatter(problem: Problem) -> Iterator[ChatterWarning]:
    """A warning for each contact and obstacle whose enforcement, penalty and step are known to make energy."""
    for key, who, enforcement, beta in _enforced(problem):
        if sentence := _warn(who, enforcement, beta, problem):
            yield ChatterWarning(sentence, key)


def _enforced(problem: Problem) -> Iterator[tuple[str, str, str, float]]:
    """Key, name, enforcement and β of every contact and obstacle."""
    bodies = problem.bodies

    def factor(given, names) -> float:
        if given.beta is not None:
            return given.beta
        return (
            given.epsilon
            * min(bodies[name].mesh.shortest_edge for name in names)
            / min(bodies[name].material.young for name in names)
        )

    for i, contact in enumerate(problem.parts.contacts):
        names = [body for body, _ in contact.surfaces]
        yield (
            f"contact[{i}]",
            pair_name(contact.surfaces),
            contact.enforcement,
            factor(contact, names),
        )
    for effect in problem.parts.effects:
        if effect.name == "obstacle":
            yield (
                effect.key,
                obstacle_name(effect),
                effect.given.enforcement,
                factor(effect.given, effect.given.surface[:1]),
            )


def _warn(who: str, enforcement: str, beta: float, problem: Problem) -> str:
    stable = problem.stable.dt if enforcement == "penalty" else problem.stable.dt_without_contact
    fraction = problem.dt / stable
    own = problem.pointer.integrator
    damped = (
        own.scheme != lib.CT_CENTRAL_DIFFERENCE
        and own.parameter == lib.ct_integrator_default(own.scheme).parameter
    )
    stiff = {
        "penalty": any(
            beta >= least and fraction > most
            for least, most in (DAMPED_PENALTY if damped else PENALTY)
        ),
        "bipenalty": beta >= BIPENALTY_BETA and beta * fraction > BIPENALTY_PRODUCT,
    }
    if not stiff.get(enforcement, False):
        return ""
    return (
        f'{who}: enforcement = "{enforcement}" with beta = {beta:.3g} at {fraction:.2g} of the stable step is known to feed energy into the bodies; '
        'take a smaller step, a smaller beta, or enforcement = "energy_controlled"'
    )
