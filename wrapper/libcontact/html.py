"""What a notebook shows of a scene, a run, an explanation and a plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table in HTML; a float is written with six digits."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(_cell(value) for value in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f'<td style="text-align: left">{escape(text)}</td>'


def titled(title: str, *parts: str) -> str:
    """Parts in HTML under a title, which is text."""
    return f"<div><strong>{escape(title)}</strong>{''.join(parts)}</div>"


def lines(text: str) -> str:
    """A text in HTML that keeps its lines and columns."""
    return f'<pre style="white-space: pre; overflow-x: auto">{escape(text)}</pre>'


def sections(text: str) -> str:
    """A text in HTML whose sections can be closed. Empty lines divide them; the first line of each is its
    title."""
    out = []
    for section in text.split("\n\n"):
        title, _, rest = section.partition("\n")
        head = f"<summary>{escape(title)}</summary>"
        out.append(f"<details open>{head}{lines(rest) if rest else ''}</details>")
    return "<div>" + "".join(out) + "</div>"
