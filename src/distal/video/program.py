"""What is rendered again and again, and what its pictures depend on.

Input: anything that is a picture, a view, parameters. Output: pictures by their
number and time, and a fingerprint: two programs of one fingerprint make the same pictures. Knows no
file.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from distal.images.picture import Picture
from distal.ir.nodes import Origin
from distal.lang.chosen_values import checked_values
from distal.lang.runtime_hook import executor
from distal.runtime.lowered import Lowered
from distal.scene.checks.warnings import check_slopes, doubt_black, doubt_functions
from distal.scene.scene_arguments import checked_samples
from distal.scene.viewing.viewable import COLOR, Viewable, viewable
from distal.version import __version__
from distal.video.formats import WishError


@dataclass(frozen=True, slots=True)
class Program:
    """A picture as a function of time.

    Attributes:
        name: What the author calls it.
        size: Width and height in pixels.
        parameters: The value of each parameter that it reads, by name.
        fingerprint: Equal for programs that make the same pictures.
        source_hash: Hash of the text of the files that its scene code stands in.
    """

    name: str
    size: tuple[int, int]
    parameters: Mapping[str, Any]
    fingerprint: str
    source_hash: str
    _image: Any = field(repr=False)
    _scene: Any = field(repr=False)
    _options: Mapping[str, Any] = field(repr=False)
    _view: str = COLOR

    def picture(self, index: int, time: float, size: tuple[int, int] | None = None) -> Picture:
        """The picture of a time; ``index`` is the frame's number."""
        made: Picture = executor().render(
            self._image,
            size=size or self.size,
            time=time,
            index=index,
            params=self.parameters,
            **self._options,
        )
        return made.told(
            view=self._view,
            samples=self._options["settings"].get("Samples", 1),
            stage=None if self._scene is None else self._scene.staged,
        )

    def doubt(self, picture: Picture, time: float) -> None:
        """Warn of a first picture that shows nothing, as a still would."""
        if self._scene is not None and self._view == COLOR:
            doubt_black(self._scene, picture, self.parameters, time)


def program(
    obj: Any,
    size: tuple[int, int],
    time: float,
    params: Mapping[str, Any],
    view: str,
    samples: int,
    options: Mapping[str, Any],
) -> Program:
    """What renders an object.

    Args:
        obj: A scene, a shape or an ``@image``.
        size: Width and height in pixels.
        time: Seconds; where a lone shape's stage is as large as the shape is then.
        params: Values of parameters by name.
        view: One of its views.
        samples: Rays for each pixel of a scene.
        options: What the executor is told besides: device, threads, cancel.

    Raises:
        LoadError: It is no picture.
        WishError: There is no such view or parameter, or no such number of samples.
    """
    shown = viewable(obj, params, time)
    image, settings = _image(shown, view, samples)
    lowered = Lowered.of(image, None)
    values = _values(shown, lowered, params)
    if shown.scene is not None:
        check_slopes(shown.scene.shape, values, time)
        doubt_functions(shown.scene.shape, values, time)
    return Program(
        name=shown.name,
        size=size,
        parameters=values,
        fingerprint=_fingerprint(lowered, settings),
        source_hash=lowered.source_hash,
        _image=image,
        _scene=shown.scene,
        _options={**options, "settings": settings},
        _view=view,
    )


def _image(shown: Viewable, view: str, samples: int) -> tuple[Any, dict[str, Any]]:
    """One program that gives display values: a second pass over each frame costs more."""
    try:
        if checked_samples(samples) > 1 and shown.scene is None:
            raise WishError(f"samples are for scenes and shapes; '{shown.name}' is an @image")
        if samples == 1 or shown.scene is None:
            return shown.image(view, encoded=True), {}
        return shown.scene.view(view, sampled=True, encoded=True), {"Samples": samples}
    except ValueError as error:
        raise WishError(str(error)) from None


def _values(shown: Viewable, lowered: Lowered, params: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters that the view reads; one that only another view reads is no mistake."""
    read = {
        u.source.name: u.source
        for u in lowered.module.uniforms
        if u.origin is Origin.PARAMETER and u.source is not None
    }
    try:
        chosen = checked_values(shown.parameters, params)
    except (ValueError, TypeError) as error:
        raise WishError(str(error)) from None
    return {name: chosen.get(name, parameter.default) for name, parameter in read.items()}


def _fingerprint(lowered: Lowered, settings: Mapping[str, Any]) -> str:
    numbers = {u.name: u.default for u in lowered.module.uniforms if u.origin is Origin.NUMBER}
    told = [__version__, lowered.digest, numbers, dict(settings)]
    digest = hashlib.sha256(json.dumps(told, sort_keys=True, default=repr).encode())
    for name, source in sorted(lowered.resources.items()):
        digest.update(f"\0{name}\0".encode())
        digest.update(_bytes(getattr(source, "data", source)))
    return digest.hexdigest()


def _bytes(data: Any) -> bytes:
    """What a texture or a buffer holds; of a file its content."""
    if isinstance(data, str | Path):
        try:
            return Path(data).read_bytes()
        except OSError:  # rendering tells what is wrong with it
            return str(data).encode()
    try:
        array = np.asarray(data)
    except ValueError:
        return repr(data).encode()
    if array.dtype == object:
        return repr(data).encode()
    return f"{array.dtype}{array.shape}".encode() + array.tobytes()
