"""Quote C source in the book, and keep the links between code and equations whole.

::

    .. weave:: libcontact/src/mesh/mass.c ct_mass_element
       :doc:

    .. weave:: libcontact/src/mesh/mass.c "Scale the diagonal to the element's mass"

    .. weave:: libcontact/src/mesh/mass.c "ct_mass_element: Scale the diagonal to the element's mass"

The first form quotes a whole function, with ``:doc:`` also the comment before it. The others quote the fragment under
the heading comment ``// -- Scale the diagonal to the element's mass (eq:hrz)``: down to the next heading of the same
function or to the end of the block in which the heading stands. A heading that occurs twice in a file needs the name of
its function.

Every listing shows the lines' true numbers, and its caption links the file and the equations that the quoted comments
name. Below an equation stand the places in the code that name it. A build with ``-W`` fails when a file, function or
heading is gone or ambiguous, and when any comment under ``weave_sources``, quoted or not, names an equation
(``eq:label`` or ``:eq:`label```) that no page defines. (That two pages define one label is reported by Sphinx itself.)
"""

from __future__ import annotations

import textwrap
from pathlib import Path

from csource import Source, WeaveError
from docutils import nodes
from docutils.parsers.rst import directives
from sphinx import addnodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

logger = logging.getLogger(__name__)


def code_page(path: str) -> str:
    """Name of the page that shows the whole source file (written by ``codepages.py``)."""
    return f"_code/{path}"


def code_reference(docname: str, path: str, line: int) -> addnodes.pending_xref:
    """A link to a line of a source file, for ``resolve_code``."""
    text = f"{path}:{line}"
    return addnodes.pending_xref(
        "",
        nodes.literal(text, text),
        refdomain="",
        reftype="weave-code",
        reftarget=path,
        refdoc=docname,
        line=line,
        refexplicit=True,
    )


class Weave(SphinxDirective):
    """``.. weave:: path function`` or ``.. weave:: path "heading"``; see the top of the module."""

    required_arguments = 2
    final_argument_whitespace = True
    option_spec = {"doc": directives.flag}

    def run(self) -> list[nodes.Node]:
        path, what = self.arguments[0], self.arguments[1].strip()
        try:
            return [self.quote(path, what)]
        except (WeaveError, OSError, UnicodeError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            logger.warning("weave: %s %s", path, reason, location=self.get_location(), type="weave")
            return []

    def quote(self, path: str, what: str) -> nodes.Node:
        file = source_root(self.config, self.env) / path
        self.env.note_dependency(str(file))
        source = Source(file.read_text(encoding="utf-8"))
        span = source.quote(what, "doc" in self.options)
        first = span.first
        self.env.weave_quotes.setdefault(self.env.docname, set()).add((path, first, span.last))

        text = textwrap.dedent("\n".join(source.lines[first - 1 : span.last]))
        listing = nodes.literal_block(text, text, language="c", linenos=True, source=str(file))
        listing["highlight_args"] = {"linenostart": first}
        caption = nodes.caption("", "", code_reference(self.env.docname, path, first))
        caption += nodes.Text(f" {span.name}" if what.startswith('"') else f" {span.name}()")
        for i, label in enumerate(
            dict.fromkeys(label for label, _, _ in source.labels(first, span.last))
        ):
            caption += nodes.Text(", " if i else ": ")
            caption += addnodes.pending_xref(
                "",
                nodes.literal(label, label),
                refdomain="math",
                reftype="eq",
                reftarget=label,
                refdoc=self.env.docname,
                refexplicit=False,
                refwarn=True,
            )
        wrapper = nodes.container(
            "", caption, listing, literal_block=True, classes=["literal-block-wrapper", "weave"]
        )
        self.set_source_info(listing)
        self.set_source_info(caption)
        for node in caption.findall(addnodes.pending_xref):
            self.set_source_info(node)
        return wrapper


def source_root(config, env) -> Path:
    return (Path(env.srcdir) / config.weave_root).resolve()


def source_files(config, env) -> list[str]:
    """All C files under ``weave_sources``, relative to the root of the repository."""
    root = source_root(config, env)
    files = [
        f
        for folder in config.weave_sources
        for f in (root / folder).rglob("*")
        if f.suffix in (".c", ".h")
    ]
    return sorted(f.relative_to(root).as_posix() for f in files)


def scan_labels(app, env, added, changed, removed):
    """List all labels that the code names; pages whose equations are named from elsewhere than before are read
    again."""
    before, env.weave_labels = getattr(env, "weave_labels", {}), {}
    if not hasattr(env, "weave_quotes"):
        env.weave_quotes = {}
    for path in source_files(app.config, env):
        try:
            source = Source((source_root(app.config, env) / path).read_text(encoding="utf-8"))
        except WeaveError as error:
            logger.warning("weave: %s %s", path, error, location=path, type="weave")
            continue
        for label, line, role in source.labels():
            env.weave_labels.setdefault(label, []).append((path, line, role))
    moved = {
        label
        for label in {*before, *env.weave_labels}
        if before.get(label) != env.weave_labels.get(label)
    }
    equations = env.get_domain("math").equations
    return sorted({equations[label][0] for label in moved if label in equations} & env.found_docs)


def check_labels(app, env):
    """Warn of every label in the code that no page defines."""
    equations = env.get_domain("math").equations
    for label, places in sorted(env.weave_labels.items()):
        if label not in equations:
            where = [f"{path}:{line}" for path, line, _ in places]
            also = f" (named also at {', '.join(where[1:])})" if where[1:] else ""
            logger.warning(
                "weave: no page defines the equation %s%s",
                label,
                also,
                location=where[0],
                type="weave",
            )


def add_computed_in(app, doctree, docname):
    """Write below each equation where the code computes it: the headings and comments that name it, not the
    manual's."""
    for block in list(doctree.findall(nodes.math_block)):
        places = [
            (path, line)
            for path, line, role in app.env.weave_labels.get(block.get("label"), [])
            if not role
        ]
        if places and app.builder.format == "html":
            paragraph = nodes.paragraph("", "computed in ", classes=["weave-computed"])
            for i, (path, line) in enumerate(places):
                paragraph += nodes.Text(", " if i else "")
                paragraph += code_link(
                    app, docname, path, line, nodes.literal("", f"{Path(path).name}:{line}")
                )
            block.parent.insert(block.parent.index(block) + 1, paragraph)


def code_link(app, docname: str, path: str, line: int, content: nodes.Node) -> nodes.reference:
    """A link from a page to a line of a source file, in HTML."""
    uri = f"{app.builder.get_relative_uri(docname, code_page(path))}#line-{line}"
    return nodes.reference("", "", content, refuri=uri, internal=True)


def resolve_code(app, env, node, content):
    if node["reftype"] != "weave-code":
        return None
    if app.builder.format != "html" or node["reftarget"] not in source_files(app.config, env):
        return content
    return code_link(app, node["refdoc"], node["reftarget"], node["line"], content)


def purge_quotes(app, env, docname):
    getattr(env, "weave_quotes", {}).pop(docname, None)


def merge_quotes(app, env, docnames, other):
    for docname in docnames:
        if docname in other.weave_quotes:
            env.weave_quotes[docname] = other.weave_quotes[docname]


def setup(app):
    app.add_config_value("weave_root", "..", "env")
    app.add_config_value("weave_sources", ["libcontact"], "env")
    app.add_directive("weave", Weave)
    app.connect("env-get-outdated", scan_labels)
    app.connect("env-purge-doc", purge_quotes)
    app.connect("env-merge-info", merge_quotes)
    app.connect("env-check-consistency", check_labels)
    app.connect("missing-reference", resolve_code)
    app.connect("doctree-resolved", add_computed_in)
    return {
        "version": "1",
        "env_version": 1,
        "parallel_read_safe": True,
        "parallel_write_safe": True,
    }
