"""Shapes as values: their arguments, their parts, and shapes with others.

Input: nodes. Output: arguments by declared name; the shapes below a shape; a shape with other
arguments. Nothing here knows a single shape or operator.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final, Self, cast

from distal.diagnostics import Span
from distal.fields.guarantees import Operator, Primitive
from distal.fields.library import OPERATORS
from distal.fields.repeat.varied import IN_CELLS
from distal.lang.functions import Func
from distal.lang.lazy_module import LazyModule
from distal.lang.source_places import author_place
from distal.scene.tree.arguments import RESERVED, RESERVED_OF_SHAPES, slots_of
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.node import Node, Rule
from distal.scene.tree.value import AuthorObject, CallRecord, state_of, value_of
from distal.scene.tree.varying import holds

if TYPE_CHECKING:
    from distal.scene.objects import shape_rows, shape_texts
    from distal.scene.objects.field import BaseShape
    from distal.scene.objects.materials import Material
    from distal.scene.tree import digests
    from distal.scene.tree.texts import TextWriter
else:
    shape_rows = LazyModule("distal.scene.objects.shape_rows")
    shape_texts = LazyModule("distal.scene.objects.shape_texts")
    digests = LazyModule("distal.scene.tree.digests")  # needs hashlib and json

# The key in a node's derived values of the call that it was made by.
ORIGIN: Final = "origin"
# The class of each primitive of the library, by the identity of its rule; ``shapes`` fills it.
CLASSES_OF_RULES: Final[dict[int, type[BaseShape]]] = {}
# The class of an operator's result, by ``flat``; the module ``shape`` fills it.
PLAIN: Final[dict[bool, type[BaseShape]]] = {}


class ShapeValue(AuthorObject):
    """The part of a shape that shows what it was made from."""

    flat: ClassVar[bool]
    node: Node

    @property
    def arguments(self) -> Mapping[str, Any]:
        """The arguments of the shape, or of the operator that made it, by name.

        A number that is a slider or an expression comes back as that.
        """
        origin = self._origin
        return _arguments_of(authored(self.node)) if origin is None else origin.arguments

    @property
    def operator(self) -> str | None:
        """The name of the operator that made the shape, as ``apply`` takes it.

        None if no operator of the author did, and the shape has no children.
        """
        rule = self._operator
        return None if rule is None else rule.name

    @property
    def children(self) -> tuple[BaseShape, ...]:
        """The shapes that the operator was applied to."""
        if self._operator is None:
            return ()
        return tuple([shape_of(child) for child in authored(self.node).children])

    @property
    def material(self) -> Material | None:
        """The material that ``paint`` has set; None if there is none."""
        found: Material | None = self.node.material
        return found

    def _parts(self) -> Mapping[str, Any]:
        of_node = {"material": self.material, "cut_material": self.node.cut_material}
        parts = {name: material for name, material in of_node.items() if material is not None}
        return {**self.arguments, "children": self.children, **parts}

    @property
    def _origin(self) -> CallRecord | None:
        """The call that made the shape; None for shapes of the library, and operators' results."""
        return _origin_of(authored(self.node))

    @property
    def _class(self) -> type[BaseShape] | None:
        """The class of a shape of the library; None for others."""
        return CLASSES_OF_RULES.get(id(authored(self.node).rule))

    @property
    def _made_with(self) -> tuple[str, Any, Any]:
        """The name, the material and the cut material that the call that made it has given it."""
        origin = self._origin
        return ("", None, None) if origin is None else origin.made_with

    @property
    def _operator(self) -> Operator | None:
        node = authored(self.node)
        made = isinstance(node.rule, Primitive) or _origin_of(node) is not None
        return None if made else cast("Operator", node.rule)

    def _replaced(self, changes: dict[str, Any]) -> Self:
        """Return the shape with other arguments; materials and names are kept.

        Besides its arguments ``children`` may change, the shapes that the operator is applied to,
        ``material``, ``cut_material`` and ``name``.
        """
        place = author_place()
        node: Any = self.node
        material = changes.pop("material", node.material)
        label = changes.pop("name", node.label)
        cut_material = changes.pop("cut_material", node.cut_material)
        made: Any = self._made_again(changes, place) if changes else self
        if material is None and made.node.material is not None:
            made = made._again(made.node.with_material(None))
        elif material is not made.node.material:
            made = made.paint(material)
        if cut_material is not made.node.cut_material:
            made = made.cut_material(cut_material)
        if label != made.node.label:
            made = made.named(label)
        again: Self = made
        return again

    def _made_again(self, changes: dict[str, Any], place: Span | None) -> Any:
        """Return the shape of other arguments, without its material and its name."""
        rule = self._operator
        children = self.children
        if "children" in changes:
            children = _checked_children(changes.pop("children"), children, self, place)
        node = authored(self.node)
        origin = _origin_of(node)
        if origin is not None:
            return origin.factory(**{**self.arguments, **changes})
        given = {**self.arguments, **_of_vector(self.arguments, changes)}
        if rule is None:
            kind = CLASSES_OF_RULES[id(node.rule)]
            return cast("Any", kind)(**given)
        first, *others = children
        return first._under(OPERATORS.get(rule.name, rule), (), given, place, others)

    def _again(self, node: Node) -> Self:
        """Return the same shape with another material or name: what it was made from is kept."""
        origin = _origin_of(authored(self.node))
        if origin is not None and _origin_of(authored(node)) is None:
            node.derived(ORIGIN, lambda: origin)
        return type(self)._of_node(node, state_of(self))

    @classmethod
    def _of_node(cls, node: Node, state: Mapping[str, Any]) -> Self:
        """Return a shape of this class without calling its constructor.

        Args:
            node: Its node.
            state: Its other attributes.
        """
        made = cls.__new__(cls)
        made.__dict__.update(state)
        made._set_node(node)
        return made

    @classmethod
    def _of_tree(cls, node: Node, state: Mapping[str, Any]) -> Self:
        """Return a shape of a tree that was checked and made shallow before."""
        made = cls.__new__(cls)
        made.__dict__.update(state, node=node)
        return made

    def _set_node(self, node: Node) -> None:
        raise NotImplementedError

    def _digest(self) -> bytes:
        return digests.digest_of_node(self.node)

    def _pickled(self) -> Any:
        return shape_rows.unpacked, (shape_rows.packed(self),)

    def _record(self, origin: CallRecord) -> None:
        node = authored(self.node)
        origin.made_with = (node.label, node.material, node.cut_material)
        node.derived(ORIGIN, lambda: origin)

    def _written(self, writer: TextWriter) -> str:
        return shape_texts.text_of_shape(self, writer)


def authored(node: Node) -> Node:
    """Return the author's node below those that only hold bounds."""
    while node.rule is IN_CELLS or holds(node.rule):
        node = node.children[0]
    return node


def shape_of(node: Node) -> BaseShape:
    """Return the shape of a node as its author made it: a ``Sphere``, a ``Bolt``, a ``Shape``."""
    while node.rule is IN_CELLS:
        node = node.children[0]
    own = authored(node)
    origin = _origin_of(own)
    if origin is not None:
        made: BaseShape = origin.kind._of_node(node, origin.state)
        return made
    return CLASSES_OF_RULES.get(id(own.rule), PLAIN[node.flat])._of_node(node, {})


def _of_vector(arguments: Mapping[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return changes in which x, y and z have become those of the only vector, as in calls."""
    vectors = [name for name, value in arguments.items() if isinstance(value, tuple)]
    if len(vectors) != 1 or vectors[0] in changes:
        return changes
    components = dict(zip("xyzw", arguments[vectors[0]], strict=False))
    letters = components.keys() & changes.keys() - arguments.keys()
    if not letters:
        return changes
    components |= {letter: changes[letter] for letter in letters}
    rest = {name: value for name, value in changes.items() if name not in letters}
    return {**rest, vectors[0]: tuple(components.values())}


@lru_cache(maxsize=1024)
def names_of(rule: Rule) -> tuple[str, ...]:
    """Return the names of a rule's arguments, in the declared order."""
    rule = OPERATORS.get(rule.name, rule) if isinstance(rule, Operator) else rule
    functions: tuple[Func, ...]
    if isinstance(rule, Primitive):
        functions, hidden = (rule.distance,), {*RESERVED_OF_SHAPES, *rule.measured}
    else:
        functions, hidden = rule.number_functions, {*RESERVED, *rule.fixed}
    slots = (slot for function in functions for slot in slots_of(function))
    return tuple(dict.fromkeys(slot.name for slot in slots if slot.name not in hidden))


def _arguments_of(node: Node) -> Mapping[str, Any]:
    known = {**node.numbers, **node.constants}
    names = [name for name in names_of(node.rule) if name in known]
    endless = getattr(node.rule, "endless", ())
    return MappingProxyType(
        {name: value_of(known[name], is_endless=name in endless) for name in names}
    )


def _checked_children(
    given: Any, before: tuple[BaseShape, ...], shape: Any, place: Span | None
) -> tuple[Any, ...]:
    if not before:
        refuse(f"{shape.name} was made by no operator: it has no children", None, place)
    listed = tuple(given) if isinstance(given, Iterable) else (given,)
    for child in listed:
        if not isinstance(child, ShapeValue):
            refuse_kind(f"children are shapes, not {child!r:.60}", None, place)
        if child.flat is not before[0].flat:
            kind = "flat shapes" if before[0].flat else "solids"
            refuse(f"the children of '{shape.operator}' are {kind}", None, place)
    many = len(before) > 1
    if not listed or (len(listed) > 1) is not many:
        count = "two or more children" if many else "one child"
        refuse(f"'{shape.operator}' takes {count}, not {len(listed)}", None, place)
    return listed


def _origin_of(node: Node) -> CallRecord | None:
    found: CallRecord | None = node.known(ORIGIN)
    return found
