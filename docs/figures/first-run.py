"""The picture of the page "Five minutes to the first impact"."""

from matplotlib.figure import Figure

import libcontact as ct


def hertz():
    """What ``run.plot()`` draws of the scene Hertz."""
    run = ct.Scene.load(ct.example("hertz")).run(progress=False)
    return run.plot(figure=Figure())
