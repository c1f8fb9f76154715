"""The reserved names of WGSL texts, including the names that the texts declare themselves.

Every name that the writers declare at module scope is listed here once: the writers read it from
``OWN``, and the author's names must be different. Uniforms and per-frame values are members of
structs.
"""

from __future__ import annotations

from typing import Final, NamedTuple

from distal.backends.clike.keywords import WGSL_KEYWORDS, WGSL_PREDECLARED
from distal.backends.clike.module_names import Vocabulary
from distal.backends.clike.names import Reserved


class OwnNames(NamedTuple):
    """The names that the writers declare at module scope."""

    uniforms: str = "uniforms"
    uniforms_type: str = "Uniforms"
    uniforms_input: str = "uniforms_input"
    frame: str = "frame"
    frame_type: str = "Frame"
    frame_input: str = "frame_input"
    frame_output: str = "frame_output"
    pixel: str = "pixel"
    pixels: str = "pixels"
    source: str = "source"
    arguments: str = "arguments"
    results: str = "results"
    vertex_main: str = "vertex_main"
    fragment_main: str = "fragment_main"
    compute_main: str = "compute_main"
    frame_main: str = "frame_main"
    pixels_main: str = "pixels_main"
    points_main: str = "points_main"


OWN: Final = OwnNames()

_KEYWORDS: Final = Reserved(WGSL_KEYWORDS)
VOCABULARY: Final = Vocabulary(_KEYWORDS, _KEYWORDS | WGSL_PREDECLARED | OWN)
