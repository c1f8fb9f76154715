"""Keeps the picture up with what a person wants to see: which frame is made next, and how sharp.

Input: shots, sizes, finished frames. Output: jobs for the worker, the frame to
show, the figures. Knows neither window nor keys.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from distal.window.frame_renderers import FrameRenderer, RenderedFrame
from distal.window.resolution import ResolutionChooser
from distal.window.session import Shot
from distal.window.worker import Worker

if TYPE_CHECKING:
    from distal.scene.viewing.viewable import Viewable

_LEAST_GAP_S: Final = 1 / 60
_FIGURES_S: Final = 1.0  # frames are counted over the last second


@dataclass(frozen=True, slots=True)
class FrameRequest:
    """A frame that is wanted, in making, or shown.

    Attributes:
        viewable: What it shows.
        shot: How.
        size: Width and height of the window's picture in pixels.
        share: The part of them that is rendered.
    """

    viewable: Viewable
    shot: Shot
    size: tuple[int, int]
    share: float

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height that are rendered."""
        width, height = self.size
        return max(round(width * self.share), 1), max(round(height * self.share), 1)

    def shows_the_same(self, other: FrameRequest) -> bool:
        """Whether only sharpness sets them apart."""
        mine, its = (self.viewable, self.shot, self.size), (other.viewable, other.shot, other.size)
        return mine == its


class FrameScheduler:
    """One frame at a time, always of what is wanted when it begins.

    Attributes:
        shown: The last frame that was finished.
        failed: The order that could not be made; it is not tried again.
        made: Its figures.
    """

    def __init__(
        self,
        maker: FrameRenderer,
        worker: Worker,
        finished: Callable[[FrameRequest, RenderedFrame], None],
        failing: Callable[[FrameRequest, BaseException], None],
    ) -> None:
        self.maker = maker
        self.shown: FrameRequest | None = None
        self.made: RenderedFrame | None = None
        self.failed: FrameRequest | None = None
        self._worker = worker
        self._finished, self._failing = finished, failing
        self._pace = ResolutionChooser()
        self._in_making: FrameRequest | None = None
        self._begun = float("-inf")
        self._times: deque[float] = deque(maxlen=240)

    @property
    def is_busy(self) -> bool:
        """Whether a frame is being made."""
        return self._in_making is not None

    @property
    def frames_per_s(self) -> float:
        """How many frames the last second saw."""
        now = time.monotonic()
        recent = [moment for moment in self._times if now - moment < _FIGURES_S]
        if len(recent) < 2:
            return float(len(recent))
        return (len(recent) - 1) / max(recent[-1] - recent[0], 1e-6)

    def want(
        self, viewable: Viewable, shot: Shot, size: tuple[int, int], *, is_moving: bool
    ) -> float | None:
        """Make a frame if what is shown is another.

        Returns:
            Seconds after which to ask again; None where a finished frame will be the occasion, or
            nothing is left to do.
        """
        if self.shown is not None and (
            self.shown.viewable is not viewable or self.shown.shot.view != shot.view
        ):
            self._forget(viewable, shot)
        share = self._pace.share(size, is_moving=is_moving)
        order = FrameRequest(viewable, shot, size, share)
        if self._in_making is not None:
            self._give_up_for(order, is_moving=is_moving)
            return None
        if not self._is_wanted(order):
            return None
        wait = self._begun + _LEAST_GAP_S - time.monotonic()
        if wait > 0:
            return wait
        self._begin(order)
        return None

    def _forget(self, viewable: Viewable, shot: Shot) -> None:
        assert self.shown is not None
        making = self._in_making
        if making is None or making.viewable is not viewable or making.shot.view != shot.view:
            self._pace.forget()

    def _is_wanted(self, order: FrameRequest) -> bool:
        for known in (self.shown, self.failed):
            if known is not None and order.shows_the_same(known):
                return known is self.shown and order.share > known.share
        return True

    def _give_up_for(self, order: FrameRequest, *, is_moving: bool) -> None:
        """End a sharp frame that nobody waits for any more; coarse ones come soon enough."""
        making = self._in_making
        assert making is not None
        if making.shows_the_same(order):
            return
        if is_moving and making.share <= order.share:
            return
        self._worker.cancel()

    def _begin(self, order: FrameRequest) -> None:
        self._in_making, self._begun = order, time.monotonic()
        self._worker.submit(
            lambda cancel: self.maker.make(order.viewable, order.shot, order.pixels, cancel),
            lambda result: self._end(order, result),
        )

    def _end(self, order: FrameRequest, result: Any) -> None:
        self._in_making = None
        if isinstance(result, BaseException):
            self.failed = order
            self._failing(order, result)
            return
        width, height = order.pixels
        self._pace.learn(result.seconds, width * height * result.share)
        if result.share == 1.0:
            self.shown, self.made, self.failed = order, result, None
            self._times.append(time.monotonic())
        self._finished(order, result)
