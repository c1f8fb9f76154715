"""What several messages hold: values of parameters, changes, literals, places, mistakes.

Input: nothing. Output: types and frozen records.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias

from distal.error_codes import ErrorCode

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
class MistakeLabel:
    """Another place that a mistake is about, and what is there; fields as those of ``Mistake``."""

    text: str
    file: str | None
    line: int | None
    column: int | None
    end_line: int | None
    end_column: int | None
    excerpt: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Mistake:
    """An error, warning or note: the JSON of a ``Diagnostic``, and how severe it is.

    Attributes:
        code: The family of messages that it belongs to.
        line: Counted from 1, as columns are, in characters; null where the place is not known.
        end_column: One past the last column on the first line.
        excerpt: The whole first line.
    """

    severity: Literal["error", "warning", "note"]
    code: str = ErrorCode.DEVICE.value
    message: str
    hint: str | None = None
    file: str | None = None
    line: int | None = None
    column: int | None = None
    end_line: int | None = None
    end_column: int | None = None
    excerpt: str | None = None
    labels: tuple[MistakeLabel, ...] = ()
