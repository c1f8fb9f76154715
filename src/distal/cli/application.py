"""The commands, each a few lines around the library's own functions.

What flows in: parsed words. What flows out: the work of ``distal.load``, ``distal.compile`` and
``render``. Heavy packages are imported only by the command that needs them: ``compile`` runs
without numpy, llvmlite and wgpu.
"""

from __future__ import annotations

import functools
import json
import sys
import time
from collections.abc import Callable
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, ParamSpec

import typer

import distal
from distal.cli.arguments import (
    UsageError,
    read_assignments,
    read_scene,
    read_size,
    read_time,
)
from distal.diagnostics import CompileError, LoadError
from distal.film.replacement import SaveError, check_destination, replacement
from distal.version import __version__

if TYPE_CHECKING:
    from distal.lang.functions import Func

Arguments = ParamSpec("Arguments")

# By the name under which Python knows it: what rendering needs besides this command itself.
CORE_PACKAGES: Final = {"numpy": "numpy", "llvmlite": "llvmlite", "PIL": "pillow", "rich": "rich"}

application = typer.Typer(
    name="distal",
    help="Scenes and shaders written as Python: render them, compile them.",
    no_args_is_help=True,
    add_completion=False,
    # A traceback is a fault of ours; it is shown as Python shows it, with nothing hidden.
    pretty_exceptions_enable=False,
)


class Device(StrEnum):
    """What renders."""

    CPU = "cpu"
    REFERENCE = "reference"


class TargetName(StrEnum):
    """What ``distal compile`` writes."""

    IR = "ir"
    LLVM = "llvm"
    GLSL_ES300 = "glsl-es300"
    GLSL_330 = "glsl-330"
    GLSL_ES100 = "glsl-es100"
    SHADERTOY = "shadertoy"
    WGSL = "wgsl"
    WGSL_COMPUTE = "wgsl-compute"


def reporting(command: Callable[Arguments, None]) -> Callable[Arguments, None]:
    """Turn an author's mistake into its message and exit code; anything else is our fault."""

    @functools.wraps(command)
    def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        try:
            command(*args, **kwargs)
        except UsageError as error:
            print(f"error: {error}", file=sys.stderr)
            raise typer.Exit(2) from None
        except CompileError as error:
            print(error, file=sys.stderr)
            raise typer.Exit(1) from None
        except (LoadError, SaveError) as error:
            print(f"error: {error}", file=sys.stderr)
            raise typer.Exit(1) from None
        except ModuleNotFoundError as error:
            if error.name not in CORE_PACKAGES:
                raise
            package = CORE_PACKAGES[error.name]
            print(f"error: {package} is missing: pip install {package}", file=sys.stderr)
            raise typer.Exit(1) from None
        except MemoryError as error:
            print(f"error: not enough memory: {error}".rstrip(": "), file=sys.stderr)
            raise typer.Exit(1) from None
        except KeyboardInterrupt:
            raise typer.Exit(130) from None

    return run


SceneArgument = Annotated[
    str,
    typer.Argument(
        metavar="FILE[:NAME]", help="A scene's file, or example:NAME.", show_default=False
    ),
]


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"distal {__version__}")
        raise typer.Exit


@application.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Show the version.", is_eager=True, callback=_show_version),
    ] = False,
) -> None:
    """Scenes and shaders written as Python: render them, compile them."""


@application.command()
@reporting
def render(
    scene: SceneArgument,
    output: Annotated[
        Path, typer.Option("-o", "--output", help="The picture's file.", show_default=False)
    ],
    size: Annotated[str, typer.Option(help="Width and height in pixels.")] = "640x480",
    at: Annotated[str, typer.Option("--time", help="Seconds.")] = "0",
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
    ] = None,
    device: Annotated[Device, typer.Option(help="What renders.")] = Device.CPU,
    threads: Annotated[
        int | None,
        typer.Option(min=1, max=1024, help="CPU threads; one per core if not given."),
    ] = None,
    stats: Annotated[
        bool, typer.Option("--stats", help="Print one line of JSON with the figures.")
    ] = False,
) -> None:
    """Render a scene to a picture."""
    from distal.cli.report import ProgressBar, say, stages
    from distal.executor import LARGEST_SIDE_PX
    from distal.film.picture import Picture, check_savable

    width_height, seconds = read_size(size, LARGEST_SIDE_PX), read_time(at)
    check_savable(output)
    if device is Device.CPU:
        _check_processor()
    begin = time.perf_counter()
    obj = _load(scene)
    run = getattr(obj, "render", None)
    if run is None:
        raise LoadError(f"'{obj.name}' is a @func; only an @image can be rendered")
    values = read_assignments(assignments or (), obj.parameters())
    loaded = time.perf_counter()
    with ProgressBar() as progress:
        picture: Picture = run(
            size=width_height,
            time=seconds,
            params=values,
            device=device.value,
            threads=threads,
            progress=progress,
        )
    rendered = time.perf_counter()
    picture.save(output)
    figures = {
        "load_s": loaded - begin,
        **dict.fromkeys(("compile_s", "render_s", "cache_hit", "lanes", "threads")),
        **picture.stats,
        "save_s": time.perf_counter() - rendered,
        "device": device.value,
        "size": list(width_height),
    }
    if stats:
        print(json.dumps(figures))
    else:
        say(f"{output}: {picture.width}x{picture.height}; {stages(figures)}")


@application.command()
@reporting
def compile(
    scene: SceneArgument,
    target: Annotated[
        TargetName, typer.Option("--target", help="What to write.", show_default=False)
    ],
    after: Annotated[
        str | None,
        typer.Option(metavar="PASS", help="With --target ir: show the module after this pass."),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o",
            "--output",
            help="A file for the text; its interface is written beside it as .json, "
            "a vertex stage as .vert.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Compile a scene to text: a shader, vector code, or any stage of the compiler."""
    if after is not None and target is not TargetName.IR:
        raise UsageError("--after belongs to --target ir")
    if after is not None:
        _check_pass(after)
    if output is not None:
        if output.suffix.lower() in (".json", ".vert"):
            raise UsageError(f"'{output}' is where the interface or the vertex stage goes")
        if output.resolve() == Path(read_scene(scene)[0]).resolve():
            raise UsageError(f"'{output}' is the scene itself")
        check_destination(output)
    artifact = distal.compile(_load(scene), target=target.value, after=after)
    if output is None:
        print(artifact.text.rstrip("\n"))
        return
    files = {output.with_suffix(".json"): json.dumps(artifact.interface, indent=2)}
    if artifact.vertex is not None:
        files[output.with_suffix(".vert")] = artifact.vertex
    files[output] = artifact.text
    for path, text in files.items():
        with replacement(path) as file:
            file.write(text.rstrip("\n").encode() + b"\n")


@application.command()
@reporting
def examples() -> None:
    """List the gallery; render one as example:NAME."""
    for name, path in sorted(distal.gallery().items()):
        print(f"example:{name}\t{path}")


@application.command()
@reporting
def doctor() -> None:
    """Tell what this machine can do, and how to mend what is missing."""
    from distal.cli.checkup import show
    from distal.doctor import State, examine

    findings = examine()
    show(findings)
    if any(finding.state is State.BROKEN for finding in findings):
        raise typer.Exit(1)


def _load(scene: str) -> Func:
    path, name = read_scene(scene)
    return distal.load(path, name)


def _check_processor() -> None:
    from distal.devices.features import chosen_level

    try:
        chosen_level()
    except ValueError as error:  # a processor too old, or a wish in DISTAL_CPU it cannot grant
        raise UsageError(str(error)) from None


def _check_pass(name: str) -> None:
    from distal.passes.pipeline import PASS_NAMES

    if name not in ("lower", *PASS_NAMES):
        raise UsageError(f"there is no pass '{name}'; passes: lower, {', '.join(PASS_NAMES)}")
