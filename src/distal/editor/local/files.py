"""The files that the studio shows and saves: the scene's file and the modules beside it.

Input: a path, texts to save. Output: texts, their digests, what other programs changed. Every text
that is seen on the disk is kept as a version; nothing is written over a text that its author did
not know. Needs the standard library alone.
"""

from __future__ import annotations

import ast
import contextlib
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from distal.diagnostics import LoadError
from distal.editor.local.drafts import Drafts
from distal.editor.local.source_file import NO_FILE, UNREADABLE, SourceFile
from distal.editor.local.versions import Why
from distal.editor.messages import Changed, DiskProblem, Saved
from distal.editor.scene_folder import check_name
from distal.file_writer import ChangedError, LinkedError, digest_of, save
from distal.forking import new_lock
from distal.frontend.parsing import parse
from distal.source_text import SourceTextError, decoded, with_plain_ends


@dataclass(frozen=True, slots=True)
class _FileState:
    """What is known of a file.

    Attributes:
        last: The last text that it had on the disk; or the text that a new file begins with.
        now: What is there now: as ``last``, or something without a text.
    """

    last: SourceFile
    now: SourceFile

    @classmethod
    def of(cls, file: SourceFile) -> _FileState:
        return cls(file, file)

    @property
    def state(self) -> tuple[str, str]:
        """Equal while nothing has changed."""
        return self.now.digest, self.now.problem


class SceneFiles:
    """The file that is edited, and the modules beside it that it imports.

    Args:
        path: The scene's file; where it is a link, the file that it leads to is edited.
        unsaved: Texts by name that are not saved yet: of a new file, or of a copy of an example.

    Raises:
        LoadError: A file cannot be read.
    """

    def __init__(self, path: Path, unsaved: Mapping[str, str] | None = None) -> None:
        self.folder = path.parent.resolve()
        self.main = path.name
        self.drafts: Drafts | None = None
        self.unkept = ""  # why a version could not be kept
        self._lock = new_lock()
        self._order = 0
        self._unsaved = dict(unsaved or {})
        self._entries = {
            name: _FileState.of(SourceFile(text, NO_FILE)) for name, text in self._unsaved.items()
        }
        for name, now in self._seen():
            if now.problem and now.digest != NO_FILE:
                raise LoadError(f"'{path.with_name(name)}' {now.problem}")
            if now.problem and name not in self._entries:
                raise LoadError(f"'{path.with_name(name)}' cannot be read: {now.problem}")
            if not now.problem:
                self._entries[name] = _FileState.of(now)
        self._reported = self._states()

    # Reading

    def read(self) -> Changed | None:
        """Read the files again; return what has changed since the last call, or None.

        Of a file that is gone, or has no text, the last text stays.
        """
        with self._lock:
            for name, now in list(self._seen()):
                self._observe(name, now)
            states = self._states()
            changed = [name for name, state in states.items() if self._reported.get(name) != state]
            self._reported = states
            if not changed:
                return None
            return self._message(changed)

    def all(self) -> Changed:
        """Return all texts."""
        with self._lock:
            return self._message(list(self._entries))

    def included(self, names: Iterable[str]) -> Changed | None:
        """Show more files, of which there are drafts; return those that are not known yet."""
        with self._lock:
            new = [name for name in names if name not in self._entries]
            for name in new:
                now = self._file(name)
                last = SourceFile("", NO_FILE) if now.problem else now
                self._entries[name] = _FileState(last, now)
                self._keep(name, now.data, "opened")
            self._reported.update({name: self._entries[name].state for name in new})
            return self._message(new) if new else None

    @property
    def is_new(self) -> bool:
        """Whether the scene's file is not on the disk yet."""
        return not self._entries[self.main].last.digest

    def text_of(self, name: str) -> str | None:
        """Return the text that the disk has of a file; None if it has none."""
        entry = self._entries.get(name)
        return None if entry is None or not entry.now.digest else entry.now.text

    # Keeping

    def keep_in(self, drafts: Drafts) -> None:
        """Keep from now on what was on the disk, beginning with what is there."""
        with self._lock:
            self.drafts = drafts
            for name, entry in self._entries.items():
                self._keep(name, entry.now.data, "opened")

    def taken_unsaved(self) -> dict[str, str]:
        """Return, once, the texts that the files begin with although the disk has others."""
        with self._lock:
            texts, self._unsaved = self._unsaved, {}
            return {n: text for n, text in texts.items() if self._entries[n].last.digest}

    def _keep(self, name: str, data: bytes, why: Why) -> None:
        """Keep a version; that it cannot be kept does not stop what is done."""
        if self.drafts is None:
            return
        try:
            self.drafts.versions.keep(name, data, why)
            self.unkept = ""
        except OSError as error:
            self.unkept = self.drafts.reason(error)

    def _observe(self, name: str, now: SourceFile, why: Why = "other") -> None:
        """Note what is on the disk now."""
        entry = self._entries.get(name)
        if entry is None:
            entry = _FileState.of(SourceFile("", NO_FILE))
        if now.digest == NO_FILE and entry.last.digest == NO_FILE:
            return  # a new file, still
        if now.digest == NO_FILE:
            now = SourceFile("", NO_FILE, problem=self._loss(entry.last))
        changed = _FileState(entry.last if now.problem else now, now)
        if name in self._entries and changed.state == entry.state:
            return
        self._entries[name] = changed
        self._order += 1
        self._keep(name, entry.now.data, why)
        self._keep(name, now.data, why)

    def _loss(self, last: SourceFile) -> str:
        """Return what became of a file that is gone."""
        try:
            for entry in os.scandir(self.folder):
                is_it = entry.name.endswith(".py") and last.inode and entry.inode() == last.inode
                # A number of a file that is gone is soon that of another one.
                if is_it and SourceFile.of(Path(entry)).digest == last.digest:
                    return f"was renamed to {entry.name}"
        except OSError:
            pass
        return "was deleted"

    # Saving

    def save(self, name: str, text: str, digest: str | None, *, in_place: bool = False) -> Saved:
        """Write a text, unless the disk has another one than its author knows.

        Args:
            name: The name of a file in the folder.
            text: The text.
            digest: The digest of what it replaces; None or "" for a new file.
            in_place: Whether the file itself is written, with all its other names.

        Raises:
            LoadError: There is no such name, or the text cannot be in a file.
            SaveError: The file cannot be written.
        """
        path = self._path_of(name)
        with self._lock:
            there = SourceFile.of(path)
            self._observe(name, there)
            if there.digest == UNREADABLE:
                raise LoadError(f"{name} is not saved: what is there now {there.problem}")
            if there.digest != (digest or NO_FILE):
                return self._conflict(name, there)
            data = there.encoded(name, text)
            try:
                written = save(path, data, expected=there.digest, in_place=in_place)
            except ChangedError:  # since it was read above
                return self._conflict(name, self._file(name))
            except LinkedError as error:
                return self._conflict(name, there, refusal=str(error))
            # Not read again: what another program has written since then would be taken for ours.
            self._observe(name, self._written(path, there, data), "saved")
            self._reported[name] = self._entries[name].state
            other = written.other
            if other is not None:
                self._keep(name, other, "other")
            return Saved(
                digest=written.digest,
                other=None if other is None else version_text(other),
                unkept=self.unkept,
                order=self._order,
            )

    def _written(self, path: Path, before: SourceFile, data: bytes) -> SourceFile:
        inode = 0
        with contextlib.suppress(OSError):
            inode = path.stat().st_ino
        text = with_plain_ends(decoded(data))
        return replace(
            before, text=text, digest=digest_of(data), data=data, problem="", inode=inode
        )

    def _conflict(self, name: str, there: SourceFile, refusal: str = "") -> Saved:
        self._observe(name, there)
        entry = self._entries.get(name)
        problem = (entry.now.problem if entry is not None else "") or there.problem
        return Saved(
            digest=there.digest,
            is_saved=False,
            conflict=None if problem or refusal else there.text,
            problem="" if refusal else problem,
            refusal=refusal,
            order=self._order,
        )

    def _path_of(self, name: str) -> Path:
        try:
            check_name(name)
        except LoadError as error:
            raise LoadError(f"{error.reason} in {self.folder}") from None
        path = self.folder / name
        if name != self.main and not self._is_inside(path):
            raise LoadError(f"'{name[:80]}' is not the name of a Python file in {self.folder}")
        return path

    def _is_inside(self, path: Path) -> bool:
        """Whether a file is in the folder, wherever links to it lead."""
        try:
            return Path(os.path.realpath(path)).parent == self.folder
        except (OSError, ValueError):
            return False

    def _seen(self) -> Iterator[tuple[str, SourceFile]]:
        """Yield what is on the disk: of the files shown so far, and modules that they import."""
        waiting = list(dict.fromkeys((self.main, *self._entries)))
        seen = set(waiting)
        while waiting:
            name = waiting.pop()
            file = self._file(name)
            yield name, file
            entry = self._entries.get(name)
            text = entry.last.text if file.problem and entry is not None else file.text
            for beside in sorted(f"{module}.py" for module in _imported(text)):
                path = self.folder / beside
                if beside not in seen and os.path.isfile(path) and self._is_inside(path):
                    seen.add(beside)
                    waiting.append(beside)

    def _file(self, name: str) -> SourceFile:
        """Return what is on the disk now."""
        path = self.folder / name
        if name != self.main and os.path.lexists(path) and not self._is_inside(path):
            return SourceFile("", UNREADABLE, problem="leads out of the folder")
        return SourceFile.of(path)

    def _states(self) -> dict[str, tuple[str, str]]:
        return {name: entry.state for name, entry in self._entries.items()}

    def _message(self, names: list[str]) -> Changed:
        entries = {name: self._entries[name] for name in names}
        return Changed(
            files={name: entry.last.text for name, entry in entries.items()},
            digests={name: entry.last.digest for name, entry in entries.items()},
            problems={
                name: DiskProblem(digest=entry.now.digest, text=entry.now.problem)
                for name, entry in entries.items()
                if entry.now.problem
            },
            order=self._order,
        )


def version_text(data: bytes) -> str:
    """Return the text of a version's bytes; what is no text in its encoding is replaced."""
    try:
        text = decoded(data)
    except SourceTextError:
        text = data.decode("utf-8", "replace")
    return with_plain_ends(text)


def _imported(text: str) -> set[str]:
    """Return the names of the top-level modules that a text imports; none if it is not Python."""
    try:
        tree = parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return set()
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            names.add(node.module.partition(".")[0])
    return names
