"""The codes of errors, warnings and notes: each names one family of messages.

Every ``Diagnostic`` has one, so that an editor can group, filter or explain messages without
reading their texts. Input: nothing. Output: ``ErrorCode``, whose members are texts, each with its
meaning; ``docs/reference/errors.md`` lists them. Depends on nothing.
"""

from __future__ import annotations

from enum import StrEnum
from typing import Final, Self

MOST_CODES: Final = 40


class ErrorCode(StrEnum):
    """A family of messages.

    Attributes:
        meaning: What is wrong, in a few words.
    """

    meaning: str

    def __new__(cls, text: str, meaning: str) -> Self:
        """Return a member: a text that has a meaning."""
        code = str.__new__(cls, text)
        code._value_ = text
        code.meaning = meaning
        return code

    # Files and Python
    SYNTAX = "syntax", "the file is not Python"
    FILE = "file", "a file cannot be found, read or run, or runs for too long"
    SOURCE = "source", "the text of a function cannot be read, or is not what Python runs"
    LESSON = "lesson", "a lesson is not written as lessons are"
    DEVICE = "device", "a device, a process or a package cannot do the work"

    # Scene code
    LANGUAGE = "not-scene-code", "Python that scene code does not have: a statement, a function"
    NAME = "unknown-name", "there is no such name, field or component"
    UNSET = "no-value", "a local may have no value where it is read"
    TYPE = "type", "a value has another type than it must have"
    VALUE = "not-a-value", "a function, a type or a Python object stands for a value"
    CALL = "arguments", "a call has too few, too many or unknown arguments"
    ANNOTATION = "annotation", "an annotation is missing, or is not a type"
    DEFINITION = "definition", "a function, a struct or an image is not defined as it must be"
    ASSIGNMENT = "assignment", "what stands on the left side cannot be assigned to"
    RESULT = "result", "a function returns no value, or a value is not used"
    INDEX = "index", "an index is negative, out of range or not known"
    NUMBER = "number", "a number is out of range, or an operation has no result"
    SIZE = "size", "a vector or an array has too few or too many elements"
    LOOP = "loop", "the bounds of a loop are not known, or do not match"
    RECURSION = "recursion", "a function or an object contains itself, or is nested too deeply"
    PARAMETER = "parameter-name", "two parameters have one name"

    # Objects and targets
    OBJECT = "object", "an object of a scene does not accept a value"
    TARGET = "target", "the target cannot do what the scene needs"

    # Findings of ``distal check``
    SLOPE_EXCEEDED = "slope-exceeded", "the value changes faster than the slope allows"
    SLOPE_REFUTED = "slope-refuted", "the slope is too small, by interval arithmetic"
    SLOPE_OUTSIDE_BOX = "slope-outside-box", "the slope is too small outside of the bounds"
    SLOPE_TOO_LARGE = "slope-too-large", "the slope is a hundred times what was measured"
    NO_INSIDE = "no-inside", "the shape is a sheet or an estimate, and drawn with a thickness"
    OUTSIDE_BOX = "outside-box", "part of the shape is outside its box"
    NOT_EXACT = "not-exact", "the values of a shape that is declared exact are not distances"
    UNDEFINED = "undefined", "a value or a gradient is NaN or infinite"
    FLUSH_FACES = "flush-faces", "a cutter ends exactly on a face, or a blend moves a flush face"
    NO_BOX = "no-box", "the shape has no finite bounding box"
    NO_GROWTH = "no-growth", "the box is lost because the growth of a function is not known"
    BLEND_EVERYWHERE = "blend-everywhere", "a blend changes shapes far from where they meet"
    PROVED = "proved", "the slope or the box is proved in a region"
    SLOPE_PROVED = "slope-proved", "the slope holds at every point of the box"
    SLOPE_NOT_PROVED = "slope-not-proved", "the slope is neither proved nor refuted"
    SLOPE_RAISED = "slope-raised", "an operator raises the slope"
    CLAIM_LOST = "claim-lost", "an operator loses a guarantee"
