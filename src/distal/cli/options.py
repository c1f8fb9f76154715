"""Options of commands that are rows of ``distal.lang.render_options``.

Input: rows. Output: their flags, texts, readers and defaults for typer; a request from what a
command was given. Does not depend on any command.
"""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from typing import Annotated, Any, Final, NamedTuple

import typer

from distal.cli.arguments import UsageError, read_plane, read_size, read_steering, read_time
from distal.lang.options import Option, rows
from distal.lang.render_options import LARGEST_SIDE_PX, RenderOptions

# The options of a request that a command was given, by name.
Asked = Mapping[str, Any]
NOTHING_ASKED: Final[Asked] = {}
_NUMBERS: Final = {"int | None": int | None, "float | None": float | None}


class TextForm(NamedTuple):
    """The form of an option that a command reads from a text.

    Attributes:
        read: Returns the value of a text.
        written: Returns the text of a default; None if the command has no default.
    """

    read: Callable[[str], Any]
    written: Callable[[Any], str] | None = None


FORMS: Final[Mapping[str, TextForm]] = {
    "size": TextForm(
        lambda text: read_size(text, LARGEST_SIDE_PX), lambda size: f"{size[0]}x{size[1]}"
    ),
    "seconds": TextForm(read_time, lambda seconds: f"{seconds:g}"),
    "plane": TextForm(read_plane),
    "steering": TextForm(read_steering),
}


def flags(method: str, request: type = RenderOptions) -> Iterator[Option]:
    """Yield the rows of a method that the commands have."""
    return (row for row in rows(request, method) if row.flag is not None)


def flag_name(row: Option) -> str:
    """Return the name of an option on the command line; of a switch the one that changes it."""
    return _names(row)[0].rpartition("/")[2]


def typer_option(row: Option, method: str) -> Any:
    """Return the option of the command that calls a method."""
    flag = row.flag
    assert flag is not None
    least, largest = flag.limits
    default = row.default_of(method)
    return typer.Option(
        *_names(row),
        help=row.help_of(method),
        metavar=flag.metavar,
        min=least,
        max=largest,
        show_default=flag.shown or (default if isinstance(default, str) else True),
    )


def option_of(name: str) -> Any:
    """Return the option of a row by its name, for a command that declares it itself."""
    return typer_option(next(row for row in flags("scene") if row.name == name), "scene")


def requesting(
    method: str, request: type = RenderOptions
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """Give a command the options of a method, in the place of its parameter ``asked``.

    Those that the command declares itself are left out. What is asked for is passed as ``asked``.

    Args:
        method: The method that the command calls, as the rows name it.
        request: The request.
    """

    def wrap(command: Callable[..., None]) -> Callable[..., None]:
        own = inspect.signature(command, eval_str=True).parameters
        taken = [row for row in flags(method, request) if row.name not in own]

        @functools.wraps(command)
        def run(**given: Any) -> None:
            texts = [(row, given.pop(row.name)) for row in taken]
            asked = {row.name: _read(row, text) for row, text in texts if text is not None}
            command(**given, asked=asked)

        place = list(own).index("asked")
        parameters = [*own.values()]
        parameters[place : place + 1] = [_parameter(row, method) for row in taken]
        named = (p.replace(kind=inspect.Parameter.KEYWORD_ONLY) for p in parameters)
        run.__signature__ = inspect.Signature([*named])  # type: ignore[attr-defined]
        return run

    return wrap


def request_of(asked: Asked, **more: Any) -> RenderOptions:
    """Return the request of what a command was asked for, and of more options.

    Raises:
        UsageError: An option is invalid.
    """
    try:
        return RenderOptions(**asked, **more)
    except ValueError as error:
        raise UsageError(str(error)) from None


def _names(row: Option) -> tuple[str, ...]:
    assert row.flag is not None
    return row.flag.names or (f"--{row.name.replace('_', '-')}",)


def _form(row: Option) -> TextForm | None:
    assert row.flag is not None
    return None if row.flag.form is None else FORMS[row.flag.form]


def _read(row: Option, value: Any) -> Any:
    form = _form(row)
    return value if form is None else form.read(value)


def _parameter(row: Option, method: str) -> inspect.Parameter:
    """Return the parameter of a command; None stands for the default of the request."""
    form, default = _form(row), row.default_of(method)
    kind: Any = bool if isinstance(default, bool) else _NUMBERS.get(row.type, str | None)
    if form is not None and form.written is not None:
        default = form.written(default)
    elif kind is not bool:
        default = None
    annotation = Annotated[kind, typer_option(row, method)]
    keyword = inspect.Parameter.KEYWORD_ONLY
    return inspect.Parameter(row.name, keyword, default=default, annotation=annotation)
