"""Pictures of the chapter on the stable step with contact and on its pressure."""

import balls as hertz
import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE, RED
from shared.scenes import bar_on_wall, done

import libcontact as ct


def after_impact(fraction, **law):
    """Largest energy after the impact over that before, and the step over that of the elements."""
    worst, cells, landings = 0.0, 40, 3
    for place in range(landings):
        at = 0.02 + place / landings * fraction / cells
        scene = bar_on_wall(cells, at, **law).set_time(end=2.3 + at, dt=fraction / cells)
        run = done(scene)
        worst = max(worst, run.energy["total"][-1] / run.energy["total"][0])
    return worst


def delay():
    """Pressure of a bar at a wall for three penalties, against the closed form."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    cells, at = 100, 0.01
    for beta, colour in ((0.2, BLUE), (1.0, ORANGE), (10.0, GREEN)):
        scene = bar_on_wall(cells, at, beta=beta).set_time(end=at + 0.3, fraction=0.2)
        run = done(scene)
        t = run.momentum["time"]
        p = np.gradient(run.momentum["p"][:, 0], t) / 0.05**2
        elements = cells * (t - at)
        ax.plot(elements, p, color=colour, label=f"β = {beta:g}")
        later = np.linspace(0, 20, 400)
        ax.plot(later, 1 - np.exp(-beta * later), color=colour, ls="--", lw=1)
    ax.plot([-2, 0, 0, 20], [0, 0, 1, 1], color="black", lw=1)
    ax.set(xlabel="time c t / h after the touch", ylabel="pressure / (ρ c v)")
    ax.set(xlim=(-1, 20), ylim=(-0.05, 1.5))
    ax.legend()
    return figure


def growth():
    """Energy after an impact over the length of the step, for the explicit penalty and the default."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    part = np.linspace(0.4, 0.99, 5)
    for beta, colour in ((1.0, ORANGE), (5.0, GREEN), (10.0, RED)):
        # Reported step of a bar on a wall: 1 / sqrt(1 + β) of that of the elements.
        steps = part / np.sqrt(1 + beta)
        ratio = [after_impact(s, beta=beta, enforcement="penalty") for s in steps]
        ax.plot(steps, ratio, "o-", ms=3.5, color=colour, label=f"explicit, β = {beta:g}")
    steps = np.linspace(0.2, 0.98, 4)
    ratio = [after_impact(s) for s in steps]
    ax.plot(steps, ratio, "s-", ms=3.5, color="black", label="default")
    ax.axhline(1.0, color=GREY, lw=0.8)
    ax.set(xlabel="step / stable step of the elements", ylabel="energy after / before")
    ax.legend()
    return figure


def rim():
    """The recovered pressure under a sphere on coarse meshes with a stiff contact, and that over the faces in contact
    alone."""
    figure = Figure(figsize=(7.5, 3.4))
    ax = figure.subplots()
    a, peak, fine = np.sqrt(4 * 0.1), 2000 / 0.91 / np.pi * np.sqrt(0.1 / 4), np.linspace(0, 1, 300)
    ax.plot(fine * a, peak * np.sqrt(1 - fine**2), color="black", lw=1.4, label="Hertz")
    for cells, mark, colour in ((20, "o", BLUE), (10, "s", ORANGE)):
        data = ct.Scene.load(ct.example("hertz")).data
        data["body"][0]["box"]["cells"] = [cells] * 3
        del data["obstacle"][0]["beta"]
        (nodes,) = ct.Scene(data).run(progress=False, output=False).pressure["obstacle"]
        r, p = np.hypot(*nodes["position"][:, :2].T), nodes["pressure"]
        near = r < 1.2
        ax.plot(r[near], p[near], mark, color=colour, ms=6, label=f"{cells}³ elements")
    # On the coarse mesh the face in the middle alone has points in contact.
    some = p > 0
    alone = (p * nodes["area"])[some] / (0.4**2 / 4)
    ax.plot(r[some], alone, "x", color=RED, ms=8, label="10³, faces in contact alone")
    ax.set(xlabel="distance from the middle r [mm]", ylabel="pressure [MPa]", xlim=(-0.02, 1.2))
    ax.legend()
    return figure


def balls():
    """The recovered pressure between two balls on three meshes at the largest force of an impact, and the pressures of
    single points; over the radius and the peak of Hertz's profile for the force."""
    figure = Figure(figsize=(7.5, 3.4))
    ax, fine = figure.subplots(), np.linspace(0, 1, 300)
    ax.plot(fine, np.sqrt(1 - fine**2), color="black", lw=1.4, label="Hertz")
    for element, n, mark, colour in (("hex8", 3, "o", BLUE), ("hex20", 2, "s", ORANGE)):
        run = done(hertz.scene(element, n, n, impact=True))
        a, r, p, points, raw = hertz.profile(run, run.pressure["contact"][0], 0)
        if element == "hex8":
            ax.plot(points / a, raw, "x", color=GREY, ms=4, label="hex8, 3 over the radius, points")
        ax.plot(r / a, p, mark, color=colour, ms=5, label=f"{element}, {n} over the radius, nodes")
    ax.set(xlabel="distance from the middle r / a", ylabel="pressure / peak of Hertz's")
    ax.set(xlim=(-0.02, 1.4), ylim=(-0.05, 1.6))
    ax.legend()
    return figure
