"""What the studio can render: formats and limits, as the packages declare them.

Input: nothing. Output: ``RenderChoices``, and what a request makes. Uses the packages of pictures
and videos, and with them NumPy.
"""

from __future__ import annotations

from functools import cache

from distal.diagnostics import LoadError
from distal.editor.messages import RenderChoices, RenderFormat
from distal.images.picture import FORMATS as PICTURES
from distal.images.picture import PACKAGES
from distal.lang.render_options import LARGEST_SIDE_PX, MODES, MOST_SAMPLES, PATH_SAMPLES
from distal.packages import missing
from distal.video.formats import FORMATS as FILMS
from distal.video.formats import LOSSLESS, PACKAGE, QUALITIES, QUALITY


@cache
def choices() -> RenderChoices:
    """Return what a picture or film can be."""
    pictures = (
        RenderFormat(
            name=suffix.removeprefix("."),
            film=False,
            bits=bits,
            missing=missing(PACKAGES[suffix]) if suffix in PACKAGES else None,
        )
        for suffix, bits in PICTURES.items()
    )
    films = (
        RenderFormat(
            name=format.name,
            film=True,
            lossy=format.lossy,
            loops=format.loops,
            missing=missing(PACKAGE),
        )
        for format in FILMS.values()
    )
    return RenderChoices(
        formats=(*pictures, *films),
        modes=MODES,
        qualities=(*QUALITIES, LOSSLESS),
        quality=QUALITY,
        largest_side=LARGEST_SIDE_PX,
        most_samples=MOST_SAMPLES,
        path_samples=PATH_SAMPLES,
    )


def format_named(name: str) -> RenderFormat:
    """Return the format of a name.

    Raises:
        LoadError: There is none, or a package for it is missing.
    """
    known = {format.name: format for format in choices().formats}
    if name not in known:
        raise LoadError(f"there is no format '{name[:40]}'; formats: {', '.join(known)}")
    if known[name].missing is not None:
        raise LoadError(f"{name} files cannot be written: {known[name].missing}")
    return known[name]
