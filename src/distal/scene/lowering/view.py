"""Views of a scene as images, and the encoding of its light for display.

Input: a scene, the name of a view and how it is shown. Output: functions of a ``Frame``, or of a
color.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.nodes import EntryKind, Param, Read, Return
from distal.ir.types import FRAME, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.scene.lowering.photons import scene_photons
from distal.scene.lowering.picture import RANGED, SceneLowering

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class View(Composed):
    """A view of a scene, as an image."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(
        self,
        scene: Scene,
        view: str,
        transparent: bool,
        sampled: bool,
        encoded: bool,
        steered: bool,
        adaptive: bool,
        paths: bool,
        filter: str,
        photons: bool,
    ) -> None:
        copy_loaded_from(scene, self)
        self.name = scene.name if view == "color" else f"{scene.name} ({view})"
        self._scene = scene
        self._view = view
        self._transparent, self._sampled, self._encoded = transparent, sampled, encoded
        self._steered = steered
        self._passes, self._filter = adaptive, filter
        self.adaptive, self.refined = adaptive and not paths, paths
        if photons:
            self.photons = scene_photons(scene, steered=steered)
        self.display = scene.display if view == "color" and not encoded else None
        self.glow = scene.glow
        self.ranged = view in RANGED

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        return SceneLowering(assembly, self._scene, paths=self.refined).main(
            self._view,
            transparent=self._transparent,
            sampled=self._sampled,
            encoded=self._encoded and self._view == "color",
            steered=self._steered,
            adaptive=self._passes,
            paths=self.refined,
            filter=self._filter,
            photons=self.photons is not None,
        )

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


class DisplayEncoding(Composed):
    """The function that encodes a scene's linear light for display."""

    signature = (("color", VEC4),)
    result = VEC4

    def __init__(self, scene: Scene) -> None:
        self.name = f"display of {scene.name}"
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps a linear color to a display value."""
        made = SceneLowering(assembly, self._scene)
        value = made.displayed(Read("color", VEC4))
        return assembly.define("display_color", (Param("color", VEC4),), VEC4, (Return(value),))
