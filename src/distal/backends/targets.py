"""The properties of a text target besides its capabilities: where and how the text is used.

Each target is declared once, in the ``targets`` module of its backend. The command line, exports
and the backends read the declarations. They import no backend, because they are read whenever
``distal`` starts. To add a target, add a declaration to the ``TARGETS`` of its backend.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, Final

from distal.ir.target import Target
from distal.ir.types import TextureShape

ALL_SHAPES: Final = frozenset(TextureShape)


class Declares(Enum):
    """Who declares a uniform."""

    TEXT = "text"  # the text declares it, and the program that draws sets it
    PLACE = "place"  # the host declares it before the text
    NOBODY = "nobody"  # the host cannot set it, so it is a constant


@dataclass(frozen=True, slots=True, kw_only=True)
class TextTarget(Target):
    """A target whose output is a shader text.

    Attributes:
        backend: The module that writes the text.
        place: The name of the host, where the text is used.
        use: How to use it there, in sentences.
        suffix: The suffix of exported files; None if another target has the suffix.
        parameters: Who declares the author's parameters.
        textures_by: How a user provides textures, if the text does not declare them.
        textures: The kinds of textures that it can read.
        most_textures: The largest number of textures; None: no limit of the target's own.
        live: Whether the host has what changes with each frame: the keyboard, earlier frames ...
    """

    backend: ClassVar[str]
    place: str
    use: str
    suffix: str | None = None
    parameters: Declares = Declares.TEXT
    textures_by: str = ""
    textures: frozenset[TextureShape] = ALL_SHAPES
    most_textures: int | None = None
    live: bool = False

    @property
    def host(self) -> str:
        """The name of the host, for messages."""
        return self.place.partition(",")[0]

    @property
    def is_described(self) -> bool:
        """Whether a description of its interface, with all values, belongs to a text."""
        return self.parameters is Declares.TEXT
