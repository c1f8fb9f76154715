"""Images put into memory and called.

What flows in: an ``Image``. What flows out: functions that ctypes calls without Python's lock.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import mmap
import struct
import sys
from collections.abc import Callable

from distal.devices.link import Image


class Executable:
    """An image in memory that may be run; the memory is given back with the object."""

    def __init__(self, image: Image) -> None:
        if sys.platform == "win32":
            raise OSError("the CPU device runs on Linux and macOS only, so far")
        size = -(-max(1, len(image.code)) // mmap.PAGESIZE) * mmap.PAGESIZE
        code = bytearray(image.code)
        for name, slot in image.imports.items():
            struct.pack_into("<Q", code, slot, _library_address(name))
        # Never writable and executable at once.
        self._memory = mmap.mmap(-1, size, mmap.MAP_PRIVATE | mmap.MAP_ANON)
        self._memory.write(bytes(code))
        view = (ctypes.c_char * size).from_buffer(self._memory)
        self._view = view  # keeps the mapping alive and in place
        self._base = ctypes.addressof(view)
        library = ctypes.CDLL(None, use_errno=True)
        if library.mprotect(
            ctypes.c_void_p(self._base), ctypes.c_size_t(size), mmap.PROT_READ | mmap.PROT_EXEC
        ):
            raise OSError(ctypes.get_errno(), "the system refuses memory for compiled code")
        self._entries = image.entries

    def function(self, name: str) -> Callable[[int], None]:
        """An exported function that takes one pointer; it keeps the image in memory."""
        prototype = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
        function = prototype(self._base + self._entries[name])

        def call(pointer: int) -> None:
            assert self._memory is not None
            function(pointer)

        return call

    def __contains__(self, name: str) -> bool:
        return name in self._entries


def _library_address(name: str) -> int:
    """Where a function of the C or mathematics library is."""
    for library in (None, ctypes.util.find_library("m")):
        try:
            function = getattr(ctypes.CDLL(library), name)
        except (AttributeError, OSError):
            continue
        address = ctypes.cast(function, ctypes.c_void_p).value
        assert address is not None
        return address
    raise OSError(f"the C library has no {name}")
