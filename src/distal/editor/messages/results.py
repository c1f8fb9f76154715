"""The results of requests, one record for each kind of request that has one.

Input: nothing. Output: frozen records, and the type of all of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from distal.editor.messages.records import Edit, Mistake, Place, Program


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
    """The file is on the disk with this digest; or it is not written, and this is there instead.

    Attributes:
        digest: Of what is on the disk now; "" for nothing, "?" for what cannot be read.
        is_saved: Whether the text is on the disk.
        conflict: The text that is there instead; None where there is none.
        problem: What is wrong with the file that is there instead, as ``DiskProblem.text``; or "".
        refusal: Why the file is not replaced, although ``in_place`` would write it; or "".
        other: What another program wrote while the file was replaced; it is among the versions.
        unkept: Why the versions cannot be kept; "" where they are.
        order: As in ``changed``.
    """

    digest: str
    is_saved: bool = True
    conflict: str | None = None
    problem: str = ""
    refusal: str = ""
    other: str | None = None
    unkept: str = ""
    order: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class DiskProblem:
    """A file on the disk that has no text.

    Attributes:
        digest: Of its bytes; "" if it is gone, "?" if it cannot be read.
        text: What is wrong, for a sentence that begins with its name: "was deleted".
    """

    digest: str
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class UnsavedText:
    """A draft: a text, and the digest of what was on the disk when it began."""

    text: str
    digest: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Greeted:
    """What a tab begins with.

    Attributes:
        tab: The tab's name, to be said when the page is loaded again.
        drafts: Its unsaved texts by file.
        others: Files of which other unsaved texts were there; they are versions now.
        unkept: Why nothing can be kept; "" where it can.
    """

    tab: str
    drafts: dict[str, UnsavedText]
    others: tuple[str, ...]
    unkept: str


@dataclass(frozen=True, slots=True, kw_only=True)
class DraftAnswer:
    """The draft is kept; or ``unkept`` says why not."""

    unkept: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionEntry:
    """A version of a file.

    Attributes:
        name: Names it in ``version``.
        at: When it was kept, in milliseconds since 1970.
        why: "opened" (on the disk then), "saved" (here), "other" (by another program), "typed"
            (in the page), "left" (in a tab that is gone).
        size: In bytes.
    """

    name: str
    at: float
    why: str
    size: int


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionList:
    """The versions of a file, the newest first."""

    versions: tuple[VersionEntry, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class VersionText:
    """The text of a version."""

    text: str


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
    | Greeted
    | DraftAnswer
    | VersionList
    | VersionText
)  # in TypeScript, the type that `Results` has for the kind of the request
