"""Textures whose texels change with each frame: earlier pictures, the keyboard.

A host provides the texels: ``runtime.frame_history`` for pictures rendered from Python, the player
for a page. This module declares what they are, and the values of a host that has none.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, Final

from distal.diagnostics import LoadError
from distal.ir.types import TEXTURE_2D, Type
from distal.lang.resources import Texture2D, TextureValue, beside

if TYPE_CHECKING:
    from distal.lang.functions import Image

KEYS: Final = 256
SOUND_COLUMNS: Final = 512
SILENT_WAVE: Final = 128.0 / 255.0


class LiveTexture(TextureValue):
    """A flat texture whose texels a host sets before each frame.

    Attributes:
        wrap: How it is sampled outside.
        kind: What it shows; a host that does not know the kind cannot show the picture.
        shown: The kind in messages.
    """

    __distal_type__: ClassVar[Type] = TEXTURE_2D
    kind: ClassVar[str]
    shown: ClassVar[str]

    def __init__(self, wrap: str = "clamp") -> None:
        super().__init__(None, wrap)

    def __repr__(self) -> str:
        return f"<{self.shown}>"


class LastFrame(LiveTexture):
    """The latest picture of an image: this frame's if it is drawn before the reader.

    Attributes:
        image: The image.
    """

    kind = "picture"
    shown = "earlier frames"

    def __init__(self, image: Image, wrap: str = "clamp") -> None:
        self.image = image
        super().__init__(wrap)

    def __repr__(self) -> str:
        return f"<{self.shown} of '{self.image.name}'>"

    @property
    def data(self) -> Any:
        """Texels for a host without earlier frames.

        Raises:
            LoadError: Always.
        """
        raise LoadError(
            f"what is drawn here reads earlier frames of '{self.image.name}', which only the "
            "picture of an @image has: .render(), a video, a window or a page"
        )

    @data.setter
    def data(self, value: Any) -> None:
        """Take nothing: the texels are the host's."""


class Key(IntEnum):
    """The codes of some keys, as browsers and Shadertoy number them; letters are ``ord("A")``."""

    BACKSPACE = 8
    TAB = 9
    ENTER = 13
    SHIFT = 16
    CONTROL = 17
    ALT = 18
    ESCAPE = 27
    SPACE = 32
    PAGE_UP = 33
    PAGE_DOWN = 34
    END = 35
    HOME = 36
    LEFT = 37
    UP = 38
    RIGHT = 39
    DOWN = 40
    A = 65
    D = 68
    E = 69
    F = 70
    Q = 81
    R = 82
    S = 83
    W = 87
    X = 88
    Z = 90


@dataclass(frozen=True, slots=True)
class Keys:
    """The state of the keyboard in one frame, as codes of keys.

    Attributes:
        held: The keys that are down.
        pressed: Those that went down in this frame.
        toggled: Those that were pressed an odd number of times.
    """

    held: frozenset[int] = frozenset()
    pressed: frozenset[int] = frozenset()
    toggled: frozenset[int] = frozenset()

    @staticmethod
    def of(held: Collection[int]) -> Keys:
        """Return the state in which these keys went down in the first frame and are still down."""
        codes = frozenset(held)
        return Keys(codes, frozenset(), codes)

    def with_key(self, code: int, *, down: bool) -> Keys:
        """Return the state after a key went down or up."""
        if not down:
            return replace(self, held=self.held - {code})
        if code in self.held:  # repeated by the system
            return self
        one = frozenset({code})
        return Keys(self.held | one, self.pressed | one, self.toggled ^ one)

    def settled(self) -> Keys:
        """Return the state in the next frame."""
        return replace(self, pressed=frozenset()) if self.pressed else self

    def rows(self) -> list[list[tuple[float, float, float, float]]]:
        """Return texels: a row for each set, from below, and a column for each code."""
        return [_row(codes) for codes in (self.held, self.pressed, self.toggled)]


NO_KEYS: Final = Keys()


def _row(codes: Iterable[int]) -> list[tuple[float, float, float, float]]:
    found = set(codes)
    return [(float(i in found), 0.0, 0.0, 1.0) for i in range(KEYS)]


def checked_keys(keys: Any) -> Keys:
    """Return the state of the keyboard for an option: a ``Keys``, or the codes of held keys.

    Raises:
        TypeError: It is neither.
        ValueError: A code is out of range.
    """
    if isinstance(keys, Keys):
        return keys
    if isinstance(keys, str | bytes) or not isinstance(keys, Sequence | Collection):
        raise TypeError(f"keys are codes such as Key.LEFT or ord('A'), not {keys!r}")
    for code in keys:
        if isinstance(code, bool) or not isinstance(code, int):
            raise TypeError(f"a key is a code such as Key.LEFT or ord('A'), not {code!r}")
        if not 0 <= code < KEYS:
            raise ValueError(f"the code of a key lies between 0 and {KEYS - 1}, not {code}")
    return Keys.of(keys)


class Keyboard(LiveTexture):
    """The keyboard, with Shadertoy's texels; see ``key_held`` and the functions beside it."""

    kind = "keyboard"
    shown = "keyboard"

    @property
    def data(self) -> Any:
        """Texels for a host without a keyboard: no key is down."""
        return [row for row in reversed(NO_KEYS.rows())]

    @data.setter
    def data(self, value: Any) -> None:
        """Take nothing: the texels are the host's."""


class Microphone(LiveTexture):
    """The microphone, with Shadertoy's texels: 512 columns, and two rows from below.

    The first row is the spectrum from 0 to about 11 kHz, the second one the wave, 0.5 at rest; both
    are in the first component, from 0 to 1. Pages have it after a person allowed it; everything
    else hears silence.
    """

    kind = "mic"
    shown = "microphone"

    @property
    def data(self) -> Any:
        """Texels for a host without a microphone: silence."""
        return [[(value, 0.0, 0.0, 1.0)] * SOUND_COLUMNS for value in (SILENT_WAVE, 0.0)]

    @data.setter
    def data(self, value: Any) -> None:
        """Take nothing: the texels are the host's."""


class SoundFile(LiveTexture):
    """A sound from a file, with the texels of ``microphone`` at the time of the frame.

    They are the same on every device and page. Videos and pages of the picture play the sound.

    Args:
        path: A file: ``.wav``, or what PyAV reads (``.mp3``, ``.ogg``, ``.flac`` ...), ten minutes
            at most. A relative name is looked up in the folder of the file that declares it, then
            in the working folder; "example:arpeggio.wav" is that of an example.
        loop: Whether it begins again at its end; else it is silent from there on.
    """

    kind = "music"
    shown = "sound"

    def __init__(self, path: str | PathLike[str], *, loop: bool = True) -> None:
        if not isinstance(path, str | PathLike) or not os.fspath(path):
            raise TypeError(f"a sound is the path of a file, not {path!r:.40}")
        declared_in = sys._getframe(1).f_globals.get("__file__")
        self.path = str(beside(declared_in, path) if isinstance(declared_in, str) else path)
        self.loop = bool(loop)
        super().__init__()

    def __repr__(self) -> str:
        return f"<sound '{os.path.basename(self.path)}'>"

    @property
    def data(self) -> Any:
        """Texels of silence, for a host that shows no time."""
        return microphone.data

    @data.setter
    def data(self, value: Any) -> None:
        """Take nothing: the texels are the host's."""


class ImageInput(Texture2D):
    """A picture that whoever sees a page replaces by one of their own, by dropping a file on it.

    Elsewhere it is the ``Texture2D`` of its data.

    Args:
        data: A file, an array, or nested lists of numbers.
        wrap: How to sample outside: "repeat", or "clamp" to repeat the edge texels.
        max_memory: The most memory that a file may become, as "4 GB" or in bytes; None: by its
            size.
    """


keyboard: Final = Keyboard()
microphone: Final = Microphone()
