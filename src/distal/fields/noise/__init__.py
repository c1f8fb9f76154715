"""Noise functions, and shapes made of noise. An author's ``@func`` imports them from here."""

from distal.fields.noise.space import (
    fbm,
    fbm_slope,
    gradient_noise,
    simplex_noise,
    turbulence,
    value_noise,
)
from distal.fields.noise.voronoi import Cellular, cellular, voronoi_border, worley

__all__ = [
    "Cellular",
    "cellular",
    "fbm",
    "fbm_slope",
    "gradient_noise",
    "simplex_noise",
    "turbulence",
    "value_noise",
    "voronoi_border",
    "worley",
]
