"""Render stills by paths: a film that gets more samples with each frame.

Input: a viewable object, a ``Shot``, a size. Output: a ``RenderedFrame`` of display values with
its number of samples. Runs in the worker's thread; does not depend on windows.
"""

from __future__ import annotations

import threading
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from distal.devices.base import Cancelled
from distal.images.png import quantise
from distal.lang.render_options import Refinement
from distal.lang.runtime_access import executor
from distal.runtime.accumulation import Film
from distal.runtime.allocation import MOST_OF_A_PASS, Pass
from distal.scene.steering import STILL
from distal.window.frame_renderers import RenderedFrame, picture, render_options
from distal.window.shot import Shot

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.runtime.passes import Passes
    from distal.scene.viewing.viewable import Viewable

# A film has enough: its error is 1/128 of that of one sample. As on pages.
MOST_SAMPLES: Final = 16384
# With fewer samples direct light looks better.
_FEWEST_SHOWN: Final = 4
# A saved picture has so many at least.
_FEWEST_SAVED: Final = 16
# Seconds between two pictures of a film.
_FRAME_S: Final = 0.2


class FilmRenderer:
    """Renders frames by paths on one device; keeps the film of the last shot."""

    def __init__(self, device: str) -> None:
        """Make a renderer; ``device`` is a name as for ``render``."""
        # Paths need no textures: a GPU computes them without its fragment stage.
        self.device = device.replace("gpu-fragment", "gpu")
        self._key: tuple[Viewable, Shot, tuple[int, int]] | None = None
        self._film = Film.empty(1, 1)
        self._seconds = 0.0  # of all samples

    def render(
        self, viewable: Viewable, shot: Shot, size: tuple[int, int], cancel: threading.Event
    ) -> RenderedFrame:
        """Add samples and return the picture; if cancelled, keep what the film has.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early.

        Raises:
            CompileError: The scene code has mistakes.
            DeviceError: The device was lost.
        """
        if (viewable, shot, size) != self._key:
            self._key, self._film, self._seconds = (viewable, shot, size), Film.empty(*size), 0.0
        film, passes = self._film, self._passes(viewable, shot, size, cancel)
        begin = time.perf_counter()
        assert viewable.scene is not None
        refinement = Refinement(samples=MOST_SAMPLES, shutter=viewable.scene.shutter)
        try:
            while self._done < MOST_SAMPLES:
                asked, started = self._next_pass(refinement), time.perf_counter()
                film.add(passes.pass_of(refinement, asked, None), asked.count)
                now = time.perf_counter()
                self._seconds += now - started
                if self._is_enough(now - begin):
                    break
            pixels = quantise(passes.shown(film.light))
        except Cancelled:
            return RenderedFrame(seconds=time.perf_counter() - begin, share=0.5)
        seconds, rate = time.perf_counter() - begin, self._done / max(self._seconds, 1e-9)
        return RenderedFrame(pixels, seconds=seconds, samples=self._done, rate=rate)

    def picture(self, viewable: Viewable, shot: Shot, size: tuple[int, int]) -> Picture:
        """Return the film's picture with complete metadata; it has at least a few samples.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
        """
        never = threading.Event()
        self.render(viewable, shot, size, never)
        while self._done < _FEWEST_SAVED:
            self.render(viewable, shot, size, never)
        # Direct light of the same shot has the same metadata.
        options = render_options(shot, size, self.device)
        direct = picture(viewable.in_mode("direct"), shot, options)
        light = self._film.light
        shown = self._passes(viewable, shot, size, never).shown(light)
        made = replace(direct, array=shown, light=light, stats=self._film.figures())
        paths = {} if viewable.caustics else {"caustics": False}
        return made.with_provenance(mode="path", samples=self._done, paths=paths)

    def _passes(
        self, viewable: Viewable, shot: Shot, size: tuple[int, int], cancel: threading.Event
    ) -> Passes:
        viewable = viewable.shown_with(shot.section)
        assert viewable.scene is not None
        steering = STILL if shot.steering is None else shot.steering
        options = render_options(shot, size, self.device)
        options = replace(
            options, cancel=cancel, settings=viewable.settings(steering, shot.section)
        )
        image = viewable.scene.view(shot.view, steered=True, paths=True, caustics=viewable.caustics)
        return executor().passes(image, options)

    def _is_enough(self, seconds: float) -> bool:
        """Return whether the film is shown now that it has got samples for so many seconds."""
        return self._done >= _FEWEST_SHOWN and seconds > 0.5 * _FRAME_S

    @property
    def _done(self) -> int:
        """The number of samples of the film."""
        return int(self._film.samples.min())

    def _next_pass(self, refinement: Refinement) -> Pass:
        """Return the next pass, so that frames follow each other in time."""
        done = self._done
        if done == 0 or refinement.shutter > 0.0:
            return Pass(done, 1)
        fit = int(_FRAME_S * done / max(self._seconds, 1e-9))
        return Pass(done, max(1, min(fit, MOST_OF_A_PASS, MOST_SAMPLES - done)))
