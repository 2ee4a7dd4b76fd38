"""Picture of the chapter on the certified projection."""

import numpy as np
from matplotlib.figure import Figure
from shared.drawing import BLUE, GREY, ORANGE
from shared.faces import POINT, SQUARE, bent_face, coefficients, derivatives, squares

import libcontact as ct


def secant_bound(c, base, centre, w):
    """Gradient at the base, and the quadratic form that lies below f on the piece (certified-spread)."""
    d, t1, t2, t11, t22, t12 = derivatives(c, base)
    x, y = centre - base
    a1 = t1 + (x * t11 + y * t12) / 2 + x * y * c[6]
    a2 = t2 + (y * t22 + x * t12) / 2 + x * y * c[7]
    v = abs(x) * w + abs(y) * w + w * w
    m11 = a1 @ a1 + d @ (t11 + 2 * c[6] * y)
    m22 = a2 @ a2 + d @ (t22 + 2 * c[7] * x)
    m12 = a1 @ a2 + d @ t12
    m11 -= abs(a1 @ t11) * w + abs(a1 @ t12 + 2 * d @ c[6]) * w + 2 * abs(a1 @ c[6]) * v
    m22 -= abs(a2 @ t22) * w + abs(a2 @ t12 + 2 * d @ c[7]) * w + 2 * abs(a2 @ c[7]) * v
    spread = abs(a1 @ t22 + a2 @ t12) / 2 * w + abs(a1 @ t12 + a2 @ t11) / 2 * w
    spread += abs(a1 @ c[7] + a2 @ c[6]) * v
    g = 2 * np.array([d @ t1, d @ t2])
    return d @ d, g, m11, m22, abs(m12) + spread


def pieces(c, best, target):
    """The pieces of a face, each with the bound that settles it: 0 from the closest point, 1 from its own centre."""
    stack, done = [(np.zeros(2), 1.0)], []
    while stack:
        centre, w = stack.pop()
        _, _, m11, m22, twist = secant_bound(c, best, centre, w)
        if m11 >= 0 and m22 >= 0 and m11 * m22 >= twist**2:
            done.append((centre, w, 0))
            continue
        f, g, m11, m22, twist = secant_bound(c, centre, centre, w)
        worst = (m11 + m22) / 2 - np.hypot((m11 - m22) / 2, twist)
        if f - np.abs(g).sum() * w + min(worst, 0) * 2 * w**2 >= target:
            done.append((centre, w, 1))
            continue
        stack += [(centre + w / 2 * np.array(s), w / 2) for s in SQUARE[:4]]
        assert len(done) < 3000
    return done


def certificate():
    """A section of f with the parabola below it, and the pieces of a face with their bounds."""
    nodes = bent_face()
    best = ct.project("Q8", nodes, [POINT], method="certified").xi[0]
    c = coefficients(nodes, POINT)
    lowest_ = squares(nodes, POINT, best)
    target = (np.sqrt(lowest_) - 1e-6) ** 2
    figure = Figure(figsize=(7.5, 3.4))
    section, flat = figure.subplots(1, 2)
    across = np.linspace(-1, 1, 200)
    along = np.column_stack([across, np.full(200, best[1])])
    section.plot(across, squares(nodes, POINT, along), color="black", label="f")
    centre, w = np.array([0.75, best[1]]), 0.25
    f0, g, m11, _, _ = secant_bound(c, best, centre, w)
    x = np.linspace(0.5, 1, 50)
    bound = f0 + g[0] * (x - best[0]) + m11 * (x - best[0]) ** 2
    section.plot(x, bound, color=BLUE, label="from the closest point")
    centre = np.array([0.25, best[1]])
    f1, g, m11, _, _ = secant_bound(c, centre, centre, w)
    x = np.linspace(0, 0.5, 50)
    section.plot(
        x,
        f1 + g[0] * (x - centre[0]) + m11 * (x - centre[0]) ** 2,
        color=ORANGE,
        label="from the centre",
    )
    section.axhline(target, color=GREY, ls="--", lw=1, label="target")
    section.set(xlabel="ξ₁", ylabel="f", ylim=(0.8 * lowest_, 1.6 * lowest_))
    section.legend(fontsize=9)
    for centre, w, kind in pieces(c, best, target):
        corner = centre + w * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        colour = (BLUE, ORANGE)[kind]
        flat.fill(*corner.T, facecolor=colour, alpha=0.45, edgecolor="black", lw=0.4)
    flat.plot(*best, "*", color="black", ms=12)
    flat.set(xlabel="ξ₁", ylabel="ξ₂", aspect="equal", xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    flat.grid(False)
    return figure
