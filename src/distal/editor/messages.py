"""The messages between the studio's app and its worker: their fields, and their check.

Input: JSON texts. Output: frozen records, checked field by field. A carrier (a socket, a pipe, a
browser's message port) carries one JSON object a message. ``tools/gen_messages.py`` makes the types
of TypeScript of these classes. Needs the standard library alone.

Each request has an ``id`` and the ``revision`` of the text it is about. It is answered by exactly
one message with the same two numbers: ``scene``, ``numbers``, ``answer``, ``mistakes`` or
``dropped``; before that there may be ``printed`` and ``progress``. The worker does one request at a
time. A request that waits is dropped when a newer one of its kind arrives, and a ``look`` drops all
that wait for an older revision. ``render`` has processes of its own: it waits for earlier ones
only, and is dropped by ``cancel``, which is not answered itself.

Offsets and columns are counted in UTF-16 units, as a browser does; offsets from the beginning of a
file's text, columns from 0, lines from 1. Texts of files end lines by a newline alone.
"""

from __future__ import annotations

import json
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass
from functools import cache
from typing import Annotated, Any, ClassVar, Final, Literal, TypeAlias, Union

LONGEST_MESSAGE: Final = 64_000_000  # characters of a message
LONGEST_PRINTED: Final = 20_000  # characters that are kept of what the author's code prints

# A parameter's value: a number, a switch, a color or a point.
Value: TypeAlias = bool | float | tuple[float, ...]
# What a literal holds; the text is that of a hex color or of a choice's word.
LiteralValue: TypeAlias = bool | float | str | tuple[float, ...]
# The names after a type are those of TypeScript.
Payload: TypeAlias = Annotated[dict[str, Any], "Payload"]
Program: TypeAlias = Annotated[dict[str, Any], "Program"]
Parameter: TypeAlias = Annotated[dict[str, Any], "Parameter"]
UniformValue: TypeAlias = Annotated[Any, 'UniformEntry["default"]']
Place: TypeAlias = tuple[int, int, int, int]  # first and last line of a text, file number, line


class MessageError(ValueError):
    """A message has the wrong form; the error says which field of it and what belongs there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Change:
    """One change of the source that the worker writes.

    Attributes:
        what: "literal": the one at ``file``, ``start`` and ``end``; "parameter": the default in the
            declaration of the parameter ``name``; "camera": the placement of the scene's camera.
        value: The new value of a literal or parameter; a choice's number for a parameter of choice.
        text: For a camera: what ``Player.cameraText()`` gives.
    """

    what: Literal["literal", "parameter", "camera"]
    file: str | None = None
    start: int | None = None
    end: int | None = None
    name: str | None = None
    value: LiteralValue | None = None
    text: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit:
    """A piece of a file to replace: offsets in the text as it was sent."""

    file: str
    start: int
    end: int
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceLiteral:
    """A literal of the source that a dial, a picker or a switch can change.

    Attributes:
        type: What changes it.
        value: Its value now; of a color linear numbers, or its text where it is "#hex".
        parts: Start and end of each number of a vector.
        call: The function or class it is an argument of, or "".
        slot: The name of that argument, or of the variable it is assigned to, or "".
        low: The least allowed value, of each part of a vector.
        high: The greatest.
        step: How much the last written digit counts.
        whole: Whether only whole numbers are allowed.
        options: The words of a choice.
        way: What a drag needs: "numbers" where the program stays (an object scene), "hold" where a
            ``hold`` request first makes it an input (in a ``@func``), else "compile".
    """

    file: str
    line: int
    start: int
    end: int
    text: str
    type: Literal["number", "vector", "color", "switch", "choice"]
    value: LiteralValue
    parts: tuple[tuple[int, int], ...] = ()
    call: str = ""
    slot: str = ""
    low: float | None = None
    high: float | None = None
    step: float = 1.0
    whole: bool = False
    options: tuple[str, ...] = ()
    way: Literal["numbers", "hold", "compile"] = "compile"


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapePlace:
    """Where a shape of the scene was written.

    Attributes:
        name: The author's name for it, else that of the primitive or operator.
        label: Whether the name is the author's.
        start: First column of the call that makes it.
        end: One past its last column on that line.
        material: The material's name or "".
    """

    name: str
    label: bool
    file: str
    line: int
    start: int
    end: int
    material: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """An error or warning; without a line where the place is not known."""

    severity: Literal["error", "warning", "note"]
    message: str
    file: str | None = None
    line: int | None = None
    column: int = 0
    end_line: int = 0
    end_column: int = 0
    hint: str | None = None


# Results of requests


@dataclass(frozen=True, slots=True, kw_only=True)
class Written:
    """Edits that make the changes; the new literals are found by the next ``look``."""

    edits: tuple[Edit, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Counting:
    """A program that counts how often lines run, or their operations, and what to draw it with.

    Draw it as the view's program with the uniform ``which`` set to the number of a place: each
    pixel's color holds the count as red + 256 green + 65536 blue (bytes).

    Attributes:
        most: The largest count of a pixel; it stands for all above.
        places: File (number in ``files``) and line by the number of the place.
    """

    program: Program
    which: str
    most: int
    files: tuple[str, ...]
    places: tuple[tuple[int, int], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class LineTiming:
    """A program that does what a line computes several times, without changing the picture.

    Attributes:
        choice: The program's line that picks a place. It ends in -1, for none; with n it repeats
            place n, with -2 - n the loop of the place alone, without what it computes.
        repeats: The uniform that says how often.
        places: File (number in ``files``) and line by the number of the place.
        evaluations: How often one repetition does the line, by the number of the place.
    """

    program: Program
    choice: str
    repeats: str
    files: tuple[str, ...]
    places: tuple[tuple[int, int], ...]
    evaluations: tuple[int, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ShapeMap:
    """A program that draws which shape each pixel shows, for outlines.

    Draw it as the view's program: each pixel's color holds the number of a part as red + 256 green
    + 65536 blue (bytes), with alpha 0 where there is none.

    Attributes:
        parts: For each number the lines that make a shape which holds the part: file (number in
            ``files``) and line.
    """

    program: Program
    files: tuple[str, ...]
    parts: tuple[tuple[tuple[int, int], ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeResult:
    """What a pixel shows; ``shape`` is empty where it is the background.

    Attributes:
        numbers: Further measured values by name, e.g. "steps", "distance", "depth".
    """

    shape: str = ""
    material: str = ""
    file: str | None = None
    line: int | None = None
    point: tuple[float, ...] = ()
    normal: tuple[float, ...] = ()
    numbers: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class EmittedText:
    """A scene as the text of a target, and where its lines come from."""

    target: str
    language: Literal["glsl", "wgsl", "llvm", "ir"]
    text: str
    files: tuple[str, ...]
    places: tuple[Place, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportedFile:
    """A file to save: its data as text, or in base64 where it is bytes."""

    name: str
    media_type: str
    text: str | None = None
    base64: str | None = None
    command: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Checked:
    """What ``distal check`` reports."""

    mistakes: tuple[Mistake, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Saved:
    """The file is on the disk, with this digest; or a conflict: what is there instead."""

    digest: str
    conflict: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderFormat:
    """A format of ``render``.

    Attributes:
        film: Whether it is a film; it is then written beside the scene.
        bits: The bits of a channel that there are; the first is the default.
        lossy: Whether it has a quality.
        loops: Whether the file says if it repeats.
        missing: What has to be installed first, or None.
    """

    name: str
    film: bool
    bits: tuple[int, ...] = ()
    lossy: bool = False
    loops: bool = False
    missing: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderChoices:
    """What ``render`` can be asked for.

    Attributes:
        modes: How light may be computed.
        qualities: Names of qualities; numbers from 0 to 100 are allowed, too.
        quality: The one that is used without.
        largest_side: Of a picture, in pixels.
        most_samples: Of a pixel.
        path_samples: Samples of a pixel in mode "path" without ``samples`` and ``time_limit``.
    """

    formats: tuple[RenderFormat, ...]
    modes: tuple[str, ...]
    qualities: tuple[str, ...]
    quality: str
    largest_side: int
    most_samples: int
    path_samples: int


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned:
    """The command that renders a picture or film, in the folder of the scene."""

    command: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Rendered:
    """A finished picture or film.

    Attributes:
        name: The file's name.
        bytes: Its size.
        address: Where the page gets it, for a picture; None for a film, which is beside the scene.
        command: The command that makes the same file.
        said: What the command has said: figures, warnings.
    """

    name: str
    bytes: int
    address: str | None
    command: str
    said: str = ""


Result: TypeAlias = (
    Written
    | Counting
    | LineTiming
    | ShapeMap
    | ProbeResult
    | EmittedText
    | ExportedFile
    | Checked
    | RenderChoices
    | Planned
    | Rendered
    | Saved
)  # in TypeScript, the type that `Results` has for the kind of the request


# From the app to the worker


@dataclass(frozen=True, slots=True, kw_only=True)
class AppRequest:
    """What all requests have.

    Attributes:
        id: The app's number of the request, never used twice.
        revision: The app's number of the text, greater after each change.
    """

    kind: ClassVar[str]
    result: ClassVar[type | None] = None
    id: int
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceRequest(AppRequest):
    """A request about a scene.

    Attributes:
        files: The texts by name: the scene's file and modules beside it.
        main: The name of the scene's file.
        object: The name of the object in it; None for the only one.
        view: The view to show.
        values: Values of parameters by name; others have their defaults.
        time: In seconds.
        look: The look to show it in; None for its own.
        mode: How light is computed; None: as the scene says.
        size: The author's frame in pixels.
    """

    files: dict[str, str]
    main: str
    object: str | None = None
    view: str = "color"
    values: dict[str, Value] = field(default_factory=dict)
    time: float = 0.0
    look: str | None = None
    mode: Literal["direct", "path"] | None = None
    size: tuple[int, int] = (640, 480)


@dataclass(frozen=True, slots=True, kw_only=True)
class LookRequest(SourceRequest):
    """Compile a scene's view. Answered by ``scene``, ``numbers`` or ``mistakes``.

    Attributes:
        known: The ``key`` of the program that the app shows; if it is still that of the scene, the
            answer is ``numbers``. None for a ``scene`` in any case.
        changes: Changes to make in the text first; the answer has their edits.
        lean: Whether to leave out literals and shapes, as while a literal is dragged.
        guided: Whether the camera's guide is among the programs. Without it the camera moves
            freely; while one types, the picture comes sooner.
    """

    kind: ClassVar[str] = "look"
    known: str | None = None
    changes: tuple[Change, ...] = ()
    lean: bool = False
    guided: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class HoldRequest(SourceRequest):
    """Make the number of a ``@func`` an input of the program. Answered as a ``look``.

    The ``scene`` that answers has ``held``: the name of the input, to be set by
    ``player.setNumber(held, value)``. Where it cannot be an input (a loop's bound), ``held`` is
    None and the program is the usual one.
    """

    kind: ClassVar[str] = "hold"
    file: str
    start: int
    end: int


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteRequest(SourceRequest):
    """Write changes into the source: Keep of a slider, a literal or the camera."""

    kind: ClassVar[str] = "write"
    result: ClassVar[type | None] = Written
    changes: tuple[Change, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class CountRequest(SourceRequest):
    """Give the program that counts how often each line runs.

    Attributes:
        work: Whether its estimated operations are counted instead.
    """

    kind: ClassVar[str] = "count"
    result: ClassVar[type | None] = Counting
    work: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class TimeRequest(SourceRequest):
    """Give the program that repeats what a line computes, to measure its time."""

    kind: ClassVar[str] = "time"
    result: ClassVar[type | None] = LineTiming


@dataclass(frozen=True, slots=True, kw_only=True)
class MapRequest(SourceRequest):
    """Give the program that draws which shape each pixel shows."""

    kind: ClassVar[str] = "map"
    result: ClassVar[type | None] = ShapeMap


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeRequest(SourceRequest):
    """Tell what the pixel at ``x``, ``y`` shows (from the top left), with the camera as moved.

    Attributes:
        steering: "yaw", "pitch", "zoom", "pan_x", "pan_y"; empty where it was not moved.
    """

    kind: ClassVar[str] = "probe"
    result: ClassVar[type | None] = ProbeResult
    x: float
    y: float
    steering: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckRequest(SourceRequest):
    """Validate the scene as ``distal check`` does."""

    kind: ClassVar[str] = "check"
    result: ClassVar[type | None] = Checked


@dataclass(frozen=True, slots=True, kw_only=True)
class TextRequest(SourceRequest):
    """Give the emitted text of a target, as ``distal compile`` prints it."""

    kind: ClassVar[str] = "text"
    result: ClassVar[type | None] = EmittedText
    target: str = "glsl-es300"


@dataclass(frozen=True, slots=True, kw_only=True)
class ExportRequest(SourceRequest):
    """Make a file of the scene; ``ready`` has the formats.

    Attributes:
        format: E.g. "page", "shadertoy", "isf", "wgsl".
        title: The title of a page; None for the scene's name.
        embed: Whether a page is a fragment for other pages.
        poster: A PNG in base64 that a page shows first; None for none.
    """

    kind: ClassVar[str] = "export"
    result: ClassVar[type | None] = ExportedFile
    format: str
    title: str | None = None
    embed: bool = False
    poster: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureRequest(SourceRequest):
    """A request about a picture or film to render (local only; the server answers).

    Its time is that of the picture, or of the first frame of a film.

    Attributes:
        format: The name of a format of ``choices``.
        samples: Samples of a pixel; None: as ``distal render`` has it.
        time_limit: In mode "path", of a picture: seconds after which no more samples are begun.
        bits: Bits of a channel of a picture; None for the format's own.
        transparent: Whether a picture's background is left out.
        steering: How the camera was moved; empty where it was not.
        duration: Seconds of a film.
        fps: Frames of a film in a second: "30", "29.97", "30000/1001".
        quality: Of a lossy film: a name, or a number from 0 to 100; None for the default.
        loop: Whether a film repeats, where its format says so.
    """

    format: str
    samples: int | None = None
    time_limit: float | None = None
    bits: int | None = None
    transparent: bool = False
    steering: dict[str, float] = field(default_factory=dict)
    duration: float = 2.0
    fps: str = "30"
    quality: str | None = None
    loop: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class RenderRequest(PictureRequest):
    """Render a picture or film, with ``progress``."""

    kind: ClassVar[str] = "render"
    result: ClassVar[type | None] = Rendered


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandRequest(PictureRequest):
    """Give the command that renders it."""

    kind: ClassVar[str] = "command"
    result: ClassVar[type | None] = Planned


@dataclass(frozen=True, slots=True, kw_only=True)
class ChoicesRequest(AppRequest):
    """Tell what ``render`` can be asked for (local only; the server answers)."""

    kind: ClassVar[str] = "choices"
    result: ClassVar[type | None] = RenderChoices


@dataclass(frozen=True, slots=True, kw_only=True)
class CancelRequest(AppRequest):
    """End a ``render`` (local only), which is then ``dropped``; it has no answer of its own.

    Attributes:
        job: The ``id`` of the render.
    """

    kind: ClassVar[str] = "cancel"
    job: int


@dataclass(frozen=True, slots=True, kw_only=True)
class SaveRequest(AppRequest):
    """Write a file (local only; the server answers). ``digest`` is that of the text it replaces."""

    kind: ClassVar[str] = "save"
    result: ClassVar[type | None] = Saved
    file: str
    text: str
    digest: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class StopRequest(AppRequest):
    """End the worker; it answers nothing."""

    kind: ClassVar[str] = "stop"


# From the worker to the app


@dataclass(frozen=True, slots=True, kw_only=True)
class Ready:
    """The first message of a worker.

    Attributes:
        abilities: The kinds of requests that it answers.
        versions: By name: "distal", "python", "payload", "messages".
        targets: The targets of ``text``.
        formats: The formats of ``export``.
    """

    kind: ClassVar[str] = "ready"
    abilities: tuple[str, ...]
    versions: dict[str, str]
    targets: tuple[str, ...] = ()
    formats: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """What all answers have: the numbers of the request."""

    kind: ClassVar[str]
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneFound(Found):
    """A compiled view: the payload of a player, with its program.

    Attributes:
        payload: For ``player.load(payload)``. It has the programs of ``view`` and of the camera's
            guide; ``views`` lists all views, with program -1 for those that are not there.
        objects: The names of the pictures in the file, which ``object`` can select.
        held: For ``hold``: the name of the input; else None.
    """

    kind: ClassVar[str] = "scene"
    payload: Payload
    objects: tuple[str, ...] = ()
    held: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class NumbersFound(Found):
    """The program is the one the app has; these are its new numbers.

    Attributes:
        numbers: The new values of the program's inputs of origin "number", by their ``name``: for
            ``player.setNumber(name, value)``.
        parameters: The declarations of all parameters, as in the payload.
    """

    kind: ClassVar[str] = "numbers"
    numbers: dict[str, UniformValue]
    parameters: tuple[Parameter, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistakes(Reply):
    """The author's code has mistakes, or the request cannot be done; at least one."""

    kind: ClassVar[str] = "mistakes"
    mistakes: tuple[Mistake, ...]
    literals: tuple[SourceLiteral, ...] | None = None
    edits: tuple[Edit, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer(Reply):
    """The result of a request; ``request`` is its kind."""

    kind: ClassVar[str] = "answer"
    request: str
    result: Result


@dataclass(frozen=True, slots=True, kw_only=True)
class Dropped(Reply):
    """A newer request made this one useless; it was not done."""

    kind: ClassVar[str] = "dropped"


@dataclass(frozen=True, slots=True, kw_only=True)
class Printed(Reply):
    """What the author's code printed."""

    kind: ClassVar[str] = "printed"
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress(Reply):
    """How much of a long request is done.

    Attributes:
        done: From 0 to 1, of what ``label`` names.
        label: What is done now: "waiting", "loading", "compiling", "rendering", "encoding".
        text: Figures for people: "12 of 60 frames".
        remaining_s: Seconds that are left of it, if that is known.
    """

    kind: ClassVar[str] = "progress"
    done: float
    label: str = ""
    text: str = ""
    remaining_s: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Changed:
    """Files were changed by another program (local only; from the server): their new texts."""

    kind: ClassVar[str] = "changed"
    files: dict[str, str]
    digests: dict[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Restarted:
    """The worker did not answer and was replaced (from the carrier); ``id`` is not answered."""

    kind: ClassVar[str] = "restarted"
    id: int | None
    reason: str


REQUESTS: Final = (
    LookRequest,
    HoldRequest,
    WriteRequest,
    CountRequest,
    TimeRequest,
    MapRequest,
    ProbeRequest,
    CheckRequest,
    TextRequest,
    ExportRequest,
    RenderRequest,
    CommandRequest,
    ChoicesRequest,
    CancelRequest,
    SaveRequest,
    StopRequest,
)
RESPONSES: Final = (
    *(Ready, SceneFound, NumbersFound, Mistakes, Answer, Dropped),
    *(Printed, Progress, Changed, Restarted),
)
Message: TypeAlias = (
    LookRequest
    | HoldRequest
    | WriteRequest
    | CountRequest
    | TimeRequest
    | MapRequest
    | ProbeRequest
    | CheckRequest
    | TextRequest
    | ExportRequest
    | RenderRequest
    | CommandRequest
    | ChoicesRequest
    | CancelRequest
    | SaveRequest
    | StopRequest
    | Ready
    | SceneFound
    | NumbersFound
    | Mistakes
    | Answer
    | Dropped
    | Printed
    | Progress
    | Changed
    | Restarted
)
_BY_KIND: Final[Mapping[str, type]] = {made.kind: made for made in (*REQUESTS, *RESPONSES)}


def encoded(message: Message) -> str:
    """Return a message as JSON on one line, with all its fields."""
    return json.dumps({"kind": message.kind, **_plain(message)}, separators=(",", ":"))


def parsed(text: str | bytes) -> Message:
    """Return the message of a JSON text.

    Raises:
        MessageError: It is not JSON, of no known kind, or a field is missing or of another type.
    """
    if len(text) > LONGEST_MESSAGE:
        raise MessageError(f"a message has at most {LONGEST_MESSAGE} characters, not {len(text)}")
    try:
        found = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise MessageError(f"a message is a JSON object; {str(error)[:100]}") from None
    if not isinstance(found, dict) or not isinstance(found.get("kind"), str):
        raise MessageError("a message is a JSON object with a text 'kind'")
    kind = found.pop("kind")
    if kind not in _BY_KIND:
        raise MessageError(f"there is no message '{kind[:40]}'; kinds: {', '.join(_BY_KIND)}")
    made: Message = _record(_BY_KIND[kind], found, kind)
    if isinstance(made, Answer):
        _check_result(made)
    return made


def _check_result(answer: Answer) -> None:
    wanted = {made.kind: made.result for made in REQUESTS}.get(answer.request)
    if wanted is None or type(answer.result) is not wanted:
        raise MessageError(f"answer.result: not the result of a '{answer.request[:40]}'")


def _plain(value: Any) -> Any:
    """Return a record, or a value in it, as JSON values."""
    if is_dataclass(value):
        return {f.name: _plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, tuple):
        return [_plain(v) for v in value]
    if isinstance(value, dict):
        return {key: _plain(v) for key, v in value.items()}
    return value


def _default(made: Any) -> Any:
    if made.default_factory is not MISSING:
        return made.default_factory()
    return made.default


@cache
def field_types(record: type) -> dict[str, Any]:
    """Return the types of a record's fields by name."""
    found = typing.get_type_hints(record, include_extras=True)
    return {f.name: found[f.name] for f in fields(record)}


def _record(record: type, found: Mapping[str, Any], path: str) -> Any:
    """Return a record from a JSON object.

    Raises:
        MessageError: As ``parsed``.
    """
    known = field_types(record)
    for name in found:
        if name not in known:
            raise MessageError(
                f"{path}: there is no field '{name[:40]}'; it has {', '.join(known)}"
            )
    for made in fields(record):
        if made.name not in found and _default(made) is MISSING:
            raise MessageError(f"{path}: the field '{made.name}' is missing")
    return record(**{n: _checked(known[n], value, f"{path}.{n}") for n, value in found.items()})


def _checked(wanted: Any, value: Any, path: str) -> Any:
    """Return a JSON value as a value of a type.

    Raises:
        MessageError: It is of another type.
    """
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return value if inner[0] is Any else _checked(inner[0], value, path)
    if origin in (Union, types.UnionType):
        return _member(inner, value, path)
    if origin is Literal:
        if value in inner:
            return value
    elif origin is tuple:
        if isinstance(value, list) and (inner[-1] is ... or len(value) == len(inner)):
            each = [inner[0]] * len(value) if inner[-1] is ... else inner
            pairs = enumerate(zip(each, value, strict=True))
            return tuple(_checked(t, v, f"{path}[{i}]") for i, (t, v) in pairs)
    elif origin is dict:
        if isinstance(value, dict):
            if inner[1] is Any:
                return value
            return {k: _checked(inner[1], v, f"{path}[{k[:40]}]") for k, v in value.items()}
    elif is_dataclass(wanted):
        if isinstance(value, dict):
            return _record(typing.cast(type, wanted), value, path)
    elif _is_of(wanted, value):
        return float(value) if wanted is float else value
    raise MessageError(f"{path}: {_named(wanted)} belongs here, not {json.dumps(value)[:60]}")


def _is_of(wanted: Any, value: Any) -> bool:
    if wanted is float:
        numeric = isinstance(value, int | float) and not isinstance(value, bool)
        return numeric and value == value and abs(value) <= 1e300
    if wanted is int:
        return isinstance(value, int) and not isinstance(value, bool) and abs(value) < 2**53
    return isinstance(value, wanted)


def _member(inner: tuple[Any, ...], value: Any, path: str) -> Any:
    """Return a JSON value as one of several types: the first that it fits.

    Raises:
        MessageError: It fits none.
    """
    first: MessageError | None = None
    for wanted in inner:
        try:
            return _checked(wanted, value, path)
        except MessageError as error:
            # The deepest error: a record with one wrong field, not a value of another type.
            if first is None or len(str(error).split(":")[0]) > len(str(first).split(":")[0]):
                first = error
    assert first is not None
    if str(first).startswith(f"{path}: "):
        names = " or ".join(map(_named, inner))
        raise MessageError(f"{path}: {names} belongs here, not {json.dumps(value)[:60]}")
    raise first


_NAMES: Final[Mapping[Any, str]] = {
    **{str: "a text", int: "a whole number", float: "a finite number", bool: "true or false"},
    types.NoneType: "null",
}


def _named(wanted: Any) -> str:
    """Return a type's name for people."""
    origin, inner = typing.get_origin(wanted), typing.get_args(wanted)
    if origin is Annotated:
        return f"a {inner[1]}"
    if origin is Literal:
        return " or ".join(map(repr, inner))
    if origin in (Union, types.UnionType):
        return " or ".join(map(_named, inner))
    if origin is tuple:
        return "a list" if inner[-1] is ... else f"a list of {len(inner)}"
    if origin is dict or is_dataclass(wanted):
        return "an object"
    return _NAMES[wanted]


def records() -> Iterator[type]:
    """Yield every record that a message is or has, each once: those in a message first."""
    yield from (Change, Edit, SourceLiteral, ShapePlace, Mistake)
    yield RenderFormat
    yield from (made.result for made in REQUESTS if made.result is not None)
    yield from REQUESTS
    yield from RESPONSES
