"""Metric screws: ``MetricThread``, ``MetricHole``, ``Bolt`` and ``Nut``, by names of sizes.

Input: a size such as "M6" and lengths in millimetres. Output: solids around the y axis, made of the
library's threads, prisms and cones. Does not contain formulas of distances.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from distal.fields.solids.threads import DEPTH
from distal.lang.source_places import author_place
from distal.scene.objects.field import BaseShape
from distal.scene.objects.metric_sizes import MetricSize, metric_size
from distal.scene.objects.shape import Shape
from distal.scene.objects.shapes import made_of
from distal.scene.tree.conversion import is_scalar
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.value import recorded

if TYPE_CHECKING:
    from distal.scene.objects.argument_types import Amount

# Depth of a thread for a pitch of 1, and so the usual chamfer at its end.
_CHAMFER: Final = 0.6
# The corners of hexagons are cut off by a cone, 30 degrees to the face, of this share of the width.
_BEVEL: Final = 0.95
_BEVEL_OPENING: Final = math.tau / 3.0
_SINK: Final = 0.05  # the countersink of a nut, in diameters


@recorded
class MetricThread(Shape):
    """Threaded rod of a metric size with its coarse pitch, centred at the origin.

    Args:
        size: "M2" to "M20".
        length: Full length in millimetres.
        pitch: Another pitch, for fine threads; None for the coarse one.
        left: Whether the thread is left-handed.

    Raises:
        CompileError: At the author's line: there is no such size, or a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    size: Any
    length: Any
    pitch: Any
    left: Any

    def __init__(
        self, size: str, length: Amount = 20.0, *, pitch: float | None = None, left: bool = False
    ) -> None:
        row = metric_size(size, "MetricThread", author_place())
        pitch = row.pitch if pitch is None else pitch
        made = made_of("Thread", row.diameter, pitch, length, _CHAMFER * pitch, left=left)
        BaseShape.__init__(self, made.named("MetricThread").node)


@recorded
class MetricHole(Shape):
    """Hole to subtract from a part, threaded for a metric size, or wide enough for a bolt.

    Args:
        size: "M2" to "M20".
        length: Thickness of the part in millimetres; the hole is centred at the origin.
        gap: Gap between the threads in millimetres; about .1 to .2 for printed parts.
        threaded: Whether it has a thread; otherwise a bolt passes through it (ISO 273, medium).
        pitch: Another pitch, for fine threads; None for the coarse one.
        left: Whether the thread is left-handed.
        through: Whether it opens on both sides; otherwise only upwards.

    Raises:
        CompileError: At the author's line: there is no such size, or a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    size: Any
    length: Any
    gap: Any
    threaded: Any
    pitch: Any
    left: Any
    through: Any

    def __init__(
        self,
        size: str,
        length: Amount = 10.0,
        *,
        gap: Amount = 0.1,
        threaded: bool = True,
        pitch: float | None = None,
        left: bool = False,
        through: bool = True,
    ) -> None:
        row = metric_size(size, "MetricHole", author_place())
        pitch = row.pitch if pitch is None else pitch
        if threaded:
            sink = _SINK * row.diameter
            numbers = (row.diameter, pitch, length, gap, sink)
            made = made_of("TappedHole", *numbers, left=left, through=through)
        else:
            beyond = 2.0 * pitch if through else pitch
            made = made_of("Cylinder", 0.5 * row.hole, length + beyond)
            made = made if through else made.translate(0.0, 0.5 * pitch, 0.0)
        BaseShape.__init__(self, made.named("MetricHole").node)


@recorded
class Bolt(Shape):
    """Bolt with a hexagon head, pointing downwards; the head stands on y = 0.

    ``Nut(size).screwed(y)`` fits on it at every height.

    Args:
        size: "M2" to "M20"; the head is that of ISO 4014.
        length: Length below the head in millimetres.
        thread: Length of the thread; None for twice the diameter plus 6 mm, as ISO 888, or the
            whole length. Before a shank, the depth of the last pitch falls to 0.
        left: Whether the thread is left-handed.

    Raises:
        CompileError: At the author's line: there is no such size, or a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    size: Any
    length: Any
    thread: Any
    left: Any

    def __init__(
        self, size: str, length: Amount = 20.0, *, thread: Amount | None = None, left: bool = False
    ) -> None:
        place = author_place()
        row = metric_size(size, "Bolt", place)
        if not is_scalar(length):
            refuse(f"length of Bolt is a number, not {length!r:.40}", 'Bolt("M6", 20)', place)
        if isinstance(length, float | int) and length <= row.pitch:
            refuse(f"length of Bolt must be above its pitch, {row.pitch:g}", None, place)
        thread = _threaded_length(row, length, thread, place)
        # The thread goes on a little into the head or the shank, where it is not seen.
        chamfer = _CHAMFER * row.pitch
        turned = made_of("Thread", row.diameter, row.pitch, thread + chamfer, chamfer, left=left)
        parts = [_screwed(turned, 0.5 * (thread + chamfer) - length, row.pitch, left)]
        plain = length - thread
        if not isinstance(plain, float | int) or plain > 0.0:
            shank = made_of("Cylinder", 0.5 * row.diameter, plain + 0.5 * row.head)
            parts.append(shank.translate(0.0, 0.25 * row.head - 0.5 * plain, 0.0))
            parts.append(_run_out(row).translate(0.0, -0.5 * row.pitch - plain, 0.0))
        head = _hexagon(row, row.head, both=False).translate(0.0, 0.5 * row.head, 0.0)
        BaseShape.__init__(self, head.union(*parts).named("Bolt").node)


@recorded
class Nut(Shape):
    """Hexagon nut around the y axis, centred at the origin.

    Args:
        size: "M2" to "M20"; the sizes are those of ISO 4032.
        gap: Gap to the thread of the bolt in millimetres; about .1 to .2 for printed parts.
        left: Whether the thread is left-handed.

    Raises:
        CompileError: At the author's line: there is no such size, or a number is beyond its limit.
    """

    # The arguments, of which ``recorded`` makes attributes.
    size: Any
    gap: Any

    pitch: float
    left: bool

    def __init__(self, size: str, *, gap: Amount = 0.1, left: bool = False) -> None:
        row = metric_size(size, "Nut", author_place())
        sink = _SINK * row.diameter
        self.__dict__.update(pitch=row.pitch, left=left)
        hole = made_of("TappedHole", row.diameter, row.pitch, row.nut, gap, sink, left=left)
        made = _hexagon(row, row.nut, both=True) - hole
        BaseShape.__init__(self, made.named("Nut").node)

    def screwed(self, height: Amount) -> Shape:
        """Return the nut with its middle at a height on its bolt, turned as the thread turns it.

        ``height`` may be a parameter, or follow the time.
        """
        made: Shape = _screwed(self, height, self.pitch, self.left)
        return made


def _screwed(shape: Any, height: Any, pitch: Any, left: bool) -> Any:
    """Return a thread that is moved along its axis and turned, so that its grooves stay."""
    turn = (-math.tau if left else math.tau) / pitch
    return shape.translate(0.0, height, 0.0).rotate(y=turn * height)


def _run_out(row: MetricSize) -> Any:
    """Return what fills the grooves of the last pitch before a shank: their depth falls to 0."""
    crest = 0.5 * row.diameter
    return made_of("CappedCone", crest - DEPTH * row.pitch, crest, row.pitch)


def _threaded_length(row: MetricSize, length: Any, thread: Any, place: Any) -> Any:
    if thread is None:
        usual = 2.0 * row.diameter + 6.0
        return min(usual, length) if isinstance(length, float | int) else length
    if isinstance(thread, str):
        refuse_kind(f"thread of Bolt is a length, not {thread!r:.40}", "thread=12.0", place)
    plain = isinstance(thread, float | int) and isinstance(length, float | int)
    if plain and not row.pitch <= thread <= length:
        message = f"thread of Bolt must be from its pitch, {row.pitch:g}, to its length"
        refuse(message, None, place)
    return thread


def _hexagon(row: MetricSize, height: float, *, both: bool) -> Any:
    """Return a hexagon whose corners are cut off by a cone, on top or on both ends."""
    body = made_of("HexPrism", 0.5 * row.across, height)
    cone = made_of("InfiniteCone", opening=_BEVEL_OPENING)
    rise = 0.5 * height + 0.5 * _BEVEL * row.across / math.tan(0.5 * _BEVEL_OPENING)
    cut = body & cone.translate(0.0, rise, 0.0)
    return cut & cone.rotate(x=math.pi).translate(0.0, -rise, 0.0) if both else cut
