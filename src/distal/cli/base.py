"""Code shared by the commands: the application, common arguments, error reports.

Input: arguments of the command line. Output: a loaded scene; for an author's mistake, its message
and exit code. Does not depend on any command.
"""

from __future__ import annotations

import functools
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Final, ParamSpec

import typer

from distal.cli.arguments import UsageError, read_assignments, read_scene
from distal.cli.exit_codes import ExitCode
from distal.cli.messages import say
from distal.cli.options import option_of
from distal.cli.surroundings import check_processor, check_working_folder, prepare_for_arrays
from distal.diagnostics import CompileError, DeviceError, LoadError, readable
from distal.file_writer import SaveError
from distal.interrupting import CtrlCRaises
from distal.lang.units import UNITS
from distal.packages import explained
from distal.runtime import device_names
from distal.version import __version__

if TYPE_CHECKING:
    from distal.cluster import WorkerPool
    from distal.lang.functions import Image
    from distal.lang.parameter_values import Value
    from distal.loading import SceneCode
    from distal.scene.objects.field import BaseShape
    from distal.scene.scene import Scene
    from distal.scene.viewing.viewable import Viewable

Arguments = ParamSpec("Arguments")

application = typer.Typer(
    name="distal",
    help="Scenes and shaders written as Python: render them, compile them.",
    no_args_is_help=True,
    add_completion=False,
    # A traceback is a bug in distal, so it is shown complete, as Python prints it.
    pretty_exceptions_enable=False,
)


def _show_version(wanted: bool) -> None:
    if wanted:
        print(f"distal {__version__}", flush=True)
        raise typer.Exit


@application.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", help="Show the version.", is_eager=True, callback=_show_version),
    ] = False,
) -> None:
    """Scenes and shaders written as Python: render them, compile them."""


class Device(StrEnum):
    """The device to render on."""

    AUTO = device_names.AUTO
    CPU = device_names.CPU
    GPU = device_names.GPU
    GPU_FRAGMENT = device_names.GPU_FRAGMENT
    REFERENCE = device_names.REFERENCE


class ProgressKind(StrEnum):
    """How a command shows its progress."""

    BAR = "bar"
    JSON = "json"


# Commands that do not import NumPy.
_WITHOUT_ARRAYS: Final = ("compile", "doctor", "examples")


def reporting(command: Callable[Arguments, None]) -> Callable[Arguments, None]:
    """Wrap a command: print an author's mistake and set the exit code; other errors propagate.

    With ``--json``, the mistakes are also answered, as ``docs/reference/errors.md`` says.
    """

    @functools.wraps(command)
    def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        try:
            with CtrlCRaises():
                reported(*args, **kwargs)
        except KeyboardInterrupt:
            raise typer.Exit(ExitCode.INTERRUPTED) from None

    def reported(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        try:
            check_working_folder()
            if command.__name__ not in _WITHOUT_ARRAYS:
                prepare_for_arrays()
            command(*args, **kwargs)
        except UsageError as error:
            say(f"error: {error}")
            raise typer.Exit(ExitCode.USAGE) from None
        except (CompileError, LoadError) as error:
            say(error if isinstance(error, CompileError) else f"error: {error}")
            if kwargs.get("as_json"):
                errors = [diagnostic.to_json() for diagnostic in error.diagnostics]
                answer(json.dumps({"version": 1, "errors": errors}))
            raise typer.Exit(ExitCode.FAILED) from None
        except (SaveError, DeviceError) as error:
            say(f"error: {error}")
            raise typer.Exit(ExitCode.FAILED) from None
        except Exception as error:
            line = _line_of(error)
            if line is None:
                raise
            say(f"error: {line}")
            raise typer.Exit(ExitCode.FAILED) from None

    return run


def _line_of(error: Exception) -> str | None:
    """Return what to print of an error of the surroundings; None for a fault in distal."""
    if isinstance(error, Warning):
        return f"{error} (a filter of Python's makes this warning an error)"
    if isinstance(error, OSError) and error.filename is not None:
        return f"cannot use {error.filename}: {error.strerror or error}"
    cause = error if isinstance(error, MemoryError) else explained(error)
    if isinstance(cause, MemoryError):
        return f"not enough memory: {cause}".rstrip(": ")
    return None if cause is None else str(cause)


SceneArgument = Annotated[
    str,
    typer.Argument(
        metavar="FILE[:NAME]", help="A scene's file, or example:NAME.", show_default=False
    ),
]

SizeOption = Annotated[str, option_of("size")]
TimeOption = Annotated[str, option_of("time")]
ModeOption = Annotated[str | None, option_of("mode")]
CausticsOption = Annotated[bool, option_of("caustics")]
ThreadsOption = Annotated[int | None, option_of("threads")]
ClusterOption = Annotated[str | None, option_of("cluster")]
DeviceOption = Annotated[Device, option_of("device")]
LookOption = Annotated[
    str | None,
    typer.Option(
        help="studio, outdoor, sunset, night or blueprint; what the scene gives itself stays.",
        show_default=False,
    ),
]
ProgressOption = Annotated[
    ProgressKind,
    typer.Option(
        "--progress",
        help="bar: on a terminal; json: for other programs, a line of JSON for each step.",
    ),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
]

UnitOption = Annotated[str, typer.Option(help=f"The length of one scene unit: {', '.join(UNITS)}.")]
JsonOption = Annotated[bool, typer.Option("--json", help="Plain values, on one line.")]
ToleranceOption = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="How far the mesh may be from the surface, in scene units.",
        show_default="0.002 of the largest side",
    ),
]
FeatureOption = Annotated[
    float | None,
    typer.Option(
        metavar="LENGTH",
        help="The diameter of the smallest parts and gaps that must be found.",
        show_default=False,
    ),
]
TimeoutOption = Annotated[
    float,
    typer.Option(
        "--task-timeout",
        metavar="S",
        min=1.0,
        help="With --cluster: give a task that takes longer to another worker.",
    ),
]
AdapterOption = Annotated[
    str | None,
    typer.Option(
        "--adapter", metavar="NAME", help="Which GPU: its number in distal doctor, or its name."
    ),
]


def chosen_device(device: Device, adapter: str | None) -> str:
    """Return the name of the device for ``render``; if "auto" selects the CPU, print why.

    Raises:
        UsageError: The options are not valid together, or the processor is not supported.
        DeviceError: There is no such adapter.
    """
    if device in (Device.CPU, Device.REFERENCE):
        if adapter is not None:
            raise UsageError(f"--adapter is for a GPU, and --device is {device.value}")
        if device is Device.CPU:
            check_processor()
        return device.value
    if adapter is not None:
        return f"{Device.GPU if device is Device.AUTO else device}:{adapter}"
    if device is Device.AUTO:
        from distal.devices.adapters import resolve

        found = resolve(device.value)
        if found.device == Device.CPU:
            say(f"rendering on the CPU: {found.reason}")
            check_processor()
            return Device.CPU.value
    return device.value


def answer(text: str) -> None:
    """Write data to stdout.

    Raises:
        SaveError: It cannot be written, as to a file on a full disk.
    """
    try:
        print(readable(text), flush=True)
    except BrokenPipeError:  # the reader closed the pipe
        raise
    except OSError as error:
        raise SaveError(f"cannot write to stdout: {error.strerror or error}") from None


def load(scene: str) -> SceneCode:
    """Load the object FILE[:NAME].

    A file that never ends is reported after 3 s, and loaded again when it is saved.
    """
    from distal.load_watch import load_watched

    path, name = read_scene(scene)
    return load_watched(path, name, lambda found: say(found.text("warning")))


def load_picture(
    scene: str, assignments: Sequence[str] | None
) -> tuple[Image | Scene | BaseShape, dict[str, Value]]:
    """Load the picture FILE[:NAME] and parse the parameter values given by --set.

    Raises:
        LoadError: There is no such object, or it is not a picture.
        UsageError: The value of a parameter is invalid.
    """
    from distal.scene.viewing.viewable import checked_picture

    picture = checked_picture(load(scene))
    return picture, read_assignments(assignments or (), picture.parameters())


@contextmanager
def cluster_of(where: str | None, device: str, timeout: float) -> Iterator[WorkerPool | None]:
    """Connect to the cluster of ``--cluster``; give None without it.

    Raises:
        UsageError: A device was chosen that workers do not have.
        DeviceError: There is no such cluster.
    """
    if where is None:
        yield None
        return
    if device not in (Device.CPU, Device.AUTO):
        raise UsageError(f"workers of a cluster render on their CPU: no --device {device}")
    from distal.cluster import connected

    with connected(where, timeout=timeout, tell=say) as pool:
        pool.check()
        yield pool


def check_view(seen: Viewable, view: str) -> None:
    """Check that there is such a view.

    Raises:
        UsageError: There is none.
    """
    try:
        seen.image(view)
    except ValueError as error:
        raise UsageError(str(error)) from None
