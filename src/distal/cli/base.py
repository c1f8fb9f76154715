"""What the commands share: the application they belong to, arguments, error reports.

Input: words of the command line. Output: a loaded scene; an author's mistake as its
message and exit code. Knows no command.
"""

from __future__ import annotations

import functools
import os
import sys
from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Final, ParamSpec

import typer

import distal
from distal.cli.arguments import UsageError, read_assignments, read_scene
from distal.cli.messages import say
from distal.devices.memory_limit import is_limited, require
from distal.diagnostics import CompileError, DeviceError, LoadError
from distal.images.atomic_files import SaveError
from distal.packages import explained
from distal.runtime import device_names

if TYPE_CHECKING:
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
    # A traceback is an error of distal; it is shown as Python shows it, with nothing hidden.
    pretty_exceptions_enable=False,
)


class Device(StrEnum):
    """What renders."""

    AUTO = device_names.AUTO
    CPU = device_names.CPU
    GPU = device_names.GPU
    GPU_FRAGMENT = device_names.GPU_FRAGMENT
    REFERENCE = device_names.REFERENCE


# Commands that load no NumPy.
_WITHOUT_ARRAYS: Final = ("compile", "doctor", "examples")
_NUMPY_BYTES: Final = 96 * 2**20  # measured: 85 with one thread of OpenBLAS, 41 for each more


def prepare_for_arrays() -> None:
    """Refuse a limit under which NumPy's BLAS would end the process with words of its own.

    Raises:
        MemoryError: What is left is too little.
    """
    if is_limited() and "numpy" not in sys.modules:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # distal multiplies no large matrices
        require(_NUMPY_BYTES, "NumPy")


def reporting(command: Callable[Arguments, None]) -> Callable[Arguments, None]:
    """Turn an author's mistake into its message and exit code; other errors stay as they are."""

    @functools.wraps(command)
    def run(*args: Arguments.args, **kwargs: Arguments.kwargs) -> None:
        try:
            if command.__name__ not in _WITHOUT_ARRAYS:
                prepare_for_arrays()
            command(*args, **kwargs)
        except UsageError as error:
            say(f"error: {error}")
            raise typer.Exit(2) from None
        except CompileError as error:
            say(error)
            raise typer.Exit(1) from None
        except (LoadError, SaveError, DeviceError) as error:
            say(f"error: {error}")
            raise typer.Exit(1) from None
        except KeyboardInterrupt:
            raise typer.Exit(130) from None
        except Exception as error:
            found = error if isinstance(error, MemoryError) else explained(error)
            if found is None:
                raise
            short = "not enough memory: " if isinstance(found, MemoryError) else ""
            say(f"error: {short}{found}".rstrip(": "))
            raise typer.Exit(1) from None

    return run


SceneArgument = Annotated[
    str,
    typer.Argument(
        metavar="FILE[:NAME]", help="A scene's file, or example:NAME.", show_default=False
    ),
]

SizeOption = Annotated[
    str, typer.Option("--size", metavar="WxH", help="Width and height in pixels.")
]
TimeOption = Annotated[str, typer.Option("--time", metavar="S", help="Seconds.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
]

ThreadsOption = Annotated[
    int | None, typer.Option(min=1, max=1024, help="CPU threads; one per core if not given.")
]
DeviceOption = Annotated[
    Device, typer.Option("--device", help="What renders; auto: a GPU, else the CPU.")
]
AdapterOption = Annotated[
    str | None,
    typer.Option(
        "--adapter", metavar="NAME", help="Which GPU: its number in distal doctor, or its name."
    ),
]


def chosen_device(device: Device, adapter: str | None) -> str:
    """The device's name, as ``render`` takes it; where "auto" ends on the CPU, says why.

    Raises:
        UsageError: The options do not go together.
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
        print(text, flush=True)
    except BrokenPipeError:  # whoever reads has seen enough
        raise
    except OSError as error:
        raise SaveError(f"cannot write to stdout: {error.strerror or error}") from None


def load(scene: str) -> SceneCode:
    """The object that FILE[:NAME] means."""
    path, name = read_scene(scene)
    return distal.load(path, name)


def load_picture(
    scene: str, assignments: Sequence[str] | None
) -> tuple[Image | Scene | BaseShape, dict[str, Value]]:
    """What FILE[:NAME] means, and the values of its parameters that --set gives.

    Raises:
        LoadError: There is none, or it is no picture.
        UsageError: A parameter's value is wrong.
    """
    from distal.scene.viewing.viewable import checked_picture

    picture = checked_picture(load(scene))
    return picture, read_assignments(assignments or (), picture.parameters())


def check_view(seen: Viewable, view: str) -> None:
    """Refuse a view that does not exist."""
    try:
        seen.image(view)
    except ValueError as error:
        raise UsageError(str(error)) from None


def check_processor() -> None:
    """Refuse a processor that cannot run what the CPU device makes."""
    from distal.devices.features import chosen_level

    try:
        chosen_level()
    except (
        ValueError
    ) as error:  # a processor too old, or a level in DISTAL_CPU that it does not have
        raise UsageError(str(error)) from None
