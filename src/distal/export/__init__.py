"""What leaves the machine: a page that shows a scene by itself, and shaders for other places.

``distal.export(obj, path)`` writes a file. This room is called like the function, so the room
itself can be called: whichever of the two Python finds first under the name, both work.
"""

from __future__ import annotations

import sys
from os import PathLike
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from distal.export.registry import Exported


def export(obj: Any, path: str | PathLike[str], **options: Any) -> Exported:
    """Write a picture as a page or a shader; see ``distal.export.registry.export``."""
    from distal.export import registry  # noqa: PLC0415 (only when something is written)

    return registry.export(obj, path, **options)


class _Room(ModuleType):
    """The module ``distal.export``, which is also the function."""

    def __call__(self, obj: Any, path: str | PathLike[str], **options: Any) -> Exported:
        """Write a picture as a page or a shader."""
        return export(obj, path, **options)


sys.modules[__name__].__class__ = _Room
