"""Noise functions, their hashes, and shapes made of noise, for an author's ``@func``."""

from distal.fields.noise.lattice import fraction, lattice_hash, lattice_hash_2
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
    "fraction",
    "gradient_noise",
    "lattice_hash",
    "lattice_hash_2",
    "simplex_noise",
    "turbulence",
    "value_noise",
    "voronoi_border",
    "worley",
]
