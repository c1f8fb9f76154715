"""One build of the playground for all tests of its pages."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.made_once import made_once
from tests.site.served_playground import KEEP_FRAMES, NAMES, served
from tools.site import playground


@pytest.fixture(scope="session")
def folder(tmp_path_factory) -> Path:
    """The playground with few examples."""

    def build(made: Path) -> None:
        playground.build(made / "playground", [*NAMES, *KEEP_FRAMES])

    return made_once(tmp_path_factory, "pages-of-the-playground", build) / "playground"


@pytest.fixture(scope="session")
def address(folder):
    """The address that it is served at."""
    with served(folder) as found:
        yield found
