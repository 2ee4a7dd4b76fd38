"""The command line: ``libcontact run | explain | plan | schema | plot``. Exit codes: 0 ok, 2 bad input, 3 run failed, 130 Ctrl-C."""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import os
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .run import Run

OK, BAD_INPUT, RUN_FAILED, INTERRUPTED = 0, 2, 3, 130


class BadInput(ValueError):
    """An invalid argument on the command line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """
    Run one command.

    Parameters
    ----------
    arguments : sequence of str, optional
        The words after ``libcontact``; by default those of the process.

    Returns
    -------
    int
        The exit code. Errors of the user are reported in one line on stderr.
    """
    try:
        return _answer(arguments)
    finally:
        _drop_what_stdout_refuses()


def _answer(arguments: Sequence[str] | None) -> int:
    """The exit code of one command, after a message for whatever went wrong."""
    # Ctrl-C among these imports is left to the caller.
    from .errors import Error, NotBuiltIn, SceneWarning
    from .run import RunError
    from .schema import SceneError

    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda text, *rest, **more: _say(f"warning: {text}", "yellow")
            code = _command(arguments)
        if sys.stdout is not None:
            sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        _say("interrupted")
        return INTERRUPTED
    except BrokenPipeError:  # as in libcontact explain ... | head
        return OK
    except (SceneError, NotBuiltIn, BadInput, OSError) as error:
        _say(f"error: {getattr(error, 'strerror', None) or error}", "red")
        return BAD_INPUT
    except (Error, MemoryError, SceneWarning) as error:  # Python may be told to end at a warning
        _say(f"the run failed: {error if str(error) else 'out of memory'}", "red")
        run = error.run if isinstance(error, RunError) else None
        if run is not None and run.path is not None and len(run.steps):
            _say(f'{len(run.steps)} records up to t = {run.time[-1]:.6g} are kept in "{run.path}"')
        return RUN_FAILED


def _command(arguments: Sequence[str] | None) -> int:
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    return int(options.command(options))


def _drop_what_stdout_refuses() -> None:
    """On a full disk or a closed pipe; Python would try again at its end, and exit with 120."""
    try:
        if sys.stdout is not None:
            sys.stdout.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser() -> argparse.ArgumentParser:
    from ._core import ffi, lib

    version = "libcontact " + ffi.string(lib.ct_version()).decode()
    parser = argparse.ArgumentParser("libcontact", description="Explicit contact-impact by FEM.")
    parser.add_argument("--version", action="version", version=version)
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    run = commands.add_parser("run", help="compute a scene and write its results file")
    run.set_defaults(command=_run)
    run.add_argument("scene", metavar="SCENE.toml")
    run.add_argument("-o", "--output", metavar="FILE", help="results file, instead of the scene's")
    when = "time at which the run ends; the step stays the same"
    run.add_argument("--until", metavar="TIME", type=float, help=when)
    run.add_argument(
        "--threads", metavar="N", type=int, help="number of threads; results do not depend on it"
    )
    run.add_argument(
        "--restart", metavar="FILE", help="continue from the newest record of this file"
    )
    run.add_argument("--quiet", action="store_true", help="print nothing but errors")
    drawn = "draw the end of the run into a PNG beside its results file, or named after the scene"
    run.add_argument("--plot", action="store_true", help=drawn)
    _picture_options(run)

    explain = commands.add_parser("explain", help="show what a scene will compute, and why")
    explain.set_defaults(command=_explain)
    explain.add_argument("scene", metavar="SCENE.toml")

    plan = commands.add_parser(
        "plan", help="choose mesh, step and methods for a given error or run time"
    )
    plan.set_defaults(command=_plan)
    plan.add_argument("scene", metavar="SCENE.toml")
    goal = plan.add_mutually_exclusive_group(required=True)
    goal.add_argument("--error", metavar="5%", type=_fraction, help="relative error to meet")
    goal.add_argument("--seconds", metavar="S", type=float, help="longest run time")
    plan.add_argument(
        "--functional", metavar="NAME", help="number whose error is meant, such as wall.force_x.max"
    )
    plan.add_argument(
        "--trials", metavar="S", type=float, default=10.0, help="time for trial runs (default 10)"
    )
    plan.add_argument("--write", metavar="NEW.toml", help="write the chosen scene to this file")

    schema = commands.add_parser("schema", help="write the JSON Schema of scenes, for editors")
    schema.set_defaults(command=_schema)

    plot = commands.add_parser("plot", help="draw instants and the energies of a run")
    plot.set_defaults(command=_plot)
    plot.add_argument("file", metavar="RUN.vtkhdf")
    plot.add_argument("-o", "--output", metavar="PNG", help="picture, by default RUN.png")
    _picture_options(plot)
    return parser


def _picture_options(parser: argparse.ArgumentParser) -> None:
    field = (
        "mises, contact_pressure, principal_max, stress_xx, velocity_z, ... (default: by the scene)"
    )
    parser.add_argument("--field", help=field)
    scale = "magnify displacements (default 1, or more if they are small)"
    parser.add_argument("--scale", type=float, help=scale)
    view = "sides that the viewer sees, such as y_min or x_max+y_min+z_max"
    parser.add_argument("--view", metavar="SIDES", help=view)
    parser.add_argument("--instants", metavar="N", type=int, default=4, help="number of instants")


def _run(options: argparse.Namespace) -> int:
    from .scene import Scene

    scene = Scene.load(options.scene)
    if options.output == "":
        raise BadInput("the name of the output is empty")
    named = options.output or scene.data.get("output", {}).get("file")
    if options.plot:
        _check_picture(options)
    keys = ("restart", "until", "output", "threads")
    run = scene.run(progress=not options.quiet, **{key: getattr(options, key) for key in keys})
    if not options.quiet:
        _report(run)
    if run.interrupted:
        kept = f'; {len(run.steps)} records are kept in "{run.path}"' if run.path else ""
        _say(f"interrupted at t = {run.time[-1]:.6g}{kept}")
        return INTERRUPTED
    if options.plot:
        _draw(run, Path(run.path or Path(options.scene).name).with_suffix(".png"), options)
    if named and (run.path is None or not run.path.exists()):
        _say(f'the results file "{named}" was not written', "red")
        return RUN_FAILED
    return OK


def _report(run: Run) -> None:
    """Energy balance and size of a run, to check its quality."""
    energy, steps = run.energy, run.steps
    last, size = energy[-1], max(abs(energy[name]).max() for name in ("kinetic", "strain")) or 1.0
    change, balance = last["total"] - energy["total"][0], abs(energy["balance"]).max()
    unit = run.units.label("energy") if run.units else ""
    parts = ", ".join(f"{name} {last[name]:.6g}" for name in ("kinetic", "strain", "contact"))
    took = f"in {run.seconds:.3g} s, {len(steps)} records"
    _say(f"{steps[-1] - steps[0]} steps to t = {last['time']:.6g} {took}")
    relative = f"{change / size:.2e}, work balance {balance / size:.1e} (relative)"
    _say(f"energy: {parts} {unit}; total changed by {relative}")
    if run.path is not None:
        _say(f'results in "{run.path}"')


def _explain(options: argparse.Namespace) -> int:
    from .scene import Scene

    text = Scene.load(options.scene).explain()
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")
    print(text, flush=True)
    return OK


def _fraction(text: str) -> float:
    """5% or 0.05."""
    return float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)


def _plan(options: argparse.Namespace) -> int:
    from .scene import Scene

    if options.write is not None and Path(options.write).exists():
        raise BadInput(f'"{options.write}" exists already')
    keys = ("error", "seconds", "functional", "trials")
    plan = Scene.load(options.scene).plan(**{key: getattr(options, key) for key in keys})
    print(plan, flush=True)
    if options.write is not None:
        plan.scene.save(options.write)
        _say(f'scene in "{options.write}"')
    return INTERRUPTED if plan.interrupted else OK


def _schema(options: argparse.Namespace) -> int:
    import json

    from .parts import schema

    print(json.dumps(schema(), indent=2), flush=True)
    return OK


def _plot(options: argparse.Namespace) -> int:
    from .run import Run

    _check_picture(options)
    try:
        run = Run.load(options.file)
    except ImportError as error:
        raise BadInput(f"plotting needs h5py ({error})") from None
    except ValueError as error:
        raise BadInput(str(error)) from None
    _draw(run, Path(options.output or Path(options.file).with_suffix(".png")), options)
    return OK


def _check_picture(options: argparse.Namespace) -> None:
    """Refuse what can't be drawn before a run, not after it."""
    from .drawing import check_view
    from .run import COMPONENTS
    from .schema import suggestion

    if options.scale is not None and not abs(options.scale) <= 1e12:
        raise BadInput(f"the scale {options.scale:g} can't be drawn")
    if options.field is not None and options.field not in COMPONENTS:
        near = suggestion(options.field, COMPONENTS)
        raise BadInput(f'no component is named "{options.field}"{near}')
    if options.instants < 1:
        raise BadInput(f"--instants is {options.instants}; at least one is needed")
    try:
        check_view(options.view or "z_max")
    except ValueError as error:
        raise BadInput(str(error)) from None
    if importlib.util.find_spec("matplotlib") is None:
        raise BadInput('plotting needs matplotlib: pip install "libcontact[plot]"')


def _draw(run: Run, target: Path, options: argparse.Namespace) -> None:
    from .picture import picture

    keys = ("field", "view", "scale", "instants")
    try:
        picture(run, target, **{key: getattr(options, key) for key in keys})
    except OSError as error:
        raise BadInput(f'"{target}" can\'t be written: {error.strerror or error}') from None
    except ValueError as error:
        raise BadInput(str(error)) from None
    if not getattr(options, "quiet", False):
        _say(f'picture in "{target}"')


def _say(text: str, style: str = "") -> None:
    """A line on stderr, coloured where stderr is a terminal."""
    from rich.console import Console
    from rich.text import Text

    # A message that can't be shown does not change the result.
    with contextlib.suppress(OSError):
        if sys.stderr is not None:
            Console(stderr=True).print(Text(text, style), soft_wrap=True)
