"""The actions of keys in a window.

Input: a key or a typed character. Output: the name of an action. The table of keys is
``scene/viewing/key_bindings.py``, which pages also use. Performs no action itself.
"""

from __future__ import annotations

from enum import Enum
from typing import Final

from distal.lang.live_textures import Key
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
    FRAME = "frame"
    FRONT = "front"
    BACK_SIDE = "back_side"
    RIGHT_SIDE = "right_side"
    LEFT_SIDE = "left_side"
    TOP = "top"
    BOTTOM = "bottom"
    COPY_CAMERA = "copy_camera"
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
    SECTION = "section"
    SECTION_SIDE = "section_side"
    SECTION_BACK = "section_back"
    SECTION_FORTH = "section_forth"
    RULER = "ruler"
    MODE = "mode"
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
_OPPOSITES: Final = {
    key: Action(binding.opposite)
    for binding in BINDINGS
    if binding.opposite is not None
    for key in binding.keys
}
# How the canvas names the digits of the numeric keypad: by the code of glfw.
_KEYPAD: Final = {chr(320 + digit): str(digit) for digit in range(10)}
# The canvas's number of a button -> its bit in ``frame.buttons``.
BUTTON_BITS: Final = {1: 1, 2: 2, 3: 4}
# Keys that stay the window's where a picture reads the keyboard.
_OF_WINDOW: Final = frozenset({"Escape", "Tab"})
_CODES: Final = {
    "ArrowLeft": Key.LEFT,
    "ArrowRight": Key.RIGHT,
    "ArrowUp": Key.UP,
    "ArrowDown": Key.DOWN,
    "PageUp": Key.PAGE_UP,
    "PageDown": Key.PAGE_DOWN,
    "Home": Key.HOME,
    "End": Key.END,
    "Enter": Key.ENTER,
    "Backspace": Key.BACKSPACE,
    "Shift": Key.SHIFT,
}
# Actions that repeat while the key is held; the system itself repeats typed characters.
REPEATED: Final = frozenset(
    {
        *(Action.LEFT, Action.RIGHT, Action.UP, Action.DOWN),
        *(Action.SECTION_BACK, Action.SECTION_FORTH),
    }
)


def code_of_key(key: str, *, modified: bool = False) -> int | None:
    """Return the code of a key that a picture reads; None for one that stays the window's.

    Args:
        key: The name of the key, such as "ArrowLeft", "a" or " ".
        modified: Whether ctrl or alt is held.
    """
    key = _KEYPAD.get(key, key)
    if modified or key in _OF_WINDOW:
        return None
    if len(key) == 1 and key.isascii() and (key.isalnum() or key == " "):
        return ord(key.upper())
    return _CODES.get(key)


def action_of_key(key: str, *, modified: bool = False) -> Action | None:
    """Return the action of a key by its name, such as "ArrowLeft", "1" or " ".

    Args:
        key: The name of the key.
        modified: Whether shift or ctrl is held, which gives digits the opposite action.
    """
    key = _KEYPAD.get(key, key)
    if key.isdigit():
        return (_OPPOSITES if modified else _KEYS).get(key)
    return _KEYS.get(key) if len(key) > 1 or key == " " else None


def action_of_character(character: str) -> Action | None:
    """Return the action of a typed character; digits and space are keys."""
    if character == " " or character.isdigit():
        return None
    return _KEYS.get(character, _KEYS.get(character.lower()))
