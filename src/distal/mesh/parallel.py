"""Apply a function to pieces of work in several threads.

Input: a function and pieces. Output: its results, in the order of the pieces, whatever the number
of threads. Compiled kernels and NumPy release the lock of the interpreter, so pieces run at the
same time. The calling thread only waits: it reports progress and is cancelled.
"""

from __future__ import annotations

import itertools
import threading
from collections.abc import Callable, Sequence
from typing import Final, Generic, TypeVar, cast

from distal.devices import threads
from distal.mesh.solid import Integers

Piece = TypeVar("Piece")
Result = TypeVar("Result")
# Rows in a piece: their columns fit into the cache of a processor.
ROWS_AT_ONCE: Final = 1 << 14
_WATCH_S: Final = 0.02  # the longest delay of progress and of a request to stop


class _PieceThread(threading.Thread):
    """A thread that computes pieces. Its stack is large enough for every kernel."""


def is_worker() -> bool:
    """Return whether this thread computes pieces: its kernels need no threads of their own."""
    return isinstance(threading.current_thread(), _PieceThread)


def parallel_map(
    function: Callable[[Piece], Result],
    pieces: Sequence[Piece],
    watch: Callable[[float], None] = lambda share: None,
) -> list[Result]:
    """Return the results of a function for pieces, in their order.

    Args:
        function: The function; several threads call it at the same time.
        pieces: Its arguments.
        watch: Called in the calling thread with the share of the pieces that are begun. What it
            raises ends the work, as ctrl-C does; pieces that are begun are finished first.

    Raises:
        BaseException: What the function raises for the first of the pieces for which it does.
        MemoryError: The system starts no thread.
    """
    if len(pieces) < 2 or is_worker():
        found = [function(piece) for piece in pieces]
        watch(1.0)
        return found
    run = _MapRun(function, pieces)
    workers: list[threading.Thread] = [
        _PieceThread(target=run.work, daemon=True)
        for _ in range(min(threads.usable_threads(), len(pieces)))
    ]
    started: list[threading.Thread] = []
    try:
        threads.start_threads(workers, started)
        for thread in started:
            while thread.is_alive():
                thread.join(_WATCH_S)
                watch(run.share)
    finally:
        run.stopped.set()
        for thread in started:
            thread.join()
    if run.failures:
        raise run.failures[min(run.failures)]
    watch(1.0)
    return cast("list[Result]", run.found)


def by_one_thread(function: Callable[[], Result]) -> Result:
    """Return the result of a function that is computed by one thread, with the same bits.

    Raises:
        BaseException: What the function raises.
        MemoryError: The system starts no thread.
    """
    run: _MapRun[None, Result] = _MapRun(lambda _: function(), [None])
    started: list[threading.Thread] = []
    threads.start_threads([_PieceThread(target=run.work, daemon=True)], started)
    for thread in started:
        thread.join()
    if run.failures:
        raise run.failures[0]
    return cast("Result", run.found[0])


class _MapRun(Generic[Piece, Result]):
    """What the threads of one map share.

    Attributes:
        found: The results so far.
        failures: What was raised, by piece. Pieces are begun in their order, and those that are
            begun are finished: the first that fails is always among them.
        stopped: Set when no piece is to be begun.
        share: The share of the pieces that are begun.
    """

    def __init__(self, function: Callable[[Piece], Result], pieces: Sequence[Piece]) -> None:
        self._function, self._pieces = function, pieces
        self._numbers = itertools.count()  # a number is taken by one thread only
        self.found: list[Result | None] = [None] * len(pieces)
        self.failures: dict[int, BaseException] = {}
        self.stopped = threading.Event()
        self.share = 0.0

    def work(self) -> None:
        """Compute pieces until none is left."""
        while not self.stopped.is_set():
            number = next(self._numbers)
            if number >= len(self._pieces):
                return
            self.share = number / len(self._pieces)
            try:
                self.found[number] = self._function(self._pieces[number])
            except BaseException as error:  # raised in the calling thread
                self.failures[number] = error
                self.stopped.set()


def pieces(rows: Integers) -> list[Integers]:
    """Return rows in pieces that need little memory, none of them empty."""
    return [rows[some] for some in slices_of(len(rows))]


def slices_of(count: int, at_once: int = ROWS_AT_ONCE) -> list[slice]:
    """Return rows in pieces, none of them empty."""
    return [slice(first, min(first + at_once, count)) for first in range(0, count, at_once)]
