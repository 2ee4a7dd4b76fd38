"""Names of C in single backticks become links, and no public function is missing from the manual.

The comments of the headers write names as `ct_mesh_check` or `count`. With ``default_role = "cname"`` a name that
begins with ``ct_`` or ``CT_`` is linked to its entry in the API pages (with ``-n`` a name without entry fails),
anything else is shown as code. hawkmoth leaves the star before the last line of a comment that ends with text; here it
goes, since docutils would read a list. At the end of reading, every function that a public header declares with
``CT_API`` must have an entry, and no header may have a comment *after* what it describes (``/**< … */``): hawkmoth
would give it to the next name.
"""

from __future__ import annotations

import re
from pathlib import Path

from csource import Source
from docutils import nodes
from sphinx import addnodes
from sphinx.util import logging
from sphinx.util.docutils import SphinxRole

logger = logging.getLogger(__name__)


class NameRole(SphinxRole):
    def run(self):
        code = nodes.literal(self.rawtext, self.text, classes=["c"])
        if not re.fullmatch(r"(ct_|CT_)\w+", self.text):
            return [code], []
        link = addnodes.pending_xref(
            self.rawtext,
            code,
            refdomain="c",
            reftype="identifier",
            reftarget=self.text,
            refdoc=self.env.docname,
            refexplicit=True,
        )
        self.set_source_info(link)
        return [link], []


def take_last_star(app, lines, transform, options):
    """Take the star away that stands before the last line of a comment of several lines."""
    if len(lines) > 1:
        lines[-1] = re.sub(r"^\s+\* ", "", lines[-1])


def check_manual(app, env):
    """Warn of every public function that no page documents."""
    documented = {name for name, *_ in env.get_domain("c").get_objects()}
    root = Path(env.srcdir, app.config.cnames_headers).resolve()
    for header in sorted(root.rglob("*.h")):
        source = Source(header.read_text(encoding="utf-8"))
        for match in re.finditer(r"/\*\*<", source.text):
            logger.warning(
                "a comment must stand before what it describes, not after",
                type="cnames",
                location=f"{header.relative_to(root)}:{source.line(match.start())}",
            )
        for match in re.finditer(r"\bCT_API\b[^;{}]*?\b(ct_\w+)\s*\(", source.code):
            if match[1] not in documented:
                logger.warning(
                    "the manual lacks %s: has it a /** comment */, and its header an API page?",
                    match[1],
                    location=f"{header.relative_to(root)}:{source.line(match.start(1))}",
                    type="cnames",
                )


def setup(app):
    app.add_config_value("cnames_headers", "../libcontact/include", "env")
    app.add_role("cname", NameRole())
    app.setup_extension("hawkmoth")
    app.connect("hawkmoth-process-docstring", take_last_star)
    app.connect("env-check-consistency", check_manual)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
