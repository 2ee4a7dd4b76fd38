"""Meshes from files of other programs: Gmsh, Abaqus, Exodus, VTK."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import NotBuiltIn
from . import abaqus, exodus, gmsh, vtk
from .convert import MeshData, Report, convert
from .raw import Numbers, Raw, Reading

__all__ = ["MeshData", "Report", "read_mesh"]

# What reads a file, by the ending of its name.
FORMATS: dict[str, Callable[[Reading], Raw]] = {
    ".vtkhdf": vtk.read_vtkhdf,
    ".msh": gmsh.read,
    ".vtu": vtk.read_vtu,
    ".inp": abaqus.read,
    ".g": exodus.read,
    ".e": exodus.read,
    ".exo": exodus.read,
    ".gen": exodus.read,
    ".ex2": exodus.read,
}
MOST_LAYERS = 10_000


def read_mesh(
    path: str | Path,
    *,
    part: str | None = None,
    scale: float = 1.0,
    extrude: tuple[float, int] | None = None,
) -> MeshData:
    """
    Read the bricks of a mesh file and its named sets.

    A tetrahedron is split into four bricks, and its neighbours as far as they must be. A wedge that need not be split
    becomes a brick with a collapsed side. Surfaces and lines of named groups become sets of faces and nodes.

    Parameters
    ----------
    path : str or Path
        A file of Gmsh (``.msh``, version 2.2 or 4.1), Abaqus (``.inp``), Exodus (``.g``, ``.e``, ``.exo``), or VTK
        (``.vtu``, ``.vtkhdf``).
    part : str, optional
        Name of a set of elements: a physical group, a part, an instance or an ELSET of Abaqus, or a block of Exodus.
        Only its elements are read.
    scale : float, default 1
        Coordinates are multiplied by it.
    extrude : (float, int), optional
        Height [length of the file] and number of layers: a mesh of quadrilaterals and triangles in a plane z = const
        is extruded along z.

    Returns
    -------
    MeshData
        Nodes, elements and sets.

    Raises
    ------
    ValueError
        The file can't be read, or an element is inverted or listed twice. The text names the file, and line and
        element where it can.
    NotBuiltIn
        A package that reads this format is not installed.
    """
    return MeshFile(path).bricks(part, scale, extrude)


class MeshFile:
    """A mesh file that is read once, also if several bodies are parts of it."""

    def __init__(self, path: str | Path):
        self.path, self.reading = Path(path), Reading(path)
        self._raw: Raw | None = None
        self._taken: list[tuple[str, object, Numbers]] = []

    def take(self, body: str, cells: Numbers, where: object) -> None:
        """
        Refuse a body with an element of another body in the same place.

        Parameters
        ----------
        body
            Name of the body.
        cells
            Its cells of the file.
        where
            What makes its coordinates of those of the file.

        Raises
        ------
        ValueError
            The text names the file, an element and the two bodies.
        """
        for other, its, theirs in self._taken:
            common = np.intersect1d(cells, theirs)
            if its == where and common.size and self._raw is not None:
                text = f'{self._raw.who(int(common[0]))} is in the bodies "{other}" and "{body}"'
                cure = "give each body a part that has no elements of the others"
                raise self.reading.wrong(f"{text}, {common.size} in all; {cure}")
        self._taken.append((body, where, cells))

    def bricks(self, part: str | None, scale: float, extrude: tuple[float, int] | None) -> MeshData:
        """
        The bricks of a part.

        Parameters
        ----------
        part, scale, extrude
            As for :func:`read_mesh`.

        Returns
        -------
        MeshData
            Nodes, elements and sets.

        Raises
        ------
        ValueError, NotBuiltIn
            As for :func:`read_mesh`.
        """
        path, reading = self.path, self.reading
        read = FORMATS.get(path.suffix.lower())
        if read is None and _is_hdf5(path):
            read = vtk.read_vtkhdf
        if read is None:
            text = f"the ending must be one of {', '.join(FORMATS)}; Gmsh writes .msh of geometries and surfaces"
            cure = f'meshio convert "{path}" "{path.with_suffix(".vtu")}" may convert a mesh'
            raise reading.wrong(f"{text}, and {cure}")
        if not (math.isfinite(scale) and scale > 0.0):
            raise reading.wrong(f"scale is {scale:g}; it must be positive")
        if extrude is not None:
            height, layers = extrude
            if not (math.isfinite(height) and height > 0.0 and 1 <= layers <= MOST_LAYERS):
                text = f"extrude is {[height, layers]}; a positive height and 1 to {MOST_LAYERS}"
                raise reading.wrong(f"{text} layers are needed")
        try:
            if self._raw is None:
                self._raw = read(reading)
            return convert(self._raw, part, scale, extrude)
        except NotBuiltIn:
            raise
        except ValueError as error:
            if str(path) in str(error) or any(str(file) in str(error) for file in reading.files):
                raise
            raise reading.wrong(f"is damaged: {error}") from None
        except OSError as error:
            raise reading.wrong(f"can't be read: {error.strerror or error}") from None
        except MemoryError:
            raise reading.wrong("needs more memory than there is") from None
        except (Exception, SystemExit) as error:
            # What the libraries that read damaged files raise: anything.
            text = f"is damaged: {type(error).__name__} {error}".strip()
            raise reading.wrong(text) from None


def _is_hdf5(path: Path) -> bool:
    try:
        with open(path, "rb") as file:
            return file.read(4) == exodus.HDF5
    except OSError:  # told when the file is read
        return False
