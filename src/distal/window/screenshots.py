"""What the pictures that are saved of a window are called.

Input: a folder, a scene's title, a ``Shot``. Output: a file's name that is free.
"""

from __future__ import annotations

from pathlib import Path

from distal.window.session import Shot


def free_name(folder: Path, title: str, shot: Shot) -> Path:
    """A file's name after the scene and the time that no file has yet."""
    plain = "".join(c if c.isalnum() or c in "-_" else "_" for c in title)[:60]
    stem = f"{plain or 'picture'}-{shot.time:.2f}s"
    if shot.view != "color":
        stem += "-" + "".join(c if c.isalnum() else "_" for c in shot.view)
    number = 1
    while True:
        path = folder / (f"{stem}.png" if number == 1 else f"{stem}-{number}.png")
        if not path.exists():
            return path
        number += 1
