"""All messages, and their JSON texts.

Input: a message, or a JSON text. Output: the text, or the message after its check.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Final

from distal.editor.messages.checking import MessageError, plain, record_of
from distal.editor.messages.kinds import KINDS, Message
from distal.editor.messages.records import (
    Change,
    Edit,
    Mistake,
    MistakeLabel,
    ShapePlace,
    SourceLiteral,
)
from distal.editor.messages.requests import AppRequest
from distal.editor.messages.responses import Answer
from distal.editor.messages.results import DiskProblem, RenderFormat, UnsavedText, VersionEntry

LONGEST_MESSAGE: Final = 64_000_000  # characters of a message
LONGEST_PRINTED: Final = 20_000  # characters that are kept of what the author's code prints
REQUESTS: Final = tuple(made for made in KINDS.values() if issubclass(made, AppRequest))
RESPONSES: Final = tuple(made for made in KINDS.values() if not issubclass(made, AppRequest))


def encoded(message: Message) -> str:
    """Return a message as JSON on one line, with all its fields."""
    return json.dumps({"kind": message.kind, **plain(message)}, separators=(",", ":"))


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
    if kind not in KINDS:
        raise MessageError(f"there is no message '{kind[:40]}'; kinds: {', '.join(KINDS)}")
    made: Message = record_of(KINDS[kind], found, kind)
    if isinstance(made, Answer):
        _check_result(made)
    return made


def _check_result(answer: Answer) -> None:
    wanted = {made.kind: made.result for made in REQUESTS}.get(answer.request)
    if wanted is None or type(answer.result) is not wanted:
        raise MessageError(f"answer.result: not the result of a '{answer.request[:40]}'")


def records() -> Iterator[type]:
    """Yield every record that a message is or has, each once: those in a message first."""
    yield from (Change, Edit, SourceLiteral, ShapePlace, MistakeLabel, Mistake)
    yield from (RenderFormat, DiskProblem, UnsavedText, VersionEntry)
    yield from (made.result for made in REQUESTS if made.result is not None)
    yield from REQUESTS
    yield from RESPONSES
