"""What a scene reads of the options of a picture: how paths are refined, the numbers of its views.

Input: a ``RenderOptions``. Output: a ``Refinement``, and the numbers that a scene's programs read.
Standard library only.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from distal.fields.guarantees import Limit
from distal.ir.types import FLOAT, VEC3
from distal.lang.options import Option, rows
from distal.lang.render_options import MOST_SAMPLES, PATH_SAMPLES, Refinement, RenderOptions
from distal.lang.source_places import author_place
from distal.render import filters, path_film
from distal.scene.lowering.layers import OF_SAMPLES
from distal.scene.tree.conversion import Asked, number
from distal.scene.tree.errors import refuse_kind

_OF_PATHS: Final = tuple(row for row in rows(RenderOptions) if row.of_paths)
# The options of mode "path" that a picture's file records.
RECORDED: Final = tuple(row for row in _OF_PATHS if row.recorded)


def refinement_of(options: RenderOptions, mode: str, shutter: float = 0.0) -> Refinement | None:
    """Return when a picture in mode "path" is finished; None in mode "direct".

    Args:
        options: The options of the picture.
        mode: The scene's own mode.
        shutter: The scene's own shutter, in seconds.

    Raises:
        ValueError: An option for paths was given in mode "direct", or contradicts another.
    """
    if (options.mode or mode) != "path":
        for name in _not_default(options, _OF_PATHS):
            raise ValueError(f"{name} is for mode 'path'")
        for name in options.layers:
            if name in OF_SAMPLES:
                raise ValueError(f"the layer '{name}' is for mode 'path'")
        return None
    if options.view != "color":
        if options.mode is None:
            return None
        raise ValueError(f"mode 'path' computes light; the view '{options.view:.40}' shows none")
    spp, samples = options.spp, options.samples
    if None not in (spp, samples) and spp != samples:
        raise ValueError(f"spp={spp} and samples={samples} are the same: give one")
    limited = options.time_limit is not None or options.noise is not None
    return Refinement(
        samples=spp or samples or (MOST_SAMPLES if limited else PATH_SAMPLES),
        time_limit=options.time_limit,
        noise=options.noise,
        film=None if options.film is None else Path(options.film),
        shutter=shutter if options.shutter is None else options.shutter,
        signed=options.filter in filters.SIGNED,
        preview=options.preview,
    )


def path_settings(options: RenderOptions) -> dict[str, Any]:
    """Return the uniforms of a picture in mode "path" that differ from their defaults."""
    return {} if options.clamp is None else {path_film.LARGEST: options.clamp}


def recorded(options: RenderOptions) -> dict[str, Any]:
    """Return the options of mode "path" that a picture's file records, by name."""
    return _not_default(options, RECORDED)


def _not_default(options: RenderOptions, asked: tuple[Option, ...]) -> dict[str, Any]:
    """Return those of some options that are not at their defaults, by name."""
    values = ((row, getattr(options, row.name)) for row in asked)
    return {row.name: value for row, value in values if value != row.default}


def steering_settings(options: RenderOptions) -> dict[str, Any]:
    """Return the uniforms of a steered view and of a section; empty without them."""
    moved = {} if options.steering is None else options.steering.settings
    return moved if options.section is None else {**moved, **options.section.settings}


def slice_settings(options: RenderOptions) -> dict[str, Any]:
    """Return the plane of the view "slice" as settings; empty for other views.

    Raises:
        CompileError: ``plane`` is not a normal and an offset.
    """
    if options.view != "slice":
        return {}
    place = author_place()
    try:
        normal, offset = options.plane
    except (TypeError, ValueError):
        hint = "plane=((0, 0, 1), 0.5)"
        refuse_kind(f"a plane is a normal and an offset, not {options.plane!r:.60}", hint, place)
    direction = number(normal, Asked("normal", "slice", VEC3, Limit.UNIT, place=place))
    distance = number(offset, Asked("offset", "slice", FLOAT, place=place))
    return {"Slice_normal": direction.plain, "Slice_offset": distance.plain}
