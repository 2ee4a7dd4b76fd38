"""Influence of the penalty factor β on the plate impact: difference from the reference, energy,
stable step."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import libcontact as ct

SCENES = Path(__file__).parent.parent / "tutorials" / "scenes"
BETAS = [0.1, 0.5, 1, 3, 4, 5, 10, 20]
PLATEAU = 7 / 3


def line(run: ct.Run) -> np.ndarray:
    """σ_x* in the row of elements next to z = 0 of the right plate."""
    young, nu, rho, v0 = 2.1e5, 0.3, 7.8e-9, 1000.0
    lame = young * nu / ((1 + nu) * (1 - 2 * nu))
    c1 = np.sqrt((lame + young / (1 + nu)) / rho)
    body = run.state["right"]
    row = body.centres[:, 2] < 1.5 * body.centres[:, 2].min()
    return body.stress[row, 0] * c1 / (lame * v0)


def measure() -> list[dict]:
    reference = line(
        ct.Scene.load(SCENES / "plates_reference.toml").run(progress=False, output=False)
    )
    rows = []
    for beta in BETAS:
        data = ct.Scene.load(SCENES / "plates.toml").data
        data["contact"][0]["beta"] = beta
        data["output"] = {"every": 8}
        scene = ct.Scene(data)
        run = scene.run(progress=False, output=False)
        total = run.energy["total"]
        stable = scene.explain().data["time"]
        rows.append(
            {
                "beta": beta,
                "difference_percent": 100 * float(np.mean(np.abs(line(run) - reference))) / PLATEAU,
                "energy_deviation": float(np.max(np.abs(total / total[0] - 1))),
                "stable_courant": stable["stable"] / stable["dt_courant"],
            }
        )
    return rows


def report(rows: list[dict]) -> str:
    lines = [
        "β of the penalty β E / h: mean |contact - reference| on Fig. 4's line, energy, stable Courant number (run at 0.125)",
        f"{'β':>6} {'difference':>11} {'energy':>9} {'stable':>7}",
    ]
    for row in rows:
        lines.append(
            f"{row['beta']:6g} {row['difference_percent']:9.2f} % {row['energy_deviation']:9.1e} {row['stable_courant']:7.3f}"
        )
    return "\n".join(lines)
