"""Comparison of the planner's predictions with true errors and times: ``python accuracy/planned.py
[--trials SECONDS] [--grid] [NAME ...]`` plans the scenes below for 5, 2 and 1 %, runs each choice,
and prints requested, expected and true error, predicted and measured time. ``--grid`` also runs each
setting of the list on meshes in steps of 2^(1/2), up to runs as long as the most expensive choice, and
prints how much less the cheapest run costs that truly meets the error. Use a machine without other load.
"""

from __future__ import annotations

import os
import sys
import time as clock
import warnings
from collections.abc import Iterator
from typing import Any, NamedTuple

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from libcontact.planning.answer import functional, plates  # noqa: E402
from libcontact.planning.planner import COARSEST, FINER, Planner  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402

import libcontact as ct  # noqa: E402

ASKED = (0.05, 0.02, 0.01)
# The sphere's force at the end of its displacement has no closed form, because the block is finite and
# moves: computed with 40 cells along an edge, with the default penalty and with beta 4.
HERTZ = -26.42


class Known(NamedTuple):
    """A scene with a known true error: from the closed form of the plates, or from the exact value of a
    functional."""

    scene: ct.Scene
    functional: str | None = None
    exact: float = 0.0

    def error(self, run: ct.Run, scene: ct.Scene) -> float:
        """The true error of a run."""
        problem = scene._built(None)
        if self.functional:
            return abs(functional(problem, self.functional).value(run) / self.exact - 1.0)
        found = plates(problem)
        assert found is not None
        return found.error(problem, run)


def with_probe(name: str, **probe: Any) -> ct.Scene:
    data = ct.Scene.load(ct.example(name)).data
    data["probe"] = [{"name": "probe", **probe}]
    data["output"] = {"every": 10**9}
    return ct.Scene(data)


def plates_until(nu: float, end: float) -> ct.Scene:
    data = ct.Scene.load(ct.example("plates")).data
    data["material"][0]["poisson"] = nu
    data["time"]["end_c1t_over"]["value"] = end
    data["output"] = {"every": 10**9}
    return ct.Scene(data)


def known() -> Iterator[tuple[str, Known]]:
    """
    The scenes by name. The bar leaves the wall with the momentum m v = 0.1 * 10. The bouncing bar meets the
    floor with v = 10, and its free end reverses when the wave returns from it, after
    5 + v L / c + g (L / c)^2 / 2 ... = 8 + 8/9.
    """
    for nu in (0.3, 0.4):
        for end in (0.56, 0.8):
            yield f"plates, nu = {nu}, c1 t / d = {end}", Known(plates_until(nu, end))
    bar = with_probe("bar_on_a_wall", surface="bar.x_max")
    yield "bar on a wall", Known(bar, "bar.p_x.end", 1.0)
    tip = with_probe("bouncing_bar", surface="bar.z_max")
    yield "bouncing bar", Known(tip, "probe.displacement_z.min", -(8 + 8 / 9))
    yield "Hertz", Known(with_probe("hertz", resultant="obstacle"), "probe.force_z.min", HERTZ)


def taken(scene: ct.Scene) -> tuple[ct.Run, float]:
    """A run, and the least time of several [s], because disturbances only make runs longer."""
    seconds: list[float] = []
    begin = clock.perf_counter()
    while len(seconds) < 10 and (len(seconds) < 3 or clock.perf_counter() - begin < 5.0):
        run = scene.run(progress=False, output=False)
        seconds.append(sum(run.costs.values()))
    return run, min(seconds)


def grid(own: Known, trials: float, longest: float) -> list[tuple[float, float]]:
    """Times [s] and true errors of each setting of the list on the planner's sequence of meshes, up to runs
    of ``longest`` seconds."""
    planner, found = Planner(own.scene, own.functional, trials), []
    finest = max(max(each.cells) for each in planner.lattices)
    for tried in planner.tried:
        scale, seconds = COARSEST / finest, 0.0
        while seconds < longest:
            scene = planner.changed(tried.keys, scale)
            try:
                run, seconds = taken(scene)
            except ct.Error:
                break
            found.append((seconds, own.error(run, scene)))
            scale *= FINER
    return found


def main() -> None:
    words = sys.argv[1:]
    trials = float(words[words.index("--trials") + 1]) if "--trials" in words else 10.0
    names = [word for word in words if not word.startswith("--") and not word[0].isdigit()]
    heads = "scene, requested, expected, true, of requested, predicted, measured, ratio, cheapest, mesh, setting"
    table = Table(*heads.split(", "), box=None, pad_edge=False)
    for name, own in known():
        if names and not any(word in name for word in names):
            continue
        plans = [
            own.scene.plan(error=asked, functional=own.functional, trials=trials) for asked in ASKED
        ]
        runs = [(plan, *taken(plan.scene)) for plan in plans]
        longest = max(seconds for _, _, seconds in runs)
        rivals = grid(own, trials, longest) if "--grid" in words else []
        for asked, (plan, run, seconds) in zip(ASKED, runs):
            true, choice = own.error(run, plan.scene), plan.choice
            least = min((cost for cost, error in rivals if error <= asked), default=float("nan"))
            numbers = [f"{100 * x:.3g} %" for x in (asked, choice.error, true)]
            numbers += [f"{true / asked:.2f}", f"{choice.seconds:.3g} s", f"{seconds:.3g} s"]
            numbers += [f"{seconds / choice.seconds:.2f}", f"{seconds / least:.2f}"]
            table.add_row(name, *numbers, choice.mesh, choice.setting)
            print(f"{name}, {asked:.0%}: {numbers}", file=sys.stderr)
    Console(width=240).print(table)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
