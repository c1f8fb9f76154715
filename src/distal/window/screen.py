"""Open a native window with a device of wgpu to draw on it, or report in one line why it failed.

Input: a size, the name of a device. Output: canvas, surface, renderer. The only module that uses
glfw.
"""

from __future__ import annotations

import os
import re
import sys
import warnings
from typing import Any, Final

import glfw
from rendercanvas.glfw import RenderCanvas  # type: ignore[import-untyped, unused-ignore]

from distal.devices.adapters import NO_SOCKETS, adapters, chosen, opened, wgpu_module
from distal.diagnostics import DeviceError
from distal.packages import loading
from distal.window.frame_renderers import FrameRenderer, PixelRenderer, TextureRenderer
from distal.window.surface import WindowSurface

_NO_WINDOW: Final = "no window can be opened here"
_MEND: Final = "install the GPU's driver, or in software: apt-get install mesa-vulkan-drivers"
LARGEST_SIDE: Final = 8192


def check_display() -> None:
    """Raise an error on a machine without a display, before any work is done.

    Raises:
        DeviceError: There is no display.
    """
    if sys.platform.startswith("linux") and not (
        os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    ):
        raise DeviceError(f"{_NO_WINDOW}: no display (DISPLAY is not set)")
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with loading("glfw"):
            ready = glfw.init()
    if not ready:
        reason = _words_of_glfw(str(said[-1].message)) if said else "the display does not answer"
        raise DeviceError(f"{_NO_WINDOW}: {reason}")


def _words_of_glfw(message: str) -> str:
    """Return the message of a glfw error like "(65550) b'X11: …'", without its number."""
    found = re.fullmatch(r"\(\d+\) b?(['\"])(.*)\1", message)
    return found[2] if found else message


def open_canvas(size: tuple[int, int], title: str) -> Any:
    """Open a window with a size in its own units."""
    return RenderCanvas(
        size=size, title=title, update_mode="ondemand", max_fps=60, present_method="screen"
    )


def open_surface(canvas: Any, device: str) -> tuple[WindowSurface, FrameRenderer]:
    """Return the surface of a canvas and the renderer for its frames.

    Raises:
        DeviceError: There is no adapter, or it cannot draw on this window.
    """
    # Checked first: without any driver, wgpu does not raise for a window but ends the process.
    if not adapters():
        raise DeviceError(f"{_NO_WINDOW}: no graphics driver; {_MEND}")
    if device.startswith("gpu"):
        return _on_gpu(canvas, device)
    return WindowSurface(canvas, _any_device(canvas)), PixelRenderer(device)


def _on_gpu(canvas: Any, device: str) -> tuple[WindowSurface, FrameRenderer]:
    adapter = device.partition(":")[2] or None
    gpu = opened(chosen(adapter))
    name = f"gpu-fragment:{adapter}" if adapter else "gpu-fragment"
    try:
        return WindowSurface(canvas, gpu.device), TextureRenderer(name, gpu.device, adapter)
    except (RuntimeError, ValueError, wgpu_module().GPUError) as error:
        raise DeviceError(
            f"{_NO_WINDOW}: {gpu.adapter.name} cannot draw on it ({_first_line(error)});"
            " another with --adapter, or --device cpu"
        ) from error


def _any_device(canvas: Any) -> Any:
    """Return any device that can draw on the window; it is only used to show finished frames."""
    wgpu = wgpu_module()
    # Without this variable Mesa prints a warning; glfw has already found its display.
    os.environ.setdefault("XDG_RUNTIME_DIR", NO_SOCKETS)
    try:
        adapter = wgpu.gpu.request_adapter_sync(canvas=canvas)
        if adapter is None:
            raise RuntimeError("none was found")
        return adapter.request_device_sync()
    except (RuntimeError, wgpu.GPUError) as error:
        raise DeviceError(
            f"{_NO_WINDOW}: no graphics driver draws on it ({_first_line(error)}); {_MEND}"
        ) from error


def _first_line(error: BaseException) -> str:
    return (str(error).splitlines() or [type(error).__name__])[0]


def set_full_screen(canvas: Any, back_to: tuple[int, ...] | None) -> tuple[int, ...] | None:
    """Fill the screen, or restore the former position and size; return what to restore later."""
    window = canvas._window  # rendercanvas has no public access to this
    if back_to is not None:
        glfw.set_window_monitor(window, None, *back_to, 0)  # type: ignore[arg-type, call-arg, unused-ignore]
        return None
    monitor = glfw.get_primary_monitor()
    if not monitor:
        return None
    mode = glfw.get_video_mode(monitor)
    place = (*glfw.get_window_pos(window), *glfw.get_window_size(window))
    width, height = mode.size
    glfw.set_window_monitor(window, monitor, 0, 0, width, height, mode.refresh_rate)
    return place


def copy_text(canvas: Any, text: str) -> None:
    """Put a text on the clipboard."""
    glfw.set_clipboard_string(canvas._window, text)
