"""Drafts: the unsaved texts of each tab of the studio, which outlive the tab and the server.

Input: a tab's text and the digest of what it began with. Output: a file for each tab and name; what
is replaced goes to the versions (``versions.py``). A draft belongs to its tab while that lives, in
this process or another: later the next tab that opens gets it. Needs no network.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
import secrets
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from distal.editor.local.versions import FileVersions, Why, sweep
from distal.file_writer import write_private
from distal.file_writer.locks import is_over, process_name
from distal.file_writer.state import state_folder
from distal.forking import new_lock

# A text that was in the page for a second has been here for almost as long.
_STANDING_S: Final = 0.7
# So long the socket of a page that was loaded again may take to end.
_LEAVING_S: Final = 1.0
_TICK_S: Final = 0.02
# The process (its file of locks and its token), the server in it, the tab.
_NAME: Final = re.compile(r"([0-9a-f]{8})-([0-9a-f]{7})-([0-9a-f]{8})\.([0-9a-f]{12})\.json")

_servers: Final[set[str]] = set()  # those of this process that have not ended


@dataclass(frozen=True, slots=True)
class Draft:
    """An unsaved text.

    Attributes:
        text: The text; lines end by a newline alone.
        base: The digest of the bytes on the disk that it began with; "" for a new file.
        since: When it came, in seconds since 1970.
    """

    text: str
    base: str
    since: float

    @classmethod
    def of(cls, path: Path) -> Draft | None:
        """Return the draft in a file; None where there is none, or a damaged one."""
        try:
            fields = json.loads(path.read_bytes())
            draft = cls(fields["text"], fields["base"], float(fields["since"]))
        except (OSError, ValueError, TypeError, KeyError, RecursionError):
            return None
        return draft if isinstance(draft.text, str) and isinstance(draft.base, str) else None

    def encoded(self) -> bytes:
        """Return the draft as JSON; half a character of UTF-16 is kept, too."""
        fields = {"text": self.text, "base": self.base, "since": self.since}
        return json.dumps(fields, indent=1).encode()


class Drafts:
    """The drafts and versions of the files of one folder, for one server.

    Args:
        root: The folder of all drafts.
        folder: The real folder of the scene.
        clock: Gives seconds since 1970.
        fault: Why nothing can be kept in the folder of all drafts; "" where it can.
    """

    def __init__(
        self,
        root: Path,
        folder: Path,
        clock: Callable[[], float] = time.time,
        fault: str = "",
    ) -> None:
        self.root, self._fault = root, fault
        self._folder = root / hashlib.sha256(os.fsencode(folder)).hexdigest()
        self.versions = FileVersions(self._folder, clock)
        self._scene_folder, self._clock = folder, clock
        self._server = secrets.token_hex(4)
        _servers.add(self._server)
        self._tabs: dict[str, object] = {}  # those that live, and what they belong to
        self._texts: dict[tuple[str, str], Draft] = {}  # by tab and name: what its file has
        self._lock = new_lock()

    @classmethod
    def of_user(cls, folder: Path) -> Drafts:
        """Return the drafts of a folder in the user's state."""
        try:
            root = state_folder() / "drafts"
        except OSError as error:  # each page says it
            return cls(Path(os.devnull, "drafts"), folder, fault=_said(error))
        # Thousands of files, perhaps: the studio does not wait for them.
        threading.Thread(target=sweep, args=(root,), daemon=True).start()
        return cls(root, folder)

    def reason(self, error: OSError) -> str:
        """Return why something cannot be kept, for people."""
        return self._fault or f"{error.strerror or error} in {self.root}"

    # Tabs

    def entered(self, owner: object, before: str = "", *, is_new: bool = True) -> str:
        """Return the name of a tab that opens: the one it had before, unless another tab has it.

        Args:
            owner: Says in ``left`` that it is this one that goes.
            before: The name that the page remembers; a tab that was duplicated has the original's.
            is_new: Whether the page has no texts yet; else it is the tab that had the name, whose
                earlier connection has not ended.
        """
        end = time.monotonic() + _LEAVING_S
        while is_new and before in self._tabs and time.monotonic() < end:
            time.sleep(_TICK_S)
        with self._lock:
            is_good = re.fullmatch(r"[0-9a-f]{12}", before)
            is_free = before not in self._tabs or not is_new
            tab = before if is_good and is_free else secrets.token_hex(6)
            self._tabs[tab] = owner
        return tab

    def left(self, owner: object, tab: str) -> None:
        """Note that a tab is gone; its drafts wait for the next one."""
        with self._lock:
            if self._tabs.get(tab) is not owner:
                return
            del self._tabs[tab]
            for key in [key for key in self._texts if key[0] == tab]:
                del self._texts[key]

    def close(self) -> None:
        """End: all tabs are gone."""
        with self._lock:
            self._tabs.clear()
            _servers.discard(self._server)

    # Texts

    def put(self, tab: str, name: str, text: str, base: str) -> None:
        """Keep a tab's text of a file; the one before becomes a version if it stood for a moment.

        Raises:
            OSError: It cannot be written; the draft before stays.
        """
        with self._lock:
            before = self._texts.get((tab, name))
            if before is not None and (before.text, before.base) == (text, base):
                return
            now = self._clock()
            since = now
            if before is not None and before.text == text:
                since = before.since
            elif before is not None and now - before.since >= _STANDING_S:
                self._keep(name, before, "typed")
            draft = Draft(text, base, since)
            self._write_folder_name()
            write_private(self._path(tab, name), draft.encoded())
            self._texts[tab, name] = draft

    def drop(self, tab: str, name: str, saved: str | None) -> None:
        """Forget a tab's text of a file: the page has what the disk has.

        A text that the disk does not have becomes a version.

        Args:
            tab: The tab.
            name: The file.
            saved: The text on the disk; None if it has none.

        Raises:
            OSError: The version cannot be written, or the draft not be removed.
        """
        with self._lock:
            before = self._texts.get((tab, name))
            if before is None:
                return
            if before.text != saved:
                self._keep(name, before, "typed")
            self._path(tab, name).unlink(missing_ok=True)
            self._texts.pop((tab, name), None)

    def offered(self, tab: str, *, is_new: bool) -> tuple[dict[str, Draft], list[str]]:
        """Return a tab's drafts, and the files of which there were others, which are versions now.

        Args:
            tab: The tab.
            is_new: Whether its page has no texts yet: then it gets those of tabs that are gone.

        Raises:
            OSError: They cannot be read or renamed.
        """
        drafts: dict[str, Draft] = {}
        others: list[str] = []
        with self._lock:
            for path, draft in self._abandoned(tab, is_new=is_new):
                name = path.parent.name
                if name not in drafts:
                    if self._is_taken(path, self._path(tab, name)):
                        drafts[name] = self._texts[tab, name] = draft
                    continue
                # One that can be no version now, on a full disk, stays where it is.
                with contextlib.suppress(OSError):
                    if draft.text != drafts[name].text:
                        self._keep(name, draft, "left")
                        others.append(name)
                    path.unlink(missing_ok=True)
            return drafts, list(dict.fromkeys(others))

    def _abandoned(self, tab: str, *, is_new: bool) -> list[tuple[Path, Draft]]:
        """Return the drafts that a tab may have: its own first, then the newest."""
        candidates: list[tuple[bool, float, Path, Draft]] = []
        for path in self._folder.glob("*/*.json"):
            parts = _NAME.fullmatch(path.name)
            draft = Draft.of(path) if parts else None
            if parts is None or draft is None:
                continue
            lock_file, token, server, owner = parts.groups()
            is_ours = server == self._server
            is_gone = owner not in self._tabs if is_ours else _is_over(lock_file, token, server)
            is_own = owner == tab and (is_ours or is_gone)
            if is_own or (is_gone and is_new):
                candidates.append((is_own, draft.since, path, draft))
        candidates.sort(key=lambda candidate: candidate[:2], reverse=True)
        return [(path, draft) for _, _, path, draft in candidates]

    def _is_taken(self, path: Path, own: Path) -> bool:
        """Make a draft this tab's; return whether no other server was faster."""
        try:
            path.replace(own)
        except FileNotFoundError:
            return False
        return True

    def _keep(self, name: str, draft: Draft, why: Why) -> None:
        self.versions.keep(name, draft.text.encode("utf-8", "replace"), why)

    def _path(self, tab: str, name: str) -> Path:
        process = "-".join(process_name())
        return self._folder / name / f"{process}-{self._server}.{tab}.json"

    def _write_folder_name(self) -> None:
        """Write the name of the scene's folder, for people who look for a text."""
        about = self._folder / "folder.txt"
        if not about.exists():
            with contextlib.suppress(OSError):
                write_private(about, os.fsencode(self._scene_folder) + b"\n")


def _said(error: OSError) -> str:
    place = f" ({error.filename})" if error.filename else ""
    return f"{error.strerror or error}{place}"


def _is_over(lock_file: str, token: str, server: str) -> bool:
    """Whether a server has ended.

    One of another machine may live; to take its draft loses nothing, since it writes it again.
    """
    if (lock_file, token) == process_name():
        return server not in _servers
    return is_over(lock_file, token) is not False
