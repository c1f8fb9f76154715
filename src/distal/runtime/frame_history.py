"""Earlier frames of a picture that reads them: its buffers, and its own last picture.

Input: a picture, and a function that renders an image once. Output: the texels that the picture
reads in one frame. Frames are computed in order, from the first one or from one that is kept.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from distal.forking import new_lock
from distal.lang.functions import Image
from distal.lang.live_textures import Keyboard, LastFrame, LiveTexture, SoundFile
from distal.lang.render_options import RenderOptions
from distal.runtime.images_read import ImagesRead
from distal.sounds.analysis import texels_at

# Frames whose texels are kept. One of 1920x1080 has 33 MB for each buffer.
_FRAMES_KEPT: Final = 2

Texels: TypeAlias = "NDArray[np.float32]"
# Renders an image with these texels for its frame: (height, width, 4), top row first.
Render: TypeAlias = Callable[[Image, Mapping[Image, Texels], RenderOptions], Texels]


@dataclass(slots=True)
class FrameHistory:
    """The latest frames of one picture.

    Attributes:
        frames: The texels that frames read, by their index: of buffers those of the frame itself,
            of the picture those of the frame before.
    """

    frames: OrderedDict[int, dict[Image, Texels]] = field(default_factory=OrderedDict)
    lock: Any = field(default_factory=new_lock)

    def at(self, read: ImagesRead, options: RenderOptions, render: Render) -> dict[Image, Texels]:
        """Return the texels that the picture reads in the frame ``options.index``.

        Raises:
            Cancelled: ``options.cancel`` stopped the work; finished frames are kept.
        """
        index = max(options.index or 0, 0)
        with self.lock:
            if index not in self.frames:
                earlier = [i for i in self.frames if i < index]
                first = max(earlier) + 1 if earlier else 0
                if not earlier:
                    self.frames.clear()
                for i in range(first, index + 1):
                    self._add(read, _of_frame(options, i, index), render)
                    if options.progress is not None:
                        options.progress((i - first) / (index - first + 1))
            return self.frames[index]

    def _add(self, read: ImagesRead, options: RenderOptions, render: Render) -> None:
        index = options.index or 0
        last = self.frames.get(index - 1)
        width, height = options.size
        if last is None:
            blank = np.zeros((height, width, 4), np.float32)
            texels: dict[Image, Texels] = dict.fromkeys(read.all, blank)
        else:
            texels = dict(last)
            if read.itself is not None:
                before = _of_frame(options, index - 1, index)
                texels[read.itself] = _upward(render(read.itself, last, before))
        for image in read.buffers:
            texels[image] = _upward(render(image, texels, options))
        self.frames[index] = texels
        while len(self.frames) > _FRAMES_KEPT:
            self.frames.popitem(last=False)


@dataclass(slots=True)
class LiveFrames(FrameHistory):
    """The frames of a host that shows one after the other, as many as it can.

    A later time is the next frame; an earlier one, or another size, begins again at frame 0.
    """

    index: int = -1
    time: float = 0.0
    size: tuple[int, int] = (0, 0)

    def numbered(self, options: RenderOptions, *, keeps: bool) -> RenderOptions:
        """Return the options with the number of the frame, and the seconds since the last one.

        Args:
            options: The options of the picture.
            keeps: Whether frames are kept; a frame that was broken off keeps its number.
        """
        with self.lock:
            if options.size != self.size or options.time < self.time:
                self.frames.clear()
                self.size, self.index = options.size, -1
            delta = options.delta
            is_drawn = self.index < 0 or self.index in self.frames or not keeps
            if is_drawn and (self.index < 0 or options.time > self.time):
                delta = delta if self.index < 0 else options.time - self.time
                self.index, self.time = self.index + 1, options.time
            return replace(options, index=self.index, delta=delta)


def _of_frame(options: RenderOptions, index: int, last: int) -> RenderOptions:
    """Return the options of an earlier frame."""
    seconds = max(options.time - (last - index) * options.delta, 0.0)
    seconds = options.time if index == last else seconds
    return replace(options, index=index, time=seconds, progress=None, samples=None)


def _upward(pixels: Texels) -> Texels:
    """Return a picture as texels, whose first row is the lowest."""
    return np.ascontiguousarray(pixels[::-1])


def frames_until(options: RenderOptions) -> int:
    """Return the index of the frame that a picture at ``options.time`` is."""
    if options.index is not None:
        return options.index
    return max(0, round(options.time / options.delta))


def key_of(read: ImagesRead, options: RenderOptions) -> tuple[Any, ...]:
    """Return what all frames of one history have in common, if each has the same values."""
    origin = options.time - (options.index or 0) * options.delta
    values = tuple(sorted((name, repr(value)) for name, value in options.params.items()))
    others = (options.mouse, options.buttons, options.keys, options.seed, options.date)
    place = (options.size, options.device, options.delta, round(origin, 6))
    return (read.all, values, others, place)


def live_texels(
    resources: Mapping[str, Any], texels: Mapping[Image, Texels], options: RenderOptions
) -> dict[str, Any]:
    """Return the texels of the textures that change with each frame, by name.

    Args:
        resources: What a picture reads, by name.
        texels: Earlier frames.
        options: The keyboard, and the time at which sounds are heard.

    Raises:
        LoadError: The file of a sound cannot be read.
    """
    found: dict[str, Any] = {}
    for name, source in resources.items():
        if isinstance(source, LastFrame):
            found[name] = texels[source.image]
        elif isinstance(source, Keyboard):
            found[name] = np.asarray(options.keys.rows(), np.float32)
        elif isinstance(source, SoundFile):
            found[name] = texels_at(source, options.time)
        elif isinstance(source, LiveTexture):
            found[name] = np.asarray(source.data, np.float32)[::-1]
    return found
