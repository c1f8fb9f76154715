"""What ``show``, ``export`` and ``video`` of a picture do: each in a room of its own.

Input: a scene, a shape or an image. Output: a widget, a page, a film. Reached from
below through a hook; the rooms are entered only when they are needed.
"""

from __future__ import annotations

import importlib
from os import PathLike
from typing import Any

from distal.packages import explained


class Presenter:
    """Hands a picture on to the room that shows it."""

    def show(self, obj: Any, **options: Any) -> Any:
        """A live picture in a notebook."""
        try:
            room = importlib.import_module("distal.notebook.widget")
        except Exception as error:
            raise explained(error) or error from None
        return room.show(obj, **options)

    def export(self, obj: Any, path: str | PathLike[str], **options: Any) -> Any:
        """A page, or a text."""
        return importlib.import_module("distal.export.registry").export(obj, path, **options)

    def video(self, obj: Any, path: str | PathLike[str], **options: Any) -> Any:
        """A video, or a sequence of pictures."""
        return importlib.import_module("distal.video").video(obj, path, **options)
