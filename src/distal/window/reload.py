"""Reload a scene whose files were saved.

Input: paths, and the current shot. Output: a scene that is compiled and ready to replace the old
one; the files that may have to change to fix an error.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from distal.diagnostics import CompileError
from distal.load_watch import LoadWatch
from distal.loading import load, loaded_from
from distal.scene.steering import STILL
from distal.scene.viewing.guide import Moment
from distal.scene.viewing.viewable import Viewable, checked_picture, viewable
from distal.window.dials import valid_values
from distal.window.shot import Shot

if TYPE_CHECKING:
    from distal.window.frame_renderers import FrameRenderer


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
    watch: LoadWatch,
    look: str | None = None,
    caustics: bool = True,
) -> ReloadedScene:
    """Load a scene again and compile it for the current shot.

    Args:
        path: The path for ``distal.load``.
        name: The name of the object in the file; None for the default.
        shot: The current shot.
        maker: Compiles and renders the frames.
        watch: Says where the file is if it takes long, and ends it.
        look: The name of a look to show it in; None for its own.
        caustics: Whether photons find the caustics of paths.

    Raises:
        LoadError, CompileError: There is a mistake; the scene that was loaded before still works.
        DeviceError: The device was lost.
    """
    with watch:
        loaded = load(path, name)
    obj = checked_picture(loaded)
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
