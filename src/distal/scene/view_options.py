"""What a picture of a scene shows: each option with its default, its check and its meaning.

Input: values from a caller. Output: a ``ViewOptions``, and the numbers that its programs read.
``distal.lang.render_options`` has the options that every picture takes. Standard library only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC3
from distal.scene.lowering.layers import checked_layers
from distal.scene.steering import Steering
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.source_places import author_place

MOST_SAMPLES: Final = 65536


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewOptions:
    """What is shown of a scene, checked when it is made.

    Attributes:
        samples: Rays for each pixel.
        view: What to show: "color", "coordinate", "signal", "distance", "normal", "depth",
            "steps", "material", "slope" or "slice".
        transparent: Whether alpha is 0 where nothing is met.
        plane: What "slice" shows: the plane's normal, of length 1, and its distance from the
            origin along it.
        steering: How the camera is moved by hand; None: not.
        layers: What else to compute of each pixel's middle, for ``Picture.layers``: "depth",
            "normal", "albedo", "material".

    Raises:
        ValueError: A value is out of range, or there is no such layer.
    """

    samples: int = 1
    view: str = "color"
    transparent: bool = False
    plane: tuple[Any, float] = ((0.0, 0.0, 1.0), 0.0)
    steering: Steering | None = None
    layers: Sequence[str] = ()

    def __post_init__(self) -> None:
        checked_samples(self.samples)
        object.__setattr__(self, "layers", checked_layers(self.layers))

    @property
    def steering_settings(self) -> dict[str, Any]:
        """The values of a steered program's numbers; empty where the camera is not moved."""
        return {} if self.steering is None else self.steering.settings

    @property
    def slice_settings(self) -> dict[str, Any]:
        """The plane of the view "slice" as settings; empty for other views.

        Raises:
            CompileError: It is no plane.
        """
        if self.view != "slice":
            return {}
        place = author_place()
        try:
            normal, offset = self.plane
        except (TypeError, ValueError):
            hint = "plane=((0, 0, 1), 0.5)"
            refuse_kind(f"a plane is a normal and an offset, not {self.plane!r:.60}", hint, place)
        direction = number(normal, Asked("normal", "slice", VEC3, Limit.UNIT, place=place))
        distance = number(offset, Asked("offset", "slice", FLOAT, place=place))
        return {"Slice_normal": direction.plain, "Slice_offset": distance.plain}

    @property
    def sample_settings(self) -> dict[str, Any]:
        """The number of rays as a setting; empty where a pixel has one ray."""
        return {"Samples": self.samples} if self.samples > 1 else {}


def checked_samples(samples: object) -> int:
    """Rays for each pixel.

    Raises:
        ValueError: It is no such number.
    """
    if not isinstance(samples, int) or not 1 <= samples <= MOST_SAMPLES:
        raise ValueError(f"a pixel has 1 to {MOST_SAMPLES} samples, not {samples!r}")
    return samples
