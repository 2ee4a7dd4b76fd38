"""
``make pdf``: ``printed.py HTML`` prints the built book into three PDFs beside its pages, with contents, bookmarks,
page numbers and links between their pages: the course (the chapters of ``course.toml``, without what is for the
curious), the book, and the reference. Answers of exercises stand at the end of their page. The browser that shows the
book sets it, so it needs no typesetting system.
"""

from __future__ import annotations

import html
import io
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

sys.path.append(str(Path(__file__).resolve().parent / "_ext"))

import browser
import course
from pypdf import PdfReader, PdfWriter
from pypdf.generic import ArrayObject, NameObject
from tqdm import tqdm

FORMAT: dict[str, Any] = {"format": "A4", "scale": 0.78, "print_background": True}
MARGIN = {"top": "18mm", "bottom": "18mm", "left": "16mm", "right": "16mm"}
WIDTH = int((210 - 2 * 16) / 25.4 * 96 / FORMAT["scale"])  # of the text, in pixels of the browser
# One table that is too wide would make the browser shrink its whole page. What is folded would be lost on paper.
# Answers come last, under the numbers of their exercises. A course leaves out what is for the curious.
PREPARE = """
course => {
  for (const mark of course ? document.querySelectorAll("article .course-mark") : [])
    if (mark.textContent === "for the curious") mark.closest("section").remove();
  const answers = [...document.querySelectorAll("article .exercise details")];
  if (answers.length) {
    const title = document.createElement("h2"), article = document.querySelector("article");
    title.textContent = "Answers";
    article.append(title);
    for (const answer of answers) {
      answer.querySelector("summary").textContent = answer.closest(".exercise").querySelector(".caption-number").textContent;
      article.append(answer);
    }
  }
  for (const folded of document.querySelectorAll("article details")) folded.open = true;
  for (const box of document.querySelectorAll("article .table-wrapper"))
    if (box.scrollWidth > box.clientWidth) box.firstElementChild.style.zoom = 0.98 * box.clientWidth / box.scrollWidth;
}
"""
ENTRY = re.compile(
    r'<li class="toctree-l(\d)[^"]*"><a class="reference internal" href="([^"#]+)">(.*?)</a>'
)


TITLES = course.table()["pdfs"]
REFERENCE = ("reference/index.html", "develop/index.html")  # parts


class Page(NamedTuple):
    """A page of the book: its depth in the contents, its path, its title."""

    depth: int
    name: str
    title: str


class Printed(NamedTuple):
    page: Page
    sheets: PdfReader
    first: int  # index of its first sheet in the PDF


def contents(folder: Path) -> Iterator[tuple[str, Page]]:
    """The pages in the order of the contents, from the tree beside each page, with the first page of their part."""
    text = (folder / "index.html").read_text(encoding="utf-8")
    tree = text[text.index('class="sidebar-tree"') :]
    part, seen = "", set[str]()
    for depth, name, title in ENTRY.findall(tree):
        part = name if depth == "1" else part
        if name not in seen:
            seen.add(name)
            yield part, Page(int(depth), name, strip(title))


def selected(folder: Path) -> dict[str, list[Page]]:
    """The pages of each PDF."""
    pages = list(contents(folder))
    of_course = ["start/course", "start/units", *course.chapters(course.table())]
    titles = {page.name: page for _, page in pages}
    return {
        "course.pdf": [titles[f"{name}.html"]._replace(depth=1) for name in of_course],
        "libcontact.pdf": [page for part, page in pages if part not in REFERENCE],
        "reference.pdf": [page for part, page in pages if part in REFERENCE],
    }


def strip(title: str) -> str:
    return html.unescape(re.sub(r"<[^>]*>", "", title)).strip()


def printed(reader: browser.Reader, page: Page, first: int, short: bool) -> Printed:
    own = reader.open(page.name)
    if own.query_selector("mjx-merror"):
        raise SystemExit(f"{page.name}: MathJax could not set a formula")
    own.evaluate(PREPARE, short)
    return Printed(page, PdfReader(io.BytesIO(own.pdf(**FORMAT, margin=MARGIN))), first)


def table(reader: browser.Reader, title: str, book: list[Printed]) -> PdfReader:
    """Title and contents with page numbers, as sheets."""
    rows = "".join(
        f'<p style="margin:0.15em 0 0.15em {2 * (one.page.depth - 1)}em"><a href="{reader.address}/{one.page.name}">{html.escape(one.page.title)}</a>'
        f'<span style="float:right">{one.first + 1}</span></p>'
        for one in book
    )
    text = (
        '<body style="font-family:sans-serif;font-size:15px"><style>a{color:inherit;text-decoration:none}</style>'
        f"<h1>libcontact: {title}</h1><p>Explicit finite-element contact and impact: the equations and the code that computes them.</p><h2>Contents</h2>{rows}"
    )
    reader.page.set_content(text)
    return PdfReader(io.BytesIO(reader.page.pdf(**FORMAT, margin=MARGIN)))


def numbers(reader: browser.Reader, count: int) -> PdfReader:
    """Sheets with nothing but their number."""
    each = "".join(
        f'<div style="height:100vh;break-after:page;position:relative"><p style="position:absolute;bottom:8mm;width:100%;text-align:center">{k + 1}</p></div>'
        for k in range(count)
    )
    reader.page.set_content(f'<body style="margin:0;font:11px sans-serif;color:#555">{each}')
    return PdfReader(io.BytesIO(reader.page.pdf(format="A4")))


def finish(writer: PdfWriter, address: str, book: list[Printed]) -> None:
    """Links to pages of the PDF lead to their first sheet, those to other pages of the book nowhere; each page has a
    bookmark below that of the page above it in the contents."""
    first = {one.page.name: writer.pages[one.first].indirect_reference for one in book}
    for sheet in writer.pages:
        kept = ArrayObject()
        for link in sheet.get("/Annots") or []:
            own = link.get_object()
            target = str(own.get("/A", {}).get("/URI", ""))
            name = target.removeprefix(f"{address}/").split("#")[0]
            if name in first:
                own[NameObject("/Dest")] = ArrayObject([first[name], NameObject("/Fit")])
                del own["/A"]
            if not target.startswith(address) or name in first:
                kept.append(link)
        if "/Annots" in sheet:
            sheet[NameObject("/Annots")] = kept
    above: dict[int, Any] = {}
    for one in book:
        above[one.page.depth] = writer.add_outline_item(
            title=one.page.title, page_number=one.first, parent=above.get(one.page.depth - 1)
        )


def write(reader: browser.Reader, pages: list[Page], path: Path) -> None:
    book, first = list[Printed](), 0
    for page in tqdm(pages, desc=path.name, unit="page", disable=None):
        book.append(printed(reader, page, first, path.name == "course.pdf"))
        first += len(book[-1].sheets.pages)
    before = len(table(reader, TITLES[path.name], book).pages)
    book = [one._replace(first=one.first + before) for one in book]
    writer = PdfWriter()
    for sheets in (table(reader, TITLES[path.name], book), *(one.sheets for one in book)):
        writer.append(sheets, import_outline=False)
    for sheet, number in zip(writer.pages, numbers(reader, len(writer.pages)).pages):
        sheet.merge_page(number)
        sheet.compress_content_streams()
    if reader.outside:
        raise SystemExit(f"a page fetches {reader.outside[0]}")
    finish(writer, reader.address, book)
    writer.write(path)
    print(f"{len(writer.pages)} pages: {path}")


def main(folder: Path, *names: str) -> None:
    own = browser.find()
    if own is None:
        raise SystemExit(
            "no browser: install chromium, or run build/venv/bin/playwright install --only-shell chromium"
        )
    with browser.reading(folder, own) as reader:
        reader.page.emulate_media(media="print", color_scheme="light")
        reader.page.set_viewport_size({"width": WIDTH, "height": 1200})
        for name, pages in selected(folder).items():
            if not names or name in names:
                write(reader, pages, folder / name)
    course.reveal(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
