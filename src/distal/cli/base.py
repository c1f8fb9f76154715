"""What the commands share: the application they belong to, arguments, and how mistakes are told.

What flows in: words of the command line. What flows out: a loaded scene; an author's mistake as its
message and exit code. Knows no command.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from enum import StrEnum
from typing import TYPE_CHECKING, Annotated, Final, ParamSpec

import typer

import distal
from distal.cli.arguments import UsageError, read_scene
from distal.diagnostics import CompileError, LoadError
from distal.film.replacement import SaveError

if TYPE_CHECKING:
    from distal.loading import SceneCode

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

SizeOption = Annotated[str, typer.Option("--size", help="Width and height in pixels.")]
TimeOption = Annotated[str, typer.Option("--time", help="Seconds.")]
SetOption = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a parameter; may be repeated."),
]


def load(scene: str) -> SceneCode:
    """The object that FILE[:NAME] means."""
    path, name = read_scene(scene)
    return distal.load(path, name)


def check_processor() -> None:
    """Refuse a processor that cannot run what the CPU device makes."""
    from distal.devices.features import chosen_level

    try:
        chosen_level()
    except ValueError as error:  # a processor too old, or a wish in DISTAL_CPU it cannot grant
        raise UsageError(str(error)) from None
