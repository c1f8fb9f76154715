"""The end of a command that its wrapper (``distal.cli.base.reporting``) does not see.

Input: the application of typer. Output: its exit code, and one line where ``--help`` or
``--version`` cannot be written.
"""

from __future__ import annotations

import errno
from collections.abc import Callable
from typing import Final

from distal.cli.exit_codes import ExitCode
from distal.cli.messages import say

_NOT_WRITTEN: Final = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def run_to_its_end(application: Callable[[], object]) -> None:
    """Run the application of typer.

    Raises:
        SystemExit: It has ended.
    """
    try:
        application()
    except SystemExit as end:
        if isinstance(end.__context__, BrokenPipeError):  # typer and rich make it a 1
            raise SystemExit(ExitCode.PIPE_CLOSED) from None
        raise
    except OSError as error:
        if error.errno not in _NOT_WRITTEN or error.filename is not None:
            raise
        say(f"error: cannot write to stdout: {error.strerror}")
        raise SystemExit(ExitCode.FAILED) from None
