"""The messages from the app to the worker.

Input: nothing. Output: frozen records, each with its kind and the type of its result.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, Literal

from distal.editor.messages.kinds import Message, message
from distal.editor.messages.records import Change, Value
from distal.editor.messages.results import (
    Checked,
    Counting,
    DraftAnswer,
    EmittedText,
    ExportedFile,
    Greeted,
    LineTiming,
    Planned,
    ProbeResult,
    RenderChoices,
    Rendered,
    Saved,
    ShapeMap,
    VersionList,
    VersionText,
    Written,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class AppRequest(Message):
    """What all requests have.

    Attributes:
        result: Of a kind that is answered by ``answer``: the type of the result.
        id: The app's number of the request, never used twice.
        revision: The app's number of the text, greater after each change.
    """

    result: ClassVar[type | None] = None
    id: int
    revision: int

    @property
    def numbers(self) -> dict[str, Any]:
        """The two numbers, which each answer has."""
        return {"id": self.id, "revision": self.revision}


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


@message("look")
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

    known: str | None = None
    changes: tuple[Change, ...] = ()
    lean: bool = False
    guided: bool = True


@message("hold")
class HoldRequest(SourceRequest):
    """Make the number of a ``@func`` an input of the program. Answered as a ``look``.

    The ``scene`` that answers has ``held``: the name of the input, to be set by
    ``player.setNumber(held, value)``. Where it cannot be an input (a loop's bound), ``held`` is
    None and the program is the usual one.
    """

    file: str
    start: int
    end: int


@message("write", Written)
class WriteRequest(SourceRequest):
    """Write changes into the source: Keep of a slider, a literal or the camera."""

    changes: tuple[Change, ...]


@message("count", Counting)
class CountRequest(SourceRequest):
    """Give the program that counts how often each line runs.

    Attributes:
        work: Whether its estimated operations are counted instead.
    """

    work: bool = False


@message("time", LineTiming)
class TimeRequest(SourceRequest):
    """Give the program that repeats what a line computes, to measure its time."""


@message("map", ShapeMap)
class MapRequest(SourceRequest):
    """Give the program that draws which shape each pixel shows."""


@message("probe", ProbeResult)
class ProbeRequest(SourceRequest):
    """Tell what the pixel at ``x``, ``y`` shows (from the top left), with the camera as moved.

    Attributes:
        steering: "yaw", "pitch", "zoom", "pan_x", "pan_y"; empty where it was not moved.
    """

    x: float
    y: float
    steering: dict[str, float] = field(default_factory=dict)


@message("check", Checked)
class CheckRequest(SourceRequest):
    """Validate the scene as ``distal check`` does."""


@message("text", EmittedText)
class TextRequest(SourceRequest):
    """Give the emitted text of a target, as ``distal compile`` prints it."""

    target: str = "glsl-es300"


@message("export", ExportedFile)
class ExportRequest(SourceRequest):
    """Make a file of the scene; ``ready`` has the formats.

    Attributes:
        format: E.g. "page", "shadertoy", "isf", "wgsl".
        title: The title of a page; None for the scene's name.
        embed: Whether a page is a fragment for other pages.
        poster: A PNG in base64 that a page shows first; None for none.
    """

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


@message("render", Rendered)
class RenderRequest(PictureRequest):
    """Render a picture or film, with ``progress``."""


@message("command", Planned)
class CommandRequest(PictureRequest):
    """Give the command that renders it."""


@message("choices", RenderChoices)
class ChoicesRequest(AppRequest):
    """Tell what ``render`` can be asked for (local only; the server answers)."""


@message("cancel")
class CancelRequest(AppRequest):
    """End a ``render`` (local only), which is then ``dropped``; it has no answer of its own.

    Attributes:
        job: The ``id`` of the render.
    """

    job: int


@message("save", Saved)
class SaveRequest(AppRequest):
    """Write a file (local only; the server answers).

    Attributes:
        file: The file's name.
        text: Its new text.
        digest: The digest of what it replaces; None or "" for a new file.
        in_place: Whether the file itself is written, not replaced by another: other names of it
            (hard links) then have the new text, too.
    """

    file: str
    text: str
    digest: str | None = None
    in_place: bool = False


@message("hello", Greeted)
class HelloRequest(AppRequest):
    """Say which tab this is (local only; the server answers).

    Attributes:
        tab: The name that the tab had before it was loaded again, or "".
        is_new: Whether it has no texts yet: then it gets the drafts of tabs that are gone.
    """

    tab: str = ""
    is_new: bool = True


@message("draft", DraftAnswer)
class DraftRequest(AppRequest):
    """Keep an unsaved text (local only; the server answers).

    Attributes:
        file: The file's name.
        text: The text; None where the file on the disk has it.
        digest: The digest of the text on the disk that it began with; "" for a new file.
    """

    file: str
    text: str | None
    digest: str = ""


@message("versions", VersionList)
class VersionsRequest(AppRequest):
    """List the versions of a file that are kept (local only; the server answers)."""

    file: str


@message("version", VersionText)
class VersionRequest(AppRequest):
    """Give the text of a version (local only; the server answers)."""

    file: str
    version: str


@message("stop")
class StopRequest(AppRequest):
    """End the worker; it answers nothing."""
