"""Pictures of the chapter on the contact problem before it is discretised."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE


def wall_terms(method, epsilon, K, f, h):
    """Add what a method puts on the gap, the first unknown, to the matrix of a bar (E = area = 1)."""
    gap = np.eye(len(f))[0]
    if method == "penalty":
        K = K + epsilon * np.outer(gap, gap)  # ½ ε g² (eq:continuum-penalty)
    if method == "nitsche":
        p = np.zeros(len(f))
        p[:2] = np.array([1.0, -1.0]) / h  # pressure of the element at the wall: p · u
        law = p - epsilon * gap
        # ((p - ε g)² - p²) / 2ε (eq:continuum-nitsche)
        K = K + (np.outer(law, law) - np.outer(p, p)) / epsilon
        if np.linalg.eigvalsh(K).min() <= 0.0:
            return None, f  # no minimum: the energy falls without limit
    if method == "multiplier":
        # one more unknown: U - p g (eq:continuum-multiplier)
        K = np.block([[K, -gap[:, None]], [-gap[None], np.zeros((1, 1))]])
        f = np.append(f, 0.0)
    return K, f


def pressed(method, stiffness, elements=10, pushed=-1.0):
    """Gap at the wall of a bar of length, stiffness and area 1 whose far end is pushed by `pushed`."""
    h = 1.0 / elements
    K = np.zeros((elements, elements))  # unknowns: all nodes but the pushed one
    f = np.zeros(elements)
    for e in range(elements):
        nodes = np.array([e, e + 1])
        block = np.array([[1.0, -1.0], [-1.0, 1.0]]) / h
        for i in range(2):
            for j in range(2):
                if nodes[i] == elements:
                    continue
                if nodes[j] == elements:
                    f[nodes[i]] -= block[i, j] * pushed
                else:
                    K[nodes[i], nodes[j]] += block[i, j]
    K, f = wall_terms(method, stiffness, K, f, h)
    return np.nan if K is None else np.linalg.solve(K, f)[0]


def three_ways():
    """Energy of a spring at a wall, and the gap that each way of enforcing contact leaves."""
    figure = Figure(figsize=(7.5, 3.8))
    energy, gap = figure.subplots(1, 2)
    g = np.linspace(-1.2, 1.0, 300)
    body = 0.5 * (g + 0.8) ** 2
    energy.plot(g, body, color="black", lw=1, label="body alone")
    for k in (1.0, 5.0, 50.0):
        total = body + 0.5 * k * np.minimum(g, 0) ** 2
        (line,) = energy.plot(g, total, label=f"with penalty {k:g}")
        energy.plot(-0.8 / (1 + k), total.min(), "o", color=line.get_color(), ms=5)
    energy.axvspan(-1.2, 0, color=GREY, alpha=0.15, lw=0)
    energy.plot(0, 0.32, "k*", ms=11)
    energy.set(xlabel="gap g", ylabel="energy", ylim=(0, 1.5), xlim=(-1.2, 1.0))
    energy.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    stiffness = np.geomspace(1, 1e8, 49)
    for method, name in (
        ("penalty", "penalty"),
        ("nitsche", "Nitsche"),
        ("multiplier", "multiplier"),
    ):
        off = [abs(pressed(method, k)) for k in stiffness]
        gap.loglog(stiffness, np.maximum(off, 1e-17), label=name)
    gap.axvline(10, color="black", ls=":", lw=1)
    gap.text(13, 1e-5, "E / h", rotation=90)
    gap.set(xlabel="ε / (E / L)", ylabel="|gap| / displacement", ylim=(1e-18, 10))
    gap.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    return figure


def laws():
    """The pressure that each law allows at a gap."""
    figure = Figure(figsize=(7.5, 3.6))
    ax = figure.subplots()
    g = np.linspace(-0.6, 1.0, 400)
    for epsilon in (2.0, 5.0, 20.0):
        ax.plot(g, epsilon * np.maximum(-g, 0), color=BLUE, lw=1.4)
    near = np.linspace(1e-3, 0.4, 400)
    for epsilon in (0.5, 2.0):
        p = epsilon * (2 * (near - 0.4) * np.log(near / 0.4) + (near - 0.4) ** 2 / near)
        ax.plot(near, p, color=GREEN, lw=1.4)
    for constant in (0.4, 0.8, 1.2):
        ax.plot(g, constant + 2.5 * g, color=ORANGE, ls=":", lw=1.4)
        ax.plot(0, constant, "o", color=ORANGE, ms=6)
    ax.plot([0, 0, 1], [2, 0, 0], color="black", lw=2.6)
    ax.text(-0.58, 1.3, "penalties", color=BLUE)
    ax.text(0.27, 0.5, "barriers", color=GREEN)
    ax.text(0.55, 1.35, "Nitsche: p − εg = const", color=ORANGE)
    ax.text(0.45, 0.1, "exact condition, multiplier")
    ax.set(xlabel="gap g / h", ylabel="pressure p", xlim=(-0.6, 1), ylim=(-0.1, 2), yticks=[0])
    return figure
