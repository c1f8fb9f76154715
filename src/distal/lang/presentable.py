"""What every picture can do besides being rendered: be shown, exported, filmed.

The work is done far above; this room only hands the object on.
"""

from __future__ import annotations

from os import PathLike
from typing import Any

from distal.lang.runtime_hook import presenter


class Presentable:
    """Something that can be looked at: a scene, a shape, an image."""

    __slots__ = ()

    def show(self, **options: Any) -> Any:
        """A live picture in a notebook, with a control for every parameter.

        The widget's ``params``, ``time``, ``view`` and ``steering`` are bound both ways: controls
        change them, and setting them changes the picture. Needs the extra ``notebook``.

        Args:
            options: ``size`` (width and height in CSS pixels), ``params``, ``time``, ``playing``,
                ``view``, ``panel``.

        Raises:
            CompileError: The scene code has mistakes, or says what WebGL cannot do.
        """
        return presenter().show(self, **options)

    def export(self, path: str | PathLike[str], **options: Any) -> Any:
        """Write a web page or a shader's text; the suffix or ``target`` says which.

        A page is one file that needs no network: a live picture with controls.

        Args:
            path: ``page.html``, or a text: ``.frag``, ``.glsl``, ``.wgsl``, ``.fs`` (ISF).
            options: ``target`` for a text; for a page ``size``, ``time``, ``duration``, ``params``,
                ``title``, ``view``, ``views``, ``embed``, ``panel``, ``poster``, and
                ``device``, which renders the poster, as for ``render``.

        Raises:
            CompileError: The scene code has mistakes, or says what the target cannot do.
            SaveError: The suffix is unknown, or the file cannot be written.
        """
        return presenter().export(self, path, **options)

    def video(self, path: str | PathLike[str], *, duration: float, **options: Any) -> Any:
        """Render a video or a sequence of pictures; the suffix says which.

        A run that was broken off goes on where it ended. Needs the extra ``video`` for mp4 and
        webm.

        Args:
            path: ``.mp4``, ``.webm``, ``.gif``, ``.apng``, ``.webp``, or ``frames/%05d.png``.
            duration: Seconds.
            options: ``fps``, ``size``, ``start``, ``samples``, ``loop``, ``quality``, ``params``,
                ``view``, ``device``, ``threads``, ``keep_frames``, ``fresh``, ``progress``,
                ``cancel``. The devices are those of ``render``.

        Raises:
            CompileError: The scene code has mistakes.
            SaveError: The suffix is unknown, or the file cannot be written.
        """
        return presenter().video(self, path, duration=duration, **options)
