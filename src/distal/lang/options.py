"""Rows of options: all that is known of an option stands beside its field in a frozen request.

Input: the fields of a dataclass, each declared by ``option``. Output: its rows, from which methods
with their documentation (``tools/gen_option_methods.py``), the options of commands
(``distal.cli.options``) and what a picture's file records are derived. Standard library only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import KW_ONLY, MISSING, dataclass, field, fields, replace
from typing import Any, Concatenate, Final, ParamSpec

_KEY: Final = "option"
Declared = ParamSpec("Declared")


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
    """One option: a row of the table.

    Attributes:
        doc: What it does, with its unit.
        methods: The methods that take it, with blanks between; "" if only programs set it.
        positional: Whether it may be passed by position.
        of_paths: Whether it is for mode "path" alone, which its documentation then says.
        recorded: Whether a picture's file records it.
        taken: Its type in methods, where None stands for an empty value.
        check: Returns the checked value, or raises ``TypeError`` or ``ValueError``.
        flag: The option of the commands; None if they have none.
        docs: ``doc`` for some methods.
        defaults: ``default`` for some methods.
        name: Its name, that of the field.
        type: Its type in a request, as it is written.
        default: Its default in a request; None if it is an empty value.
    """

    doc: str
    methods: str = ""
    _: KW_ONLY
    positional: bool = False
    of_paths: bool = False
    recorded: bool = False
    taken: str | None = None
    check: Callable[[Any], Any] | None = None
    flag: Flag | None = None
    docs: Mapping[str, str] = field(default_factory=dict)
    defaults: Mapping[str, Any] = field(default_factory=dict)
    name: str = ""
    type: str = ""
    default: Any = None

    def doc_of(self, method: str) -> str:
        """Return what it does, as the documentation of a method says it."""
        return self._prefixed('In mode "path": ', self.docs.get(method, self.doc))

    def help_of(self, method: str) -> str:
        """Return what the command says that calls a method."""
        text = "" if self.flag is None else self.flag.helps.get(method, self.flag.help)
        return self._prefixed("In mode path: ", text or self.doc)

    def default_of(self, method: str) -> Any:
        """Return its default for a method."""
        return self.defaults.get(method, self.default)

    def _prefixed(self, mode: str, text: str) -> str:
        return f"{mode}{text[:1].lower()}{text[1:]}" if self.of_paths else text


def _declaring(row: Callable[Declared, Option]) -> Callable[Concatenate[Any, Declared], Any]:
    def option(default: Any, /, *args: Declared.args, **kwargs: Declared.kwargs) -> Any:
        """Return the field of an option: its default (a class makes an empty value), its row."""
        metadata = {_KEY: row(*args, **kwargs)}
        if isinstance(default, type):
            return field(default_factory=default, metadata=metadata)
        return field(default=default, metadata=metadata)

    return option


option = _declaring(Option)


def rows(request: type, method: str | None = None) -> Iterator[Option]:
    """Yield the rows of a request in their order, all or those that a method takes."""
    for each in fields(request):
        row = each.metadata[_KEY]
        if method is None or method in row.methods.split():
            default = None if each.default is MISSING else each.default
            yield replace(row, name=each.name, type=str(each.type), default=default)


def checks(request: type) -> tuple[tuple[str, Callable[[Any], Any]], ...]:
    """Return the names of the options that are checked, and how."""
    checked = ((row.name, row.check) for row in rows(request))
    return tuple((name, check) for name, check in checked if check is not None)
