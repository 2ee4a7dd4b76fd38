"""Tables of methods, made when the book is built. ``.. integrator-table::`` prints the library's own table of
integrators; ``.. method-table::`` measures the projection methods.

Each row is a method of the compiled package: median evaluations on the ordinary faces of the bench, and the share of
the corpus of hard cases (``tests/data``) where it is right. Nothing is typed, so nothing can go stale. A book that is
built without the package says so in place of the table.
"""

from __future__ import annotations

import sys
from pathlib import Path

from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).resolve().parents[2]


def measure() -> tuple[list[tuple[str, float, float]], int]:
    """Rows of (method, evaluations, share that is right), and the number of cases."""
    sys.path.append(str(ROOT / "bench"))
    import faces
    from libcontact.projection import METHODS

    import libcontact

    found = {name: faces.side_by_side(libcontact, name) for name in METHODS}
    return [(name, calls, share) for name, (calls, share, _) in found.items()], next(
        iter(found.values())
    )[2]


class MethodTable(SphinxDirective):
    def run(self):
        for source in ("bench/faces.py", "tests/data/corpus.npz"):
            self.env.note_dependency(str(ROOT / source))
        try:
            rows, cases = measure()
        except ImportError as error:
            return self.parse_text_to_nodes(
                f"(This book was built without the Python package, so its table is missing here: {error}.)\n"
            )
        import libcontact._core

        self.env.note_dependency(libcontact._core.__file__)
        text = [
            ".. list-table:: Median evaluations on ordinary curved Q8 faces to :math:`10^{-10}`, and how many of "
            f"{cases} hard cases are answered right",
            "   :header-rows: 1",
            "   :widths: 40 30 30",
            "",
            "   * - method",
            "     - evaluations",
            "     - right",
        ]
        for name, calls, share in rows:
            percent = "100 %" if share == 1.0 else f"{100 * min(share, 0.9999):.2f} %"
            text += [f"   * - ``{name}``", f"     - {calls:g}", f"     - {percent}"]
        return self.parse_text_to_nodes("\n".join(text) + "\n")


class IntegratorTable(SphinxDirective):
    def run(self):
        try:
            from libcontact._core import ffi, lib
            from libcontact.model import INTEGRATORS
        except ImportError as error:
            return self.parse_text_to_nodes(f"(Made with the Python package: {error}.)\n")
        head = (
            "``integrator``",
            "parameter",
            "range",
            "usual",
            "order",
            "forces per step",
            "limit",
        )
        text = [".. list-table::", "   :header-rows: 1", "", *_row(head)]
        for name, scheme in INTEGRATORS.items():
            facts, own = lib.ct_integrator_facts(scheme), lib.ct_integrator_default(scheme)
            pointer, ranged = ffi.new("ct_integrator *", own), facts.most > facts.least
            parameter = ffi.string(facts.parameter).decode()
            text += _row(
                (
                    f"``{name}``",
                    f"``{parameter}``" if ranged else "none",
                    f"{facts.least:.4g} ... {facts.most:.4g}" if ranged else "",
                    f"{facts.usual:.4g}" if ranged else "",
                    facts.order,
                    lib.ct_integrator_evaluations(pointer),
                    f"{lib.ct_integrator_limit(pointer):.4g}",
                )
            )
        return self.parse_text_to_nodes("\n".join(text) + "\n")


def _row(cells):
    return [f"   {'*' if i == 0 else ' '} - {cell}".rstrip() for i, cell in enumerate(cells)]


def setup(app):
    app.add_directive("integrator-table", IntegratorTable)
    app.add_directive("method-table", MethodTable)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
