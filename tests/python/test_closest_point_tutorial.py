"""Tutorial 02 asserts what it claims: run it."""

import os
import subprocess
import sys
from pathlib import Path

TUTORIAL = Path(__file__).resolve().parents[2] / "tutorials" / "02_closest_point.py"


def test_tutorial_02_runs_and_draws(tmp_path):
    environment = {**os.environ, "MPLBACKEND": "Agg", "LIBCONTACT_FIGURES": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, str(TUTORIAL)],
        capture_output=True,
        text=True,
        env=environment,
        cwd=tmp_path,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    for name in ("face", "starts", "paths", "work", "floor"):
        assert (tmp_path / f"closest_point_{name}.png").stat().st_size > 10_000
    assert "finds the closest point from" in done.stdout
