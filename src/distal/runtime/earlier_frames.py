"""Provide what changes with each frame to the kernels of a picture.

Input: a picture's functions and its options. Output: the texels of earlier pictures and of the
keyboard, by the names of its textures. Keeps the frames of the last few pictures.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.forking import new_lock
from distal.lang.functions import Image
from distal.lang.render_options import RenderOptions
from distal.runtime.frame_history import (
    FrameHistory,
    LiveFrames,
    frames_until,
    key_of,
    live_texels,
)
from distal.runtime.moving import moved_resources
from distal.runtime.standard_executor import Parts
from distal.runtime.uniform_values import chosen_uniforms

if TYPE_CHECKING:
    from distal.runtime.executor import PythonExecutor

# Pictures whose frames are kept: those of a video, of a window, follow one another.
_HISTORIES_KEPT: Final = 2


class EarlierFrames:
    """The frames of the last few pictures that read earlier ones."""

    def __init__(self, executor: PythonExecutor) -> None:
        self._executor = executor
        self._histories: dict[tuple[Any, ...], FrameHistory] = {}
        self._lock = new_lock()

    def numbered(self, run: Parts, options: RenderOptions) -> RenderOptions:
        """Return the options with the number of the frame."""
        if isinstance(options.history, LiveFrames):
            return options.history.numbered(options, keeps=bool(run.read.all))
        if options.index is not None:
            return options
        return replace(options, index=frames_until(options) if run.read.all else 0)

    def texels(self, run: Parts, options: RenderOptions) -> dict[str, Any]:
        """Return the texels of what changes with each frame, by name.

        Args:
            run: The picture.
            options: Its options, with the number of the frame.

        Raises:
            Cancelled: ``options.cancel`` stopped the work.
        """
        texels: dict[Image, NDArray[np.float32]] = {}
        if run.read.all:
            history = options.history or self._history(key_of(run.read, options))
            texels = history.at(run.read, options, self._rendered)
        return live_texels(run.parts[0].resources, texels, options)

    def _history(self, key: tuple[Any, ...]) -> FrameHistory:
        """Return the frames that were computed for these values."""
        with self._lock:
            found = self._histories.pop(key, None) or FrameHistory()
            self._histories[key] = found
            if len(self._histories) > _HISTORIES_KEPT:
                self._histories.pop(next(iter(self._histories)))
            return found

    def _rendered(
        self, image: Image, texels: Mapping[Image, NDArray[np.float32]], options: RenderOptions
    ) -> NDArray[np.float32]:
        """Render a buffer, or an earlier picture, once."""
        run = self._executor.parts(image)
        own = {n for p in run.declared.parameters for n in (p.name, p.label)}
        chosen = {name: value for name, value in options.params.items() if name in own}
        options = replace(options, params=chosen, settings={})
        values, others = chosen_uniforms(run.declared, options)
        resources = moved_resources(run.parts[0].resources, values, options.time)
        return self._executor.kernels.kernel(run.parts[0], options.device, 32).render(
            *options.size,
            run.declared.for_kernel(0, values, others),
            resources | live_texels(run.parts[0].resources, texels, options),
            threads=options.threads,
            cancel=options.cancel,
        )
