"""The events of a canvas: keys, characters and the pointer.

Input: events of a canvas. Output: calls of the session and of the window, which is updated after
each of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any, Final, Protocol

from distal.scene.viewing import interaction
from distal.window.keys import (
    BUTTON_BITS,
    REPEATED,
    Action,
    action_of_character,
    action_of_key,
    code_of_key,
)
from distal.window.session import Session

_REPEAT_AFTER_S: Final = 0.35
_REPEAT_S: Final = 1 / 15


class InputTarget(Protocol):
    """What events of a canvas act on, besides the session."""

    def act(self, action: Action, *, shift: bool = False) -> None:
        """Perform the action of a key."""

    def resize(self) -> None:
        """Take the new size of the canvas."""

    def wake(self) -> None:
        """Update everything once."""


class CanvasInput:
    """The handlers of a canvas's events.

    Args:
        session: The state that they change.
        canvas: The canvas.
        loop: The event loop, for keys that repeat.
        target: The window.
    """

    def __init__(self, session: Session, canvas: Any, loop: Any, target: InputTarget) -> None:
        self._session, self._canvas, self._loop, self._target = session, canvas, loop, target
        self._held: Action | None = None
        handlers: Mapping[str, Callable[[dict[str, Any]], None]] = {
            "key_down": self._key_down,
            "key_up": self._key_up,
            "char": self._typed,
            "pointer_down": self._pressed,
            "pointer_move": self._moved,
            "pointer_up": self._released,
            "double_click": self._double_clicked,
            "wheel": self._wheeled,
            "resize": lambda _: target.resize(),
        }
        for event, handler in handlers.items():
            canvas.add_event_handler(handler, event)

    def _key_down(self, event: dict[str, Any]) -> None:
        shift = "Shift" in event["modifiers"]
        modified = shift or "Control" in event["modifiers"]
        if self._takes_key(event, down=True):
            return
        action = action_of_key(event["key"], modified=modified)
        if action is None:
            return
        if action is Action.QUIT and self._session.ruler.is_on:
            action = Action.RULER  # Esc removes the ruler first
        self._target.act(action, shift=shift)
        if action in REPEATED:
            self._held = action
            self._loop.call_later(_REPEAT_AFTER_S, self._repeat, action, shift)

    def _takes_key(self, event: dict[str, Any], *, down: bool) -> bool:
        """Give a key to a picture that reads the keyboard; return whether it is taken."""
        if not self._session.viewable.reads_keyboard:
            return False
        modified = not {"Control", "Alt", "Meta"}.isdisjoint(event["modifiers"])
        code = code_of_key(event["key"], modified=modified)
        if code is not None:
            self._session.key_changed(code, down=down)
            self._target.wake()
        return code is not None

    def _key_up(self, event: dict[str, Any]) -> None:
        if self._takes_key(event, down=False):
            return
        if action_of_key(event["key"]) is self._held:
            self._held = None

    def _repeat(self, action: Action, shift: bool) -> None:
        if self._held is action and not self._canvas.get_closed():
            self._target.act(action, shift=shift)
            self._loop.call_later(_REPEAT_S, self._repeat, action, shift)

    def _typed(self, event: dict[str, Any]) -> None:
        if self._session.viewable.reads_keyboard:
            return
        action = action_of_character(event["data"])
        if action is not None:
            self._target.act(action)

    def _pressed(self, event: dict[str, Any]) -> None:
        shift = "Shift" in event["modifiers"]
        x, y, button = event["x"], event["y"], event["button"]
        self._session.buttons |= BUTTON_BITS.get(button, 0)
        self._session.press(x, y, button, time.monotonic(), shift=shift)
        self._target.wake()

    def _moved(self, event: dict[str, Any]) -> None:
        self._session.drag(event["x"], event["y"], time.monotonic())
        self._target.wake()

    def _released(self, event: dict[str, Any]) -> None:
        self._session.buttons &= ~BUTTON_BITS.get(event.get("button", 1), 0)
        self._session.release(time.monotonic())
        self._target.wake()

    def _double_clicked(self, event: dict[str, Any]) -> None:
        self._session.double_click(event["x"], event["y"], time.monotonic())
        self._target.wake()

    def _wheeled(self, event: dict[str, Any]) -> None:
        is_pinch = "Control" in event["modifiers"]
        notches = interaction.notches_of(event["dy"], 0, is_pinch)  # dy is in pixels
        self._session.wheel(notches, time.monotonic())
        self._target.wake()
