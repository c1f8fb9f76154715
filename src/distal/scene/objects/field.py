"""The base class of solid and flat shapes: evaluation, combination, materials.

Input: the author's numbers and shapes. Output: new shapes; shapes never change. A shape is also a
function of scene code: ``shape(p)`` in a ``@func``, ``shape(points)`` in Python.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar, Final, TypeVar, Unpack, overload

from distal.at_once import cached_property
from distal.diagnostics import Span
from distal.fields.combine import blends, joins
from distal.fields.guarantees import EXACT, Guarantee, Limit, Operator, ended
from distal.frontend import Assembly
from distal.frontend.problems import did_you_mean
from distal.ir.nodes import Call, Param, Read, Return
from distal.ir.types import FLOAT, INT, VEC3, Type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.lang.option_methods import RenderedShape
from distal.lang.places import PLACES
from distal.lang.presentable import Presentable
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor, viewing
from distal.lang.source_places import author_place
from distal.scene.lowering.derived import BoundsOf, GradientOf
from distal.scene.lowering.nesting import shallow
from distal.scene.lowering.parts.table import rolled_for
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.slope_limit import check_gradient, check_slope
from distal.scene.lowering.varied_cells import with_bounds_of_cells
from distal.scene.lowering.varied_places import with_bounds_of_places
from distal.scene.objects.binding import bound, own_node
from distal.scene.objects.materials import as_material
from distal.scene.objects.movable import Movable
from distal.scene.objects.other_names import instead
from distal.scene.objects.proving import proved
from distal.scene.objects.shape_values import PLAIN, ShapeValue
from distal.scene.objects.shaped_edges import suited
from distal.scene.objects.vm_shapes import vm_node
from distal.scene.tree.arguments import RESERVED, slots_of
from distal.scene.tree.conversion import Asked, number, plain_choice
from distal.scene.tree.conversion import Number as Checked
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import renamed
from distal.scene.tree.node import Node
from distal.scene.tree.value import recorded
from distal.scene.tree.values import plain_name

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from distal.images.picture import Picture
    from distal.lang import vec2, vec3
    from distal.scene.objects.argument_types import (
        Argument,
        ArrayLike,
        BlendNumbers,
        Box,
        Corners,
        Number,
        Painted,
        ParameterValues,
        Place2,
        Place3,
        Rows,
    )

# The most primitives in a tree: a hundred thousand take some hundred megabytes.
MOST_PARTS: Final = 1_000_000


# The class of the receiver. jedi takes Self for the class that defines the method.
S = TypeVar("S", bound="BaseShape")


class BaseShape(RenderedShape, ShapeValue, Composed, Presentable):
    """The base class of solid and flat shapes."""

    flat: ClassVar[bool] = False
    point_type: ClassVar[Type] = VEC3
    result = FLOAT
    signature = (("p", VEC3),)
    node: Node

    def __init__(self, node: Node) -> None:
        self._set_node(node)

    def _set_node(self, node: Node) -> None:
        if node.parts > MOST_PARTS:
            refuse(
                f"this {node.name} is made of {node.parts:,} shapes; more than {MOST_PARTS:,} "
                "take too long to compile and to draw",
                "repeat, array and symmetry show many copies for the price of one",
                node.place,
            )
        self.__dict__["node"] = with_bounds_of_places(shallow(node))

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a {type(self).__name__} does not change; make another")

    if not TYPE_CHECKING:  # a checker reports an unknown name itself

        def __getattr__(self, name):
            of_others = not name.startswith("_") and hasattr(PLAIN[not self.flat], name)
            message = instead(type(self).__name__, name, flat=self.flat, of_others=of_others)
            raise AttributeError(message, name=name, obj=self)

    @property
    def name(self) -> str:  # type: ignore[override]
        """The name set by the author, else that of the primitive or operator."""
        return self.node.name

    # Evaluation

    @cached_property
    def _gradient(self) -> GradientOf:
        return GradientOf(self.node)

    @cached_property
    def _bounds_function(self) -> BoundsOf:
        return BoundsOf(self.node)

    def compose(self, assembly: Assembly) -> str:
        """Add the distance function to the program, and return its name."""
        node = rolled_for(assembly, self.node, exact=True)
        composer = ShapeComposer(assembly, [node])
        found = composer.field(node, composer.values.all(node), ZERO_CELL)
        if not found.captures:
            return found.name
        value = Call(found.name, (Read("p", self.point_type), *found.captures), FLOAT)
        params = (Param("p", self.point_type),)
        name = f"{plain_name(self.name)}_distance"
        return assembly.define(name, params, FLOAT, (Return(value),), self.node.place)

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the shape calls."""
        return self.node.functions()

    @overload
    def __call__(
        self, point: Place2 | Place3, /, *, params: ParameterValues | None = None, time: float = 0.0
    ) -> float: ...
    @overload
    def __call__(
        self,
        points: ArrayLike | Rows,
        /,
        *,
        params: ParameterValues | None = None,
        time: float = 0.0,
    ) -> NDArray[np.floating[Any]]: ...
    def __call__(
        self, *points: Any, params: ParameterValues | None = None, time: float = 0.0
    ) -> Any:
        """Return the signed distance at points, negative inside.

        Args:
            points: A point, or one array (n, 3), or (n, 2) for a flat shape. A grid (an array with
                more dimensions) is allowed too.
            params: Values of parameters by name; the others have their defaults.
            time: Time in seconds.

        Returns:
            A number; or an array of the shape of ``points`` without the last axis. Float32 arrays
            in, float32 out; everything else is computed in 64 bits.
        """
        return self._asked(self, points, params, time)

    def _rendered(self, options: RenderOptions) -> Picture:
        """Render a picture of the shape alone: its camera, light and background are chosen for it.

        A flat shape is shown as it lies in its plane. ``Scene(shape).render`` has more options.

        Raises:
            CompileError: The shape's scene code has mistakes.
            DeviceError: The device is missing or was lost.
        """
        scene = viewing.viewable(self, options.params, options.time).scene
        assert scene is not None
        return scene._rendered(options)

    @overload
    def gradient(
        self, point: Place2, /, *, params: ParameterValues | None = None, time: float = 0.0
    ) -> vec2: ...
    @overload
    def gradient(
        self, point: Place3, /, *, params: ParameterValues | None = None, time: float = 0.0
    ) -> vec3: ...
    @overload
    def gradient(
        self,
        points: ArrayLike | Rows,
        /,
        *,
        params: ParameterValues | None = None,
        time: float = 0.0,
    ) -> NDArray[np.floating[Any]]: ...
    def gradient(
        self, *points: Any, params: ParameterValues | None = None, time: float = 0.0
    ) -> Any:
        """Return the gradient of the distance at points, an array of the shape of ``points``.

        Arguments as for a call of the shape.
        """
        return self._asked(self._gradient, points, params, time)

    def _asked(
        self, what: Composed, points: Any, params: Mapping[str, Any] | None, time: float
    ) -> Any:
        """Evaluate a function of a point at points, or at a grid of points."""
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

    def bounds(self, *, params: ParameterValues | None = None, time: float = 0.0) -> Box:
        """Return a box (low, high) around the surface and the inside, two tuples.

        A side without end is infinite.
        """
        low, high = self._known_bounds(params, time)[2:4]
        return tuple(map(ended, low)), tuple(map(ended, high))

    @property
    def slope(self) -> float:
        """Lipschitz bound (slope): a bound on |gradient| everywhere, for default parameters."""
        return float(self._known_bounds(None, 0.0)[0])

    @property
    def divisor(self) -> float:
        """The number by which the marcher divides distances, for the parameters' defaults."""
        return float(self._known_bounds(None, 0.0)[1])

    @property
    def claims(self) -> frozenset[Guarantee]:
        """The guarantees besides the bound on the slope."""
        return self.node.claims

    @property
    def exact(self) -> bool:
        """Whether the value is the true distance, outside and inside."""
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
        """Apply an operator to this shape, and to others.

        Args:
            rule: The operator.
            args: The operator's numbers by position.
            kwargs: The operator's numbers by name.
            place: The author's line.
            others: The shapes to combine this one with.
        """
        flat = _flat_result(rule, self.flat)
        if flat is None:
            kind, fix = ("solid", ".extrude(height)") if self.flat else ("flat", ".slice()")
            refuse(f"{rule.name} works on {kind} shapes", f"{fix} first", place)
        numbers, constants = bound(rule, args, kwargs, place)
        own = self.node
        if rule.repeats:
            own = with_bounds_of_cells(own, rule, numbers, constants, place)
        children = (own, *(other.node for other in others))
        if others:
            rule, more = suited(rule, children, numbers)
            numbers = {**numbers, **more}
        made = self._of(Node(rule, flat, children, numbers, constants, place))
        check_slope(made.node)
        return made

    @classmethod
    def _of(cls, node: Node) -> Any:
        plain = PLAIN[node.flat]
        made = plain.__new__(plain)
        made._set_node(node)
        return made

    def _combined(
        self, sharp: Operator, others: Sequence[Any], smooth: Any, blend: str, **extra: Any
    ) -> Any:
        place, kind = author_place(), sharp.name
        # One list of shapes counts as these shapes.
        if len(others) == 1 and isinstance(others[0], Iterable) and not isinstance(others[0], str):
            others = tuple(others[0])
        for other in others:
            if not isinstance(other, BaseShape):
                hint = "smooth=0.1 is given by name" if isinstance(other, float) else None
                hint = "a | group, or group(a, b)" if isinstance(other, Movable) else hint
                refuse_kind(f"a {kind} joins shapes, not {other!r:.60}", hint, place)
            if other.flat != self.flat:
                refuse(
                    f"a {kind} joins a flat shape and a solid one",
                    "make the flat one solid: .extrude(height) or .revolve()",
                    place,
                )
        rule, numbers, constants = joining(sharp, smooth, blend, extra, place)
        # A union of a union is one union; a difference of a difference likewise.
        bare = rule if not numbers else None
        nodes: list[Node] = []
        for shape in others:
            node = shape.node
            nested = node.rule is bare and sharp in _ASSOCIATIVE and _bare(node)
            nodes.extend(node.children if nested else (node,))
        own = self.node
        if own.rule is bare and _bare(own):
            return self._of(Node(rule, self.flat, own.followed_by(nodes), {}, constants, place))
        children = (own, *nodes)
        rule, more = suited(rule, children, numbers)
        return self._of(Node(rule, self.flat, children, {**numbers, **more}, constants, place))

    def union(
        self: S,
        *others: BaseShape | Iterable[BaseShape],
        smooth: Number = 0.0,
        blend: str = "quadratic",
        **blend_numbers: Unpack[BlendNumbers],
    ) -> S:
        """Unite with other shapes; also written ``a | b``.

        Args:
            others: Shapes, or one list of shapes.
            smooth: How far a blend moves the surface outwards where two surfaces meet, in scene
                units; 0 for a sharp edge.
            blend: Form of the blend: quadratic, cubic, quartic, circular, circular_geometric,
                exponential, root, sigmoid; or of a shaped edge: chamfer, round, columns, stairs,
                soft.
            blend_numbers: ``count``: number of columns or stairs.
        """
        joined: S = self._combined(joins.UNION, others, smooth, blend, **blend_numbers)
        return joined

    def intersection(
        self: S,
        *others: BaseShape | Iterable[BaseShape],
        smooth: Number = 0.0,
        blend: str = "quadratic",
        **blend_numbers: Unpack[BlendNumbers],
    ) -> S:
        """Intersect with other shapes; also written ``a & b``.

        Arguments as for ``union``.
        """
        joined: S = self._combined(joins.INTERSECTION, others, smooth, blend, **blend_numbers)
        return joined

    def difference(
        self: S,
        *others: BaseShape | Iterable[BaseShape],
        smooth: Number = 0.0,
        blend: str = "quadratic",
        **blend_numbers: Unpack[BlendNumbers],
    ) -> S:
        """Subtract other shapes, one after the other; also written ``a - b``.

        Arguments as for ``union``.
        """
        joined: S = self._combined(joins.DIFFERENCE, others, smooth, blend, **blend_numbers)
        return joined

    def xor(self: S, *others: BaseShape | Iterable[BaseShape]) -> S:
        """Keep what is in exactly one of two shapes; also written ``a ^ b``.

        Of more shapes, it is what is in an odd number of them.

        Args:
            others: Shapes, or one list of shapes.
        """
        joined: S = self._combined(joins.XOR, others, 0.0, "quadratic")
        return joined

    def __or__(self: S, other: BaseShape) -> S:
        return self.union(other) if isinstance(other, BaseShape) else NotImplemented

    def __and__(self: S, other: BaseShape) -> S:
        return self.intersection(other) if isinstance(other, BaseShape) else NotImplemented

    def __sub__(self: S, other: BaseShape) -> S:
        return self.difference(other) if isinstance(other, BaseShape) else NotImplemented

    def __xor__(self: S, other: BaseShape) -> S:
        return self.xor(other) if isinstance(other, BaseShape) else NotImplemented

    if not TYPE_CHECKING:  # a checker reports the operator itself

        def __add__(self, other):
            hint = "a | b joins two; a.union(b, c), or a.union(list), many"
            refuse_kind("shapes are joined by |, not by +", hint)

        __radd__ = __add__  # sum() begins with 0 + shape

        def __mul__(self, other):
            refuse_kind("a shape is not multiplied", "shape.scale(2)", author_place())

        __rmul__ = __truediv__ = __mul__

    def __bool__(self) -> bool:
        """Refuse ``a and b``, which would be one of the two, and ``if a``."""
        hint = "a & b, a | b or a - b; and shape is None asks whether there is one"
        refuse_kind("a shape is neither true nor false", hint, author_place())

    def __invert__(self: S) -> S:
        return self.complement()

    def complement(self: S) -> S:
        """Swap inside and outside; also written ``~a``."""
        made: S = self._under(joins.COMPLEMENT, (), {}, author_place())
        return made

    def paint(self: S, material: Painted, *, priority: int = 0) -> S:
        """Set the material, or its color; the outermost ``paint`` counts.

        Solids of one priority merge where they overlap. Of solids with different priorities that
        are united by ``|``, the higher displaces the lower: a glass of priority 2 that holds wine
        of priority 1, a pebble of priority 3 inside of either.

        Args:
            material: A material, a color, a pattern.
            priority: A whole number.
        """
        made = as_material(material)
        asked = Asked("priority", "paint", INT, Limit.ANY, place=author_place())
        if rank := plain_choice(priority, asked):
            made = made.replace(priority=rank)
        return self._again(self.node.with_material(made))

    def cut_material(self: S, material: Painted) -> S:
        """Set the material of the faces that this shape cuts into others.

        Without it, these faces show the material of the shape that is cut.
        """
        return self._again(replace(self.node, cut_material=as_material(material)))

    def named(self: S, name: str) -> S:
        """Set a name that is used in emitted texts and messages."""
        if not isinstance(name, str) or not name.strip():
            refuse(f"a name is a text, not {name!r}", None, author_place())
        return self._again(replace(self.node, label=name))

    @recorded
    @classmethod
    def from_function(
        cls: type[S],
        function: Func,
        *,
        slope: Number | None = None,
        bounds: Corners | None = None,
        exact: bool = False,
        growth: Number | None = None,
        normalize: bool = False,
        region: Corners | None = None,
        signed: bool | None = None,
        **numbers: Argument,
    ) -> S:
        """Make a shape from a ``@func`` of a point, and of numbers passed by name.

        Args:
            function: ``(p: vec3, …) -> float``, or with ``p: vec2`` for a flat shape. A parameter
                ``cell: vec3`` receives the index of the repetition that contains the point.
            slope: Lipschitz bound (slope): a bound on |gradient| everywhere, of the result if
                ``normalize``. The marcher relies on it. None: 1, which with ``normalize`` is only
                an estimate.
            bounds: Corners (low, high) of a box around the surface; None for an infinite shape.
            exact: Whether the value is the true distance.
            growth: How far from the box a point may be, at most, for each unit of its value; 1 if
                the value is never less than the distance to the box. None: unknown (1 if
                ``exact``). Operators that move the surface outwards (round, offset, blends) need it
                to compute a box. Used only with ``bounds``.
            normalize: Whether to divide values by the length of their gradient, which makes a badly
                scaled function (0 on the surface, like x^4 + y^4 + z^4 - 1) about the distance near
                its surface. Pass ``bounds`` too: they also limit the values far away.
            region: Corners (low, high) of a box that contains the whole shape. Then a slope and
                bounds that are not passed are proved by interval arithmetic, within the region; a
                slope that is passed is refused if the function is steeper at a point, or in a
                whole cell of the region. ``distal check`` says what is proved.
            signed: Whether values are negative inside. False: a sheet, or an estimate of a distance
                (a fractal), which is drawn a third of a pixel thick. None: found by samples, as
                ``distal check`` says.
            numbers: Values of the function's other parameters.

        Raises:
            SceneTypeError: The function is not a ``@func`` of a point that returns a float.
            SceneValueError: A number is beyond its limit, a function to normalize has no gradient,
                or nothing can be proved in ``region``.
        """
        place = author_place()
        proof = None
        if region is not None:
            slope, bounds, proof = proved(
                function, numbers, place, region=region, slope=slope, bounds=bounds
            )
        node = own_node(
            function,
            numbers,
            place,
            slope=slope,
            bounds=bounds,
            exact=exact,
            growth=growth,
            normalize=normalize,
            proved=proof,
            signed=signed,
        )
        if normalize:
            check_gradient(node)
        made: S = cls._of(node)
        return made

    @recorded
    @classmethod
    def from_vm(
        cls: type[S],
        source: str | PathLike[str],
        *,
        slope: Number | None = None,
        bounds: Corners | None = None,
    ) -> S:
        """Make a shape from a ``.vm`` file, a list of operations as Fidget writes it.

        Each line has a name, an operation, and a number or the names of earlier results:
        ``_2 add _0 _1``. The shape is flat if only ``var-x`` and ``var-y`` occur, else solid.

        Args:
            source: The path of a file, or its text (more than one line).
            slope: Lipschitz bound (slope): a bound on |gradient| everywhere. The marcher relies on
                it. None: 1.
            bounds: Corners (low, high) of a box around the surface; None for an infinite shape.

        Raises:
            VmFileError: The file is invalid, or has more than 20,000 operations; the message shows
                the line.
            SceneValueError: The file cannot be read, or a number is beyond its limit.
        """
        made: S = cls._of(vm_node(source, author_place(), slope=slope, bounds=bounds))
        return made


def _bare(node: Node) -> bool:
    return node.material is None and node.cut_material is None and not node.label


@lru_cache(maxsize=1024)
def _flat_result(rule: Operator, flat: bool) -> bool | None:
    """Return whether the result of an operator lies in the plane; None if it takes no such child.

    Args:
        rule: The operator.
        flat: Whether the child lies in the plane.
    """
    result = rule.lies_flat(flat)
    return result if rule.takes_flat(result) is flat else None


_ASSOCIATIVE: Final = (joins.UNION, joins.INTERSECTION)


def joining(
    sharp: Operator, smooth: Any, blend: str, extra: Mapping[str, Any], place: Span | None
) -> tuple[Operator, dict[str, Checked], dict[str, Any]]:
    """Return the operator of a combination, its numbers and its constants.

    Args:
        sharp: The operator without a blend.
        smooth: The size of the blend.
        blend: The name of the blend.
        extra: The other numbers of the blend.
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
    numbered = {slot.name for slot in slots_of(rule.combine)} - {*RESERVED, "smooth"}
    if unknown := set(extra) - numbered:
        name = min(unknown)
        hint = renamed(rule.name, name) or did_you_mean(name, {"smooth", "blend", *numbered})
        refuse_kind(f"a {blend} {kind} has no '{name}'", hint, place)
    limit = rule.limits.get("smooth", Limit.ANY)
    number(smooth, Asked("smooth", kind, FLOAT, limit, place=place, varies=PLACES))
    numbers, constants = bound(rule, (smooth,), extra, place)
    return rule, numbers, constants
