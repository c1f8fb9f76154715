"""Groups: shapes, lights and cameras that are placed together.

Input: the author's objects, other groups and scenes. Output: a group, which is placed, added to
others and given to a scene. Does not depend on how a scene is drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final, NoReturn, Self, TypeAlias

from distal.fields.guarantees import Operator
from distal.lang.immutable import Immutable
from distal.lang.lazy_module import LazyModule
from distal.lang.option_methods import RenderedShape
from distal.lang.presentable import Presentable
from distal.lang.runtime_access import viewing
from distal.lang.source_places import author_place
from distal.scene.objects.cameras import BaseCamera
from distal.scene.objects.lights import Light
from distal.scene.objects.movable import MovableSolid
from distal.scene.objects.shape import Shape, Shape2D
from distal.scene.scene_values import SceneValue
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.value import AuthorObject

if TYPE_CHECKING:
    from distal.diagnostics import Span
    from distal.images.picture import Picture
    from distal.lang.render_options import RenderOptions
    from distal.scene.objects import shape_rows
    from distal.scene.objects.argument_types import Painted
    from distal.scene.scene import Scene
    from distal.scene.tree.texts import TextWriter

    # What a scene shows.
    Solid: TypeAlias = "Shape | Group | Scene"
    Part: TypeAlias = "Shape | Light | BaseCamera | Group | Scene"
else:
    shape_rows = LazyModule("distal.scene.objects.shape_rows")

_HINT: Final = "group(Sphere(), PointLight((2, 3, 4)), Camera())"


class Group(RenderedShape, MovableSolid, AuthorObject, Immutable, Presentable):
    """Shapes, lights and cameras together, made by ``group``.

    A group never changes; its methods place all of it and return another group.

    Attributes:
        parts: What it was made of, in order.
    """

    __slots__ = ("_kept_digest", "parts")

    parts: tuple[Part, ...]

    def __init__(self, *parts: Part | Iterable[Part]) -> None:
        listed = parts
        if len(parts) == 1 and isinstance(parts[0], Iterable) and not isinstance(parts[0], str):
            listed = tuple(parts[0])
        place = author_place()
        if not listed:
            refuse("a group has at least one part", _HINT, place)
        for part in listed:
            _check_part(part, place)
        object.__setattr__(self, "parts", listed)

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError("a group does not change; make another")

    def as_scene(self) -> Scene:
        """Return a scene of the group: ``Scene(group)``."""
        scene = viewing.viewable(self).scene
        assert scene is not None
        return scene

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments by name."""
        return MappingProxyType({"parts": self.parts})

    def _replaced(self, changes: dict[str, Any]) -> Self:
        """Return a group of other parts: ``lamp.replace(parts=(*lamp.parts, bulb))``."""
        for name in changes:
            if name != "parts":
                refuse_kind(f"a group has no '{name}'", "parts=(…)", author_place())
        return type(self)(*changes.get("parts", self.parts))

    def _written(self, writer: TextWriter) -> str:
        return f"group({writer.several(self.parts, ', ')})"

    def _compared(self) -> tuple[Any, ...]:
        return "group", self.parts

    def _pickled(self) -> Any:
        return _group_of, (type(self), shape_rows.packed(self.parts))

    # What is in it

    @property
    def shape(self) -> Shape | None:
        """The union of all shapes, those of groups and scenes in it too; None without shapes."""
        shapes: list[Shape] = [*self._all(Shape)]
        if len(shapes) < 2:
            return shapes[0] if shapes else None
        return shapes[0].union(*shapes[1:])

    @property
    def lights(self) -> tuple[Light, ...]:
        """All lights; of scenes those that their authors gave them."""
        return tuple(self._all(Light))

    @property
    def cameras(self) -> tuple[BaseCamera, ...]:
        """All cameras but those of scenes."""
        return tuple(self._all(BaseCamera))

    def _all(self, kind: type[Any] | tuple[type[Any], ...]) -> Iterator[Any]:
        for part in self.parts:
            if isinstance(part, kind):
                yield part
            elif isinstance(part, Group):
                yield from part._all(kind)
            elif isinstance(part, SceneValue) and kind is not BaseCamera:
                yield from _contents(part)._all(kind)

    # Groups of others

    def _with(self, operator: Operator, *args: Any, **kwargs: Any) -> Self:
        return self._each(lambda part: part._with(operator, *args, **kwargs))

    def _each(self, change: Callable[[Any], Any]) -> Self:
        """Return the group of changed parts; a scene becomes the group of its contents."""
        parts = (_contents(p) if isinstance(p, SceneValue) else p for p in self.parts)
        return type(self)(*map(change, parts))

    def paint(self, material: Painted, *, priority: int = 0) -> Self:
        """Set the material of all shapes, as ``paint`` of a shape.

        Args:
            material: A material, a color, a pattern.
            priority: A whole number; see ``paint`` of a shape.
        """

        def painted(part: Any) -> Any:
            if isinstance(part, Light | BaseCamera):
                return part
            return part.paint(material, priority=priority)

        return self._each(painted)

    def __or__(self, other: Part) -> Group:
        # Placing a group places its parts: it is the list of them, and loops make no deep tree.
        return Group(*self.parts, other) if isinstance(other, _PARTS) else NotImplemented

    def __ror__(self, other: Part) -> Group:
        return Group(other, *self.parts) if isinstance(other, _PARTS) else NotImplemented

    # Pictures

    def _rendered(self, options: RenderOptions) -> Picture:
        """Render the picture of ``Scene(group)``."""
        return self.as_scene()._rendered(options)


_PARTS: Final = (Shape, Light, BaseCamera, Group, SceneValue)


def group(*parts: Part | Iterable[Part]) -> Group:
    """Group shapes, lights and cameras, which are then placed together.

    ``Scene(group(lamp, light).translate(0, 2, 0))``: positions and directions of lights and cameras
    move as the shapes do; a scale changes sizes and distances, and no intensity. Groups are grouped
    and added by ``|``, also to shapes. A scene is grouped without its camera and its look.

    Args:
        parts: Shapes, lights, cameras, groups and scenes, or one list of them.

    Raises:
        SceneTypeError: A part is something else.
        SceneValueError: There is no part, or a shape is flat.
    """
    return Group(*parts)


def _group_of(kind: type[Group], packed: shape_rows.PackedShapes) -> Group:
    """Return a group from a pickle."""
    return kind(*shape_rows.unpacked(packed))


def _contents(scene: SceneValue) -> Group:
    """Return the shapes of a scene, and the lights that its author gave it."""
    given = scene.arguments
    inside = Group(given["shape"], *(given["lights"] or ()))
    return Group(*inside._all((Shape, Light)))


def _check_part(part: Any, place: Span | None) -> None:
    if isinstance(part, Shape2D):
        hint = "make it solid: .extrude(height) or .revolve()"
        refuse(f"'{part.name}' is a flat shape; a group is of solids", hint, place)
    if not isinstance(part, _PARTS):
        kind = f"the class {part.__name__}" if isinstance(part, type) else f"{part!r:.60}"
        refuse_kind(f"a group is of shapes, lights and cameras, not {kind}", _HINT, place)
