"""A folder that one worker of a run makes, and that the others read."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest

LIMIT_S = 600.0


def made_once(factory: pytest.TempPathFactory, name: str, make: Callable[[Path], object]) -> Path:
    """Return a folder of the run that ``make`` has filled, in this process or in another worker's.

    Args:
        factory: pytest's.
        name: The name of the folder in the run.
        make: Fills the folder.
    """
    base = factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / name
    ready, failed = folder.with_suffix(".ready"), folder.with_suffix(".failed")
    try:
        folder.mkdir()
    except FileExistsError:
        until = time.monotonic() + LIMIT_S
        while not ready.exists():
            assert not failed.exists(), f"another worker could not make '{name}'"
            assert time.monotonic() < until, f"another worker still makes '{name}'"
            time.sleep(0.1)
        return folder
    try:
        make(folder)
    except BaseException:
        failed.touch()
        raise
    ready.touch()
    return folder
