"""Sets of values that fill the ranges of parameters evenly: Latin hypercubes and Sobol points.

Input: a picture, how many sets, ranges by parameter, a seed. Output: a list of sets for
``distal.sweep``. Does not depend on pictures.

Source: M. D. McKay, R. J. Beckman, W. J. Conover, "A Comparison of Three Methods for Selecting
    Values of Input Variables in the Analysis of Output from a Computer Code" (1979).
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from distal.lang.parameters import Parameter, ParameterKind
from distal.lang.presentable import Presentable
from distal.packages import imported
from distal.scene.viewing.viewable import viewable
from distal.sweeps.axes import MOST, axis_of
from distal.sweeps.columns import InputColumn, column_of

LATIN: Final = "latin"
SOBOL: Final = "sobol"
METHODS: Final = (LATIN, SOBOL)
# Kinds whose parameters have ranges of their own.
_RANGED: Final = (ParameterKind.SLIDER, ParameterKind.INTEGER)
_LISTED: Final = (ParameterKind.TOGGLE, ParameterKind.CHOICE)
# What makes a value of a number from 0 to below 1.
_Map = Callable[[float], Any]


def parameter_sets(
    obj: Presentable,
    count: int,
    values: Mapping[str, Any] | None = None,
    *,
    method: str = LATIN,
    seed: int = 0,
) -> list[dict[str, Any]]:
    """Draw sets of values that fill the ranges of parameters evenly, for ``distal.sweep``.

    Of a Latin hypercube each parameter has one value in each of ``count`` parts of its range. Sobol
    points fill all ranges together, best if their count is a power of 2. The same arguments, with
    the same versions of NumPy or SciPy, give the same sets.

    Args:
        obj: A scene, a shape or an ``@image``.
        count: How many sets.
        values: What parameters vary, by name: a pair of ends, a text "0.2:0.8", or a list of values
            to choose from; None for the whole range of a parameter. Sliders with ``log=True`` are
            spread by the logarithm. None: all sliders, integers, toggles and choices.
        method: "latin" or "sobol", which is scrambled (Owen) and needs ``distal[design]``.
        seed: The seed of the random numbers, 0 or above.

    Raises:
        PackageError: SciPy is missing.
        ValueError: There is no such parameter or method, or a number is out of range.
    """
    _check_whole("count", count, 1, MOST)
    _check_whole("seed", seed, 0, 2**63 - 1)
    if method not in METHODS:
        raise ValueError(f"method is one of {', '.join(METHODS)}, not {method!r:.40}")
    parameters = viewable(obj, {}, 0.0).parameters
    if values is None:
        values = {p.name: None for p in parameters if p.kind in (*_RANGED, *_LISTED)}
    if not values:
        raise ValueError("there is no parameter to vary: sliders, integers, toggles or choices")
    maps: dict[InputColumn, _Map] = {}
    for name, given in values.items():
        column = column_of(name, parameters)
        if column in maps:
            raise ValueError(f"'{column.label}' has values twice: give all of them once")
        maps[column] = _map_of(column, given, parameters)
    points = (_latin if method == LATIN else _sobol)(count, len(maps), seed)
    return [
        {c.name: c.named(of(float(u))) for (c, of), u in zip(maps.items(), point, strict=True)}
        for point in points
    ]


def _check_whole(name: str, value: Any, least: int, most: int) -> None:
    is_whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
    if not is_whole or not least <= value <= most:
        raise ValueError(f"{name} is a whole number from {least} to {most}, not {value!r:.40}")


def _latin(count: int, dimensions: int, seed: int) -> NDArray[np.float64]:
    """Return the points of a Latin hypercube, of shape (count, dimensions)."""
    random = np.random.default_rng(seed)
    parts = np.stack([random.permutation(count) for _ in range(dimensions)], axis=1)
    return np.minimum((parts + random.random(parts.shape)) / count, math.nextafter(1.0, 0.0))


def _sobol(count: int, dimensions: int, seed: int) -> NDArray[np.float64]:
    """Return Sobol points, of shape (count, dimensions)."""
    qmc = imported("scipy.stats").qmc
    most = qmc.Sobol.MAXDIM
    if dimensions > most:
        raise ValueError(f"Sobol points have at most {most} parameters, not {dimensions}")
    if count & (count - 1):
        below = 1 << (count.bit_length() - 1)
        warnings.warn(
            f"{count} Sobol points are not balanced: {below} or {2 * below} are", stacklevel=3
        )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # said above, in our words
        # A generator, and not the seed: the name of that argument differs by version.
        engine = qmc.Sobol(dimensions, scramble=True, **_random_of(qmc.Sobol, seed))
        points: NDArray[np.float64] = engine.random(count)
    return points


def _random_of(engine: Any, seed: int) -> dict[str, Any]:
    """Return the argument for random numbers, whose name differs by the version of SciPy."""
    import inspect  # noqa: PLC0415 (slow to import)

    name = "rng" if "rng" in inspect.signature(engine).parameters else "seed"
    return {name: np.random.default_rng(seed)}


def _map_of(column: InputColumn, given: Any, parameters: Sequence[Parameter]) -> _Map:
    """Return what makes a value of a parameter of a number from 0 to below 1."""
    parameter = column.parameter
    ends = _ends_of(column, given)
    if ends is not None:
        low, high = (column.checked(end) for end in ends)
        if low > high:
            raise ValueError(f"'{column.label}' takes LOW:HIGH, not {low!r}:{high!r}")
        if column.is_integer:
            return lambda u: low + math.floor(u * (high - low + 1))
        if parameter is not None and parameter.log:
            return lambda u: min(max(low * (high / low) ** u, low), high)
        return lambda u: min(max(low + (high - low) * u, low), high)
    if given is None:
        if parameter is None or parameter.kind not in _LISTED:
            raise ValueError(f"'{column.label}' has no range of its own: give values of it")
        options: Sequence[Any] = (
            range(len(parameter.options)) if parameter.options else (False, True)
        )
    else:
        options = axis_of(column.name, given, parameters).values
    return lambda u: options[math.floor(u * len(options))]


def _ends_of(column: InputColumn, given: Any) -> tuple[Any, Any] | None:
    """Return the ends of a range; None if there are single values to choose from."""
    parameter = column.parameter
    is_ranged = parameter is None or parameter.kind in _RANGED
    if given is None:
        if parameter is None or parameter.kind not in _RANGED:
            return None
        return parameter.low, parameter.high
    if isinstance(given, str) and given.count(":") == 1 and is_ranged:
        low, _, high = given.partition(":")
        return low, high
    if isinstance(given, tuple) and len(given) == 2 and is_ranged:
        return given
    return None
