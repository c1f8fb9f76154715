"""The functions that follow rays through one scene: to the first surface, and to a light.

Input: the scene's tree and the values of its march. Output: a function ``(ray) -> Hit``, which all
renderers, views and layers call, a function of a point and a light that returns the visible share
of the light, and one of a point and a normal that returns the share of ambient light. Planes that
the scene is united with are met in closed form; the parts of a table are each marched in its box;
the other shapes are marched together.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Final, TypeAlias

from distal.fields.guarantees import UNBOUNDED, Primitive
from distal.frontend import Assembly
from distal.ir.build import boolean, builtin, cast, compare, integer, multiply
from distal.ir.build import field as field_of
from distal.ir.build import number as constant_number
from distal.ir.nodes import (
    Call,
    CompareOp,
    Const,
    Construct,
    Expr,
    FunctionRef,
    If,
    Param,
    Read,
    Return,
)
from distal.ir.types import BOOL, FLOAT, INT, VEC2, VEC3, FunctionType, Kind, Type
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.passes.fold.fold import fold_expression
from distal.render import (
    closed_hits,
    heightfield_march,
    part_grid,
    part_segments,
    part_shading,
    part_tree,
    segment,
    settings,
    shade,
    shadows,
    trace,
)
from distal.render.camera import Ray
from distal.render.lights import LightSample
from distal.scene.lowering.captures import capturing
from distal.scene.lowering.chords import chord_of, has_chord
from distal.scene.lowering.parts.table import TableNode
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.union_parts import parts_of, united
from distal.scene.tree.conversion import NO_VALUES
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.lowering import distance_grid
else:
    distance_grid = LazyModule("distal.scene.lowering.distance_grid")  # needs NumPy

# The number of steps of a ray through an exact field; a field that grows faster needs more.
STEPS: Final = 160
MOST_STEPS: Final = 4096
# A shadow ray starts at a surface, where steps are short: it takes so many times the steps of other
# rays, and at least this many. With as many, .2 % of the pixels of a ball on a floor lost one.
SHADOW_STEPS: Final = 2
LEAST_SHADOW_STEPS: Final = 64
# The most solids with chords that are met in closed form; more of them are marched.
MOST_SOLIDS: Final = 15
# The same for paths, which number them (``media.SPAN``).
MOST_SHAPES: Final = 15

# The number of the first shape that paths meet in closed form; that of each other one is one lower.
# Parts of a table have numbers from 0 on, and -1 is not known.
FIRST_SHAPE: Final = -2

# What is known of the start of a ray from the eye, as ``segment`` takes it.
FROM_ANYWHERE: Final = {"side": constant_number(0.0), "slope": constant_number(0.0)}
# What the marches take besides the ray and the fields.
_TAKEN: Final = (
    "bounds",
    "others_bounds",
    "has_others",
    "numbers",
    "steps",
    "hybrid",
    "stride",
    "farthest_plane",
    "steep",
    "some_sharp",
    "many_boxes",
    "look",
    "place",
    "count",
    "has_planes",
)

# Adds a function to the program: its name, its parameters, its body, captured values.
Make: TypeAlias = "Callable[[StatementList, Mapping[str, Expr]], Expr]"
Params: TypeAlias = "Sequence[tuple[str, Type]]"
Define: TypeAlias = "Callable[[str, Params, Make, Sequence[Expr]], FunctionRef]"


def function_in(
    assembly: Assembly, name: str, params: Params, make: Make, captured: Sequence[Expr] = ()
) -> FunctionRef:
    """Add a function to a program, and return it as a value.

    Args:
        assembly: The program.
        name: The preferred name.
        params: Names and types of its parameters.
        make: Adds its statements and returns its result.
        captured: Values that are bound to its last parameters.
    """
    body = StatementList(taken={n for n, _ in params})
    result = make(body, {n: Read(n, t) for n, t in params})
    body.statements.append(Return(result))
    declared = tuple(Param(n, t) for n, t in params)
    defined = assembly.define(name, declared, result.type, body.statements)
    free = tuple(t for _, t in params[: len(params) - len(captured)])
    return FunctionRef(defined, tuple(captured), FunctionType(free, result.type))


def step_limit(divisor: Expr, *, in_glass: bool = False) -> Expr:
    """Return the number of steps for a field whose values are divided by a number.

    Args:
        divisor: The number.
        in_glass: Whether rays go on inside of solids, where many graze a surface.
    """
    least, most = float(STEPS * (2 if in_glass else 1)), float(MOST_STEPS)
    wanted = builtin("max", multiply(divisor, constant_number(least)), constant_number(least))
    return _whole(builtin("min", wanted, constant_number(most)))


def shadow_step_limit(steps: Expr) -> Expr:
    """Return the number of steps of a shadow ray, given that of other rays."""
    more = multiply(steps, integer(SHADOW_STEPS))
    return fold_expression(builtin("max", more, integer(LEAST_SHADOW_STEPS)), 32)


def _whole(value: Expr) -> Expr:
    """Return a number rounded up; a constant if it is one."""
    return fold_expression(cast(builtin("ceil", value), Kind.INT), 32)


def split_planes(root: Node) -> tuple[list[Node], list[Node]]:
    """Return the planes that a tree is united with, and the other shapes of this union."""
    planes: list[Node] = []
    others: list[Node] = []
    for node in parts_of(root):
        (planes if is_linear(node) else others).append(node)
    return planes, others


def is_linear(node: Node) -> bool:
    """Return whether a subtree's distance is linear in the point."""
    if isinstance(node.rule, Primitive) or not node.children:
        return node.rule.linear
    return node.rule.linear and is_linear(node.children[0])


class RayFunctions:
    """Makes the functions of a scene that follow rays."""

    def __init__(
        self, composer: ShapeComposer, root: Node, define: Define, *, closed: bool = False
    ) -> None:
        """Begin.

        Args:
            composer: Makes the functions of the program's shapes.
            root: The scene's tree.
            define: Adds a function to the program.
            closed: Whether solids with chords are met in closed form on the whole way of rays that
                are followed from surface to surface.
        """
        self._composer = composer
        self._root = root
        self._define = define
        self._planes, others = split_planes(root)
        self._others = [node for node in others if not isinstance(node, TableNode)]
        is_closed = len(self._others) <= MOST_SOLIDS and all(map(has_chord, self._others))
        self._solids = self._others if is_closed else []
        self._beside = [*self._planes, *self._others]
        tables = [node for node in others if isinstance(node, TableNode)]
        self._table_node = tables[0] if tables else None
        self._table = composer.table(tables[0]) if tables else None
        # All shapes, if paths meet them in closed form; a hit has the number of its shape.
        self._closed: list[Node] = []
        shapes = [*self._others, *self._planes]
        if closed and self._table is None and len(shapes) <= MOST_SHAPES:
            self._closed = shapes if all(map(has_chord, shapes)) else []

    def first_hit(
        self, body: StatementList, given: Mapping[str, Expr], *, hybrid: bool
    ) -> FunctionRef:
        """Return the function ``(ray) -> Hit``.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name.
            hybrid: Whether the march for terrain and water is used.
        """
        params = [("ray", self._composer.assembly.struct(Ray))]
        if self._closed and not hybrid:
            return self._segment_of_solids(params, {**given, **FROM_ANYWHERE, "part": integer(-1)})
        if self._table is None:
            return self._first_of_others(body, params, given, hybrid=hybrid)
        if self._beside:
            others = self._first_of_others(body, params, given, hybrid=hybrid)
        else:
            others = self._bound(part_tree.nothing_else, params, given, {})
        functions = {"others": others, "others_field": self._beside_field()}
        return self._bound(part_tree.first_of_parts, params, given, functions)

    def next_hit(self, body: StatementList, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function ``(ray, side, slope, part) -> Hit`` for rays from a surface.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name; rays begin at 0.
        """
        ray = self._composer.assembly.struct(Ray)
        params = [("ray", ray), ("side", FLOAT), ("slope", FLOAT), ("part", INT)]
        if self._closed:
            return self._segment_of_solids(params, given)
        if self._table is None:
            return self._segment_of_others(body, params, given)
        if self._beside:
            others = self._segment_of_others(body, params, given)
        else:
            others = self._bound(part_segments.nothing_next, params, given, {})
        functions = {"others": others, "others_field": self._beside_field()}
        return self._bound(part_segments.segment_of_parts, params, given, functions)

    def _segment_of_others(
        self,
        body: StatementList,
        params: Params,
        given: Mapping[str, Expr],
        start: Mapping[str, Expr] = NO_VALUES,
    ) -> FunctionRef:
        """Return the function of a ray to its end, of all shapes but those of the table.

        Args:
            body: The statements of the function that calls it.
            params: Name and type of each parameter: the ray, and what is known of its start.
            given: The values of the march, by name.
            start: What is known of the start of all rays, by name: constants.
        """
        if self._table is None and not self._planes:
            functions = {"field": self._safe_field(self._root)}
            return self._bound(segment.segment, params, given, functions, start)
        values = {**given, **self._without_planes(body)}
        if not self._planes:
            functions = {"field": self._others_field()}
            return self._bound(segment.segment, params, values, functions, start)
        functions = {**self._fields(), "nearest_plane": self._nearest_plane()}
        return self._bound(trace.segment_or_plane, params, values, functions, start)

    def _first_of_others(
        self, body: StatementList, params: Params, given: Mapping[str, Expr], *, hybrid: bool
    ) -> FunctionRef:
        """Return the function ``(ray) -> Hit`` of all shapes but those of the table."""
        if hybrid:
            field = {"field": self._field(self._root)}
            return self._bound(heightfield_march.march_heightfield, params, given, field)
        if self._solids:
            return self._first_of_solids(params, given)
        return self._segment_of_others(body, params, given, FROM_ANYWHERE)

    def _first_of_solids(self, params: Params, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function ``(ray) -> Hit`` of solids that all have chords, and of planes."""
        values = {
            **given,
            "count": integer(len(self._solids) + len(self._planes)),
            "has_planes": boolean(bool(self._planes)),
        }
        functions = {
            "solids": self._along_solids(),
            "planes": self._planes_field() if self._planes else self._nothing(),
            "nearest_plane": self._nearest_plane(),
        }
        return self._bound(closed_hits.first_surface_of_solids, params, values, functions)

    def _segment_of_solids(self, params: Params, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function of a ray to its end, of shapes that all have chords.

        Args:
            params: Name and type of each parameter: the ray, and what is known of its start.
            given: The other values, by name.
        """
        numbered = [(node, integer(FIRST_SHAPE - i)) for i, node in enumerate(self._closed)]
        numbers = {n: given[n] for n in ("near", "farthest_plane")}
        start = {n: given[n] for n in ("side", "part") if n in given}
        counts = {"count": integer(len(self._closed))}

        def make(body: StatementList, asked: Mapping[str, Expr]) -> Expr:
            call = self._composer.call
            known = {**start, **numbers, **counts, **asked}
            ray = known["ray"]
            chords = [
                (body.let("chord", Call(self._chord(node).name, (ray,), VEC2)), of)
                for node, of in numbered
            ]
            nothing = (constant_number(UNBOUNDED), integer(-1))
            entry: Expr = Construct(nothing, self._composer.assembly.struct(closed_hits.Reached))
            for chord, of in chords:
                one = {**known, "reached": entry, "chord": chord, "of": of}
                entry = body.let("entry", call(closed_hits.entered, one))
            known |= {"entry": entry, "covers": self._covers(chords, known)}
            return call(closed_hits.segment_of_solids, known)

        names = [n for n, value in numbers.items() if not isinstance(value, Const)]
        every = [*params, *((n, numbers[n].type) for n in names)]
        return self._define("segment_of_solids", every, make, [numbers[n] for n in names])

    def _covers(
        self, chords: Sequence[tuple[Expr, Expr]], known: Mapping[str, Expr]
    ) -> FunctionRef:
        """Return the function ``(reached) -> Reached``: how far solids go on.

        Args:
            chords: The chord of each solid, and its number.
            known: The ray and the solid on which it starts, by name.
        """
        captured = {n: known[n] for n in ("ray", "part")}
        captured |= {f"chord_{i}": chord for i, (chord, _) in enumerate(chords)}

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            reached = given["reached"]
            for i, (_, of) in enumerate(chords):
                one = {**given, "reached": reached, "chord": given[f"chord_{i}"], "of": of}
                reached = body.let("further", self._composer.call(closed_hits.covered, one))
            return reached

        place = self._composer.assembly.struct(closed_hits.Reached)
        params = [("reached", place), *((n, value.type) for n, value in captured.items())]
        return self._define("covers", params, make, list(captured.values()))

    def _along_solids(self) -> FunctionRef:
        """Return the function ``(ray, t, below) -> Passed``: the solids along a ray from a place.

        Planes count only for rays from below one.
        """
        composer = self._composer
        ray, passed = (composer.assembly.struct(s) for s in (Ray, closed_hits.Passed))

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            found: Expr = Construct((constant_number(UNBOUNDED), given["t"]), passed)
            for node in (*self._solids, *self._planes):
                chord = Call(self._chord(node).name, (given["ray"],), VEC2)
                step = closed_hits.pass_plane if is_linear(node) else closed_hits.pass_chord
                asked = {**given, "passed": found, "chord": chord}
                found = body.let("passed", composer.call(step, asked))
            return found

        return self._define("along_solids", [("ray", ray), ("t", FLOAT), ("below", BOOL)], make, [])

    def shadow(
        self, body: StatementList, given: Mapping[str, Expr], *, casts: bool, hybrid: bool
    ) -> FunctionRef:
        """Return the function ``(origin, light, sample, samples) -> Opening``.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name.
            casts: Whether there are shadows.
            hybrid: Whether the march for terrain and water is used.
        """
        light = self._composer.assembly.struct(LightSample)
        params = [("origin", VEC3), ("light", light), ("sample", INT), ("samples", INT)]
        if not casts:
            return self._bound(shadows.no_shadow, params, {}, {})
        values = {**given, "steps": body.let("shadow_steps", shadow_step_limit(given["steps"]))}
        if self._table is not None:
            return self._shadow_of_parts(body, params, values)
        if hybrid or not self._planes:
            field = self._field(self._root) if hybrid else self._safe_field(self._root)
            return self._bound(shadows.soft_shadow, params, values, {"field": field})
        values |= self._without_planes(body)
        return self._bound(shadows.shadow_beside_planes, params, values, self._fields())

    def _chord(self, node: Node) -> FunctionRef:
        """Return the function ``(ray) -> vec2``: where a ray enters and leaves a solid."""
        composer = self._composer

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            line = (field_of(given["ray"], "origin"), field_of(given["ray"], "direction"))
            return chord_of(composer, body, node, line, ZERO_CELL, composer.values.all(node))

        return self._define("chord", [("ray", composer.assembly.struct(Ray))], make, [])

    def _shadow_of_parts(
        self, body: StatementList, params: Params, given: Mapping[str, Expr]
    ) -> FunctionRef:
        assert self._table is not None
        values = {**given, **self._beside_table(body)}
        functions = {"others": self._others_field()}
        if not self._planes:
            return self._bound(part_shading.shadow_of_parts, params, values, functions)
        functions["planes"] = self._planes_field()
        return self._bound(part_shading.shadow_of_parts_and_planes, params, values, functions)

    def occlusion(
        self,
        body: StatementList,
        given: Mapping[str, Expr],
        *,
        reach: float | None,
        hybrid: bool,
    ) -> FunctionRef:
        """Return the function ``(p, n, slope) -> float``.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name.
            reach: How far to search for surfaces; None if that may change.
            hybrid: Whether the march for terrain and water is used.
        """
        params: Params = [("p", VEC3), ("n", VEC3), ("slope", FLOAT)]
        if self._table_node is None:
            field = self._field(self._root) if hybrid else self._safe_field(self._root)
            return self._bound(shade.occlusion_in, params, given, {"field": field})
        values = {**given, "has_others": boolean(bool(self._beside))}
        functions = {"others": self._beside_field()}
        grid = distance_grid.grid_for(self._table_node, reach)
        if grid is None:
            return self._bound(part_shading.occlusion_of_parts, params, values, functions)
        values["place"] = body.let("place", self._place_of(grid))
        levels = {"levels": self._composer.assembly.resource(grid, "part_distances")}
        return self._bound(part_grid.occlusion_by_grid, params, values, functions, levels)

    def _place_of(self, grid: distance_grid.DistanceGrid) -> Expr:
        """Return where a grid is, as numbers: programs of other grids are the same."""
        fixed = self._composer.values.fixed
        points = tuple(map(float, grid.points))
        numbers = (
            fixed("grid_low", VEC3, grid.low),
            fixed("grid_cell", FLOAT, grid.cell),
            fixed("grid_points", VEC3, points),
        )
        return Construct(numbers, self._composer.assembly.struct(part_grid.GridPlace))

    def field_of(self, *, hybrid: bool) -> FunctionRef:
        """Return the function ``(p, part) -> float``: the field near a surface of a part.

        ``hybrid`` says whether the march for terrain and water is used.
        """

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            field = given["others"]
            assert isinstance(field, FunctionRef)
            of_others = Call(field.name, (given["p"], *field.captures), FLOAT)
            if self._table is None:
                return of_others
            distance = Call(self._table.value_of.name, (given["p"], given["part"]), FLOAT)
            is_part = compare(CompareOp.GE, given["part"], integer(0))
            body.statements.append(If(is_part, (Return(distance),), ()))
            return of_others

        if self._closed and not hybrid:
            return self._field_of_solid()
        others = self._beside_field()
        if self._table is None:
            others = self._field(self._root) if hybrid else self._safe_field(self._root)
        params: Params = [("p", VEC3), ("part", INT)]
        return capturing(self._define, "field_of_hit", params, {"others": others}, make)

    def _field_of_solid(self) -> FunctionRef:
        """Return the function ``(p, part) -> float`` of shapes that all have chords.

        Where two of them meet, the normal is that of the one whose chord ended the ray, which the
        next ray then leaves or enters.
        """
        fields = [self._field(node) for node in self._closed]

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            values = [Call(field.name, (given["p"], *field.captures), FLOAT) for field in fields]
            for i, value in enumerate(values[:-1]):
                is_one = compare(CompareOp.EQ, given["part"], integer(FIRST_SHAPE - i))
                body.statements.append(If(is_one, (Return(value),), ()))
            return values[-1]

        return self._define("field_of_solid", [("p", VEC3), ("part", INT)], make, [])

    def _beside_field(self) -> FunctionRef:
        """Return the distance to all shapes besides the table."""
        if not self._beside:
            return self._nothing()
        return self._safe_field(united(self._root, self._beside))

    def _beside_table(self, body: StatementList) -> dict[str, Expr]:
        """Return whether shapes are beside the table and the planes, and their box."""
        bounds = self._without_planes(body)["bounds"]
        return {"has_others": boolean(bool(self._others)), "others_bounds": bounds}

    def _others_field(self) -> FunctionRef:
        """Return the distance to the shapes besides the planes and the table."""
        if not self._others:
            return self._nothing()
        return self._safe_field(united(self._root, self._others))

    def _planes_field(self) -> FunctionRef:
        return self._field(united(self._root, self._planes))

    def _fields(self) -> dict[str, FunctionRef]:
        """Return the distance to the planes, and that to the other shapes."""
        return {"field": self._others_field(), "planes": self._planes_field()}

    def _field(self, node: Node) -> FunctionRef:
        return self._composer.field(node, self._composer.values.all(node), ZERO_CELL)

    def _safe_field(self, node: Node) -> FunctionRef:
        return self._composer.safe_field(node, self._composer.values.all(node), ZERO_CELL)

    def _nothing(self) -> FunctionRef:
        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return constant_number(UNBOUNDED)

        return self._define("nothing", [("p", VEC3)], make, [])

    def _without_planes(self, body: StatementList) -> dict[str, Expr]:
        """Return the box of the shapes besides the planes."""
        composer = self._composer
        if not self._others:
            return {"bounds": composer.call(settings.no_box, {})}
        node = united(self._root, self._others)
        found = composer.bounds.of(body, node, composer.values.all(node))
        grown = composer.call(settings.grown_bounds, {"bounds": found.bounds})
        return {"bounds": body.let("other_bounds", composer.sheets.grown(node, grown))}

    def _nearest_plane(self) -> FunctionRef:
        """Return the function ``(ray) -> float``: the distance to the first plane."""
        fields = [self._field(plane) for plane in self._planes]

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            nearest: Expr = constant_number(UNBOUNDED)
            for plane in fields:
                met = self._composer.call(trace.plane_crossing, {**given, "plane": plane})
                nearest = body.let("t", builtin("min", nearest, met))
            return nearest

        ray = self._composer.assembly.struct(Ray)
        return self._define("nearest_plane", [("ray", ray)], make, [])

    def _bound(
        self,
        function: Func,
        params: Params,
        values: Mapping[str, Expr],
        functions: Mapping[str, FunctionRef],
        start: Mapping[str, Expr] = NO_VALUES,
    ) -> FunctionRef:
        """Return a march as a function of these parameters alone; it captures values that vary.

        Args:
            function: The march.
            params: Name and type of each parameter.
            values: The other values that it takes, by name.
            functions: The functions that it takes, by name.
            start: Constants that it takes besides.
        """
        constants = {n: values[n] for n in _TAKEN if n in values and isinstance(values[n], Const)}
        captured = {n: values[n] for n in _TAKEN if n in values and n not in constants}
        constants |= start
        if self._table is not None:
            constants |= self._table.given

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return self._composer.call(function, {**constants, **given})

        return capturing(self._define, function.name, params, functions, make, captured)
