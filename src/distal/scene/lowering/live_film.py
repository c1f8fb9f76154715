"""The two programs of a live picture by paths: one adds a pass to a film, one shows the film.

Input: a scene. Output: images; both read the film of the host (``render.live_film``). The host
keeps the film and counts its samples.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.nodes import EntryKind
from distal.ir.types import FRAME, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.scene.lowering.photon_functions import casts_caustics
from distal.scene.lowering.photons import photon_images
from distal.scene.lowering.picture import SceneLowering

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class FilmPass(Composed):
    """A scene's film after some more samples, as an image of plain values."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene, *, caustics: bool = True) -> None:
        """Make the program.

        Args:
            scene: The scene.
            caustics: Whether photons find the caustics, if the scene has any.
        """
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (paths)"
        if caustics and casts_caustics(scene):
            self.photons = photon_images(scene)
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a texel of the film, and return its name."""
        return SceneLowering(assembly, self._scene, paths=True).main(
            "color",
            transparent=False,
            sampled=False,
            encoded=False,
            steered=True,
            paths=True,
            kept=True,
            photons=self.photons is not None,
        )

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


class ShownFilm(Composed):
    """A scene's film, encoded for display."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (film)"
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a display value, and return its name."""
        return SceneLowering(assembly, self._scene).film()

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()
