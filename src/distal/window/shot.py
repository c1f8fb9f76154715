"""What a frame of a window depends on.

Input: nothing. Output: ``Shot``. Equal shots look the same, so no frame is drawn twice.
"""

from __future__ import annotations

from dataclasses import dataclass

from distal.lang.live_textures import NO_KEYS, Keys
from distal.lang.parameter_values import Value
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.viewing import interaction
from distal.window.gestures import Mouse


@dataclass(frozen=True, slots=True)
class Shot:
    """Everything that a frame depends on, except its size.

    Attributes:
        time: Seconds.
        parameters: Name and value of each parameter that is not at its default.
        view: The name of the view.
        steering: The movement of the camera; None if there is no movable camera.
        mouse: The pointer for an ``@image``.
        mode: How light is computed: "direct" or "path".
        section: The plane that cuts the scene open; None if it is whole.
        keys: The keyboard, for an ``@image`` that reads it.
        buttons: The buttons of the mouse that are down, for an ``@image``.
    """

    time: float
    parameters: tuple[tuple[str, Value], ...]
    view: str
    steering: Steering | None
    mouse: Mouse
    mode: str = "direct"
    section: CutPlane | None = None
    keys: Keys = NO_KEYS
    buttons: int = 0

    @property
    def index(self) -> int:
        """The number of the frame, computed from the time, so that it can be rendered again."""
        return int(interaction.index_at(self.time))
