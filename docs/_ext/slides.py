"""Slides for lectures, from what the chapters show.

The file ``slides/theory/mass.rst`` has the slides of the chapter ``theory/mass``: a section per slide. It has words of
its own; equations, pictures, listings and exercises stay in the chapter and are pulled from there:

::

    .. pull:: equation week-wave week-impact-stress
    .. pull:: picture waves
    .. pull:: listing impact
    .. pull:: exercise bar-density

With the option ``:wide:`` a picture stands below the equations and not beside them. An equation and an exercise have
their label, a picture the name of its function, a listing that of the function or the heading which it quotes. A name
that the chapter does not have is a warning. The title, the question and the goal of the chapter come first, its summary
last. The deck of a week (``slides/six/1.html``) joins the slides of the week's chapters after ``course.toml``, and ends
with its sheet. Pictures and listings beside a question that begins with "Predict" are covered until a key or a click
asks for them (``_static/deck.js``).
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

import course
from docutils import nodes
from docutils.parsers.rst import directives
from exercises import exercise
from sphinx import addnodes
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

logger = logging.getLogger(__name__)
FOLDER = "slides/"
KINDS = ("equation", "picture", "listing", "exercise")


class pull(nodes.General, nodes.Element):
    """What a slide takes from its chapter."""


class Pull(SphinxDirective):
    required_arguments = 2
    final_argument_whitespace = True
    option_spec = {"wide": directives.flag}

    def run(self) -> list[nodes.Node]:
        kind, names = self.arguments
        if kind not in KINDS:
            raise self.error(f"a slide pulls one of {', '.join(KINDS)}")
        names = [names.strip('"')] if '"' in names else names.split()
        found = [pull("", kind=kind, name=name, wide="wide" in self.options) for name in names]
        for node in found:
            self.set_source_info(node)
        return found


def listing_names(node: nodes.Node) -> list[str]:
    """By which names a listing can be pulled: function and heading of a woven one, else the functions in it."""
    if isinstance(node, nodes.container) and "weave" in node["classes"]:
        last = node[0].children[1].astext().strip().replace("’", "'")
        return [last, last.removesuffix("()"), last.partition(": ")[2]]
    if isinstance(node, nodes.literal_block):
        first = re.match(r"(?:def |# )([^(\n]*)", node.astext())
        return [first[1].strip()] if first else []
    return []


def names(kind: str, node: nodes.Element) -> list[str]:
    """By which names a node of a chapter can be pulled."""
    if kind == "equation" and isinstance(node, nodes.math_block):
        return [node.get("label")]
    if kind == "picture" and isinstance(node, nodes.figure):
        return [node.get("drawn")]
    if kind == "exercise" and isinstance(node, exercise):
        return node["names"]
    return listing_names(node) if kind == "listing" else []


class PullFromChapter(SphinxPostTransform):
    """Before references are resolved, so that those of a pulled node lead from the slide."""

    default_priority = 1

    def run(self, **kwargs: Any) -> None:
        if not self.env.docname.startswith(FOLDER):
            return
        self.chapter = self.env.docname.removeprefix(FOLDER)
        source = self.env.get_doctree(self.chapter)
        asked = {id(n) for one in source.findall(exercise) for n in one.findall(nodes.Element)}
        for node in list(self.document.findall(pull)):
            kind, name = node["kind"], node["name"]
            found = [n for n in source.findall(nodes.Element) if name in names(kind, n)]
            found = [n for n in found if kind == "exercise" or id(n) not in asked]
            if node["wide"]:
                node.parent["classes"].append("stack")
            if len(found) == 1:
                node.replace_self(self.pulled(found[0]))
            else:
                logger.warning(
                    "slides: %s has %d times the %s %s",
                    *(self.chapter, len(found), kind, name),
                    type="slides",
                    location=node,
                )
                node.parent.remove(node)
        self.frame(source)

    def frame(self, source: nodes.document) -> None:
        """Title, question and goal before the slides, the summary behind them."""
        top = self.document[0]
        fields = next(source.findall(nodes.field_list))
        question = fields.parent[fields.parent.index(fields) + 1]
        title = self.link(self.env.titles[self.chapter].astext())
        goal = self.pulled(fields[0][1][0])
        goal.insert(0, nodes.strong("", "Goal: "))
        first = nodes.section("", nodes.title("", "", title), classes=["opening"], ids=["opening"])
        first += [self.pulled(question), goal]
        last = nodes.section("", nodes.title("", "Summary"), ids=["closing"])
        for section in source.findall(nodes.section):
            if section[0].astext() == "Summary":
                last += [self.pulled(n) for n in section if isinstance(n, nodes.bullet_list)]
        shown = (nodes.figure, nodes.container, nodes.literal_block)
        for section in top.findall(nodes.section):
            asks = any(node.astext().startswith("Predict") for node in section)
            if asks and any(isinstance(node, shown) for node in section):
                section["classes"].append("predict")
        self.document[:] = [first, *top.findall(nodes.section, include_self=False), last]

    def link(self, text: str, anchor: str = "") -> nodes.reference:
        uri = self.app.builder.get_relative_uri(self.env.docname, self.chapter)
        return nodes.reference("", text, refuri=uri + anchor)

    def pulled(self, node: nodes.Element) -> nodes.Node:
        """A copy of a node of the chapter, with its number there as a link."""
        own = node.deepcopy()
        for data in list(own.findall(nodes.legend)):
            data.parent.remove(data)
        for ref in own.findall(addnodes.pending_xref):
            if ref["reftype"] == "doc":
                target = posixpath.join("/", posixpath.dirname(self.chapter), ref["reftarget"])
                ref["reftarget"] = posixpath.normpath(target)
            ref["refdoc"] = self.env.docname
        if isinstance(node, nodes.math_block):
            own["number"] = own["label"] = None
            own["ids"] = []
            link = self.link(f"({self.number(node, 'displaymath')})", f"#{node['ids'][0]}")
            link["classes"].append("eqno")
            return nodes.container("", own, nodes.inline("", "", link), classes=["equation"])
        if isinstance(node, exercise):
            own["about"] = f"Exercise {self.number(node, 'exercise')} · {own['about']}"
        for caption in own.findall(nodes.caption):
            if isinstance(node, nodes.figure):
                number = self.number(node, "figure")
                caption.insert(0, self.link(f"Fig. {number}", f"#{node['ids'][0]}"))
                caption.insert(1, nodes.Text(" "))
        for answer in [n for n in own.findall(nodes.container) if n.get("design_component")]:
            answer.parent.remove(answer)
        return own

    def number(self, node: nodes.Element, kind: str) -> str:
        found = self.env.toc_fignumbers.get(self.chapter, {}).get(kind, {})
        return ".".join(str(n) for n in found.get(node["ids"][0], ()))


def outdated(app, env, added, changed, removed) -> list[str]:
    """Slides are read again with their chapter."""
    moved = added | changed
    return [
        doc
        for doc in env.found_docs
        if doc.startswith(FOLDER) and doc.removeprefix(FOLDER) in moved
    ]


def lay_out(app, pagename, templatename, context, doctree):
    return "deck.html" if pagename.startswith(FOLDER) else None


def body(app, chapter: str) -> str:
    """The slides of a chapter, from the page that was written."""
    path = Path(app.outdir) / f"{FOLDER}{chapter}.html"
    return path.read_text(encoding="utf-8").partition("<main>")[2].rpartition("</main>")[0]


def sheet(app, week: dict[str, Any]) -> str:
    """The exercises of a week, as a slide."""
    lines = []
    for chapter in week["chapters"]:
        numbers = app.env.toc_fignumbers[chapter]["exercise"]
        uri = app.builder.get_relative_uri(f"{FOLDER}six/1", chapter)
        minutes = course.exercises(Path(app.srcdir), chapter)
        for label in (label for label in week["exercises"] if label in minutes):
            number = ".".join(str(n) for n in numbers[label])
            lines.append(
                f'<li><a href="{uri}#{label}">Exercise {number}</a>, {minutes[label]} minutes</li>'
            )
    return f"<section><h2>Sheet of the week</h2><ul>{''.join(lines)}</ul></section>"


def decks(app) -> Iterator[tuple[str, dict[str, str], str]]:
    """The deck of each week of the courses."""
    table = course.table(Path(app.srcdir))
    for name in ("six", "twelve"):
        for number, week in enumerate(table[name]["weeks"], 1):
            title, course_title = f"Week {number}", escape(table[name]["title"])
            titles = (escape(app.env.titles[chapter].astext()) for chapter in week["chapters"])
            first = (
                f"<h1>{title}</h1><p>{course_title}</p><ul><li>{'</li><li>'.join(titles)}</li></ul>"
                "<p>Commands are for the folder of a clone, after <code>make figures</code>.</p>"
            )
            slides = "".join(body(app, chapter) for chapter in week["chapters"])
            deck = f'<section class="opening">{first}</section>{slides}{sheet(app, week)}'
            yield f"{FOLDER}{name}/{number}", {"title": title, "body": deck}, "deck.html"


def setup(app):
    app.setup_extension("exercises")
    app.add_node(pull)
    app.add_directive("pull", Pull)
    app.add_post_transform(PullFromChapter)
    app.connect("env-get-outdated", outdated)
    app.connect("html-page-context", lay_out)
    app.connect("html-collect-pages", decks)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
