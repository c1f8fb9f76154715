"""Random trees of shapes: any operator on shapes whose promises are known to hold.

Input: operators' rows. Output: shapes of the object model, and subjects of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Final

import numpy as np

from distal.devices import cpu, reference
from distal.fields.guarantees import OPERATORS, PRIMITIVES, UNBOUNDED, Operator
from distal.frontend import Assembly, lower
from distal.ir.nodes import Gradient, Param, Read, Return
from distal.ir.printer import print_identity
from distal.ir.types import FLOAT, VEC2, VEC3, FunctionType, tuple_type
from distal.lang import Func
from distal.lang.composed import Composed
from distal.scene.lowering.derived import BoundsOf
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.objects import shapes  # the classes come from the rows that importing it declares
from distal.scene.objects.binding import bound
from distal.scene.objects.field import BaseShape
from distal.scene.tree.arguments import RESERVED
from distal.scene.tree.arguments import slots_of as scene_slots_of
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList
from tests.fields.drawing import drawn, fits, random_sample
from tests.fields.rows import Doubles, Slot, endless
from tests.fields.subject import Subject

assert shapes.CLASSES

# Exact, cheap, and of different kinds: round, edged, hollow, long. One is a bound only.
SOLIDS: Final = (
    "Sphere",
    "Box",
    "Torus",
    "Capsule",
    "Cylinder",
    "RoundBox",
    "BoxFrame",
    "BoxCheap",
)
FLATS: Final = ("Circle", "Rectangle", "Hexagon", "Pie", "UnevenCapsule", "Pentagram")
# Far below the distance somewhere.
BOUNDS: Final = (
    "OctahedronCheap",
    "ConeCheap",
    "Ellipsoid",
    "Superellipsoid",
    "SmoothOctahedron",
    "Dodecahedron",
    "Spring",
    "Blob",
)
# What may stand between the operator that is looked at and the primitives.
BETWEEN: Final = {
    False: ("translate", "rotate", "scale", "union", "difference", "intersection", "round"),
    True: ("flat translate", "flat rotate", "flat scale", "union", "difference", "round"),
}


def random_tree(
    operator: Operator, rng: np.random.Generator, depth: int = 1, *, small: bool = False
) -> Node | None:
    """The operator on random shapes, or None where no numbers were found.

    ``small``: on small shapes off the centre, for operators that set shapes beside each other.
    """
    flat, flat_children = flatness(operator, rng)
    return _tree_of(operator, flat, flat_children, rng, depth, small)


def _tree_of(
    operator: Operator,
    flat: bool,
    flat_children: bool,
    rng: np.random.Generator,
    depth: int,
    small: bool,
) -> Node | None:
    count = 2 if operator.combine is not None else 1
    children = [_random_shape(flat_children, rng, depth, small) for _ in range(count)]
    return random_node(operator, flat, tuple(children), rng)


def _random_shape(flat: bool, rng: np.random.Generator, depth: int, small: bool) -> Node:
    if depth > 0 and rng.random() < 0.4:
        name = str(rng.choice([n for n in BETWEEN[flat] if n in OPERATORS]))
        made = _tree_of(OPERATORS[name], flat, flat, rng, depth - 1, small)
        if made is not None:
            return made
    row = PRIMITIVES[str(rng.choice(FLATS if flat else SOLIDS))]
    sample = random_sample(row, rng)
    assert sample is not None
    numbers, constants = bound(row, (), {**sample.numbers, **sample.choices}, None)
    node = Node(row, flat, (), numbers, constants)
    if small:
        node = _placed("scale", node, factor=float(rng.uniform(0.05, 0.3)))
    # Off the centre, so that two shapes meet at an angle.
    reach = 1.2 if small else 0.35
    offset = tuple(rng.uniform(-reach, reach, 2 if flat else 3).tolist())
    return _placed("translate", node, offset=offset)


def nested_tree(rng: np.random.Generator, *, flat: bool, depth: int) -> Node:
    """Operators upon operators, on shapes that cost little."""
    if depth == 0:
        return _any_shape(flat, rng)
    names = list(OPERATORS)
    while True:
        rule = OPERATORS[str(rng.choice(names))]
        own, below = flatness(rule, rng)
        if own is not flat:
            continue
        count = 2 if rule.combine is not None else 1
        inner = [nested_tree(rng, flat=below, depth=int(rng.integers(depth))) for _ in range(count)]
        made = random_node(rule, flat, tuple(inner), rng)
        if made is not None:
            return made


def _any_shape(flat: bool, rng: np.random.Generator) -> Node:
    row = PRIMITIVES[str(rng.choice(FLATS if flat else (*SOLIDS, *BOUNDS)))]
    sample = random_sample(row, rng)
    assert sample is not None
    numbers, constants = bound(row, (), {**sample.numbers, **sample.choices}, None)
    node = Node(row, flat, (), numbers, constants)
    offset = tuple(rng.uniform(-0.8, 0.8, 2 if flat else 3).tolist())
    return _placed("translate", node, offset=offset) if rng.random() < 0.5 else node


def _placed(name: str, node: Node, **values: Any) -> Node:
    rule = OPERATORS[f"flat {name}" if node.flat else name]
    numbers, constants = bound(rule, (), values, None)
    return Node(rule, node.flat, (node,), numbers, constants)


def random_node(
    operator: Operator,
    flat: bool,
    children: tuple[Node, ...],
    rng: np.random.Generator,
    **given: Any,
) -> Node | None:
    """The operator on these shapes; its numbers are random, but for those given."""
    slots = operator_slots(operator)
    for _ in range(500):
        values = {**drawn(slots, operator.limits, rng), **given}
        if fits(operator, values):
            numbers, constants = bound(operator, (), values, None)
            return Node(operator, flat, children, numbers, constants)
    return None


def operator_slots(operator: Operator) -> tuple[Slot, ...]:
    """An operator's numbers and choices."""
    found: dict[str, Slot] = {}
    reserved = RESERVED | {*operator.fixed}
    for func in operator.number_functions:
        for slot in scene_slots_of(func):
            if slot.name not in reserved and slot.type is not None:
                found.setdefault(slot.name, Slot(slot.name, slot.type, slot.default))
    return tuple(found.values())


def flatness(operator: Operator, rng: np.random.Generator) -> tuple[bool, bool]:
    """Whether the operator's shape is flat, and whether its children are."""
    own = _flat_by(operator.number_functions, "p")
    below = own
    if operator.point is not None:
        result = str(operator.point.python_function.__annotations__["return"])
        below = {"vec2": True, "Site2": True, "vec3": False, "Site": False}[result]
    if operator.around is not None:
        field = str(operator.around.python_function.__annotations__["field"])
        below = "Field2" in field or "[vec2" in field
    if own is None:
        own = _flat_by_box(operator, rng)
    return own, own if below is None else below


def _flat_by(functions: Iterable[Func], name: str) -> bool | None:
    for func in functions:
        annotation = func.python_function.__annotations__.get(name)
        if annotation is not None:
            return str(annotation) == "vec2"
    return None


def _flat_by_box(operator: Operator, rng: np.random.Generator) -> bool:
    """What works in the plane and in space is tried in both, unless its box knows one only."""
    rules = [r for r in (operator.bounds, operator.slope) if isinstance(r, Func)]
    for rule in rules:
        named = {str(o.python.__annotations__.get(n)) for o in rule.overloads for n in
                 ("bounds", "bounds_a")}  # fmt: skip
        if "Bounds" in named and "Bounds2" not in named:
            return False
        if "Bounds2" in named and "Bounds" not in named:
            return True
    return bool(rng.random() < 0.4)


class FieldOf(Composed):
    """Distance and gradient of a shape, from one evaluation."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = node.name
        self._point = VEC2 if node.flat else VEC3
        self.signature = (("p", self._point),)
        self.result = tuple_type((FLOAT, self._point))

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        composer = ShapeComposer(assembly, [self._node])
        field = composer.field(self._node, composer.values.all(self._node), ZERO_CELL)
        assert isinstance(field.type, FunctionType)
        value = Gradient(field, Read("p", self._point), True, self.result)
        params = (Param("p", self._point),)
        return assembly.define("with_gradient", params, self.result, (Return(value),))


class SiteOf(Composed):
    """The child's distance at the place that an operator's ``site``, or ``point``, tells."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self.name = f"site of {node.name}"
        self._point = VEC2 if node.flat else VEC3
        self.signature = (("p", self._point),)
        self.result = FLOAT

    def compose(self, assembly: Assembly) -> str:
        """The function in a program."""
        node, body = self._node, StatementList(taken={"p"})
        assert isinstance(node.rule, Operator)
        composer = ShapeComposer(assembly, [node])
        p = Read("p", self._point)
        given, (values,) = composer.given(body, node, p, ZERO_CELL, composer.values.all(node))
        if node.rule.site is not None:
            given["field"] = composer.field_around(node, node.children[0], values, ZERO_CELL)
            place = composer.call(node.rule.site, given)
            inner, cell = composer.site(body, place, ZERO_CELL)
        else:
            inner, cell = composer.moved(body, node.rule, given)
        d = composer.distance(body, node.children[0], inner, cell, values)
        body.statements.append(Return(d))
        return assembly.define("at_site", (Param("p", self._point),), FLOAT, body.statements)


_KERNELS: dict[tuple[str, str], Any] = {}


class Prepared:
    """A composed function on a device; kernels serve all that differ in their numbers only."""

    def __init__(self, made: Composed, device: str) -> None:
        module = lower(made)
        key = (print_identity(module), device)
        if key not in _KERNELS:
            room = cpu if device == "cpu" else reference
            _KERNELS[key] = room.prepare(module, precision=64)
        self._kernel = _KERNELS[key]
        self._uniforms = {u.name: u.default for u in module.uniforms}
        self._resources = {r.name: r.source for r in module.resources}

    def __call__(self, *rows: Doubles) -> Any:
        """What it gives for rows of arguments. One thread: tests run side by side already."""
        args = [np.ascontiguousarray(r, np.float64) for r in rows]
        return self._kernel.evaluate(args, self._uniforms, self._resources, threads=1)


class Tree:
    """A random shape, lowered once and asked often."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.shape: BaseShape = BaseShape._of(node)
        self._devices: dict[str, Prepared] = {}

    def evaluate(self, points: Doubles, device: str = "cpu") -> tuple[Doubles, Doubles]:
        """Distances and gradients at points."""
        if device not in self._devices:
            self._devices[device] = Prepared(FieldOf(self.node), device)
        d, g = self._devices[device](points)
        return np.broadcast_to(d, len(points)), np.broadcast_to(g, points.shape)

    def at_site(self, points: Doubles) -> Doubles | None:
        """The child's distance in the cell of a repetition; None where nothing is repeated."""
        rule = self.node.rule
        if not isinstance(rule, Operator) or not (rule.site or _gives_site(rule.point)):
            return None
        found = Prepared(SiteOf(self.node), "reference")(points)
        return np.broadcast_to(found, len(points))

    def subject(self, device: str = "cpu") -> Subject:
        """The shape with its promises; for few points the reference is ready sooner."""
        promise = Prepared(BoundsOf(self.node), "reference")()
        slope, divisor, low, high, growth, side_growth = promise
        return Subject(
            described(self.node),
            lambda points: self.evaluate(points, device),
            2 if self.node.flat else 3,
            self.node.claims,
            float(slope[0]),
            float(divisor[0]),
            endless(low[0]),
            endless(high[0]),
            self.node.signed,
            hollow=True,
            empty=True,
            estimate=self.node.estimate,
            growth=float(growth[0]),
            side_growth=float(side_growth[0]),
        )


def accepted_tree(operator: Operator, rng: np.random.Generator, tries: int = 24) -> Tree | None:
    """A random tree that is not refused: operators may say that they need other shapes.

    It is not empty either, unless it always is.
    """
    found, refused = None, 0
    for _ in range(tries):
        node = random_tree(operator, rng, small=refused >= 2)
        if node is None:
            continue
        tree = Tree(node)
        subject = tree.subject()
        if subject.slope >= UNBOUNDED / 1000.0:
            refused += 1
            continue
        found = tree
        points = rng.uniform(*subject.region, (1000, subject.dimension))
        if not subject.signed or (tree.evaluate(points, "reference")[0] < 0.0).any():
            return tree
    return found


def _gives_site(point: Func | None) -> bool:
    return point is not None and "Site" in str(point.python_function.__annotations__["return"])


def described(node: Node) -> str:
    """A tree as a line of text, to build it again by hand."""
    values = {n: number.value for n, number in node.numbers.items()}
    values |= {n: getattr(c, "value", c) for n, c in node.constants.items()}
    inner = [described(child) for child in node.children]
    inner += [f"{n}={_short(v)}" for n, v in values.items()]
    return f"{node.rule.name.replace(' ', '_')}({', '.join(inner)})"


def _short(value: Any) -> str:
    if isinstance(value, tuple):
        return f"({', '.join(map(_short, value))})"
    return f"{value:.6g}" if isinstance(value, float) else str(value)
