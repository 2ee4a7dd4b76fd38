"""Moving pictures of runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .drawing import Drawing, readable, title_of

if TYPE_CHECKING:
    from ..run import Run

# Writers of matplotlib by the ending of the file.
WRITERS = {".gif": "pillow", ".mp4": "ffmpeg"}
# Default number of pictures, and of pictures per second.
FRAMES, RATE = 60, 15
# Size of a picture [inch].
SIZE = (8.0, 6.0)


def animate(
    run: Run, path: Path, *, frames: int = FRAMES, rate: int = RATE, **options: Any
) -> None:
    """
    Draw the recorded states of a run, one after the other, into a GIF or an MP4.

    Parameters
    ----------
    run
        The run.
    path
        The file; its ending, ``.gif`` or ``.mp4``, selects the format.
    frames
        Largest number of pictures, at equal intervals in the records.
    rate
        Pictures per second.
    **options
        ``field``, ``view`` and ``scale``, as for :func:`libcontact.pictures.picture.plot_run`.

    Raises
    ------
    ValueError
        The format is unknown or can't be written here, or the picture can't be drawn.
    """
    from matplotlib.animation import writers
    from matplotlib.figure import Figure

    name = WRITERS.get(path.suffix.lower())
    if name is None:
        raise ValueError(f'"{path}" has an unknown ending; {" and ".join(WRITERS)} are possible')
    if not writers.is_available(name):
        raise ValueError(f"{path.suffix} needs {name}, which is not installed; write a .gif")
    numbers = np.unique(np.linspace(0, len(run.states) - 1, frames).round().astype(int))
    states = [run.states[i] for i in numbers]
    drawing = Drawing.of(run, states=states, **options)
    figure, writer = Figure(figsize=SIZE, layout="constrained"), writers[name](fps=rate)
    title = title_of(run, SIZE[0])
    factor, unit = readable(run.units, "time", states[-1].time)
    with writer.saving(figure, path, dpi=100):
        for state in states:
            figure.clear()
            axes = figure.subplots()
            patches = drawing.draw(axes, state)
            now = f"{title}\nt = {factor * state.time:.4g} {unit}".rstrip()
            axes.set_title(now, fontsize="medium")
            drawing.colour_bar(patches, axes)
            writer.grab_frame()
