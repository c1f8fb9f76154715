"""Lines about the work behind a scene, for hosts that print them: the commands.

Input: lines from the library. Output: the same lines, each once in a process, to the host's
function; nothing if there is none. Imports nothing.
"""

from __future__ import annotations

from collections.abc import Callable

_hosts: list[Callable[[str], object]] = []
_given: set[str] = set()


def receive_notices(function: Callable[[str], object]) -> None:
    """Call a function with each further line."""
    _hosts.append(function)


def notice(line: str) -> None:
    """Give a line to the host, unless it had it before: scenes are loaded again when they change.

    Args:
        line: What was done, with figures, and how to do it otherwise.
    """
    if not _hosts or line in _given:
        return
    _given.add(line)
    for function in _hosts:
        function(line)
