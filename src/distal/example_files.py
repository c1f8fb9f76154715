"""The files of the examples: in the package, or in ``examples/`` of a checkout.

Output: paths by name. Reads nothing but folders, and imports nothing of the package.
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

EXAMPLE_PREFIX: Final = "example:"


def gallery() -> dict[str, Path]:
    """Return the paths of the examples in the package by name, sorted by name."""
    return {path.stem: path for path in sorted(_folder().glob("*.py"))}


def frame_examples() -> dict[str, Path]:
    """Return the paths of the examples that keep frames, by name, sorted by name."""
    return {path.stem: path for path in sorted((_folder() / "frames").glob("*.py"))}


def all_examples() -> dict[str, Path]:
    """Return the paths of all examples, by name: the gallery, then those that keep frames."""
    return gallery() | frame_examples()


def posters() -> dict[str, Path]:
    """Return the paths of small pictures of the examples by name: WebP, 320 pixels wide."""
    return {path.stem: path for path in sorted((_folder() / "posters").glob("*.webp"))}


def data_file(name: str) -> Path | None:
    """Return the path of a file that an example reads, from "example:FILE"; None for others."""
    if not name.startswith(EXAMPLE_PREFIX):
        return None
    found = _folder() / "frames" / Path(name.removeprefix(EXAMPLE_PREFIX)).name
    return found if found.is_file() else None


def _folder() -> Path:
    installed = Path(__file__).parent / "gallery"
    checkout = Path(__file__).parents[2] / "examples"
    return installed if installed.is_dir() else checkout
