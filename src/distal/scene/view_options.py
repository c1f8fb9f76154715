"""The options of a scene's picture: each with its default and its check.

Input: values from a caller. Output: a ``ViewOptions``, and the numbers that its programs read.
``distal.lang.render_options`` has the options that all pictures share. Standard library only.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC3
from distal.scene.lowering.layers import checked_layers
from distal.scene.steering import Steering
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse_kind
from distal.scene.tree.source_places import author_place


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewOptions:
    """What is shown of a scene; checked on construction.

    Attributes:
        view: What to show: "color", "coordinate", "signal", "distance", "normal", "depth",
            "steps", "material", "slope" or "slice".
        transparent: Whether alpha is 0 where a ray hits nothing.
        plane: The plane that the view "slice" shows: its normal, of length 1, and its distance from
            the origin along the normal.
        steering: How a person has moved the camera; None if it was not moved.
        layers: Layers to compute at the middle of each pixel for ``Picture.layers``: "depth",
            "normal", "albedo", "material".

    Raises:
        ValueError: A value is out of range, or there is no such layer.
    """

    view: str = "color"
    transparent: bool = False
    plane: tuple[Any, float] = ((0.0, 0.0, 1.0), 0.0)
    steering: Steering | None = None
    layers: Sequence[str] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", checked_layers(self.layers))

    @property
    def steering_settings(self) -> dict[str, Any]:
        """The uniforms of a steered view; empty if the camera was not moved."""
        return {} if self.steering is None else self.steering.settings

    @property
    def slice_settings(self) -> dict[str, Any]:
        """The plane of the view "slice" as settings; empty for other views.

        Raises:
            CompileError: ``plane`` is not a normal and an offset.
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
