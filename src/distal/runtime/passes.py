"""The kernels of one picture, and the passes that they render.

Input: compiled kernels, the values of their uniforms, options. Output: pixels of a pass; the light
of a picture of ever more samples. Counts lost rays.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Kernel
from distal.lang.render_options import Progress, Refinement, RenderOptions
from distal.render import film
from distal.runtime import accumulation, film_files
from distal.runtime.fingerprints import fingerprint
from distal.runtime.lost_rays import LostRays
from distal.runtime.lowered import Lowered
from distal.runtime.photons import PhotonPasses
from distal.runtime.uniform_values import DeclaredUniforms


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
        pixels = self.kernels[0].render(
            *size,
            self.declared.for_kernel(0, parameters, changed),
            {name: buffers.get(own[name], now) for name, now in self.resources.items()},
            threads=self.options.threads,
            progress=progress,
            cancel=self.options.cancel,
        )
        if len(self.parts) > 1:
            self.lost.remove_marks(pixels)
        return pixels

    def accumulated(self, refinement: Refinement) -> accumulation.Film:
        """Render samples until there are enough of them."""

        def rendered(first: int, count: int, progress: Progress | None) -> NDArray[np.float32]:
            numbers = {film.FIRST_SAMPLE: first, film.SAMPLES: count}
            if self.photons is None:
                return self.light(self.options.size, numbers, {}, progress)
            found = self.photons.tables(first, count)
            return self.light(
                self.options.size, {**numbers, **found.numbers}, found.buffers, progress
            )

        size, progress = self.options.size, self.options.progress
        if refinement.film is None:
            exposed = accumulation.Film.empty(*size)
            accumulation.accumulate(exposed, rendered, refinement, None, progress)
            return exposed
        file = film_files.FilmFile(refinement.film, self._fingerprint)
        exposed = file.load(*size)
        try:
            accumulation.accumulate(exposed, rendered, refinement, file.keep, progress)
        finally:
            file.write(exposed)
        return exposed

    @property
    def _fingerprint(self) -> str:
        """The fingerprint of the picture without its number of samples."""
        parameters, others = self.values
        numbers = self.declared.for_kernel(0, parameters, others)
        numbers = {n: v for n, v in numbers.items() if n not in film.PASS_NUMBERS}
        parts = [self.parts[0].digest, numbers, self.options.size]
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
        """Return the contrast of each pixel of display values with its neighbours."""
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
