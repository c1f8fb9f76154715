"""Opens a window on a scene and keeps it until it is closed.

Input: what ``distal.load`` gave and where it came from, a device. Output: an exit
code.
"""

from __future__ import annotations

import signal
import time
from typing import Any, Final

from distal.lang.render_options import RenderOptions
from distal.loading import loaded_from
from distal.scene.viewing.viewable import viewable
from distal.window.app import Application, SceneSource
from distal.window.screen import check_display, open_canvas, open_surface
from distal.window.session import Session

# How long the end of a running compilation is waited for.
_PATIENCE_S: Final = 0.5


def view(
    obj: Any,
    path: str,
    name: str | None,
    options: RenderOptions,
    *,
    first_view: str = "color",
    scale: float = 1.0,
    paused: bool = False,
) -> tuple[int, bool]:
    """Show what was loaded until the window is closed.

    Args:
        obj: What ``distal.load(path, name)`` gave.
        path: Where it came from, to load it again when it is saved.
        name: Which object of the file.
        options: Size (the window's, in its own units), first time, parameters, and device, where
            "auto" is resolved already.
        first_view: The view to begin with.
        scale: Pixels that are rendered for each of the window's, along a side.
        paused: Whether the time is paused at first.

    Returns:
        The exit code, 0 or 130, and whether everything has ended: what is still being compiled
        cannot be stopped, and the process should end without waiting for it.

    Raises:
        CompileError, LoadError: It cannot be shown.
        DeviceError: No window can be opened here, or the device is missing.
        ValueError: There is no such view.
    """
    check_display()
    known = loaded_from(obj)
    origin = SceneSource(path, name, known.files if known is not None else ())
    shown = viewable(obj, options.params, options.time)
    if first_view not in shown.views:
        raise ValueError(f"there is no view '{first_view:.40}'; views: {', '.join(shown.views)}")
    canvas = open_canvas(options.size, f"{origin.title} - distal")
    try:
        surface, maker = open_surface(canvas, options.device)
        session = Session(
            shown,
            time=options.time,
            values=options.params,
            view=first_view,
            paused=paused,
            now=time.monotonic(),
        )
        loop = canvas._rc_canvas_group.get_loop()
        application = Application(session, origin, maker, canvas, surface, loop, scale=scale)
        interrupted = _run(application, canvas, loop)
    finally:
        canvas.close()
    ended = application.stop(_PATIENCE_S)
    return (130 if interrupted else 0), ended


def _run(application: Application, canvas: Any, loop: Any) -> bool:
    """Run until the window is closed; whether that was ctrl-C."""
    interrupted = False

    def interrupt(_signal: int, _frame: object) -> None:
        nonlocal interrupted
        if interrupted:  # a second ctrl-C: something does not end
            raise KeyboardInterrupt
        interrupted = True
        # Not closed here: this may be in the middle of drawing on it.
        loop.call_soon_threadsafe(canvas.close)

    def begin() -> None:
        # The loop has set its own by now, which would report it on the terminal.
        signal.signal(signal.SIGINT, interrupt)
        application.start()

    before = signal.getsignal(signal.SIGINT)
    loop.call_soon(begin)
    try:
        loop.run()
    finally:
        signal.signal(signal.SIGINT, before)
    return interrupted
