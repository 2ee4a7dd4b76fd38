"""Wave speeds of steel: find the error."""

import numpy as np


def lame(young, nu):
    """Lamé's constants Λ and μ."""
    return young * nu / ((1 + nu) * (1 - nu)), young / (2 * (1 + nu))


def speeds(young, nu, density):
    first, shear = lame(young, nu)
    return np.sqrt((first + 2 * shear) / density), np.sqrt(shear / density)


if __name__ == "__main__":
    c1, c2 = speeds(210e9, 0.3, 7800.0)
    print(f"dilatation wave {c1:.0f} m/s, shear wave {c2:.0f} m/s")
