"""What solid and flat shapes share: evaluation, combination, paint.

Input: the author's numbers and shapes. Output: new shapes; none changes. A shape is a function of
scene code too: ``shape(p)`` in a ``@func``, ``shape(points)`` in Python.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, ClassVar, Final, NoReturn, Self

from distal.diagnostics import Span
from distal.fields.combine import blends, joins
from distal.fields.guarantees import EXACT, Guarantee, Limit, Operator, ended
from distal.frontend import Assembly
from distal.frontend.problems import did_you_mean
from distal.ir.nodes import Call, Param, Read, Return
from distal.ir.types import FLOAT, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.presentable import Presentable
from distal.lang.runtime_access import executor
from distal.scene.lowering.derived import BoundsOf, GradientOf
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.slope_limit import check_slope
from distal.scene.objects.binding import bound, own_node
from distal.scene.objects.materials import as_material
from distal.scene.objects.other_names import instead
from distal.scene.tree.arguments import RESERVED, slots_of
from distal.scene.tree.conversion import Asked, Number, number
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node
from distal.scene.tree.source_places import author_place
from distal.scene.tree.values import plain_name

# A union of so many shapes compiles for minutes.
MOST_PARTS: Final = 2048


class BaseShape(Composed, Presentable):
    """What solid and flat shapes share."""

    flat: ClassVar[bool] = False
    point_type: ClassVar[Type] = VEC3
    result = FLOAT
    node: Node
    _gradient: GradientOf
    _bounds_function: BoundsOf

    def __init__(self, node: Node) -> None:
        if node.parts > MOST_PARTS:
            refuse(
                f"this {node.name} is made of {node.parts:,} shapes; more than {MOST_PARTS:,} "
                "take too long to compile and to draw",
                "repeat, array and mirror show many copies for the price of one",
                node.place,
            )
        made = {
            "node": node,
            "signature": (("p", self.point_type),),
            "_gradient": GradientOf(node),
            "_bounds_function": BoundsOf(node),
        }
        self.__dict__.update(made)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} does not change; make another")

    def __getattr__(self, name: str) -> NoReturn:
        of_others = not name.startswith("_") and hasattr(PLAIN[not self.flat], name)
        message = instead(type(self).__name__, name, flat=self.flat, of_others=of_others)
        raise AttributeError(message, name=name, obj=self)

    @property
    def name(self) -> str:  # type: ignore[override]
        """The author's name for it, else the primitive's or operator's."""
        return self.node.name

    # Evaluation

    def compose(self, assembly: Assembly) -> str:
        """Its distance as a function of scene code."""
        composer = ShapeComposer(assembly, [self.node])
        found = composer.field(self.node, composer.values.all(self.node), ZERO_CELL)
        if not found.captures:
            return found.name
        value = Call(found.name, (Read("p", self.point_type), *found.captures), FLOAT)
        params = (Param("p", self.point_type),)
        name = f"{plain_name(self.name)}_distance"
        return assembly.define(name, params, FLOAT, (Return(value),), self.node.place)

    def functions(self) -> Iterable[Func]:
        """The functions that it is made of."""
        return self.node.functions()

    def __call__(
        self, *points: Any, params: Mapping[str, Any] | None = None, time: float = 0.0
    ) -> Any:
        """The distance at points, negative inside.

        Args:
            points: One array (n, 3), or (n, 2) for a flat shape; float32 or float64. A grid, an
                array of more dimensions, is allowed too.
            params: Values of parameters by name; the others have their defaults.
            time: Seconds.

        Returns:
            An array of the shape of ``points`` without the last axis, of the same type.
        """
        return self._asked(self, points, params, time)

    def gradient(
        self, *points: Any, params: Mapping[str, Any] | None = None, time: float = 0.0
    ) -> Any:
        """The gradient of the distance at points, an array of the shape of ``points``.

        Arguments as for a call.
        """
        return self._asked(self._gradient, points, params, time)

    def _asked(
        self, what: Composed, points: Any, params: Mapping[str, Any] | None, time: float
    ) -> Any:
        """The values of a function of a point at points, or at a grid of points."""
        if len(points) != 1:
            size = 2 if self.flat else 3
            raise TypeError(
                f"{self.name}() takes one point, or one array of points with {size} numbers each; "
                f"{len(points)} arguments were given"
            )
        sizes: tuple[int, ...] = getattr(points[0], "shape", ())
        if len(sizes) < 3:
            return executor().call(what, points, {}, params=params, time=time)
        rows = points[0].reshape(-1, sizes[-1])
        found = executor().call(what, (rows,), {}, params=params, time=time)
        return found.reshape(*sizes[:-1], *found.shape[1:])

    def _known_bounds(self, params: Mapping[str, Any] | None, time: float) -> tuple[Any, ...]:
        found = executor().call(self._bounds_function, (), {}, params=params, time=time)
        return tuple(found)

    def bounds(self, *, params: Mapping[str, Any] | None = None, time: float = 0.0) -> Any:
        """A box around the surface and the inside: (low, high), each a tuple; infinite allowed."""
        low, high = self._known_bounds(params, time)[2:4]
        return tuple(tuple(map(ended, corner)) for corner in (low, high))

    @property
    def slope(self) -> float:
        """A bound on |gradient|, everywhere, for the parameters' defaults."""
        return float(self._known_bounds(None, 0.0)[0])

    @property
    def divisor(self) -> float:
        """What the marcher divides distances by, for the parameters' defaults."""
        return float(self._known_bounds(None, 0.0)[1])

    @property
    def claims(self) -> frozenset[Guarantee]:
        """Its guarantees besides the bound on its slope."""
        return self.node.claims

    @property
    def exact(self) -> bool:
        """Whether it is the true distance, outside and inside."""
        return self.node.claims >= EXACT

    # Making others

    def _under(
        self,
        rule: Operator,
        args: Sequence[Any],
        kwargs: Mapping[str, Any],
        place: Span | None,
        others: Sequence[BaseShape] = (),
    ) -> Any:
        """This shape, and others, under an operator.

        Args:
            rule: The operator.
            args: Its numbers by position.
            kwargs: Its numbers by name.
            place: The author's line.
            others: The shapes that it combines this one with.
        """
        flat = rule.lies_flat(self.flat)
        if rule.takes_flat(flat) is not self.flat:
            kind, fix = ("solid", ".extrude(height)") if self.flat else ("flat", ".slice()")
            refuse(f"{rule.name} works on {kind} shapes", f"{fix} first", place)
        numbers, constants = bound(rule, args, kwargs, place)
        children = (self.node, *(other.node for other in others))
        node = Node(rule, flat, children, numbers, constants, place)
        check_slope(node)
        return self._of(node)

    @classmethod
    def _of(cls, node: Node) -> Any:
        plain = PLAIN[node.flat]
        made = plain.__new__(plain)
        BaseShape.__init__(made, node)
        return made

    def _combined(
        self, sharp: Operator, others: Sequence[Any], smooth: Any, blend: str, **k: Any
    ) -> Any:
        place, kind = author_place(), sharp.name
        # One list of shapes is as good as the shapes.
        if len(others) == 1 and isinstance(others[0], Iterable) and not isinstance(others[0], str):
            others = tuple(others[0])
        for other in others:
            if not isinstance(other, BaseShape):
                hint = "smooth=0.1 is given by name" if isinstance(other, float) else None
                refuse_kind(f"a {kind} joins shapes, not {other!r:.60}", hint, place)
            if other.flat != self.flat:
                refuse(
                    f"a {kind} joins a flat shape and a solid one",
                    "make the flat one solid: .extrude(height) or .revolve()",
                    place,
                )
        rule, numbers, constants = joining(sharp, smooth, blend, k, place)
        nodes: list[Node] = []
        for shape in (self, *others):
            plain = not numbers and shape.node.rule is rule and _bare(shape.node)
            nested = plain and (sharp in _ASSOCIATIVE or shape is self)
            nodes.extend(shape.node.children if nested else (shape.node,))
        return self._of(Node(rule, self.flat, tuple(nodes), numbers, constants, place))

    def union(self, *others: Any, smooth: Any = 0.0, blend: str = "quadratic", **k: Any) -> Self:
        """Unite with others; ``|``.

        Args:
            others: Shapes, or one list of them.
            smooth: How far the surface moves out where two surfaces meet, in scene units.
            blend: Its form: quadratic, cubic, quartic, circular, circular_geometric, exponential,
                root, sigmoid, or an edge: chamfer, round, columns, stairs, soft.
            k: ``count``: how many columns or stairs.
        """
        joined: Self = self._combined(joins.UNION, others, smooth, blend, **k)
        return joined

    def intersection(
        self, *others: Any, smooth: Any = 0.0, blend: str = "quadratic", **k: Any
    ) -> Self:
        """Intersect with others; ``&``. Arguments as for ``union``."""
        joined: Self = self._combined(joins.INTERSECTION, others, smooth, blend, **k)
        return joined

    def difference(
        self, *others: Any, smooth: Any = 0.0, blend: str = "quadratic", **k: Any
    ) -> Self:
        """Subtract others; ``-``. Arguments as for ``union``."""
        joined: Self = self._combined(joins.DIFFERENCE, others, smooth, blend, **k)
        return joined

    def xor(self, *others: Any) -> Self:
        """Keep what is in one of two shapes and not in the other; ``^``."""
        joined: Self = self._combined(joins.XOR, others, 0.0, "quadratic")
        return joined

    def __or__(self, other: Any) -> Self:
        return self.union(other) if isinstance(other, BaseShape) else NotImplemented

    def __and__(self, other: Any) -> Self:
        return self.intersection(other) if isinstance(other, BaseShape) else NotImplemented

    def __sub__(self, other: Any) -> Self:
        return self.difference(other) if isinstance(other, BaseShape) else NotImplemented

    def __xor__(self, other: Any) -> Self:
        return self.xor(other) if isinstance(other, BaseShape) else NotImplemented

    def __add__(self, other: Any) -> NoReturn:
        hint = "a | b joins two; a.union(b, c), or a.union(list), many"
        refuse_kind("shapes are joined by |, not by +", hint)

    __radd__ = __add__  # sum() begins with 0 + shape

    def __invert__(self) -> Self:
        return self.complement()

    def complement(self) -> Self:
        """Swap inside and outside; ``~``."""
        made: Self = self._under(joins.COMPLEMENT, (), {}, author_place())
        return made

    def paint(self, material: Any) -> Self:
        """Set the material, or its color; the outermost ``paint`` counts."""
        changed: Self = self._of(replace(self.node, material=as_material(material)))
        return changed

    def cut_material(self, material: Any) -> Self:
        """Set the material of faces cut by this shape; without it they show what is cut."""
        changed: Self = self._of(replace(self.node, cut_material=as_material(material)))
        return changed

    def named(self, name: str) -> Self:
        """Set a name, for the function in emitted text and for messages."""
        if not isinstance(name, str) or not name.strip():
            refuse(f"a name is a text, not {name!r}", None, author_place())
        changed: Self = self._of(replace(self.node, label=name))
        return changed

    @classmethod
    def from_function(
        cls,
        function: Func,
        *,
        slope: float = 1.0,
        bounds: Any = None,
        exact: bool = False,
        growth: float | None = None,
        **numbers: Any,
    ) -> Any:
        """Make a shape from a ``@func`` of a point (and of numbers, given by name).

        Args:
            function: ``(p: vec3, …) -> float``; vec2 makes a flat shape. A parameter
                ``cell: vec3`` is the index of the repetition the point lies in.
            slope: A bound on |gradient| everywhere. The marcher relies on it.
            bounds: (low, high) corners of a box around the surface; None for no end.
            exact: Whether it is the true distance.
            growth: With ``bounds``, how far from the box a point may be for each unit of its value:
                1 where the value is never less than the distance to the box. None: not known (1 if
                ``exact``). What moves the surface out (round, offset, blends) needs it for a box.
            numbers: Values of its other parameters.
        """
        place = author_place()
        node = own_node(
            function, numbers, place, slope=slope, bounds=bounds, exact=exact, growth=growth
        )
        return cls._of(node)


def _bare(node: Node) -> bool:
    return node.material is None and node.cut_material is None and not node.label


_ASSOCIATIVE: Final = (joins.UNION, joins.INTERSECTION)


# The classes of shapes that come from operators, by ``flat``; ``shape`` fills it.
PLAIN: dict[bool, type[BaseShape]] = {}


def joining(
    sharp: Operator, smooth: Any, blend: str, extra: Mapping[str, Any], place: Span | None
) -> tuple[Operator, dict[str, Number], dict[str, Any]]:
    """The operator of a combination, its numbers and constants.

    Args:
        sharp: The operator without a blend.
        smooth: The author's size of the blend.
        blend: Its name.
        extra: Its other numbers.
        place: The author's line.

    Raises:
        SceneValueError: There is no such blend, or ``smooth`` is beyond its limit.
        SceneTypeError: The blend has no such number.
    """
    kind = sharp.name
    plain = isinstance(smooth, int | float) and smooth == 0 and not extra
    if plain and blend == "quadratic":
        return sharp, {}, {}
    rule = blends.COMBINATIONS.get((kind, blend))
    if rule is None:
        known = [name for of, name in blends.COMBINATIONS if of == kind]
        refuse(f"there is no blend '{blend}' for a {kind}", ", ".join(known), place)
    assert rule.combine is not None
    numbered = {slot.name for slot in slots_of(rule.combine)} - {*RESERVED, "k"}
    if unknown := set(extra) - numbered:
        hint = did_you_mean(min(unknown), {"smooth", "blend", *numbered})
        refuse_kind(f"a {blend} {kind} has no '{min(unknown)}'", hint, place)
    number(smooth, Asked("smooth", kind, FLOAT, rule.limits.get("k", Limit.ANY), place=place))
    numbers, constants = bound(rule, (smooth,), extra, place)
    return rule, numbers, constants
