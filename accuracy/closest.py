"""The local search: errors and evaluations of each method at each tolerance, from the loops of
``bench/projection.py``."""

from __future__ import annotations

import csv
import sys
import tempfile
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[1] / "bench"))

COLUMNS = ("method", "tolerance", "evaluations", "ns", "xi_error", "distance_error", "wrong")


def write(path: Path) -> None:
    """Run each method of the library on the ordinary curved Q8 faces of the bench; an existing table is
    not computed again."""
    if path.exists():
        return
    import faces
    import numpy as np
    import projection
    from libcontact._core import lib
    from libcontact.projection import METHODS

    with tempfile.TemporaryDirectory() as folder:
        run = projection.solvers(projection.build(Path(folder)))
        nodes, points, xi, gaps = faces.ordinary(projection.ORDINARY)
        sizes = np.array([faces.corpus.face_size(own) for own in nodes])
        pairs = projection.Pairs(lib.CT_Q8, nodes, points)
        with path.open("w", newline="", encoding="utf-8") as file:
            table = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            table.writeheader()
            for name in METHODS:
                for row in projection.work_and_precision(run[name], pairs, xi, gaps, sizes):
                    table.writerow(
                        {"method": name} | {key: f"{value:.5g}" for key, value in row.items()}
                    )
