"""Choose names for pictures that are saved from a window.

Input: a folder, the title of a scene, a ``Shot``. Output: the name of a file that does not exist.
"""

from __future__ import annotations

from pathlib import Path

from distal.window.shot import Shot


def free_name(folder: Path, title: str, shot: Shot) -> Path:
    """Return a file name made of the scene's title and time that does not exist yet.

    Args:
        folder: The folder of the file.
        title: The title of the scene.
        shot: The shot to save.
    """
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
