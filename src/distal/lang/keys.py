"""Functions of scene code that read the keyboard.

A picture without a keyboard (a still, a video) reads that no key is down.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from distal.lang import func, ivec2, keyboard, texel
else:  # ``distal.lang`` imports this module
    from distal.ir.types import IVEC2
    from distal.lang.functions import func
    from distal.lang.live_textures import keyboard
    from distal.lang.names import texel
    from distal.lang.values import VALUE_CLASSES

    ivec2 = VALUE_CLASSES[IVEC2]


@func
def key_held(code: int) -> bool:
    """Return whether a key is down. ``code``: a member of ``Key``, or ``ord("A")`` for a letter."""
    return texel(keyboard, ivec2(code, 0)).x > 0.5


@func
def key_pressed(code: int) -> bool:
    """Return whether a key went down in this frame; ``code`` as for ``key_held``."""
    return texel(keyboard, ivec2(code, 1)).x > 0.5


@func
def key_toggled(code: int) -> bool:
    """Return whether a key was pressed an odd number of times; ``code`` as for ``key_held``."""
    return texel(keyboard, ivec2(code, 2)).x > 0.5
