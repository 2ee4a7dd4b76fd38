"""The page ``trace.html``: each computed equation of the book with the line that its page quotes and the tests that
name it.

``.. trace::`` becomes the tables. What an equation must have, and what is read, ``tracing.py`` says; the warnings are
of the type ``trace``: ``trace.code`` for an equation without a line or of an unknown class, ``trace.test`` for one
without a test, or a test that names an equation which no page defines.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import tracing
from docutils import nodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective
from weave import code_link, source_files, source_root

logger = logging.getLogger(__name__)


class trace_tables(nodes.General, nodes.Element):
    """Where the tables come when all pages are read."""


class Trace(SphinxDirective):
    def run(self) -> list[nodes.Node]:
        return [trace_tables()]


def read(app, env):
    """Read pages, sources and tests, and warn of what is missing."""
    pages = {name: Path(env.doc2path(name)) for name in chapters(env, env.config.root_doc)}
    root = source_root(app.config, env)
    app.traced, lost = tracing.trace(pages, root, app.config.trace_tests)
    for equation in app.traced.values():
        for subtype, text in equation.faults:
            where = (equation.page, equation.line)
            warn(subtype, f"the equation {equation.label} {text}", where)
    for label, where in lost:
        text = f"{where.function}() names the equation {label}, which no page defines"
        warn("test", text, f"{where.path}:{where.first}")
    for label, (page, _) in env.get_domain("math").equations.items():
        if page in pages and label not in app.traced:
            warn("code", f"the directive of the equation {label} is not understood", page)


def warn(subtype: str, text: str, location):
    logger.warning("trace: %s", text, location=location, type="trace", subtype=subtype)


def chapters(env, docname: str, seen=None) -> list[str]:
    """All pages in the order of the book."""
    seen = {} if seen is None else seen
    if docname not in seen:
        seen[docname] = True
        for child in env.toctree_includes.get(docname, ()):
            chapters(env, child, seen)
    return list(seen)


def page_with_tables(app, env):
    """It is written anew in each build: any page, source or test may have changed it."""
    return [name for name in [app.config.trace_page] if name in env.found_docs]


def fill(app, doctree, docname):
    for place in list(doctree.findall(trace_tables)):
        place.replace_self(tables(app, docname))


def tables(app, docname: str) -> list[nodes.Node]:
    """A table of counts, then for each chapter one of its computed equations."""
    by_page: dict[str, list[tracing.Equation]] = {}
    for equation in app.traced.values():
        by_page.setdefault(equation.page, []).append(equation)
    total, overview, parts = Counter(), [], []
    sources = set(source_files(app.config, app.env))
    for page, equations in by_page.items():
        count = tracing.counts(equations)
        total += count
        title = app.env.titles[page].astext()
        section_id = nodes.make_id(f"trace-{page}")
        link = nodes.reference("", title, refid=section_id, internal=True)
        overview.append([link, *(str(count[column]) for column in tracing.COLUMNS)])
        rows = [row(app, docname, e, sources) for e in equations if e.kind == "computed"]
        if rows:
            uri = app.builder.get_relative_uri(docname, page)
            heading = nodes.reference("", title, refuri=uri, internal=True)
            parts.append(nodes.rubric("", "", heading, ids=[section_id]))
            parts.append(table(["equation", "line", "tests", "executed"], rows, [20, 45, 25, 10]))
        else:
            overview[-1][0] = nodes.Text(title)
    overview.append(["all", *(str(total[column]) for column in tracing.COLUMNS)])
    return [table(["chapter", *tracing.COLUMNS], overview, [40, *[10] * 5]), *parts]


def row(app, docname: str, equation: tracing.Equation, sources: set[str]) -> list:
    """Number and label, the line, the tests, those that execute it."""
    env = app.env
    node_id = nodes.make_id(f"equation-{equation.label}")
    number = env.toc_fignumbers.get(equation.page, {}).get("displaymath", {}).get(node_id)
    text = f"({'.'.join(map(str, number))}) " if number else ""
    uri = f"{app.builder.get_relative_uri(docname, equation.page)}#{node_id}"
    name = nodes.reference("", "", refuri=uri, internal=True)
    name += [nodes.Text(text), nodes.literal("", equation.label)]
    code: list[nodes.Node] = []
    if equation.code:
        place, where = equation.code, nodes.literal("", position(equation.code))
        if place.path in sources and app.builder.format == "html":
            where = code_link(app, docname, place.path, place.first, where)
        code = [where, nodes.Text(" "), nodes.literal("", place.text)]
    tests = [f"{position(test)} {test.function}()" for test in equation.tests]
    return [
        name,
        code,
        [nodes.paragraph("", "", nodes.literal("", test)) for test in dict.fromkeys(tests)],
        "yes" if equation.executed else "",
    ]


def position(place: tracing.Place) -> str:
    return f"{place.path}:{place.first}"


def table(head: list[str], rows: list[list], widths: list[int]) -> nodes.table:
    group = nodes.tgroup(cols=len(head))
    group += [nodes.colspec(colwidth=width) for width in widths]
    group += nodes.thead("", line(head))
    group += nodes.tbody("", *map(line, rows))
    return nodes.table("", group, classes=["trace"])


def line(cells: list) -> nodes.row:
    """A row of the table; a cell is a text, a node or several."""
    made = nodes.row()
    for cell in cells:
        cell = [nodes.Text(cell)] if isinstance(cell, str) else cell
        cell = cell if isinstance(cell, list) else [cell]
        blocks = cell and isinstance(cell[0], nodes.paragraph)
        made += nodes.entry("", *(cell if blocks else [nodes.paragraph("", "", *cell)]))
    return made


def setup(app):
    app.setup_extension("weave")
    app.add_config_value("trace_page", "trace", "env")
    app.add_config_value("trace_tests", tracing.FOLDERS, "env")
    app.add_node(trace_tables)
    app.add_directive("trace", Trace)
    app.connect("env-updated", page_with_tables)
    app.connect("env-check-consistency", read)
    app.connect("doctree-resolved", fill)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
