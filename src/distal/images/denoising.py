"""Remove the noise of a picture of random paths, by Intel's Open Image Denoise.

Input: linear light, and the albedo and the normal of what each pixel shows. Output: linear light.
A trained network, so the result is plausible, not exact: fine detail below the noise is lost. Does
not depend on how the picture was rendered.

Source: Attila Áfra, "Intel Open Image Denoise" (2019 to 2025), https://www.openimagedenoise.org.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from distal.packages import imported

MODULE = "pyoidn"


def check_denoiser() -> None:
    """Check that the denoiser is installed, before time is spent on rendering.

    Raises:
        PackageError: It is missing or cannot be loaded.
    """
    imported(MODULE)


def denoised(
    light: NDArray[np.float32], albedo: NDArray[np.float32], normal: NDArray[np.float32]
) -> NDArray[np.float32]:
    """Return a picture without noise; alpha is unchanged.

    Args:
        light: Linear light and straight alpha, (height, width, 4).
        albedo: The color of what each pixel shows, (height, width, 3), linear.
        normal: Its normal, (height, width, 3), in world space.

    Raises:
        PackageError: The denoiser is missing or cannot be loaded.
    """
    alpha = light[..., 3:]
    # The network is for light from 0 on; the format of half floats limits what a file can hold.
    color = np.clip(np.nan_to_num(light[..., :3] * alpha), 0.0, 65504.0)
    found = imported(MODULE).denoise(
        np.ascontiguousarray(color, np.float32),
        np.ascontiguousarray(np.clip(albedo, 0.0, 1.0), np.float32),
        np.ascontiguousarray(np.clip(normal, -1.0, 1.0), np.float32),
        hdr=True,
    )
    made = light.copy()
    made[..., :3] = np.asarray(found, np.float32) / np.maximum(alpha, 1e-6)
    return made
