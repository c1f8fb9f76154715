"""Triply periodic minimal surfaces, as sheets or as the solid on one side.

Input: a point, the edge length of the repeated cell, a level and, for sheets, a thickness.
Output: the value of the surface's equation divided by its typical gradient, which is about the
distance near the surface, and the bound on its slope. ``THICKEN_BY`` sets the thickness of a sheet
from another shape's distance.

The slope is bounded by the largest gradient of each equation (maxima over a cell, in closed form if
the comment gives one). The typical gradient is the mean over a thin layer around the surface, so
that the mean thickness of a sheet is the requested one (measured at 200,000 points).

Source: Alan Schoen, "Infinite periodic minimal surfaces without self-intersections" (NASA TN
D-5541, 1970), for the surfaces; the nodal equations after Hans-Georg von Schnering and Reinhard
Nesper, "Nodal surfaces of Fourier series" (1991).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

from distal.fields.constants import TAU
from distal.fields.extents import moved_out
from distal.fields.guarantees import NOTHING, Bounds, Growth, Limit, operator, primitive
from distal.fields.widths import periodic_width, thickened_width
from distal.lang import abs, clamp, cos, dot, func, max, sin, vec3
from distal.lang.functions import Func

GYROID_STEEPEST: Final = 1.7320508075688772  # sqrt(3)
GYROID_TYPICAL: Final = 1.53
SCHWARZ_P_STEEPEST: Final = 1.7320508075688772  # sqrt(3)
SCHWARZ_P_TYPICAL: Final = 1.307
SCHWARZ_D_STEEPEST: Final = 1.224744871391589  # sqrt(3/2)
SCHWARZ_D_TYPICAL: Final = 1.055
NEOVIUS_STEEPEST: Final = 7.0
NEOVIUS_TYPICAL: Final = 2.57
LIDINOID_STEEPEST: Final = 2.598076211353316  # 3/2 sqrt(3)
LIDINOID_TYPICAL: Final = 1.28
SPLIT_P_STEEPEST: Final = 3.62008
SPLIT_P_TYPICAL: Final = 2.25
IWP_STEEPEST: Final = 5.196152422706632  # 3 sqrt(3)
IWP_TYPICAL: Final = 4.31
FISCHER_KOCH_S_STEEPEST: Final = 2.443973
FISCHER_KOCH_S_TYPICAL: Final = 1.76
FRD_STEEPEST: Final = 7.0406904
FRD_TYPICAL: Final = 3.62


def _sheet_fits(cell_size: float, thickness: float, level: float) -> str | None:
    """Return why a sheet is too thick or a level is too large, or None."""
    if 4.0 * thickness > cell_size:
        return "thickness must be at most a quarter of cell_size"
    if 10.0 * math.fabs(level) > cell_size:
        return "level must be at most a tenth of cell_size, either way"
    return None


@func
def layered(
    value: float, cell_size: float, typical: float, thickness: float, level: float, solid: bool
) -> float:
    """Return the solid where ``value`` is below 0, or a sheet around its surface.

    ``level`` moves the solid's surface outwards.
    """
    d = value * cell_size / (TAU * typical) - level
    return d if solid else abs(d) - 0.5 * thickness


def minimal_surface(name: str, slope: float) -> Callable[[Func], Func]:
    """Declare the ``@func`` below as an infinite surface with this bound on its slope."""
    return primitive(name, NOTHING, slope=slope, requires=_sheet_fits, tier=2, width=periodic_width)


@minimal_surface("Gyroid", GYROID_STEEPEST / GYROID_TYPICAL)
@func
def gyroid(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Gyroid (Schoen): a minimal surface without straight lines or mirror planes.

    It separates space into two labyrinths.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Alan Schoen, "Infinite periodic minimal surfaces" (1970).

    Measured:
        gyroid((0.0, 0.0, 0.0), 1.0, 0.25) = -0.125
        gyroid((0.25, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.1040228
        gyroid((1.0, 0.5, 0.0), 2.0, 0.1, 0.05, True) = 0.1580457
    """
    q = p * (TAU / cell_size)
    value = dot(sin(q), cos(q.yzx))
    return layered(value, cell_size, GYROID_TYPICAL, thickness, level, solid)


@minimal_surface("SchwarzP", SCHWARZ_P_STEEPEST / SCHWARZ_P_TYPICAL)
@func
def schwarz_p(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Schwarz P (primitive) surface: tubes along the axes that meet in the middle of each cell.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Hermann Schwarz (1865), for the surface; its nodal equation.

    Measured:
        schwarz_p((0.25, 0.25, 0.25), 1.0, 0.25) = -0.125
        schwarz_p((0.0, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.3653136
        schwarz_p((1.0, 0.5, 0.5), 2.0, 0.1, 0.05, True) = -0.2935424
    """
    q = cos(p * (TAU / cell_size))
    value = q.x + q.y + q.z
    return layered(value, cell_size, SCHWARZ_P_TYPICAL, thickness, level, solid)


@minimal_surface("SchwarzD", SCHWARZ_D_STEEPEST / SCHWARZ_D_TYPICAL)
@func
def schwarz_d(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Schwarz D (diamond) surface: tubes along the bonds of the atoms in a diamond.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Hermann Schwarz (1865), for the surface; its nodal equation.

    Measured:
        schwarz_d((0.25, 0.0, 0.0), 1.0, 0.25) = -0.125
        schwarz_d((0.0, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.1508578
        schwarz_d((0.5, 0.5, 0.5), 2.0, 0.1, 0.05, True) = -0.3517155
    """
    q = p * (TAU / cell_size)
    c = cos(q)
    s = sin(q)
    value = c.x * c.y * c.z - s.x * s.y * s.z
    return layered(value, cell_size, SCHWARZ_D_TYPICAL, thickness, level, solid)


@minimal_surface("Neovius", NEOVIUS_STEEPEST / NEOVIUS_TYPICAL)
@func
def neovius(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Neovius surface: like Schwarz P, with additional tubes along the cell's edges.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Edvard Neovius (1883), for the surface; its nodal equation.

    Measured:
        neovius((0.25, 0.25, 0.25), 1.0, 0.25) = -0.125
        neovius((0.0, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.8050639
        neovius((1.0, 0.5, 0.5), 2.0, 0.1, 0.05, True) = -0.421568
    """
    c = cos(p * (TAU / cell_size))
    value = 3.0 * (c.x + c.y + c.z) + 4.0 * c.x * c.y * c.z
    return layered(value, cell_size, NEOVIUS_TYPICAL, thickness, level, solid)


@minimal_surface("Lidinoid", LIDINOID_STEEPEST / LIDINOID_TYPICAL)
@func
def lidinoid(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Lidinoid: a surface related to the gyroid, with more twisted labyrinths.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Sven Lidin and Stefan Larsson (1990), for the surface; its nodal equation.

    Measured:
        lidinoid((0.0, 0.0, 0.0), 1.0, 0.25) = 0.0428587
        lidinoid((0.25, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.0808209
        lidinoid((0.5, 0.5, 0.0), 2.0, 0.1, 0.05, True) = 0.1116417
    """
    q = p * (TAU / cell_size)
    s = sin(q)
    c = cos(q)
    double_sine = 2.0 * s * c
    double_cosine = 2.0 * c * c - 1.0
    woven = dot(double_sine, c.yzx * s.zxy)
    value = 0.5 * woven - 0.5 * dot(double_cosine, double_cosine.yzx) + 0.15
    return layered(value, cell_size, LIDINOID_TYPICAL, thickness, level, solid)


@minimal_surface("SplitP", SPLIT_P_STEEPEST / SPLIT_P_TYPICAL)
@func
def split_p(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Split P surface: between the gyroid and Schwarz P.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: the nodal equation in use among makers of lattices.

    Measured:
        split_p((0.0, 0.0, 0.0), 1.0, 0.25) = 0.002324
        split_p((0.25, 0.25, 0.25), 1.0, 0.1, 0.0, True) = 0.0424413
        split_p((0.5, 0.5, 0.0), 2.0, 0.1, 0.05, True) = 0.0348826
    """
    q = p * (TAU / cell_size)
    s = sin(q)
    c = cos(q)
    double_sine = 2.0 * s * c
    double_cosine = 2.0 * c * c - 1.0
    woven = 1.1 * dot(double_sine, s.zxy * c.yzx)
    pairs = 0.2 * dot(double_cosine, double_cosine.yzx)
    value = woven - pairs - 0.4 * (double_cosine.x + double_cosine.y + double_cosine.z)
    return layered(value, cell_size, SPLIT_P_TYPICAL, thickness, level, solid)


@minimal_surface("IWP", IWP_STEEPEST / IWP_TYPICAL)
@func
def iwp(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """I-WP surface (Schoen): tubes along the diagonals of a cube.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Alan Schoen, "Infinite periodic minimal surfaces" (1970).

    Measured:
        iwp((0.0, 0.0, 0.0), 1.0, 0.25) = -0.0142193
        iwp((0.25, 0.25, 0.25), 1.0, 0.1, 0.0, True) = 0.1107807
        iwp((1.0, 0.0, 0.0), 2.0, 0.1, 0.05, True) = -0.419269
    """
    c = cos(p * (TAU / cell_size))
    double_cosine = 2.0 * c * c - 1.0
    value = 2.0 * dot(c, c.yzx) - (double_cosine.x + double_cosine.y + double_cosine.z)
    return layered(value, cell_size, IWP_TYPICAL, thickness, level, solid)


@minimal_surface("FischerKochS", FISCHER_KOCH_S_STEEPEST / FISCHER_KOCH_S_TYPICAL)
@func
def fischer_koch_s(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """Fischer-Koch S surface: two labyrinths of the same form, with many crossings in each cell.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Werner Fischer and Elke Koch (1987), for the surface; its nodal equation.

    Measured:
        fischer_koch_s((0.0, 0.0, 0.0), 1.0, 0.25) = -0.125
        fischer_koch_s((0.25, 0.0, 0.0), 1.0, 0.1, 0.0, True) = 0.0904289
        fischer_koch_s((0.5, 0.25, 0.0), 2.0, 0.1, 0.05, True) = -0.05
    """
    q = p * (TAU / cell_size)
    s = sin(q)
    c = cos(q)
    value = dot(2.0 * c * c - 1.0, s.yzx * c.zxy)
    return layered(value, cell_size, FISCHER_KOCH_S_TYPICAL, thickness, level, solid)


@minimal_surface("FRD", FRD_STEEPEST / FRD_TYPICAL)
@func
def frd(
    p: vec3,
    cell_size: float = 1.0,
    thickness: float = 0.1,
    level: float = 0.0,
    solid: bool = False,
) -> float:
    """F-RD surface (Schoen): tubes from the corners of a cube to the middles of its faces.

    Args:
        p: Point.
        cell_size: Edge length of the repeated cube.
        thickness: Thickness of the sheet, at most a quarter of ``cell_size``.
        level: How far the surface is moved outwards, in scene units.
        solid: Whether to return the solid inside the surface instead of a sheet.

    Source: Alan Schoen, "Infinite periodic minimal surfaces" (1970).

    Measured:
        frd((0.0, 0.0, 0.0), 1.0, 0.25) = -0.08103451
        frd((0.25, 0.25, 0.25), 1.0, 0.1, 0.0, True) = -0.1318964
        frd((1.0, 0.5, 0.0), 2.0, 0.1, 0.05, True) = 0.03793092
    """
    c = cos(p * (TAU / cell_size))
    double_cosine = 2.0 * c * c - 1.0
    value = 4.0 * c.x * c.y * c.z - dot(double_cosine, double_cosine.yzx)
    return layered(value, cell_size, FRD_TYPICAL, thickness, level, solid)


@func
def graded(a: float, b: float, near_thickness: float, far_thickness: float, span: float) -> float:
    """Return a sheet around the first surface; the second shape's distance sets its thickness."""
    share = clamp(b / span, 0.0, 1.0)
    return abs(a) - 0.5 * (near_thickness + (far_thickness - near_thickness) * share)


@func
def graded_mix(a: float, b: float) -> float:
    """Return 0: the second shape only sets the thickness and is not shown."""
    return 0.0


@func
def graded_slope(
    slope_a: float, slope_b: float, near_thickness: float, far_thickness: float, span: float
) -> float:
    """Return the first shape's slope plus that of the thickness."""
    return slope_a + 0.5 * slope_b * abs(far_thickness - near_thickness) / span


@func
def graded_bounds(
    bounds_a: Bounds,
    bounds_b: Bounds,
    near_thickness: float,
    far_thickness: float,
    side_growth_a: float,
) -> Bounds:
    """Return the first shape's box, enlarged by half of the largest thickness."""
    return moved_out(bounds_a, 0.5 * max(near_thickness, far_thickness), side_growth_a)


THICKEN_BY = operator(
    "thicken by",
    combine=graded,
    mix=graded_mix,
    slope=graded_slope,
    bounds=graded_bounds,
    limits={
        "near_thickness": Limit.NOT_NEGATIVE,
        "far_thickness": Limit.NOT_NEGATIVE,
        "span": Limit.POSITIVE,
    },
    growth=Growth.FIRST,
    width=thickened_width,
)
"""A sheet around the first shape's surface: ``near_thickness`` thick on and in the second shape,
``far_thickness`` where that is ``span`` away or more."""
