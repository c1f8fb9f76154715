"""The files that the studio shows and saves: the scene's file and the modules beside it.

Input: a path. Output: texts, their digests, what other programs changed. Texts end lines by a
newline alone; a file keeps the line ends that it had. Needs the standard library alone.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePath

from distal.diagnostics import LoadError
from distal.editor.messages import Changed, Saved
from distal.images.atomic_files import replacement

_BOM = "\ufeff"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file's text as the app has it, and how it stands on the disk.

    Attributes:
        text: The text; lines end by a newline alone.
        digest: The digest of the file's bytes.
        ends: What ends lines on the disk.
        mark: The byte order mark that begins the file, or "".
    """

    text: str
    digest: str
    ends: str = "\n"
    mark: str = ""

    @classmethod
    def of(cls, path: Path) -> SourceFile:
        """Read a file.

        Raises:
            LoadError: It cannot be read, or is not UTF-8.
        """
        try:
            data = path.read_bytes()
            text = data.decode("utf-8")
        except OSError as error:
            raise LoadError(f"'{path}' cannot be read: {error.strerror}") from None
        except UnicodeDecodeError:
            raise LoadError(f"'{path}' is not UTF-8 text") from None
        mark = _BOM if text.startswith(_BOM) else ""
        ends = "\r\n" if "\r\n" in text else "\n"
        plain = text.removeprefix(_BOM).replace("\r\n", "\n").replace("\r", "\n")
        return cls(plain, digest_of(data), ends, mark)

    def encoded(self, text: str) -> bytes:
        """Return the bytes of a new text of this file."""
        return (self.mark + text.replace("\n", self.ends)).encode("utf-8")


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
            LoadError: There is no such name, or the file cannot be written.
        """
        path = self._path_of(name)
        there = SourceFile.of(path) if path.exists() else SourceFile("", "")
        if there.digest != (digest or ""):
            return Saved(digest=there.digest, conflict=there.text)
        data = there.encoded(text)
        try:
            with replacement(path) as file:
                file.write(data)
        except OSError as error:
            raise LoadError(f"'{name}' cannot be written: {error.strerror}") from None
        self._known[name] = SourceFile(text, digest_of(data), there.ends, there.mark)
        return Saved(digest=digest_of(data))

    def _path_of(self, name: str) -> Path:
        path = (self.folder / name).resolve()
        if PurePath(name).name != name or not name.endswith(".py") or path.parent != self.folder:
            raise LoadError(f"'{name[:80]}' is not the name of a Python file in {self.folder}")
        return path

    def _found(self) -> Iterator[tuple[str, SourceFile]]:
        """Yield the scene's file and the modules that it imports, and those that they import."""
        waiting, seen = [self.main], {self.main}
        while waiting:
            name = waiting.pop()
            file = self._read(name)
            yield name, file
            for beside in sorted(f"{module}.py" for module in _imported(file.text)):
                is_there = beside in self._known or (self.folder / beside).is_file()
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
    except (SyntaxError, ValueError, RecursionError):
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
