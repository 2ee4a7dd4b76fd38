"""The rooms of the C library, and the directive ``.. floors::`` that draws them from the includes.

FLOORS is the one table of floors and rooms: the picture and the table of ``develop/layers.rst`` are made from it, and
``tests/python/test_house.py`` checks the sources against it.
"""

from __future__ import annotations

import re
from pathlib import Path

from docutils import nodes
from docutils.parsers.rst import Directive

ROOT = Path(__file__).resolve().parents[2]
SOURCES = Path("libcontact/src")
HEADERS = Path("libcontact/include/libcontact")

# From the top down: the rooms of a floor, and what they know.
FLOORS = (
    ({"scene": "bodies, effects and time put together", "hdf5": "results files and restart"}),
    (
        {
            "effect": "solid, contact, support, motion, gravity, load, damping, viscosity, absorb, initial stress, tie, rigid",
            "dispersion": "waves of a mesh in space and time",
        }
    ),
    (
        {
            "step": "contract of effects, problem, state, time loop, energy, monitor, probes, pieces",
            "host": "contact in the time loop of a host",
        }
    ),
    ({"contact": "contract of interactions: surfaces in contact, obstacles, friction"}),
    ({"gap": "where the points of a surface are: closest points, candidates, depth, tunnelling"}),
    (
        {
            "solid": "elements and their kernels",
            "search": "which faces a point may meet",
            "constraint": "laws of contact and their solver",
        }
    ),
    (
        {
            "projection": "closest point of one face",
            "mesh": "bodies, materials, masses",
            "gsl": "modal series",
        }
    ),
    ({"shape": "faces, bricks, quadrature", "exact": "closed forms"}),
    ({"base": "status, errors, memory, sums"}),
)
FLOOR = {room: len(FLOORS) - i for i, rooms in enumerate(FLOORS) for room in rooms}
# Rooms without a public header: the calls of a host are in that of the contact.
WITHOUT_HEADER = {"gap", "host"}
# Public headers that are not called as their room.
ROOM_OF_HEADER = {
    "output": "hdf5",
    "series": "gsl",
    "ray": "projection",
    "batch": "projection",
    "problem": "step",
    "ledger": "step",
    "observe": "step",
    "piece": "step",
    "contact_result": "contact",
    "contact_effect": "effect",
}


def room_of_header(name: str) -> str:
    return ROOM_OF_HEADER.get(name, name)


def includes(root: Path = ROOT) -> list[tuple[str, str, str]]:
    """Every include from one room to another: the file, its room, the other room."""
    found = []
    files = [*(root / SOURCES).rglob("*.[ch]"), *(root / HEADERS).glob("*.h")]
    for file in sorted(files):
        public = file.parent == root / HEADERS
        room = room_of_header(file.stem) if public else file.relative_to(root / SOURCES).parts[0]
        for name in re.findall(r'^#include [<"](.*?)[>"]', file.read_text(encoding="utf-8"), re.M):
            if name.startswith("libcontact/"):
                other = room_of_header(Path(name).stem)
            elif name.startswith("../"):
                other = Path(name).parts[1]
            else:
                continue
            if other != room:
                found.append((file.relative_to(root).as_posix(), room, other))
    return found


def arrows(root: Path = ROOT) -> set[tuple[str, str]]:
    """Pairs of rooms of which the first includes the second."""
    return {(room, other) for _, room, other in includes(root)}


def upward(root: Path = ROOT) -> list[tuple[str, str, str]]:
    """Includes that do not look down."""
    return [entry for entry in includes(root) if FLOOR.get(entry[2], 99) >= FLOOR.get(entry[1], 0)]


def picture(root: Path = ROOT) -> str:
    """The floors as SVG: a box a room, a line an arrow."""
    width, high, box, room_height = 760, 78, 190, 34
    place = {}
    for i, rooms in enumerate(FLOORS):
        gap = width / len(rooms)
        for k, room in enumerate(rooms):
            place[room] = (gap * (k + 0.5), 12 + high * i)
    lines = [
        f'<line x1="{place[a][0]:.0f}" y1="{place[a][1] + room_height}" x2="{place[b][0]:.0f}" '
        f'y2="{place[b][1]}" stroke="#7a8fa6" stroke-width="1.2" marker-end="url(#head)"/>'
        for a, b in sorted(arrows(root))
        if b != "base"
    ]
    boxes = []
    for room, (x, y) in place.items():
        boxes.append(
            f'<rect x="{x - box / 2:.0f}" y="{y}" width="{box}" height="{room_height}" rx="5" '
            'fill="#f3f6fa" stroke="#35506b"/>'
            f'<text x="{x:.0f}" y="{y + 22}" text-anchor="middle" font-family="sans-serif" '
            f'font-size="15" fill="#14283c">{room}</text>'
        )
    height = 24 + high * (len(FLOORS) - 1) + room_height
    head = (
        '<defs><marker id="head" markerWidth="7" markerHeight="7" refX="6" refY="3" orient="auto">'
        '<path d="M0,0 L6,3 L0,6 z" fill="#7a8fa6"/></marker></defs>'
    )
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" '
        f'aria-label="Rooms of the library and their includes" style="max-width:100%">'
        + head
        + "".join(lines + boxes)
        + "</svg>"
    )


class Floors(Directive):
    """``.. floors::``: the picture, and the table of floors."""

    def run(self) -> list[nodes.Node]:
        env = self.state.document.settings.env
        for file in (ROOT / SOURCES).rglob("*.[ch]"):
            env.note_dependency(str(file))
        table = nodes.table()
        group = nodes.tgroup(cols=3)
        table += group
        for size in (8, 18, 74):
            group += nodes.colspec(colwidth=size)
        head, body = nodes.thead(), nodes.tbody()
        group += head
        group += body
        head += self.row(("floor", "room", "what it knows"))
        for i, rooms in enumerate(FLOORS):
            for room, knows in rooms.items():
                body += self.row((str(len(FLOORS) - i), room, knows))
        return [nodes.raw("", picture(), format="html"), table]

    @staticmethod
    def row(cells: tuple[str, ...]) -> nodes.row:
        row = nodes.row()
        for cell in cells:
            row += nodes.entry("", nodes.paragraph("", cell))
        return row


def setup(app):
    app.add_directive("floors", Floors)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
