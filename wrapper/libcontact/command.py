"""The command line: ``libcontact run | explain | plot``. Exit codes: 0 ok, 2 bad input, 3 run failed, 130 Ctrl-C."""

from __future__ import annotations

import argparse
import contextlib
import math
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

OK, BAD_INPUT, RUN_FAILED, INTERRUPTED = 0, 2, 3, 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code; errors of the user come out as one line on stderr."""
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *rest, **more: _say(f"warning: {message}", "yellow")
        return _guarded(options)


def _guarded(options: argparse.Namespace) -> int:
    """The command itself, with what may go wrong turned into messages and exit codes; Ctrl-C among its imports is left to the caller."""
    from .errors import Error, NotBuiltIn, SceneWarning
    from .run import RunError
    from .schema import SceneError

    try:
        return options.command(options)
    except KeyboardInterrupt:
        _say("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        _silence_stdout()
        return OK
    except RunError as error:
        _say(f"the run failed: {error}", "red")
        if error.run is not None and error.run.path is not None and len(error.run.steps):
            _say(
                f'{len(error.run.steps)} records up to t = {error.run.time[-1]:.6g} are kept in "{error.run.path}"'
            )
        return RUN_FAILED
    except (SceneError, NotBuiltIn, BadInput) as error:
        _say(f"error: {error}", "red")
        return BAD_INPUT
    except (Error, MemoryError) as error:
        _say(f"the run failed: {error or 'out of memory'}", "red")
        return RUN_FAILED
    except OSError as error:
        _say(f"error: {error.strerror or error}", "red")
        return BAD_INPUT
    except SceneWarning as warning:  # Python was told to end at a warning
        _say(f"the run failed: {warning}", "red")
        return RUN_FAILED


class BadInput(ValueError):
    """Something on the command line that can't be used."""


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="libcontact", description="Explicit finite-element contact-impact."
    )
    parser.add_argument("--version", action=_Version, help="print the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    run = commands.add_parser(
        "run", help="compute a scene", description="Compute a scene and write its results file."
    )
    run.add_argument("scene", metavar="SCENE.toml")
    run.add_argument(
        "-o", "--output", metavar="FILE", help="results file, instead of the scene's own"
    )
    run.add_argument(
        "--until", metavar="TIME", type=float, help="end at this time (the step stays the same)"
    )
    run.add_argument(
        "--threads", metavar="N", type=int, help="threads; results do not depend on them"
    )
    run.add_argument(
        "--restart", metavar="FILE", help="continue from the newest record of a results file"
    )
    run.add_argument("--quiet", action="store_true", help="print nothing but errors")
    run.set_defaults(command=_run)

    explain = commands.add_parser("explain", help="tell what a scene will compute, and why")
    explain.add_argument("scene", metavar="SCENE.toml")
    explain.set_defaults(command=_explain)

    plot = commands.add_parser("plot", help="draw a field and the energies of a run")
    plot.add_argument("file", metavar="RUN.vtkhdf")
    plot.add_argument(
        "-o", "--output", metavar="PNG", help="picture; by default the name of the run with .png"
    )
    plot.add_argument(
        "--field",
        default="stress_xx",
        help="component to draw, such as stress_xx (the default) or velocity_z",
    )
    plot.add_argument(
        "--scale", type=float, default=1.0, help="magnification of the displacement (default 1)"
    )
    plot.set_defaults(command=_plot)
    return parser


class _Version(argparse.Action):
    """Print the version of the C library that the wrapper was compiled with."""

    def __init__(self, *arguments: Any, **options: Any):
        super().__init__(*arguments, nargs=0, **options)

    def __call__(self, parser: argparse.ArgumentParser, *rest: Any) -> None:
        from ._core import ffi, lib

        print("libcontact " + ffi.string(lib.ct_version()).decode())
        parser.exit(OK)


def _run(options: argparse.Namespace) -> int:
    from .scene import Scene

    scene = Scene.load(options.scene)
    if options.output == "":
        raise BadInput("the name of the output is empty")
    named = options.output or scene.data.get("output", {}).get("file")
    run = scene.run(
        progress=not options.quiet,
        restart=options.restart,
        until=options.until,
        output=options.output,
        threads=options.threads,
    )
    if not options.quiet:
        _report(run)
    if run.interrupted:
        kept = f'; {len(run.steps)} records are kept in "{run.path}"' if run.path else ""
        _say(f"interrupted at t = {run.state.time:.6g}{kept}")
        return INTERRUPTED
    if named and (run.path is None or not run.path.exists()):
        _say(f'the results file "{named}" was not written', "red")
        return RUN_FAILED
    return OK


def _report(run: Any) -> None:
    """The few numbers that tell whether a run can be trusted."""
    last = run.energy[-1]
    size = max(abs(run.energy["kinetic"]).max(), abs(run.energy["strain"]).max()) or 1.0
    start = run.energy["total"][0]
    unit = run.units.label("energy") if run.units else ""
    _say(
        f"{run.steps[-1] - run.steps[0]} steps to t = {last['time']:.6g} in {run.seconds:.3g} s, {len(run.steps)} records"
    )
    _say(
        f"energy: kinetic {last['kinetic']:.6g}, strain {last['strain']:.6g}, contact {last['contact']:.6g} {unit}; "
        f"total changed by {(last['total'] - start) / size:.2e}, work balance {abs(run.energy['balance']).max() / size:.1e} (relative)"
    )
    if run.path is not None:
        _say(f'results in "{run.path}"')


def _explain(options: argparse.Namespace) -> int:
    from .scene import Scene

    text = Scene.load(options.scene).explain()
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")
    print(text, flush=True)
    return OK


def _plot(options: argparse.Namespace) -> int:
    from .run import Run

    if not math.isfinite(options.scale) or abs(options.scale) > 1e12:
        raise BadInput(f"the scale {options.scale:g} can't be drawn")
    if not options.file:
        raise BadInput("the name of the run is empty")
    target = Path(options.output) if options.output else Path(options.file).with_suffix(".png")
    try:
        run = Run.load(options.file)
    except ValueError as error:
        raise BadInput(str(error)) from None
    try:
        from .plot import picture

        picture(run, target, options.field, options.scale)
    except ImportError as error:
        raise BadInput(f"plotting needs matplotlib ({error})") from None
    except OSError as error:
        raise BadInput(f'"{target}" can\'t be written: {error.strerror or error}') from None
    except ValueError as error:
        raise BadInput(str(error)) from None
    _say(f'picture in "{target}"')
    return OK


def _say(text: str, style: str = "") -> None:
    """A line on stderr, coloured where stderr is a terminal and rich is there."""
    if sys.stderr is None:
        return
    if sys.stderr.isatty():
        try:
            from rich.console import Console
            from rich.text import Text
        except ImportError:
            pass
        else:
            Console(stderr=True).print(Text(text, style=style))
            return
    with contextlib.suppress(OSError):  # a message that can't be shown does not change the result
        print(text, file=sys.stderr, flush=True)


def _silence_stdout() -> None:
    """Point stdout away from a pipe that was closed (``libcontact explain ... | head``)."""
    import os

    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
