"""
What a loose tolerance of the contact forces changes (chapter "All points of a step together"). Each scene runs once
with each tolerance. FOLDER/tolerance.jsonl keeps the completed rows, so the same command continues; ``--book`` writes
the table of the chapter.

A row compares a run with that of the tolerance 1e-10: final velocities (rms over the nodes, relative to their own rms),
the energy of the bodies at the end (relative to the largest energy or work), the errors of Figs. 4 and 5 and of the
price list (relative to the errors themselves), and the work of the solver. In some scenes a difference of round-off
grows until it is as large as the motion, as when a point misses an edge: the tolerance 1e-12 shows which.
"""

from __future__ import annotations

import csv
import json
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "accuracy")]

import animals  # noqa: E402
import campaign  # noqa: E402
import cases  # noqa: E402
import lab  # noqa: E402
import numpy as np  # noqa: E402
import price  # noqa: E402
import program  # noqa: E402
from libcontact._core import ffi, lib  # noqa: E402
from libcontact.bridge import call  # noqa: E402
from libcontact.problem import new_state  # noqa: E402

import libcontact as ct  # noqa: E402

BOOK = HERE.parent / "docs" / "theory" / "tolerance.csv"
TIGHT = 1e-10
TOLERANCES = (1e-12, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2)
ALIKE = 1e-3  # what counts as the same
Scenes = Iterator[tuple[str, ct.Scene]]
Rows = Iterator[dict[str, Any]]


def zoo() -> Scenes:
    """The everyday scenes of the zoo, and some of them with hex20."""
    for animal in animals.ANIMALS:
        yield animal.__name__, animal(animals.Options()).stage.scene(animal.__name__)
    for animal in (animals.part_on_a_slab, animals.stack, animals.closed_impact):
        name = f"{animal.__name__}, hex20"
        yield name, animal(animals.Options(element="hex20")).stage.scene(name)


def laboratory() -> Scenes:
    """The short cases of the laboratory that have the default law."""
    found: list[tuple[str, ct.Scene]] = []

    def keep(case: str, made: ct.Scene, *, enforcement: str, **_: Any) -> lab.Row:
        found.append((case, made))
        return lab.Row(case, enforcement, None, 1, 1, 1, 0, 0, 0, 0, 0, "passes")

    plain, cases.classify = cases.classify, keep
    for case in CASES:
        for _ in case(True):
            pass
    cases.classify = plain
    default = [(name, made) for name, made in found if is_default(made)]
    for k, (name, made) in enumerate(default):
        yield f"{name} {k}", made


CASES = (
    *(cases.bar_on_a_wall, cases.two_bars, cases.plate_impact, cases.plates_with_each_method),
    *(cases.unlike_meshes, cases.spinning_ring, cases.crossing_rings, cases.sliding_block),
    *(cases.thin_plates, cases.distorted_mesh, cases.aspect_ratio, cases.vibration),
)


def is_default(made: ct.Scene) -> bool:
    data = made.data
    touching = [*data.get("contact", ()), *data.get("obstacle", ())]
    return bool(touching) and all(
        each.get("enforcement", lab.DEFAULT) == lab.DEFAULT for each in touching
    )


def shipped() -> Scenes:
    """The shipped scenes, with the default penalty; Hertz on half of the elements."""
    for name in ("bar_on_a_wall", "block_on_an_incline", "bouncing_bar", "hertz"):
        data = ct.Scene.load(ct.example(name)).data
        for each in data["obstacle"]:
            each.pop("beta", None)
        if name == "hertz":
            data["body"][0]["box"]["cells"] = [10, 10, 10]
        yield name, ct.Scene(data)


def with_tolerance(made: ct.Scene, tolerance: float) -> ct.Scene:
    data = made.data
    data["time"]["force_tolerance"] = tolerance
    return ct.Scene(data)


def end_of(made: ct.Scene) -> tuple[np.ndarray, dict[str, float]]:
    """Velocities at the end of a scene; energies there, work of the solver, steps that did not converge."""
    problem = made._built(None)
    state, energy = new_state(problem), ffi.new("ct_energy *")
    call(lib.ct_energy_of, problem.pointer, state, energy)
    scale = abs(energy.total)
    call(lib.ct_run, problem.pointer, state, problem.step_count, ffi.NULL, 0)
    call(lib.ct_energy_of, problem.pointer, state, energy)
    size = 24 * problem.pointer.node_count
    velocity = np.frombuffer(ffi.buffer(state.velocity, size)).copy()
    own = energy.kinetic + energy.strain
    numbers = {
        "own": own,
        "scale": max(scale, abs(energy.external), own),
        "rounds": state.constraint_rounds,
        "unconverged": state.unconverged,
    }
    return velocity, numbers


def compare(made: ct.Scene) -> Rows:
    """A scene with each tolerance."""
    tight, same = end_of(with_tolerance(made, TIGHT))
    for tolerance in TOLERANCES:
        velocity, own = end_of(with_tolerance(made, tolerance))
        yield {
            "tolerance": tolerance,
            "velocity": float(np.linalg.norm(velocity - tight) / np.linalg.norm(tight)),
            "energy": abs(own["own"] - same["own"]) / max(same["scale"], 1e-300),
            "rounds": own["rounds"] / max(same["rounds"], 1),
            "unconverged": own["unconverged"],
        }


def errors_of(cells: int, keys: campaign.Keys) -> Rows:
    """The errors of a method of the price list with each tolerance."""

    def errors(tolerance: float) -> dict[str, float]:
        own = campaign.case("contact", cells, keys | {"time.force_tolerance": tolerance})
        return price.times_of(own)[1]

    tight = errors(TIGHT)
    for tolerance in TOLERANCES:
        found = errors(tolerance)
        change = max(abs(found[each] / tight[each] - 1.0) for each in price.ERRORS)
        yield {"tolerance": tolerance, "errors": change}


def prices() -> Iterator[tuple[str, Callable[[], Rows]]]:
    """The methods that have the default law."""
    for cells in (12, 25, 50):
        for method, keys in campaign.METHODS.items():
            if "contact.enforcement" not in keys and (cells < 50 or keys == campaign.BEST):
                yield f"{method}, {cells}", partial(errors_of, cells, keys)


def listed(scenes: Callable[[], Scenes]) -> Callable[[], Iterator[tuple[str, Callable[[], Rows]]]]:
    return lambda: ((name, partial(compare, made)) for name, made in scenes())


GROUPS: dict[str, Callable[[], Iterator[tuple[str, Callable[[], Rows]]]]] = {
    "price list": prices,
    "laboratory": listed(laboratory),
    "zoo": listed(zoo),
    "shipped scenes": listed(shipped),
}


def read(file: Path) -> list[dict[str, Any]]:
    if not file.exists():
        return []
    return [json.loads(line) for line in file.read_text(encoding="utf-8").splitlines()]


def write_table(rows: list[dict[str, Any]]) -> None:
    """One line per tolerance: the largest change of an error of the price list, and of all other scenes the median
    of the differences, how many of them are below 0.1 %, and the geometric mean of the solver's work."""
    with BOOK.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        head = [
            "tolerance",
            "figures and prices",
            "energy",
            "within 0.1 %",
            "velocities",
            "within 0.1 %",
            "rounds",
        ]
        table.writerow(head)
        for tolerance in TOLERANCES:
            own = [row for row in rows if row["tolerance"] == tolerance]
            scenes = [row for row in own if "velocity" in row]
            errors = max(row["errors"] for row in own if "errors" in row)
            cells = [f"{tolerance:g}", f"{errors:.1e}"]
            for name in ("energy", "velocity"):
                values = np.array([row[name] for row in scenes])
                cells += [f"{np.median(values):.0e}", f"{(values <= ALIKE).sum()} of {len(values)}"]
            rounds = np.exp(np.mean([np.log(row["rounds"]) for row in scenes if row["rounds"] > 0]))
            table.writerow([*cells, f"{rounds:.2f}"])


def main() -> None:
    given = program.parser(__doc__, GROUPS, "for tolerance.jsonl").parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    file = given.folder / "tolerance.jsonl"
    warnings.simplefilter("ignore")
    known = {(row["group"], row["scene"]) for row in read(file)}
    for group in given.cases or GROUPS:
        for name, rows in GROUPS[group]():
            if (group, name) in known:
                continue
            try:
                found = [{"group": group, "scene": name} | row for row in rows()]
            except ct.Error as error:
                print(f"{group}, {name}: left out, {str(error)[:100]}", flush=True)
                continue
            with file.open("a", encoding="utf-8") as out:
                out.writelines(json.dumps(row) + "\n" for row in found)
            print(
                group,
                name,
                *(
                    f"{row['tolerance']:g}: {row.get('velocity', row.get('errors')):.1e}"
                    for row in found
                ),
                flush=True,
            )
    if given.book:
        write_table(read(file))


if __name__ == "__main__":
    main()
