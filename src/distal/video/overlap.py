"""Run two kinds of work at the same time: items are made in order while other threads take them.

Input: a function that makes items, a function that takes them. Output: each item is passed to the
second function, on separate threads. Few items wait in between, so memory use is constant. Does not
depend on pictures.
"""

from __future__ import annotations

import queue
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from typing import Final, Generic, TypeVar

Item = TypeVar("Item")
Given = TypeVar("Given")
# Maximum number of waiting items: one for each side, and two more for uneven speed.
WAITING: Final = 4
_LOOK_S: Final = 0.1  # the longest time before an error of the other side is noticed


class Taker(Generic[Item]):
    """Passes items to threads; ``put`` or ``finish`` raises the first error of a thread."""

    def __init__(self, take: Callable[[Item], None], workers: int) -> None:
        self._take = take
        self._queue: queue.Queue[Item | None] = queue.Queue(WAITING)
        self._failure: BaseException | None = None
        self._ended = threading.Event()
        # Daemon threads, so that an encoder in the middle of a frame does not delay the exit.
        self._threads = [threading.Thread(target=self._run, daemon=True) for _ in range(workers)]
        for thread in self._threads:
            thread.start()

    def put(self, item: Item | None) -> None:
        """Pass on an item; wait while too many are in the queue.

        Raises:
            BaseException: The first error of a thread.
        """
        while True:
            if self._failure is not None:
                raise self._failure
            try:
                self._queue.put(item, timeout=_LOOK_S)
                return
            except queue.Full:
                continue

    def finish(self) -> None:
        """Wait until all items are taken.

        Raises:
            BaseException: The first error of a thread.
        """
        for _ in self._threads:
            self.put(None)
        self._join()
        if self._failure is not None:
            raise self._failure

    def abandon(self) -> None:
        """Drop waiting items; work on current items is finished."""
        self._ended.set()
        self._join()

    def _join(self) -> None:
        for thread in self._threads:
            while thread.is_alive():
                thread.join(_LOOK_S)  # with a timeout, so that ctrl-C is handled on every platform

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
    """Take items on threads during the block; its end waits for them or raises the first error."""
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
    """Yield ``make`` of each item, in order, computing several at the same time.

    If the generator is closed early, ``stop`` is called.

    Args:
        make: Makes an item.
        given: The arguments for ``make``.
        count: How many items to make at the same time.
        stop: Should end the work on items that are being made.
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


def made_at_once(
    make: Callable[[Given], Item], given: Iterable[Given], count: int, stop: Callable[[], object]
) -> Generator[Item, None, None]:
    """Yield ``make`` of each item as it is finished, in any order; arguments of ``made_ahead``."""
    rest, working = iter(given), set[Future[Item]]()
    with ThreadPoolExecutor(count) as pool:
        try:
            while True:
                working |= {pool.submit(make, each) for each in islice(rest, count - len(working))}
                if not working:
                    return
                # With a timeout, so that ctrl-C is handled everywhere.
                done, working = wait(working, _LOOK_S, FIRST_COMPLETED)
                for future in done:
                    yield future.result()
        except BaseException:
            stop()
            for future in working:
                future.cancel()
            raise


def _result(future: Future[Item]) -> Item:
    while True:
        try:
            return future.result(_LOOK_S)  # with a timeout, so that ctrl-C is handled everywhere
        except TimeoutError:
            if future.done():
                return future.result()
