"""The data of a picture as a table (CSV), for the link that ``drawn.py`` sets below it, and for those of tutorials.

A row per point: the panel (from 1), the curve (its label, or kind and number), x, y, and the value that a colour shows.
The corners of a bar and of a filled area and the points of a line of equal height have a row each, a cell of an image
and a coloured polygon one for their middle. Panels without axes are sketches and have no data.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import Collection, PathCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Patch


def points(artist: Artist) -> np.ndarray:
    """Rows of x, y and, where there is one, the value."""
    if isinstance(artist, Line2D):
        return np.column_stack([np.asarray(a, float) for a in artist.get_data()])
    if isinstance(artist, Patch):
        return artist.get_patch_transform().transform(artist.get_path().vertices)
    if isinstance(artist, AxesImage):
        values = artist.get_array()
        (rows, columns), (left, right, low, high) = values.shape, artist.get_extent()
        x = left + (np.arange(columns) + 0.5) * (right - left) / columns
        y = low + (np.arange(rows) + 0.5) * (high - low) / rows
        y = y if artist.origin == "lower" else y[::-1]
        x, y = np.meshgrid(x, y)
        return np.column_stack([x.ravel(), y.ravel(), np.ma.filled(values, np.nan).ravel()])
    assert isinstance(artist, Collection)
    values = artist.get_array()
    parts = [path.vertices for path in artist.get_paths()]
    if isinstance(artist, PathCollection):
        parts = [point[None, :] for point in np.ma.filled(artist.get_offsets(), np.nan)]
    elif isinstance(artist, PolyCollection) and values is not None:
        parts = [part[:-1].mean(axis=0, keepdims=True) for part in parts]
    if values is not None and len(values) == len(parts):
        parts = [np.column_stack([part, [v] * len(part)]) for part, v in zip(parts, values)]
    return np.vstack([np.empty((0, parts[0].shape[1])), *parts]) if parts else np.empty((0, 2))


def curves(ax: Axes) -> Iterator[tuple[str, np.ndarray]]:
    images = [
        image for image in ax.images if image.get_array().ndim == 2
    ]  # without a scale: colours
    kinds = (("line", ax.lines), ("image", images), ("area", ax.patches), ("set", ax.collections))
    for kind, artists in kinds:
        for number, artist in enumerate(artists, 1):
            label = str(artist.get_label())
            yield (
                f"{kind} {number}" if label.startswith("_") or not label else label,
                points(artist),
            )


def table(figure: Figure) -> str:
    """The data as text; empty for a sketch."""
    panels = [
        ax for ax in figure.axes if ax.axison and ax.name != "3d" and ax.get_label() != "<colorbar>"
    ]
    rows = [
        (panel, name, *(f"{x:.6g}" for x in row))
        for panel, ax in enumerate(panels, 1)
        for name, values in curves(ax)
        for row in values
    ]
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(
        [("panel", "curve", "x", "y", "value"), *((*row, "")[:5] for row in rows)]
    )
    return text.getvalue() if rows else ""


def scrape(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:
    """The pictures of a tutorial, with links to their data."""
    from matplotlib import pyplot
    from sphinx_gallery.scrapers import matplotlib_scraper

    tables = [table(pyplot.figure(number)) for number in pyplot.get_fignums()]
    text = matplotlib_scraper(block, block_vars, gallery_conf)
    for name, data in zip(re.findall(r"image-sg:: (\S+)\.png", text), tables):
        if data:
            Path(gallery_conf["src_dir"], f"{name[1:]}.csv").write_text(data, encoding="utf-8")
            text += f"\n:download:`data of the picture (CSV) <{name}.csv>`\n"
    return text


def _get_sg_image_scraper() -> Callable[..., str]:
    """For the gallery, which takes the name of this module."""
    return scrape
