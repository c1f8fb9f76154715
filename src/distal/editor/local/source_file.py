"""A Python file as the studio has it: its text, its digest, and what is wrong with it.

Input: a path. Output: the text with lines that end by a newline alone; the bytes of a new text with
the line ends that the file had. Needs the standard library alone.
"""

from __future__ import annotations

import errno
import os
import stat
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from distal.diagnostics import LoadError
from distal.editor.scene_folder import encoded_text
from distal.file_writer import digest_of

LONGEST_FILE: Final = 8_000_000  # bytes of a file that is shown or saved
NO_FILE: Final = ""  # the digest of a file that is not there
UNREADABLE: Final = "?"  # that of one whose bytes are not known: nothing is written there
_BOM = "\ufeff"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A file's text as the app has it, and how it stands on the disk.

    Attributes:
        text: The text; lines end by a newline alone. "" where there is a problem.
        digest: The digest of the file's bytes, ``NO_FILE`` or ``UNREADABLE``.
        ends: What ends lines on the disk.
        mark: The byte order mark that begins the file, or "".
        data: The bytes.
        problem: Why it has no text, for a sentence that begins with its name; "" where it has one.
        inode: Names the file among those of its folder, whatever it is called; 0 if unknown.
    """

    text: str
    digest: str
    ends: str = "\n"
    mark: str = ""
    data: bytes = b""
    problem: str = ""
    inode: int = 0

    @classmethod
    def of(cls, path: Path) -> SourceFile:
        """Read a file; what is wrong with it is its problem."""
        try:
            with open(path, "rb", opener=_opened) as file:
                inode = os.fstat(file.fileno()).st_ino
                data = file.read(LONGEST_FILE + 1)
        except FileNotFoundError:
            is_link = os.path.islink(path)
            about = "is a link to a file that is not there" if is_link else "is not there"
            return cls("", UNREADABLE if is_link else NO_FILE, problem=about)
        except OSError as error:
            if os.path.isdir(path):
                return cls("", UNREADABLE, problem="is a folder")
            return cls("", UNREADABLE, problem=f"cannot be read: {error.strerror}")
        if len(data) > LONGEST_FILE:
            return cls("", UNREADABLE, problem=f"has more than {LONGEST_FILE:,} bytes")
        digest = digest_of(data)
        try:
            text = data.decode("utf-8")
        except UnicodeDecodeError:
            return cls("", digest, data=data, problem="is not UTF-8 text", inode=inode)
        mark = _BOM if text.startswith(_BOM) else ""
        ends = "\r\n" if "\r\n" in text else "\n"
        return cls(plain(text), digest, ends, mark, data, inode=inode)

    def encoded(self, name: str, text: str) -> bytes:
        """Return the bytes of a new text of this file.

        Raises:
            LoadError: It is too long, or has what no file can hold.
        """
        data = encoded_text(name, self.mark + text.replace("\n", self.ends))
        if len(data) > LONGEST_FILE:
            raise LoadError(f"'{name}' would have more than {LONGEST_FILE:,} bytes")
        return data


def plain(text: str) -> str:
    """Return a text without byte order mark, whose lines end by a newline alone."""
    return text.removeprefix(_BOM).replace("\r\n", "\n").replace("\r", "\n")


def _opened(path: str, flags: int) -> int:
    """Open an ordinary file; a pipe or a device would never come to its end.

    Raises:
        OSError: It is none, or it cannot be opened.
    """
    file = os.open(path, flags | getattr(os, "O_NONBLOCK", 0))
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(errno.EINVAL, "it is no ordinary file")
    return file
