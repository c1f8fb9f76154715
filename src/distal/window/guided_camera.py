"""The camera of a window: moved by gestures and keys, kept out of solids.

Input: goals of gestures, actions of keys, the moment in which they happen. Output: a ``Steering``,
and the place of the camera. Does not depend on displays.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Final

from distal.scene.steering import STILL, Steering
from distal.scene.viewing.guide import Moment, Place
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
        self._place: tuple[Steering, Moment, Place] | None = None

    def adopt(self, viewable: Viewable) -> None:
        """Continue with another object at the same place, if it has a camera."""
        self._viewable, self._place = viewable, None
        if not viewable.steers:
            self.steering = STILL

    def go(self, goal: Steering, moment: Moment) -> None:
        """Move to a goal, or as far as no solid is entered."""
        guide = self._guide
        self.steering = goal if guide is None else guide.go(self.steering, goal, moment)

    def show(self, action: Action, moment: Moment) -> None:
        """Show the whole scene, for one of the actions of ``SHOWN``."""
        if self._guide is not None:
            self.steering = self._guide.show(SHOWN[action], self.steering, moment)

    def prepare(self, moment: Moment) -> None:
        """Start to compile the guide, in a thread of its own; a gesture waits for the result."""
        guide = self._guide
        if guide is not None:
            # A daemon, because a compiler cannot be interrupted.
            threading.Thread(target=guide.prepare, args=(moment,), daemon=True).start()

    def text(self, moment: Moment) -> str:
        """Return the camera at its place as Python; "" without a guide."""
        place = self.place(moment)
        return self._guide.text(place) if place is not None and self._guide is not None else ""

    def place(self, moment: Moment) -> Place | None:
        """Return where the camera is; None without a guide."""
        if self._guide is None:
            return None
        if self._place is None or self._place[:2] != (self.steering, moment):
            found = self._guide.place(self.steering, moment)
            self._place = (self.steering, moment, found)
        return self._place[2]

    def known_place(self, moment: Moment) -> Place | None:
        """Return where the camera is, without waiting for a compilation."""
        guide = self._guide
        return self.place(moment) if guide is not None and guide.is_ready else None

    @property
    def _guide(self) -> Guide | None:
        return self._viewable.guide if self.is_guided else None
