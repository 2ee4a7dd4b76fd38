"""Answers of the exercises of the chapter on waves in meshes."""

import numpy as np

import libcontact as ct


def late(planes, element, mass):
    size = 1.0 if element == "hex8" else 2.0
    found = ct.dispersion([[2 * np.pi / planes, 0, 0]], element, [size] * 3, mass=mass)
    return abs(1 - found.phase[0, 2])


def test_waves_orders(says):
    errors = {}
    for element, mass, order in (
        ("hex8", "lumped", 2),
        ("hex8", "consistent", 2),
        ("hex20", "lumped", 2),
        ("hex20", "consistent", 4),
    ):
        pair = late(20, element, mass), late(40, element, mass)
        assert abs(np.log2(pair[0] / pair[1]) - order) < 0.1
        errors[element, mass] = pair[1]
    says(*(f"{100 * errors[element, 'lumped']:.2f} %" for element in ("hex8", "hex20")))


def test_waves_diagonal(says):
    """The long waves of the library, at 45° and along an axis."""
    k = 0.05
    for nu, courant in ((0.0, 0.0), (0.3, 0.0), (0.3, 0.9)):
        waves = ct.dispersion([[k, 0, 0], [k / 2**0.5, k / 2**0.5, 0]], poisson=nu, courant=courant)
        error = 1 - waves.phase[:, 2]
        says(f"{error[1] / error[0]:.2f}")
    says(f"{np.sqrt((7 - 2 / 7) / 4):.2f}")
