"""The methods of every picture besides rendering: show, export, and write as a video.

``distal.notebook``, ``distal.export`` and ``distal.video`` do the work; they are imported when
first needed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from os import PathLike
from typing import TYPE_CHECKING, Any, TypedDict, Unpack

from distal.lang.render_options import Cancel
from distal.lang.runtime_access import exports, recording, widget
from distal.packages import explained

if TYPE_CHECKING:
    from distal.export.exported import Exported
    from distal.notebook.widget import LiveView
    from distal.scene.steering import Steering
    from distal.video.frame_rendering import Progress
    from distal.video.recording import FinishedSequence
    from distal.video.store import Tell


class ShowOptions(TypedDict, total=False):
    """The options of ``show``; ``LiveView`` documents them."""

    size: tuple[int, int]
    params: Mapping[str, Any] | None
    time: float
    playing: bool | None
    view: str
    panel: bool
    mode: str | None


class ExportOptions(TypedDict, total=False):
    """The options of ``export`` besides the target; ``PageOptions`` documents them."""

    size: tuple[int, int]
    time: float
    duration: float | None
    params: Mapping[str, Any] | None
    title: str | None
    embed: bool
    panel: bool
    poster: bool | str
    view: str
    views: Sequence[str] | None
    device: str
    mode: str | None
    caustics: bool | None
    printable: bool
    inspect: bool
    unit: str
    tolerance: float | None


class VideoOptions(TypedDict, total=False):
    """The options of ``video`` besides the duration; ``distal.video.video`` documents them."""

    fps: float | Fraction | str
    size: tuple[int, int]
    start: float | Fraction | str
    params: Mapping[str, Any] | None
    view: str
    samples: int | None
    mode: str | None
    shutter: float | None
    steering: Steering | None
    loop: bool
    quality: str | float
    device: str
    threads: int | None
    keep_frames: str | PathLike[str] | None
    fresh: bool
    progress: Progress | None
    cancel: Cancel | None
    tell: Tell | None
    cluster: Any


class Presentable:
    """Base class of objects that can be viewed: scenes, shapes, images."""

    __slots__ = ()

    def show(self, **options: Unpack[ShowOptions]) -> LiveView:
        """Show a live picture in a notebook, with a control for every parameter.

        The widget's ``params``, ``time``, ``view`` and ``steering`` are bound both ways: controls
        change them, and setting them changes the picture. Needs the extra ``notebook``.

        Args:
            options: ``size`` (width and height in CSS pixels), ``params``, ``time``, ``playing``,
                ``view``, ``panel``, ``mode`` ("direct" or "path"; None: as the scene says).

        Raises:
            CompileError: The scene code has mistakes, or uses something that WebGL lacks.
        """
        try:
            show = widget.show
        except Exception as error:
            raise explained(error) or error from None
        return show(self, **options)

    def _repr_mimebundle_(self, **_: object) -> Any:
        """Return what a notebook's cell shows that ends with this object: its live picture.

        Without the extra ``notebook`` it is a still one.
        """
        try:
            bundle = widget.bundle_of
        except Exception as error:
            found = explained(error) or error
            still = getattr(self, "render")()._repr_png_()  # noqa: B009 (of every subclass)
            return {"image/png": still, "text/plain": f"{self!r}\n{found}"}
        return bundle(self)

    def export(
        self,
        path: str | PathLike[str],
        *,
        target: str | None = None,
        **options: Unpack[ExportOptions],
    ) -> Exported:
        """Write a web page or the text of a shader, depending on the suffix or ``target``.

        A page is one file that needs no network: a live picture with controls.

        Args:
            path: ``page.html``, or for a text: ``.frag``, ``.glsl``, ``.wgsl``, ``.fs`` (ISF).
            target: The output format if the suffix does not determine it: "html" or a text target.
            options: For a page ``size``, ``time``, ``duration``, ``params``, ``title``, ``view``,
                ``views``, ``embed``, ``panel``, ``poster``, ``mode`` ("direct" or "path"; None:
                as the scene says), and ``device``, which renders the poster, as for ``render``;
                for a text ``params``, ``view``, ``time``.

        Raises:
            CompileError: The scene code has mistakes, or uses something that the target lacks.
            SaveError: The suffix is unknown, or the file cannot be written.
        """
        return exports.export(self, path, target=target, **options)

    def video(
        self, path: str | PathLike[str], *, duration: float, **options: Unpack[VideoOptions]
    ) -> FinishedSequence:
        """Render a video or a sequence of pictures, depending on the suffix.

        An interrupted run continues where it stopped. Needs the extra ``video`` for mp4 and
        webm.

        Args:
            path: ``.mp4``, ``.webm``, ``.gif``, ``.apng``, ``.webp``, or ``frames/%05d.png``.
            duration: Seconds.
            options: ``fps``, ``size``, ``start``, ``samples``, ``mode``, ``shutter``,
                ``steering``, ``loop``, ``quality``, ``params``, ``view``, ``device``,
                ``threads``, ``keep_frames``, ``fresh``, ``progress``, ``cancel``, ``cluster``.
                The devices are those of ``render``.

        Raises:
            CompileError: The scene code has mistakes.
            SaveError: The suffix is unknown, or the file cannot be written.
        """
        return recording.video(self, path, duration=duration, **options)
