"""The camera of a window: moved by gestures and keys, kept out of solids.

Input: goals of gestures, actions of keys, the moment in which they happen. Output: a ``Steering``,
and the place of the camera. Does not depend on displays.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from distal.diagnostics import CompileError, DeviceError
from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import CameraPlace, Moment
from distal.window.keys import Action

if TYPE_CHECKING:
    from distal.scene.viewing.guide import Guide
    from distal.scene.viewing.viewable import Viewable

# The keys that show the whole scene, by the names of ``Guide.show``.
SHOWN: Final = {
    Action.FRAME: "frame",
    Action.FRONT: "front",
    Action.BACK_SIDE: "back",
    Action.RIGHT_SIDE: "right",
    Action.LEFT_SIDE: "left",
    Action.TOP: "top",
    Action.BOTTOM: "bottom",
}


class GuidedCamera:
    """The movement of a camera.

    Attributes:
        steering: The movement; set it to move the camera anywhere.
        is_guided: Whether solids stop the camera, and keys show the whole scene.
    """

    def __init__(self, viewable: Viewable, *, is_guided: bool) -> None:
        self.steering = STILL
        self.is_guided = is_guided
        self._viewable = viewable
        self._place: tuple[Steering, Moment, CameraPlace] | None = None
        # What gestures asked for before the guide was compiled.
        self._waiting: Steering | Action | None = None
        self._thread: threading.Thread | None = None

    def adopt(self, viewable: Viewable) -> None:
        """Continue with another object at the same place, if it has a camera."""
        self._viewable, self._place, self._waiting = viewable, None, None
        if not viewable.steers:
            self.steering = STILL

    @property
    def aim(self) -> Steering:
        """Where gestures have asked the camera to go."""
        return self._waiting if isinstance(self._waiting, Steering) else self.steering

    def go(self, goal: Steering, moment: Moment) -> None:
        """Move to a goal, or as far as no solid is entered."""
        self._waiting = goal
        self.settle(moment)

    def show(self, action: Action, moment: Moment) -> None:
        """Show the whole scene, for one of the actions of ``SHOWN``."""
        self._waiting = action
        self.settle(moment)

    def reset(self) -> None:
        """Return to the author's camera."""
        self.steering, self._waiting = STILL, None

    def settle(self, moment: Moment) -> None:
        """Do what gestures have asked for, unless the guide is still being compiled."""
        guide, waiting = self._guide, self._waiting
        if waiting is None or (guide is not None and not guide.is_ready):
            return
        self._waiting = None
        if isinstance(waiting, Steering):
            self.steering = waiting if guide is None else guide.go(self.steering, waiting, moment)
        elif guide is not None:
            self.steering = guide.show(SHOWN[waiting], self.steering, moment)

    def prepare(self, moment: Moment, then: Callable[[], None]) -> None:
        """Compile the guide in a thread of its own; until then, the camera waits.

        Args:
            moment: What the camera's surroundings depend on.
            then: Called in that thread when it is done.
        """
        guide = self._guide
        if guide is None:
            return

        def work() -> None:
            try:
                guide.prepare(moment)
            except (CompileError, DeviceError):
                self.is_guided = False  # a camera that moves freely is better than none
            then()

        # A daemon, because a compiler cannot be interrupted.
        self._thread = threading.Thread(target=work, name="distal-guide", daemon=True)
        self._thread.start()

    @property
    def is_preparing(self) -> bool:
        """Whether the guide is being compiled."""
        return self._thread is not None and self._thread.is_alive()

    def text(self, moment: Moment) -> str:
        """Return the camera at its place as Python; "" without a guide."""
        place = self.place(moment)
        return self._guide.text(place) if place is not None and self._guide is not None else ""

    def place(self, moment: Moment) -> CameraPlace | None:
        """Return where the camera is; None without a guide."""
        if self._guide is None:
            return None
        if self._place is None or self._place[:2] != (self.steering, moment):
            found = self._guide.place(self.steering, moment)
            self._place = (self.steering, moment, found)
        return self._place[2]

    def known_place(self, moment: Moment) -> CameraPlace | None:
        """Return where the camera is, without waiting for a compilation."""
        guide = self._guide
        return self.place(moment) if guide is not None and guide.is_ready else None

    @property
    def _guide(self) -> Guide | None:
        return self._viewable.guide if self.is_guided else None
