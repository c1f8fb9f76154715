"""The window: connects user input, rendered frames and the screen.

Input: events of a canvas, timers, finished jobs of the worker. Output: jobs for the worker,
drawings. The parts are in modules of their own; this module determines when each of them runs.
"""

from __future__ import annotations

import sys
import time
import traceback
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from distal.diagnostics import (
    CompileError,
    DeviceError,
    Diagnostic,
    LoadError,
    printable,
    printable_lines,
)
from distal.example_files import EXAMPLE_PREFIX
from distal.file_writer import SaveError
from distal.images.metadata import Ends
from distal.lang.number_text import shown as number_text
from distal.load_watch import LoadWatch
from distal.loading import file_of
from distal.saved_files import PERIOD_S, FileWatcher
from distal.scene.steering import STILL
from distal.scene.viewing.guide import point_text
from distal.scene.viewing.viewable import view_label
from distal.window.canvas_input import CanvasInput
from distal.window.frame_renderers import FrameRenderer, RenderedFrame, picture, render_options
from distal.window.frame_scheduler import FrameRequest, FrameScheduler
from distal.window.keys import Action
from distal.window.log import Log
from distal.window.overlay import Overlay
from distal.window.overlay_content import OverlayContent, overlay_content
from distal.window.panels import Panel, blended, clipped
from distal.window.reload import ReloadedScene, files_in, load_again
from distal.window.ruler_panels import ruler_panels
from distal.window.screen import copy_text, set_full_screen
from distal.window.screenshots import free_name
from distal.window.session import Session
from distal.window.worker import Done, Job, Worker

if TYPE_CHECKING:
    from distal.window.surface import WindowSurface

_NOTE_S: Final = 4.0
_FIGURES_S: Final = 0.25  # digits that change faster are not readable
_SLOW_S: Final = 0.4  # after this time a note says what the window waits for
_EXPECTED: Final = (CompileError, LoadError, DeviceError, SaveError, ValueError, TypeError)


@dataclass(frozen=True, slots=True)
class SceneSource:
    """The file of the scene, for reloading it.

    Attributes:
        path: The path for ``distal.load``.
        name: The name of the object in the file; None for the default.
        files: The file and the modules that it imported.
        look: The name of a look to show it in; None for its own.
        caustics: Whether photons find the caustics of paths.
        since_ns: When its loading began (``time.time_ns``): what was saved since then, while the
            window opened, is loaded again.
    """

    path: str
    name: str | None
    files: tuple[Path, ...]
    look: str | None = None
    caustics: bool = True
    since_ns: int | None = None

    @property
    def title(self) -> str:
        """The title of the window: the file's name, because most scenes are named "scene"."""
        stem = Path(self.path.removeprefix(EXAMPLE_PREFIX)).stem
        return printable(stem if self.name is None else f"{stem}:{self.name}")


class Application:
    """An open window."""

    def __init__(
        self,
        session: Session,
        source: SceneSource,
        renderer: FrameRenderer,
        canvas: Any,
        surface: WindowSurface,
        loop: Any,
        *,
        scale: float,
    ) -> None:
        self._session, self._source, self._canvas = session, source, canvas
        self._surface, self._loop, self._scale = surface, loop, scale
        self._log = Log()
        self._worker = Worker(loop.call_soon_threadsafe)
        self._scheduler = FrameScheduler(renderer, self._worker, self._finished, self._failed)
        self._overlay = Overlay()
        self._watch = FileWatcher(source.files, source.since_ns)
        self._has_begun = False
        self._loading: LoadWatch | None = None  # the file that is being loaded
        self._busy_since: float | None = None
        self._trouble_of_file = self._trouble_of_frame = ""
        self._last_report = ""
        self._note, self._note_until = "", 0.0
        self._status, self._status_at = "", float("-inf")
        self._shown_content: OverlayContent | None = None
        self._wake_at: float | None = None
        self._full_screen_from: tuple[int, ...] | None = None
        session.ruler.compile_aside(lambda: loop.call_soon_threadsafe(self.wake))
        CanvasInput(session, canvas, loop, self)

    # The loop

    def start(self) -> None:
        """Start the window; called when the event loop runs."""
        self._canvas.request_draw(self._draw)
        self._loop.call_later(PERIOD_S, self._look_at_files)
        self.resize()

    def stop(self, patience_s: float) -> bool:
        """Stop the worker; return whether it ended within ``patience_s`` seconds."""
        return self._worker.stop(patience_s)

    def wake(self) -> None:
        """Update everything once; called after every event."""
        if self._canvas.get_closed():
            return
        now = time.monotonic()
        self._wake_at = None
        shot = self._session.shot(now)
        moving = self._session.is_moving(now)
        again = self._scheduler.request_frame(
            self._session.viewable,
            shot,
            self._frame_size(),
            is_moving=moving or self._session.playing,
        )
        if again is not None:
            self._wake_in(again)
        if moving:
            self._wake_in(self._session.settles_in(now) or PERIOD_S)
        if self._note and now < self._note_until:
            self._wake_in(self._note_until - now)
        if self._waiting_note(now) is not None:
            self._wake_in(_SLOW_S)
        if self._content(now) != self._shown_content:
            self._canvas.request_draw()

    def _wake_in(self, seconds: float) -> None:
        at = time.monotonic() + seconds
        if self._wake_at is not None and self._wake_at <= at:
            return
        self._wake_at = at

        def wake() -> None:
            if self._wake_at == at:  # otherwise an earlier wake-up replaced this one
                self.wake()

        self._loop.call_later(max(seconds, 0.001), wake)

    def _frame_size(self) -> tuple[int, int]:
        width, height = self._canvas.get_physical_size()
        return max(round(width * self._scale), 1), max(round(height * self._scale), 1)

    def _draw(self) -> None:
        now = time.monotonic()
        self._shown_content = self._content(now)
        size, ratio = self._canvas.get_physical_size(), self._canvas.get_pixel_ratio()
        self._surface.draw(self._overlay.panels(self._shown_content, size, ratio))
        shown = self._scheduler.shown
        if shown is not None:
            is_final = self._scheduler.is_final(shown)
            facts = {**_facts(shown), "is_final": is_final}
            ruler, hint = self._shown_content.ruler, self._session.ruler.hint
            lines = [] if ruler is None else list(ruler.lines)
            self._log(
                "drawn", size=size, shown=facts, trouble=self._trouble, ruler=lines, hint=hint
            )

    # Frames

    def _finished(self, request: FrameRequest, made: RenderedFrame) -> None:
        if made.share == 1.0:
            if not self._has_begun:
                self._begin(request)
            self._trouble_of_frame = ""
            self._surface.show(made)
            if request.shot.mouse == self._session.mouse:
                self._session.frame_begun()
            if self._session.playing and request.shot.keys is self._session.keys:
                self._session.keys = self._session.keys.settled()
            self._log("frame", **_facts(request), ms=made.seconds * 1000)
            self._canvas.request_draw()
        self.wake()

    def _begin(self, request: FrameRequest) -> None:
        """Start the time with the first picture, and compile what guides the camera."""
        self._has_begun = True
        session, now = self._session, time.monotonic()
        if session.playing:
            session.clock.jump(request.shot.time, now)
        post = self._loop.call_soon_threadsafe
        session.camera.prepare(session.moment(now), lambda: post(self._guided))

    def _guided(self) -> None:
        self._log("guided")
        self.wake()

    def _failed(self, request: FrameRequest, error: BaseException) -> None:
        self._trouble_of_frame = self._report(error)
        self.wake()

    # Text over the picture

    @property
    def _trouble(self) -> str:
        return self._trouble_of_file or self._trouble_of_frame

    def _content(self, now: float) -> OverlayContent:
        note = self._note if now < self._note_until else self._waiting_note(now) or ""
        return overlay_content(
            self._session, now, status=self._figures(now), trouble=self._trouble, note=note
        )

    def _waiting_note(self, now: float) -> str | None:
        """Return what the window waits for: "" while it is still fast, None if it does not wait."""
        made, is_tracing = self._scheduler.made, self._scheduler.is_tracing
        is_counted = is_tracing and made is not None and made.samples > 0
        if not self._worker.waiting or is_counted:
            self._busy_since = None
            return None
        if self._busy_since is None:
            self._busy_since = now
        if self._is_loading:
            what = "loading the saved file …"
        elif self._scheduler.shown is None:
            what = "compiling …"
        elif is_tracing:
            what = "tracing paths …"
        elif self._scheduler.is_busy:
            what = "rendering …"
        else:
            what = "saving the picture …"
        return what if now - self._busy_since > _SLOW_S else ""

    def _figures(self, now: float) -> str:
        session, made, shown = self._session, self._scheduler.made, self._scheduler.shown
        words = [self._source.title, view_label(session.view)]
        if session.clock.speed != 1.0:
            words.append(f"{number_text(session.clock.speed)}x")
        if session.playing and now - self._status_at < _FIGURES_S and self._status:
            return self._status
        if made is not None and shown is not None:
            if session.playing or session.is_moving(now):
                words.append(f"{self._scheduler.frames_per_s:.0f} fps")
            words.append(f"{made.seconds * 1000:.1f} ms")
            words.append("{}x{}".format(*shown.pixels))
            if made.samples:
                words.append(f"{made.samples} samples  {made.rate:.{made.rate < 10:d}f}/s")
            elif shown.shot.mode == "path":
                words.append("direct light")
        words.append(self._scheduler.renderer.device)
        section = session.section(now)
        if section is not None:
            words.append(session.plane.text(section))
        place = session.camera.known_place(session.moment(now))
        if place is not None and session.steering != STILL and not session.playing:
            words.append(f"camera {point_text(place.position, place)}")
        words.append("H: help")
        self._status, self._status_at = "   ".join(words), now
        return self._status

    def _notify(self, text: str) -> None:
        self._note, self._note_until = text, time.monotonic() + _NOTE_S

    def _report(self, error: BaseException) -> str:
        """Return the text of an error; also print it on the terminal, once."""
        if isinstance(error, _EXPECTED):
            text = str(error)
        else:
            text = f"{type(error).__name__}: {error}"
            traceback.print_exception(error)  # a bug in distal
        if isinstance(error, LoadError | SaveError | DeviceError):
            text = f"error: {text}"
        text = printable_lines(text)
        if text != self._last_report:
            print(text, file=sys.stderr, flush=True)
            self._log("trouble", text=text)
        self._last_report = text
        return text

    # The scene's files

    def _look_at_files(self) -> None:
        if self._canvas.get_closed():
            return
        overdue = self._loading is not None and self._loading.is_overdue
        if (overdue or not self._is_loading) and self._watch.has_changed():
            if overdue:
                self._end_loading()
            self._load()
        self._loop.call_later(PERIOD_S, self._look_at_files)

    @property
    def _is_loading(self) -> bool:
        return self._loading is not None

    def _load(self) -> None:
        source, session = self._source, self._session
        shot, renderer = session.shot(time.monotonic()), self._scheduler.renderer
        post = self._loop.call_soon_threadsafe
        watch = LoadWatch(
            file_of(source.path), lambda found: post(lambda: self._hangs(watch, found))
        )
        self._loading = watch

        def job(_: object) -> ReloadedScene:
            return load_again(
                source.path, source.name, shot, renderer, watch, source.look, source.caustics
            )

        # A frame of what the file was before may never end either.
        self._worker.cancel()
        self._submit(job, self._loaded)
        self.wake()

    def _hangs(self, watch: LoadWatch, found: Diagnostic) -> None:
        """Show where the scene's file is after some seconds; the picture before it stays."""
        if watch is self._loading:
            text = printable_lines(found.text("warning"))
            self._trouble_of_file = text
            print(text, file=sys.stderr, flush=True)
            self._log("hangs", text=text)
            self._canvas.request_draw()
            self.wake()

    def _end_loading(self) -> None:
        """Give up a file that does not end; the thread that runs it is left alone if it must be."""
        assert self._loading is not None
        self._loading.interrupt()
        self._loading = None
        self._worker.abandon()

    def _submit(self, job: Job, done: Done) -> None:
        """Run a job, which does not wait for the refinement of a still."""
        self._worker.submit(job, done)
        self._scheduler.postpone_refinement()

    def _loaded(self, result: ReloadedScene | BaseException) -> None:
        self._loading = None
        if isinstance(result, BaseException):
            self._trouble_of_file = self._report(result)
            self._watch.watch([*self._source.files, *files_in(result, self._source.files[0])])
        else:
            self._trouble_of_file = self._trouble_of_frame = self._last_report = ""
            self._source = replace(self._source, files=result.files)
            self._watch.watch(result.files)
            self._session.adopt(result.viewable, time.monotonic(), animated=result.animated)
            self._log("loaded", files=[str(file) for file in result.files])
        self.wake()

    # Input

    def resize(self) -> None:
        """Take the new size of the canvas."""
        self._session.size = self._canvas.get_logical_size()
        self._canvas.request_draw()
        self.wake()

    def act(self, action: Action, *, shift: bool = False) -> None:
        """Perform the action of a key."""
        if action is Action.QUIT:
            self._canvas.close()
            return
        if action is Action.SCREENSHOT:
            self._save()
        elif action is Action.COPY_CAMERA:
            self._copy_camera()
        elif action is Action.FULL_SCREEN:
            self._toggle_full_screen()
        else:
            refusal = self._session.refusal(action)
            if refusal:
                self._notify(refusal)
                self._log("refused", text=refusal)
            self._session.act(action, time.monotonic(), shift=shift)
        self.wake()

    def _save(self) -> None:
        """Save the current picture at the size of a frame in the window."""
        session, size = self._session, self._frame_size()
        shot, viewable = session.shot(time.monotonic()), session.viewable
        renderer, title, film = self._scheduler.renderer, self._source.title, self._scheduler.film
        samples = renderer.samples[-1] if viewable.is_sampled(shot.view) else 1
        options = render_options(shot, size, renderer.device, samples=samples)
        panels, ends = self._ruler_of_picture(size)
        options = renderer.history.added(viewable, options)

        def job(_: object) -> Path:
            path = free_name(Path.cwd(), title, shot)
            if shot.mode == "path":
                made = film.picture(viewable, shot, size)
            else:
                made = picture(viewable.in_mode("direct"), shot, options)
            if ends:
                made = replace(made, array=blended(made.array, panels), light=None)
            made.with_provenance(ruler=ends).save(path)
            return path

        def done(result: Path | BaseException) -> None:
            if isinstance(result, BaseException):
                self._notify(self._report(result).splitlines()[0])
            else:
                self._notify(f"saved {result.name}{', with the ruler' if ends else ''}")
                print(printable_lines(f"saved {result}"), file=sys.stderr, flush=True)
                self._log("saved", path=str(result))
            self.wake()

        self._submit(job, done)

    def _ruler_of_picture(self, size: tuple[int, int]) -> tuple[list[Panel], Ends | None]:
        """Return the panels of the ruler on a picture of this size, and the ends to record."""
        session = self._session
        shown = overlay_content(session, time.monotonic()).ruler
        if shown is None or not shown.lines:
            return [], None
        panels = ruler_panels(shown, size, size[1] / max(session.size[1], 1.0))
        start, end = (end.point for end in session.ruler.ends)
        return [clipped(panel, size) for panel in panels], (start, end)

    def _copy_camera(self) -> None:
        """Copy the camera as Python to the clipboard."""
        text = self._session.camera.text(self._session.moment(time.monotonic()))
        if text:
            copy_text(self._canvas, text)
            self._notify(f"copied {text}")
            self._log("copied", text=text)

    def _toggle_full_screen(self) -> None:
        self._full_screen_from = set_full_screen(self._canvas, self._full_screen_from)


def _facts(request: FrameRequest) -> dict[str, Any]:
    shot, steering = request.shot, request.shot.steering
    return {
        "section": None if shot.section is None else shot.section.settings,
        "time": shot.time,
        "view": shot.view,
        "parameters": dict(shot.parameters),
        "steering": steering.settings if steering is not None else None,
        "mouse": shot.mouse.pixels(request.pixels),
        "pixels": request.pixels,
        "share": request.share,
        "refinement": request.refinement,
    }
