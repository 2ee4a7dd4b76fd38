"""Pages that show each source file whole, with line numbers to link to, so that the book needs no server for its
``[source]`` links.

Every C file under ``weave_sources`` becomes ``_code/<path>.html``; line 49 has the anchor ``#line-49``. Above the
source stand the pages of the book that quote it.
"""

from __future__ import annotations

from html import escape

from weave import code_page, source_files, source_root


def pages(app):
    """Yield the pages, for Sphinx to lay them out as it does its own."""
    quoted: dict[str, set[str]] = {}
    for docname, quotes in app.env.weave_quotes.items():
        for path, _, _ in quotes:
            quoted.setdefault(path, set()).add(docname)
    for path in source_files(app.config, app.env):
        text = (source_root(app.config, app.env) / path).read_text(encoding="utf-8")
        listing = app.builder.highlighter.highlight_block(
            text, "c", linenos="inline", lineanchors="line", anchorlinenos=True
        )
        links = ", ".join(
            f'<a href="{app.builder.get_relative_uri(code_page(path), docname)}">{escape(app.env.titles[docname].astext())}</a>'
            for docname in sorted(quoted.get(path, ()))
        )
        body = (
            f"<h1>{escape(path)}</h1>\n"
            + (f"<p>Explained in: {links}</p>\n" if links else "")
            + listing
        )
        yield code_page(path), {"title": path, "body": body}, "page.html"


def setup(app):
    app.setup_extension("weave")
    app.connect("html-collect-pages", pages)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
