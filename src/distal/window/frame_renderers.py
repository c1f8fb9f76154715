"""Render frames: on the CPU as pixels, on a GPU as a texture that stays there.

Input: a viewable object, a ``Shot``, a size. Output: a ``RenderedFrame`` of display values. Runs in
the worker's thread; does not depend on windows.
"""

from __future__ import annotations

import threading
import time
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from distal.devices.base import Cancelled
from distal.images.png import quantise
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime.executor import DrawTarget
from distal.scene.view_ranges import with_range
from distal.window.session import Shot

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
    """

    pixels: NDArray[np.uint8] | None = None
    texture: Any = None
    seconds: float = 0.0
    share: float = 1.0


class FrameRenderer(Protocol):
    """Renders frames on one device.

    Attributes:
        device: Its name, as for ``render``.
        refines: Whether it can make edges smooth.
    """

    device: str
    refines: bool

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
        is_refined: bool = False,
    ) -> RenderedFrame:
        """Render a frame.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early.
            is_refined: Whether edges are smooth: several samples where pixels differ.

        Raises:
            CompileError: The scene code has mistakes.
            DeviceError: The device was lost.
        """
        ...


def render_options(
    shot: Shot, size: tuple[int, int], device: str, *, is_refined: bool = False
) -> RenderOptions:
    """Return the options for rendering a shot.

    Args:
        shot: Time, parameters, view and camera.
        size: Width and height in pixels.
        device: The device that renders.
        is_refined: Whether edges are smooth: several samples where pixels differ.
    """
    return RenderOptions(
        size=size,
        time=shot.time,
        params=dict(shot.parameters),
        mouse=shot.mouse.pixels(size),
        index=shot.index,
        samples=None if is_refined else 1,
        device=device,
    )


def picture(viewable: Viewable, shot: Shot, options: RenderOptions) -> Picture:
    """Render a shot as a picture with complete metadata.

    Args:
        viewable: The object to show.
        shot: Time, parameters, view and camera.
        options: The options for rendering, of ``render_options``.
    """
    return viewable.render(options, view=shot.view, steering=shot.steering)


class PixelRenderer:
    """Renders pixels, on any device that renders to memory."""

    refines = True

    def __init__(self, device: str) -> None:
        self.device = device

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        """Compile what a shot needs."""
        picture(viewable, shot, render_options(shot, _SMALLEST, self.device))

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        is_refined: bool = False,
    ) -> RenderedFrame:
        """Render a frame; if cancelled, return the finished fraction and the time.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Set to stop the rendering early.
            is_refined: Whether edges are smooth: several samples where pixels differ.
        """
        done = 0.0
        begin = time.perf_counter()

        def progress(share: float) -> None:
            nonlocal done, begin
            if done == 0.0 and share == 0.0:
                begin = time.perf_counter()
            done = share

        options = render_options(shot, size, self.device, is_refined=is_refined)
        try:
            made = picture(viewable, shot, replace(options, cancel=cancel, progress=progress))
        except Cancelled:
            return RenderedFrame(seconds=time.perf_counter() - begin, share=min(done, 0.999))
        begin = time.perf_counter()
        pixels = quantise(made.array)
        quantised = time.perf_counter() - begin
        return RenderedFrame(pixels, seconds=made.stats["render_s"] + quantised)


class TextureRenderer:
    """Draws into textures of a GPU, by its fragment path."""

    refines = False

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
        self._ready: tuple[Viewable | None, set[str]] = (None, set())
        self._textures: list[Any] = []
        self._texel: Any = None

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        """Compile what a shot needs, by drawing a few pixels of it."""
        known, views = self._ready
        if known is viewable and shot.view in views:
            return
        self._draw(viewable, shot, self._texture(_SMALLEST), _SMALLEST)
        self._ready = (viewable, {shot.view, *(views if known is viewable else ())})

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        is_refined: bool = False,
    ) -> RenderedFrame:
        """Render a frame.

        Args:
            viewable: The object to show.
            shot: Time, parameters, view and camera.
            size: Width and height in pixels.
            cancel: Has no effect, because a GPU finishes what it has begun.
            is_refined: Has no effect: this path draws one sample a pixel.
        """
        self.prepare(viewable, shot)
        # Two textures are enough: the window shows one while the other is drawn.
        texture = self._textures.pop(0) if len(self._textures) > 1 else None
        if texture is None or texture.size[:2] != size:
            texture = self._texture(size)
        self._textures.append(texture)
        begin = time.perf_counter()
        self._draw(viewable, shot, texture, size)
        return RenderedFrame(texture=texture, seconds=time.perf_counter() - begin)

    def _draw(self, viewable: Viewable, shot: Shot, texture: Any, size: tuple[int, int]) -> None:
        settings = viewable.settings(shot.steering) if shot.steering else {}
        image = viewable.image(shot.view, steered=shot.steering is not None, encoded=True)
        options = replace(render_options(shot, size, self.device), settings=settings)
        target = DrawTarget(texture.create_view(), TEXTURE_FORMAT, self._adapter)
        executor().draw(image, target, with_range(image, options))
        self._wait_for(texture)

    def _wait_for(self, texture: Any) -> None:
        """Wait until a texture is drawn, so that frames do not queue up and timings are right.

        It reads one texel; in wgpu 0.32 for Python, waiting for the queue itself fails.
        """
        if self._texel is None:
            self._texel = self._gpu.create_buffer(size=256, usage="COPY_DST|MAP_READ")
        encoder = self._gpu.create_command_encoder()
        place = {"buffer": self._texel, "offset": 0, "bytes_per_row": 256, "rows_per_image": 1}
        encoder.copy_texture_to_buffer({"texture": texture}, place, (1, 1, 1))
        self._gpu.queue.submit([encoder.finish()])
        self._texel.map_async("READ").sync_wait()
        self._texel.unmap()

    def _texture(self, size: tuple[int, int]) -> Any:
        return self._gpu.create_texture(
            size=(*size, 1),
            format=TEXTURE_FORMAT,
            usage="RENDER_ATTACHMENT|TEXTURE_BINDING|COPY_SRC",
        )
