"""Pictures of the chapters on integrators, masses, loads, supports, dashpots, large strain and reduced integration."""

import warnings

import numpy as np
from libcontact.mesh import Mesh
from matplotlib.figure import Figure

import libcontact as ct

BLUE, ORANGE, GREEN, RED, VIOLET, GREY = (
    "#3b8bd4",
    "#e8762b",
    "#3fa34d",
    "#d64550",
    "#9b6fd0",
    "#8a8a8a",
)


def scene_of(young=1.0, poisson=0.0, density=1.0, **law):
    """A scene with one material, "elastic", and no body yet."""
    scene = ct.Scene(title="picture", units={"length": "m", "mass": "kg", "time": "s"})
    return scene.add_material("elastic", young=young, poisson=poisson, density=density, **law)


def bar(scene, cells=100, length=1.0, sides=True, **keys):
    """A bar along x of cubes, one across; its sides are held, so that it is a row of masses and springs."""
    edge = length / cells
    box = {"origin": [0, 0, 0], "size": [length, edge, edge], "cells": [cells, 1, 1]}
    scene.add_body("bar", material="elastic", box=box, **keys)
    for face in ("y_min", "y_max", "z_min", "z_max") if sides else ():
        scene.add_support(f"bar.{face}", fix="yz")
    return scene


def done(scene):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that ω Δt near the limit is a coarse step, and the like
        return scene.run(progress=False, output=False)


# -- Integrators -----------------------------------------------------------------------------------

SCHEMES = {
    "central_difference": ("central difference", 2.0),
    "chung_lee": ("Chung, Lee", 28 / 27),
    "noh_bathe": ("Noh, Bathe", 0.54),
    "tchamwa_wielgosz": ("Tchamwa, Wielgosz", 0.9),
    "pushforward_pullback": ("pushforward, pullback", 0.7),
}


def stretch(view):
    """Forces that pull the two ends of a free cube apart at t = 0 and never again."""
    force = np.zeros_like(view.reference)
    if view.time == 0.0:
        force[:, 0] = 1e-6 * (view.reference[:, 0] - 0.5)
    return force


def free_cube(integrator, fraction, softer=1.0, steps=40):
    """
    The stretch of a free cube over its steps, and Ω = ω Δt. With E = ρ = h = 1 the motion has ω = 2. A second cube, of this stiffness and at rest, sets the
    stable step; the first one may be softer.
    """
    scene = bar(scene_of(young=softer), cells=1)
    scene.add_material("stiff", young=1.0, poisson=0.0, density=1.0)
    box = {"origin": [3, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
    scene.add_body("clock", material="stiff", box=box)
    scene.add_effect("kick", "bar", np.arange(8), stretch)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    scene.set_time(end=1.0, fraction=fraction, integrator=integrator)
    dt = fraction * scene.explain().data["time"]["stable"]
    scene.set_time(end=steps * dt, dt=dt, integrator=integrator, energy_limit=1e9)
    run = done(scene)
    return run.probes["end"]["displacement"][:, 0], 2 * np.sqrt(softer) * run.dt


def found_roots(u, count):
    """Factors of the motion per step, from the recurrence u_{n+count} = Σ c_i u_{n+i} that the steps obey."""
    rows = np.stack([u[i : len(u) - count + i] for i in range(count)], axis=1)
    c = np.linalg.lstsq(rows, u[count:], rcond=1e-11)[0]
    return np.roots(np.concatenate([[1.0], -c[::-1]]))


def amplification(integrator, omega, push=None):
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
    if integrator == "pushforward_pullback":
        mu = parameter / 6 * (push**2 - 1)
        step = np.zeros((3, 3))
        step[:2, :2] = [[1 - x - mu * (1 + push) * x**2 / 2, 1 + mu * x], [-x, 1]]
    return step


def principal(roots):
    """The root that belongs to the oscillation: the largest of those with an angle, or of all."""
    turning = roots[np.abs(roots.imag) > 1e-9]
    return max(turning if len(turning) else roots, key=abs)


def radii():
    """Spectral radius and error of the period: eigenvalues of the amplification matrix, and those found from runs of the library."""
    figure = Figure(figsize=(7.5, 3.8))
    radius, period = figure.subplots(1, 2)
    colours = (GREY, BLUE, ORANGE, GREEN, VIOLET)
    limits = (2.0, 1.867, 3.745, 1.902, 1.0)
    for (name, (label, _)), colour, limit in zip(SCHEMES.items(), colours, limits, strict=True):
        two = 2.0 if name == "noh_bathe" else 1.0  # two evaluations of the forces in a step
        push = 2.0 if name == "pushforward_pullback" else None
        omega = np.linspace(0.02, limit, 300)
        roots = [np.linalg.eigvals(amplification(name, w, push)) for w in omega]
        largest = np.array([np.abs(r).max() for r in roots])
        radius.plot(omega / two, largest, color=colour, label=label)
        angle = np.array([abs(np.angle(principal(r))) for r in roots])
        turns = np.flatnonzero(np.diff(angle) <= 1e-9)
        end = turns[0] if len(turns) else len(omega)
        period.plot(omega[:end] / two, 100 * (omega[:end] / angle[:end] - 1), color=colour, lw=1.4)
        for part in (0.15, 0.3, 0.45, 0.6, 0.75, 0.9):
            # The push is twice the step at half of the stable step.
            u, found = free_cube(name, 0.5, part**2) if push else free_cube(name, part)
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
    figure = Figure(figsize=(7.5, 5.2))
    axes = figure.subplots(5, 1, sharex=True, sharey=True)
    colours = (GREY, BLUE, ORANGE, GREEN, VIOLET)
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


# -- Loads, supports, weight -----------------------------------------------------------------------

AMPLITUDES = {
    "step": ([0.0], [1.0]),
    "ramp": ([0.0, 1.0], [0.0, 1.0]),
    "pulse": ([0.0, 0.5, 1.0], [0.0, 1.0, 0.0]),
    "jump": ([1.0, 1.0], [0.0, 1.0]),
}


def amplitudes():
    """Four amplitudes of a load at the end of a long bar, and the velocity of this end in runs of the library."""
    figure = Figure(figsize=(7.5, 3.6))
    axes = figure.subplots(2, 4, sharex=True, sharey="row")
    t = np.linspace(-0.5, 2, 501)
    for column, (name, (time, value)) in enumerate(AMPLITUDES.items()):
        axes[0, column].plot(t, np.interp(t, time, value) if name != "jump" else 1.0 * (t >= 1))
        axes[0, column].plot(time, value, "o", ms=5)
        axes[0, column].set_title(name)
        scene = bar(scene_of(), cells=150, length=3.0)
        scene.add(
            "load",
            surface="bar.x_max",
            traction=[1.0, 0, 0],
            history={"time": time, "value": value},
        )
        scene.add_probe("end", body="bar", point=[3, 0, 0], quantities=["velocity"])
        run = done(scene.set_time(end=2.0, fraction=0.9))
        axes[1, column].plot(
            run.probes["end"]["time"], run.probes["end"]["velocity"][:, 0], color=ORANGE, lw=1.2
        )
        axes[1, column].set_xlabel("time")
    axes[0, 0].set(ylabel="amplitude φ", ylim=(-0.1, 1.3), xlim=(-0.5, 2))
    axes[1, 0].set(ylabel="velocity of the end", ylim=(-0.2, 1.5))
    return figure


def nodal_forces():
    """Share of the nodes in a uniform traction on the two faces of bricks, from the library: masses times first accelerations."""
    figure = Figure(figsize=(7.5, 2.9))
    for ax, element in zip(figure.subplots(1, 2), ("hex8", "hex20"), strict=True):
        scene = scene_of()
        box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
        scene.add_body("cube", material="elastic", element=element, box=box)
        scene.add("load", surface="cube.z_max", traction=[0, 0, 1.0])
        run = done(scene.set_time(end=1e-3, dt=1e-3))
        body = run.state["cube"]
        place = body.mesh.nodes
        corners = np.isin(place, (0.0, 1.0)).all(axis=1)
        mass = np.full(len(place), 1 / 8)
        if element == "hex20":
            mass = np.where(corners, 7 / 248, 2 / 31)
        # From rest, one step gives the velocity f Δt / m half a step later.
        force = mass * body.displacement[:, 2] / (0.5 * run.dt**2)
        top = np.flatnonzero(np.abs(place[:, 2] - 1) < 1e-9)
        ax.fill([0, 1, 1, 0], [0, 0, 1, 1], color=GREY, alpha=0.15)
        for n in top:
            up = force[n] > 0
            colour = BLUE if up else RED
            ax.plot(*place[n, :2], "o", ms=6, color=colour)
            inwards = np.array([0.34, 0.2]) * (np.array([0.5, 0.5]) - place[n, :2])
            ax.text(*(place[n, :2] + inwards), f"{force[n]:+.3f}", ha="center", va="center")
        ax.set(title={"hex8": "Q4", "hex20": "Q8"}[element], aspect="equal")
        ax.set(xlim=(-0.1, 1.1), ylim=(-0.1, 1.1))
        ax.set_axis_off()
    return figure


def fall():
    """A stone thrown up: twelve long steps on the parabola, and its energies."""
    scene = scene_of(young=100.0)
    box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
    scene.add_body("stone", material="elastic", box=box, velocity=[0, 0, 5])
    scene.add("gravity", acceleration=[0, 0, -10])
    scene.add_probe("stone", body="stone", point=[0, 0, 0], quantities=["displacement"])
    run = done(scene.set_time(end=1.0, dt=1 / 12).set_output(every=1))
    figure = Figure(figsize=(7.5, 3.0))
    height, energy = figure.subplots(1, 2)
    t = np.linspace(0, 1, 201)
    height.plot(t, 5 * t - 5 * t**2, color="black", lw=1, label="v₀t − ½gt²")
    height.plot(run.probes["stone"]["time"], run.probes["stone"]["displacement"][:, 2], "o")
    height.set(xlabel="time", ylabel="height")
    height.legend(loc="lower center")
    for name, colour in (("kinetic", BLUE), ("gravity", ORANGE), ("total", "black")):
        energy.plot(run.energy["time"], run.energy[name], ".-", color=colour, label=name, lw=1)
    energy.axhline(12.5, color=GREY, lw=1, ls="--", label="½mv₀²")
    energy.set(xlabel="time", ylabel="energy")
    energy.legend(loc="center")
    return figure


def reaction():
    """The force of a rigid wall on a bar that flies against it, over ρ c v₀ A, and the impulse of the support."""
    scene = bar(scene_of(), cells=100, velocity=[-1, 0, 0])
    scene.add_support("bar.x_min", fix="x")
    scene.add_probe("wall", resultant="support[4]", body="bar", quantities=["force"])
    run = done(scene.set_time(end=1.8, fraction=0.5))
    figure = Figure(figsize=(7.5, 2.9))
    force, impulse = figure.subplots(1, 2)
    t, f = run.probes["wall"]["time"], run.probes["wall"]["force"][:, 0] / 1e-4
    force.plot(t, f, lw=1)
    force.plot([0, 1.8], [1, 1], color="black", lw=1)
    force.set(xlabel="time c t / L", ylabel="reaction / ρ c v₀ A", ylim=(-0.1, 1.7))
    impulse.plot(t, np.cumsum(f) * run.dt)
    impulse.plot([0, 1.8], [0, 1.8], color="black", lw=1)
    impulse.set(xlabel="time c t / L", ylabel="its impulse / ρ A L v₀")
    return figure


def pushed(time, value):
    """A long bar whose end follows a path: displacement and force of the end."""
    scene = bar(scene_of(), cells=100, length=2.0)
    history = {"time": time, "value": value}
    scene.add_support("bar.x_min", fix="x", travel=[0.1, 0, 0], history=history)
    scene.add_probe("end", body="bar", point=[0, 0, 0], quantities=["displacement"])
    scene.add_probe("force", resultant="support[4]", body="bar", quantities=["force"])
    run = done(scene.set_time(end=1.8, fraction=0.7))
    end, force = run.probes["end"], run.probes["force"]
    return end["time"], end["displacement"][:, 0], force["time"], force["force"][:, 0] / 4e-4


def paths():
    """Two paths of the end of a bar, with straight lines and rounded, and the forces that they take."""
    figure = Figure(figsize=(7.5, 3.4))
    place, force = figure.subplots(2, 1, sharex=True)
    t = np.linspace(0, 1, 81)
    smooth = (t - np.sin(2 * np.pi * t) / (2 * np.pi)).tolist()
    for label, time, value, colour in (
        ("straight", [0.0, 1.0], [0.0, 1.0], ORANGE),
        ("rounded", t.tolist(), smooth, BLUE),
    ):
        when, u, then, f = pushed(time, value)
        place.plot(when, u, color=colour, label=label)
        force.plot(then, f, color=colour, lw=1.2)
    place.set(ylabel="displacement")
    place.legend(loc="lower right")
    force.set(xlabel="time", ylabel="force / ρ c² A", ylim=(-0.15, 0.35))
    return figure


# -- Dashpots --------------------------------------------------------------------------------------


def decay(young, rate):
    """The fraction of critical damping of a cube that swings along its length, from the peaks of a run, and its ω."""
    scene = bar(scene_of(young=young), cells=1, velocity=[1e-3, 0, 0])
    scene.add_support("bar.x_min", fix="x").add("damping", rate=rate)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    omega = np.sqrt(2 * young)
    run = done(scene.set_time(end=40 / omega, dt=0.02 / omega))
    u = run.probes["end"]["displacement"][:, 0]
    peaks = np.flatnonzero((u[1:-1] > u[:-2]) & (u[1:-1] > u[2:])) + 1
    fall = np.log(u[peaks[0]] / u[peaks[-1]]) / (len(peaks) - 1) / (2 * np.pi)
    return omega, fall / np.sqrt(1 + fall**2)


def ratios():
    """The ratio of damping of modes: in proportion to mass, to stiffness, and both."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    omega, rate, slow = np.geomspace(0.3, 30, 201), 0.2, 0.01
    ax.loglog(omega, rate / (2 * omega), label="α M", color=BLUE)
    ax.loglog(omega, slow * omega / 2, label="β K", color=ORANGE)
    ax.loglog(omega, rate / (2 * omega) + slow * omega / 2, "k--", lw=1, label="α M + β K")
    found = np.array([decay(young, rate) for young in (0.2, 1, 5, 25, 125)])
    ax.loglog(*found.T, "o", color=BLUE, label="α M, runs")
    ax.set(xlabel="ω of the mode", ylabel="ratio of damping ζ", xlim=(0.3, 30), ylim=(1e-3, 1))
    ax.legend(loc="center left")
    return figure


def to_rest():
    """A bar that hangs at one end and gets its weight at once: without damping, with three rates, and relaxed."""
    figure = Figure(figsize=(7.5, 3.4))
    ax = figure.subplots()
    lowest = np.pi / 2  # of a bar with ρ = c = L = 1
    for label, keys, colour in (
        ("no damping", None, GREY),
        ("α = 0.4 ω₁", {"rate": 0.4 * lowest}, BLUE),
        ("α = 2 ω₁", {"rate": 2 * lowest}, ORANGE),
        ("α = 10 ω₁", {"rate": 10 * lowest}, GREEN),
        ("relaxation", {"relaxation": True}, RED),
    ):
        scene = bar(scene_of(), cells=20)
        scene.add_support("bar.x_min", fix="x").add("gravity", acceleration=[1e-3, 0, 0])
        if keys:
            scene.add("damping", **keys)
        scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
        run = done(scene.set_time(end=16.0, fraction=0.9))
        u = run.probes["end"]["displacement"][:, 0] / 0.5e-3
        ax.plot(run.probes["end"]["time"], u, label=label, color=colour, lw=1.4)
    ax.axhline(1.0, color="black", lw=0.8)
    ax.set(xlabel="time c t / L", ylabel="displacement of the end / at rest", ylim=(-0.05, 2.4))
    ax.legend(ncols=3, loc="upper right")
    return figure


def reflected(angle, poisson):
    """Amplitudes of the P and S waves that :eq:`absorb-traction` sends back, for a P wave of amplitude 1."""
    ratio = np.sqrt((1 - 2 * poisson) / (2 - 2 * poisson))  # c₂ / c₁
    p, s = angle, np.arcsin(ratio * np.sin(angle))
    found = []
    for a, b in zip(np.atleast_1d(p), np.atleast_1d(s), strict=True):
        # Waves exp i(k·x - ωt) with c₁ = ω = ρ = 1; the boundary x = 0 has the normal (1, 0).
        kz = np.sin(a)
        waves = (
            ((np.cos(a), kz), (np.cos(a), np.sin(a))),
            ((-np.cos(a), kz), (-np.cos(a), np.sin(a))),
            ((-np.cos(b) / ratio, kz), (np.sin(b), np.cos(b))),
        )
        rows = []
        for (kx, _), (ux, uz) in waves:
            normal = kx * ux + (1 - 2 * ratio**2) * kz * uz  # σxx / i
            shear = ratio**2 * (kz * ux + kx * uz)  # σxz / i
            rows.append((normal - ux, shear - ratio * uz))  # σ + ρ c v, v = -iu
        come, *back = np.array(rows)
        found.append(np.linalg.solve(np.array(back).T, -come))
    found = np.array(found)
    energy = found[:, 0] ** 2 + found[:, 1] ** 2 * ratio * np.cos(s) / np.cos(p)
    return found, energy


def oblique(half, wave, length=300, poisson=0.25):
    """
    Energy that an absorbing end of a plane strip sends back. The strip lies between two planes of symmetry at the distance `half`, so that its P waves of
    the length `wave` run at the angle arcsin(wave / 2 half) to its axis; all in elements.
    """
    young = (1 + poisson) * (1 - 2 * poisson) / (1 - poisson)
    scene = scene_of(young, poisson)
    box = {"origin": [0, 0, 0], "size": [length, 1, half], "cells": [length, 1, half]}
    scene.add_body("strip", material="elastic", box=box)
    for face in ("x_min", "y_min", "y_max", "z_min", "z_max"):
        scene.add_support(f"strip.{face}", fix=face[0])
    scene.add("absorb", surface="strip.x_max")
    angle = np.arcsin(wave / (2 * half))
    omega, turn, wide = 2 * np.pi / wave, np.pi / half, wave / 4
    pulse = 12 * wave

    def push(view):
        # Forces without curl, the gradient of ψ = g(x) cos(kz), send P waves only.
        x, _, z = view.reference.T
        g = np.exp(-((x / wide) ** 2))
        shape = np.sin(np.pi * view.time / pulse) ** 2 if view.time < pulse else 0.0
        edge = np.where((z == 0) | (z == half), 0.5, 1.0) * 0.5  # mass of the nodes
        force = np.zeros_like(view.reference)
        force[:, 0] = -2 * x / wide**2 * g * np.cos(turn * z)
        force[:, 2] = -turn * g * np.sin(turn * z)
        return 1e-6 * np.sin(omega * view.time) * shape * edge[:, None] * force

    cells = (length, 1, half)
    near = np.flatnonzero(Mesh.box("hex8", [0, 0, 0], cells, cells).nodes[:, 0] < 3 * wide)
    scene.add_effect("source", "strip", near, push)
    there = length / np.cos(angle)
    scene.set_output(times=[pulse, pulse + 2.6 * there], fields=[])
    run = done(scene.set_time(end=pulse + 2.6 * there, fraction=0.9))
    held = run.energy["kinetic"] + run.energy["strain"]
    share = held[-1] / held[np.searchsorted(run.energy["time"], 0.999 * pulse)]
    # The pulse is a sum of waves of many frequencies, each with its own angle.
    w = np.linspace(1.001 * turn, 2 * omega, 800)
    t = np.linspace(0, pulse, 801)
    signal = np.sin(omega * t) * np.sin(np.pi * t / pulse) ** 2
    spectrum = np.abs(np.exp(1j * np.outer(w, t)) @ signal) ** 2
    along = np.sqrt(w**2 - turn**2)
    weight = w**3 * spectrum * np.exp(-((along * wide) ** 2) / 2) / along
    expected = (weight * reflected(np.arcsin(turn / w), poisson)[1]).sum() / weight.sum()
    return angle, share, expected


def reflection():
    """What an absorbing boundary sends back of a P wave, against the angle."""
    figure = Figure(figsize=(7.5, 3.4))
    amplitude, energy = figure.subplots(1, 2)
    angle = np.linspace(0, np.radians(89.5), 180)
    for poisson, style in ((0.25, "-"), (0.4, "--")):
        back, share = reflected(angle, poisson)
        amplitude.plot(
            np.degrees(angle), np.abs(back[:, 0]), style, color=BLUE, label=f"P, ν = {poisson}"
        )
        amplitude.plot(
            np.degrees(angle), np.abs(back[:, 1]), style, color=ORANGE, label=f"S, ν = {poisson}"
        )
        energy.plot(np.degrees(angle), share, style, color="black", label=f"formula, ν = {poisson}")
    runs = np.array([oblique(*strip) for strip in ((24, 24), (17, 24), (15, 25), (14, 25.5))])
    at = np.degrees(runs[:, 0])
    energy.plot(at, runs[:, 1], "o", color=RED, label="runs of pulses, ν = 0.25")
    energy.plot(at, runs[:, 2], "s", mfc="none", color=BLUE, ms=9, label="formula for the pulses")
    amplitude.set(
        xlabel="angle of incidence, degrees", ylabel="amplitude", xlim=(0, 90), ylim=(0, 1.05)
    )
    energy.set(
        xlabel="angle of incidence, degrees",
        ylabel="reflected energy",
        xlim=(0, 90),
        ylim=(0, 1.05),
    )
    amplitude.legend(loc="upper left")
    energy.legend(loc="upper left")
    return figure


def viscous_pressure(speed, linear, quadratic):
    """Pressure of the bulk viscosity of a cube whose ends approach each other at this speed, from one step of the library."""
    scene = bar(scene_of(), cells=1, velocity=[-speed, 0, 0])
    scene.add_support("bar.x_min", fix="x")
    scene.add("viscosity", linear=linear, quadratic=quadratic)
    scene.add_probe("end", body="bar", point=[1, 0, 0], quantities=["displacement"])
    run = done(scene.set_time(end=1e-4, dt=1e-4))
    # From t = 0 the end, half of the mass, has gained half a kick of the pressure; the stress is of higher order.
    return (run.probes["end"]["displacement"][1, 0] / run.dt + speed) / run.dt


def viscosity_law():
    """The pressure of the bulk viscosity over the closing speed of an element."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    x = np.linspace(-0.03, 0.1, 261)
    knee, a, closing = 0.03 / 1.44, 1.44, np.maximum(x, 0)
    parabola = np.where(closing <= knee, a * closing**2, a * knee * (2 * closing - knee))
    ax.axvline(knee, color=GREY, lw=0.8)
    ax.text(knee + 0.001, 0.0105, "$x_*$")
    ax.plot(x, 0.06 * closing, label="linear part, Q₁ = 0.06")
    ax.plot(x, parabola, label="quadratic part, Q₂ = 1.2")
    ax.plot(closing, a * closing**2, "--", color=GREY, lw=1, label="parabola without limit")
    ax.plot(x, 0.06 * closing + parabola, color="black", label="both")
    at = np.array([-0.02, 0.01, 0.02, 0.04, 0.06, 0.08])
    for linear, quadratic, colour in ((0.06, 0.0, BLUE), (0.0, 1.2, ORANGE), (0.06, 1.2, "black")):
        found = [viscous_pressure(speed, linear, quadratic) for speed in at]
        ax.plot(at, found, "o", color=colour, ms=4)
    ax.set(xlabel="closing speed  l|D| / c₁  (left of 0: expansion)", ylabel="q / ρ c₁²")
    ax.set(ylim=(-0.0005, 0.0115), xlim=(-0.03, 0.1))
    ax.legend(loc="upper left")
    return figure


def shock():
    """The front in a rod of cubes that hits a wall at 5 % of c, after 120 cubes, with bulk viscosity of different strength."""
    figure = Figure(figsize=(7.5, 4.4))
    axes = figure.subplots(4, 1, sharex=True, sharey=True)
    for ax, (linear, quadratic), colour in zip(
        axes, ((0, 0), (0.06, 0), (0.06, 1.2), (0.5, 0)), (GREY, BLUE, ORANGE, GREEN), strict=True
    ):
        scene = bar(scene_of(), cells=160, length=160.0, velocity=[-0.05, 0, 0])
        scene.add_support("bar.x_min", fix="x")
        if linear:
            scene.add("viscosity", linear=linear, quadratic=quadratic)
        body = done(scene.set_time(end=120.0, courant=0.2)).state["bar"]
        order = np.argsort(body.centres[:, 0])
        ax.plot([60, 120, 120, 150], [1, 1, 0, 0], color="black", lw=0.8)
        ax.plot(
            body.centres[order, 0], -body.stress[order, 0] / 0.05, ".-", ms=4, lw=1, color=colour
        )
        ax.set_title(f"Q₁ = {linear}, Q₂ = {quadratic}", loc="left", fontsize=9)
        ax.set(xlim=(70, 140), ylim=(-0.15, 1.4))
    figure.supylabel("stress over the exact one", fontsize=10)
    axes[-1].set_xlabel("distance from the wall, elements")
    return figure


# -- One point per element -------------------------------------------------------------------------

CUBE = np.array([[i, j, k] for k in (-1, 1) for j in (-1, 1) for i in (-1, 1)], dtype=float)
PATTERNS = {"ηζ": (1, 2), "ζξ": (2, 0), "ξη": (0, 1), "ξηζ": (0, 1, 2)}


def hourglasses():
    """The four patterns of hourglass modes of a brick, here as displacements along x."""
    figure = Figure(figsize=(7.5, 2.2), layout="none")
    edges = [(a, b) for a in range(8) for b in range(a) if np.abs(CUBE[a] - CUBE[b]).sum() == 2]
    for column, (name, axes) in enumerate(PATTERNS.items()):
        ax = figure.add_subplot(1, 4, column + 1, projection="3d", computed_zorder=False)
        ax.view_init(elev=20, azim=-68)
        ax.set_axis_off()
        moved = CUBE.copy()
        moved[:, 0] += 0.45 * CUBE[:, axes].prod(axis=1)
        for nodes, colour, width in ((CUBE, GREY, 0.6), (moved, ORANGE, 1.6)):
            for a, b in edges:
                ax.plot(*nodes[[a, b]].T, color=colour, lw=width)
        ax.plot(*moved.T, "o", color="black", ms=3)
        ax.set_title(f"$u_x$ = a {name}", fontsize=10)
        ax.set_box_aspect((1, 1, 1), zoom=1.25)
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.9, wspace=0)
    return figure


def frequency(pattern, integration, kappa=1.0):
    """ω² h² ρ / E of a free cube that swings in an hourglass mode along x, from a run."""
    scene = scene_of()
    box = {"origin": [-1, -1, -1], "size": [2, 2, 2], "cells": [1, 1, 1]}
    keys = {"integration": integration}
    if integration == "reduced":
        keys["hourglass"] = kappa
    scene.add_body("bar", material="elastic", box=box, **keys)

    def kick(view):
        force = np.zeros_like(view.reference)
        if view.time == 0.0:
            force[:, 0] = 1e-6 * view.reference[:, PATTERNS[pattern]].prod(axis=1)
        return force

    scene.add_effect("kick", "bar", np.arange(8), kick)
    scene.add_probe("corner", body="bar", point=[1, 1, 1], quantities=["displacement"])
    run = done(scene.set_time(end=20.0, dt=0.25))
    root = found_roots(run.probes["corner"]["displacement"][2:, 0], 2)
    return 4 * (2 * np.sin(np.abs(np.angle(root[0])) / 2) / run.dt) ** 2


def stiffness():
    """The stiffness of the hourglass modes over Q, as frequencies of a cube, beside full integration."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    kappa = np.linspace(0, 1.6, 50)
    ax.plot(kappa, 4 / 3 * kappa, color="black", lw=1, label="closed form, 4Q/3")
    at = (0.1, 0.3, 0.6, 1.0, 1.5)
    for name, mark, colour in (("ηζ", "o", ORANGE), ("ξη", "s", BLUE), ("ξηζ", "^", GREEN)):
        runs = [frequency(name, "reduced", k) for k in at]
        ax.plot(
            at,
            runs,
            mark,
            color=colour,
            mfc="none",
            ms=5 + 3 * (mark == "s"),
            label=f"{name}, one point",
        )
        if name != "ηζ":  # with full integration this one is part of a mode along x, y and z
            full = frequency(name, "full")
            ax.axhline(full, color=colour, lw=1, ls="--", label=f"{name}, full: {full:.2f}")
    ax.set(
        xlabel="hourglass coefficient Q", ylabel="ω² ρ h² / E of the mode along x", xlim=(0, 1.6)
    )
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def deflection(cells, kappa):
    """End deflection of a cantilever of length 10 and height 1 with ν = 0, over Timoshenko's; full integration if Q is None."""
    scene = scene_of()
    size = [10.0, 1 / cells, 1.0]
    box = {"origin": [0, 0, 0], "size": size, "cells": [10 * cells, 1, cells]}
    keys = {} if kappa is None else {"integration": "reduced", "hourglass": kappa}
    scene.add_body("beam", material="elastic", box=box, **keys)
    scene.add_support("beam.x_min", fix="xyz")
    scene.add_support("beam.y_min", fix="y").add_support("beam.y_max", fix="y")
    scene.add("load", surface="beam.x_max", traction=[0, 0, 1e-6]).add("damping", relaxation=True)
    scene.add_probe("end", surface="beam.x_max", quantities=["displacement"])
    run = done(scene.set_time(end=3e4, fraction=0.9, until_static=1e-4))
    exact = 1e-6 * (10**3 / 3 * 12 + 10 * 2 * 6 / 5)
    return run.probes["end"]["displacement"][-1, 2] / exact


def bending():
    """Deflection of cantilevers with one, two and four cubes through the height, over Q."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    kappa = np.linspace(0.05, 1.5, 100)
    for cells, colour in ((1, ORANGE), (2, BLUE), (4, GREEN)):
        ax.plot(
            kappa,
            1 / (1 - (1 - kappa) / cells**2),
            color=colour,
            label=f"{cells} through the height",
        )
        ax.plot((0.3, 1.0), [deflection(cells, k) for k in (0.3, 1.0)], "o", color=colour, ms=5)
        ax.plot(1.45, deflection(cells, None), "D", color=colour, ms=6)
    ax.text(1.4, 1.2, "full integration", ha="center")
    ax.axhline(1.0, color="black", lw=0.8)
    ax.set(
        xlabel="hourglass coefficient Q",
        ylabel="deflection / beam theory",
        ylim=(0, 4),
        xlim=(0, 1.55),
    )
    ax.legend(loc="upper right")
    return figure


# -- Large strain ----------------------------------------------------------------------------------


def stress_at(law, gradient, poisson=0.3):
    """Cauchy's stress over E of a cube with this displacement gradient: one step of forces m u / (Δt²/2) leads there from rest."""
    gradient = np.asarray(gradient, dtype=float)
    scene = scene_of(poisson=poisson, **law)
    box = {"origin": [0, 0, 0], "size": [1, 1, 1], "cells": [1, 1, 1]}
    scene.add_body("cube", material="elastic", box=box)
    dt = 1e-3

    def force(view):
        return (view.time == 0.0) * (view.reference @ gradient.T) / 8 * 2 / dt**2

    scene.add_effect("there", "cube", np.arange(8), force)
    return done(scene.set_time(end=dt, dt=dt, energy_limit=1e12)).state["cube"].stress[0]


LAWS = {
    "Hooke, small strain": ({}, GREY),
    "St. Venant-Kirchhoff": ({"law": "st_venant_kirchhoff"}, BLUE),
    "neo-Hookean": ({"law": "neo_hookean"}, ORANGE),
}


def turning():
    """Stress of a cube that only turns, and strains of a bar that is stretched."""
    figure = Figure(figsize=(7.5, 3.2))
    turn, strain = figure.subplots(1, 2)
    angle = np.linspace(0, 180, 181)
    lame, shear = 0.3 / (1.3 * 0.4), 1 / 2.6
    swell = 1 - np.cos(np.radians(angle))
    turn.plot(
        angle, -(2 * lame + 2 * shear) * swell, color=GREY, lw=1, label="Hooke: −2(Λ+μ)(1−cos φ)"
    )
    for name, (law, colour) in LAWS.items():
        at = np.arange(15, 181, 30.0)
        found = []
        for a in np.radians(at):
            gradient = [[np.cos(a) - 1, -np.sin(a), 0], [np.sin(a), np.cos(a) - 1, 0], [0, 0, 0]]
            found.append(stress_at(law, gradient)[0])
        turn.plot(at, found, "o", color=colour, ms=7 if "St" in name else 4, label=name)
    turn.set(xlabel="angle of rotation, degrees", ylabel="σxx / E", xlim=(0, 180))
    turn.legend(loc="lower left", fontsize=8)
    a = np.linspace(0.05, 2, 200)
    for label, value, colour in (
        ("small strain, a − 1", a - 1, GREY),
        ("Green–Lagrange, (a² − 1)/2", (a**2 - 1) / 2, BLUE),
        ("logarithm, ln a", np.log(a), GREEN),
    ):
        strain.plot(a, value, color=colour, label=label)
    strain.set(xlabel="stretch a", ylabel="strain", xlim=(0, 2), ylim=(-2, 1.6))
    strain.legend(loc="lower right", fontsize=8)
    return figure


def stretching():
    """Force per undeformed area of a bar whose sides are held, over its stretch."""
    figure = Figure(figsize=(7.5, 3.2))
    ax = figure.subplots()
    a = np.linspace(0.12, 1.8, 300)
    lame, shear = 0.3 / (1.3 * 0.4), 1 / 2.6
    stiff = lame + 2 * shear
    closed = (stiff * (a - 1), stiff / 2 * a * (a**2 - 1), shear * (a - 1 / a) + lame * (a - 1))
    for (name, (law, colour)), force in zip(LAWS.items(), closed, strict=True):
        ax.plot(a, force, color=colour, label=name)
        at = (0.25, 0.4, 0.577, 0.8, 1.0, 1.3, 1.6)
        found = [stress_at(law, np.diag([stretch - 1, 0, 0]))[0] for stretch in at]
        ax.plot(at, found, "o", color=colour, ms=4)
    ax.axvline(1 / np.sqrt(3), color=BLUE, lw=0.8, ls="--")
    ax.text(1 / np.sqrt(3) + 0.01, 1.2, "1/√3", color=BLUE)
    ax.set(xlabel="stretch a", ylabel="P / E", ylim=(-3, 2), xlim=(0, 1.8))
    ax.legend(loc="lower right")
    return figure


# -- Averaged mass ---------------------------------------------------------------------------------


def masses():
    """Phase velocity of P waves with three masses at a Courant number of 0.5, along an axis and across, and two fronts."""
    figure = Figure(figsize=(7.5, 5.4))
    grid = figure.add_gridspec(2, 2, height_ratios=[1, 0.9])
    axis, across = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[0, 1])
    part = np.linspace(0.005, 0.5, 150)
    for ax, way, title in (
        (axis, [1.0, 0.0, 0.0], "along an axis"),
        (across, [0.5**0.5, 0.0, 0.5**0.5], "at 45°"),
    ):
        wave = 2 * np.pi * part[:, None] * way
        for mass, colour in (("lumped", GREY), ("consistent", ORANGE), ("averaged", BLUE)):
            courant = 0.0 if mass == "consistent" else 0.5
            speed = ct.dispersion(wave, mass=mass, courant=courant).phase[:, 2]
            ax.plot(part, speed, color=colour, label=mass)
        ax.axhline(1.0, color="black", lw=0.8)
        ax.set(title=title, xlabel="edges in a wave length, h/λ", ylim=(0.5, 1.35), xlim=(0, 0.5))
    axis.set_ylabel("phase velocity / c₁")
    across.legend(loc="upper left")
    front = figure.add_subplot(grid[1, :])
    for averaged, colour, label in ((False, GREY, "lumped"), (True, BLUE, "averaged")):
        scene = bar(scene_of(), cells=100, length=100.0, velocity=[-1, 0, 0])
        scene.add_support("bar.x_min", fix="x")
        if averaged:
            scene.add("averaging")
        body = done(scene.set_time(end=56.0, courant=0.5)).state["bar"]
        order = np.argsort(body.centres[:, 0])
        front.plot(
            body.centres[order, 0],
            -body.stress[order, 0],
            ".-",
            ms=4,
            lw=1,
            color=colour,
            label=label,
        )
    front.plot([0, 56, 56, 80], [1, 1, 0, 0], color="black", lw=0.8)
    front.set(
        xlabel="distance from the wall, elements",
        ylabel="stress / exact",
        xlim=(20, 66),
        ylim=(-0.1, 1.4),
    )
    front.legend(loc="lower left")
    return figure
