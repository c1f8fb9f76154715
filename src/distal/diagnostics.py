"""Source spans, and the errors that a scene author sees.

Input: a message, a place in the author's source and, if known, a hint. Output: an exception whose
text shows the author's line with a caret. This is the only module that prints carets; other modules
report a mistake by raising ``CompileError`` with a ``Diagnostic``. The module also makes external
texts (from a file, a driver or a package) safe to print.
"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any, Final

from distal.error_codes import ErrorCode

LONGEST_SHOWN: Final = 200  # characters of an external text
LONGEST_MESSAGE: Final = 1000  # characters of a line that may contain several external texts

_PLACE_KEYS: Final = ("file", "line", "column", "end_line", "end_column")

# Control, format (bidirectional overrides, zero width), surrogates, line and paragraph separators.
_UNSAFE_CATEGORIES: Final = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
# Invisible letters and marks (Unicode's Default_Ignorable_Code_Point of other categories).
_INVISIBLE: Final = frozenset(
    map(
        chr,
        (
            *(0x034F, 0x115F, 0x1160, 0x17B4, 0x17B5, 0x2065, 0x3164, 0xFFA0),
            *range(0x180B, 0x1810),
            *range(0xFE00, 0xFE10),
            *range(0xFFF0, 0xFFF9),
            *range(0xE0000, 0xE1000),
        ),
    )
)


def readable(name: object) -> str:
    r"""Return the name of a file as Unicode text: bytes of it that are no UTF-8 as ``\xNN``.

    Python reads such bytes, and in a locale without UTF-8 all others than ASCII, as half characters
    (surrogates), which no file can hold.

    Args:
        name: The name or path, as Python has it.
    """
    text = str(name)
    try:
        return text.encode("utf-8", "surrogateescape").decode("utf-8", "backslashreplace")
    except UnicodeEncodeError:  # other half characters, which Windows allows
        return text.encode("utf-8", "backslashreplace").decode("utf-8")


def printable(text: object, limit: int = LONGEST_SHOWN) -> str:
    """Return an external text on one line: control characters escaped, long texts cut.

    Args:
        text: Any object; converted by ``str``.
        limit: Maximum number of characters.
    """
    whole = readable(text)
    safe = "".join(map(_escaped, whole[: limit + 1]))
    return safe if len(safe) <= limit else f"{safe[: limit - 1]}…"


def printable_lines(text: object) -> str:
    """Escape control characters in a message with external text; keep newlines and tabs."""
    return "".join(c if c in "\n\t" else _escaped(c) for c in str(text))


def _escaped(character: str) -> str:
    if " " <= character <= "~":
        return character
    if unicodedata.category(character) in _UNSAFE_CATEGORIES or character in _INVISIBLE:
        return character.encode("unicode_escape").decode("ascii")
    return character


@dataclass(frozen=True, slots=True)
class Span:
    """A range of the author's source.

    Attributes:
        file: The file name as the author knows it.
        line: First line, counted from 1.
        col: First column, counted from 0 in characters.
        end_col: One past the last column on the first line.
        text: The whole first line, without its newline.
        end_line: Last line of the range; usually equal to ``line``.
    """

    file: str
    line: int
    col: int
    end_col: int
    text: str
    end_line: int = 0


@dataclass(frozen=True, slots=True)
class Label:
    """Another place that a mistake is about, and what is there (no full stop)."""

    span: Span
    text: str


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake: the message (no full stop), its place and, if known, a hint how to fix it.

    Attributes:
        code: The family of messages that it belongs to.
        labels: Other places that explain it, such as where a local got its type.
    """

    code: ErrorCode
    message: str
    span: Span | None
    hint: str | None = None
    labels: tuple[Label, ...] = ()

    def __str__(self) -> str:
        return self.text("error")

    def text(self, kind: str) -> str:
        """Return the text with its severity ("error", "warning" or "note") in front."""
        places = [label.span for label in self.labels]
        places += [] if self.span is None else [self.span]
        width = max((len(_line_number(span)) for span in places), default=1)
        lines = [f"{kind}: {self.message}"]
        if self.span is not None:
            lines += _excerpt(self.span, width, "-->", "^")
        for label in self.labels:
            lines += _excerpt(label.span, width, ":::", "-", f" {label.text}")
        if self.hint:
            lines.append(f"{' ' * width} = hint: {self.hint}")
        return "\n".join(lines)

    def to_json(self) -> dict[str, Any]:
        """Return plain values in the schema of ``docs/reference/errors.md``."""
        labels = [{"text": label.text, **_line_json(label.span)} for label in self.labels]
        return {
            "code": self.code.value,
            "message": self.message,
            "hint": self.hint,
            **_line_json(self.span),
            "labels": labels,
        }


def place_json(span: Span | None) -> dict[str, Any] | None:
    """Return a place with lines and columns counted from 1, as in editors; None if not known."""
    if span is None:
        return None
    return {
        "file": readable(span.file),
        "line": span.line,
        "column": span.col + 1,
        "end_line": span.end_line or span.line,
        "end_column": span.end_col + 1,
    }


def _line_json(span: Span | None) -> dict[str, Any]:
    """Return a place and its line; of an unknown place, None for each."""
    line = None if span is None else span.text
    return {**dict.fromkeys(_PLACE_KEYS), **(place_json(span) or {}), "excerpt": line}


def excerpt(span: Span) -> list[str]:
    """Return the place in the author's file, and the line with carets below."""
    return _excerpt(span, len(_line_number(span)), "-->", "^")


def _excerpt(span: Span, width: int, arrow: str, mark: str, text: str = "") -> list[str]:
    """Return a place, and its line with marks and a text below.

    Args:
        span: The place.
        width: The width of the line numbers.
        arrow: What stands before the place.
        mark: The character that marks the columns.
        text: What follows the marks.
    """
    gutter = " " * width
    # Tabs are kept, so that the marks are in the same columns as in the editor.
    lead = "".join("\t" if c == "\t" else " " for c in span.text[: span.col])
    marks = mark * max(1, min(span.end_col, len(span.text)) - span.col)
    return [
        f"{gutter}{arrow} {span.file}:{span.line}:{span.col + 1}",
        f"{gutter} |",
        f"{_line_number(span):>{width}} | {span.text}",
        f"{gutter} | {lead}{marks}{text}",
    ]


def _line_number(span: Span) -> str:
    return f"{span.line:>2}"


class CompileError(Exception):
    """One or more mistakes in the author's scene code; the message shows all of them.

    Attributes:
        diagnostics: At least one, in the order of the source.
    """

    def __init__(self, diagnostics: Iterable[Diagnostic]) -> None:
        self.diagnostics = tuple(diagnostics)
        assert self.diagnostics, "a compile error needs a diagnostic"
        super().__init__("\n\n".join(map(str, self.diagnostics)))

    def __reduce__(self) -> Any:
        return type(self), (self.diagnostics,)

    @classmethod
    def at(
        cls,
        code: ErrorCode,
        message: str,
        span: Span | None,
        hint: str | None = None,
        labels: tuple[Label, ...] = (),
    ) -> CompileError:
        """Return an error for a single mistake.

        Args:
            code: The family of messages that it belongs to.
            message: What is wrong.
            span: Where it is; None if the place is not known.
            hint: What to write instead.
            labels: Other places that explain it.
        """
        return cls([Diagnostic(code, message, span, hint, labels)])


class LoadError(Exception):
    """A scene file that cannot be found, read or run, or that defines no scene code.

    Attributes:
        message: What is wrong, and where.
        span: The place in the author's files, where it is known.
        reason: The message without its place.
        hint: What to write instead, where it is known.
    """

    def __init__(
        self,
        message: str,
        span: Span | None = None,
        reason: str | None = None,
        hint: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.span = span
        self.reason = message if reason is None else reason
        self.hint = hint

    def __reduce__(self) -> Any:
        return type(self), (self.message, self.span, self.reason, self.hint)

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The mistake, as that of a ``CompileError``."""
        return (Diagnostic(ErrorCode.FILE, self.reason, self.span, self.hint),)


class DeviceError(Exception):
    """A device is missing, was lost or cannot do the work; the message says how to fix it."""
