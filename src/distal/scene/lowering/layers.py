"""Layers of a scene's picture besides color: depth, normal, albedo, material, and of its samples.

Input: a scene and names of layers. Output: arrays, computed by programs of the library's scene
code. Needs NumPy only to render layers.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, ClassVar, Final

from distal.frontend import Assembly
from distal.ir.nodes import EntryKind
from distal.ir.types import FRAME, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.render.layers import LAYERS
from distal.scene.lowering.picture import SceneLowering

if TYPE_CHECKING:
    from distal.scene.scene import Scene

# What a picture in mode "path" knows of its samples, not of the scene.
OF_SAMPLES: Final = ("samples", "variance")
NAMES: Final = (*LAYERS, *OF_SAMPLES)


class Layer(Composed):
    """One layer of a scene, as an image of plain values."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene, layer: str, *, steered: bool) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (layer {layer})"
        self._scene, self._layer, self._steered = scene, layer, steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to the layer's values, and return its name."""
        return SceneLowering(assembly, self._scene).layer(self._layer, steered=self._steered)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


class PathLayer(Composed):
    """One layer of a scene as the mean over samples, which follow mirrors and clear glass."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4
    refined = True

    def __init__(self, scene: Scene, layer: str, filter: str, *, steered: bool) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (layer {layer})"
        self._scene, self._layer, self._filter = scene, layer, filter
        self._steered = steered

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to the layer's values, and return its name."""
        made = SceneLowering(assembly, self._scene, paths=True)
        return made.path_layer(self._layer, self._filter, steered=self._steered)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


def checked_layers(names: Any) -> tuple[str, ...]:
    """Return the names of layers, each once, in the order of ``NAMES``.

    Raises:
        ValueError: There is no such layer.
    """
    wanted = (names,) if isinstance(names, str) else tuple(names)
    for name in wanted:
        if name not in NAMES:
            raise ValueError(f"there is no layer {name!r:.40}; layers: {', '.join(NAMES)}")
    return tuple(name for name in NAMES if name in wanted)


def values(name: str, pixels: Any) -> Any:
    """Return a layer's values from pixels whose alpha is 1 where a ray hit something.

    Returns:
        (height, width) or (height, width, 3), as ``Picture.layers`` has them.
    """
    import numpy as np  # noqa: PLC0415 (scenes compile without it)

    if name == "depth":
        # Infinity: in a merge with another picture, the nearer surface is chosen.
        return np.where(pixels[..., 3] > 0.5, pixels[..., 0], np.float32(np.inf))
    if name == "material":
        return np.rint(pixels[..., 0]).astype(np.uint32)
    return np.ascontiguousarray(pixels[..., :3])
