"""The film of a live picture by paths: the mean of all samples so far, kept between passes.

Input: the mean of a pass, and the film before it. Output: the film after it; the light that it
shows. A film has one texel for each pixel: light times alpha, and alpha. As a mean it has the
magnitude of the picture after any number of samples, so 32-bit floats suffice: an update changes
it by the share of its own samples.
"""

from __future__ import annotations

from typing import Final

from distal.lang import Texture2D, floor, func, ivec2, select, texel, vec2, vec4
from distal.render.film import mean_light

# The place of the frame on the film, in pixels; a host sets it if it shows more than the frame.
FILM_OFFSET: Final = "Film_offset"
# The host replaces it by its own film.
FILM: Final = Texture2D([[(0.0, 0.0, 0.0, 0.0)]], wrap="clamp")


@func
def film_texel(film: Texture2D, coord: vec2, offset: vec2) -> vec4:
    """Return the texel of a pixel.

    Args:
        film: The film; row 0 is the lowest.
        coord: Middle of the pixel, in pixels of the frame.
        offset: Lower left corner of the frame on the film, in pixels.
    """
    return texel(film, ivec2(floor(coord + offset)))


@func
def film_after(before: vec4, light: vec4, first_sample: int, samples: int) -> vec4:
    """Return a texel of the film after a pass.

    Args:
        before: The texel so far; not read if there are no samples.
        light: The mean of the pass: linear light times alpha, and alpha.
        first_sample: The number of samples so far.
        samples: The number of samples of the pass.
    """
    share = float(samples) / float(first_sample + samples)
    return select(first_sample > 0, before + (light - before) * share, light)


@func
def film_light(mean: vec4) -> vec4:
    """Return the linear light and straight alpha of a texel."""
    return mean_light(mean, 1)
