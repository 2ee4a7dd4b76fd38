"""Picture of the chapter on the contact in another program."""

from matplotlib.figure import Figure
from shared.drawing import BLUE, GREEN, GREY, ORANGE

# What each side does in one step, in rows from top to bottom.
HOST = {
    0: "forces of the elements, loads: $\\mathbf{f}_n$",
    1: "call ct_contact_step",
    3: "stop on an error",
    4: "call ct_contact_add_force",
    5: "$\\mathbf{v}_{n+1/2} = \\mathbf{v}_{n-1/2} + \\tau\\,\\mathbf{M}^{-1}(\\mathbf{f}_n + \\mathbf{f}^c_n)$\n"
    "$\\mathbf{x}_{n+1} = \\mathbf{x}_n + \\Delta t\\,\\mathbf{v}_{n+1/2}$",
}
CONTACT = {
    1: "closest points, normals,\ngaps $g_n$",
    2: "motion without contact,\nmotion by a unit force",
    3: "forces λ and friction of\nall points together",
    4: "sum over the points\nof each node",
    5: "",
}
# What passes between them: row, whether it goes to the contact, and what it is.
PASSED = (
    (
        1,
        True,
        "$\\mathbf{x}_n,\\ \\mathbf{v}_{n-1/2},\\ \\mathbf{f}_n,\\ \\mathbf{M}^{-1},\\ \\Delta t,\\ \\tau$",
    ),
    (3, False, "status, error"),
    (4, True, "$\\mathbf{f}_n$"),
    (5, False, "$\\mathbf{f}_n + \\mathbf{f}^c_n$"),
)


def sequence():
    """One step of a host: what it calls when, and what passes between it and the contact."""
    figure = Figure(figsize=(7.5, 4.6))
    ax = figure.subplots()
    lanes = ((0.0, HOST, BLUE, "your program"), (3.4, CONTACT, ORANGE, "the contact"))
    boxes = {}
    for x, entries, colour, name in lanes:
        ax.text(x, 0.62, name, color=colour, ha="center", weight="bold")
        ax.plot([x, x], [0.5, -5.3], color=GREY, lw=0.8, ls=":", zorder=0)
        for row, text in entries.items():
            box = {"boxstyle": "round,pad=0.4", "fc": "#fefefe", "ec": colour} if text else None
            boxes[x, row] = ax.text(x, -row, text, ha="center", va="center", bbox=box)
    arrow = {"arrowstyle": "-|>", "lw": 1.4}
    for row, there, text in PASSED:
        a, b = (lanes[0][0], lanes[1][0])[:: 1 if there else -1]
        patches = {
            "patchA": boxes[a, row].get_bbox_patch(),
            "patchB": boxes[b, row].get_bbox_patch(),
        }
        ends = {"xy": (b, -row), "xytext": (a, -row)}
        ax.annotate("", **ends, arrowprops=arrow | patches | {"color": GREEN})
        ax.text(1.62, 0.12 - row, text, ha="center", color=GREEN)
    left = -1.75
    ax.plot([-1.02, left, left], [-5, -5, 0], color="black", lw=1.2)  # back, to the next step
    patches = {"patchB": boxes[0.0, 0].get_bbox_patch(), "shrinkA": 0}
    ax.annotate("", (0, 0), (left, 0), arrowprops=arrow | patches | {"color": "black"})
    ax.text(left - 0.08, -2.5, "next step", rotation=90, va="center", ha="right")
    ax.set(xlim=(-2.1, 4.5), ylim=(-5.5, 0.9))
    ax.set_axis_off()
    return figure
