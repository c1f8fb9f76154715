"""A scene's picture, computed: which programs, with which numbers, and what is doubtful about it.

Input: a scene, and what its author asked to see. Output: a ``Picture`` with its
layers, which says how it was made. Needs NumPy; scenes compile without this module.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from distal.lang.runtime_hook import executor
from distal.scene.checks import warnings as doubts
from distal.scene.lowering.layers import checked_layers, values
from distal.scene.scene_arguments import checked_samples, slice_settings
from distal.scene.steering import Steering
from distal.scene.tree.errors import refuse

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class Wish:
    """What is to be seen; the fields are arguments of ``Scene.render``."""

    samples: int
    view: str
    transparent: bool
    plane: tuple[Any, float]
    steering: Steering | None
    layers: Sequence[str]


def rendered(
    scene: Scene, wish: Wish, progress: Callable[[float], Any] | None, **options: Any
) -> Picture:
    """The picture of a scene.

    Args:
        scene: The scene.
        wish: What is to be seen.
        progress: Called with the finished share.
        options: Those of ``executor().render``: size, time, params and the like.
    """
    samples, view = checked_samples(wish.samples), wish.view
    layers = checked_layers(wish.layers)
    steered = wish.steering is not None
    moved = {} if wish.steering is None else wish.steering.settings
    sliced = slice_settings(wish.plane) if view == "slice" else {}
    sampled = {"Samples": samples} if samples > 1 else {}
    params, time = options["params"] or {}, options["time"]
    doubts.check_slopes(scene.shape, params, time)
    doubts.doubt_functions(scene.shape, params, time)
    shares = _parts_of(progress, 1 + len(layers))
    image = scene.view(view, transparent=wish.transparent, sampled=samples > 1, steered=steered)
    settings = {**sampled, **sliced, **moved}
    picture: Picture = executor().render(image, settings=settings, progress=shares[0], **options)
    if view == "color" and not wish.transparent and not doubts.shows(picture.array[..., 3]):
        message = f"the camera is inside '{scene.shape.name}', and no ray finds a way out"
        refuse(message, "move the camera, or look at the shape with view='slice'", scene.place)
    if view == "color":
        doubts.doubt_black(scene, picture, params, time)
    found = {}
    for name, share in zip(layers, shares[1:], strict=True):
        layer = scene.layer(name, steered=steered)
        pixels = executor().render(layer, settings=moved, progress=share, **options).array
        found[name] = values(name, pixels)
    return picture.with_layers(found).told(
        samples=samples,
        view=view,
        transparent=wish.transparent,
        plane=tuple(sliced.values()) or None,
        steering=None if wish.steering is None else wish.steering.numbers,
        stage=scene.staged,
        layers=layers,
        **scene.asked_display,
    )


def _parts_of(
    progress: Callable[[float], Any] | None, count: int
) -> list[Callable[[float], Any] | None]:
    """What is told of each of several parts of the work, which are taken for equal."""
    if progress is None:
        return [None] * count
    whole = progress

    def part(done: int) -> Callable[[float], Any]:
        return lambda share: whole((done + share) / count)

    return [part(done) for done in range(count)]
