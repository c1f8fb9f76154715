"""``Exported``: the description of a file that an export wrote."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Exported:
    """The result of an export.

    Attributes:
        path: The file.
        parts: The sizes of its parts in bytes, by name.
        beside: Further files that were written.
        omitted: Views that the target cannot show, and why.
        unprinted: Of a printable page: what has no end and is not saved, in words.
    """

    path: Path
    parts: Mapping[str, int]
    beside: tuple[Path, ...] = ()
    omitted: Mapping[str, str] = field(default_factory=dict)
    unprinted: tuple[str, ...] = ()

    def __str__(self) -> str:
        """Return one line: the file, its size, and the sizes of its parts in kB."""
        total = self.path.stat().st_size
        parts = ", ".join(f"{name} {_kilobytes(size)}" for name, size in self.parts.items() if size)
        beside = f", and {', '.join(p.name for p in self.beside)}" if self.beside else ""
        return f"{self.path}: {_kilobytes(total)} kB{f' ({parts})' if parts else ''}{beside}"


def _kilobytes(size: int) -> str:
    return f"{size / 1000:.1f}" if size < 10_000 else f"{size / 1000:.0f}"
