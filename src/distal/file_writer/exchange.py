"""Exchange two files in one step, where the system can.

Input: two paths in one folder. Output: whether each now names the other's file. After a plain
rename nobody can say which file it replaced: another program may have saved a moment before.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from pathlib import Path
from typing import Any, Final

_CURRENT_FOLDER: Final = -100  # AT_FDCWD of Linux
_EXCHANGE: Final = 2  # RENAME_EXCHANGE of Linux, RENAME_SWAP of macOS


def exchange(first: Path, second: Path) -> bool:
    """Exchange two files; return False if nothing has changed, because the system cannot do it."""
    function = _function()
    if function is None:
        return False
    one, other = os.fsencode(first), os.fsencode(second)
    if sys.platform == "darwin":
        return bool(function(one, other, _EXCHANGE) == 0)
    return bool(function(_CURRENT_FOLDER, one, _CURRENT_FOLDER, other, _EXCHANGE) == 0)


@cache
def _function() -> Any:
    """Return the system's function: glibc has it since 2.28, musl not."""
    if sys.platform not in ("linux", "darwin"):
        return None
    import ctypes  # noqa: PLC0415 (most commands do not need it)

    name = "renamex_np" if sys.platform == "darwin" else "renameat2"
    try:
        function = getattr(ctypes.CDLL(None), name)
    except (OSError, AttributeError):
        return None
    if sys.platform == "darwin":
        function.argtypes = (ctypes.c_char_p, ctypes.c_char_p, ctypes.c_uint)
    else:
        path, number = ctypes.c_char_p, ctypes.c_int
        function.argtypes = (number, path, number, path, ctypes.c_uint)
    function.restype = ctypes.c_int
    return function
