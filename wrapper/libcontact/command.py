"""The command line: ``libcontact run | explain | plan | info | mesh | plot | animate | export | schema | completion``.
Exit codes: 0 ok, 2 bad input, 3 run failed, 130 Ctrl-C."""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import math
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .run import Run
    from .scene import Scene

OK, BAD_INPUT, RUN_FAILED, INTERRUPTED = 0, 2, 3, 130
# Columns of the energy balance that a report names where they are not zero.
STORED = ("contact", "obstacle", "reserve")
# Arguments that are files, for completion.
FILES = ("SCENE.toml", "NEW.toml", "RUN.vtkhdf", "FILE", "MESH", "PNG", "OUT")


class BadInput(ValueError):
    """An invalid argument on the command line."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command, by default that of the process, and return its exit code. Errors of the user are
    reported in one line on stderr. Of several processes of MPI the first one prints."""
    return _attempt(lambda: _command(arguments))[0]


def _attempt(action: Callable[[], int]) -> tuple[int, str]:
    """The exit code of an action, after a message for whatever went wrong, and this message."""
    # Ctrl-C among these imports is left to the caller.
    from .errors import Error, NotBuiltIn, SceneWarning
    from .run import RunError
    from .schema import SceneError

    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda text, *rest, **more: _say(f"warning: {text}", "yellow")
            code = action()
        if sys.stdout is not None:
            sys.stdout.flush()
        return code, ""
    except KeyboardInterrupt:
        _say("interrupted")
        return INTERRUPTED, "interrupted"
    except BrokenPipeError:  # as in libcontact explain ... | head
        _drop_what_stdout_refuses()
        return OK, ""
    except (SceneError, NotBuiltIn, BadInput, OSError) as error:
        file = getattr(error, "filename", None)
        place = f'"{file}": ' if file else ""
        text = f"{place}{getattr(error, 'strerror', None) or error}"
        _drop_what_stdout_refuses()
        _say(f"error: {text}", "red")
        return BAD_INPUT, text
    except (Error, MemoryError, SceneWarning) as error:  # Python may be told to end at a warning
        text = str(error) or "out of memory"
        _say(f"the run failed: {text}", "red")
        run = error.run if isinstance(error, RunError) else None
        told = run is None or str(run.path) in str(error)
        if run is not None and run.path is not None and len(run.steps) and not told:
            _say(f'{len(run.steps)} records up to t = {run.time[-1]:.6g} are kept in "{run.path}"')
        return RUN_FAILED, text


def _command(arguments: Sequence[str] | None) -> int:
    try:
        options = _parser().parse_args(arguments)
    except SystemExit as end:
        return int(end.code or 0)
    if options.command is not _run_all:
        from .pieces import launched

        processes, number = launched()
        if processes > 1 and number > 0:
            return BAD_INPUT
        if processes > 1:
            raise BadInput("only run computes on several processes; start this without mpirun")
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
    for add in (_add_run, _add_explain, _add_plan, _add_info, _add_mesh):
        add(commands)
    schema = commands.add_parser("schema", help="write the JSON Schema of scenes, for editors")
    schema.set_defaults(command=_schema)
    for add in (_add_plot, _add_animate, _add_export):
        add(commands)
    completion = commands.add_parser("completion", help="write the completion of a shell")
    completion.set_defaults(command=_completion)
    completion.add_argument("shell", choices=("bash", "zsh", "tcsh"))
    return parser


def _add_run(commands: Any) -> None:
    run = commands.add_parser("run", help="compute a scene and write its results file")
    run.set_defaults(command=_run_all)
    _scene_options(run)
    output = "results file (VTKHDF), instead of the scene's"
    run.add_argument("-o", "--output", metavar="FILE", help=output)
    when = "time at which the run ends; the step stays the same"
    run.add_argument("--until", metavar="TIME", type=float, help=when)
    run.add_argument(
        "--threads", metavar="N", type=int, help="number of threads; results do not depend on it"
    )
    run.add_argument(
        "--restart", metavar="FILE", help="continue from the newest record of this file"
    )
    _partition_option(run)
    run.add_argument("--quiet", action="store_true", help="print nothing but errors")
    drawn = "draw the end of the run into a PNG beside its results file, or named after the scene"
    run.add_argument("--plot", action="store_true", help=drawn)
    _picture_options(run)


def _add_explain(commands: Any) -> None:
    explain = commands.add_parser("explain", help="show what a scene will compute, and why")
    explain.set_defaults(command=lambda options: _each(options, _explain))
    _scene_options(explain)
    many = "also show what each of N processes of MPI would compute and exchange"
    explain.add_argument("--pieces", metavar="N", type=int, help=many)
    _partition_option(explain)


def _add_plan(commands: Any) -> None:
    plan = commands.add_parser(
        "plan", help="choose mesh, step and methods for a given error or run time"
    )
    plan.set_defaults(command=lambda options: _each(options, _plan))
    _scene_options(plan)
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


def _add_info(commands: Any) -> None:
    what = "show what is in results files, meshes and scenes"
    info = commands.add_parser("info", help=what)
    info.set_defaults(command=lambda options: _each(options, _info))
    info.add_argument("scenes", metavar="FILE", nargs="+")
    info.add_argument("--json", action="store_true", help="write JSON, one line per file")


def _add_mesh(commands: Any) -> None:
    mesh = commands.add_parser("mesh", help="show cells, sets and quality of mesh files")
    mesh.set_defaults(command=lambda options: _each(options, _mesh))
    mesh.add_argument("scenes", metavar="MESH", nargs="+")
    mesh.add_argument("--part", metavar="NAME", help="only this set of elements")
    mesh.add_argument("--scale", metavar="FACTOR", type=float, default=1.0, help="scale of lengths")
    extrude = "extrude a mesh in a plane z = const: height and number of layers"
    mesh.add_argument("--extrude", metavar=("HEIGHT", "LAYERS"), nargs=2, help=extrude)
    speed = "speed of the dilatational wave, for the estimated step (default: steel, in m/s)"
    mesh.add_argument("--speed", metavar="C1", type=float, help=speed)
    mesh.add_argument("--plot", action="store_true", help="draw the mesh into MESH.png")
    mesh.add_argument("--json", action="store_true", help="write JSON, one line per file")


def _add_plot(commands: Any) -> None:
    plot = commands.add_parser("plot", help="draw instants and the energies of a run")
    plot.set_defaults(command=_plot)
    plot.add_argument("file", metavar="RUN.vtkhdf")
    plot.add_argument("-o", "--output", metavar="PNG", help="picture, by default RUN.png")
    movie = "instead a film of the records, as animate draws it, by default RUN.gif"
    plot.add_argument("--movie", metavar="FILE", nargs="?", const="", help=movie)
    _picture_options(plot)


def _add_animate(commands: Any) -> None:
    animate = commands.add_parser("animate", help="draw the records of a run as a film")
    animate.set_defaults(command=_animate)
    animate.add_argument("file", metavar="RUN.vtkhdf")
    film = "film, a .gif or a .mp4 (needs ffmpeg), by default RUN.gif"
    animate.add_argument("-o", "--output", metavar="FILE", help=film)
    animate.add_argument("--rate", metavar="N", type=int, default=15, help="pictures per second")
    _picture_options(animate, instants=60)


def _add_export(commands: Any) -> None:
    export = commands.add_parser("export", help="convert a run to CSV, VTU or XDMF")
    export.set_defaults(command=_export)
    export.add_argument("file", metavar="RUN.vtkhdf")
    form = "csv: energy, momentum and probes; vtu: one record; xdmf: all records"
    export.add_argument("--to", choices=("csv", "vtu", "xdmf"), required=True, help=form)
    target = "file, or folder of the CSV files; by default named after the run"
    export.add_argument("-o", "--output", metavar="OUT", help=target)
    record = "number of the record for vtu, counted from 0 (default: the last one)"
    export.add_argument("--record", metavar="N", type=int, default=-1, help=record)


def _partition_option(parser: argparse.ArgumentParser) -> None:
    cut = "how the elements are given to the processes of MPI (default: metis if pymetis is installed)"
    parser.add_argument("--partition", choices=("metis", "coordinates"), help=cut)


def _scene_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("scenes", metavar="SCENE.toml", nargs="+")
    parser.add_argument(
        "--set",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="replace a value of the scene, as in time.end=2e-7 or contact.0.beta=10",
    )
    parser.add_argument(
        "--json", action="store_true", help="write JSON to stdout, one line per scene"
    )


def _picture_options(parser: argparse.ArgumentParser, instants: int = 4) -> None:
    field = (
        "mises, contact_pressure, principal_max, stress_xx, velocity_z, ... (default: by the scene)"
    )
    parser.add_argument("--field", help=field)
    scale = "magnify displacements (default 1, or more if they are small)"
    parser.add_argument("--scale", type=float, help=scale)
    view = "sides that the viewer sees, such as y_min or x_max+y_min+z_max"
    parser.add_argument("--view", metavar="SIDES", help=view)
    parser.add_argument(
        "--instants", metavar="N", type=int, default=instants, help="number of instants"
    )


def _each(
    options: argparse.Namespace, action: Callable[[argparse.Namespace], dict[str, Any]]
) -> int:
    """Do one action for each scene; what it returns is written as JSON if that is wanted. The worst
    exit code counts, and Ctrl-C ends all."""
    worst = OK
    for path in options.scenes:
        one, found = argparse.Namespace(**vars(options), scene=path), dict[str, Any]()

        def act(one: argparse.Namespace = one, found: dict[str, Any] = found) -> int:
            found |= action(one)
            return int(found["exit"])

        if len(options.scenes) > 1 and not getattr(options, "quiet", False):
            _say(path, "bold")
        code, message = _attempt(act)
        if options.json:
            error = {"error": message} if message else {}
            print(_json({"scene": path, **found, "exit": code, **error}), flush=True)
        if code == INTERRUPTED:
            return code
        worst = max(worst, code)
    return worst


def _json(value: Any) -> str:
    """JSON in one line; numbers that are not finite are null."""
    import json

    return json.dumps(_plain(value), allow_nan=False, ensure_ascii=False)


def _plain(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        return _plain({each.name: getattr(value, each.name) for each in fields(value)})
    if isinstance(value, dict):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, (str, bool, int, float, type(None))) else str(value)


def _load(options: argparse.Namespace) -> Scene:
    """The scene of a command, with the values of ``--set``."""
    from .older import tomllib
    from .scene import Scene
    from .source import value_of

    changes = {}
    for text in options.set:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise BadInput(f'--set "{text}" is no KEY=VALUE')
        try:
            changes[key.strip()] = value_of(value.strip())
        except tomllib.TOMLDecodeError as error:
            raise BadInput(f'--set {key}: "{value}" is no value of TOML: {error}') from None
    return Scene.load(options.scene, changes)


def _run_all(options: argparse.Namespace) -> int:
    """Run each scene, after a check that each has a file of its own. Under ``mpirun`` all processes compute
    one run, and the first one reports."""
    from .pieces import world

    options.comm = world()
    if options.comm is not None and options.comm.rank > 0:
        options.quiet, options.plot = True, False
        sys.stdout = sys.stderr = open(os.devnull, "w", encoding="utf-8")
    if len(options.scenes) > 1:
        for name in ("output", "restart"):
            if getattr(options, name) is not None:
                raise BadInput(f"--{name} is one file; give one scene")
        _check_files(options)
    return _each(options, _run)


def _check_files(options: argparse.Namespace) -> None:
    """Refuse scenes of which one would overwrite the results of another one."""
    from .schema import SceneError

    writers: dict[Path, str] = {}
    for path in options.scenes:
        try:
            scene = _load(argparse.Namespace(scene=path, set=options.set))
        except SceneError:  # told when the scene is run
            continue
        if name := scene.data.get("output", {}).get("file"):
            first = writers.setdefault(Path(name).resolve(), path)
            if first is not path:
                raise BadInput(f'{first} and {path} both write "{name}"')


def _run(options: argparse.Namespace) -> dict[str, Any]:
    scene = _load(options)
    if options.output == "":
        raise BadInput("the name of the output is empty")
    named = options.output or scene.data.get("output", {}).get("file")
    if options.plot:
        _check_picture(options)
    keys = ("restart", "until", "output", "threads", "partition")
    run = scene.run(
        progress=not options.quiet,
        comm=options.comm,
        **{key: getattr(options, key) for key in keys},
    )
    if not options.quiet:
        _report(run)
    code = _finish(run, named, options)
    return _summary(run) | {"exit": code}


def _finish(run: Run, named: str | None, options: argparse.Namespace) -> int:
    """Messages and picture after a run, and its exit code."""
    if run.interrupted:
        records = f'; {len(run.steps)} records are kept in "{run.path}"'
        kept = f"{records}, from which --restart continues" if run.path else ""
        _say(f"interrupted at t = {run.time[-1]:.6g}{kept}")
        return INTERRUPTED
    if options.plot:
        _draw(run, Path(run.path or Path(options.scene).name).with_suffix(".png"), options)
    if named and (run.path is None or not run.path.exists()):
        _say(f'the results file "{named}" was not written', "red")
        return RUN_FAILED
    return OK


def _summary(run: Run) -> dict[str, Any]:
    """The end of a run, for programs."""
    last = run.energy[-1]
    names = run.energy.dtype.names or ()
    return {
        "file": run.path,
        "bodies": run.bodies,
        "records": len(run.steps),
        "steps": run.steps[-1],
        "time": run.time[-1],
        "dt": run.dt,
        "seconds": run.seconds,
        "interrupted": run.interrupted,
        "energy": {name: last[name] for name in names if name != "time"},
        "energy_change": last["total"] - run.energy["total"][0],
        "costs": run.costs,
        "penetration": run.penetration,
        "contact_pressure": _largest_pressure(run),
    }


def _largest_pressure(run: Run) -> dict[str, Any] | None:
    """The node with the largest recovered contact pressure at the end of a run; None if nothing touches."""
    rows = [
        table[table["pressure"].argmax()]
        for kind in run.pressure.values()
        for table in kind
        if len(table)
    ]
    row = max(rows, key=lambda row: row["pressure"], default=None)
    if row is None or row["pressure"] == 0.0:
        return None
    found = {name: row[name] for name in ("pressure", "node", "position")}
    return found | {"body": run.bodies[row["body"]]}


def _report(run: Run) -> None:
    """Energy balance and size of a run, to check its quality."""
    energy, steps = run.energy, run.steps
    last, size = energy[-1], max(abs(energy[name]).max() for name in ("kinetic", "strain")) or 1.0
    change, balance = last["total"] - energy["total"][0], abs(energy["balance"]).max()
    unit = run.units.label("energy") if run.units else ""
    stored = [name for name in STORED if name in (energy.dtype.names or ()) and energy[name].any()]
    parts = ", ".join(f"{name} {last[name]:.6g}" for name in ["kinetic", "strain", *stored])
    took = f"in {run.seconds:.3g} s, {len(steps)} records"
    _say(f"{steps[-1] - steps[0]} steps to t = {last['time']:.6g} {took}")
    relative = f"{change / size:.2e}, work balance {balance / size:.1e} (relative)"
    _say(f"energy: {parts} {unit}; total changed by {relative}")
    if most := _largest_pressure(run):
        unit = run.units.label("stress") if run.units else ""
        place = ", ".join(f"{x:.4g}" for x in most["position"])
        where = f"{unit} at ({place}) on {most['body']}"
        _say(
            f"largest contact pressure at the end: {most['pressure']:.6g} {where}, recovered at the nodes"
        )
    elif any(run.pressure.values()) and not stored:
        if not any(run.momentum[f"{kind}_impulse"].any() for kind in run.pressure):
            _say("nothing touched: no contact and no obstacle had a force at any time")
    if run.path is not None:
        _say(f'results in "{run.path}"')


def _explain(options: argparse.Namespace) -> dict[str, Any]:
    text = _load(options).explain(options.pieces, options.partition)
    if options.json:
        return {**text.data, "exit": OK}
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")
    print(text, flush=True)
    return {"exit": OK}


def _info(options: argparse.Namespace) -> dict[str, Any]:
    from .info import describe_file, text

    with _naming_what_is_wrong():
        facts = describe_file(options.scene)
    if not options.json:
        print(text(facts), flush=True)
    return {**facts, "exit": OK}


def _mesh(options: argparse.Namespace) -> dict[str, Any]:
    from .mesh_info import describe, text
    from .meshes import read_mesh

    if options.plot:
        _check_matplotlib()
    if options.speed is not None and not 0.0 < options.speed < math.inf:
        raise BadInput(f"--speed is {options.speed:g}; it must be positive")
    with _naming_what_is_wrong():
        extrude = options.extrude and (float(options.extrude[0]), int(options.extrude[1]))
        keys = {"part": options.part, "scale": options.scale, "extrude": extrude}
        data = read_mesh(options.scene, **keys)
        facts = describe(options.scene, data, options.speed)
    if not options.json:
        print(text(facts), flush=True)
    if options.plot:
        from .pictures.mesh import draw_mesh

        target = f"{options.scene}.png"  # plot draws a run with this stem into the .png
        draw_mesh(data, Path(target).stem).savefig(target, dpi=150)
        _say(f'picture in "{target}"')
    return {**facts, "exit": OK}


@contextlib.contextmanager
def _naming_what_is_wrong() -> Iterator[None]:
    """A file that can't be read is bad input."""
    from .errors import install
    from .schema import SceneError

    try:
        yield
    except SceneError:
        raise
    except ImportError as error:
        raise BadInput(f"reading a run needs h5py ({error}): {install('files')}") from None
    except ValueError as error:
        raise BadInput(str(error)) from None


def _fraction(text: str) -> float:
    """5% or 0.05."""
    return float(text.removesuffix("%")) / (100.0 if text.endswith("%") else 1.0)


def _plan(options: argparse.Namespace) -> dict[str, Any]:
    if options.write is not None and Path(options.write).exists():
        raise BadInput(f'"{options.write}" exists already')
    keys = ("error", "seconds", "functional", "trials")
    plan = _load(options).plan(**{key: getattr(options, key) for key in keys})
    if not options.json:
        print(plan, flush=True)
    if options.write is not None:
        plan.scene.save(options.write)
        _say(f'scene in "{options.write}"')
    facts = {each.name: getattr(plan, each.name) for each in fields(plan)}
    for name in ("choice", "cheaper", "dearer"):
        offer = facts[name]
        text = {"scene": offer.scene.toml(arrays=False)} if offer else {}
        facts[name] = offer and {**vars(offer), **text}
    return {**facts, "exit": INTERRUPTED if plan.interrupted else OK}


def _schema(options: argparse.Namespace) -> int:
    import json

    from .parts import schema

    print(json.dumps(schema(), indent=2), flush=True)
    return OK


def _plot(options: argparse.Namespace) -> int:
    from .run import Run

    _check_picture(options)
    if options.movie is not None:
        return _film(options, options.movie)
    with _naming_what_is_wrong():
        run = Run.load(options.file)
    _draw(run, Path(options.output or Path(options.file).with_suffix(".png")), options)
    return OK


def _animate(options: argparse.Namespace) -> int:
    _check_picture(options)
    if options.rate < 1:
        raise BadInput(f"--rate is {options.rate}; at least one picture per second is needed")
    return _film(options, options.output, frames=options.instants, rate=options.rate)


def _film(options: argparse.Namespace, output: str | None, **how: int) -> int:
    """Draw a film of a run with the options of a picture."""
    from .pictures.animation import animate
    from .run import Run

    target = Path(output or Path(options.file).with_suffix(".gif"))
    with _naming_what_is_wrong():
        run = Run.load(options.file)
        shown = {key: getattr(options, key) for key in ("field", "view", "scale")}
        animate(run, target, **shown, **how)
    _say(f'film in "{target}"')
    return OK


def _export(options: argparse.Namespace) -> int:
    from .export import FORMATS
    from .run import Run

    with _naming_what_is_wrong():
        run = Run.load(options.file, options.record)
        target = Path(options.output or Path(options.file).with_suffix(f".{options.to}"))
        if not options.output and options.to == "csv":
            target = target.with_suffix("")
        FORMATS[options.to](run, target)
    _say(f'{options.to} in "{target}"')
    return OK


def _completion(options: argparse.Namespace) -> int:
    try:
        import shtab
    except ImportError:
        from .errors import install

        text = f"completion needs shtab: {install('completion')}"
        raise BadInput(text) from None

    parser = _parser()
    for each in _actions(parser):
        if each.metavar in FILES:
            each.complete = shtab.FILE  # type: ignore[attr-defined]
    print(shtab.complete(parser, shell=options.shell), flush=True)
    return OK


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """The arguments of all commands."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                yield from command._actions


def _check_picture(options: argparse.Namespace) -> None:
    """Refuse what can't be drawn before a run, not after it."""
    from .pictures.drawing import check_view
    from .schema import suggestion
    from .state import COMPONENTS

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
    _check_matplotlib()


def _check_matplotlib() -> None:
    if importlib.util.find_spec("matplotlib") is None:
        from .errors import install

        raise BadInput(f"plotting needs matplotlib: {install('plot')}")


def _draw(run: Run, target: Path, options: argparse.Namespace) -> None:
    from .pictures.picture import picture

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
