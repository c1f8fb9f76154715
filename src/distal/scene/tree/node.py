"""The tree of nodes behind a shape: primitives and operators with their numbers.

Input: primitives and operators of the field library, checked numbers, other nodes. Output:
immutable nodes that ``scene.lowering`` turns into functions. A node records where the author wrote
it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Final, TypeAlias, TypeVar

from distal.diagnostics import Span
from distal.fields.guarantees import EXACT, Guarantee, Operator, Primitive
from distal.lang.functions import Func
from distal.scene.tree.conversion import NO_VALUES, Number

Rule: TypeAlias = Primitive | Operator
Derived = TypeVar("Derived")


class GrowingChildren:
    """The children of a union that may be joined with more: the beginning of a list.

    ``a | b``, ``a | b | c`` and so on share one list. Only the last of them may append to it: it
    holds the list in ``_last``, from which the first to append takes it.
    """

    __slots__ = ("_count", "_last", "_nodes", "nesting", "parts")

    def __init__(self, nodes: list[Node], parts: int, nesting: int) -> None:
        self._nodes = nodes
        self._count = len(nodes)
        self._last = [nodes]
        self.parts = parts
        self.nesting = nesting

    def children(self) -> tuple[Node, ...]:
        """Return the children."""
        return tuple(self._nodes[: self._count])

    def followed_by(self, nodes: Sequence[Node]) -> GrowingChildren:
        """Return these children with others after them."""
        try:
            own = self._last.pop()  # atomic: of two threads, one makes a copy
        except IndexError:
            own = self._nodes[: self._count]
        own.extend(nodes)
        parts = self.parts + sum([node.parts for node in nodes])
        nesting = max(self.nesting, *[node.nesting + 1 for node in nodes])
        return GrowingChildren(own, parts, nesting)


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True, init=False)
class Node:
    """A node of the tree: one shape.

    Attributes:
        rule: The primitive or operator.
        flat: Whether the shape lies in the plane.
        children: The shapes that an operator is applied to.
        numbers: Values of the floats and vectors, by name.
        constants: Choices (counts, switches), textures and buffers, by name.
        place: The author's line.
        material: The material of this node and everything below it, or None.
        cut_material: The material of faces that this node cuts into other shapes, or None.
        label: The author's name for the shape, or "".
        parts: Number of primitives evaluated for one distance; a primitive evaluated twice counts
            twice.
        nesting: The largest number of operators from here down to a primitive.
    """

    rule: Rule
    flat: bool
    children: tuple[Node, ...] = ()
    numbers: Mapping[str, Number] = field(default_factory=dict)
    constants: Mapping[str, Any] = field(default_factory=dict)
    place: Span | None = None
    material: Any = None
    cut_material: Any = None
    label: str = ""
    parts: int = field(init=False, default=1)
    nesting: int = field(init=False, default=0)
    _growing: GrowingChildren | None = field(init=False, repr=False, default=None)
    _derived: dict[str, Any] | None = field(init=False, repr=False, default=None)

    def __init__(
        self,
        rule: Rule,
        flat: bool,
        children: tuple[Node, ...] | GrowingChildren = (),
        numbers: Mapping[str, Number] = NO_VALUES,
        constants: Mapping[str, Any] = NO_VALUES,
        place: Span | None = None,
        material: Any = None,
        cut_material: Any = None,
        label: str = "",
    ) -> None:
        """Keep the parts of the node; ``children`` are the tuple or the list that it grows from.

        Args:
            rule: The primitive or operator.
            flat: Whether the shape lies in the plane.
            children: The shapes that an operator is applied to.
            numbers: Values of the floats and vectors, by name.
            constants: Choices, textures and buffers, by name.
            place: The author's line.
            material: The material of this node and everything below it, or None.
            cut_material: The material of faces that this node cuts into others, or None.
            label: The author's name for the shape, or "".
        """
        # A scene has 100,000 nodes: the descriptors of the slots take a quarter of the time of
        # object.__setattr__.
        _set_rule(self, rule)
        _set_flat(self, flat)
        _set_numbers(self, numbers)
        _set_constants(self, constants)
        _set_place(self, place)
        _set_material(self, material)
        _set_cut_material(self, cut_material)
        _set_label(self, label)
        _set_derived(self, None)
        if type(children) is tuple:
            _set_children(self, children)
            _set_growing(self, None)
            self.__post_init__()
        else:
            assert isinstance(children, GrowingChildren)
            _set_growing(self, children)
            _set_parts(self, children.parts)
            _set_nesting(self, children.nesting)

    def __post_init__(self) -> None:
        # Subclasses have the __init__ of a dataclass, which calls this method.
        children = self.children
        if len(children) == 1:
            _set_parts(self, children[0].parts)
            _set_nesting(self, children[0].nesting + 1)
        elif children:
            _set_parts(self, sum([child.parts for child in children]))
            _set_nesting(self, max([child.nesting for child in children]) + 1)
        else:
            _set_parts(self, 1)
            _set_nesting(self, 0)

    def __getattr__(self, name: str) -> Any:
        # The slot of the children is empty until they are read, if the union still grows.
        if name != "children" or self._growing is None:
            raise AttributeError(f"a node has no attribute '{name}'", name=name, obj=self)
        found = self._growing.children()
        _set_children(self, found)
        return found

    def followed_by(self, nodes: Sequence[Node]) -> GrowingChildren:
        """Return this node's children with others after them.

        The first call takes time in proportion to ``nodes`` alone, so that ``a = a | b`` in a loop
        takes linear time.
        """
        own = self._growing
        if own is None:
            own = GrowingChildren(list(self.children), self.parts, self.nesting)
        return own.followed_by(nodes)

    def with_material(self, material: Any) -> Node:
        """Return the node with another material."""
        return Node(
            self.rule,
            self.flat,
            self.children,
            self.numbers,
            self.constants,
            self.place,
            material,
            self.cut_material,
            self.label,
        )

    @property
    def has_rows(self) -> bool:
        """Whether the numbers of its children are rows of a table (``scene.lowering.parts``)."""
        return False

    @property
    def name(self) -> str:
        """The author's name for the shape, else that of the primitive or operator."""
        return self.label or self.rule.name

    @property
    def claims(self) -> frozenset[Guarantee]:
        """The guarantees besides the bound on the slope."""
        rule = self.rule
        if isinstance(rule, Primitive):
            return rule.claims
        inner = [child.claims for child in self.children]
        kept = rule.keeps.intersection(*inner)
        return kept | rule.keeps_exact if all(c >= EXACT for c in inner) else kept

    @property
    def signed(self) -> bool:
        """Whether the shape has an inside."""
        stack: list[Node] = [self]
        while stack:
            rule = (node := stack.pop()).rule
            if isinstance(rule, Primitive):
                signed = rule.signed
                if callable(signed):
                    signed = node.derived("signed", partial(signed, node))
                if not signed:
                    return False
            elif not (rule.fills or node.has_rows):
                stack.extend(node.children[:1] if rule.cuts else node.children)
        return True

    @property
    def estimate(self) -> bool:
        """Whether the slope is an estimate (fractals)."""
        if isinstance(self.rule, Primitive):
            return self.rule.estimate
        return any(child.estimate for child in self.children)

    @property
    def solid(self) -> bool:
        """Whether values change their sign at the surface, and nowhere else.

        Not those of a shape without an inside, nor estimates of a distance.
        """
        return self.signed and not self.estimate

    def derived(self, name: str, make: Callable[[], Derived]) -> Derived:
        """Return what was made of this tree before, under a name; else make it.

        It lives as long as the node, which it may refer to: trees do not change.

        Args:
            name: What it is.
            make: Makes it.
        """
        if self._derived is None:
            _set_derived(self, {})
        known = self._derived
        assert known is not None
        if name not in known:
            known[name] = make()
        found: Derived = known[name]
        return found

    def known(self, name: str) -> Any:
        """Return what ``derived`` made under a name; None if it has not."""
        return None if self._derived is None else self._derived.get(name)

    def walk(self) -> Iterator[Node]:
        """Yield this node and all below it, each once, parents first."""
        seen: set[int] = set()
        stack = [self]
        while stack:
            node = stack.pop()
            if id(node) not in seen:
                seen.add(id(node))
                yield node
                stack.extend(reversed(node.children))

    def functions(self) -> Iterator[Func]:
        """Yield the scene functions that this node and all below it call."""
        for node in self.walk():
            rule = node.rule
            if isinstance(rule, Primitive):
                yield rule.distance
            else:
                yield from rule.point_functions


# The descriptors of the slots write what ``frozen`` keeps from changing.
_SLOTS: Final[Mapping[str, Any]] = vars(Node)
_set_rule: Final = _SLOTS["rule"].__set__
_set_flat: Final = _SLOTS["flat"].__set__
_set_children: Final = _SLOTS["children"].__set__
_set_numbers: Final = _SLOTS["numbers"].__set__
_set_constants: Final = _SLOTS["constants"].__set__
_set_place: Final = _SLOTS["place"].__set__
_set_material: Final = _SLOTS["material"].__set__
_set_cut_material: Final = _SLOTS["cut_material"].__set__
_set_label: Final = _SLOTS["label"].__set__
_set_parts: Final = _SLOTS["parts"].__set__
_set_nesting: Final = _SLOTS["nesting"].__set__
_set_growing: Final = _SLOTS["_growing"].__set__
_set_derived: Final = _SLOTS["_derived"].__set__
