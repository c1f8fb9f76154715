"""What renders: the names of the devices, declared once.

Docstrings, the command line and the executor name these and no others; a test compares them.
"""

from __future__ import annotations

from typing import Final

AUTO: Final = "auto"
CPU: Final = "cpu"
GPU: Final = "gpu"
GPU_FRAGMENT: Final = "gpu-fragment"
REFERENCE: Final = "reference"

# What ``device=`` and ``--device`` take; an adapter may follow the GPU's: "gpu:nvidia".
DEVICE_NAMES: Final = (AUTO, CPU, GPU, GPU_FRAGMENT, REFERENCE)
