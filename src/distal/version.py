"""The version, in the one place that the package, the wheel and every picture read.

Knows nothing else, so that any layer may import it. The build reads the line below as text.
"""

__version__ = "0.1.0"
