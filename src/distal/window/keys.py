"""The actions of keys in a window.

Input: a key or a typed character. Output: the name of an action. The table of keys is
``scene/viewing/key_bindings.py``, which pages also use. Performs no action itself.
"""

from __future__ import annotations

from enum import Enum
from typing import Final

from distal.scene.viewing.key_bindings import BINDINGS


class Action(Enum):
    """The action of a key: one of ``BINDINGS``."""

    LEFT = "left"
    RIGHT = "right"
    UP = "up"
    DOWN = "down"
    NEARER = "nearer"
    FARTHER = "farther"
    RESET_CAMERA = "reset_camera"
    PAUSE = "pause"
    BACK = "back"
    FORTH = "forth"
    FRAME_BACK = "frame_back"
    FRAME_FORTH = "frame_forth"
    BEGIN = "begin"
    SLOWER = "slower"
    FASTER = "faster"
    NEXT_VIEW = "next_view"
    LAST_VIEW = "last_view"
    PARAMETERS = "parameters"
    SCREENSHOT = "screenshot"
    FULL_SCREEN = "full_screen"
    HELP = "help"
    OVERLAY = "overlay"
    RESET_PARAMETER = "reset_parameter"
    QUIT = "quit"


# Typed characters, not keys, because brackets have other keys on other keyboards. Space is a key.
_KEYS: Final = {
    key: Action(binding.action)
    for binding in BINDINGS
    for key in (*binding.keys, *binding.window_keys)
}
# Actions that repeat while the key is held; the system itself repeats typed characters.
REPEATED: Final = frozenset({Action.LEFT, Action.RIGHT, Action.UP, Action.DOWN})


def action_of_key(key: str) -> Action | None:
    """Return the action of a key by its name, such as "ArrowLeft" or " "."""
    return _KEYS.get(key) if len(key) > 1 or key == " " else None


def action_of_character(character: str) -> Action | None:
    """Return the action of a typed character."""
    if character == " ":
        return None
    return _KEYS.get(character, _KEYS.get(character.lower()))
