"""The files that the studio shows and saves: the scene's file and the modules beside it.

Input: a path. Output: texts, their digests, what other programs changed. Texts end lines by a
newline alone; a file keeps the line ends that it had. Needs the standard library alone.
"""

from __future__ import annotations

import ast
import errno
import hashlib
import os
import stat
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from distal.diagnostics import LoadError
from distal.editor.messages import Changed, Saved
from distal.editor.scene_folder import check_name, encoded_text
from distal.images.atomic_files import replacement
from distal.source_text import SourceTextError, decoded, has_mark, with_plain_ends

LONGEST_FILE: Final = 8_000_000  # bytes of a file that is shown or saved


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file's text as the app has it, and how it stands on the disk.

    Attributes:
        text: The text; lines end by a newline alone.
        digest: The digest of the file's bytes.
        ends: What ends lines on the disk.
        mark: Whether a byte order mark begins the file.
    """

    text: str
    digest: str
    ends: str = "\n"
    mark: bool = False

    @classmethod
    def of(cls, path: Path) -> SourceFile:
        """Read a file.

        Raises:
            LoadError: It cannot be read, or is not UTF-8.
        """
        try:
            with open(path, "rb", opener=_opened) as file:
                data = file.read(LONGEST_FILE + 1)
            text = decoded(data)
        except OSError as error:
            raise LoadError(f"'{path}' cannot be read: {error.strerror}") from None
        except SourceTextError as error:
            raise LoadError(f"'{path}' {error}") from None
        if len(data) > LONGEST_FILE:
            raise LoadError(f"'{path}' has more than {LONGEST_FILE:,} bytes")
        ends = "\r\n" if "\r\n" in text else "\n"
        return cls(with_plain_ends(text), digest_of(data), ends, has_mark(data))

    def encoded(self, name: str, text: str) -> bytes:
        """Return the bytes of a new text of this file.

        Raises:
            LoadError: It is too long, or has what no file can hold.
        """
        data = encoded_text(name, text.replace("\n", self.ends), mark=self.mark)
        if len(data) > LONGEST_FILE:
            raise LoadError(f"'{name}' would have more than {LONGEST_FILE:,} bytes")
        return data


def _opened(path: str, flags: int) -> int:
    """Open an ordinary file; a pipe or a device would never come to its end.

    Raises:
        OSError: It is none, or it cannot be opened.
    """
    found = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(os.fstat(found).st_mode):
        os.close(found)
        raise OSError(errno.EINVAL, "it is no ordinary file")
    return found


def digest_of(data: bytes) -> str:
    """Return a short name of some bytes."""
    return hashlib.sha256(data).hexdigest()[:16]


class SceneFiles:
    """The file that is edited, and the modules beside it that it imports.

    Args:
        path: The scene's file.
        unsaved: Texts by name that are shown in place of files of these names until they are saved.

    Raises:
        LoadError: A file cannot be read.
    """

    def __init__(self, path: Path, unsaved: Mapping[str, str] | None = None) -> None:
        self.folder = path.parent.resolve()
        self.main = path.name
        self._known = {n: SourceFile(text, "") for n, text in (unsaved or {}).items()}
        self.read()

    def read(self) -> Changed | None:
        """Read the files again; return what differs from what is known, or None.

        A file that is gone keeps its text, and is new: the next save writes it.

        Raises:
            LoadError: A file cannot be read.
        """
        found = dict(self._found())
        changed = {
            name: file
            for name, file in found.items()
            if name not in self._known or self._known[name].digest != file.digest
        }
        self._known = found
        return _told(changed) if changed else None

    def all(self) -> Changed:
        """Return all texts."""
        return _told(self._known)

    @property
    def is_new(self) -> bool:
        """Whether the scene's file is not on the disk yet."""
        return not self._known[self.main].digest

    def save(self, name: str, text: str, digest: str | None) -> Saved:
        """Write a text, unless another program has changed the file.

        Args:
            name: The name of a file in the folder.
            text: The text.
            digest: The digest of what it replaces; None or "" for a new file.

        Raises:
            LoadError: There is no such name, or the text cannot be in a file.
            SaveError: The file cannot be written.
        """
        path = self._path_of(name)
        there = SourceFile.of(path) if os.path.lexists(path) else SourceFile("", "")
        if there.digest != (digest or ""):
            return Saved(digest=there.digest, conflict=there.text)
        data = there.encoded(name, text)
        with replacement(path) as file:
            file.write(data)
        self._known[name] = SourceFile(text, digest_of(data), there.ends, there.mark)
        return Saved(digest=digest_of(data))

    def _path_of(self, name: str) -> Path:
        try:
            check_name(name)
        except LoadError as error:
            raise LoadError(f"{error.reason} in {self.folder}") from None
        path = self.folder / name
        if not self._is_inside(path):
            raise LoadError(f"'{name[:80]}' is not the name of a Python file in {self.folder}")
        return path

    def _is_inside(self, path: Path) -> bool:
        """Whether a file is in the folder, wherever links to it lead."""
        try:
            return Path(os.path.realpath(path)).parent == self.folder
        except (OSError, ValueError):
            return False

    def _found(self) -> Iterator[tuple[str, SourceFile]]:
        """Yield the scene's file and the modules that it imports, and those that they import."""
        waiting, seen = [self.main], {self.main}
        while waiting:
            name = waiting.pop()
            file = self._read(name)
            yield name, file
            for beside in sorted(f"{module}.py" for module in _imported(file.text)):
                path = self.folder / beside
                is_there = beside in self._known or (path.is_file() and self._is_inside(path))
                if is_there and beside not in seen:
                    seen.add(beside)
                    waiting.append(beside)

    def _read(self, name: str) -> SourceFile:
        known = self._known.get(name)
        if known is not None and not known.digest:
            return known  # not saved yet
        path = self.folder / name
        if known is not None and not path.exists():
            return SourceFile(known.text, "", known.ends, known.mark)
        return SourceFile.of(path)


def _imported(text: str) -> set[str]:
    """Return the names of the top-level modules that a text imports; none if it is not Python."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.partition(".")[0])
    return found


def _told(files: dict[str, SourceFile]) -> Changed:
    return Changed(
        files={name: file.text for name, file in files.items()},
        digests={name: file.digest for name, file in files.items()},
    )
