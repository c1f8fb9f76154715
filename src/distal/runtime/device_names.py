"""The names of the devices, declared once.

Docstrings, the command line and the executor use exactly these names; a test compares them.
"""

from __future__ import annotations

from typing import Final

AUTO: Final = "auto"
CPU: Final = "cpu"
GPU: Final = "gpu"
GPU_FRAGMENT: Final = "gpu-fragment"
REFERENCE: Final = "reference"

# Valid values of ``device=`` and ``--device``; "gpu" can be followed by an adapter: "gpu:nvidia".
DEVICE_NAMES: Final = (AUTO, CPU, GPU, GPU_FRAGMENT, REFERENCE)
