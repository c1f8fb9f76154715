"""The names in a command's lines of progress, for the commands and for what reads them.

Input: nothing. Output: the key of the stage in a line of JSON, and the stages. Imports nothing.
"""

from __future__ import annotations

from typing import Final

KEY: Final = "stage"
LOADING: Final = "loading"  # the author's file runs
COMPILING: Final = "compiling"
RENDERING: Final = "rendering"
ENCODING: Final = "encoding"
STAGES: Final = (LOADING, COMPILING, RENDERING, ENCODING)
