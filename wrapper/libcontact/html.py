"""What a notebook shows of a scene, a run, an explanation and a plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """
    Write a table.

    Parameters
    ----------
    heads : sequence of str
        Headings of the columns.
    rows : iterable of sequences
        The cells; a float is written with six digits.

    Returns
    -------
    str
        The HTML.
    """
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(f"<tr>{''.join(_cell(value) for value in row)}</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    text = f"{value:.6g}" if isinstance(value, float) else str(value)
    return f'<td style="text-align: left">{escape(text)}</td>'


def titled(title: str, *parts: str) -> str:
    """
    Put a title above parts.

    Parameters
    ----------
    title : str
        The title, as text.
    *parts : str
        HTML.

    Returns
    -------
    str
        The HTML.
    """
    return f"<div><strong>{escape(title)}</strong>{''.join(parts)}</div>"


def lines(text: str) -> str:
    """
    Keep lines and columns of a text.

    Parameters
    ----------
    text : str
        The text.

    Returns
    -------
    str
        The HTML.
    """
    return f'<pre style="white-space: pre; overflow-x: auto">{escape(text)}</pre>'


def sections(text: str) -> str:
    """
    Make each section of a text one that can be closed.

    Parameters
    ----------
    text : str
        Sections divided by empty lines; the first line of each is its title.

    Returns
    -------
    str
        The HTML.
    """
    out = []
    for section in text.split("\n\n"):
        title, _, rest = section.partition("\n")
        head = f"<summary>{escape(title)}</summary>"
        out.append(f"<details open>{head}{lines(rest) if rest else ''}</details>")
    return "<div>" + "".join(out) + "</div>"
