"""The browser that tests of whole pages need."""

from __future__ import annotations

import pytest

from tests.browser import SWIFTSHADER, BrowserUnavailableError, browser


@pytest.fixture(scope="module")
def chromium() -> None:
    """Start Chromium with a GPU in software; tests that need it are skipped where there is none."""
    try:
        browser(*SWIFTSHADER)
    except BrowserUnavailableError as error:
        pytest.skip(str(error))
