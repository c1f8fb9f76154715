"""Render frames: on the CPU as pixels, on a GPU as a texture that stays there.

Input: a viewable object, a ``Shot``, a size. Output: a ``RenderedFrame`` of display values. Runs in
the worker's thread; does not depend on windows.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Cancelled
from distal.images.png import quantise
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.render.film import SAMPLES
from distal.runtime.executor import DrawTarget
from distal.runtime.frame_history import LiveFrames
from distal.scene.view_ranges import with_range
from distal.window.shot import Shot

if TYPE_CHECKING:
    from distal.images.picture import Picture
    from distal.scene.viewing.viewable import Viewable

# Stores display values unchanged. For a surface that encodes, ``surface`` reads them decoded.
TEXTURE_FORMAT: Final = "rgba8unorm"
_SMALLEST: Final = (8, 8)


@dataclass(frozen=True, slots=True, eq=False)
class RenderedFrame:
    """A frame of display values.

    Attributes:
        pixels: uint8, (height, width, 4), top row first; None if the frame is a texture.
        texture: A texture of wgpu; None if the frame is pixels.
        seconds: The rendering time without compilation.
        share: The fraction that was rendered; below 1 it was cancelled, and there is no picture.
        samples: The samples of each pixel of a picture by paths; 0 for other pictures.
        rate: How many of them are rendered in a second.
    """

    pixels: NDArray[np.uint8] | None = None
    texture: Any = None
    seconds: float = 0.0
    share: float = 1.0
    samples: int = 0
    rate: float = 0.0


class FrameRenderer(Protocol):
    """Renders frames on one device.

    Attributes:
        device: Its name, as for ``render``.
        history: The frames that it has shown of a picture that reads earlier ones.
        samples: The samples in a pixel of the first frame of a still, and of the finer ones that
            follow it where a view has several samples (``Viewable.is_sampled``); None: adaptive.
    """

    device: str
    history: LiveHistory
    samples: tuple[int | None, ...]

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        """Compile what a shot needs, so that errors are found before anything is replaced."""
        ...

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        samples: int | None = 1,
    ) -> RenderedFrame:
        """Render a frame.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early.
            samples: One of ``samples``.

        Raises:
            CompileError: The scene code has mistakes.
            DeviceError: The device was lost.
        """
        ...


def render_options(
    shot: Shot, size: tuple[int, int], device: str, *, samples: int | None = 1
) -> RenderOptions:
    """Return the options for rendering a shot.

    Args:
        shot: Time, parameters, view and camera.
        size: Width and height in pixels.
        device: The device that renders.
        samples: Samples in each pixel; None: adaptive for a scene's colors, else one.
    """
    return RenderOptions(
        size=size,
        time=shot.time,
        params=dict(shot.parameters),
        mouse=shot.mouse.pixels(size),
        index=shot.index,
        keys=shot.keys,
        buttons=shot.buttons,
        samples=samples,
        device=device,
    )


class LiveHistory:
    """The frames that a window has shown of one object."""

    def __init__(self) -> None:
        self._viewable: Viewable | None = None
        self._frames = LiveFrames()

    def added(self, viewable: Viewable, options: RenderOptions) -> RenderOptions:
        """Return the options with the frames that an object reads; unchanged for most objects."""
        if not viewable.keeps_frames:
            return options
        if self._viewable is not viewable:
            self._viewable, self._frames = viewable, LiveFrames()
        return replace(options, history=self._frames, date=_date())


def first_frame(viewable: Viewable, options: RenderOptions) -> RenderOptions:
    """Return the options for compiling, which draw no earlier frames."""
    return replace(options, index=0) if viewable.keeps_frames else options


def _date() -> tuple[float, float, float, float]:
    """Return ``frame.date``."""
    now = datetime.now()
    midnight = now.replace(hour=0, minute=0, second=0, microsecond=0)
    return (float(now.year), now.month - 1.0, float(now.day), (now - midnight).total_seconds())


def picture(viewable: Viewable, shot: Shot, options: RenderOptions) -> Picture:
    """Render a shot as a picture with complete metadata.

    Args:
        viewable: The object to show.
        shot: Time, parameters, view and camera.
        options: The options for rendering, of ``render_options``.
    """
    shown = replace(options, view=shot.view, steering=shot.steering, section=shot.section)
    return viewable.render(shown)


class PixelRenderer:
    """Renders pixels by direct light, on any device that renders to memory."""

    samples: tuple[int | None, ...] = (1, None)

    def __init__(self, device: str) -> None:
        self.device = device
        self.history = LiveHistory()

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        """Compile what a shot needs."""
        direct = viewable.in_mode("direct")
        options = render_options(shot, _SMALLEST, self.device)
        picture(direct, shot, first_frame(viewable, options))

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        samples: int | None = 1,
    ) -> RenderedFrame:
        """Render a frame; if cancelled, return the finished fraction and the time.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early.
            samples: One of ``samples``.
        """
        done = 0.0
        begin = time.perf_counter()

        def progress(share: float) -> None:
            nonlocal done, begin
            if done == 0.0 and share == 0.0:
                begin = time.perf_counter()
            done = share

        options = render_options(shot, size, self.device, samples=samples)
        try:
            options = replace(options, cancel=cancel, progress=progress)
            options = self.history.added(viewable, options)
            made = picture(viewable.in_mode("direct"), shot, options)
        except Cancelled:
            return RenderedFrame(seconds=time.perf_counter() - begin, share=min(done, 0.999))
        begin = time.perf_counter()
        pixels = quantise(made.array)
        quantised = time.perf_counter() - begin
        return RenderedFrame(pixels, seconds=made.stats["render_s"] + quantised)


class TextureRenderer:
    """Draws into textures of a GPU, by its fragment path.

    One program takes any number of samples, so that nothing is compiled when a picture is refined.
    """

    samples: tuple[int | None, ...] = (1, 4, 16)

    def __init__(self, device: str, gpu: Any, adapter: str | None) -> None:
        """Make a renderer.

        Args:
            device: The name of the device, as for ``render``.
            gpu: The device of wgpu that the executor draws with.
            adapter: The adapter of the device; None for the best one.
        """
        self.device = device
        self._gpu = gpu
        self._adapter = adapter
        self.history = LiveHistory()
        self._ready: tuple[Viewable | None, set[tuple[str, bool]]] = (None, set())
        self._finished: Any = None  # the texture of the last finished frame
        self._spare: Any = None  # the texture that the next frame is drawn into

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        """Compile what a shot needs, by drawing a few pixels of it."""
        known, views = self._ready
        program = (shot.view, shot.section is not None)
        if known is viewable and program in views:
            return
        options = first_frame(viewable, render_options(shot, _SMALLEST, self.device))
        self._draw(viewable, shot, self._texture(_SMALLEST), options)
        self._ready = (viewable, {program, *(views if known is viewable else ())})

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        samples: int | None = 1,
    ) -> RenderedFrame:
        """Render a frame; if cancelled, return the finished fraction and the time.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early, after the part that the GPU draws.
            samples: One of ``samples``; has no effect where a view has one sample.
        """
        self.prepare(viewable, shot)
        done = 0.0

        def progress(share: float) -> None:
            nonlocal done
            done = share

        if self._spare is None or self._spare.size[:2] != size:
            self._spare = self._texture(size)
        options = render_options(shot, size, self.device, samples=samples)
        options = self.history.added(viewable, options)
        begin = time.perf_counter()
        try:
            self._draw(
                viewable, shot, self._spare, replace(options, cancel=cancel, progress=progress)
            )
        except Cancelled:
            return RenderedFrame(seconds=time.perf_counter() - begin, share=min(done, 0.999))
        # The window shows the finished texture until the next frame is finished in the other one.
        self._spare, self._finished = self._finished, self._spare
        return RenderedFrame(texture=self._finished, seconds=time.perf_counter() - begin)

    def _draw(self, viewable: Viewable, shot: Shot, texture: Any, options: RenderOptions) -> None:
        viewable = viewable.shown_with(shot.section)
        is_steered, is_sampled = shot.steering is not None, viewable.is_sampled(shot.view)
        image = viewable.image(shot.view, steered=is_steered, encoded=True, sampled=is_sampled)
        settings = viewable.settings(shot.steering, shot.section) if shot.steering else {}
        if is_sampled:
            settings = {**settings, SAMPLES: options.samples}
        target = DrawTarget(texture.create_view(), TEXTURE_FORMAT, self._adapter)
        executor().draw(image, target, with_range(image, replace(options, settings=settings)))

    def _texture(self, size: tuple[int, int]) -> Any:
        return self._gpu.create_texture(
            size=(*size, 1),
            format=TEXTURE_FORMAT,
            usage="RENDER_ATTACHMENT|TEXTURE_BINDING|COPY_SRC",
        )
