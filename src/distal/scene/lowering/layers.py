"""A scene's layers: depth, normal, albedo and material beside its color.

Input: a scene and names. Output: arrays, made by programs of the library's scene
code. Needs NumPy only when layers are rendered.
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

NAMES: Final = tuple(LAYERS)


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
        """The layer, as a function of the frame."""
        return SceneLowering(assembly, self._scene).layer(self._layer, steered=self._steered)

    def functions(self) -> Iterable[Func]:
        """The functions that it is made of."""
        return self._scene.functions()


def checked_layers(names: Any) -> tuple[str, ...]:
    """Names of layers, each once, in the order of ``NAMES``.

    Raises:
        ValueError: There is no such layer.
    """
    wanted = (names,) if isinstance(names, str) else tuple(names)
    for name in wanted:
        if name not in NAMES:
            raise ValueError(f"there is no layer {name!r:.40}; layers: {', '.join(NAMES)}")
    return tuple(name for name in NAMES if name in wanted)


def values(name: str, pixels: Any) -> Any:
    """A layer's values, of pixels whose alpha says whether anything was met.

    Returns:
        (height, width) or (height, width, 3), as ``Picture.layers`` has them.
    """
    import numpy as np  # noqa: PLC0415 (scenes compile without it)

    if name == "depth":
        # Farther than all else: nearer wins, whatever is merged with it.
        return np.where(pixels[..., 3] > 0.5, pixels[..., 0], np.float32(np.inf))
    if name == "material":
        return np.rint(pixels[..., 0]).astype(np.uint32)
    return np.ascontiguousarray(pixels[..., :3])
