"""Check what surrounds a command before it begins: memory, the working folder, the environment.

Input: this process. Output: nothing, or one clear error. Does not depend on typer.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import Final

from distal.cli.arguments import UsageError
from distal.devices.memory_limit import is_limited, require
from distal.file_writer import SaveError

_NUMPY_BYTES: Final = 96 * 2**20  # measured: 85 with one OpenBLAS thread, 41 per further thread


def prepare_for_arrays() -> None:
    """Refuse a memory limit under which NumPy's BLAS would end the process with its own message.

    Raises:
        MemoryError: The memory that is left is not enough.
    """
    if is_limited() and "numpy" not in sys.modules:
        os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # distal multiplies no large matrices
        require(_NUMPY_BYTES, "NumPy")


def check_working_folder() -> None:
    """Check that there is a working folder, which names of files are relative to.

    Raises:
        SaveError: It was deleted.
    """
    try:
        os.getcwd()
    except OSError:
        raise SaveError("the working folder was deleted; change to another one") from None


def check_processor() -> None:
    """Check that the processor can run the code of the CPU device.

    Raises:
        UsageError: It cannot, or a variable of the environment has a value that it must not have.
    """
    from distal.devices.features import chosen_level

    _checked(chosen_level)
    check_cache()


def check_cache() -> None:
    """Check the variables of the environment that the cache and readers of files use.

    Raises:
        UsageError: One has a value that it must not have.
    """
    from distal.devices.cache import size_limit
    from distal.devices.kernel_key import optimization
    from distal.foreign_files import memory_of

    _checked(size_limit)
    _checked(optimization)
    _checked(lambda: memory_of(None))


def _checked(read: Callable[[], object]) -> None:
    try:
        read()
    except ValueError as error:
        raise UsageError(str(error)) from None
