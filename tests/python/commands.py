"""Programs that tests run."""

import subprocess


def captured(command, **more):
    """Run a command and keep what it writes, as text."""
    return subprocess.run(command, capture_output=True, text=True, **more)
