"""When a penalty is known to feed energy into the bodies as its points come and go (chapter "Enforcement", tutorial "Choosing a penalty")."""

from __future__ import annotations

from collections.abc import Iterator

from .problem import Problem

# Measured on the bar on a wall, over ways to meet the wall: within these limits its energy grows by less than 1 %. (β, largest fraction of the stable step)
PENALTY = ((4.0, 0.4), (30.0, 0.25))
BIPENALTY_BETA, BIPENALTY_PRODUCT = 3.0, 1.5


class ChatterWarning(UserWarning):
    """A penalty is so stiff for the step that points which come and go with every step feed energy into the bodies."""


def chatter(problem: Problem) -> list[str]:
    """A sentence for each contact and obstacle whose enforcement, penalty and step are known to make energy."""
    return [sentence for who, enforcement, beta in _enforced(problem) if (sentence := _warn(who, enforcement, beta, problem))]


def _enforced(problem: Problem) -> Iterator[tuple[str, str, float]]:
    """Name, enforcement and β of every contact and obstacle."""
    bodies = problem.bodies

    def factor(given, names) -> float:
        if given.beta is not None:
            return given.beta
        return given.epsilon * min(bodies[name].mesh.shortest_edge for name in names) / min(bodies[name].material.young for name in names)

    for contact in problem.parts.contacts:
        names = [body for body, _ in contact.surfaces]
        yield "contact " + " with ".join(".".join(surface) for surface in contact.surfaces), contact.enforcement, factor(contact, names)
    for effect in problem.parts.effects:
        if effect.name == "obstacle":
            yield "obstacle at " + ".".join(effect.given.surface), effect.given.enforcement, factor(effect.given, effect.given.surface[:1])


def _warn(who: str, enforcement: str, beta: float, problem: Problem) -> str:
    stable = problem.stable.dt if enforcement == "penalty" else problem.stable.dt_without_contact
    fraction = problem.dt / stable
    stiff = {"penalty": any(beta >= least and fraction > most for least, most in PENALTY),
             "bipenalty": beta >= BIPENALTY_BETA and beta * fraction > BIPENALTY_PRODUCT}
    if not stiff.get(enforcement, False):
        return ""
    return (f'{who}: enforcement = "{enforcement}" with beta = {beta:.3g} at {fraction:.2g} of the stable step is known to feed energy into the bodies; '
            'take a smaller step, a smaller beta, or enforcement = "energy_controlled"')
