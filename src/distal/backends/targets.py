"""What is known of a text target besides its capabilities: where it is used, and how.

Input: one declaration for each target, in the ``targets`` module of its backend. Output: what the
command line, exports and the backends read. Declarations import no backend: they are read whenever
``distal`` starts. To add a target of a family, add a declaration to its ``TARGETS``.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

from distal.ir.target import Target


class Declares(Enum):
    """Where a text gets a uniform from."""

    TEXT = "text"  # it declares it, and whoever draws sets it
    PLACE = "place"  # the place has declared it already
    NOBODY = "nobody"  # nothing there would set it: it is a constant


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTarget(Target):
    """A target whose output is a shader text.

    Attributes:
        backend: The module that writes it.
        place: The name of the place where the text is used.
        use: How to use it there, in sentences.
        suffix: What exported files end in; None where another target has the suffix.
        parameters: Who declares the author's parameters.
        textures_by: How a person gives a text its textures, where the text does not declare them.
    """

    backend: ClassVar[str]
    place: str
    use: str
    suffix: str | None = None
    parameters: Declares = Declares.TEXT
    textures_by: str = ""
