"""The moving picture of the first page: two plates collide."""

import io

import numpy as np
from matplotlib.figure import Figure
from PIL import Image
from shared.drawing import DARK, GREY, RED

import libcontact as ct

FLIGHT, FRAMES = 12, 46  # pictures before and after the first contact
CELLS, D, SPAN = 50, 2.5, 0.92  # elements and mm along d, half the thickness; c₁t/d at the end


def collision():
    """The plates of the paper on a coarser mesh, with the default law and little ringing."""
    data = ct.Scene.load(ct.example("plates")).data
    data["time"] = {"end_c1t_over": {"length": D, "value": SPAN}, "fraction": 0.98}
    data["time"] |= {"integrator": "tchamwa_wielgosz", "integrator_parameter": 0.95}
    data["contact"] = [{"surfaces": data["contact"][0]["surfaces"]}]
    data["output"] = {"every": 2}
    for body in data["body"]:
        body["box"]["cells"] = [CELLS, 1, CELLS]
    return ct.Scene(data).run(progress=False, output=False)


def draw_plate(ax, stress, side, flight):
    """A plate with its stress, mirrored at the plane of symmetry; side: -1 left, 1 right."""
    x = sorted((side * flight, side * (1 + flight)))
    quarter = stress.reshape(CELLS, CELLS).T
    look = {"cmap": "coolwarm", "vmin": -1, "vmax": 1, "extent": (*x, -1, 1)}
    ax.imshow(np.vstack([quarter[::-1], quarter]), **look)
    ax.plot(np.take(x, (0, 1, 1, 0, 0)), (-1, -1, 1, 1, -1), color=GREY, lw=1)


def draw_fronts(ax, time):
    for name, curves in ct.exact.fronts(time).items():
        look = {"marker": "o", "color": RED} if name == "rayleigh" else {"color": DARK, "lw": 1.2}
        for curve in curves:
            for turn in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
                ax.plot(*(curve * turn).T, **look)


def moving():
    """Two plates fly at each other and collide: pictures on a transparent ground, and the milliseconds of each."""
    states = collision().states
    end, top = states[-1].time, np.abs(states[-1]["left"].stress[:, 2]).max()
    figure = Figure(figsize=(7.6, 4.18))
    # For all pictures; the option of Figure is forgotten after the first.
    figure.set_layout_engine("none")
    ax = figure.add_axes((0, 0, 1, 1))
    flights = [*np.linspace(0.9, 0, FLIGHT, endpoint=False), *np.zeros(FRAMES)]
    shown = [0] * FLIGHT + [round(i) for i in np.linspace(0, len(states) - 1, FRAMES)]
    pictures = []
    for flight, number in zip(flights, shown):
        ax.clear()
        ax.axis("off")
        for name, side in (("left", -1), ("right", 1)):
            draw_plate(ax, states[number][name].stress[:, 2] / top, side, flight)
        if (time := SPAN * states[number].time / end) > 0.05:
            draw_fronts(ax, time)
        ax.set(xlim=(-2, 2), ylim=(-1.1, 1.1))
        file = io.BytesIO()
        figure.savefig(file, dpi=100, transparent=True)
        pictures.append(Image.open(file).convert("RGBA"))
    return pictures, [80] * (len(pictures) - 1) + [1200]
