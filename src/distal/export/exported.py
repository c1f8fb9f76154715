"""What an export says of the file that it wrote."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Exported:
    """What was written.

    Attributes:
        path: The file.
        parts: What it is made of: bytes by name.
        beside: Further files.
        omitted: Views that the place cannot show, and why.
    """

    path: Path
    parts: Mapping[str, int]
    beside: tuple[Path, ...] = ()
    omitted: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """One line: the file, its size, and that of its parts in kB."""
        total = self.path.stat().st_size
        parts = ", ".join(f"{name} {_kilobytes(size)}" for name, size in self.parts.items() if size)
        beside = f", and {', '.join(p.name for p in self.beside)}" if self.beside else ""
        return f"{self.path}: {_kilobytes(total)} kB{f' ({parts})' if parts else ''}{beside}"


def _kilobytes(size: int) -> str:
    return f"{size / 1000:.1f}" if size < 10_000 else f"{size / 1000:.0f}"
