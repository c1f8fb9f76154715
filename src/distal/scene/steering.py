"""A person's movement of a scene's camera, as five numbers.

Input: gestures, already converted to angles and fractions of the picture. Output: the values of
the uniforms that a steered view reads; ``render/steer.py`` defines their effect.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from distal.ir.types import FLOAT, VEC2, Type
from distal.lang.parameter_values import LARGEST_FLOAT

# The numbers of a steered view: name (without the uniforms' prefix), type, value at rest.
NUMBERS: Final[tuple[tuple[str, Type, Any], ...]] = (
    ("yaw", FLOAT, 0.0),
    ("pitch", FLOAT, 0.0),
    ("zoom", FLOAT, 1.0),
    ("pan", VEC2, (0.0, 0.0)),
)
PREFIX: Final = "View_"
# The five numbers by name, where each stands alone: in messages and on the command line.
NAMES: Final = ("yaw", "pitch", "zoom", "pan_x", "pan_y")

# What the program that guides a camera reads, besides the numbers that the camera has: the numbers
# that a gesture asks for, the action of a key, the size of the picture.
GOAL_PREFIX: Final = "Goal_"
ACTION: Final = "Guide_action"
SIZE: Final = "Guide_size"


@dataclass(frozen=True, slots=True)
class Steering:
    """How far a person has moved a camera; the defaults show the author's own picture.

    Attributes:
        yaw: Angle by which the eye moved around the target, to its own right, in radians.
        pitch: Angle by which the eye moved upwards around the target, in radians.
        zoom: Factor on the distance to the target: 0.5 is twice as near.
        pan: How far the picture was dragged, to the right and up; 1 is half the picture's height.

    Raises:
        ValueError: A number is not finite, or zoom is not above 0.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    zoom: float = 1.0
    pan: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        if not all(abs(n) <= LARGEST_FLOAT for n in self.numbers):
            raise ValueError(f"a camera is moved by finite numbers, not {self!r}")
        if not self.zoom > 0.0:
            raise ValueError(f"zoom is a factor above 0, not {self.zoom:g}")

    @classmethod
    def of(cls, numbers: Mapping[str, float]) -> Steering:
        """Return the steering of numbers by name; those that are not there keep their defaults.

        Args:
            numbers: By the names in ``NAMES``.

        Raises:
            ValueError: There is no such name, or a number is invalid.
        """
        for name in numbers:
            if name not in NAMES:
                known = ", ".join(NAMES)
                raise ValueError(f"a camera is moved by {known}, not by '{name:.40}'")
        given = {**dict(zip(NAMES, STILL.numbers, strict=True)), **numbers}
        yaw, pitch, zoom, pan_x, pan_y = (float(given[name]) for name in NAMES)
        return cls(yaw, pitch, zoom, (pan_x, pan_y))

    @property
    def numbers(self) -> tuple[float, ...]:
        """The five numbers: yaw, pitch, zoom, pan's x and y."""
        return (self.yaw, self.pitch, self.zoom, *self.pan)

    @property
    def settings(self) -> dict[str, Any]:
        """The values of the uniforms, by name."""
        return {f"{PREFIX}{name}": getattr(self, name) for name, _, _ in NUMBERS}


STILL: Final = Steering()
