"""Detect that the files of a scene were saved, and reload the scene.

Input: paths, and the current shot. Output: whether files have changed and are completely written; a
scene that is compiled and ready to replace the old one.

The times of files are read four times a second. That costs a few microseconds per file and works
on every file system. Notifications of the operating system do not work on shared folders, and for
an editor that saves by renaming they would also need a watch on the folder.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeAlias

from distal.diagnostics import CompileError
from distal.loading import load, loaded_from
from distal.scene.steering import STILL
from distal.scene.viewing.guide import Moment
from distal.scene.viewing.viewable import Viewable, checked_picture, viewable
from distal.window.session import Shot, valid_values

if TYPE_CHECKING:
    from distal.window.frame_renderers import FrameRenderer

PERIOD_S: Final = 0.25

Signature: TypeAlias = "tuple[tuple[int, ...] | None, ...]"


class FileWatcher:
    """Watches a set of files, and of folders whose entries may change."""

    def __init__(self, files: Iterable[Path]) -> None:
        self._paths: tuple[Path, ...] = ()
        self._known: Signature = ()
        self._last: Signature = ()
        self.watch(files)

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these files from now on.

        A file that was already watched keeps its last known state, so that a save during loading is
        detected.
        """
        known = dict(zip(self._paths, self._known, strict=True))
        self._paths = tuple(dict.fromkeys(files))
        self._known = tuple(known[p] if p in known else _state(p) for p in self._paths)
        self._last = self._known

    def has_changed(self) -> bool:
        """Return whether something was saved since this last returned True, and is now unchanged.

        A file that is still being written changes between two calls; then the result is False.
        """
        state = tuple(map(_state, self._paths))
        at_rest, self._last = state == self._last, state
        if not at_rest or state == self._known:
            return False
        self._known = state
        return True


def _state(path: Path) -> tuple[int, ...] | None:
    """Return values that change when a file is saved or replaced, or a folder's entries change."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size, found.st_ino


@dataclass(frozen=True, slots=True, eq=False)
class ReloadedScene:
    """A reloaded scene that is ready to be shown.

    Attributes:
        viewable: The scene.
        animated: Whether its picture depends on the time.
        files: The file and the modules that it imported.
    """

    viewable: Viewable
    animated: bool
    files: tuple[Path, ...]


def load_again(
    path: str,
    name: str | None,
    shot: Shot,
    maker: FrameRenderer,
    look: str | None = None,
    caustics: bool = True,
) -> ReloadedScene:
    """Load a scene again and compile it for the current shot.

    Args:
        path: The path for ``distal.load``.
        name: The name of the object in the file; None for the default.
        shot: The current shot.
        maker: Compiles and renders the frames.
        look: The name of a look to show it in; None for its own.
        caustics: Whether photons find the caustics of paths.

    Raises:
        LoadError, CompileError: There is a mistake; the scene that was loaded before still works.
        DeviceError: The device was lost.
    """
    obj = checked_picture(load(path, name))
    origin = loaded_from(obj)
    assert origin is not None, "it was loaded just now"
    values = valid_values(obj.parameters(), dict(shot.parameters))
    shown = viewable(obj, values, shot.time, look).in_mode(None, caustics=caustics)
    view = shot.view if shot.view in shown.views else shown.views[0]
    parameters = tuple(sorted(values.items()))
    steering = (shot.steering or STILL) if shown.steers else None
    maker.prepare(shown, replace(shot, parameters=parameters, view=view, steering=steering))
    # Computed and cached here, so that the window's thread does not have to wait.
    _ = shown.elevation
    if shown.guide is not None:
        shown.guide.prepare(Moment(time=shot.time, params=values))
    return ReloadedScene(shown, shown.animated, origin.files)


def files_in(error: BaseException, scene: Path) -> list[Path]:
    """Return the files and folders that may have to change to fix an error, besides known ones.

    A module that fails to load belongs to no loaded scene. A missing module is detected by its
    folder, whose entries change when the module is created.
    """
    folder = scene.resolve().parent
    names = [folder]
    if isinstance(error, CompileError):
        names += (Path(d.span.file) for d in error.diagnostics if d.span is not None)
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, SyntaxError) and cause.filename:
            names.append(Path(cause.filename))
        trace = cause.__traceback__
        while trace is not None:
            names.append(Path(trace.tb_frame.f_code.co_filename))
            trace = trace.tb_next
        cause = cause.__cause__
    near = (path for path in names if path.resolve().is_relative_to(folder))
    return [path for path in dict.fromkeys(near) if path.exists()]
