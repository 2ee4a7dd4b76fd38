"""
Contact laws on a bar in one dimension (chapter "Enforcement"): energy that each law loses while contact
lasts, and the part of the surface mode that remains.

The bar has n elements. Element length, wave speed and density are 1, so a step is its Courant number and a
penalty is β. ``--book`` writes the table of the chapter.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import program

# The force of the wall from β, the gaps g_n and g_{n-1}, the gap without the force, the displacement of
# the node by a unit force, and the step.
Law = Callable[[float, float, float, float, float, float], float]
COURANT = (0.03, 0.125, 0.25, 0.5, 0.9, 0.98)
LANDINGS = (0.0, 0.2, 0.4, 0.6, 0.8)
BETAS = (1.0, 2.0, 4.0, 10.0, 40.0, 100.0)


def ramp(share: Callable[[float, float], float]) -> Law:
    """The law of the library, with its dashpot; ``share`` is the function a of β and the step."""

    def force(k: float, g: float, before: float, free: float, moves: float, dt: float) -> float:
        a, p = share(k, dt), min(before, 0.0)
        return max(0.0, -0.5 * k * ((1 + a) * free + (1 - a) * p) / (1 + 0.5 * k * (1 + a) * moves))

    return force


def damped(zeta: float) -> Law:
    """The function a for a damping ratio, as in the library: (ω Δt)² = k Δt²/m with the half mass of the
    last node."""
    return ramp(lambda k, dt: zeta * np.sqrt(1 + 4 / (2 * k * dt * dt)))


def two_ramps(s: float) -> Law:
    """One ramp at the middle of the next step, with a fraction s at its end."""
    m = 0.5 * (1 - s)

    def force(k: float, g: float, before: float, free: float, moves: float, dt: float) -> float:
        lines = ((m, m), (0.0, s), (m, m + s))
        return max(0.0, *(-k * (a * g + h * free) / (1 + k * h * moves) for a, h in lines))

    return force


def multipliers(k: float, g: float, before: float, free: float, moves: float, dt: float) -> float:
    """The gap of the next step is not negative."""
    return max(0.0, -free / moves)


LAWS = {
    "two ramps": two_ramps(0.1),
    "a = 0": damped(0.0),
    "dashpot h/4c": ramp(lambda k, dt: 0.25 / dt),
    "ζ = 0.05": damped(0.05),
    "ζ = 0.15": damped(0.15),
    "ζ = 0.5": damped(0.5),
    "multipliers": multipliers,
}


def bar(law: Law, k: float, dt: float, u: np.ndarray, v: np.ndarray, pull: float, steps: int):
    """Forces of the wall, stress of the first element, and gaps and energies of the bodies half a step later."""
    m = np.ones(len(u))
    m[[0, -1]] = 0.5
    before, rows = u[0] - dt * v[0], np.empty((steps, 5))
    for row in rows:
        stress = np.diff(u)
        f = np.concatenate((stress, [pull])) - np.concatenate(([0.0], stress))
        free = u[0] + dt * (v[0] + dt * f[0] / m[0])
        f[0] += (push := law(k, u[0], before, free, dt * dt / m[0], dt))
        v = v + dt * f / m
        before, after = u[0], u + dt * v
        energy = 0.5 * m @ v**2 + 0.5 * stress @ np.diff(after) - 0.5 * pull * (u[-1] + after[-1])
        row[:] = push, stress[0], u[0], after[0], energy
        u = after
    return rows.T


def impact(law: Law, k: float, dt: float, n: int = 100) -> np.ndarray:
    """Mode next to the contact, error of the force, energy lost, largest force; the worst of the landings."""
    found = []
    for landing in LANDINGS:
        gap, steps = landing * dt, int((2 * n + 40) / dt)
        u, v = np.full(n + 1, gap), np.full(n + 1, -1.0)
        push, stress, *_, energy = bar(law, k, dt, u, v, 0.0, steps)
        t = np.arange(steps) * dt - gap
        held, near = (t >= 30) & (t <= 180), (t >= 20) & (t <= 40)
        force = np.sqrt(np.mean((push[held] - 1) ** 2))
        found.append((np.std(stress[near]), force, 1 - energy[-1] / (0.5 * n), push.max()))
    return np.max(found, axis=0)


def lasting(law: Law, k: float, dt: float, n: int, slow: bool) -> float:
    """Fraction of the energy of an oscillation that is lost per period while the contact stays closed:
    after a jump of the load by half, or in the slowest mode."""
    u, v = -1 / k - np.arange(n + 1.0), np.zeros(n + 1)
    pull, period = (-1.0 if slow else -1.5), 4.0 * n
    if slow:
        stiff = 2 * np.eye(n + 1) - np.eye(n + 1, k=1) - np.eye(n + 1, k=-1)
        stiff[0, 0], stiff[n, n] = 1 + k, 1
        half = np.ones(n + 1)
        half[[0, -1]] = np.sqrt(0.5)
        squares, shapes = np.linalg.eigh(stiff / np.outer(half, half))
        v = 0.05 * shapes[:, 0] / half / (shapes[-1, 0] / half[-1])
        period = 2 * np.pi / np.sqrt(squares[0])
    steps = int(10 * period / dt)
    push, _, now, after, energy = bar(law, k, dt, u, v, pull, steps)
    stored = 0.25 * k * (np.minimum(now, 0) ** 2 + np.minimum(after, 0) ** 2)
    swing = energy + stored + 0.5 * pull**2 * (n + 1 / k)
    return 1 - (swing[-1] / swing[0]) ** (period / dt / steps) if push.min() > 0 else np.nan


def measured(name: str, k: float) -> dict[str, float]:
    """All columns of a law at one penalty, in per cent."""
    hits = np.array([impact(LAWS[name], k, dt) for dt in COURANT])
    row = {
        "mode": hits[:, 0].max(),
        "force": hits[:, 1].max(),
        "impact 0.5": hits[COURANT.index(0.5), 2],
        "impact 0.98": hits[-1, 2],
        "peak": hits[:, 3].max() / 100,
    }
    if name != "multipliers":
        row["settled"] = lasting(LAWS[name], k, 0.5, 10, False)
        row["smooth"] = lasting(LAWS[name], k, 0.5, 20, True)
    return {what: 100 * value for what, value in row.items()}


def main() -> None:
    given, rows = program.parser(__doc__).parse_args(), {}
    for name in LAWS:
        for k in BETAS if name != "multipliers" else (4.0,):
            rows[name, k] = row = measured(name, k)
            print(
                f"{name:<24} β = {k:<5g}", *(f"{what} {value:.3g}" for what, value in row.items())
            )
    if not given.book:
        return
    folder = Path(__file__).resolve().parent.parent / "docs" / "theory"
    shares = ("settled", "smooth", "mode", "force", "impact 0.5", "impact 0.98")
    heads = {share: f"{share}, %" for share in shares} | {"peak": "peak"}
    lines = []
    for (name, k), row in rows.items():
        if k in (1.0, 4.0, 40.0, 100.0):
            cells = {c: f"{row[c]:.2g}" if abs(row[c]) > 1e-6 else "0" for c in row}
            line = {"law": name, "β": "" if name == "multipliers" else f"{k:g}"}
            lines.append(line | {head: cells.get(c, "") for c, head in heads.items()})
    program.write_table(folder / "laws.csv", lines)


if __name__ == "__main__":
    main()
