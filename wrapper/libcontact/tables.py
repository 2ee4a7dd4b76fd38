"""Tables of results: structured numpy arrays that give one column per number, to pandas and to CSV."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from .bridge import Floats, Rows, members
from .errors import NotBuiltIn, install
from .schema import suggestion

__all__ = ["Table"]

# Names of the columns of a field with so many numbers.
PARTS = {3: ("x", "y", "z"), 6: ("xx", "yy", "zz", "xy", "yz", "zx")}

# Rows of the energy balance and of the momenta.
ENERGY = np.dtype(members("ct_energy"))
MOMENTUM = np.dtype(members("ct_momentum"))
# Effects whose energy or work is part of a column of ENERGY; others have a column of their own.
IN_ENERGY = ("solid", "contact", "support")


class Table(np.ndarray[Any, Any]):
    """A structured array, one row per time, such as ``run.energy``; its fields, and their columns such as
    ``force_x``, are plain numpy arrays."""

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str) and key not in (self.dtype.names or ()):
            columns = dict(self.columns())
            if key in columns:
                return columns[key]
            raise ValueError(f'no field is named "{key}"' + suggestion(key, [*columns]))
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
            raise NotBuiltIn(f"to_pandas needs pandas: {install('pandas')}") from None
        return pandas.DataFrame(dict(self.columns()))


def as_table(rows: Rows) -> Table:
    """A view of a structured array as a table."""
    return rows.view(Table)


def energy_table(energy: Rows, effects: Sequence[str], values: Floats) -> Rows:
    """``Run.energy`` from rows of ENERGY, with a column for each further name, which sums the ``values``
    (rows, effects) of the effects with this name."""
    own = tuple(dict.fromkeys(name for name in effects if name not in IN_ENERGY))
    out = np.zeros(len(energy), _energy_row(own))
    for name in ENERGY.fields or ():
        out[name] = energy[name]
    for name, value in zip(effects, values.T):
        if name in own:
            out[name] += value
    return out


@cache
def _energy_row(own: tuple[str, ...]) -> np.dtype[np.void]:
    """The numpy type of a row of ENERGY with a column for each further name; cached, because each record
    needs it and numpy creates it slowly."""
    return np.dtype(ENERGY.descr + [(name, "f8") for name in own])


def write_csv(path: Path, table: Table, names: list[str] | None = None) -> None:
    """Write a table with one header row; numbers in ``body`` become these ``names``."""
    columns = dict(table.columns())
    if names is not None and "body" in columns:
        columns["body"] = np.array(names, object)[columns["body"]]
    with open(path, "w", newline="", encoding="utf-8") as file:
        lines = csv.writer(file)
        lines.writerow(columns)
        lines.writerows(zip(*(column.tolist() for column in columns.values())))
