"""What the pointer's motion means: for a camera, and for an ``@image``'s ``frame.mouse``.

Input: distances in parts of the picture's height, places in parts of the picture. Output:
five numbers of a ``Steering``, or Shadertoy's four of the mouse. Knows no camera: what
the numbers do is scene code; ``scene/viewing/interaction.py`` says how far a hand moves them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from distal.scene.steering import Steering
from distal.scene.viewing import interaction


def orbited(steering: Steering, right: float, down: float, elevation: float = 0.0) -> Steering:
    """The scene turned under the hand; ``elevation`` is the camera's own."""
    return replace(
        steering,
        yaw=interaction.turned(steering.yaw, right),
        pitch=interaction.raised(steering.pitch, down, elevation),
    )


def panned(steering: Steering, right: float, down: float) -> Steering:
    """The scene dragged sideways by as much as the pointer."""
    x, y = steering.pan
    return replace(steering, pan=(interaction.dragged(x, right), interaction.dragged(y, -down)))


def zoomed(steering: Steering, notches: float) -> Steering:
    """The eye farther away by so many notches of a wheel; nearer where they are negative."""
    return replace(steering, zoom=interaction.notched(steering.zoom, notches))


@dataclass(frozen=True, slots=True)
class Mouse:
    """The pointer as an ``@image`` sees it, in shares of the window from its lower left.

    Attributes:
        at: Where it was last while the button was down.
        pressed: Where the button went down.
        down: Whether it is down.
        fresh: Whether it went down since the last frame.
    """

    at: tuple[float, float] = (0.0, 0.0)
    pressed: tuple[float, float] = (0.0, 0.0)
    down: bool = False
    fresh: bool = False

    def nudged(self, right: float, up: float) -> Mouse:
        """For the keyboard: a press and release beside where it was."""
        place = on_picture(self.at[0] + right, self.at[1] + up)
        return Mouse(place, place, down=False, fresh=True)

    def pixels(self, size: tuple[int, int]) -> tuple[float, float, float, float]:
        """Shadertoy's four: the place, and where it was pressed, negative once that is over.

        The third number is positive while the button is down, the fourth only in the first frame.
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
    """The nearest place on the picture."""
    return interaction.clamped(x, 0.0, 1.0), interaction.clamped(y, 0.0, 1.0)
