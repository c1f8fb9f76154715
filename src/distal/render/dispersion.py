"""Dispersion: the index of refraction by wavelength, and the color of light of one wavelength.

Input: a random number, or a wavelength in nanometers. Output: an index; a linear color whose mean
over all random numbers is white. A path that meets glass with dispersion has one wavelength from
there on: its light is multiplied by the color of the wavelength. Lights and surfaces keep their
red, green and blue: spectral refraction of light in three channels.
"""

from __future__ import annotations

from distal.lang import exp, func, mat3, select, vec3

# The wavelengths of paths, in nanometers. The rest of the visible light is .1 to .2 % of it.
SHORTEST = 390.0
LONGEST = 700.0
# Fraunhofer's lines F, d and C: Abbe's number is (n_d - 1) / (n_F - n_C).
BLUE_LINE = 486.134
YELLOW_LINE = 587.562
RED_LINE = 656.281
# ``Surface.dispersion`` is this divided by Abbe's number.
ABBE = 20.0
# From the matching functions to linear red, green and blue (IEC 61966-2-1), each divided by its
# mean over the wavelengths above: an even spectrum is white.
TO_COLOR = mat3(
    vec3(7.828519, -2.960664, 0.1779388),
    vec3(-3.713528, 5.730355, -0.6524427),
    vec3(-1.204388, 0.1269346, 3.380840),
)


@func
def index_at(ior: float, dispersion: float, wavelength: float) -> float:
    """Return the index of refraction for a wavelength.

    Args:
        ior: The index for yellow light (587.6 nm).
        dispersion: 20 divided by Abbe's number; 0 for the same index everywhere.
        wavelength: In nanometers.

    Source: Augustin-Louis Cauchy's formula with two terms; the extension KHR_materials_dispersion
        of glTF for the unit.
    """
    blue = 1.0 / (BLUE_LINE * BLUE_LINE) - 1.0 / (RED_LINE * RED_LINE)
    here = 1.0 / (wavelength * wavelength) - 1.0 / (YELLOW_LINE * YELLOW_LINE)
    return ior + (ior - 1.0) * (dispersion / ABBE) * (here / blue)


@func
def wavelength_of(u: float) -> float:
    """Return the wavelength of a random number in [0, 1), in nanometers."""
    return SHORTEST + (LONGEST - SHORTEST) * u


@func
def bump(wavelength: float, middle: float, below: float, above: float) -> float:
    """Return a Gaussian bell with a width on either side.

    Args:
        wavelength: In nanometers.
        middle: Where it is 1.
        below: Its standard deviation at shorter wavelengths.
        above: That at longer ones.
    """
    x = (wavelength - middle) / select(wavelength < middle, below, above)
    return exp(-0.5 * x * x)


@func
def color_of(wavelength: float) -> vec3:
    """Return the linear color of light of one wavelength; components may be negative.

    Args:
        wavelength: In nanometers.

    Source: Chris Wyman, Peter-Pike Sloan and Peter Shirley, "Simple Analytic Approximations to the
        CIE XYZ Color Matching Functions" (2013).
    """
    x = 1.056 * bump(wavelength, 599.8, 37.9, 31.0) + 0.362 * bump(wavelength, 442.0, 16.0, 26.7)
    y = 0.821 * bump(wavelength, 568.8, 46.9, 40.5) + 0.286 * bump(wavelength, 530.9, 16.3, 31.1)
    z = 1.217 * bump(wavelength, 437.0, 11.8, 36.0) + 0.681 * bump(wavelength, 459.0, 26.0, 13.8)
    return TO_COLOR @ vec3(x - 0.065 * bump(wavelength, 501.1, 20.4, 26.2), y, z)
