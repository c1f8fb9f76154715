"""A report about one pixel of an ``@image``: the value of every local, and the color.

Input: an author's image and a pixel. Output: a ``ProbedImage`` of plain values. It is computed by
the author's own function, changed to return its locals too, with the reference backend.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from distal.diagnostics import Span, place_json
from distal.frontend import Assembly
from distal.frontend.signatures.signatures import read_signature
from distal.ir.nodes import Construct, Read
from distal.ir.types import BOOL, FLOAT, FRAME, INT, UINT, VEC3, Kind, Struct, Type, Vector
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.lang.render_options import RenderOptions, place_of_pixel
from distal.lang.runtime_access import executor
from distal.scene.lowering.local_views import Local, kept_values, locals_of, watched

TYPES: Final[frozenset[Type]] = frozenset(
    (FLOAT, INT, UINT, BOOL, *(Vector(kind, n) for kind in Kind for n in (2, 3, 4)))
)


@dataclass(frozen=True, slots=True)
class ProbedLocal:
    """A local of an image at a pixel.

    Attributes:
        name: Its name; a field of a struct has the names of both.
        type: Its type.
        value: Its last value; None if the pixel gave it none.
        place: Where it is first given a value.
    """

    name: str
    type: Type
    value: Any
    place: Span | None


@dataclass(frozen=True, slots=True)
class ProbedImage:
    """The locals and the color of a pixel.

    Attributes:
        name: The image's name.
        pixel: Column and row, from the upper left.
        size: Size of the picture in pixels.
        color: The color, with alpha, before it is limited to 0 to 1.
        locals: The locals, in source order.
    """

    name: str
    pixel: tuple[int, int]
    size: tuple[int, int]
    color: tuple[float, ...]
    locals: tuple[ProbedLocal, ...]

    def as_json(self) -> dict[str, Any]:
        """Return plain values in the schema of ``docs/guide/checking.md``."""
        return {
            "version": 1,
            "pixel": list(self.pixel),
            "size": list(self.size),
            "image": self.name,
            "color": list(self.color),
            "locals": [
                {
                    "name": each.name,
                    "type": str(each.type),
                    "value": plain(each.value),
                    "place": place_json(each.place),
                }
                for each in self.locals
            ],
        }


def probe_image(
    image: Image,
    pixel: tuple[int, int],
    size: tuple[int, int] = (640, 480),
    params: Mapping[str, Any] | None = None,
    time: float = 0.0,
) -> ProbedImage:
    """Return the value of every local of an image at a pixel.

    Args:
        image: The image.
        pixel: Column and row from 0; rows count from the top, as in a picture's array.
        size: Width and height of the picture in pixels.
        params: Values of parameters by name; the others have their defaults.
        time: Time in seconds.

    Raises:
        ValueError: The picture has no such pixel.
        CompileError: The image has mistakes.
    """
    place = place_of_pixel(pixel, size)
    found = locals_of(image, TYPES)
    options = RenderOptions(size=size, params=params or {}, time=time)
    seen = executor().at_pixel(_ImageLocals(image, found), place, options)
    *values, color = seen
    pairs = zip(values[::2], values[1::2], strict=True)
    known = tuple(
        ProbedLocal(local.name, local.type, value if reached else None, local.place)
        for local, (value, reached) in zip(found, pairs, strict=True)
    )
    shown = tuple(float(c) for c in color)
    return ProbedImage(image.name, pixel, size, (*shown, 1.0)[:4], known)


class _ImageLocals(Composed):
    """An image's function, changed to return its locals and the color."""

    signature = (("frame", FRAME),)
    result: Type = VEC3  # until it is composed

    def __init__(self, image: Image, found: list[Local]) -> None:
        self.name = f"probe of {image.name}"
        self._image = image
        self._found = found

    def compose(self, assembly: Assembly) -> str:
        """Add the function that returns a struct, and return its name."""
        slot = read_signature(self._image.overloads[0]).parameters[0].name
        call: Any = assembly.call(self._image, {slot: Read(slot, FRAME)})
        function = assembly.function(call.function)
        kept = kept_values(function, self._found)
        fields: list[tuple[str, Type]] = []
        for i, each in enumerate(kept):
            fields += [(f"value{i}", each.local.type), (f"reached{i}", BOOL)]
        fields.append(("color", function.result))
        self.result = assembly.adopt(Struct("Locals", tuple(fields), False))
        parts = [part for each in kept for part in (each.value, each.reached)]
        body = watched(function, kept, lambda color: Construct((*parts, color), self.result))
        name = f"{function.name}_locals"
        return assembly.define(name, function.params, self.result, body, function.span)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the image calls."""
        return (self._image,)


def plain(value: Any) -> Any:
    """Return a value of scene code as a plain number or list."""
    if value is None or isinstance(value, bool | int | float):
        return value
    return [plain(c) for c in value]
