"""A folder in which a scene's texts run: the texts, and links to what else is beside the scene.

Input: the texts by name, and the folder of the scene. Output: files. Needs the standard library
alone.
"""

from __future__ import annotations

import contextlib
import itertools
from pathlib import Path, PurePath
from typing import Final

from distal.diagnostics import LoadError

MOST_LINKS: Final = 1000  # entries of the scene's folder


def check_name(name: str) -> None:
    """Check that a name is that of a Python file, without a folder.

    Raises:
        LoadError: It is another.
    """
    if PurePath(name).name != name or not name.endswith(".py"):
        raise LoadError(f"'{name[:80]}' is not the name of a Python file")


def link_beside(source: Path, folder: Path) -> None:
    """Link what a folder has, apart from Python files, where links are allowed."""
    for entry in itertools.islice(source.iterdir(), MOST_LINKS):
        if entry.suffix != ".py" and entry.name != "__pycache__":
            with contextlib.suppress(OSError):
                (folder / entry.name).symlink_to(entry, target_is_directory=entry.is_dir())
