"""Units of a scene: names, SI factors, and the labels of what is derived from them.

The C library knows no units: it computes with plain numbers that must be consistent. A scene names its three base
units, and this module turns them into labels (``mm``, ``t``, ``s`` give stresses in ``MPa``) and into SI values for hints.
"""

from __future__ import annotations

from .schema import Choice, Table, key

LENGTH = {
    "m": 1.0,
    "dm": 1e-1,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "µm": 1e-6,
    "nm": 1e-9,
    "km": 1e3,
    "in": 0.0254,
    "ft": 0.3048,
}
MASS = {
    "kg": 1.0,
    "g": 1e-3,
    "mg": 1e-6,
    "t": 1e3,
    "Mg": 1e3,
    "kt": 1e6,
    "lb": 0.45359237,
    "slug": 0.45359237 * 9.80665 / 0.3048,
    "slinch": 0.45359237 * 9.80665 / 0.0254,
}
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}

BASES = {"length": LENGTH, "mass": MASS, "time": TIME}

# Exponents of length, mass and time, and the names that go with an SI factor.
_NAMED = {
    "stress": (
        (-1, 1, -2),
        {1.0: "Pa", 1e3: "kPa", 1e6: "MPa", 1e9: "GPa", 1e12: "TPa", 1e-1: "dPa"},
    ),
    "force": ((1, 1, -2), {1e-3: "mN", 1.0: "N", 1e3: "kN", 1e6: "MN"}),
    "energy": ((2, 1, -2), {1e-6: "µJ", 1e-3: "mJ", 1.0: "J", 1e3: "kJ", 1e6: "MJ"}),
    "impulse": ((1, 1, -1), {1.0: "N s", 1e3: "kN s"}),
    "velocity": ((1, 0, -1), {}),
    "density": ((-3, 1, 0), {}),
    "length": ((1, 0, 0), {}),
    "mass": ((0, 1, 0), {}),
    "time": ((0, 0, 1), {}),
    "penalty": ((-2, 1, -2), {}),
}


class Units(Table):
    """
    The base units of a scene, for example ``Units("mm", "t", "s")``. All numbers of the scene and of
    its results are in them.

    Attributes
    ----------
    length
        Unit of lengths.
    mass
        Unit of masses. A slinch is the mass that one pound-force accelerates by 1 in/s².
    time
        Unit of times.
    """

    length: str = key(Choice(LENGTH), kw_only=False)
    mass: str = key(Choice(MASS), kw_only=False)
    time: str = key(Choice(TIME), kw_only=False)

    def factor(self, quantity: str) -> float:
        """SI value of one unit of a quantity (``"stress"``, ``"energy"``, ``"velocity"``, ...)."""
        (length, mass, time), _ = _NAMED[quantity]
        return LENGTH[self.length] ** length * MASS[self.mass] ** mass * TIME[self.time] ** time

    def label(self, quantity: str) -> str:
        """Name of the unit of a quantity: ``MPa`` where there is a name, ``t/(mm s^2)`` where there is none."""
        exponents, names = _NAMED[quantity]
        factor = self.factor(quantity)
        for value, name in names.items():
            if abs(factor - value) <= 1e-12 * value:
                return name
        if quantity == "penalty":
            return f"{self.label('stress')}/{self.length}"
        return _product((self.length, self.mass, self.time), exponents)


def _product(bases: tuple[str, str, str], exponents: tuple[int, int, int]) -> str:
    """``t/(mm s^2)`` from bases and exponents, the mass first as is the custom."""
    order = (1, 0, 2)
    above = [_power(bases[i], exponents[i]) for i in order if exponents[i] > 0]
    below = [_power(bases[i], -exponents[i]) for i in order if exponents[i] < 0]
    top = " ".join(above) or "1"
    if not below:
        return top
    bottom = " ".join(below)
    return f"{top}/({bottom})" if len(below) > 1 else f"{top}/{bottom}"


def _power(base: str, exponent: int) -> str:
    return base if exponent == 1 else f"{base}^{exponent}"
