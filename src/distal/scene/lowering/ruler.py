"""The programs of inspection: the place under a pointer, a ruler in the picture, planes that cut.

Input: a scene; as uniforms the movement of its camera, and the place of the pointer or the ends of
the ruler. Output: images of one row, in which each pixel holds the bits of one number, so that a
picture of eight bits per channel is enough to read them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar, Final

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Param, Read, Return
from distal.ir.types import FRAME, VEC2, VEC3, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.render import ruler
from distal.scene.lowering.guide import box_of_finite
from distal.scene.lowering.picture import SceneLowering
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene

# The uniforms: the size of the picture, the pointer's place in it, the ends of a ruler.
SIZE: Final = "Ruler_size"
POINTER: Final = "Ruler_pointer"
START: Final = "Ruler_start"
END: Final = "Ruler_end"


class _NumberImage(Composed):
    """An image of one row of numbers."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene, name: str) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} ({name})"
        self._scene = scene

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


class PlaceImage(_NumberImage):
    """The place under a pointer: the numbers of ``ruler.PLACE_NUMBERS``, one pixel each."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, "place")

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        made = SceneLowering(assembly, self._scene)
        body = StatementList(taken={"frame"})
        size = assembly.number(SIZE, VEC2, (4.0, 3.0))
        given = made.given_of_layers(body, size, steered=True)
        given["coord"] = field(Read("frame", FRAME), "coord")
        pointer = {**given, "pointer": assembly.number(POINTER, VEC2, (0.0, 0.0))}

        given["uv"] = made.composer.call(ruler.pointed, pointer)
        given["place"] = body.let("place", made.composer.call(ruler.place_under, given))
        body.statements.append(Return(made.composer.call(ruler.place_pixel, given)))
        params = (Param("frame", FRAME),)
        return assembly.define("place", params, VEC4, body.statements, self._scene.place)


class RulerImage(_NumberImage):
    """A ruler in the picture: the numbers of ``ruler.RULER_NUMBERS`` and its points' places."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, "ruler")

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        made = SceneLowering(assembly, self._scene)
        size = assembly.number(SIZE, VEC2, (4.0, 3.0))
        given = {
            "coord": field(Read("frame", FRAME), "coord"),
            "camera": made.camera.ray(size, steered=True),
            "resolution": size,
            "start": assembly.number(START, VEC3, (0.0, 0.0, 0.0)),
            "end": assembly.number(END, VEC3, (0.0, 0.0, 0.0)),
        }
        body = (Return(made.composer.call(ruler.ruler_pixel, given)),)
        params = (Param("frame", FRAME),)
        return assembly.define("ruler", params, VEC4, body, self._scene.place)


class CutImage(_NumberImage):
    """The planes that cut a scene open: the numbers of ``ruler.CUT_NUMBERS``, one pixel each."""

    def __init__(self, scene: Scene) -> None:
        super().__init__(scene, "cuts")

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        made = SceneLowering(assembly, self._scene)
        body = StatementList(taken={"frame"})
        camera = made.camera.ray(assembly.number(SIZE, VEC2, (4.0, 3.0)), steered=True)
        given = {
            "coord": field(Read("frame", FRAME), "coord"),
            "box": box_of_finite(made, body, ruler.box_of_all),
            "towards": made.composer.call(ruler.towards_eye, {"camera": camera}),
        }
        body.statements.append(Return(made.composer.call(ruler.cut_pixel, given)))
        params = (Param("frame", FRAME),)
        return assembly.define("cuts", params, VEC4, body.statements, self._scene.place)
