"""Equations of the book, written again from its pages in numpy, and compared with what the library computes."""

import numpy as np
import pytest
from executes import executes

import libcontact as ct

STEEL = {"E": 210e9, "nu": 0.3, "rho": 7800.0}
lib, ffi = ct.contact.lib, ct.contact.ffi


@executes("hooke", "wave-speeds")
def test_wave_speeds():
    pass
