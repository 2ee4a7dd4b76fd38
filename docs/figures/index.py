"""Pictures of the first page: two plates just after their impact, and what accuracy costs."""

import sys
from pathlib import Path

import numpy as np
from libcontact.pictures.plot import draw_faces
from matplotlib.figure import Figure
from shared.drawing import DARK, RED

import libcontact as ct

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "accuracy"))
import drawings  # noqa: E402

D, TIME = 2.5, 0.56  # half the thickness in mm, and the time c₁t/d at the end of the scene
YOUNG, POISSON, DENSITY, SPEED = 2.1e5, 0.3, 7.8e-9, 1e3


def impact():
    """The computed transversal stress in both plates, mirrored at their plane of symmetry, and the exact wave
    fronts."""
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    c1 = np.sqrt(lame * (1 - POISSON) / POISSON / DENSITY)
    run = ct.Scene.load(ct.example("plates")).run(progress=False, output=False)
    figure = Figure(figsize=(6.4, 5.2))
    ax = figure.subplots()
    for body in (run.state["left"], run.state["right"]):
        stress = body.stress[:, 2] * c1 / (lame * SPEED)
        for mirror in (1, -1):
            turn, look = np.diag([1, mirror]) / D, {"lw": 0, "rasterized": True}
            image = draw_faces(ax, body, "y_min", stress, (-1.5, 1.5), scale=0, turn=turn, **look)
    for name, curves in ct.exact.fronts(TIME).items():
        for curve in curves:
            for side in ((1, 1), (-1, 1), (1, -1), (-1, -1)):
                if name == "rayleigh":
                    ax.plot(*(curve * side).T, "o", color=RED, ms=6, clip_on=False)
                else:
                    ax.plot(*(curve * side).T, color=DARK, lw=1.3)
    figure.colorbar(image, ax=ax, label=r"$\sigma_z^*$", shrink=0.8)
    ax.set(xlabel="x / d", ylabel="z / d", xlim=(-1, 1), ylim=(-1, 1))
    ax.grid(False)
    return figure


def accuracy():
    """Error against time for all methods; four have colours."""
    named = ("paper's setting", "hex20", "default at 0.98")
    return drawings.work(named=(*named, "Tchamwa–Wielgosz 0.95, H' = 0.8"))
