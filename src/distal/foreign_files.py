"""Files of strangers: how much memory and time a file may take, and errors in one line.

Input: a file and what it should be (``KINDS``). Output: its bytes inside of a context, in which a
reader asks ``need`` before it allocates and ``check_time`` where its work is not bounded by what it
has asked for. Every exception leaves the context as one line that names the file. Needs the
standard library alone.

The budget of a file is ``BASE_BYTES`` + ``BYTES_A_BYTE`` x its size, and of the processor's time
``BASE_SECONDS`` + ``SECONDS_A_MEGABYTE`` x its size in MB. A count in a file is compared with the
budget before anything of that size is allocated; what a packed part unpacks to is counted while it
streams. ``max_memory=`` of a loader, or the variable ``MEMORY_VARIABLE``, replaces the budget, and
lifts the limit of time (decision 100).
"""

from __future__ import annotations

import os
import re
import stat
import struct
import sys
import time
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from typing import Final, TypeAlias, TypeVar

from distal.diagnostics import LONGEST_MESSAGE, CompileError, LoadError, printable
from distal.packages import PackageError
from distal.read_watch import limited

# A picture of 2^25 pixels at 24 bytes each, which may be a file of some kB if it is of one color.
BASE_BYTES: Final = 768 * 2**20
# Text of meshes takes the most: "v 0 0 0" is a line, a list of words, then one of floats, 30 bytes
# for each of its own. Twice that is for what honest packing saves.
BYTES_A_BYTE: Final = 64
BASE_SECONDS: Final = 5.0
SECONDS_A_MEGABYTE: Final = 2.0
MEMORY_VARIABLE: Final = "DISTAL_MAX_MEMORY"

# What ``max_memory=`` takes: bytes, or a text as "4 GB".
Memory: TypeAlias = int | str
_UNITS: Final = {"B": 1, "kB": 10**3, "MB": 10**6, "GB": 10**9, "TB": 10**12}
_MEMORY: Final = re.compile(r"\s*([0-9]{1,15}(?:\.[0-9]{1,6})?)\s*([kKMGT]?B)\s*")
_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True)
class FileKind:
    """A kind of file that others write.

    Attributes:
        sentence: The message about a damaged file, of {file} and {reason}.
        unreadable: That about a file whose bytes cannot be read.
        largest: The most bytes of such a file.
    """

    sentence: str
    unreadable: str
    largest: int = 2**30


_UNREADABLE: Final = "cannot read '{file}': {reason}"


def _data(name: str, largest: int = 2**30) -> FileKind:
    return FileKind(f"'{{file}}' is no {name} that can be read: {{reason}}", _UNREADABLE, largest)


def _picture(name: str, largest: int = 2**30) -> FileKind:
    return FileKind(f"{{file}} is broken: it is no whole {name}: {{reason}}", _UNREADABLE, largest)


def _one(sentence: str, largest: int = 2**30) -> FileKind:
    return FileKind(sentence, sentence, largest)


# All kinds. ``tools/sweep_readers.py`` has files of each to damage.
KINDS: Final = {
    "STL": _data("STL"),
    "OBJ": _data("OBJ"),
    "PLY": _data("PLY"),
    "GLB": _data("GLB"),
    "3MF": _data("3MF"),
    "points": _data("file of points"),
    "volume": _data("volume", 2**31),
    "texture": _one("the texture '{file}' cannot be read: {reason}"),
    "sound": _one("cannot read the sound {file}: {reason}"),
    "font": _one("the font '{file}' cannot be read: {reason}", 2**28),
    "drawing": _one("{file} cannot be read: {reason}", 2**26),
    ".vm": _one(_UNREADABLE, 2**23),
    "film": _one("{file} is not a film: delete it or name another ({reason})", 2**34),
    "frame": _one("cannot read the frame {file}: {reason}"),
    "PNG": _picture("PNG"),
    "JPEG": _picture("JPEG"),
    "EXR": _picture("EXR", 2**33),
    "triangles": _one("{file} is no picture as triangles: {reason}", 2**26),
    "lesson": _one("cannot read {file}: {reason}", 2**24),
    "list": _one("{file}: {reason}", 2**26),
    "table": _one("{file} cannot be read: {reason}", 2**28),
}


class TooLargeError(LoadError):
    """A file would take more memory or time than files of its size get; the message is whole."""


class Budget:
    """What a file may take.

    Args:
        kind: What it should be.
        file: Its name in messages.
        size: Its size in bytes.
        max_memory: The most bytes that it may become, as the author gives them; None: by its size.
        option: Whether the author can give them.
    """

    __slots__ = ("_begin", "_is_trusted", "_option", "file", "kind", "most", "seconds", "size")

    def __init__(
        self, kind: FileKind, file: str, size: int, max_memory: Memory | None, *, option: bool
    ) -> None:
        self.kind, self.file, self.size, self._option = kind, file, size, option
        allowed = memory_of(max_memory)
        self._is_trusted = allowed is not None
        self.most = BASE_BYTES + BYTES_A_BYTE * size if allowed is None else allowed
        self.seconds = BASE_SECONDS + SECONDS_A_MEGABYTE * size / 1e6
        self._begin = time.thread_time()

    def need(self, count: int | float, what: str) -> None:
        """Check that so many bytes are within the budget.

        Args:
            count: The bytes that the file has become, with those to be allocated next.
            what: What they are of, "20,000 copies of 1,600 triangles".

        Raises:
            TooLargeError: They are not.
        """
        if count <= self.most:
            return
        enough = _rounded_up(count)
        raise TooLargeError(
            f"'{self.file}' of {shown(self.size)} would become {shown(count)}: {what}; "
            f"{self._limit()}{self._fix(enough)} reads it anyway"
        )

    def check_time(self) -> None:
        """Check that the reader has not taken longer than files of this size may.

        Raises:
            TooLargeError: It has.
        """
        if not self._is_trusted and time.thread_time() - self._begin > self.seconds:
            raise self.late()

    def late(self) -> TooLargeError:
        """Return the error of a file that took too long."""
        enough = _rounded_up(max(self.most, 1e9))
        return TooLargeError(
            f"'{self.file}' of {shown(self.size)} is not read after {self.seconds:.0f} s, which "
            f"files of this size get; {self._fix(enough)} reads it anyway"
        )

    def over(self) -> TooLargeError:
        """Return the error of a file that took too much memory."""
        return TooLargeError(
            f"'{self.file}' of {shown(self.size)} takes more than {shown(self.most)}, which files "
            f"of this size get; {self._fix(_rounded_up(2 * self.most))} reads it anyway"
        )

    @property
    def is_watched(self) -> bool:
        """Whether a thread ends a reader that asks nobody."""
        return not self._is_trusted and sys.platform != "emscripten"

    def _limit(self) -> str:
        who = "it may take" if self._is_trusted else "files of this size get"
        return f"{who} {shown(self.most)}; "

    def _fix(self, enough: str) -> str:
        variable = f"{MEMORY_VARIABLE}={enough.replace(' ', '')}"
        return f'max_memory="{enough}" or {variable}' if self._option else variable


_CURRENT: Final[ContextVar[Budget | None]] = ContextVar("distal-budget", default=None)


def need(count: int | float, what: str) -> None:
    """Check the budget of the file that is read; see ``Budget.need``. Arrays have none."""
    budget = _CURRENT.get()
    if budget is not None:
        budget.need(count, what)


def need_pixels(width: int, height: int, pixel_bytes: int) -> None:
    """Check the budget for a picture; see ``need``."""
    need(width * height * pixel_bytes, f"{width:,} x {height:,} pixels")


def check_time() -> None:
    """Check the time of the file that is read; see ``Budget.check_time``."""
    budget = _CURRENT.get()
    if budget is not None:
        budget.check_time()


@contextmanager
def opened(
    kind: str,
    path: str | os.PathLike[str],
    *,
    name: str | None = None,
    error: Callable[[str], Exception] = LoadError,
    max_memory: Memory | None = None,
    option: bool = False,
) -> Iterator[bytes]:
    """Read a file; in the context its bytes are parsed.

    Args:
        kind: A key of ``KINDS``.
        path: The file.
        name: Its name in messages; None for its path.
        error: What is raised, from a message.
        max_memory: The most bytes that it may become; None: by its size.
        option: Whether the author can give them to the loader.

    Raises:
        Exception: As ``error`` says: the file cannot be read, is damaged, or is too large.
    """
    shown_name = printable(path if name is None else name)
    with _one_line(KINDS[kind].unreadable, shown_name, error):
        data = _content(Path(path), KINDS[kind].largest)
    with reading(kind, shown_name, len(data), error=error, max_memory=max_memory, option=option):
        yield data


@contextmanager
def reading(
    kind: str,
    name: str,
    size: int,
    *,
    error: Callable[[str], Exception] = LoadError,
    max_memory: Memory | None = None,
    option: bool = False,
) -> Iterator[Budget]:
    """A context in which something of a stranger is parsed; as ``opened`` without a file.

    Args:
        kind: A key of ``KINDS``.
        name: Its name in messages.
        size: Its size in bytes.
        error: What is raised, from a message.
        max_memory: The most bytes that it may become; None: by its size.
        option: Whether the author can give them to the loader.
    """
    try:
        budget = Budget(KINDS[kind], name, size, max_memory, option=option)
    except ValueError as wrong:
        raise error(str(wrong)) from None
    with _one_line(KINDS[kind].sentence, name, error), _entered(budget):
        yield budget


@contextmanager
def bounded(
    kind: str, path: Path, size: int, *, max_memory: Memory | None = None
) -> Iterator[None]:
    """A context for what is made of a file that was read; ``need`` and ``check_time`` know it.

    Args:
        kind: A key of ``KINDS``.
        path: The file.
        size: Its size in bytes.
        max_memory: The most bytes that it may become; None: by its size.

    Raises:
        LoadError: It needs more memory than it may have, or than there is.
    """
    name = printable(path)
    try:
        with _entered(Budget(KINDS[kind], name, size, max_memory, option=True)):
            yield
    except MemoryError as error:
        raise LoadError(f"cannot read '{name}': {reason_of(error)}") from None


@contextmanager
def _entered(budget: Budget | None) -> Iterator[None]:
    token = _CURRENT.set(budget)
    try:
        yield
    finally:
        _CURRENT.reset(token)


@contextmanager
def _one_line(sentence: str, name: str, error: Callable[[str], Exception]) -> Iterator[None]:
    """Make one line of every exception of a reader."""
    try:
        yield
    except (CompileError, PackageError):  # these show the author's line, or what to install
        raise
    except TooLargeError as caught:
        raise caught if error is LoadError else error(caught.message) from None
    except Exception as caught:
        is_own = isinstance(error, type) and error not in (LoadError, ValueError)
        if is_own and isinstance(caught, error):  # type: ignore[arg-type]  # it is a class
            raise
        reason = reason_of(caught)
        if isinstance(caught, LoadError) and reason.startswith("cannot read"):
            raise
        text = sentence.format(file=name, reason=reason)
        cause = None if isinstance(caught, LoadError | OSError) else caught
        raise error(printable(text, LONGEST_MESSAGE)) from cause


def reason_of(error: BaseException) -> str:
    """Return in words what an exception of a reader says about its file."""
    match error:
        case LoadError():
            return error.message
        case MemoryError():
            return "it needs more memory than there is"
        case RecursionError():
            return "its parts are nested too deeply"
        case UnicodeDecodeError():
            return "it is no text in UTF-8"
        case OverflowError():
            return "a number in it is too large"
        case IndexError() | KeyError():
            return f"it is damaged: a part of it is missing ({printable(error, 60)})"
        case OSError() if error.strerror:
            return error.strerror
        case EOFError() | struct.error():
            return f"it ends early: {error}" if str(error) else "it ends early"
        case zlib.error() | zipfile.BadZipFile():
            return f"its packed part is damaged: {error}"
    return str(error) or f"it is damaged ({type(error).__name__})"


def _content(path: Path, most: int) -> bytes:
    """Return the content of a file.

    Raises:
        LoadError: It is no ordinary file, is empty, or is too large.
        OSError: The file system reports an error.
    """
    try:
        info = path.stat()
        if not stat.S_ISREG(info.st_mode):
            is_folder = stat.S_ISDIR(info.st_mode)
            raise LoadError("Is a directory" if is_folder else "it is no ordinary file")
        with path.open("rb") as file:
            # Not ``most``: as much is allocated before the first byte comes.
            data = b"" if info.st_size > most else file.read(info.st_size)
    except ValueError as error:  # a null character in the name
        raise LoadError(str(error)) from None
    if info.st_size > most:
        raise LoadError(f"it is larger than {most >> 20} MiB")
    if not data:
        raise LoadError("it is empty")
    return data


def watched(work: Callable[[], _Result]) -> _Result:
    """Return what a package makes of the file that is read; it is ended at its limits.

    For packages whose loops ask neither for the time nor for memory.

    Raises:
        TooLargeError: It has taken more time, or on Linux more memory, than the file may.
    """
    budget = _CURRENT.get()
    if budget is None or not budget.is_watched:
        return work()
    return limited(work, budget.seconds, budget.most, (budget.late, budget.over))


def memory_of(amount: Memory | None) -> int | None:
    """Return bytes from ``max_memory=``, or else from the variable; None for neither.

    Raises:
        ValueError: It is no amount of memory.
    """
    what = "max_memory"
    if amount is None:
        amount, what = os.environ.get(MEMORY_VARIABLE) or None, MEMORY_VARIABLE
    if amount is None:
        return None
    parts = _MEMORY.fullmatch(amount) if isinstance(amount, str) else None
    if parts is not None:
        count = int(float(parts[1]) * _UNITS[parts[2].replace("KB", "kB")])
    elif isinstance(amount, bool) or not isinstance(amount, int):
        raise ValueError(f'{what} is an amount of memory as "4 GB", not {printable(amount, 40)!r}')
    else:
        count = amount
    if count <= 0:
        raise ValueError(f"{what} is above 0, not {count}")
    return count


def shown(count: int | float) -> str:
    """Return a number of bytes with two digits: "1.1 MB"."""
    unit, factor = next(
        ((u, f) for u, f in reversed(_UNITS.items()) if count >= 0.9995 * f), ("B", 1)
    )
    value = count / factor
    return f"{value:.1f} {unit}" if value < 9.95 and factor > 1 else f"{value:,.0f} {unit}"


def _rounded_up(count: int | float) -> str:
    """Return an amount with a margin, as an author writes it."""
    return f"{-(-int(1.05 * count) // 10**9)} GB"
