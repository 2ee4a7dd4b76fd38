"""
The cases of the campaign. A setting is a dict of scene keys, ``{"time.courant": 0.125}``, that replaces
keys of the plates of ``tutorials/scenes``. So a new method is one line of ``METHODS``, and a new value of
a factor one entry of ``FACTORS``.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

Keys = dict[str, Any]

PAPER: Keys = {"time.courant": 0.125, "contact.enforcement": "penalty", "contact.beta": 4.0}
BEST: Keys = {"time.fraction": 0.98}
CENTRES = {"paper's setting": PAPER, "default at 0.98": BEST}

# Keys of which a scene has one: the last one that is set counts.
RIVALS = ("time.courant", "time.fraction")


def hourglass(share: float, nu: float) -> float:
    """The key ``hourglass`` for which the hourglass modes have the stiffness share·(λ + 2μ), H' in the
    chapter "Reduced integration"."""
    return 3 * share * (1 - nu) / ((1 + nu) * (1 - 2 * nu))


TCHAMWA: Keys = {"time.integrator": "tchamwa_wielgosz"}
SHARP: Keys = TCHAMWA | {"time.fraction": 1.0, "time.integrator_parameter": 0.95}
DAMPED: Keys = {"viscosity.linear": 0.06}
ONE_POINT: Keys = {"body.integration": "reduced"}
HEX20: Keys = {"body.element": "hex20"}
FILTERED: Keys = {"output.filter": 2}
STIFF: Keys = {"body.integration": "reduced", "body.hourglass": round(hourglass(0.8, 0.3), 4)}
# One line per method: an integrator by "time.integrator", an option of the output by "output.…".
METHODS: dict[str, Keys] = {
    "paper's setting": PAPER,
    "default at 0.98": BEST,
    "viscosity 0.06": BEST | DAMPED,
    "one-point hex8": BEST | ONE_POINT,
    "one-point hex8, viscosity": BEST | ONE_POINT | DAMPED,
    "Chung–Lee": BEST | {"time.integrator": "chung_lee"},
    "Noh–Bathe": BEST | {"time.integrator": "noh_bathe"},
    "Tchamwa–Wielgosz": BEST | TCHAMWA,
    "Tchamwa–Wielgosz 0.95": SHARP,
    "Tchamwa–Wielgosz 0.95, H' = 0.8": SHARP | STIFF,
    "Tchamwa–Wielgosz 0.95, H' = 0.8, filtered": SHARP | STIFF | {"output.filter": 1},
    "default at 0.98, filtered": BEST | FILTERED,
    "hex20": BEST | HEX20,
    "hex20, Noh–Bathe": BEST | HEX20 | {"time.integrator": "noh_bathe"},
}

# Methods that damp the front: on more meshes, and for other Poisson's ratios.
DAMPING = (
    *("Noh–Bathe", "Tchamwa–Wielgosz", "Tchamwa–Wielgosz 0.95"),
    *("Tchamwa–Wielgosz 0.95, H' = 0.8", "Tchamwa–Wielgosz 0.95, H' = 0.8, filtered"),
)
POISSON = (0.2, 0.4)

COURANT = (0.05, 0.125, 0.25, 0.5)
FRACTIONS = (0.5, 0.7, 0.9, 0.98)
SEARCH = ("robust", "newton", "least_squares", "bfgs", "simplex", "certified")
FACTORS: dict[str, list[Keys]] = {
    "step": [
        *({"time.courant": value} for value in COURANT),
        *({"time.fraction": value} for value in FRACTIONS),
    ],
    "element": [ONE_POINT, HEX20],
    "integrator": [
        *({"time.integrator": name} for name in ("chung_lee", "noh_bathe", "tchamwa_wielgosz")),
        *(TCHAMWA | {"time.integrator_parameter": value} for value in (0.8, 0.93, 0.95, 0.97)),
    ],
    "filter of the picture": [{"output.filter": value} for value in (1, 2, 4)],
    "bulk viscosity": [
        *({"viscosity.linear": value} for value in (0.03, 0.06, 0.12, 0.25)),
        {"viscosity.linear": 0.06, "viscosity.quadratic": 1.2},
    ],
}
CONTACT_FACTORS: dict[str, list[Keys]] = {
    "enforcement": [
        {"contact.enforcement": "penalty", "contact.beta": 1.0},
        {"contact.enforcement": "energy_controlled", "contact.beta": 4.0},
        {"contact.enforcement": "energy_controlled", "contact.beta": 40.0},
    ],
    "rule on the faces": [{"contact.points": "lobatto"}],
    "search": [{"contact.method": name} for name in SEARCH],
    "tolerance": [
        {"contact.method": "simplex", "contact.tolerance": value} for value in (1e-2, 1e-4, 1e-6)
    ],
}

# The penalty, with each law, at each fraction of its stable step, on a coarse mesh for short runs.
BETAS = (0.5, 1.0, 4.0, 10.0, 40.0, 100.0)
LAWS = ("penalty", "energy_controlled")
LAW_FRACTIONS = (0.3, 0.6, 0.9, 0.98)
LAW_CELLS = 50


class Level(NamedTuple):
    """
    Extent of the campaign: meshes d/n of the methods, further ones of the dissipative methods, the mesh of
    the factors, and whether each method also runs with contact.
    """

    meshes: tuple[int, ...]
    damped_meshes: tuple[int, ...]
    factor_cells: int
    every_method_in_contact: bool


LEVELS = {
    "whole": Level((12, 25, 50, 100, 200, 400), (40, 45, 125, 190, 280), 200, True),
    "reduced": Level((12, 25, 50, 100), (40, 45, 125, 190, 280), 100, False),
    "short": Level((12, 25), (), 12, False),
}


class Case(NamedTuple):
    """One row: ``reference`` (a wall) or ``contact`` (two plates), elements along d, the changed keys, and
    whether seconds are measured."""

    scene: str
    cells: int
    keys: Keys
    timed: bool = True

    @property
    def setting(self) -> str:
        return "; ".join(f"{name}={value}" for name, value in sorted(self.keys.items()))

    @property
    def name(self) -> tuple[str, int, str]:
        """The identification of a row."""
        return self.scene, self.cells, self.setting


def over(centre: Keys, change: Keys) -> Keys:
    """A setting with some keys changed."""
    stays = {
        name: value
        for name, value in centre.items()
        if not (name in RIVALS and any(key in RIVALS for key in change))
    }
    return stays | change


def case(scene: str, cells: int, keys: Keys) -> Case:
    """A case; keys of contact are dropped for a plate on a wall."""
    own = {
        name: value
        for name, value in keys.items()
        if scene == "contact" or not name.startswith("contact.")
    }
    return Case(scene, cells, own)


def methods(level: Level) -> Iterator[Case]:
    for name, keys in METHODS.items():
        damps = name in DAMPING
        for cells in (*level.meshes, *(level.damped_meshes if damps else ())):
            yield case("reference", cells, keys)
            if level.every_method_in_contact or damps or keys in (PAPER, BEST):
                yield case("contact", cells, keys)


def with_poisson(keys: Keys, nu: float) -> Keys:
    """A setting for another Poisson's ratio, with the same H'."""
    own = keys | {"material.poisson": nu}
    if "body.hourglass" in own:
        own["body.hourglass"] = round(hourglass(0.8, nu), 4)
    return own


def ratios(level: Level) -> Iterator[Case]:
    """The paper's setting, the default law near its limit and the dissipative methods, for other Poisson's
    ratios."""
    for nu in POISSON if level.damped_meshes else ():
        for name in ("paper's setting", "default at 0.98", *DAMPING):
            keys = with_poisson(METHODS[name], nu)
            for cells in (40, 45, 50, 100, 280) if name in DAMPING else (100,):
                yield case("contact", cells, keys)
        yield case("reference", 100, with_poisson(PAPER, nu))


def factors(level: Level) -> Iterator[Case]:
    for centre in CENTRES.values():
        for changes in FACTORS.values():
            for change in changes:
                yield case("reference", level.factor_cells, over(centre, change))
        for changes in CONTACT_FACTORS.values():
            for change in changes:
                yield case("contact", level.factor_cells, over(centre, change))


def laws(level: Level) -> Iterator[Case]:
    short = level is LEVELS["short"]
    for law in LAWS:
        for beta in BETAS[2:4] if short else BETAS:
            for fraction in LAW_FRACTIONS[2:3] if short else LAW_FRACTIONS:
                keys = {"contact.enforcement": law, "contact.beta": beta, "time.fraction": fraction}
                yield case("contact", 12 if short else LAW_CELLS, keys)._replace(timed=False)
    # What the impact law returns of the energy of the stopped layer, and its price in noise.
    for keys in () if short else (BEST, METHODS["hex20"]):
        yield case("contact", LAW_CELLS, keys | {"contact.restitution": 0.0})._replace(timed=False)


def cases(name: str) -> list[Case]:
    """All cases of a level, each once, cheap ones first."""
    level = LEVELS[name]
    found = {own.name: own for part in (methods, ratios, factors, laws) for own in part(level)}
    return sorted(found.values(), key=lambda own: own.cells)
