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
from distal.source_text import SourceTextError, encoded

MOST_LINKS: Final = 1000  # entries of the scene's folder


def check_name(name: str) -> None:
    """Check that a name is that of a Python file, without a folder.

    Raises:
        LoadError: It is another.
    """
    if PurePath(name).name != name or not name.endswith(".py") or not name.isprintable():
        shown = ascii(name[:80])[1:-1] if not name.isprintable() else name[:80]
        raise LoadError(f"'{shown}' is not the name of a Python file")


def encoded_text(name: str, text: str, *, mark: bool = False) -> bytes:
    """Return the bytes of a file's text.

    Args:
        name: The name of the file.
        text: Its text, which may name its encoding.
        mark: Whether a byte order mark begins the file.

    Raises:
        LoadError: It has a character that its encoding lacks, or half a character.
    """
    try:
        return encoded(text, mark=mark)
    except SourceTextError as error:
        raise LoadError(f"'{name}' {error}") from None


def link_beside(source: Path, folder: Path) -> None:
    """Link what a folder has, apart from Python files, where links are allowed."""
    with contextlib.suppress(OSError):  # the folder is gone, or may not be read
        _link_entries(source, folder)


def _link_entries(source: Path, folder: Path) -> None:
    for entry in itertools.islice(source.iterdir(), MOST_LINKS):
        if entry.suffix != ".py" and entry.name != "__pycache__":
            with contextlib.suppress(OSError):
                (folder / entry.name).symlink_to(entry, target_is_directory=entry.is_dir())
