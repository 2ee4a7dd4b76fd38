"""Pictures of the chapter on the forces of bricks."""

import numpy as np
from matplotlib.figure import Figure
from shared.bricks import BRICKS, CORNERS, draw_edges, moduli, rule, shape, stiffness, strains
from shared.drawing import BLUE, GREEN, GREY, ORANGE, axes_in_space


def bending():
    """A cube with eight nodes that is bent: its shape, and the shear stress that it should not have."""
    figure = Figure(figsize=(7.5, 2.9))
    ax, right = figure.subplots(1, 2, width_ratios=[1, 1.25])
    kappa, t = 0.35, np.linspace(-1, 1, 41)
    true = lambda x, y: np.array([x - kappa * x * y, y + kappa * (x**2 - 1) / 2])
    for y in (-1, 1):
        ax.plot(*true(t, y * np.ones(41)), "--", color=GREY)
    for x in (-1, 1):
        ax.plot(*true(x * np.ones(41), t), "--", color=GREY)
    corner = np.array([true(*c) for c in ((-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1))])
    ax.plot(*corner.T, "o-", color=BLUE, ms=5)
    g = 1 / 3**0.5
    for x in (-g, g):
        for y in (-g, g):
            ax.plot(x - kappa * x * y, y, "s", color=ORANGE, ms=6)
    ax.plot(0, 0, "o", color=GREEN, ms=7)
    ax.set(aspect="equal", title="blue: hex8, dashed: bent body")
    ax.set_axis_off()
    bent = {
        k: np.column_stack([-n[:, 0] * n[:, 1], (n[:, 0] ** 2) / 2, 0 * n[:, 0]])
        for k, n in BRICKS.items()
    }
    for kind, style, colour in (("hex8", "-", BLUE), ("hex20", "--", "black")):
        stress = [
            (moduli() @ strains(kind, BRICKS[kind], (x, g, 0))[0] @ bent[kind].ravel())[3]
            for x in t
        ]
        right.plot(t, stress, style, color=colour, label=kind)
    for x in (-g, g):
        right.plot(x, -x / 2, "s", color=ORANGE, ms=6, label="Gauss points" if x < 0 else None)
    right.plot(0, 0, "o", color=GREEN, ms=7, label="centre")
    right.set(xlabel="ξ₁", ylabel="shear stress / (E κ h/2)")
    right.legend(fontsize=9)
    return figure


def zero_modes():
    """Motions of a hex8 without strain at its centre, and the eigenvalues with one and with eight points."""
    figure = Figure(figsize=(7.5, 2.9))
    x, y, z = CORNERS.T
    for place, mode in ((141, y * z), (142, z * x), (143, x * y * z)):
        ax = axes_in_space(figure, place, elev=20, azim=-58)
        draw_edges(ax, CORNERS, ls=":")
        draw_edges(ax, CORNERS + 0.45 * np.outer(mode, [1, 0, 0]), color=ORANGE, lw=1.8)
        assert (
            np.abs(strains("hex8", CORNERS, (0, 0, 0))[0] @ np.outer(mode, [1, 0, 0]).ravel()).max()
            < 1e-15
        )
        ax.set_box_aspect((1, 1, 1), zoom=0.95)
        ax.set_title(
            {
                141: "$u_1 = \\xi_2\\xi_3$",
                142: "$u_1 = \\xi_3\\xi_1$",
                143: "$u_1 = \\xi_1\\xi_2\\xi_3$",
            }[place],
            pad=12,
        )
    ax = figure.add_subplot(144)
    for points, style, name in ((1, "o", "1 point"), (2, "s", "8 points")):
        w = np.linalg.eigvalsh(stiffness("hex8", CORNERS, points, moduli(1, 0.3)))
        ax.semilogy(
            np.arange(1, 25),
            np.maximum(w, 1e-3),
            style,
            ms=3.5,
            label=f"{name}: {(w < 1e-9).sum()} zero",
        )
    ax.set(xlabel="eigenvalue no.", yticks=[1e-3, 1e-2, 1e-1, 1, 10])
    ax.set_yticklabels(["0", "0.01", "0.1", "1", "10"])
    ax.legend(fontsize=9, loc="lower right", bbox_to_anchor=(1.08, 1.0), handletextpad=0.1)
    return figure


def cube(kind, n):
    """Nodes of a unit cube of n³ bricks, their numbers in each brick, and the bricks' reference nodes on it."""
    local = np.rint(BRICKS[kind] + 1).astype(int)
    number, nodes, elements = {}, [], []
    for cell in np.ndindex(n, n, n):
        own = []
        for at in local:
            key = tuple(2 * np.array(cell) + at)
            if key not in number:
                number[key] = len(nodes)
                nodes.append(np.array(key) / (2 * n))
            own.append(number[key])
        elements.append(own)
    return np.array(nodes), np.array(elements)


def smooth(x):
    """Gradient of the harmonic function exp(√2 x) sin y sin z: in equilibrium in any linear material; and its
    strains."""
    a = 2**0.5
    e, s, c = np.exp(a * x[..., 0]), np.sin(x), np.cos(x)
    u = e[..., None] * np.stack(
        [a * s[..., 1] * s[..., 2], c[..., 1] * s[..., 2], s[..., 1] * c[..., 2]], -1
    )
    strain = e[..., None] * np.stack(
        [
            2 * s[..., 1] * s[..., 2],
            -s[..., 1] * s[..., 2],
            -s[..., 1] * s[..., 2],
            2 * a * c[..., 1] * s[..., 2],
            2 * c[..., 1] * c[..., 2],
            2 * a * s[..., 1] * c[..., 2],
        ],
        -1,
    )
    return u, strain


def solved(kind, n):
    """Errors of displacement, and of stress at centres and at Gauss points, of a cube whose surface is displaced; over
    the largest."""
    nodes, elements = cube(kind, n)
    C, points = moduli(1, 0.3), 2 if kind == "hex8" else 3
    K = np.zeros((3 * len(nodes),) * 2)
    own = stiffness(kind, nodes[elements[0]], points, C)
    for element in elements:
        d = (3 * element[:, None] + np.arange(3)).ravel()
        K[np.ix_(d, d)] += own
    u = smooth(nodes)[0].ravel()
    free = np.repeat(((nodes > 0) & (nodes < 1)).all(axis=1), 3)
    exact = u.copy()
    if free.any():
        u[free] = -np.linalg.solve(K[np.ix_(free, free)], K[np.ix_(free, ~free)] @ u[~free])
    off = {"displacement": np.sqrt(np.mean((u - exact) ** 2))}
    size = np.sqrt(np.mean((C @ smooth(np.random.default_rng(1).random((500, 3)))[1].T) ** 2))
    for name, xis in (("centre", np.zeros((1, 3))), ("Gauss points", rule(points)[0])):
        error = []
        for element in elements:
            d = (3 * element[:, None] + np.arange(3)).ravel()
            for xi in xis:
                here = shape(kind, xi) @ nodes[element]
                error.append(C @ (strains(kind, nodes[element], xi)[0] @ u[d] - smooth(here)[1]))
        off[name] = np.sqrt(np.mean(np.square(error))) / size
    return off


def convergence():
    """Errors of the stress over the size of the bricks."""
    figure = Figure(figsize=(6.4, 3.2))
    ax = figure.subplots()
    for kind, counts, colour in (("hex8", (1, 2, 3, 4, 6), BLUE), ("hex20", (1, 2, 3, 4), ORANGE)):
        found = [solved(kind, n) for n in counts]
        for name, style in (("Gauss points", "s-"), ("centre", "o--")):
            error = [f[name] for f in found]
            ax.loglog(
                1 / np.array(counts), error, style, color=colour, ms=5, label=f"{kind}, {name}"
            )
            order = np.log(error[-2] / error[-1]) / np.log(counts[-1] / counts[-2])
            ax.text(
                0.96 / counts[-1], error[-1], f"{order:.1f}", ha="right", va="center", color=colour
            )
    ax.set(xlabel="size of the bricks h", ylabel="error of the stress", xlim=(0.13, 1.1))
    ax.set_xticks([1 / 6, 1 / 4, 1 / 3, 1 / 2, 1], ["1/6", "1/4", "1/3", "1/2", "1"])
    ax.minorticks_off()
    ax.legend(fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure
