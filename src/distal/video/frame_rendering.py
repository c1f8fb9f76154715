"""Render the frames of a sequence, several at the same time, while other threads take them.

Input: an animated picture, the indices of frames. Output: each frame is passed on, in order. A
frame that fails on the workers of a cluster does not end the others: it is noted, tried again
alone, and named in the end. Does not depend on files.
"""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from typing import Final, Generic, TypeVar

from distal.devices.base import PartError
from distal.diagnostics import DeviceError
from distal.images.picture import Picture
from distal.lang.render_options import FrameProgress
from distal.video.moving_picture import MovingPicture
from distal.video.overlap import made_ahead, taking
from distal.video.store import Tell
from distal.video.timing import Timing

Item = TypeVar("Item")
# Called with (finished frames, all frames, "rendering" or "encoding").
# So many failures in a row have one reason, which the other frames have too.
_MOST_IN_A_ROW: Final = 8
# Failed frames whose reasons a message gives, and that it names.
_MOST_EXPLAINED: Final = 3
_MOST_NAMED: Final = 10


@dataclass(frozen=True, slots=True)
class MadeFrame(Generic[Item]):
    """What a frame became.

    Attributes:
        index: The frame.
        item: What was made of it; None: nothing.
        error: Why it failed; None if it did not.
    """

    index: int
    item: Item | None
    error: PartError | None = None


@dataclass(frozen=True, slots=True)
class FrameSteps(Generic[Item]):
    """What becomes of a frame.

    Attributes:
        ready: Converts a frame, on the thread that rendered it.
        take: Takes a converted frame.
        workers: How many threads take frames.
        again: Reads frames that an earlier run has kept, by their indices.
        without: Makes the item of a frame that failed; None: there is none.
    """

    ready: Callable[[int, Picture], Item]
    take: Callable[[Item], None]
    workers: int = 1
    again: Mapping[int, Callable[[int], Item]] = field(default_factory=dict)
    without: Callable[[int], Item] | None = None


@dataclass(slots=True)
class FrameRendering:
    """Renders the frames of a sequence.

    Attributes:
        moving: The animated picture.
        timing: The times of its frames.
        progress: Called with the finished frames, all frames, and the kind of work.
        tell: Called with a line of text.
        stop: Ends the work on frames.
        failed: Why frames failed, by their indices.
        rendered: The frames that were rendered.
        has_begun: Whether ``render`` was called.
    """

    moving: MovingPicture
    timing: Timing
    progress: FrameProgress
    tell: Tell
    stop: threading.Event
    failed: dict[int, PartError] = field(default_factory=dict)
    rendered: set[int] = field(default_factory=set)
    has_begun: bool = False

    def render(
        self, wanted: Iterable[int], way: FrameSteps[Item], at_once: int | None = None
    ) -> None:
        """Render frames and convert them, while other threads take them.

        Args:
            wanted: The indices of the frames.
            way: What becomes of each.
            at_once: How many are rendered at the same time; None: as suits the picture.

        Raises:
            DeviceError: Many frames in a row failed.
        """
        indices, kept = list(wanted), way.again
        count = self.timing.count
        done = count - len(indices) - len(self.failed.keys() - set(indices))
        if (done or kept) and not self.has_begun:
            self.tell(f"continues: {done + len(kept)} of {count} frames are there")
        self.has_begun = True

        def made(some: Sequence[int]) -> list[MadeFrame[Item]]:
            moments = [(index, self.timing.time(index)) for index in some if index not in kept]
            pictures = iter(self.moving.pictures(moments) if moments else ())
            return [self._made(i, None if i in kept else next(pictures), way) for i in some]

        several = at_once or self.moving.at_once
        groups = self._groups(indices, alone=at_once == 1)
        in_a_row = 0
        with (
            taking(way.take, way.workers) as taker,
            closing(made_ahead(made, groups, several, self.stop.set)) as frames,
        ):
            for frame in itertools.chain.from_iterable(frames):
                if frame.item is not None:
                    taker.put(frame.item)
                if frame.error is None:
                    done, in_a_row = done + 1, 0
                    self._note(frame.index, is_new=frame.index not in kept)
                    self.progress(done, count, "rendering")
                    continue
                self.failed[frame.index] = frame.error
                in_a_row += 1
                if in_a_row == _MOST_IN_A_ROW < len(indices):
                    raise self.error(f"the last {in_a_row} in a row, so the others were not tried")

    def _groups(self, indices: Sequence[int], *, alone: bool) -> Iterator[Sequence[int]]:
        """Divide frames into those that are rendered together, as much as is known by then."""
        first = 0
        while first < len(indices):
            count = 1 if alone else self.moving.together(len(indices) - first)
            yield indices[first : first + count]
            first += count

    def _made(
        self, index: int, picture: Picture | PartError | None, way: FrameSteps[Item]
    ) -> MadeFrame[Item]:
        """Convert a frame; None is one that is kept."""
        if picture is None:
            return MadeFrame(index, way.again[index](index))
        if isinstance(picture, PartError):
            return MadeFrame(index, None if way.without is None else way.without(index), picture)
        if index == 0:
            self.moving.warn_of_light(picture, self.timing.time(index))
        return MadeFrame(index, way.ready(index, picture))

    def _note(self, index: int, *, is_new: bool) -> None:
        self.failed.pop(index, None)
        if is_new:
            self.rendered.add(index)

    def repeat(self, way: FrameSteps[Item]) -> None:
        """Render failed frames again, one at a time, if others may have been the reason.

        If several fail again, they are tried in the other order: workers that one frame has ended
        may be on their way back when the next one begins.
        """
        for order in (1, -1):
            again = sorted(index for index, error in self.failed.items() if error.shared)[::order]
            if again and (order == 1 or len(again) > 1):
                self.render(again, way, at_once=1)

    def check(self) -> None:
        """Name the frames that failed.

        Raises:
            DeviceError: There are some.
        """
        if self.failed:
            raise self.error("the other frames are kept: the same command renders only what failed")

    def error(self, more: str) -> DeviceError:
        """Return the error that names the failed frames."""
        failed = sorted(self.failed.items())
        named = [f"{i} at {self.timing.time(i):g} s" for i, _ in failed]
        if len(failed) <= _MOST_EXPLAINED:
            each = zip(named, failed, strict=True)
            reasons = ", ".join(f"frame {name} {error.reason}" for name, (_, error) in each)
            return DeviceError(f"{reasons}; {more}")
        return DeviceError(
            f"{len(named)} of {self.timing.count} frames failed: {listed(named)}; the first "
            f"{failed[0][1].reason}; {more}"
        )


def listed(names: Sequence[str], separator: str = ", ") -> str:
    """Return names as one text, the last ones as their number if there are many."""
    more = len(names) - _MOST_NAMED
    return separator.join(names[:_MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
