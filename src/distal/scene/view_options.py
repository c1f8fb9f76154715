"""The options of a scene's picture: each with its default and its check.

Input: values from a caller. Output: a ``ViewOptions``, and the numbers that its programs read.
``distal.lang.render_options`` has the options that all pictures share. Standard library only.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC3
from distal.lang.render_options import MOST_SAMPLES, PATH_SAMPLES, Refinement, checked_samples
from distal.lang.source_places import author_place
from distal.render import filters, path_film
from distal.scene.lowering.layers import OF_SAMPLES, checked_layers
from distal.scene.section import CutPlane
from distal.scene.steering import Steering
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse_kind

if TYPE_CHECKING:
    from distal.images.picture import Picture

MODES: Final = ("direct", "path")
# The options of mode "path", and those of them that a picture's file records.
RECORDED: Final = ("noise", "filter", "shutter", "clamp", "denoise", "caustics")
_OF_PATHS: Final = ("spp", "time_limit", "film", "preview", *RECORDED)


@dataclass(frozen=True, slots=True, kw_only=True)
class ViewOptions:
    """What is shown of a scene; checked on construction.

    Attributes:
        mode: How light is computed: "direct" or "path"; None: as the scene says.
        caustics: In mode "path": whether light that glass, mirrors and metals bundle is found by
            photons: much faster, with a small error that goes to 0. False: by paths alone.
        spp: In mode "path": samples in each pixel, the same as ``samples``. None: 64, or as
            many as a limit of time or noise takes.
        time_limit: In mode "path": seconds after which no more samples are begun.
        noise: In mode "path": the estimated error at which the picture is finished: the standard
            error of a pixel's light, as a root mean square (1 is white).
        film: In mode "path": a file that keeps the samples so far; if it exists, rendering goes on
            from them.
        filter: In mode "path": the reconstruction filter, "tent", "box", "gaussian",
            "blackman-harris" or "mitchell"; None: "tent".
        shutter: In mode "path": seconds that the shutter is open, from ``time`` on; what moves is
            blurred. None: as the scene says.
        clamp: In mode "path": the largest light of a sample; brighter ones are scaled to it. That
            removes single bright pixels, and some light: the picture is biased. None has no limit.
        denoise: In mode "path": whether Open Image Denoise removes the noise that is left, guided
            by albedo and normal; needs ``distal[denoise]``. It may remove fine detail.
        preview: In mode "path": called with the picture so far, at most every few seconds, and when
            the work is broken off.
        view: What to show: "color", "coordinate", "signal", "distance", "normal", "depth",
            "steps", "material", "slope" or "slice".
        transparent: Whether alpha is 0 where a ray hits nothing.
        plane: The plane that the view "slice" shows: its normal, of length 1, and its distance from
            the origin along the normal.
        steering: How a person has moved the camera; None if it was not moved.
        section: The plane of a scene that is cut open (``Scene.sectioned``); None if it is whole.
        layers: Layers to compute for ``Picture.layers``: "depth", "normal", "albedo", "material";
            in mode "path" also "samples" and "variance".

    Raises:
        ValueError: A value is out of range, or there is no such layer.
    """

    mode: str | None = None
    caustics: bool = True
    spp: int | None = None
    time_limit: float | None = None
    noise: float | None = None
    film: str | Path | None = None
    filter: str | None = None
    shutter: float | None = None
    clamp: float | None = None
    denoise: bool = False
    preview: Callable[[Picture], Any] | None = None
    view: str = "color"
    transparent: bool = False
    plane: tuple[Any, float] = ((0.0, 0.0, 1.0), 0.0)
    steering: Steering | None = None
    section: CutPlane | None = None
    layers: Sequence[str] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", checked_layers(self.layers))
        if self.mode not in (None, *MODES):
            raise ValueError(f"there is no mode '{self.mode!s:.40}'; modes: {', '.join(MODES)}")
        object.__setattr__(self, "spp", checked_samples(self.spp))
        for name in ("time_limit", "noise", "clamp"):
            object.__setattr__(self, name, _checked_limit(name, getattr(self, name)))
        if self.shutter != 0.0:
            object.__setattr__(self, "shutter", _checked_limit("shutter", self.shutter, "0 or "))
        if self.filter not in (None, *filters.NAMES):
            known = ", ".join(filters.NAMES)
            raise ValueError(f"there is no filter {self.filter!r:.40}; filters: {known}")
        if self.filter in filters.SIGNED and self.transparent:
            raise ValueError(
                f"the negative weights of filter '{self.filter}' leave noise in alpha: give "
                "another filter to a transparent picture"
            )

    def refinement(self, mode: str, samples: int | None, shutter: float = 0.0) -> Refinement | None:
        """Return when a picture in mode "path" is finished; None in mode "direct".

        Args:
            mode: The scene's own mode.
            samples: Samples in each pixel, if they are given as for other pictures.
            shutter: The scene's own shutter, in seconds.

        Raises:
            ValueError: An option for paths was given in mode "direct", or contradicts another.
        """
        if (self.mode or mode) != "path":
            for name in self._given(_OF_PATHS):
                raise ValueError(f"{name} is for mode 'path'")
            for name in self.layers:
                if name in OF_SAMPLES:
                    raise ValueError(f"the layer '{name}' is for mode 'path'")
            return None
        if self.view != "color":
            if self.mode is None:
                return None
            raise ValueError(f"mode 'path' computes light; the view '{self.view:.40}' shows none")
        if None not in (self.spp, samples) and self.spp != samples:
            raise ValueError(f"spp={self.spp} and samples={samples} are the same: give one")
        limited = self.time_limit is not None or self.noise is not None
        count = self.spp or samples or (MOST_SAMPLES if limited else PATH_SAMPLES)
        film = None if self.film is None else Path(self.film)
        return Refinement(
            samples=count,
            time_limit=self.time_limit,
            noise=self.noise,
            film=film,
            shutter=shutter if self.shutter is None else self.shutter,
            signed=self.filter in filters.SIGNED,
            preview=self.preview,
        )

    @property
    def path_settings(self) -> dict[str, Any]:
        """The uniforms of a picture in mode "path" that differ from their defaults."""
        return {} if self.clamp is None else {path_film.LARGEST: self.clamp}

    @property
    def recorded(self) -> dict[str, Any]:
        """The options of mode "path" that a picture's file records, by name."""
        return self._given(RECORDED)

    def _given(self, names: Iterable[str]) -> dict[str, Any]:
        """Return those of these options that are not at their defaults, by name."""
        defaults = {option.name: option.default for option in fields(self)}
        found = {name: getattr(self, name) for name in names}
        return {name: value for name, value in found.items() if value != defaults[name]}

    @property
    def steering_settings(self) -> dict[str, Any]:
        """The uniforms of a steered view and of a section; empty without them."""
        moved = {} if self.steering is None else self.steering.settings
        return moved if self.section is None else {**moved, **self.section.settings}

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


def _checked_limit(name: str, value: object, also: str = "") -> float | None:
    """Return the limit, or None.

    Args:
        name: The name of the option.
        value: The author's value.
        also: What else is allowed, for the message.

    Raises:
        ValueError: It is no number above 0.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < math.inf:
        raise ValueError(f"{name} is {also}a number above 0, not {value!r:.40}")
    return float(value)
