"""The program that guides a scene's camera: from a gesture to the numbers that it leads to.

Input: a scene; as uniforms the numbers that the camera has, those that a gesture asks for, and the
action of a key. Output: an image of one row, in which each pixel holds the bits of one number, so
that a picture of eight bits per channel is enough to read them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, ClassVar

from distal.frontend import Assembly
from distal.ir.build import field
from distal.ir.nodes import EntryKind, Expr, Param, Read, Return
from distal.ir.types import FRAME, INT, VEC2, VEC4
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.loading import copy_loaded_from
from distal.render import guide
from distal.scene import steering
from distal.scene.lowering.picture import SceneLowering
from distal.scene.lowering.shapes import ZERO_CELL
from distal.scene.lowering.union_parts import parts_of
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.scene import Scene


class GuideImage(Composed):
    """An image of one row: the numbers of ``guide.NUMBERS``, one pixel each."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4

    def __init__(self, scene: Scene) -> None:
        copy_loaded_from(scene, self)
        self.name = f"{scene.name} (guide)"
        self._scene = scene

    def compose(self, assembly: Assembly) -> str:
        """Add the function that maps the frame to a pixel, and return its name."""
        made = SceneLowering(assembly, self._scene)
        composer, node = made.composer, made.node
        body = StatementList(taken={"frame"})
        values = composer.values.all(node)
        # The picture that is guided has another size than this image.
        size = assembly.number(steering.SIZE, VEC2, (4.0, 3.0))
        given: dict[str, Expr] = {
            "coord": field(Read("frame", FRAME), "coord"),
            "size": size,
            "lens": made.camera.lens(body, size),
            "now": made.camera.steer(body, steering.PREFIX),
            "goal": made.camera.steer(body, steering.GOAL_PREFIX),
            "box": box_of_finite(made, body, guide.box_of),
            "field": composer.safe_field(node, values, ZERO_CELL),
        }
        action = {**given, "action": assembly.number(steering.ACTION, INT, 0)}
        given["action"] = composer.call(guide.asked, action)
        given["guided"] = body.let("guided", composer.call(guide.guided, given))
        body.statements.append(Return(composer.call(guide.pixel_of, given)))
        params = (Param("frame", FRAME),)
        return assembly.define("guide", params, VEC4, body.statements, self._scene.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that this object calls."""
        return self._scene.functions()


def box_of_finite(made: SceneLowering, body: StatementList, box: Func) -> Expr:
    """Return the box around the parts of the scene that are finite; planes have no part in it.

    Args:
        made: The scene.
        body: Takes the statements.
        box: ``guide.box_of``, without the ground, or ``ruler.box_of_all``.
    """
    composer = made.composer
    parts = body.let("parts", composer.call(guide.no_parts, {}))
    # The last part first: of boxes of the same size the first one counts.
    for node in reversed(list(parts_of(made.node))):
        part = composer.bounds.of(body, node, composer.values.all(node)).bounds
        parts = body.let("parts", composer.call(guide.with_part, {"parts": parts, "bounds": part}))
    return composer.call(box, {"parts": parts})
