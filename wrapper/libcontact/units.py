"""Units of a scene: names, SI factors, and the labels of what is derived from them.

The C library does not use units: it computes with numbers, which must be consistent. A scene names
its three base units, and this module turns them into labels (``mm``, ``t``, ``s`` give stresses in
``MPa``) and into SI values for hints.
"""

from __future__ import annotations

from .schema import Choice, Table, key

LENGTH = {"m": 1.0, "dm": 1e-1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9}
LENGTH |= {"km": 1e3, "in": 0.0254, "ft": 0.3048}
# The mass that one pound-force accelerates by 1 in a second, by the unit of length.
SLUG = 0.45359237 * 9.80665
MASS = {"kg": 1.0, "g": 1e-3, "mg": 1e-6, "t": 1e3, "Mg": 1e3, "kt": 1e6, "lb": 0.45359237}
MASS |= {"slug": SLUG / 0.3048, "slinch": SLUG / 0.0254}
TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}


# Exponents of length, mass and time.
EXPONENTS = {
    "stress": (-1, 1, -2),
    "force": (1, 1, -2),
    "energy": (2, 1, -2),
    "impulse": (1, 1, -1),
    "velocity": (1, 0, -1),
    "density": (-3, 1, 0),
    "length": (1, 0, 0),
    "mass": (0, 1, 0),
    "time": (0, 0, 1),
    "penalty": (-2, 1, -2),
}
# Names of units and their SI factors.
NAMES: dict[str, dict[float, str]] = {
    "stress": {1e-1: "dPa", 1.0: "Pa", 1e3: "kPa", 1e6: "MPa", 1e9: "GPa", 1e12: "TPa"},
    "force": {1e-3: "mN", 1.0: "N", 1e3: "kN", 1e6: "MN"},
    "length": {1e-9: "nm", 1e-6: "µm", 1e-3: "mm", 1.0: "m"},
    "time": {1e-12: "ps", 1e-9: "ns", 1e-6: "µs", 1e-3: "ms", 1.0: "s"},
    "energy": {1e-6: "µJ", 1e-3: "mJ", 1.0: "J", 1e3: "kJ", 1e6: "MJ"},
    "impulse": {1.0: "N s", 1e3: "kN s"},
}


class Units(Table, eq=True):
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
        length, mass, time = EXPONENTS[quantity]
        return LENGTH[self.length] ** length * MASS[self.mass] ** mass * TIME[self.time] ** time

    def scaled(self, quantity: str, largest: float) -> tuple[float, str]:
        """Factor and name of the unit in which numbers up to ``largest`` are shown, such as 1e-6 and MPa for 1e7 Pa."""
        own, name = self.factor(quantity), self.label(quantity)
        named = {value: each for value, each in NAMES.get(quantity, {}).items() if each != "dPa"}
        if name not in NAMES.get(quantity, {}).values() or largest == 0.0 or 0.1 <= largest < 1e4:
            return 1.0, name
        below = [value for value in named if value <= largest * own * (1.0 + 1e-9)]
        best = max(below, default=min(named))
        return own / best, named[best]

    def label(self, quantity: str) -> str:
        """Name of the unit of a quantity: ``MPa`` if it has a name, otherwise for example ``t/(mm s^2)``."""
        factor = self.factor(quantity)
        for value, name in NAMES.get(quantity, {}).items():
            if abs(factor - value) <= 1e-12 * value:
                return name
        if quantity == "penalty":
            return f"{self.label('stress')}/{self.length}"
        # Mass first, as is usual.
        length, mass, time = EXPONENTS[quantity]
        powers = {self.mass: mass, self.length: length, self.time: time}
        above, below = (
            [
                base if sign * n == 1 else f"{base}^{sign * n}"
                for base, n in powers.items()
                if sign * n > 0
            ]
            for sign in (1, -1)
        )
        bottom = f"({' '.join(below)})" if len(below) > 1 else "".join(below)
        return (" ".join(above) or "1") + (f"/{bottom}" if below else "")
