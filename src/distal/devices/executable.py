"""Load object files into memory and call their functions.

Input: an object file. Output: functions that ctypes calls without Python's global lock. LLVM's
loader is used, because it handles the rules for executable memory of every system.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Final

from distal.devices.jit import llvm_binding, machine_here
from distal.devices.memory_limit import require

_LOADER_BYTES: Final = 16 * 2**20


class Executable:
    """Object files loaded into executable memory; the memory is freed with this object.

    Args:
        code: The object files, which may call each other.
    """

    def __init__(self, *code: bytes) -> None:
        llvm = llvm_binding()
        require(_LOADER_BYTES + 4 * sum(map(len, code)), "loading machine code")
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine_here())
        for each in code:
            self._engine.add_object_file(llvm.ObjectFileRef.from_data(each))
        self._engine.finalize_object()

    def function(self, name: str) -> Callable[[int], None]:
        """Return an exported function, which takes one pointer; it keeps this object alive."""
        function = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(self._address(name))

        def call(pointer: int) -> None:
            assert self._engine is not None
            function(pointer)

        return call

    def __contains__(self, name: str) -> bool:
        return self._address(name) != 0

    def _address(self, name: str) -> int:
        address: int = self._engine.get_function_address(name)
        return address
