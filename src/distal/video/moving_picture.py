"""A picture as a function of time, and what its frames depend on.

Input: anything that is a picture, a view, parameters. Output: pictures by their
number and time, and a fingerprint: moving pictures of one fingerprint have the same frames. Knows
no file.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from distal.images.picture import Picture
from distal.ir.nodes import Origin
from distal.lang.chosen_values import checked_values
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime.lowered import Lowered
from distal.scene.checks.warnings import check_slopes, warn_of_black, warn_of_functions
from distal.scene.view_options import checked_samples
from distal.scene.viewing.viewable import COLOR, Viewable, viewable
from distal.version import __version__
from distal.video.formats import VideoError

if TYPE_CHECKING:
    from distal.lang.composed import Composed
    from distal.lang.functions import Image
    from distal.scene.scene import Scene


@dataclass(frozen=True, slots=True)
class MovingPicture:
    """A picture as a function of time.

    Attributes:
        name: What the author calls it.
        options: How each frame is rendered; time and index are those of the first.
        fingerprint: Equal for moving pictures with the same frames.
        source_hash: Hash of the text of the files that contain its scene code.
    """

    name: str
    options: RenderOptions
    fingerprint: str
    source_hash: str
    _image: Image | Composed = field(repr=False)
    _scene: Scene | None = field(repr=False)
    _view: str = COLOR

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self.options.size

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The value of each parameter that it reads, by name."""
        return self.options.params

    def picture(self, index: int, time: float, size: tuple[int, int] | None = None) -> Picture:
        """The picture of a time.

        Args:
            index: The frame's number.
            time: Seconds.
            size: Width and height in pixels; its own without it.
        """
        options = replace(self.options, size=size or self.size, time=time, index=index)
        return (
            executor()
            .render(self._image, options)
            .with_provenance(
                view=self._view,
                samples=options.settings.get("Samples", 1),
                stage=None if self._scene is None else self._scene.staged,
            )
        )

    def warn_if_black(self, picture: Picture, time: float) -> None:
        """Warn of a first picture that shows nothing, as a still would."""
        if self._scene is not None and self._view == COLOR:
            warn_of_black(self._scene, picture, self.parameters, time)


def moving_picture(obj: Any, options: RenderOptions, view: str, samples: int) -> MovingPicture:
    """The moving picture that an object shows.

    Args:
        obj: A scene, a shape or an ``@image``.
        options: How each frame is rendered. The stage of a lone shape is as large as the shape is
            at this time and for these parameters.
        view: One of its views.
        samples: Rays for each pixel of a scene.

    Raises:
        LoadError: It is no picture.
        VideoError: There is no such view or parameter, or no such number of samples.
    """
    shown = viewable(obj, options.params, options.time)
    image, settings = _image(shown, view, samples)
    lowered = Lowered.of(image, None)
    values = _values(shown, lowered, options.params)
    if shown.scene is not None:
        check_slopes(shown.scene.shape, values, options.time)
        warn_of_functions(shown.scene.shape, values, options.time)
    return MovingPicture(
        name=shown.name,
        options=replace(options, params=values, settings=settings),
        fingerprint=_fingerprint(lowered, settings),
        source_hash=lowered.source_hash,
        _image=image,
        _scene=shown.scene,
        _view=view,
    )


def _image(shown: Viewable, view: str, samples: int) -> tuple[Image | Composed, dict[str, Any]]:
    """One program that gives display values: a second pass over each frame costs more."""
    try:
        if checked_samples(samples) > 1 and shown.scene is None:
            raise VideoError(f"samples are for scenes and shapes; '{shown.name}' is an @image")
        if samples == 1 or shown.scene is None:
            return shown.image(view, encoded=True), {}
        return shown.scene.view(view, sampled=True, encoded=True), {"Samples": samples}
    except ValueError as error:
        raise VideoError(str(error)) from None


def _values(shown: Viewable, lowered: Lowered, params: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters that the view reads; one that only another view reads may be given too."""
    read = {
        u.source.name: u.source
        for u in lowered.module.uniforms
        if u.origin is Origin.PARAMETER and u.source is not None
    }
    try:
        chosen = checked_values(shown.parameters, params)
    except (ValueError, TypeError) as error:
        raise VideoError(str(error)) from None
    return {name: chosen.get(name, parameter.default) for name, parameter in read.items()}


def _fingerprint(lowered: Lowered, settings: Mapping[str, Any]) -> str:
    numbers = {u.name: u.default for u in lowered.module.uniforms if u.origin is Origin.NUMBER}
    parts = [__version__, lowered.digest, numbers, dict(settings)]
    digest = hashlib.sha256(json.dumps(parts, sort_keys=True, default=repr).encode())
    for name, source in sorted(lowered.resources.items()):
        digest.update(f"\0{name}\0".encode())
        digest.update(_bytes(getattr(source, "data", source)))
    return digest.hexdigest()


def _bytes(data: Any) -> bytes:
    """What a texture or a buffer holds; of a file its content."""
    if isinstance(data, str | Path):
        try:
            return Path(data).read_bytes()
        except OSError:  # rendering reports what is wrong with it
            return str(data).encode()
    try:
        array = np.asarray(data)
    except ValueError:
        return repr(data).encode()
    if array.dtype == object:
        return repr(data).encode()
    return f"{array.dtype}{array.shape}".encode() + array.tobytes()
