"""Picture of the page on mesh files."""

import tempfile
import zipfile
from pathlib import Path

from libcontact.meshes import read_mesh
from libcontact.pictures.mesh import draw_mesh

ARCHIVE = Path(__file__).resolve().parents[2] / "tests" / "data" / "meshes.zip"


def cam():
    """The cam of bricks and wedges, with its sets of faces."""
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(ARCHIVE) as archive:
        return draw_mesh(read_mesh(archive.extract("cam.msh", folder)))
