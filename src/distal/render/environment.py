"""Environment maps: a picture of the surroundings as background and as diffuse light.

Input: an equirectangular picture (-z in its middle, up at its top) in linear light. Output: the
light from a direction; and its nine spherical harmonics, which ``ambient.environment_ambient``
reads. The harmonics are computed once, in Python.
"""

from __future__ import annotations

import math
from typing import Any, Final

from distal.lang import Texture2D, clamp, cos, func, sample, sin, vec2, vec3
from distal.render.camera import equirectangular

# The factor of each band of harmonics for a diffuse surface (Ramamoorthi and Hanrahan 2001),
# divided by pi, because a white surface shows 1/pi of the incident light.
_BANDS: Final = (1.0, 2.0 / 3.0, 1.0 / 4.0)
_BAND: Final = 64  # rows at once: they are multiplied as doubles
# Squares of the harmonics' factors: one for projecting the light, one for evaluating it.
_FACTORS: Final = tuple(
    factor / (4.0 * math.pi)
    for factor in (1.0, 3.0, 3.0, 3.0, 15.0, 15.0, 5.0 / 4.0, 15.0, 15.0 / 4.0)
)


@func
def turned_by(direction: vec3, turn: float) -> vec3:
    """Rotate a direction about the upright axis."""
    c = cos(turn)
    s = sin(turn)
    return vec3(c * direction.x - s * direction.z, direction.y, s * direction.x + c * direction.z)


@func
def environment(
    direction: vec3, image: Texture2D, intensity: float = 1.0, turn: float = 0.0
) -> vec3:
    """The light of a picture of the surroundings, by direction.

    Args:
        direction: Unit direction.
        image: Equirectangular picture; linear light.
        intensity: Brightness.
        turn: Turns the surroundings to the left about the upright axis, in radians.
    """
    place = equirectangular(turned_by(direction, turn))
    # Half a texel (of 1024 rows) away from the poles; closer, the opposite row would be blended in.
    held = clamp(place.y, 0.0005, 0.9995)
    return sample(image, vec2(place.x, held)).rgb * intensity


def harmonics(texels: Any) -> list[tuple[float, float, float]]:
    """Return nine coefficients of a picture's diffuse light, for ``ambient.environment_ambient``.

    Args:
        texels: Array (height, width, 3 or more) of linear light, top row first.

    Source: Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment Maps"
        (2001).
    """
    height, width = int(texels.shape[0]), int(texels.shape[1])
    around = [2.0 * math.pi * ((column + 0.5) / width - 0.5) for column in range(width)]
    waves = [
        [1.0] * width,
        [math.sin(angle) for angle in around],
        [math.cos(angle) for angle in around],
        [math.sin(2.0 * angle) for angle in around],
        [math.cos(2.0 * angle) for angle in around],
    ]
    # The sum of each row's light times each wave around the upright axis: (height, wave, color).
    columns = _columns(waves)
    rows: list[Any] = []
    for top in range(0, height, _BAND):
        band = texels[top : top + _BAND, :, :3]
        rows += (band.swapaxes(1, 2) @ columns).swapaxes(1, 2).tolist()
    sums = [[0.0, 0.0, 0.0] for _ in range(9)]
    for row, moments in enumerate(rows):
        polar = math.pi * (row + 0.5) / height
        area = (2.0 * math.pi / width) * (math.pi / height) * math.sin(polar)
        for index, weights in enumerate(_row_weights(math.cos(polar), math.sin(polar))):
            for wave, weight in weights:
                for color in range(3):
                    sums[index][color] += area * weight * moments[wave][color]
    scaled = [_FACTORS[i] * _BANDS[0 if i == 0 else 1 if i < 4 else 2] for i in range(9)]
    return [
        (r * scale, g * scale, b * scale) for (r, g, b), scale in zip(sums, scaled, strict=True)
    ]


def _columns(rows: list[list[float]]) -> list[list[float]]:
    return [list(column) for column in zip(*rows, strict=True)]


def _row_weights(y: float, r: float) -> tuple[tuple[tuple[int, float], ...], ...]:
    """Return the nine polynomials of (x, y, z) = (r sin a, y, -r cos a), as weights of five waves.

    The waves are 1, sin a, cos a, sin 2a, cos 2a.
    """
    half = 0.5 * r * r
    return (
        ((0, 1.0),),
        ((0, y),),
        ((2, -r),),
        ((1, r),),
        ((1, r * y),),
        ((2, -r * y),),
        ((0, 3.0 * half - 1.0), (4, 3.0 * half)),
        ((3, -half),),
        ((0, half - y * y), (4, -half)),
    )
