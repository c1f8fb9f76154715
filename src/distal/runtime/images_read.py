"""Find the images whose frames a picture reads: its buffers, and itself.

Input: what images read. Output: the images in the order in which a frame draws them. Renders
nothing, and needs the standard library alone, as pages do.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Final

from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.frontend.signatures.signatures import definition_of
from distal.lang.functions import FrameBuffer, Image
from distal.lang.live_textures import LastFrame

MOST_BUFFERS: Final = 4


@dataclass(frozen=True, slots=True)
class ImagesRead:
    """The images whose frames a picture reads.

    Attributes:
        buffers: Those drawn before it in each frame, in this order.
        itself: The picture, if it or a buffer reads its last frame; else None.
    """

    buffers: tuple[FrameBuffer, ...]
    itself: Image | None

    @property
    def all(self) -> tuple[Image, ...]:
        """All of them, in the order in which a frame draws them."""
        return (*self.buffers, *([] if self.itself is None else [self.itself]))


def images_read(
    resources: Iterable[Any], resources_of: Callable[[Image], Iterable[Any]]
) -> ImagesRead:
    """Return the images whose frames a picture reads, directly or through another one.

    Args:
        resources: What the picture reads.
        resources_of: Returns what an image reads.

    Raises:
        CompileError: There are too many buffers, or one of the images is no buffer.
    """
    found: dict[Image, None] = {}
    waiting = [r.image for r in resources if isinstance(r, LastFrame)]
    while waiting:
        image = waiting.pop()
        if image not in found:
            found[image] = None
            waiting += [r.image for r in resources_of(image) if isinstance(r, LastFrame)]
    buffers = sorted((i for i in found if isinstance(i, FrameBuffer)), key=lambda b: b.number)
    others = [i for i in found if not isinstance(i, FrameBuffer)]
    if len(buffers) > MOST_BUFFERS:
        names = ", ".join(b.name for b in buffers)
        raise _refused(buffers[-1], f"a picture has {MOST_BUFFERS} buffers at most: {names}", None)
    if len(others) > 1:
        hint = "write @buffer above what another picture reads"
        message = f"'{others[0].name}' and '{others[1].name}' are read, and neither is a buffer"
        raise _refused(others[0], message, hint)
    return ImagesRead(tuple(buffers), others[0] if others else None)


def _refused(image: Image, message: str, hint: str | None) -> CompileError:
    definition = definition_of(image.overloads[0])
    return CompileError.at(
        ErrorCode.DEFINITION, message, definition.source.name_span(definition.node), hint
    )
