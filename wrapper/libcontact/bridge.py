"""The interface between Python and C: calls that raise exceptions, arrays, and the enums and
structs of the headers."""

from __future__ import annotations

import os
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import ffi, lib
from .errors import check, new_error
from .hdf5 import lock

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Rows = NDArray[Any]


def has(part: str) -> bool:
    """Check whether an optional part is there.

    Parameters
    ----------
    part : {"hdf5", "gsl", "openmp"}
        Results files, the modal series, or threads. Where HDF5 was not built in, that of h5py serves.

    Returns
    -------
    bool
        True if the part is there.

    Raises
    ------
    ValueError
        Unknown part.
    """
    # A part that is not built in returns CT_ERROR_UNSUPPORTED from every call, also from one
    # without work.
    nothing = ffi.NULL
    parts: dict[str, bool] = {
        "hdf5": part == "hdf5" and lock() is not None,
        "gsl": lib.ct_exact_plates_series(0, *[nothing] * 3, 0.3, 0, *[nothing] * 3)
        != lib.CT_ERROR_UNSUPPORTED,
        "openmp": bool(lib.ct_has_openmp()),
    }
    if part not in parts:
        raise ValueError(f'there is no part "{part}"; the parts are {", ".join(parts)}')
    return parts[part]


def call(function: Any, *arguments: Any) -> None:
    """Call a function of the library whose last argument is a ``ct_error *``, and raise its error
    as an exception."""
    error = new_error()
    check(function(*arguments, error), error)


def ask(kind: str, function: Any, *arguments: Any) -> Any:
    """Call a function that writes one value through a pointer of this kind, and return the value."""
    out = ffi.new(kind)
    call(function, *arguments, out)
    return out[0]


def names(enum: str) -> dict[str, int]:
    """The words of a C enum in the order of their numbers, for example "penalty" for
    CT_ENFORCE_PENALTY. The number of values (CT_SCHEME_COUNT) is none of them."""
    found = ffi.typeof(enum).elements.items()
    constants = sorted((number, name) for number, name in found if not name.endswith("_COUNT"))
    prefix = os.path.commonprefix([name for _, name in constants]).rpartition("_")[0] + "_"
    return {name.removeprefix(prefix).lower(): number for number, name in constants}


def members(struct: str) -> list[tuple[str, str, tuple[int, ...]]]:
    """The members of a C struct of numbers as numpy fields: name, type and shape."""
    out: list[tuple[str, str, tuple[int, ...]]] = []
    for name, member in ffi.typeof(struct).fields:
        array = member.type.kind == "array"
        of, shape = (member.type.item, (member.type.length,)) if array else (member.type, ())
        out.append((name, f"{'f' if of.cname == 'double' else 'i'}{ffi.sizeof(of)}", shape))
    return out


@cache
def row(struct: str) -> np.dtype[Any]:
    """The numpy type of an array of a C struct, padding included."""
    return np.dtype(members(struct), align=True)


class Points(np.ndarray[Any, np.dtype[Any]]):
    """Rows of ``ct_contact_point``. Their pressures had a name that did not say that they are uneven."""

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str) and key == "pressure":
            raise KeyError(
                'single points have "raw_pressure"; the contact pressure is that of the nodes: run.pressure, '
                "BodyState.contact_pressure, Contact.traction"
            )
        return super().__getitem__(key)


def point_rows(count: int) -> tuple[Points, Any]:
    """An array for C to fill with contact points, and a C pointer to it."""
    rows, pointer = table("ct_contact_point", count)
    return rows.view(Points), pointer


def table(struct: str, count: int) -> tuple[Rows, Any]:
    """An array for C to fill with structs, and a C pointer to it."""
    rows = np.zeros(count, row(struct))
    return rows, ffi.from_buffer(f"{struct}[]", rows)


def copied(struct: str, pointer: Any, count: int) -> Rows:
    """A copy of an array of C structs."""
    size = count * ffi.sizeof(struct)
    return np.frombuffer(ffi.buffer(pointer, size), row(struct)).copy()


def doubles(array: NDArray[Any]) -> Any:
    """A C pointer to a contiguous array of float64, which lives as long as the pointer."""
    if array.dtype != np.float64:
        raise TypeError(f"an array of {array.dtype} can't be passed to C as double")
    return ffi.from_buffer("double[]", array)


def ints(array: NDArray[Any]) -> Any:
    """A C pointer to a contiguous array of int32, which lives as long as the pointer."""
    return ffi.from_buffer("int32_t[]", array)


def real(name: str, values: Any, *shapes: tuple[str | int, ...]) -> Floats:
    """Values as a contiguous array of float64; they must be real numbers that float64 represents
    without loss.

    A shape in ``shapes`` consists of numbers, and of letters for any number: ``("m", 3)``. The
    array must have one of these shapes.
    """
    if np.ma.is_masked(values):
        raise ValueError(f"{name} has masked values; fill or leave them out")
    array = np.asarray(values)
    if array.size and not (array.dtype.kind in "fiu" and np.can_cast(array.dtype, np.float64)):
        raise TypeError(f"{name} must be real numbers that fit double precision, not {array.dtype}")
    if shapes and not any(_fits(array.shape, shape) for shape in shapes):
        wanted = " or ".join(map(str, shapes)).replace("'", "")
        raise ValueError(f"{name} must have shape {wanted}, not {array.shape}")
    return np.require(array, np.float64, ["C", "A"]).reshape(array.shape)


# Words that have been removed, by the name of their key, and what to write instead.
GONE = {
    "enforcement": {
        "lagrange": "is gone: on unlike meshes multipliers are neither unique nor bounded, and most steps do not converge; "
        'write "energy_controlled" with beta = 1000, where an impact at 1 % of the wave speed overlaps by at most 0.0001 of an element',
        "bipenalty": 'is gone: contact that opens and closes gained energy; write "energy_controlled", '
        "which has the same stable step and gains none",
    },
    "integrator": {
        "pushforward_pullback": "is gone: other methods reach its errors at a lower price; "
        'write "tchamwa_wielgosz" with the parameter 0.95 and, in a scene, fraction = 1'
    },
    "mass": {"averaged": 'is gone; runs have the mass "lumped"'},
    "savings": {"distant": "is gone: surfaces that are far apart are never searched; leave it out"},
    "initial_penetration": {"push": 'is gone; write "force", which is the same'},
}


def chosen(name: str, value: Any, known: dict[str, int]) -> int:
    """The number of a word."""
    if isinstance(value, str) and value in GONE.get(name, ()):
        raise ValueError(f'{name} = "{value}" {GONE[name][value]}')
    if not isinstance(value, str) or value not in known:
        raise ValueError(f"{name} must be one of {', '.join(known)}, not {value!r}")
    return known[value]


def finite(name: str, value: Any) -> float:
    """A value as a finite number."""
    number = real(name, value, ())
    if not np.isfinite(number):
        raise ValueError(f"{name} must be finite, not {value!r}")
    return float(number)


def index(name: str, value: Any) -> int:
    """A value as a whole number of 32 bits."""
    if np.ndim(value) != 0:
        raise ValueError(f"{name} must be a whole number, not {value!r}")
    return int(whole(name, value)[0])


def positive(name: str, value: Any) -> float:
    """A value as a number above 0."""
    if not 0 < float(value) < float("inf"):
        raise ValueError(f"{name} must be positive and finite, not {value!r}")
    return float(value)


def whole(name: str, values: Any) -> Ints:
    """Values as a contiguous array of int32, if they are whole numbers that fit."""
    array = np.asarray(values)
    if array.size and array.dtype.kind not in "iu":
        raise TypeError(f"{name} must be whole numbers, not {array.dtype}")
    if array.size and (array.min() < -(2**31) or array.max() >= 2**31):
        raise ValueError(f"{name} must fit 32 bits")
    return np.ascontiguousarray(array, np.int32)


def _fits(found: tuple[int, ...], wanted: tuple[str | int, ...]) -> bool:
    return len(found) == len(wanted) and all(
        isinstance(w, str) or f == w for f, w in zip(found, wanted)
    )
