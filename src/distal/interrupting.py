"""Ctrl-C by the program itself, where the one of a person was lost or is to be repeated.

Needs the standard library alone.
"""

from __future__ import annotations

import _thread
import signal
import threading


def interrupt_main() -> None:
    """Interrupt the main thread as ctrl-C does; where the system can, also a call that waits."""
    number = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and number is not None:
        signal.pthread_kill(number, signal.SIGINT)
    else:
        _thread.interrupt_main()
