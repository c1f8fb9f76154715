"""The messages from the worker to the app.

Input: nothing. Output: frozen records, each with its kind.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from distal.editor.messages.kinds import Message, message
from distal.editor.messages.records import (
    Edit,
    Mistake,
    Parameter,
    Payload,
    ShapePlace,
    SourceLiteral,
    UniformValue,
)
from distal.editor.messages.results import DiskProblem, Result


@message("ready")
class Ready(Message):
    """The first message of a worker.

    Attributes:
        abilities: The kinds of requests that it answers.
        versions: By name: "distal", "python", "payload", "messages".
        targets: The targets of ``text``.
        formats: The formats of ``export``.
    """

    abilities: tuple[str, ...]
    versions: dict[str, str]
    targets: tuple[str, ...] = ()
    formats: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply(Message):
    """What all answers have: the numbers of the request."""

    id: int
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Found(Reply):
    """What a compiled scene has apart from its program.

    Attributes:
        key: Names the program: equal keys, equal programs.
        literals: None where the request was lean.
        shapes: None where the request was lean.
        edits: The edits of the request's changes.
        ms: Milliseconds of work by stage: "load", "compile", "literals", "all".
    """

    key: str
    literals: tuple[SourceLiteral, ...] | None = None
    shapes: tuple[ShapePlace, ...] | None = None
    edits: tuple[Edit, ...] = ()
    ms: dict[str, float] = field(default_factory=dict)


@message("scene")
class SceneFound(Found):
    """A compiled view: the payload of a player, with its program.

    Attributes:
        payload: For ``player.load(payload)``. It has the programs of ``view`` and of the camera's
            guide; ``views`` lists all views, with program -1 for those that are not there.
        objects: The names of the pictures in the file, which ``object`` can select.
        held: For ``hold``: the name of the input; else None.
    """

    payload: Payload
    objects: tuple[str, ...] = ()
    held: str | None = None


@message("numbers")
class NumbersFound(Found):
    """The program is the one the app has; these are its new numbers.

    Attributes:
        numbers: The new values of the program's inputs of origin "number", by their ``name``: for
            ``player.setNumber(name, value)``.
        parameters: The declarations of all parameters, as in the payload.
    """

    numbers: dict[str, UniformValue]
    parameters: tuple[Parameter, ...]


@message("mistakes")
class Mistakes(Reply):
    """The author's code has mistakes, or the request cannot be done; at least one."""

    mistakes: tuple[Mistake, ...]
    literals: tuple[SourceLiteral, ...] | None = None
    edits: tuple[Edit, ...] = ()


@message("answer")
class Answer(Reply):
    """The result of a request; ``request`` is its kind."""

    request: str
    result: Result


@message("dropped")
class Dropped(Reply):
    """A newer request made this one useless; it was not done."""


@message("printed")
class Printed(Reply):
    """What the author's code printed, or where it is after some seconds.

    Attributes:
        text: The text.
        hangs: The line that it is at after some seconds, else nothing.
    """

    text: str
    hangs: str = ""


@message("progress")
class Progress(Reply):
    """How much of a long request is done.

    Attributes:
        done: From 0 to 1, of what ``label`` names.
        label: What is done now: "waiting", "loading", "compiling", "rendering", "encoding".
        text: Figures for people: "12 of 60 frames".
        remaining_s: Seconds that are left of it, if that is known.
    """

    done: float
    label: str = ""
    text: str = ""
    remaining_s: float | None = None


@message("changed")
class Changed(Message):
    """How files are on the disk (local only; from the server): all at first, then what changes.

    Attributes:
        files: The texts by name; of a file with a problem the last one that it had.
        digests: Of these texts; "" for those that are not on the disk yet.
        problems: Of files that have no text now.
        order: Grows with each change: an older message says nothing of newer ones.
    """

    files: dict[str, str]
    digests: dict[str, str]
    problems: dict[str, DiskProblem] = field(default_factory=dict)
    order: int = 0


@message("restarted")
class Restarted(Message):
    """The worker did not answer and was replaced (from the carrier); ``id`` is not answered."""

    id: int | None
    reason: str
