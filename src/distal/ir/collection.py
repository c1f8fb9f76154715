"""Pause Python's garbage collector while a compilation makes nodes.

A compilation makes some hundred thousand objects that live as long as it does and form no cycles.
The collector would traverse them again and again: of 200 parts, a fifth of the passes' time.
"""

from __future__ import annotations

import gc
import threading
from collections.abc import Iterator
from contextlib import contextmanager

from distal.forking import after_fork, new_lock


class _Depth(threading.local):
    """How many blocks this thread is in."""

    value = 0


_LOCK = new_lock()
_depth = _Depth()
_pausing = 0  # blocks of all threads; the collector is switched by the first and by the last


@contextmanager
def paused_collection() -> Iterator[None]:
    """Collect no garbage during the block, unless the program has paused the collector itself.

    The collector is the process's: with several threads, it is paused until the last block ends.
    """
    is_counted = _begin()
    try:
        yield
    finally:
        if is_counted:
            _end()


def _begin() -> bool:
    global _pausing
    with _LOCK:
        if _pausing == 0 and not gc.isenabled():
            return False
        gc.disable()
        _pausing += 1
        _depth.value += 1
        return True


def _end() -> None:
    global _pausing
    with _LOCK:
        _pausing -= 1
        _depth.value -= 1
        if _pausing == 0:
            gc.enable()


def _forked() -> None:
    """Forget, in a forked child, the blocks of threads that it does not have."""
    global _pausing
    if _pausing and not _depth.value:
        gc.enable()
    _pausing = _depth.value


after_fork(_forked)
