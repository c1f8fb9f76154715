"""Tone maps and sRGB's curve against their published formulas, constant by constant.

The formulas are written down here again from their sources, in doubles of NumPy. That each constant
of the scene code counts is shown by changing it by a hundredth.
"""

from __future__ import annotations

import ast
import importlib.util
import itertools
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from distal.lang.runtime_access import executor
from distal.render import tonemap

GREYS = np.concatenate([[0.0], np.geomspace(1e-5, 60.0, 80), [0.0031308, 0.00315, 0.0399, 0.0406]])
AXIS = (0.0, 0.003, 0.03, 0.0805, 0.11, 0.5, 0.79, 1.3, 6.0)
COLORS = np.concatenate(
    [np.repeat(GREYS[:, None], 3, axis=1), list(itertools.product(AXIS, repeat=3))]
)


def srgb_encoded(c: Any) -> Any:
    """IEC 61966-2-1:1999."""
    power = 1.055 * c ** (1.0 / 2.4) - 0.055
    return np.where(c <= 0.0031308, 12.92 * c, power)


def srgb_decoded(c: Any) -> Any:
    """IEC 61966-2-1:1999."""
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def reinhard(c: Any) -> Any:
    """Reinhard, Stark, Shirley and Ferwerda, "Photographic tone reproduction" (2002), eq. 3."""
    return c / (1.0 + c)


def narkowicz(c: Any) -> Any:
    """Krzysztof Narkowicz, "ACES Filmic Tone Mapping Curve" (2016): a to e, and the input times
    0.6 for the curve of ACES itself."""
    a, b, c_, d, e = 2.51, 0.03, 2.43, 0.59, 0.14
    x = 0.6 * c
    return np.clip((x * (a * x + b)) / (x * (c_ * x + d) + e), 0.0, 1.0)


def khronos_neutral(colors: Any) -> Any:
    """Khronos Group, "PBR Neutral Tone Mapper specification" (2024), one color at a time."""
    f90, start, desaturation = 0.04, 0.8 - 0.04, 0.15
    shown = []
    for color in colors:
        x = color.min()
        f = x - x * x / (4.0 * f90) if x <= 2.0 * f90 else f90
        color = color - f
        peak = color.max()
        if peak > start:
            new_peak = 1.0 - (1.0 - start) ** 2 / (peak + 1.0 - 2.0 * start)
            g = 1.0 / (desaturation * (peak - new_peak) + 1.0)
            color = color * (new_peak / peak) * g + new_peak * (1.0 - g)
        shown.append(color)
    return np.array(shown)


def wrensch_agx(c: Any) -> Any:
    """Benjamin Wrensch, "Minimal AgX Implementation" (2023), with the display's 2.2 undone."""
    inset = np.array(
        [
            [0.842479062253094, 0.0784335999999992, 0.0792237451477643],
            [0.0423282422610123, 0.878468636469772, 0.0791661274605434],
            [0.0423756549057051, 0.0784336, 0.879142973793104],
        ]
    )
    outset = np.array(
        [
            [1.19687900512017, -0.0980208811401368, -0.0990297440797205],
            [-0.0528968517574562, 1.15190312990417, -0.0989611768448433],
            [-0.0529716355144438, -0.0980434501171241, 1.15107367264116],
        ]
    )
    low, high = -12.47393, 4.026069
    with np.errstate(divide="ignore"):
        x = (np.clip(np.log2(c @ inset.T), low, high) - low) / (high - low)
    curve = np.polyval([15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232], x)
    return np.maximum(curve @ outset.T, 0.0) ** 2.2


def displayed(c: Any) -> Any:
    """Exposure before the tone map, the encoding after it."""
    return srgb_encoded(reinhard(1.7 * c))


# What each function of the module is, and on which inputs.
PUBLISHED: dict[str, tuple[Callable[[Any], Any], Any]] = {
    "encode_srgb": (srgb_encoded, COLORS),
    "decode_srgb": (srgb_decoded, COLORS),
    "reinhard": (reinhard, COLORS),
    "aces": (narkowicz, COLORS),
    "neutral": (khronos_neutral, COLORS),
    "agx": (wrensch_agx, COLORS),
}
# Functions that another one's comparison covers.
WITHIN = {"agx_contrast": "agx", "decode_srgb_power": "agx"}
# The logarithm's guard against 0: what it gives is far below the darkest stop in any case.
NO_EFFECT = {("agx", "1e-10")}
TOLERANCE = 1e-9


def asked(module: ModuleType, name: str, *args: Any) -> Any:
    return executor().call(getattr(module, name), args, {}, device="reference")


def deviation(module: ModuleType, name: str) -> float:
    """How far a function of the module is from what was published."""
    published, inputs = PUBLISHED[name]
    return float(np.abs(np.asarray(asked(module, name, inputs)) - published(inputs)).max())


@pytest.mark.parametrize("name", PUBLISHED)
def test_a_tone_map_is_the_published_one(name):
    assert deviation(tonemap, name) < TOLERANCE


def constants() -> Iterator[tuple[str, ast.Constant]]:
    """Every float in the module's functions, and the function's name."""
    for node in ast.parse(Path(tonemap.__file__).read_text()).body:
        if isinstance(node, ast.FunctionDef):
            for inner in ast.walk(node):
                if isinstance(inner, ast.Constant) and isinstance(inner.value, float):
                    yield node.name, inner


def changed_module(folder: Path, constant: ast.Constant) -> ModuleType:
    """The module with one constant a hundredth larger (a 0 becomes 0.01)."""
    lines = Path(tonemap.__file__).read_text().splitlines(keepends=True)
    line = lines[constant.lineno - 1]
    value = constant.value * 1.01 or 0.01
    before, after = line[: constant.col_offset], line[constant.end_col_offset :]
    lines[constant.lineno - 1] = f"{before}{value!r}{after}"
    name = f"tonemap_{constant.lineno}_{constant.col_offset}"
    path = folder / f"{name}.py"
    path.write_text("".join(lines))
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def test_no_constant_may_be_a_hundredth_off(tmp_path):
    alike = []
    seen = set()
    for function, constant in constants():
        text = repr(constant.value)
        seen.add((function, text))
        covered = WITHIN.get(function, function)
        if (function, text) in NO_EFFECT or covered not in PUBLISHED:
            continue
        module = changed_module(tmp_path, constant)
        if not deviation(module, covered) > 10.0 * TOLERANCE:
            alike.append(f"{function}, line {constant.lineno}: {text}")
    assert not alike, "not noticed when changed: " + "; ".join(alike)
    assert seen >= NO_EFFECT
    known = {*PUBLISHED, *WITHIN, "display", "display_by"}
    unknown = {function for function, _ in seen} - known
    assert not unknown, f"functions with constants and no published formula: {unknown}"


@pytest.mark.parametrize(
    ("name", "light", "shown"),
    [
        ("reinhard", 0.25, 0.2),
        ("reinhard", 1.0, 0.5),
        ("aces", 0.18, 0.03251664 / 0.23206352),  # x = 0.108, worked out by hand
        ("aces", 1.0, 0.9216 / 1.3688),  # x = 0.6
        ("neutral", 0.18, 0.14),
        ("neutral", 1.0, 1.0 - 0.0576 / 0.44),  # the peak is 0.96
        ("encode_srgb", 0.5, 0.735357),
        ("decode_srgb", 0.5, 0.214041),
    ],
)
def test_greys_worked_out_by_hand(name, light, shown):
    found = asked(tonemap, name, np.full((1, 3), light))
    assert found[0] == pytest.approx([shown] * 3, abs=1e-6)


def test_a_dull_color_is_kept_by_neutral_but_for_four_percent():
    kept = asked(tonemap, "neutral", np.array([[0.7, 0.5, 0.2], [0.5, 0.3, 0.0]]))
    assert kept == pytest.approx(np.array([[0.66, 0.46, 0.16], [0.5, 0.3, 0.0]]), abs=1e-9)


def test_agx_keeps_white_white():
    """Rows of both matrices sum to 1, to the digits that were published."""
    shown = asked(tonemap, "agx", np.repeat(GREYS[:, None], 3, axis=1))
    assert np.ptp(shown, axis=1).max() < 1e-3


@pytest.mark.parametrize("number", range(len(tonemap.NAMES)))
def test_a_tone_map_is_chosen_by_its_number(number):
    name = tonemap.NAMES[number]
    expected = COLORS if name == "none" else PUBLISHED[name][0](COLORS)
    assert getattr(tonemap, name.upper()) == number
    found = asked(tonemap, "tone_mapped", COLORS, number)
    assert np.abs(np.asarray(found) - expected).max() < TOLERANCE


def test_light_is_exposed_then_mapped_then_encoded():
    color = np.concatenate([COLORS, np.full((len(COLORS), 1), 0.3)], axis=1)
    color[0, :3] = -0.2  # less than nothing is nothing
    shown = asked(tonemap, "display", color, 1.7, tonemap.REINHARD)
    expected = displayed(np.maximum(color[:, :3], 0.0))
    assert np.abs(shown[:, :3] - expected).max() < 1e-6  # the exposure has 32 bits
    assert np.all(shown[:, 3] == color[:, 3])


def test_light_below_nothing_is_shown_as_nothing():
    assert np.all(asked(tonemap, "encode_srgb", np.full((1, 3), -0.5)) == 0.0)


def test_values_below_nothing_follow_the_straight_part():
    linear = asked(tonemap, "decode_srgb", np.full((1, 3), -0.5))
    assert linear == pytest.approx(np.full((1, 3), -0.5 / 12.92))
