"""Which key does what, and how the help says it.

What flows in: a key or a typed character. What flows out: an action's name, or a row of the help.
Does nothing itself.
"""

from __future__ import annotations

from enum import Enum, auto
from typing import Final


class Action(Enum):
    """What a key asks for."""

    PAUSE = auto()
    BACK = auto()
    FORTH = auto()
    BEGIN = auto()
    SLOWER = auto()
    FASTER = auto()
    NEXT_VIEW = auto()
    LAST_VIEW = auto()
    PARAMETERS = auto()
    UP = auto()
    DOWN = auto()
    RESET_PARAMETER = auto()
    RESET_CAMERA = auto()
    HELP = auto()
    OVERLAY = auto()
    SCREENSHOT = auto()
    FULL_SCREEN = auto()
    QUIT = auto()


_NAMED: Final = {
    " ": Action.PAUSE,
    "ArrowLeft": Action.BACK,
    "ArrowRight": Action.FORTH,
    "ArrowUp": Action.UP,
    "ArrowDown": Action.DOWN,
    "Home": Action.BEGIN,
    "Tab": Action.PARAMETERS,
    "Backspace": Action.RESET_PARAMETER,
    "Escape": Action.QUIT,
    "F11": Action.FULL_SCREEN,
}
# Typed characters, not keys: brackets stand elsewhere on every keyboard.
_TYPED: Final = {
    "[": Action.SLOWER,
    "]": Action.FASTER,
    "v": Action.NEXT_VIEW,
    "V": Action.LAST_VIEW,
    "r": Action.RESET_CAMERA,
    "R": Action.RESET_CAMERA,
    "h": Action.HELP,
    "H": Action.HELP,
    "?": Action.HELP,
    "o": Action.OVERLAY,
    "O": Action.OVERLAY,
    "s": Action.SCREENSHOT,
    "S": Action.SCREENSHOT,
    "f": Action.FULL_SCREEN,
    "F": Action.FULL_SCREEN,
    "q": Action.QUIT,
    "Q": Action.QUIT,
}
# Those that go on while the key is held.
REPEATED: Final = frozenset({Action.BACK, Action.FORTH, Action.UP, Action.DOWN})

HELP: Final = (
    ("drag", "orbit, or the mouse of an @image"),
    ("right or shift drag", "pan"),
    ("wheel", "zoom"),
    ("R, double click", "reset the camera"),
    ("space", "pause and go on"),
    ("left, right", "step in time (shift: one frame)"),
    ("Home", "back to the start time"),
    ("[  ]", "slower, faster"),
    ("V, shift V", "next view, the one before"),
    ("Tab", "parameters"),
    ("up, down", "choose a parameter"),
    ("left, right", "change it (shift: finely)"),
    ("Backspace", "reset it (shift: all)"),
    ("S", "save a picture"),
    ("F", "full screen"),
    ("O", "hide all this"),
    ("H", "this help"),
    ("Q, Esc", "close"),
)


def action_of_key(key: str) -> Action | None:
    """What a key with a name means; "ArrowLeft", " "."""
    return _NAMED.get(key)


def action_of_character(character: str) -> Action | None:
    """What a typed character means."""
    return _TYPED.get(character)
