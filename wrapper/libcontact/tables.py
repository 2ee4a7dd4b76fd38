"""Tables of results: structured numpy arrays that give one column per number, to pandas and to CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from .bridge import Rows
from .errors import NotBuiltIn

__all__ = ["Table"]

# Names of the columns of a field with so many numbers.
PARTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "zx")}


class Table(np.ndarray[Any, Any]):
    """A structured array, one row per time, such as ``run.energy``; its fields are plain numpy arrays."""

    def __getitem__(self, key: Any) -> Any:
        found = super().__getitem__(key)
        plain = isinstance(found, Table) and found.dtype.names is None
        return found.view(np.ndarray) if plain else found

    def columns(self) -> Iterator[tuple[str, Any]]:
        """
        Split the fields into columns.

        Yields
        ------
        tuple of str and ndarray
            Name and numbers of a column: a vector ``p`` is ``p_x``, ``p_y``, ``p_z``, a stress has
            ``stress_xx`` and five more.
        """
        for name in self.dtype.names or ():
            values = self[name]
            if values.ndim == 1:
                yield name, values
                continue
            for part, column in zip(PARTS[values.shape[1]], values.T):
                yield f"{name}_{part}", column

    def to_pandas(self) -> Any:
        """
        Convert to a table of pandas.

        Returns
        -------
        pandas.DataFrame
            One column per number, named as in :meth:`columns`.

        Raises
        ------
        NotBuiltIn
            pandas is not installed.
        """
        try:
            import pandas
        except ImportError:
            raise NotBuiltIn('to_pandas needs pandas: pip install "libcontact[pandas]"') from None
        return pandas.DataFrame(dict(self.columns()))


def as_table(rows: Rows) -> Table:
    """A view of a structured array as a table."""
    return rows.view(Table)


def write_csv(path: Path, table: Table, names: list[str] | None = None) -> None:
    """Write a table with one header row; numbers in ``body`` become these ``names``."""
    columns = dict(table.columns())
    if names is not None and "body" in columns:
        columns["body"] = np.array(names, object)[columns["body"]]
    with open(path, "w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(columns)
        lines.writerows(zip(*(column.tolist() for column in columns.values())))
