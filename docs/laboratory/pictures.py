"""What stands in the place of a laboratory on paper and without JavaScript: one picture each."""

import warnings
from pathlib import Path

from libcontact.pictures.plot_projection import draw_path
from matplotlib.figure import Figure
from shared.faces import POINT, bent_face

import libcontact as ct

RING = Path(__file__).resolve().parent / "ring.toml"


def bar():
    """Energy of a bar that hits a wall, with a stiff explicit penalty and with the default law."""
    figure = Figure(figsize=(6.4, 2.8))
    ax = figure.subplots()
    laws = {"energy_controlled": "energy-controlled (the default)", "penalty": "explicit penalty"}
    for law, name in laws.items():
        data = ct.Scene.load(ct.example("bar_on_a_wall")).data
        data["body"][0]["box"]["origin"] = [1, 0, 0]
        data["obstacle"][0] |= {"enforcement": law, "beta": 10}
        data["time"] = {"end": 1, "fraction": 0.9, "energy_limit": 1e9}
        data["output"] = {"every": 1}
        with warnings.catch_warnings(action="ignore"):  # the explicit penalty makes energy here
            energy = ct.Scene(data).run(progress=False).energy
        ax.plot(energy["time"], energy["total"] / energy["total"][0], label=name)
    ax.set(xlabel="time t [s]", ylabel="energy / start", ylim=(0, None))
    ax.legend()
    return figure


def plates():
    """Transversal stress on the line of Fig. 5, computed with 40 elements, beside the closed form."""
    figure = Figure(figsize=(6.4, 2.8))
    ax = figure.subplots()
    data = ct.Scene.load(ct.example("plates")).data
    for body in data["body"]:
        body["box"]["cells"] = [40, 1, 40]
    data["contact"] = [{"surfaces": data["contact"][0]["surfaces"], "beta": 40}]
    data["time"]["courant"] = 0.5
    run = ct.Scene(data).run(progress=False, output=False)
    place, stress = run.line("stress_zz", (1.0, 0.0, 0.03), (1.0, 0.0, 2.47), n=200, body="right")
    z = 0.03 / 2.5 + place / 2.5
    exact = ct.exact.plates(0.4, z, 0.56).stress.sigma_z
    # The plateau behind the front is -1 in the unit of the closed form.
    ax.plot(z, exact, "--", color="black", lw=1.2, label="exact")
    ax.plot(z, -stress / stress[0], label="computed, d/40")
    ax.set(xlabel="z / d at x = 0.4 d", ylabel=r"$\sigma_z^*$")
    ax.legend()
    return figure


def closest():
    """The ways of three methods over the map of distances."""
    figure = Figure(figsize=(7.5, 2.9))
    for ax, method in zip(figure.subplots(1, 3, sharey=True), ("simplex", "newton", "robust")):
        count = draw_path(ax, "Q8", bent_face(), POINT, method, start=(-0.2, 0.7))
        ax.set_title(f"{method}: {count}", fontsize=9)
        ax.grid(False)
    return figure


def waves():
    """The front of a step after 56 elements, as the sum of all waves of two meshes."""
    figure = Figure(figsize=(6.4, 2.8))
    ax = figure.subplots()
    for courant in (0.125, 0.9):
        front = ct.dispersion_front(56.0, courant=courant)
        ax.plot(front.distance, front.stress, label=f"hex8, Courant number {courant}")
    ax.set(xlabel="distance from the wall / h", ylabel=r"stress / $\rho c_1 v_0$")
    ax.legend()
    return figure


def own():
    """The energy balance of a ring that hits a block."""
    figure = Figure(figsize=(6.4, 2.8))
    ax = figure.subplots()
    energy = ct.Scene.load(RING).run(progress=False, output=False).energy
    for name in ("kinetic", "strain", "contact", "total"):
        ax.plot(1e3 * energy["time"], energy[name], label=name)
    ax.set(xlabel="time t [ms]", ylabel="energy [mJ]")
    ax.legend(ncols=4)
    return figure
