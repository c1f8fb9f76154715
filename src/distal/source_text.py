"""Bytes of Python files as text, and back: byte order marks, encoding lines, line ends.

Input: the bytes of a file, or a text. Output: the text that Python reads (PEP 263), or the bytes
that Python reads as that text. The only module that decodes and encodes scene files. Needs the
standard library alone.
"""

from __future__ import annotations

import codecs
import io
import tokenize
from typing import Final

_OTHER_MARKS: Final = {
    codecs.BOM_UTF32_LE: "UTF-32",
    codecs.BOM_UTF32_BE: "UTF-32",
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
}


class SourceTextError(ValueError):
    """A file is not text, or a text cannot be in a file; the message continues "FILE ..."."""


def has_mark(data: bytes) -> bool:
    """Return whether the byte order mark of UTF-8 begins a file."""
    return data.startswith(codecs.BOM_UTF8)


def decoded(data: bytes) -> str:
    """Return the text of a Python file, without a byte order mark, lines as in the file.

    Raises:
        SourceTextError: It has another encoding than it names, or names none that there is.
    """
    other = next((name for mark, name in _OTHER_MARKS.items() if data.startswith(mark)), None)
    if other is not None:
        raise SourceTextError(f"is text in {other}; save it as UTF-8")
    named = _named_encoding(data)
    try:
        return data.decode(named or "utf-8-sig")
    except UnicodeDecodeError:
        raise SourceTextError(f"is not text in {named or 'UTF-8'}") from None
    except LookupError:  # a codec of bytes, like base64
        raise SourceTextError(f"names '{named}', which is no encoding of text") from None


def encoded(text: str, *, mark: bool = False) -> bytes:
    """Return the bytes of a Python file, in the encoding that the text names.

    A text that names an encoding that there is not, or that contradicts the mark, is written as
    UTF-8: Python reports the name.

    Args:
        text: The text.
        mark: Whether to begin with the byte order mark of UTF-8.

    Raises:
        SourceTextError: The encoding lacks a character of the text.
    """
    try:
        named = "utf-8" if mark else _named_encoding(text.encode("utf-8", "replace")) or "utf-8"
        data = text.encode(named)
    except UnicodeEncodeError as error:
        line = text.count("\n", 0, error.start) + 1
        what = "that is not Unicode" if named == "utf-8" else f"that '{named}' does not have"
        raise SourceTextError(f"has a character in line {line} {what}") from None
    except (SourceTextError, LookupError):
        data = text.encode("utf-8", "replace")
    return codecs.BOM_UTF8 + data if mark else data


def with_plain_ends(text: str) -> str:
    """Return a text whose lines end by a newline alone, as Python reads it."""
    return text.replace("\r\n", "\n").replace("\r", "\n")


def lines_of(text: str) -> list[str]:
    """Return the lines that Python counts, with their newlines; ``splitlines`` counts others."""
    return io.StringIO(text).readlines()


def _named_encoding(data: bytes) -> str | None:
    """Return the encoding that the first two lines name; None if none, or UTF-8.

    Raises:
        SourceTextError: There is no such encoding, or the byte order mark contradicts it.
    """
    if b"coding" not in b"".join(data.split(b"\n", 2)[:2]):
        return None
    lines = io.BytesIO(data)
    try:
        name = tokenize.detect_encoding(lines.readline)[0]
    except SyntaxError as error:
        if "unknown encoding" in str(error):
            raise SourceTextError(f"names an {error}") from None
        what = "has a byte order mark of UTF-8 and names another encoding"
        raise SourceTextError(what if has_mark(data) else "is not text in UTF-8") from None
    return None if name in ("utf-8", "utf-8-sig") else name
