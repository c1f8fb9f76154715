"""Several kinds of work at once: items are made, in order, while others take those that are made.

Input: a function that makes, one that takes. Output: each item is given to a
function that runs on threads of its own; a few wait in between, so that memory stays flat. Knows
nothing of pictures.
"""

from __future__ import annotations

import queue
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from typing import Final, Generic, TypeVar

Item = TypeVar("Item")
Given = TypeVar("Given")
# How many may wait: one on the way out and one on the way in, and two for an uneven pace.
WAITING: Final = 4
_LOOK_S: Final = 0.1  # how long a failure on the other side may stay unseen


class Taker(Generic[Item]):
    """Gives items to threads; the first failure of theirs comes back to who puts the next."""

    def __init__(self, take: Callable[[Item], None], workers: int) -> None:
        self._take = take
        self._queue: queue.Queue[Item | None] = queue.Queue(WAITING)
        self._failure: BaseException | None = None
        self._ended = threading.Event()
        # Daemons: an encoder in the middle of a frame does not hold up an interpreter that ends.
        self._threads = [threading.Thread(target=self._run, daemon=True) for _ in range(workers)]
        for thread in self._threads:
            thread.start()

    def put(self, item: Item | None) -> None:
        """Pass on an item; waits while too many are underway."""
        while True:
            if self._failure is not None:
                raise self._failure
            try:
                self._queue.put(item, timeout=_LOOK_S)
                return
            except queue.Full:
                continue

    def finish(self) -> None:
        """Wait until all is taken."""
        for _ in self._threads:
            self.put(None)
        self._join()
        if self._failure is not None:
            raise self._failure

    def abandon(self) -> None:
        """Drop what waits; what is being worked on ends."""
        self._ended.set()
        self._join()

    def _join(self) -> None:
        for thread in self._threads:
            while thread.is_alive():
                thread.join(_LOOK_S)  # in turns, so that ctrl-C is heard everywhere

    def _run(self) -> None:
        while not self._ended.is_set():
            try:
                item = self._queue.get(timeout=_LOOK_S)
            except queue.Empty:
                continue
            if item is None:
                return
            try:
                self._take(item)
            except BaseException as error:
                if self._failure is None:
                    self._failure = error
                self._ended.set()
                return


@contextmanager
def taking(take: Callable[[Item], None], workers: int = 1) -> Iterator[Taker[Item]]:
    """Work on items beside the block; at its end all are done, or the first failure is raised."""
    taker = Taker(take, workers)
    try:
        yield taker
        taker.finish()
    except BaseException:
        taker.abandon()
        raise


def made_ahead(
    make: Callable[[Given], Item], given: Iterable[Given], count: int, stop: Callable[[], object]
) -> Generator[Item, None, None]:
    """What ``make`` makes of each, in order, ``count`` of them being made at once.

    Close it when it is left early: then ``stop`` is called, which should end what is being made.
    """
    waiting: deque[Future[Item]] = deque()
    with ThreadPoolExecutor(count) as pool:
        try:
            for each in given:
                waiting.append(pool.submit(make, each))
                if len(waiting) == count:
                    yield _result(waiting.popleft())
            while waiting:
                yield _result(waiting.popleft())
        except BaseException:
            stop()
            for future in waiting:
                future.cancel()
            raise


def _result(future: Future[Item]) -> Item:
    while True:
        try:
            return future.result(_LOOK_S)  # in turns, so that ctrl-C is heard everywhere
        except TimeoutError:
            if future.done():
                return future.result()
