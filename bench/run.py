"""``make bench``: run every bench, print its table, write JSON to the folder named on the command line, and a picture
of the projections."""

import json
import os
import platform
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import matplotlib  # noqa: E402

matplotlib.use("Agg")

sys.path.append(str(Path(__file__).resolve().parents[1] / "accuracy"))
import effects  # noqa: E402
import off_is_free  # noqa: E402
import plates  # noqa: E402
import projection  # noqa: E402
import savings  # noqa: E402
import search  # noqa: E402
import table  # noqa: E402
import whole  # noqa: E402

import libcontact as ct  # noqa: E402


def main() -> None:
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    where = table.where() | {"system": platform.platform(), "python": platform.python_version()}
    where["libcontact"] = ct.__version__
    print("\n".join(f"{key}: {value}" for key, value in where.items()), flush=True)
    for bench in (plates, projection, search, effects, savings, off_is_free, whole):
        result = bench.measure()
        print("\n" + bench.report(result), flush=True)
        (folder / f"{bench.__name__}.json").write_text(
            json.dumps({"machine": where, "result": result}, indent=1, default=str)
        )
        if bench is projection:
            bench.draw(result, folder / "projection.png")


if __name__ == "__main__":
    main()
