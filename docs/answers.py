"""
``make docs STUDENT=1``: ``answers.py FOLDER`` fails if a file of the students' book has a part of an answer.

An answer is known by its runs of six words that stand nowhere else in the pages. They are looked for in every file of
the folder: pages, slides, the PDF, notebooks, programs, and what is packed in archives. The index of the search has
single words, without their order: it must have none that stands on no page.
"""

from __future__ import annotations

import html
import io
import json
import re
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.append(str(DOCS / "_ext"))

import pagesource  # noqa: E402
from exercises import without_answers  # noqa: E402
from tqdm import tqdm  # noqa: E402

RUN = 6
SOURCES, SUFFIXES = ("libcontact", "tutorials", "wrapper"), (".c", ".h", ".out", ".py", ".rst")
# Roles that the book prints in other words than those of the source.
PRINTED = re.compile(r":(?:eq|ref|doc|numref|cite:\w|cite|measured):`[^`]*`")
Runs = dict[tuple[str, ...], str]  # of words, with the label of their exercise


def words(text: str) -> list[str]:
    return re.findall(r"[a-z0-9]+", text.lower())


def runs(text: str) -> Iterator[tuple[str, ...]]:
    """Six words in a row, at least four of them different words of a language: numbers alone may stand anywhere."""
    own = words(text)
    for run in zip(*(own[i:] for i in range(RUN))):
        if len({word for word in run if len(word) > 1 and word.isalpha()}) > 3:
            yield run


def parts(rst: str) -> list[str]:
    """The pieces of a source that a page shows word by word, and those of a PDF, where formulas are drawings."""
    without = re.sub(r":math:`[^`]*`", " ", rst)
    if without != rst:
        return parts(without) + pieces(rst)
    return pieces(rst)


def pieces(rst: str) -> list[str]:
    rst = re.sub(
        r":math:|:download:|^ *\.\. .*$|^ *:[\w-]+:(?: .*)?$",
        " ",
        PRINTED.sub("\0", rst),
        flags=re.M,
    )
    return rst.split("\0")


def telling(docs: Path = DOCS) -> Runs:
    """What gives an answer away: its runs of words, without those that stand elsewhere in the sources of the book."""
    folder, found, known = docs / "exercises", {}, set[tuple[str, ...]]()
    for file in folder.glob("*.rst"):
        for one in pagesource.exercises(file.read_text(encoding="utf-8")):
            known.update(run for part in parts(one.question) for run in runs(part))
            found |= {run: one.label for part in parts(one.answer) for run in runs(part)}
    tops = [docs, *(docs.parent / name for name in SOURCES)]
    for file in (file for top in tops for file in top.rglob("*")):
        if file.suffix in SUFFIXES and file.parent != folder and file.parent != docs / "tutorials":
            text = file.read_text(encoding="utf-8")
            if file.parent == docs.parent / "tutorials":
                found |= {run: file.stem for part in parts(text) for run in runs(part)}
                text = without_answers(text)
            known.update(run for part in parts(text) for run in runs(part))
    return {run: label for run, label in found.items() if run not in known}


def texts(name: str, data: bytes) -> Iterator[tuple[str, str]]:
    """The texts in a file, with their names."""
    if zipfile.is_zipfile(io.BytesIO(data)):
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            for own in packed.namelist():
                yield from texts(f"{name}/{own}", packed.read(own))
    elif name.endswith(".pdf"):
        from pypdf import PdfReader

        for number, sheet in enumerate(PdfReader(io.BytesIO(data)).pages, 1):
            yield f"{name}, page {number}", sheet.extract_text()
    elif name.endswith(".html"):
        text = re.sub(r"<(script|style)\b.*?</\1>", " ", data.decode("utf-8"), flags=re.S)
        yield name, html.unescape(re.sub(r"<[^>]*>", "", text))
    elif name.endswith(
        (".ipynb", ".inv", ".js", ".txt", ".py", ".rst", ".csv", ".json", ".svg", ".out")
    ):
        yield name, data.decode("utf-8", errors="ignore").replace("\\n", "\n")


def terms(index: str) -> set[str]:
    """The words of the search's index, as it stems them."""
    found = json.loads(index[index.index("(") + 1 : index.rindex(")")])
    return {*found["terms"], *found["titleterms"]}


def check(folder: Path, docs: Path = DOCS) -> list[str]:
    """The places where a file of a book has a part of an answer."""
    from sphinx.search.en import SearchEnglish

    secret, found, shown = telling(docs), [], set[str]()
    for path in tqdm(sorted(folder.rglob("*")), unit="file", disable=None):
        name = path.relative_to(folder).as_posix()
        if not path.is_file() or name.startswith(".doctrees/"):
            continue
        for place, text in texts(name, path.read_bytes()):
            if label := next((secret[run] for run in runs(text) if run in secret), None):
                found.append(f"{place}: the answer of {label}")
            if name.endswith(".html"):
                shown.update(re.findall(r"\w+", text.lower()))
    index = folder / "searchindex.js"
    if index.exists():
        stem = SearchEnglish({}).stem
        asked = {w for run in secret for w in run if len(w) > 2}
        known = {stem(word) for word in shown} | shown
        left = sorted(terms(index.read_text(encoding="utf-8")) & {stem(w) for w in asked} - known)
        found += [f"searchindex.js: the word {word!r}, which is on no page" for word in left]
    return found


if __name__ == "__main__":
    given_away = check(Path(sys.argv[1]))
    print("\n".join(given_away) or "no answer of an exercise is in this book")
    sys.exit(bool(given_away))
