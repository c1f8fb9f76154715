"""Open a window on a scene and run it until it is closed.

Input: an object from ``distal.load`` and its file, a device. Output: an exit code.
"""

from __future__ import annotations

import signal
import time
from typing import Any, Final

from distal.interrupting import INTERRUPTED
from distal.lang.render_options import RenderOptions
from distal.loading import loaded_from
from distal.scene.viewing.viewable import viewable
from distal.window.app import Application, SceneSource
from distal.window.screen import check_display, open_canvas, open_surface
from distal.window.session import Session

# How long to wait for a running compilation at the end, in seconds.
_PATIENCE_S: Final = 0.5


def view(
    obj: Any,
    path: str,
    name: str | None,
    options: RenderOptions,
    *,
    scale: float = 1.0,
    paused: bool = False,
    look: str | None = None,
    unit: str = "mm",
) -> tuple[int, bool]:
    """Show a loaded object until the window is closed.

    Args:
        obj: The result of ``distal.load(path, name)``.
        path: Its path, for reloading it.
        name: The name of the object in the file; None for the default.
        options: Size (of the window, in its own units), initial time, parameters, view and mode,
            and device, where "auto" is already resolved.
        scale: Rendered pixels per pixel of the window, along each side.
        paused: Whether the time is paused at the start.
        look: The name of a look to show it in; None for its own.
        unit: The length of one scene unit, which the ruler names.

    Returns:
        The exit code, 0 or 130, and whether all threads have ended: a running compilation cannot
        be stopped, and the process should exit without waiting for it.

    Raises:
        CompileError, LoadError: The object cannot be shown.
        DeviceError: No window can be opened, or the device is missing.
        ValueError: There is no such view.
    """
    check_display()
    known = loaded_from(obj)
    files, since_ns = ((), None) if known is None else (known.files, known.began_ns)
    origin = SceneSource(path, name, files, look, options.caustics, since_ns)
    shown = viewable(obj, options.params, options.time, look)
    shown = shown.in_mode(None, caustics=options.caustics)
    shown.in_mode(options.mode)  # raises if it has no such mode
    if options.view not in shown.views:
        raise ValueError(f"there is no view '{options.view:.40}'; views: {', '.join(shown.views)}")
    canvas = open_canvas(options.size, f"{origin.title} - distal")
    try:
        surface, maker = open_surface(canvas, options.device)
        session = Session(
            shown,
            time=options.time,
            values=options.params,
            view=options.view,
            paused=paused,
            guided=True,
            mode=options.mode,
            now=time.monotonic(),
            unit=unit,
        )
        loop = canvas._rc_canvas_group.get_loop()
        application = Application(session, origin, maker, canvas, surface, loop, scale=scale)
        interrupted = _run(application, canvas, loop)
    finally:
        canvas.close()
    ended = application.stop(_PATIENCE_S) and not (
        session.camera.is_preparing or session.ruler.is_preparing
    )
    return (INTERRUPTED if interrupted else 0), ended


def _run(application: Application, canvas: Any, loop: Any) -> bool:
    """Run the event loop until the window is closed; return whether ctrl-C closed it."""
    interrupted = False

    def interrupt(_signal: int, _frame: object) -> None:
        nonlocal interrupted
        if interrupted:  # a second ctrl-C: closing the window did not work
            raise KeyboardInterrupt
        interrupted = True
        # Not closed here, because the signal may arrive while the canvas is being drawn.
        loop.call_soon_threadsafe(canvas.close)

    def begin() -> None:
        # Replaces the handler that the loop has just set, which would print a message.
        signal.signal(signal.SIGINT, interrupt)
        application.start()

    before = signal.getsignal(signal.SIGINT)
    loop.call_soon(begin)
    try:
        loop.run()
    finally:
        signal.signal(signal.SIGINT, before)
    return interrupted
