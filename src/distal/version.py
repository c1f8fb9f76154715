"""The version, in the one place that the package, the wheel and every picture read.

Knows nothing else, so that any layer may import it.
"""

from __future__ import annotations

from typing import Final

__version__: Final = "0.1.0"
