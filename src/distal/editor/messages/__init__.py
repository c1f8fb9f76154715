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

from distal.editor.messages.checking import MessageError, field_types
from distal.editor.messages.kinds import Message
from distal.editor.messages.protocol import (
    LONGEST_MESSAGE,
    LONGEST_PRINTED,
    REQUESTS,
    RESPONSES,
    encoded,
    parsed,
    records,
)
from distal.editor.messages.records import (
    Change,
    Edit,
    LiteralValue,
    Mistake,
    MistakeLabel,
    Parameter,
    Payload,
    Place,
    Program,
    ShapePlace,
    SourceLiteral,
    UniformValue,
    Value,
)
from distal.editor.messages.requests import (
    AppRequest,
    CancelRequest,
    CheckRequest,
    ChoicesRequest,
    CommandRequest,
    CountRequest,
    ExportRequest,
    HoldRequest,
    LookRequest,
    MapRequest,
    PictureRequest,
    ProbeRequest,
    RenderRequest,
    SaveRequest,
    SourceRequest,
    StopRequest,
    TextRequest,
    TimeRequest,
    WriteRequest,
)
from distal.editor.messages.responses import (
    Answer,
    Changed,
    Dropped,
    Found,
    Mistakes,
    NumbersFound,
    Printed,
    Progress,
    Ready,
    Reply,
    Restarted,
    SceneFound,
)
from distal.editor.messages.results import (
    Checked,
    Counting,
    EmittedText,
    ExportedFile,
    LineTiming,
    Planned,
    ProbeResult,
    RenderChoices,
    Rendered,
    RenderFormat,
    Result,
    Saved,
    ShapeMap,
    Written,
)

__all__ = [
    "LONGEST_MESSAGE",
    "LONGEST_PRINTED",
    "REQUESTS",
    "RESPONSES",
    "Answer",
    "AppRequest",
    "CancelRequest",
    "Change",
    "Changed",
    "CheckRequest",
    "Checked",
    "ChoicesRequest",
    "CommandRequest",
    "CountRequest",
    "Counting",
    "Dropped",
    "Edit",
    "EmittedText",
    "ExportRequest",
    "ExportedFile",
    "Found",
    "HoldRequest",
    "LineTiming",
    "LiteralValue",
    "LookRequest",
    "MapRequest",
    "Message",
    "MessageError",
    "Mistake",
    "MistakeLabel",
    "Mistakes",
    "NumbersFound",
    "Parameter",
    "Payload",
    "PictureRequest",
    "Place",
    "Planned",
    "Printed",
    "ProbeRequest",
    "ProbeResult",
    "Program",
    "Progress",
    "Ready",
    "RenderChoices",
    "RenderFormat",
    "RenderRequest",
    "Rendered",
    "Reply",
    "Restarted",
    "Result",
    "SaveRequest",
    "Saved",
    "SceneFound",
    "ShapeMap",
    "ShapePlace",
    "SourceLiteral",
    "SourceRequest",
    "StopRequest",
    "TextRequest",
    "TimeRequest",
    "UniformValue",
    "Value",
    "WriteRequest",
    "Written",
    "encoded",
    "field_types",
    "parsed",
    "records",
]
