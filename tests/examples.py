"""Which examples of the gallery are functions of a pixel, without running their code.

Input: the texts of the examples. Output: names. To load all examples takes seconds, and pytest
reads each test file in each of its processes. ``tests/pictures/test_targets.py`` loads them
and asserts that none is left out.
"""

from __future__ import annotations

import re
from functools import cache

from distal.example_files import gallery

_IMAGE = re.compile(r"^@image\b", re.MULTILINE)


@cache
def functions_of_a_pixel() -> tuple[str, ...]:
    """The names of the examples that are an ``@image``, sorted."""
    texts = {name: path.read_text("utf-8") for name, path in gallery().items()}
    return tuple(name for name, text in texts.items() if _IMAGE.search(text))
