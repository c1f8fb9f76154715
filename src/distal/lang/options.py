"""Rows of options: all that is known of an option stands beside its field in a frozen request.

Input: the fields of a dataclass, each declared by ``option``. Output: its rows, from which methods
with their documentation (``tools/gen_option_methods.py``), the options of commands
(``distal.cli.options``) and what a picture's file records are derived. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, Final

_KEY: Final = "option"
_NO_TEXTS: Final[Mapping[str, Any]] = {}


@dataclass(frozen=True, slots=True)
class Flag:
    """What the commands know of an option besides the rest of its row.

    Attributes:
        help: Its text in ``--help``; "" for the documentation of the row.
        names: Its names with hyphens; empty for the name of the option.
        metavar: What stands for its value in ``--help``.
        form: The form of its text (``distal.cli.options.FORMS``).
        limits: The least and the largest number.
        shown: What ``--help`` shows as the default of an option that is None.
        helps: ``help`` for the commands of some methods.
    """

    help: str = ""
    names: tuple[str, ...] = ()
    metavar: str | None = None
    form: str | None = None
    limits: tuple[int | None, int | None] = (None, None)
    shown: str | None = None
    helps: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Option:
    """What a row says besides the name, type and default of its field.

    Attributes:
        doc: What it does, with its unit.
        methods: The methods that take it.
        positional: Whether it may be passed by position.
        of_paths: Whether it is for mode "path" alone, which its documentation then says.
        recorded: Whether a picture's file records it.
        taken: Its type in methods, where None stands for an empty value.
        check: Returns the checked value, or raises ``TypeError`` or ``ValueError``.
        flag: The option of the commands; None if they have none.
        docs: ``doc`` for some methods.
        defaults: Its default for some methods.
    """

    doc: str
    methods: frozenset[str]
    positional: bool
    of_paths: bool
    recorded: bool
    taken: str | None
    check: Callable[[Any], Any] | None
    flag: Flag | None
    docs: Mapping[str, str]
    defaults: Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class OptionRow:
    """One option of a request: its field, and what its row says.

    Attributes:
        name: Its name.
        type: Its type in a request, as it is written.
        default: Its default in a request; None if it is an empty value.
        option: The rest.
    """

    name: str
    type: str
    default: Any
    option: Option

    def doc(self, method: str) -> str:
        """Return what it does, as the documentation of a method says it."""
        text = self.option.docs.get(method, self.option.doc)
        return _of_paths('In mode "path": ', text) if self.option.of_paths else text

    def help(self, method: str) -> str:
        """Return what the command says that calls a method."""
        flag = self.option.flag
        text = "" if flag is None else flag.helps.get(method, flag.help)
        text = text or self.option.doc
        return _of_paths("In mode path: ", text) if self.option.of_paths else text

    def default_of(self, method: str) -> Any:
        """Return its default for a method."""
        return self.option.defaults.get(method, self.default)


def option(
    default: Any,
    doc: str,
    methods: str = "",
    *,
    positional: bool = False,
    of_paths: bool = False,
    recorded: bool = False,
    taken: str | None = None,
    check: Callable[[Any], Any] | None = None,
    flag: Flag | None = None,
    docs: Mapping[str, str] = _NO_TEXTS,
    defaults: Mapping[str, Any] = _NO_TEXTS,
) -> Any:
    """Return the field of an option of a request; see ``Option``.

    Args:
        default: Its default; a class makes an empty value.
        doc: What it does, with its unit.
        methods: The methods that take it, with blanks between; none if only programs set it.
        positional: Whether it may be passed by position.
        of_paths: Whether it is for mode "path" alone.
        recorded: Whether a picture's file records it.
        taken: Its type in methods, if not that of the field.
        check: Returns the checked value.
        flag: The option of the commands.
        docs: ``doc`` for some methods.
        defaults: ``default`` for some methods.
    """
    row = Option(
        doc,
        frozenset(methods.split()),
        positional,
        of_paths,
        recorded,
        taken,
        check,
        flag,
        docs,
        defaults,
    )
    if isinstance(default, type):
        return field(default_factory=default, metadata={_KEY: row})
    return field(default=default, metadata={_KEY: row})


def rows(request: type, method: str | None = None) -> Iterator[OptionRow]:
    """Yield the rows of a request in their order, all or those that a method takes."""
    for each in fields(request):
        row = each.metadata[_KEY]
        if method is None or method in row.methods:
            default = None if each.default is MISSING else each.default
            yield OptionRow(each.name, str(each.type), default, row)


def checks(request: type) -> tuple[tuple[str, Callable[[Any], Any]], ...]:
    """Return the names of the options that are checked, and how."""
    checked = ((row.name, row.option.check) for row in rows(request))
    return tuple((name, check) for name, check in checked if check is not None)


def _of_paths(prefix: str, text: str) -> str:
    return f"{prefix}{text[:1].lower()}{text[1:]}"
