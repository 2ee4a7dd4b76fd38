"""Pictures of the chapter on integrators."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE
from shared.scenes import bar, done, found_roots, scene_of

SCHEMES = {
    "central_difference": ("central difference", 2.0),
    "chung_lee": ("Chung, Lee", 28 / 27),
    "noh_bathe": ("Noh, Bathe", 0.54),
    "tchamwa_wielgosz": ("Tchamwa, Wielgosz", 0.9),
}


def stretch(view):
    """Forces that pull the two ends of a free cube apart at t = 0 and never again."""
    force = np.zeros_like(view.reference)
    if view.time == 0.0:
        force[:, 0] = 1e-6 * (view.reference[:, 0] - 0.5)
    return force


def free_cube(integrator, fraction):
    """The stretch of a free cube over 40 steps, and Ω = ω Δt. With E = ρ = h = 1 the motion has ω = 2."""
    scene = bar(scene_of(), cells=1)
    scene.add_effect("kick", "bar", np.arange(8), stretch)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    scene.set_time(end=1.0, fraction=fraction, integrator=integrator)
    dt = fraction * scene.explain().data["time"]["stable"]
    scene.set_time(end=40 * dt, dt=dt, integrator=integrator, energy_limit=1e9)
    run = done(scene)
    return run.probes["end"]["displacement"][:, 0], 2 * run.dt


def amplification(integrator, omega):
    """The matrix of one step for (u, Δt v, Δt² a of the evaluation before), eq:stage with a = -ω² u."""
    _, parameter = SCHEMES[integrator]
    stages = [(1.0, 1.0, 1.0, 0.0)]  # τ, c, r, l
    if integrator == "chung_lee":
        stages = [(1.0, 1.0, parameter, 1 - parameter)]
    elif integrator == "tchamwa_wielgosz":
        stages = [(1.0, 1.0, 2 / (1 + parameter), 0.0)]
    elif integrator == "noh_bathe":
        p, s = parameter, 1 - parameter
        stages = [(p, 1 - s / (2 * p), p, 0.0), (s, s / (2 * p), 0.5, -(2 * p - 1) * s / (2 * p))]
    step, x = np.eye(3), omega**2
    for tau, c, r, carried in stages:
        step = [[1 - tau * r * x, tau, tau * carried], [-c * x, 1, 0], [-x, 0, 0]] @ step
    return step


def principal(roots):
    """The root that belongs to the oscillation: the largest of those with an angle, or of all."""
    turning = roots[np.abs(roots.imag) > 1e-9]
    return max(turning if len(turning) else roots, key=abs)


def radii():
    """Spectral radius and error of the period: eigenvalues of the amplification matrix, and those found from runs of
    the library."""
    figure = Figure(figsize=(7.5, 3.8))
    radius, period = figure.subplots(1, 2)
    colours = (GREY, BLUE, ORANGE, GREEN)
    limits = (2.0, 1.867, 3.745, 1.902)
    for (name, (label, _)), colour, limit in zip(SCHEMES.items(), colours, limits, strict=True):
        two = 2.0 if name == "noh_bathe" else 1.0  # two evaluations of the forces in a step
        omega = np.linspace(0.02, limit, 300)
        roots = [np.linalg.eigvals(amplification(name, w)) for w in omega]
        largest = np.array([np.abs(r).max() for r in roots])
        radius.plot(omega / two, largest, color=colour, label=label)
        angle = np.array([abs(np.angle(principal(r))) for r in roots])
        turns = np.flatnonzero(np.diff(angle) <= 1e-9)
        end = turns[0] if len(turns) else len(omega)
        period.plot(omega[:end] / two, 100 * (omega[:end] / angle[:end] - 1), color=colour, lw=1.4)
        for part in (0.15, 0.3, 0.45, 0.6, 0.75, 0.9):
            u, found = free_cube(name, part)
            root = found_roots(u[2:], 3 if name == "chung_lee" else 2)  # after the pull
            radius.plot(found / two, np.abs(root).max(), "o", color=colour, ms=4)
            if found < omega[end - 1]:
                error = 100 * (found / abs(np.angle(principal(root))) - 1)
                period.plot(found / two, error, "o", color=colour, ms=4)
    radius.set(
        xlabel="ω Δt per evaluation", ylabel="spectral radius", xlim=(0, 2.05), ylim=(0.3, 1.03)
    )
    period.set(
        xlabel="ω Δt per evaluation", ylabel="error of the period, %", xlim=(0, 2.05), ylim=(-36, 8)
    )
    period.axhline(0, color="black", lw=0.8)
    figure.legend(*radius.get_legend_handles_labels(), loc="outside lower center", ncols=3)
    return figure


def steps_of_front():
    """The front of a step of stress after 56 elements, with each integrator at half of its stable step."""
    figure = Figure(figsize=(7.5, 4.4))
    axes = figure.subplots(4, 1, sharex=True, sharey=True)
    colours = (GREY, BLUE, ORANGE, GREEN)
    for ax, (name, (label, _)), colour in zip(axes, SCHEMES.items(), colours, strict=True):
        scene = bar(scene_of(), cells=100, length=100.0, velocity=[-1, 0, 0])
        scene.add_support("bar.x_min", fix="x")
        body = done(scene.set_time(end=56.0, fraction=0.5, integrator=name)).state["bar"]
        order = np.argsort(body.centres[:, 0])
        ax.plot([0, 56, 56, 80], [1, 1, 0, 0], color="black", lw=0.8)
        ax.plot(body.centres[order, 0], -body.stress[order, 0], ".-", ms=4, lw=1, color=colour)
        ax.set_title(label, loc="left", fontsize=9)
        ax.set(xlim=(10, 70), ylim=(-0.25, 1.4))
    figure.supylabel("stress over the exact one", fontsize=10)
    axes[-1].set_xlabel("distance from the wall, elements")
    return figure
