"""The screen that the tests of a module share."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.window.display import DisplayUnavailableError, screen


@pytest.fixture(scope="module")
def display() -> Iterator[str]:
    """The name of a virtual screen; tests that need one are skipped where there is none."""
    try:
        with screen() as name:
            yield name
    except DisplayUnavailableError as error:
        pytest.skip(str(error))
