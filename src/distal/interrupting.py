"""Ctrl-C: when it ends the process at once, when it raises, and by the program itself.

Without a command of distal nothing here changes what ctrl-C does. Needs the standard library alone,
and imports little of it: a command imports this first.
"""

from __future__ import annotations

import os
import signal

INTERRUPTED = 130  # of a process that ctrl-C ends, as shells give it


def end_at_once() -> None:
    """Let ctrl-C end this process without a word, from now on.

    For the time in which nothing is to be tidied: while a command is imported, and after it. A
    process that ignores ctrl-C, as a shell's job in the background, goes on ignoring it.
    """
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _end)


class CtrlCRaises:
    """A context in which ctrl-C raises ``KeyboardInterrupt``, where it would end the process."""

    def __enter__(self) -> None:
        self._is_switched = signal.getsignal(signal.SIGINT) is _end
        if self._is_switched:
            signal.signal(signal.SIGINT, signal.default_int_handler)

    def __exit__(self, *_: object) -> None:
        if self._is_switched:
            signal.signal(signal.SIGINT, _end)


def interrupt_main() -> None:
    """Interrupt the main thread as ctrl-C does; where the system can, also a call that waits."""
    import threading  # noqa: PLC0415 (not before the first line of a command)

    number = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and number is not None:
        signal.pthread_kill(number, signal.SIGINT)
    else:
        import _thread  # noqa: PLC0415

        _thread.interrupt_main()


def raise_in(thread: int, kind: type[BaseException]) -> None:
    """Raise an exception in a thread at its next step in Python.

    Args:
        thread: The thread's ``ident``.
        kind: The exception. One that has not arrived yet is replaced.
    """
    import ctypes  # noqa: PLC0415 (only where something hangs)

    ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread), ctypes.py_object(kind))


def _end(*_: object) -> None:
    os._exit(INTERRUPTED)
