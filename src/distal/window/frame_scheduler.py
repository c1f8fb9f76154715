"""Decide which frame is rendered next, and at which resolution.

Input: shots, sizes, finished frames. Output: jobs for the worker, the frame to show, the frame
rate. Does not depend on windows or keys.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final

from distal.window.film_renderer import MOST_SAMPLES, FilmRenderer
from distal.window.frame_renderers import FrameRenderer, RenderedFrame
from distal.window.resolution import ResolutionChooser
from distal.window.shot import Shot
from distal.window.worker import Worker

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

_LEAST_GAP_S: Final = 1 / 60
# A still is refined when it has been at rest so long; a hand that pauses goes on without waiting.
_LEAST_REST_S: Final = 0.3
# A still of this share is not preceded by a preview any more.
_PREVIEWED: Final = 0.4
_FIGURES_S: Final = 1.0  # the frame rate is measured over the last second


@dataclass(frozen=True, slots=True)
class FrameRequest:
    """A frame that is requested, being rendered, or shown.

    Attributes:
        viewable: The object to show.
        shot: Time, parameters, view and camera.
        size: Width and height of the window's picture in pixels.
        share: The fraction of width and height that is rendered.
        refinement: How often a still was refined: the index in the samples of the renderer; in mode
            "path" 0 is direct light, and each further frame has more samples.
    """

    viewable: Viewable
    shot: Shot
    size: tuple[int, int]
    share: float
    refinement: int = 0

    @property
    def quality(self) -> tuple[float, int]:
        """What a better frame has more of."""
        return self.share, self.refinement

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of the rendered frame in pixels."""
        width, height = self.size
        return max(round(width * self.share), 1), max(round(height * self.share), 1)

    def shows_the_same(self, other: FrameRequest) -> bool:
        """Return whether two requests differ at most in their quality."""
        mine, its = (self.viewable, self.shot, self.size), (other.viewable, other.shot, other.size)
        return mine == its


class FrameScheduler:
    """Renders one frame at a time, always the latest request.

    Attributes:
        shown: The last frame that was finished.
        failed: The request that could not be rendered; it is not tried again.
        made: The rendered frame of ``shown``.
        film: Renders stills by paths.
    """

    def __init__(
        self,
        renderer: FrameRenderer,
        worker: Worker,
        on_finished: Callable[[FrameRequest, RenderedFrame], None],
        on_failure: Callable[[FrameRequest, BaseException], None],
    ) -> None:
        self.renderer = renderer
        self.shown: FrameRequest | None = None
        self.made: RenderedFrame | None = None
        self.failed: FrameRequest | None = None
        self._worker = worker
        self.film = FilmRenderer(renderer.device)
        self._on_finished, self._on_failure = on_finished, on_failure
        self._resolution = ResolutionChooser()
        self._in_progress: FrameRequest | None = None
        self._begun = self._ended = float("-inf")
        self._times: deque[float] = deque(maxlen=240)

    @property
    def is_busy(self) -> bool:
        """Whether a frame is being rendered."""
        return self._in_progress is not None

    @property
    def is_tracing(self) -> bool:
        """Whether samples are being added to a film; the status counts them."""
        current = self._in_progress
        return current is not None and current.refinement > 0 and current.shot.mode == "path"

    @property
    def frames_per_s(self) -> float:
        """The number of frames in the last second."""
        now = time.monotonic()
        recent = [moment for moment in self._times if now - moment < _FIGURES_S]
        if len(recent) < 2:
            return float(len(recent))
        return (len(recent) - 1) / max(recent[-1] - recent[0], 1e-6)

    def request_frame(
        self, viewable: Viewable, shot: Shot, size: tuple[int, int], *, is_moving: bool
    ) -> float | None:
        """Start to render a frame if it differs from the one that is shown.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height of the window's picture in pixels.
            is_moving: Whether a fast frame is preferred to a sharp one.

        Returns:
            Seconds after which to call again; None if the call after the next finished frame is
            early enough, or if nothing is left to do.
        """
        if self.shown is not None and (
            self.shown.viewable is not viewable or _program(self.shown.shot) != _program(shot)
        ):
            self._forget(viewable, shot)
        request = self._next_request(viewable, shot, size, is_moving=is_moving)
        if self._in_progress is not None:
            self._cancel_for(request, is_moving=is_moving)
            return None
        if not self._is_wanted(request):
            return None
        rest = _LEAST_REST_S if request.refinement == 1 else 0.0
        wait = max(self._begun + _LEAST_GAP_S, self._ended + rest) - time.monotonic()
        if wait > 0:
            return wait
        self._begin(request)
        return None

    def _next_request(
        self, viewable: Viewable, shot: Shot, size: tuple[int, int], *, is_moving: bool
    ) -> FrameRequest:
        """Return the frame that is wanted now: fast, or sharp, or with smooth edges."""
        best = FrameRequest(viewable, shot, size, 1.0)
        shown = self.shown if self.shown is not None and self.shown.shows_the_same(best) else None
        is_first = shown is None or shown.share < _PREVIEWED
        share = self._resolution.share(size, is_moving=is_moving, is_first=is_first)
        if viewable.keeps_frames:  # frames build on one another: all have one size
            share = 1.0
        refinement = 0
        if shown is not None and shown.share == 1.0 and not is_moving:
            refinement = min(shown.refinement + 1, self._last_refinement(shown))
        return replace(best, share=share, refinement=refinement)

    def is_final(self, request: FrameRequest) -> bool:
        """Return whether no better frame will follow, unless something changes."""
        return request.quality >= (1.0, self._last_refinement(request))

    def _last_refinement(self, request: FrameRequest) -> int:
        if request.shot.mode == "path":
            is_finished = self.made is not None and self.made.samples >= MOST_SAMPLES
            return request.refinement + (0 if is_finished else 1)
        is_sampled = request.viewable.is_sampled(request.shot.view)
        return len(self.renderer.samples) - 1 if is_sampled else 0

    def postpone_refinement(self) -> None:
        """Cancel a refinement that is being rendered; it begins again after submitted jobs."""
        if self._in_progress is not None and self._in_progress.refinement > 0:
            self._worker.cancel()

    def _forget(self, viewable: Viewable, shot: Shot) -> None:
        assert self.shown is not None
        current = self._in_progress
        is_other = current is None or current.viewable is not viewable
        if is_other or (current is not None and _program(current.shot) != _program(shot)):
            self._resolution.forget()

    def _is_wanted(self, request: FrameRequest) -> bool:
        for known in (self.shown, self.failed):
            if known is not None and request.shows_the_same(known):
                return known is self.shown and request.quality > known.quality
        return True

    def _cancel_for(self, request: FrameRequest, *, is_moving: bool) -> None:
        """Cancel a frame that is not needed any more; a frame of low resolution is finished."""
        current = self._in_progress
        assert current is not None
        if current.shows_the_same(request):
            return
        if is_moving and current.quality <= request.quality:
            return
        self._worker.cancel()

    def _begin(self, request: FrameRequest) -> None:
        self._in_progress, self._begun = request, time.monotonic()
        what = request.viewable, request.shot, request.pixels

        def job(cancel: threading.Event) -> RenderedFrame:
            if request.refinement > 0 and request.shot.mode == "path":
                return self.film.render(*what, cancel)
            samples = self.renderer.samples[request.refinement]
            return self.renderer.render(*what, cancel, samples=samples)

        self._worker.submit(job, lambda result: self._end(request, result))

    def _end(self, request: FrameRequest, result: Any) -> None:
        self._in_progress = None
        self._ended = time.monotonic()
        if isinstance(result, BaseException):
            self.failed = request
            self._on_failure(request, result)
            return
        width, height = request.pixels
        if request.refinement == 0:
            self._resolution.learn(result.seconds, width * height * result.share)
        if result.share == 1.0:
            self.shown, self.made, self.failed = request, result, None
            self._times.append(time.monotonic())
        self._on_finished(request, result)


def _program(shot: Shot) -> tuple[str, bool]:
    """Return what decides which program of an object draws a shot."""
    return shot.view, shot.section is not None
