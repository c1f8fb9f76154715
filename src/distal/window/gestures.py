"""Interpret pointer motion: for a camera, and for an ``@image``'s ``frame.mouse``.

Input: distances as fractions of the picture's height, places as fractions of the picture. Output:
the five numbers of a ``Steering``, or Shadertoy's four of the mouse. Does not depend on cameras:
scene code interprets the numbers; ``scene/viewing/interaction.py`` defines their scale.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from distal.scene.steering import Steering
from distal.scene.viewing import interaction


def orbited(steering: Steering, right: float, down: float, elevation: float = 0.0) -> Steering:
    """Return the steering after the scene was turned by a drag.

    Args:
        steering: The steering before.
        right: Distance to the right, as a fraction of the picture's height.
        down: Distance downwards, likewise.
        elevation: The elevation of the author's camera, in radians.
    """
    return replace(
        steering,
        yaw=interaction.turned(steering.yaw, right),
        pitch=interaction.raised(steering.pitch, down, elevation),
    )


def panned(steering: Steering, right: float, down: float) -> Steering:
    """Return the steering after the scene was dragged sideways by the distance of the pointer.

    Args:
        steering: The steering before.
        right: Distance to the right, as a fraction of the picture's height.
        down: Distance downwards, likewise.
    """
    x, y = steering.pan
    return replace(steering, pan=(interaction.dragged(x, right), interaction.dragged(y, -down)))


def zoomed(steering: Steering, notches: float) -> Steering:
    """Return the steering after turning the wheel; positive notches move the eye away."""
    return replace(steering, zoom=interaction.notched(steering.zoom, notches))


@dataclass(frozen=True, slots=True)
class Mouse:
    """The pointer for an ``@image``, in fractions of the window from its lower left.

    Attributes:
        at: The last place while the button was down.
        pressed: The place where the button was pressed.
        down: Whether the button is down.
        fresh: Whether it was pressed since the last frame.
    """

    at: tuple[float, float] = (0.0, 0.0)
    pressed: tuple[float, float] = (0.0, 0.0)
    down: bool = False
    fresh: bool = False

    def nudged(self, right: float, up: float) -> Mouse:
        """Return a click beside the last place, for use by the keyboard."""
        place = on_picture(self.at[0] + right, self.at[1] + up)
        return Mouse(place, place, down=False, fresh=True)

    def pixels(self, size: tuple[int, int]) -> tuple[float, float, float, float]:
        """Return Shadertoy's four numbers: the place, and where the button was pressed.

        The third number is positive while the button is down, else negative; the fourth is positive
        only in the first frame of a press.
        """
        width, height = size
        x, y = self.pressed[0] * width, self.pressed[1] * height
        return (
            self.at[0] * width,
            self.at[1] * height,
            x if self.down else -x,
            y if self.fresh else -y,
        )


def on_picture(x: float, y: float) -> tuple[float, float]:
    """Return the nearest place on the picture."""
    return interaction.clamped(x, 0.0, 1.0), interaction.clamped(y, 0.0, 1.0)
