"""What the pointer's motion means: for a camera, and for an ``@image``'s ``frame.mouse``.

What flows in: distances in the window, in its own units, y down. What flows out: five numbers of a
``Steering``, or Shadertoy's four of the mouse. Knows no camera: what the numbers do is scene code.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

from distal.scene.steering import Steering

# A drag over the window's height turns half around: the far side comes within one drag.
_TURN: Final = math.pi
# At the poles "right" has no direction; so near them nothing is seen to be missing.
_NEAREST_POLE: Final = math.pi / 2 - 0.02
_ZOOM_STEP: Final = 1.15
_ZOOM_RANGE: Final = (1 / 64, 64.0)
_FARTHEST_PAN: Final = 1000.0


def orbited(
    steering: Steering, dx: float, dy: float, height: float, elevation: float = 0.0
) -> Steering:
    """The scene turned under the hand: what is grabbed follows the pointer.

    ``elevation`` is the camera's own: with it the eye stays between the poles. A camera that
    starts beyond them goes no further.
    """
    yaw = math.remainder(steering.yaw - dx / height * _TURN, math.tau)
    low = min(-_NEAREST_POLE - elevation, 0.0)
    high = max(_NEAREST_POLE - elevation, 0.0)
    pitch = min(max(steering.pitch + dy / height * _TURN, low), high)
    return replace(steering, yaw=yaw, pitch=pitch)


def panned(steering: Steering, dx: float, dy: float, height: float) -> Steering:
    """The scene dragged sideways by as much as the pointer: 1 is half the window's height."""
    x, y = steering.pan[0] + 2 * dx / height, steering.pan[1] - 2 * dy / height
    return replace(steering, pan=(_limited(x), _limited(y)))


def zoomed(steering: Steering, notches: float) -> Steering:
    """The eye farther away by so many notches of a wheel; nearer where they are negative."""
    # A touch pad's burst may carry hundreds: the exponent is bounded before it overflows.
    factor = _ZOOM_STEP ** min(max(notches, -100.0), 100.0)
    low, high = _ZOOM_RANGE
    return replace(steering, zoom=min(max(steering.zoom * factor, low), high))


def _limited(value: float) -> float:
    return min(max(value, -_FARTHEST_PAN), _FARTHEST_PAN)


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
