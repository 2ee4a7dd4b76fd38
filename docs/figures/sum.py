"""Picture of the chapter on sums."""

import numpy as np
from libcontact._core import ffi, lib
from matplotlib.figure import Figure
from shared.drawing import BLUE, ORANGE


def orders():
    """Errors of plain sums of the same numbers in many orders, and of the order-free sum."""
    rng = np.random.default_rng(3)
    terms = rng.random(4096)
    exact = float(sum(int(t * 2**60) for t in terms) / 2**60)
    plain, free = [], []
    for _ in range(400):
        rng.shuffle(terms)
        plain.append(float(np.cumsum(terms)[-1]) - exact)
        free.append(lib.ct_sum(ffi.from_buffer("double[]", terms), len(terms)) - exact)
    unit = float(np.spacing(exact))
    figure = Figure(figsize=(6.4, 2.6))
    ax = figure.subplots()
    values = np.array(plain) / unit
    ax.hist(
        values,
        bins=np.arange(values.min() - 0.5, values.max() + 1.5),
        color=ORANGE,
        label="one after another",
    )
    ax.axvline(np.unique(free)[0] / unit, color=BLUE, lw=3, label="on two grids: all 400 orders")
    assert len(np.unique(free)) == 1
    ax.set(xlabel="error, in units of the last digit", ylabel="orders of 400")
    ax.legend(fontsize=9)
    return figure
