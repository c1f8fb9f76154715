"""The range of a view's values, measured by a small picture of packed values.

Input: a view that shows values in a range (``render.ranges``), and how it is rendered. Output: the
options with the numbers of the range. The page's player does the same in ``web/src/range.ts``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.render.film import SAMPLES
from distal.scene import packed_values
from distal.scene.lowering.picture import RANGE

_NAMES: Final = tuple(f"View_{name}" for name in RANGE)
_PACKED: Final = dict(zip(_NAMES, (1.0, 0.0, -1.0), strict=True))


def with_range(image: Any, options: RenderOptions) -> RenderOptions:
    """Return the options with the range of the values that an image shows.

    Args:
        image: A view; others return ``options`` unchanged.
        options: How it is rendered.
    """
    if not getattr(image, "ranged", False) or _NAMES[0] in (options.settings or {}):
        return options
    size = (packed_values.PROBE_WIDTH, packed_values.PROBE_HEIGHT)
    settings = {**(options.settings or {}), **_PACKED}
    if SAMPLES in settings:
        settings[SAMPLES] = 1  # a mean of packed values has no meaning
    probe = replace(options, size=size, samples=1, settings=settings, progress=None)
    found = measured_range(executor().render(image, probe).array)
    return replace(options, settings={**(options.settings or {}), **found})


def measured_range(pixels: Any) -> dict[str, float]:
    """Return the settings for a picture of packed values; none if it has too few values.

    Args:
        pixels: (height, width, 3 or 4), 0 to 1.
    """
    colors = (255.0 * pixels[..., :3] + 0.5).astype(int).reshape(-1, 3).tolist()
    values = sorted(packed_values.unpacked(*color) for color in colors if any(color))
    if len(values) < packed_values.FEWEST_VALUES:
        return {}
    ends = (packed_values.lowest, packed_values.median, packed_values.highest)
    return {name: end(values) for name, end in zip(_NAMES, ends, strict=True)}
