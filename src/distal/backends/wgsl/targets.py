"""Declare the WGSL targets: a vertex and a fragment stage, or a compute program."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Final

from distal.backends.targets import TextTarget
from distal.ir.target import LARGEST_TABLE, FramePlace

_INTERFACE_BESIDE = "The file .json beside it tells bindings and offsets."


@dataclass(frozen=True, slots=True, kw_only=True)
class WgslTarget(TextTarget):
    """WGSL for WebGPU.

    Attributes:
        compute: Whether the text is a compute program.
    """

    backend: ClassVar[str] = "distal.backends.wgsl.backend"
    compute: bool = False


TARGETS: Final = (
    WgslTarget(
        "wgsl",
        "wgsl",
        FramePlace.HOST,
        largest_table=LARGEST_TABLE,
        place="WebGPU",
        use=f"vertex_main and fragment_main; draw 3 vertices as triangles. {_INTERFACE_BESIDE}",
        suffix=".wgsl",
    ),
    WgslTarget(
        "wgsl-compute",
        "wgsl",
        FramePlace.HOST,
        largest_table=LARGEST_TABLE,
        place="WebGPU",
        use=f"compute_main, in groups of 8 x 8 pixels. {_INTERFACE_BESIDE}",
        compute=True,
    ),
)
