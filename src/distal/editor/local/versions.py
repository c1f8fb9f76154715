"""Versions of the files of a folder: texts that were on the disk or in the page, and are not now.

Input: bytes, and why they are kept. Output: files beside the drafts, readable by any program. There
are at most 50 of a file: the last 10, then one an hour, one a day, and as many of the others as
the limits allow. Knows neither the page nor the scene's folder.
"""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Final, Literal, TypeAlias

from distal.file_writer import digest_of, write_private

MOST: Final = 50  # of a file
RECENT: Final = 10  # that are kept however close they are
MOST_BYTES: Final = 20_000_000  # of a file's versions; the newest one is kept in any case
MOST_BYTES_IN_ALL: Final = 300_000_000

# Why a text is kept: it was on the disk when the studio opened, it was saved here, another program
# saved it, it was in the page, its tab went.
Why: TypeAlias = Literal["opened", "saved", "other", "typed", "left"]
_NAME: Final = re.compile(
    r"(\d{8}T\d{6}\.\d{6})Z-(opened|saved|other|typed|left)-([0-9a-f]{16})\.py"
)
_STAMP: Final = "%Y%m%dT%H%M%S.%f"
_HOUR_S: Final = 3600.0


@dataclass(frozen=True, slots=True)
class FileVersion:
    """A version of a file.

    Attributes:
        path: Its file.
        at: When it was kept, in seconds since 1970.
        why: Why it was kept.
        digest: Names its bytes.
        size: In bytes.
    """

    path: Path
    at: float
    why: str
    digest: str
    size: int

    @classmethod
    def of(cls, path: Path) -> FileVersion | None:
        """Return the version in a file; None if it is none, or gone."""
        parts = _NAME.fullmatch(path.name)
        if parts is None:
            return None
        try:
            at = datetime.strptime(parts[1], _STAMP).replace(tzinfo=UTC).timestamp()
            return cls(path, at, parts[2], parts[3], path.stat().st_size)
        except (OSError, ValueError):
            return None


class FileVersions:
    """The versions of the files of one folder.

    Args:
        folder: Where they are; each file has a folder of its name in it.
        clock: Gives seconds since 1970.
    """

    def __init__(self, folder: Path, clock: Callable[[], float] = time.time) -> None:
        self._folder, self._clock = folder, clock

    def keep(self, name: str, data: bytes, why: Why) -> None:
        """Keep a text; one that is there already becomes the newest.

        Raises:
            OSError: It cannot be written; what was there stays.
        """
        if not data.strip():
            return  # nothing that anybody would miss
        digest = digest_of(data)
        stamp = datetime.fromtimestamp(self._clock(), UTC).strftime(_STAMP)
        path = self._folder / name / "versions" / f"{stamp}Z-{why}-{digest}.py"
        for number, version in enumerate(self.all(name)):
            if version.digest == digest:
                with contextlib.suppress(FileNotFoundError):  # another server removed it
                    if number:
                        version.path.replace(path)
                    return
        write_private(path, data)
        for version in to_remove(self.all(name)):
            with contextlib.suppress(OSError):
                version.path.unlink()

    def all(self, name: str) -> list[FileVersion]:
        """Return the versions of a file, the newest first."""
        try:
            versions = [
                FileVersion.of(path) for path in (self._folder / name / "versions").iterdir()
            ]
        except OSError:
            return []
        return sorted(filter(None, versions), key=lambda one: one.path.name, reverse=True)

    def read(self, name: str, version: str) -> bytes:
        """Return the bytes of a version.

        Args:
            name: The file's name.
            version: The name of the version's file.

        Raises:
            OSError: There is no such version.
        """
        for one in self.all(name):
            if one.path.name == version:
                return one.path.read_bytes()
        raise FileNotFoundError(f"there is no version '{version[:60]}'")


def to_remove(versions: Sequence[FileVersion]) -> list[FileVersion]:
    """Return the versions that go, so that number and bytes are within their limits.

    Args:
        versions: Those of a file, the newest first.
    """
    removed: list[FileVersion] = []
    left = list(versions)
    while len(left) > MOST or (len(left) > 1 and sum(v.size for v in left) > MOST_BYTES):
        least = _least(left)
        left.remove(least)
        removed.append(least)
    return removed


def _least(versions: Sequence[FileVersion]) -> FileVersion:
    """Return the version that is missed least.

    That is the oldest one that has a newer one in its hour, or of those before the last day in its
    day; texts that were only typed go before those that were on the disk.
    """
    seen: set[tuple[str, int]] = set()
    spare: list[FileVersion] = []
    newest = versions[0].at
    for number, version in enumerate(versions):
        is_of_today = newest - version.at < 24 * _HOUR_S
        period = _HOUR_S if is_of_today else 24 * _HOUR_S
        key = ("hour" if is_of_today else "day", int(version.at // period))
        if number >= RECENT and key in seen:
            spare.append(version)
        seen.add(key)
    typed = [version for version in spare if version.why == "typed"]
    return (typed or spare or list(versions))[-1]


def sweep(root: Path, most: int = MOST_BYTES_IN_ALL) -> None:
    """Remove the oldest versions of all folders until they have no more than some bytes."""
    files = (FileVersion.of(path) for path in root.glob("*/*/versions/*.py"))
    versions = sorted(filter(None, files), key=lambda one: one.path.name)
    size = sum(version.size for version in versions)
    for version in versions:
        if size <= most:
            return
        with contextlib.suppress(OSError):
            version.path.unlink()
        size -= version.size
