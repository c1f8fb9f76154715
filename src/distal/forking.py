"""What a forked process renews: locks that other threads of its parent held, and imports.

A thread that held a lock in the parent does not exist in the child, and would never free it.
Python itself renews only some locks of its own: not those of modules that are being imported, which
distal imports when they are first needed.
"""

from __future__ import annotations

import importlib
import os
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, Final
from weakref import WeakSet

_LOCKS: Final[WeakSet[Any]] = WeakSet()
_AFTER_FORK: Final[list[Callable[[], object]]] = []
_MAKING_LOCKS: Final = threading.RLock()
_LONGEST_IMPORT_S: Final = 5.0


def new_lock() -> Any:
    """Return a lock that is free in a forked child; reentrant.

    Callbacks of weak references run inside any allocation, also under a lock of the same thread.
    """
    return kept_free(threading.RLock())


def kept_free(lock: Any) -> Any:
    """Free a reentrant lock in forked children, unless the thread that forks has it; return it."""
    with _MAKING_LOCKS:
        _LOCKS.add(lock)
    return lock


def after_fork(renew: Callable[[], object]) -> None:
    """Call a function in each forked child."""
    _AFTER_FORK.append(renew)


def _imports_of_others() -> Iterator[Any]:
    """The locks of modules that other threads import now; CPython keeps them by name."""
    here = threading.get_ident()
    locks = getattr(getattr(importlib, "_bootstrap", None), "_module_locks", {})
    for reference in list(locks.values()):
        lock = reference()
        if lock is not None and getattr(lock, "owner", None) not in (None, here):
            yield lock


def _before() -> None:
    until = time.monotonic() + _LONGEST_IMPORT_S
    while any(_imports_of_others()) and time.monotonic() < until:
        time.sleep(0.001)


def _in_child() -> None:
    for lock in [_MAKING_LOCKS, *_LOCKS]:
        if not lock._is_owned():
            lock._at_fork_reinit()
    for lock in _imports_of_others():  # an import that began after ``_before``
        module = sys.modules.get(lock.name)
        if getattr(getattr(module, "__spec__", None), "_initializing", False):
            sys.modules.pop(lock.name, None)
        with suppress(AttributeError, TypeError):
            lock.__init__(lock.name)
    for renew in _AFTER_FORK:
        renew()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_before, after_in_child=_in_child)
