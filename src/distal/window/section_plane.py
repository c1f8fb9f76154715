"""The plane by which a person cuts a scene open in a window.

Input: actions of keys, the scene, its parameters and time. Output: a ``CutPlane``, or None while
the scene is whole. Does not depend on displays.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from distal.lang.number_text import shown
from distal.scene.looks.boxes import subject_box
from distal.scene.section import CutPlane
from distal.scene.viewing import interaction, measuring
from distal.scene.viewing.guide import Moment

if TYPE_CHECKING:
    from distal.scene.scene import Scene

_AXES: Final = "xyz"


@dataclass(frozen=True, slots=True)
class SectionPlane:
    """How a scene is cut.

    Attributes:
        axis: The number of the plane's axis, x, y or z; None for a whole scene.
        share: The place of the plane, from 0 to 1 along the box of the scene's finite parts.
        flipped: Whether the lower side is cut away instead of the upper one.
    """

    axis: int | None = None
    share: float = 0.5
    flipped: bool = False

    def turned(self) -> SectionPlane:
        """Return the cut along the next axis; after z the scene is whole."""
        if self.axis is None:
            return SectionPlane(0)
        return SectionPlane(self.axis + 1) if self.axis + 1 < len(_AXES) else SectionPlane()

    def other_side(self) -> SectionPlane:
        """Return the cut of the other side."""
        return self if self.axis is None else replace(self, flipped=not self.flipped)

    def moved(self, steps: int) -> SectionPlane:
        """Return the plane moved by some steps, within the box."""
        if self.axis is None:
            return self
        return replace(
            self, share=interaction.clamped(self.share + steps * measuring.CUT_STEP, 0.0, 1.0)
        )

    def section(self, scene: Scene, moment: Moment) -> CutPlane | None:
        """Return the plane in scene units; None for a whole scene."""
        if self.axis is None:
            return None
        box = subject_box(scene.shape.node, moment.params, moment.time)
        low, high = box.low[self.axis], box.high[self.axis]
        place = measuring.cut_place(low, high, self.share)
        sign = -1.0 if self.flipped else 1.0
        x, y, z = (sign if i == self.axis else 0.0 for i in range(3))
        return CutPlane((x, y, z), sign * place, measuring.cut_lines(2.0 * box.radius))

    def text(self, section: CutPlane) -> str:
        """Return the plane as a person reads it: "section x < 12.5"."""
        assert self.axis is not None
        place = -section.offset if self.flipped else section.offset
        size = max(section.hatch, 1e-9)
        side = ">" if self.flipped else "<"
        return f"section {_AXES[self.axis]} {side} {shown(interaction.rounded(place, size))}"
