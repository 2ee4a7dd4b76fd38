"""Closest points: cost and accuracy of each method, its failures, and a comparison with general
minimisers in the same run.

Each library is called from C in the same loop (projection_loops.c) for the same pairs of a face and a
point, with the same f and gradient. NLopt's functions are those inside its Python wheel.
"""

from __future__ import annotations

import ctypes
import os
import subprocess
import tempfile
from pathlib import Path

import faces
import numpy as np
from faces import MARGIN, RIGHT, corpus
from libcontact._core import lib
from libcontact.projection import METHODS

HERE = Path(__file__).parent
ROOT = HERE.parent
TOLERANCES = [10.0**-k for k in range(2, 15)]
ORDINARY, HARD_EVERY, ROUNDS = 400, 2, 7
FACE = np.dtype([("kind", np.int32), ("fill", np.int32), ("node", np.float64, (8, 3))])
NLOPT = {
    "NLopt SLSQP": "LD_SLSQP",
    "NLopt BOBYQA": "LN_BOBYQA",
    "NLopt NELDERMEAD": "LN_NELDERMEAD",
}
NLOPT_CALLS = (
    "create",
    "destroy",
    "set_min_objective",
    "set_lower_bounds",
    "set_upper_bounds",
    "set_xtol_abs1",
    "set_maxeval",
    "set_initial_step1",
    "optimize",
)
GSL = {"GSL nmsimplex2": "bench_gsl_nmsimplex2", "GSL bfgs2": "bench_gsl_bfgs2"}
CLOSED = ("robust", "certified")  # methods that know the edges of the face


class Pairs(ctypes.Structure):
    """``pairs`` of projection_loops.c, and the arrays it points to."""

    _fields_ = [
        ("count", ctypes.c_int64),
        ("face", ctypes.c_void_p),
        ("point", ctypes.c_void_p),
        ("tolerance", ctypes.c_double),
        ("xi", ctypes.c_void_p),
        ("distance", ctypes.c_void_p),
        ("evaluations", ctypes.c_void_p),
        ("status", ctypes.c_void_p),
    ]

    def __init__(self, kinds, nodes, points):
        m = len(points)
        self.table = np.zeros(m, FACE)
        self.table["kind"], self.table["node"] = kinds, nodes
        self.points = np.ascontiguousarray(points)
        self.closest, self.distances = np.full((m, 2), np.nan), np.full(m, np.nan)
        self.calls, self.states = np.zeros(m, np.int32), np.zeros(m, np.int32)
        super().__init__(
            m,
            *(a.ctypes.data for a in (self.table, self.points)),
            1e-10,
            *(a.ctypes.data for a in (self.closest, self.distances, self.calls, self.states)),
        )


# -- The loops ------------------------------------------------------------------------------------------------------
def build(folder: Path) -> ctypes.CDLL:
    """projection_loops.c as a shared library with the archive of the build, and with GSL if it was found."""
    target = folder / "loops.so"
    command = [
        os.environ.get("CC", "cc"),
        "-O3",
        "-std=c99",
        "-ffp-contract=off",
        "-fno-math-errno",
        "-fPIC",
        "-shared",
        "-fvisibility=hidden",
        f"-I{ROOT / 'libcontact' / 'include'}",
        str(HERE / "projection_loops.c"),
        str(ROOT / "build" / "lib" / "libcontact.a"),
        "-o",
        str(target),
    ]
    gsl = subprocess.run(
        ["pkg-config", "--cflags", "--libs", "gsl"], capture_output=True, text=True
    )
    for extra in (["-DHAVE_GSL", *gsl.stdout.split()] if gsl.returncode == 0 else None, []):
        if (
            extra is not None
            and subprocess.run(
                [*command, *extra, "-lm", "-fopenmp"], capture_output=True
            ).returncode
            == 0
        ):
            break
    loops = ctypes.CDLL(str(target))
    for name in ("bench_ours", "bench_warm", "bench_batch", "bench_nlopt", *GSL.values()):
        if hasattr(loops, name):
            getattr(loops, name).restype = ctypes.c_double
    return loops


def nlopt_table():
    """NLopt's C functions from its wheel, and its names of methods; None if it is not installed."""
    try:
        import nlopt

        own = ctypes.CDLL(nlopt._nlopt.__file__)
        return (ctypes.c_void_p * len(NLOPT_CALLS))(
            *(ctypes.cast(own["nlopt_" + name], ctypes.c_void_p) for name in NLOPT_CALLS)
        ), nlopt
    except (ImportError, AttributeError, OSError):
        return None


def solvers(loops) -> dict:
    """Name -> function(pairs, tolerance) that returns seconds, for each method and each installed library."""
    out = {}

    def add(name, call):
        def run(pairs, tolerance):
            pairs.tolerance = tolerance
            return call(pairs)

        out[name] = run

    for name in METHODS:
        add(name, lambda pairs, n=METHODS[name]: loops.bench_ours(ctypes.byref(pairs), n))
    found = nlopt_table()
    if found is not None:
        table, nlopt = found
        for name, constant in NLOPT.items():
            add(
                name,
                lambda pairs, n=getattr(nlopt, constant): loops.bench_nlopt(
                    ctypes.byref(pairs), table, n
                ),
            )
    for name, function in GSL.items():
        if hasattr(loops, function):
            add(name, lambda pairs, f=function: getattr(loops, f)(ctypes.byref(pairs)))
    return out


# -- What is measured ------------------------------------------------------------------------------
def work_and_precision(run, pairs, xi, distance, size) -> list[dict]:
    """For each tolerance: evaluations, ns and errors; without xi no error in xi."""
    rows = []
    for tolerance in TOLERANCES:
        seconds = min(run(pairs, tolerance) for _ in range(2))
        error = np.nan_to_num(
            np.abs(pairs.distances - distance) / np.maximum(distance, size), nan=np.inf
        )
        row = {
            "tolerance": tolerance,
            "evaluations": float(np.mean(pairs.calls)),
            "ns": 1e9 * seconds / len(distance),
            "distance_error": float(np.median(error)),
            "wrong": float(np.mean(error > RIGHT)),
        }
        if xi is not None:
            row["xi_error"] = float(np.median(np.max(np.abs(pairs.closest - xi), axis=1)))
        rows.append(row)
    return rows


def is_outside(pairs, tolerance):
    x, y = pairs.closest.T
    quadrilateral = np.maximum(np.abs(x), np.abs(y)) > 1 + tolerance
    return np.where(
        pairs.table["kind"] < 2,
        quadrilateral,
        (np.minimum(x, y) < -tolerance) | (x + y > 1 + tolerance),
    )


def success(run, closed, pairs, cases) -> np.ndarray:
    """Which results are correct? An unconstrained search may return "outside" if the minimum is not
    inside."""
    run(pairs, 1e-10)
    return faces.right(cases, pairs.distances, is_outside(pairs, 1e-10) & (not closed))


def speeds(loops, run) -> dict:
    """Seconds of alternating runs, so that a slower machine affects all. The least of the rounds is the
    least disturbed one; ratios are relative to robust."""
    nodes, points, _, _ = faces.ordinary(2048, seed=11)
    pairs = Pairs(lib.CT_Q8, nodes, points)
    loose = {"GSL bfgs2": 1e-8, "GSL nmsimplex2": 1e-8}  # which do not reach 1e-10
    others = ("simplex", "certified", "newton", "NLopt SLSQP", *loose)
    names = [
        "robust",
        *(name for name in others if name in run),
        "batch",
        "robust warm",
        "batch warm",
    ]
    times = {name: [] for name in names}
    lanes, point_lanes, closest, arrays = batch_of(nodes, points)

    def batch(first):
        number, tolerance = ctypes.c_int64(len(points)), ctypes.c_double(1e-10)
        return loops.bench_batch(lib.CT_Q8, number, lanes, point_lanes, first, tolerance, closest)

    start = None
    for _ in range(ROUNDS):
        for name in times:
            if name == "batch":
                own = batch(None)
                start = arrays[0] + 0.01
            elif name == "robust warm":
                pairs.closest[:] = start.transpose(0, 2, 1).reshape(-1, 2)
                own = loops.bench_warm(ctypes.byref(pairs))
            elif name == "batch warm":
                own = batch(ctypes.c_void_p(start.ctypes.data))
            else:
                own = run[name](pairs, loose.get(name, 1e-10))
            times[name].append(own)
    table = {}
    for name, row in times.items():
        own = times["robust warm" if "warm" in name else "robust"]
        ratios = [a / b for a, b in zip(row, own)]
        table[name] = {
            "tolerance": loose.get(name, 1e-10),
            "ns": 1e9 * min(row) / len(points),
            "times_robust": min(row) / min(own),
            "range": [min(ratios), max(ratios)],
        }
    return table


def batch_of(nodes, points):
    """Q8 faces and points in lanes, with memory for the closest points; the arrays are returned to keep
    them alive."""
    m = len(points)
    blocks = -(-m // 8)
    padded = np.minimum(np.arange(8 * blocks), m - 1)
    lanes, point_lanes = (
        np.ascontiguousarray(rows[padded].reshape(blocks, 8, -1, 3).transpose(0, 2, 3, 1))
        for rows in (np.asarray(nodes), np.asarray(points))
    )
    arrays = [
        np.zeros((blocks, 2, 8)),
        *(np.zeros((blocks, 8)) for _ in range(2)),
        np.zeros((blocks, 3, 8)),
        *(np.zeros((blocks, 8), np.int32) for _ in range(2)),
    ]
    closest = (ctypes.c_void_p * 6)(*(a.ctypes.data for a in arrays))
    arrays += [lanes, point_lanes]
    return (
        ctypes.c_void_p(lanes.ctypes.data),
        ctypes.c_void_p(point_lanes.ctypes.data),
        closest,
        arrays,
    )


def measure() -> dict:
    with tempfile.TemporaryDirectory() as folder:
        loops = build(Path(folder))
        run = solvers(loops)
        nodes, points, xi, gaps = faces.ordinary(ORDINARY)
        sizes = np.array([corpus.face_size(own) for own in nodes])
        ordinary = Pairs(lib.CT_Q8, nodes, points)
        cases = corpus.load()
        hard = [c for c in cases if c["category"] != "ordinary" and c["margin"] > MARGIN][
            ::HARD_EVERY
        ]
        result = {
            "ordinary": {},
            "hard": {},
            "success": {},
            "categories": sorted({c["category"] for c in cases}),
            "cases": len(cases),
        }
        for name, own in run.items():
            result["ordinary"][name] = work_and_precision(own, ordinary, xi, gaps, sizes)
            result["hard"][name] = work_and_precision(own, pairs_of(hard), None, *truths(hard))
            right = success(own, name in CLOSED, pairs_of(cases), cases)
            result["success"][name] = {
                category: float(
                    np.mean([r for r, c in zip(right, cases) if c["category"] == category])
                )
                for category in result["categories"]
            } | {"all": float(np.mean(right))}
        result["speeds"] = speeds(loops, run)
        del loops
    result["missing"] = [name for name in [*NLOPT, *GSL] if name not in run]
    return result


def pairs_of(cases) -> Pairs:
    nodes = np.zeros((len(cases), 8, 3))
    for row, case in zip(nodes, cases):
        row[: len(case["nodes"])] = case["nodes"]
    return Pairs(
        [corpus.KINDS.index(c["kind"]) for c in cases], nodes, np.array([c["point"] for c in cases])
    )


def truths(cases):
    return np.array([c["distance"] for c in cases]), np.array(
        [corpus.face_size(c["nodes"]) for c in cases]
    )


# -- Tables and pictures ---------------------------------------------------------------------------
def report(result: dict) -> str:
    lines = [
        f"closest points on {ORDINARY} ordinary Q8 faces, tolerance 1e-10 (closest points known by construction; errors are medians):",
        f"  {'':18} {'evaluations':>11} {'ns':>9} {'error in xi':>12} {'in distance':>12}",
    ]
    for name, rows in result["ordinary"].items():
        row = rows[TOLERANCES.index(1e-10)]
        lines.append(
            f"  {name:18} {row['evaluations']:11.1f} {row['ns']:9.0f} {row['xi_error']:12.1e} {row['distance_error']:12.1e}"
        )
    lines.append(
        "speed on 2048 ordinary Q8 faces from node coordinates, relative to robust at 1e-10 (warm: to robust warm), least and "
        f"range of {ROUNDS} alternating rounds:"
    )
    for name, row in result["speeds"].items():
        low, high = row["range"]
        lines.append(
            f"  {name:18} at {row['tolerance']:.0e} {row['ns']:9.0f} ns  {row['times_robust']:7.2f}  ({low:.2f} to {high:.2f})"
        )
    names = list(result["success"])
    lines.append(
        f'results correct to {RIGHT:.0e} in % of {result["cases"]} hard cases (unconstrained searches may return "outside" if the minimum is not inside;'
    )
    lines.append("NLopt has the box about the reference face):")
    lines += [f"  {chr(97 + i)}  {name}" for i, name in enumerate(names)]
    lines.append("  " + " " * 20 + "".join(f"{chr(97 + i):>6}" for i in range(len(names))))
    for category in [*result["categories"], "all"]:
        lines.append(
            f"  {category:20}"
            + "".join(f"{100 * result['success'][name][category]:6.1f}" for name in names)
        )
    lines += [f"  {name}: not installed here" for name in result["missing"]]
    return "\n".join(lines)


def draw(result: dict, path: Path) -> None:
    """Draw work against precision."""
    import matplotlib.pyplot as plt

    fig, axes = plt.subplots(2, 3, figsize=(15, 9), layout="constrained")
    colour = dict(zip(result["ordinary"], plt.get_cmap("tab20").colors))
    for row, (which, error) in zip(axes, (("ordinary", "xi_error"), ("hard", "wrong"))):
        for name, table in result[which].items():
            style = {
                "color": colour[name],
                "marker": ".",
                "ls": "-" if name in METHODS else "--",
                "label": name,
            }
            value = np.maximum([r[error] for r in table], 1e-17 if error == "xi_error" else 1e-3)
            row[0].loglog([r["evaluations"] for r in table], value, **style)
            row[1].loglog([r["ns"] for r in table], value, **style)
            row[2].loglog(
                [r["tolerance"] for r in table],
                np.maximum([r["distance_error"] for r in table], 1e-17),
                **style,
            )
        words = {
            "xi_error": "median error in ξ",
            "wrong": "fraction of distances with an error above 1e-6 (1e-3: none)",
        }[error]
        row[0].set(
            xlabel="evaluations of f",
            ylabel=words,
            title={"ordinary": "ordinary faces", "hard": "hard faces, closest point inside"}[which],
        )
        row[1].set(xlabel="ns", ylabel=words)
        row[2].set(xlabel="tolerance", ylabel="median error in distance")
    axes[0, 2].legend(fontsize=7, ncols=2)
    fig.savefig(path, dpi=130)
    plt.close(fig)
