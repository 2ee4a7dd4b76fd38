"""Pictures of the chapters on meshes, bricks, masses, time steps, energy and sums."""

import numpy as np
from libcontact._core import ffi, lib
from matplotlib.figure import Figure

import libcontact as ct

BLUE, ORANGE, GREEN, RED, GREY = "#3b8bd4", "#e8762b", "#3fa34d", "#d64550", "#8a8a8a"
KIND = {"hex8": lib.CT_HEX8, "hex20": lib.CT_HEX20}
CORNERS = np.array(
    [
        [-1, -1, -1],
        [1, -1, -1],
        [1, 1, -1],
        [-1, 1, -1],
        [-1, -1, 1],
        [1, -1, 1],
        [1, 1, 1],
        [-1, 1, 1],
    ],
    dtype=float,
)
EDGES = [(i, (i + 1) % 4) for i in range(4)]
EDGES += [(4 + i, 4 + j) for i, j in EDGES] + [(i, 4 + i) for i in range(4)]
NODES = {
    "hex8": CORNERS,
    "hex20": np.concatenate([CORNERS, [(CORNERS[i] + CORNERS[j]) / 2 for i, j in EDGES]]),
}


# -- Elements, from the shape functions of the library ---------------------------------------------


def shape(kind, xi):
    """Shape functions (nodes,) at a point."""
    N = np.zeros(20)
    lib.ct_brick_shape(
        KIND[kind], ffi.from_buffer("double[]", np.array(xi, float)), ffi.from_buffer("double[]", N)
    )
    return N[: len(NODES[kind])]


def gradient(kind, xi):
    """Their derivatives (nodes, 3) by the reference coordinates."""
    dN = np.zeros((20, 3))
    lib.ct_brick_gradient(
        KIND[kind],
        ffi.from_buffer("double[]", np.array(xi, float)),
        ffi.cast("double(*)[3]", ffi.from_buffer(dN)),
    )
    return dN[: len(NODES[kind])]


def rule(count):
    """Points and weights of Gauss's rule with `count` points along each axis."""
    x, w = np.polynomial.legendre.leggauss(count)
    return np.stack(np.meshgrid(x, x, x, indexing="ij"), -1).reshape(-1, 3), np.einsum(
        "i,j,k", w, w, w
    ).ravel()


def strains(kind, nodes, xi):
    """B (6, 3 nodes): engineering strains xx yy zz xy yz zx from the displacements; and det J."""
    dN = gradient(kind, xi)
    J = nodes.T @ dN
    slope = dN @ np.linalg.inv(J)
    B = np.zeros((6, len(nodes), 3))
    for i in range(3):
        j = (i + 1) % 3
        B[i, :, i] = slope[:, i]
        B[3 + i, :, i], B[3 + i, :, j] = slope[:, j], slope[:, i]
    return B.reshape(6, -1), np.linalg.det(J)


def moduli(young=1.0, poisson=0.0):
    lame, mu = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    return np.diag([2 * mu] * 3 + [mu] * 3) + lame * np.pad(np.ones((3, 3)), (0, 3))


def stiffness(kind, nodes, points, C):
    """Stiffness (3 nodes, 3 nodes) of an element by `points` Gauss points along each axis."""
    K = np.zeros((3 * len(nodes),) * 2)
    for xi, w in zip(*rule(points)):
        B, det = strains(kind, nodes, xi)
        K += w * det * B.T @ C @ B
    return K


def axes3(figure, place, **view):
    ax = figure.add_subplot(place, projection="3d", computed_zorder=False)
    ax.view_init(**({"elev": 18, "azim": -64} | view))
    ax.set_axis_off()
    return ax


def draw_edges(ax, corners, **style):
    for i, j in EDGES:
        ax.plot(*corners[[i, j]].T, **({"color": GREY, "lw": 1.1} | style))


# -- Material --------------------------------------------------------------------------------------


def waves():
    """Particles of a body in the two kinds of plane wave."""
    figure = Figure(figsize=(7.5, 3.0))
    x, y = np.meshgrid(np.linspace(0, 6, 61), np.linspace(0, 1, 9))
    pulse = lambda s: 0.32 * np.exp(-((s - 3) ** 2) / 0.35)
    for ax, (name, dx, dy) in zip(
        figure.subplots(2, 1, sharex=True),
        (("dilatation wave, $c_1$", pulse(x), 0 * x), ("shear wave, $c_2$", 0 * x, pulse(x))),
    ):
        ax.plot((x + dx).ravel(), (y + dy).ravel(), ".", ms=3.2, color=BLUE)
        ax.annotate("", (5.4, 1.55), (4.4, 1.55), arrowprops={"arrowstyle": "-|>", "lw": 1.5})
        ax.annotate(
            "",
            (3.0 + (0.35 if dx.any() else 0), 1.38 + (0 if dx.any() else 0.42)),
            (3.0 - (0.35 if dx.any() else 0), 1.38),
            arrowprops={"arrowstyle": "<|-|>", "lw": 1.5, "color": ORANGE},
        )
        ax.text(0, 1.45, name)
        ax.text(5.5, 1.55, "runs", va="center")
        ax.text(3.5, 1.55, "moves", va="center", color=ORANGE)
        ax.set(ylim=(-0.1, 1.9), aspect="equal")
        ax.set_axis_off()
    return figure


# -- Mesh ------------------------------------------------------------------------------------------


def maps():
    """The upper side of three hex20 bricks: lines of constant reference coordinates, and where the determinant is negative."""
    bricks = []
    for move in (
        {},
        {6: (1.25, 1.3), 18: (1.12, 1.15), 13: (1.22, 0.1), 14: (0.1, 1.3)},
        {14: (0.72, 1.0)},
    ):
        nodes = NODES["hex20"].copy()
        for node, xy in move.items():
            nodes[node, :2] = xy
        bricks.append(nodes)
    figure = Figure(figsize=(7.5, 2.7))
    t = np.linspace(-1, 1, 41)
    for ax, nodes, title in zip(
        figure.subplots(1, 3),
        bricks,
        ("reference cube", "a brick of the mesh", "mid-side node too far"),
    ):
        xi = np.stack(np.meshgrid(t, t), -1)
        xi = np.concatenate([xi, np.ones_like(xi[..., :1])], -1)
        place = np.array([[shape("hex20", p) @ nodes for p in row] for row in xi])
        det = np.array([[np.linalg.det(nodes.T @ gradient("hex20", p)) for p in row] for row in xi])
        for k in range(0, 41, 5):
            for line in (place[k], place[:, k]):
                ax.plot(
                    *line[:, :2].T,
                    color="black" if k in (0, 40) else GREY,
                    lw=1.3 if k in (0, 40) else 0.6,
                )
        ax.plot(*place[det < 0][:, :2].T, "s", ms=3, color=RED)
        top = [4, 5, 6, 7, 12, 13, 14, 15]
        ax.plot(*nodes[top][:, :2].T, "o", ms=5, color=BLUE)
        ax.set(title=title, aspect="equal", xlim=(-1.3, 1.5), ylim=(-1.3, 1.5))
        ax.set_axis_off()
    return figure


# -- Mass ------------------------------------------------------------------------------------------


def masses():
    """Shares of a cube's mass at its nodes: hex8, and hex20 by row sum and by scaling; areas are shares."""
    figure = Figure(figsize=(7.5, 3.4))
    points, weights = rule(3)
    for place, kind, name in (
        (131, "hex8", "row sum"),
        (132, "hex20", "row sum"),
        (133, "hex20", "scaled diagonal"),
    ):
        N = np.array([shape(kind, xi) for xi in points])
        m = weights @ (N if name == "row sum" else N**2)
        m /= m.sum()
        ax = axes3(figure, place)
        draw_edges(ax, CORNERS)
        for node, share in zip(NODES[kind], m):
            ax.plot(
                *node, "o", ms=34 * abs(share) ** 0.5, color=RED if share < 0 else BLUE, alpha=0.85
            )
        label = f"corner {m[0]:+.3f}" + ("" if kind == "hex8" else f"\nmiddle {m[8]:+.3f}")
        ax.set_title(f"{kind}, {name}", pad=14)
        ax.text2D(0.5, -0.02, label, transform=ax.transAxes, ha="center", va="top")
        ax.set_box_aspect((1, 1, 1), zoom=0.9)
    return figure


# -- Bricks ----------------------------------------------------------------------------------------


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
        for k, n in NODES.items()
    }
    for kind, style, colour in (("hex8", "-", BLUE), ("hex20", "--", "black")):
        stress = [
            (moduli() @ strains(kind, NODES[kind], (x, g, 0))[0] @ bent[kind].ravel())[3] for x in t
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
        ax = axes3(figure, place, elev=20, azim=-58)
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
    ax.legend(fontsize=8, loc="lower right", bbox_to_anchor=(1.06, 1.0), handletextpad=0.1)
    return figure


def cube(kind, n):
    """Nodes of a unit cube of n³ bricks, their numbers in each brick, and the bricks' reference nodes on it."""
    local = np.rint(NODES[kind] + 1).astype(int)
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
    """Gradient of the harmonic function exp(√2 x) sin y sin z: in equilibrium in any linear material; and its strains."""
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
    """Errors of displacement, and of stress at centres and at Gauss points, of a cube whose surface is displaced; over the largest."""
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


# -- Time steps ------------------------------------------------------------------------------------


def oscillator():
    """The leapfrog on one oscillator for four steps."""
    figure = Figure(figsize=(7.5, 3.6))
    t = np.linspace(0, 20, 401)
    for ax, step in zip(figure.subplots(2, 2, sharex=True).flat, (0.5, 1.2, 1.9, 2.05)):
        v, u = 0.5 * step, [1.0]
        for _ in range(int(20 / step)):
            v -= step * u[-1]
            u.append(u[-1] + step * v)
        ax.plot(t, np.cos(t), color=GREY, lw=1)
        ax.plot(step * np.arange(len(u)), u, "o-", ms=3, lw=0.9, color=BLUE if step <= 2 else RED)
        ax.set_title(f"ω Δt = {step}")
    figure.supxlabel("ω t", fontsize=10)
    figure.supylabel("displacement", fontsize=10)
    return figure


def radii():
    """Moduli of the two roots of the leapfrog, and how much too fast it vibrates, over ωΔt."""
    figure = Figure(figsize=(7.5, 2.8))
    left, right = figure.subplots(1, 2)
    x = np.linspace(0.01, 2.6, 521)
    for damping, colour in ((0.0, BLUE), (0.1, ORANGE), (0.3, GREEN)):
        d = 2 * damping * x
        roots = np.array([np.roots([1, -(2 - a - b), 1 - a]) for a, b in zip(d, x**2)])
        left.plot(x, np.abs(roots).max(axis=1), color=colour, label=f"damping {damping:.0%}")
        limit = 4 / (2 * damping + np.sqrt(4 * damping**2 + 4))
        left.plot(limit, 1, "o", color=colour, ms=5)
    left.axhline(1, color="black", lw=0.7)
    left.set(xlabel="ω Δt", ylabel="largest |λ|", ylim=(0.5, 2.2))
    left.legend(fontsize=9)
    x = x[x <= 2]
    right.plot(x, 2 * np.arcsin(x / 2) / x, color=BLUE, label="leapfrog")
    right.plot(x, 1 + x**2 / 24, "--", color=GREY, label="1 + (ωΔt)²/24")
    right.set(xlabel="ω Δt", ylabel="computed / true frequency")
    right.legend(fontsize=9)
    return figure


def cube_scene(cells, poisson, assembled=False):
    scene = ct.Scene(title="cube", units={"length": "m", "mass": "kg", "time": "s"})
    scene.add_material("elastic", young=1.0, poisson=poisson, density=1.0)
    box = {"origin": [0, 0, 0], "size": [cells] * 3, "cells": [cells] * 3}
    scene.add_body("cube", material="elastic", box=box, velocity=[1, 0, 0])
    extra = {"stable_step": "assembled"} if assembled else {}
    return scene.set_time(end=1.0, fraction=0.9, **extra)


def bounds():
    """c₁Δt/h of cubes of n³ equal bricks: by single bricks, by blocks, and the limit of the assembled matrix."""
    figure = Figure(figsize=(6.4, 3.0))
    ax = figure.subplots()
    counts = np.array([1, 2, 3, 4, 5, 6, 8])
    for poisson, colour in ((0.0, BLUE), (0.3, ORANGE)):
        c1 = ((1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))) ** 0.5
        step = lambda n, **extra: (
            c1 * cube_scene(int(n), poisson, **extra).explain().data["time"]["stable"]
        )
        one = step(1)
        ax.plot(
            counts, np.full(len(counts), one), ":", color=colour, label=f"ν = {poisson}: one brick"
        )
        ax.plot(
            counts, [step(n) for n in counts], "s", color=colour, ms=6, label="blocks of bricks"
        )
        ax.plot(
            counts,
            [step(n, assembled=True) for n in counts],
            "-",
            color=colour,
            lw=1,
            label="assembled matrix",
        )
    ax.set(xlabel="bricks per edge of the cube", ylabel="$c_1 \\Delta t / h$", ylim=(0.65, 1.04))
    ax.legend(fontsize=9, loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


def drift():
    """Total energy of a bar that hits a wall: two laws of contact, two steps."""
    figure = Figure(figsize=(7.5, 2.8))
    for ax, fraction in zip(figure.subplots(1, 2, sharey=True), (0.3, 0.95)):
        for law, colour, name in (
            ("penalty", RED, "explicit penalty"),
            ("energy_controlled", BLUE, "energy-controlled"),
        ):
            scene = ct.Scene(
                title="bar on a wall", units={"length": "m", "mass": "kg", "time": "s"}
            )
            scene.add_material("elastic", young=1.0, poisson=0.0, density=1.0)
            box = {"origin": [0.02, 0, 0], "size": [1, 0.05, 0.05], "cells": [40, 1, 1]}
            scene.add_body("bar", material="elastic", box=box, velocity=[-1, 0, 0])
            scene.add(
                "obstacle",
                surface="bar.x_min",
                plane={"point": [0, 0, 0], "normal": [1, 0, 0]},
                enforcement=law,
                beta=1.0,
            )
            scene.set_time(end=2.6, fraction=fraction).set_output(every=1, fields=[])
            run = scene.run(progress=False, output=False)
            ax.plot(
                run.time,
                100 * (run.energy["total"] / run.energy["total"][0] - 1),
                color=colour,
                label=name,
            )
        ax.set(title=f"{fraction} of the stable step", xlabel="time c t / L")
    figure.axes[0].set_ylabel("change of the total, %")
    figure.axes[0].legend(fontsize=9)
    return figure


# -- Sums ------------------------------------------------------------------------------------------


def orders():
    """Errors of plain sums of the same numbers in many orders, and of the order-free sum."""
    rng = np.random.default_rng(3)
    terms = rng.random(4096)
    exact = float(sum(int(t * 2**60) for t in terms) / 2**60)
    plain, free = [], []
    for _ in range(400):
        rng.shuffle(terms)
        plain.append(float(np.cumsum(terms)[-1]) - exact)
        free.append(lib.ct_sum(ffi.from_buffer("double[]", terms), len(terms)) - exact)
    unit = float(np.spacing(exact))
    figure = Figure(figsize=(6.4, 2.6))
    ax = figure.subplots()
    values = np.array(plain) / unit
    ax.hist(
        values,
        bins=np.arange(values.min() - 0.5, values.max() + 1.5),
        color=ORANGE,
        label="one after another",
    )
    ax.axvline(np.unique(free)[0] / unit, color=BLUE, lw=3, label="on two grids: all 400 orders")
    assert len(np.unique(free)) == 1
    ax.set(xlabel="error, in units of the last digit", ylabel="orders of 400")
    ax.legend(fontsize=9)
    return figure
