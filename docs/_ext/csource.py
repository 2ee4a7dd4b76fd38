"""Cut a C file into functions and headed fragments: as much C as quoting needs, and no parser.

Comments, strings, characters and preprocessor lines are blanked; what is left is searched for braces. A function is
then whatever stands between ``)`` and ``{`` at depth 0, whether static, with attributes, or inside ``extern "C" {``.
Lines count from 1.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

# What is no code: comments, strings and characters, preprocessor lines with their continuations.
NO_CODE = re.compile(
    r"""(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)
      |(?P<string>"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*')
      |(?P<line>^[ \t]*\#(?:\\\n|/\*.*?\*/|(?!//)[^\n])*)""",
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)
LABEL = re.compile(r"(?P<role>:)?\beq:`?(?P<label>[A-Za-z0-9]+(?:[-_][A-Za-z0-9]+)*)")
HEADING = re.compile(r"//\s*--\s*(?P<text>.*?)\s*(?:\([^()]*\beq:[^()]*\))?\s*$")


class WeaveError(Exception):
    """What a directive asks for can't be quoted; the text says why."""


@dataclass(frozen=True)
class Span:
    """A function, or the fragment under a heading: its name and lines, counted from 1, the last one included."""

    name: str
    first: int
    last: int
    function: str = ""


class Source:
    """A C file cut into functions and headings. It knows comments, strings, preprocessor lines and braces, and no
    more."""

    def __init__(self, text: str):
        self.text = text
        self.lines = text.splitlines()
        self.code = NO_CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)
        self.comments = [match for match in NO_CODE.finditer(text) if not match["string"]]
        self.functions = list(self._find_functions())
        self.headings = list(self._find_headings())

    def line(self, offset: int) -> int:
        return self.text.count("\n", 0, offset) + 1

    def labels(self, first: int = 1, last: int = 2**31) -> list[tuple[str, int, bool]]:
        """Equations that comments in these lines name: label, line, and whether as a reST role (in a doc comment)."""
        found = []
        for comment in self.comments:
            for match in LABEL.finditer(comment[0]):
                line = self.line(comment.start() + match.start())
                if first <= line <= last:
                    found.append((match["label"], line, match["role"] is not None))
        return found

    def _find_functions(self):
        depth = wrapped = start = 0
        for match in re.finditer(r"[{};]", self.code):
            head = self.code[start : match.start()]
            if match[0] == "{" and depth == 0 and head.strip() == "extern":  # extern "C" {
                wrapped, start = wrapped + 1, match.end()
            elif match[0] == "}" and depth == 0 and wrapped:
                wrapped, start = wrapped - 1, match.end()
            elif match[0] == "{":
                if depth == 0:
                    name, begin = _function_name(head), start + len(head) - len(head.lstrip())
                depth += 1
            elif match[0] == "}":
                depth -= 1
                if depth == 0:
                    start = match.end()
                    if name:
                        yield Span(name, self.line(begin), self.line(match.start()), name)
            elif depth == 0:
                start = match.end()
            if depth < 0:
                break
        if depth or wrapped:
            raise WeaveError("its braces do not balance")

    def _find_headings(self):
        for comment in self.comments:
            match = HEADING.match(comment[0])
            line = self.line(comment.start())
            owners = [f for f in self.functions if f.first <= line <= f.last]
            if match and owners:
                yield Span(match["text"], line, self._block_end(comment.end()), owners[0].function)

    def _block_end(self, offset: int) -> int:
        """Last line before the brace that closes the block around ``offset``."""
        depth = 0
        for match in re.finditer(r"[{}]", self.code[offset:]):
            depth += 1 if match[0] == "{" else -1
            if depth < 0:
                end = offset + match.start()
                line_start = self.code.rfind("\n", 0, end) + 1
                return self.line(end) - (not self.code[line_start:end].strip())
        raise WeaveError("its braces do not balance")

    def function(self, name: str) -> Span:
        return _only([f for f in self.functions if f.name == name], f"function {name}")

    def fragment(self, title: str) -> Span:
        found = [h for h in self.headings if h.name == title]
        if not found and ": " in title:
            owner, text = title.split(": ", 1)
            found = [h for h in self.headings if h.name == text and h.function == owner]
        heading = _only(found, f'heading "{title}"')
        later = [h.first - 1 for h in self.headings if h.first > heading.first]
        last = min([heading.last, *later])
        while not self.lines[last - 1].strip():
            last -= 1
        return Span(heading.name, heading.first, last, heading.function)

    def quote(self, what: str, doc: bool = False) -> Span:
        """The function of this name, with ``doc`` from the comments above it on, or the fragment under this
        ``"heading"``."""
        quoted = re.fullmatch(r'"(.*)"', what)
        if quoted:
            return self.fragment(quoted[1].strip())
        span = self.function(what)
        return replace(span, first=self.doc_start(span)) if doc else span

    def doc_start(self, span: Span) -> int:
        """First line of the comments directly above a function."""
        first = span.first
        for comment in reversed(self.comments):
            alone = not self.text[
                self.text.rfind("\n", 0, comment.start()) + 1 : comment.start()
            ].strip()
            if comment["comment"] and alone and self.line(comment.end()) == first - 1:
                first = self.line(comment.start())
        return first


def _function_name(head: str) -> str | None:
    """Name of the function that a declaration before ``{`` defines: the identifier before its last parentheses."""
    head = head.rstrip()
    level = 0
    for i in reversed(range(len(head) if head.endswith(")") else 0)):
        level += (head[i] == ")") - (head[i] == "(")
        if level == 0:
            match = re.search(r"([A-Za-z_]\w*)\s*$", head[:i])
            return match and match[1]
    return None


def _only(found: list[Span], what: str) -> Span:
    if len(found) > 1:
        raise WeaveError(
            f"{what} is ambiguous: it stands at lines {', '.join(str(f.first) for f in found)}"
        )
    if not found:
        raise WeaveError(f"has no {what}")
    return found[0]
