"""The kernels of one picture, and the passes that they render.

Input: compiled kernels, the values of their uniforms, options. Output: pixels of a pass; the light
of a picture of ever more samples. Counts lost rays.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Kernel
from distal.lang.render_options import Progress, Refinement, RenderOptions
from distal.lang.runtime_access import executor
from distal.render import film, path_film
from distal.runtime import accumulation, film_files, sampling
from distal.runtime.allocation import Pass
from distal.runtime.device_names import REFERENCE
from distal.runtime.fingerprints import fingerprint
from distal.runtime.lost_rays import LostRays
from distal.runtime.lowered import Lowered
from distal.runtime.moving import moved_resources
from distal.runtime.photons import PhotonPasses
from distal.runtime.uniform_values import DeclaredUniforms

# Seconds between two previews; one that takes long is shown less often.
PREVIEW_S: Final = 3.0
_PREVIEW_SHARE: Final = 20.0
# A pass of all pixels reads no list.
_NO_PLACES: Final = np.zeros(1, np.int32)


class Previews:
    """Shows a picture while it is rendered, and when the work is broken off.

    Args:
        preview: Shows the samples so far; None shows nothing.
    """

    def __init__(self, preview: Callable[[accumulation.Film], None] | None) -> None:
        self._preview = preview
        self._next = time.monotonic() + PREVIEW_S

    def show(self, film: accumulation.Film) -> None:
        """Show the samples so far, if the last time was long ago."""
        begin = time.monotonic()
        if self._preview is None or begin < self._next:
            return
        self._preview(film)
        end = time.monotonic()
        self._next = end + max(PREVIEW_S, _PREVIEW_SHARE * (end - begin))

    @contextmanager
    def of(self, film: accumulation.Film) -> Iterator[None]:
        """Show the samples of a film if the block is broken off."""
        try:
            yield
        except BaseException:
            if self._preview is not None and int(film.samples.min()) > 0:
                self._preview(film)
            raise


@dataclass(frozen=True, slots=True)
class Passes:
    """The kernels of one picture with everything that they are called with."""

    kernels: Sequence[Kernel]
    parts: Sequence[Lowered]
    declared: DeclaredUniforms
    values: tuple[Mapping[str, Any], Mapping[str, Any]]
    options: RenderOptions
    resources: Mapping[str, Any]
    lost: LostRays = field(default_factory=LostRays)
    photons: PhotonPasses | None = None
    earlier_s: float = 0.0  # what earlier frames took that the picture reads

    def light(
        self,
        size: tuple[int, int],
        numbers: Mapping[str, Any],
        buffers: Mapping[Any, Any],
        progress: Progress | None,
    ) -> NDArray[np.float32]:
        """Render the first kernel; see ``sampling.Programs``.

        Linear light of a scene carries marks of lost rays, which are counted and removed.
        """
        parameters, others = self.values
        changed = {**others, **numbers, "resolution": (float(size[0]), float(size[1]))}
        own = self.parts[0].resources
        resources = self.resources
        if "time" in numbers:
            resources = moved_resources(own, parameters, numbers["time"])
        pixels = self.kernels[0].render(
            *size,
            self.declared.for_kernel(0, parameters, changed),
            {name: buffers.get(own[name], now) for name, now in resources.items()},
            threads=self.options.threads,
            progress=progress,
            cancel=self.options.cancel,
        )
        if len(self.parts) > 1:
            self.lost.remove_marks(pixels)
        return pixels

    def accumulated(
        self,
        refinement: Refinement,
        preview: Callable[[accumulation.Film], None] | None = None,
    ) -> accumulation.Film:
        """Render samples until there are enough of them.

        Args:
            refinement: When there are, and what is shared by all of them.
            preview: Called with the samples so far, at most every few seconds, and when the work
                is broken off.
        """
        size, progress = self.options.size, self.options.progress
        empty = accumulation.Film.empty(*size, signed=refinement.signed)
        seen = Previews(preview)
        if refinement.film is None:
            rendered = partial(self.pass_of, refinement)
            with seen.of(empty):
                accumulation.accumulate(empty, rendered, refinement, seen.show, progress)
            return empty
        file = film_files.FilmFile(refinement.film, self._fingerprint(refinement))
        exposed = file.load(*size, signed=refinement.signed)

        def watch(film: accumulation.Film) -> None:
            file.keep(film)
            seen.show(film)

        try:
            with seen.of(exposed):
                rendered = partial(self.pass_of, refinement)
                accumulation.accumulate(exposed, rendered, refinement, watch, progress)
        finally:
            file.write(exposed)
        return exposed

    def pass_of(
        self, refinement: Refinement, asked: Pass, progress: Progress | None
    ) -> NDArray[np.float32]:
        """Render a pass; see ``accumulation.Rendered``.

        Args:
            refinement: What is shared by all samples.
            asked: The samples.
            progress: Called with the finished share, from 0 to 1.
        """
        numbers: dict[str, Any] = {film.FIRST_SAMPLE: asked.first, film.SAMPLES: asked.count}
        buffers: dict[Any, Any] = {}
        width, height = self.options.size
        if refinement.shutter > 0.0:
            numbers["time"] = self._time_of(asked.first, refinement.shutter)
        if self.photons is not None:
            pixels = asked.pixels(width * height)
            seconds = numbers.get("time", self.options.time)
            found = self.photons.tables(asked.first, asked.count, pixels, seconds)
            numbers |= found.numbers
            buffers |= found.buffers
        if film.AGAIN not in self.declared.numbers:
            assert asked.places is None, "the program renders all pixels"
            return self.light(self.options.size, numbers, buffers, progress)
        numbers |= {film.AGAIN: False, film.PICTURE_SIZE: (float(width), float(height))}
        if asked.places is None:
            buffers[film.PLACES] = _NO_PLACES
            return self.light(self.options.size, numbers, buffers, progress)
        buffers[film.PLACES], grid = sampling.arranged(asked.places)
        numbers[film.AGAIN] = True
        light = self.light(grid, numbers, buffers, progress)
        return sampling.listed(light)[: len(asked.places)]

    def _time_of(self, sample: int, shutter: float) -> float:
        """Return the time of a sample while the shutter is open, in seconds."""
        others = self.values[1]
        given = (sample, others["seed"], others["index"])
        share = executor().call(path_film.shutter_share, given, {}, device=REFERENCE)
        return float(others["time"]) + shutter * float(share)

    def _fingerprint(self, refinement: Refinement) -> str:
        """The fingerprint of the picture without its number of samples."""
        parameters, others = self.values
        numbers = self.declared.for_kernel(0, parameters, others)
        numbers = {n: v for n, v in numbers.items() if n not in film.PASS_NUMBERS}
        parts = [self.parts[0].digest, numbers, self.options.size, refinement.shutter]
        return fingerprint(parts, self.resources)

    def shown(self, light: NDArray[np.float32]) -> NDArray[np.float32]:
        """Encode linear light for display by the second kernel."""
        return self.kernels[1].map_pixels(
            light,
            self.declared.for_kernel(1, *self.values),
            self.parts[1].resources,
            threads=self.options.threads,
            cancel=self.options.cancel,
        )

    def contrast(
        self, kernel: Kernel, resources: Mapping[str, Any], shown: NDArray[np.float32]
    ) -> NDArray[np.float32]:
        """Return the contrast of each pixel of display values with its neighbors."""
        height, width, _ = shown.shape
        return over_picture(kernel, resources, (width, height), {}, shown, self.options)[..., 0]


def over_picture(
    kernel: Kernel,
    resources: Mapping[str, Any],
    size: tuple[int, int],
    numbers: Mapping[str, Any],
    light: NDArray[np.float32],
    options: RenderOptions,
) -> NDArray[np.float32]:
    """Render a picture that reads another one, as a buffer of colors.

    Args:
        kernel: The kernel of the picture.
        resources: Its buffers by name.
        size: Width and height in pixels.
        numbers: Its other uniforms by name.
        light: The picture that it reads, (height, width, 4).
        options: The threads, and the event that ends the work early.
    """
    return kernel.render(
        *size,
        {**numbers, "resolution": (float(size[0]), float(size[1]))},
        dict.fromkeys(resources, light.reshape(-1, 4)),
        threads=options.threads,
        cancel=options.cancel,
    )
