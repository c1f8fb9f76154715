"""Attributes of a place besides its distance: its material, and the part that it belongs to.

Input: nodes, and an attribute: the value at a leaf and the way to combine two values. Output: an
expression. Each attribute is computed once per hit, so subtrees do not share functions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, ClassVar

from distal.fields.combine.alternatives import SELECT
from distal.fields.deform.offsets import SECTION
from distal.fields.guarantees import Operator, Primitive
from distal.ir.build import add, builtin, cast, compare, field, index, multiply, number, select
from distal.ir.nodes import CompareOp, Expr, Gradient, Read
from distal.ir.types import FLOAT, VEC3, Kind, Type
from distal.lang.functions import Func
from distal.lang.resources import Buffer
from distal.render.footprint import (
    facing_of,
    flat_footprint,
    moved_footprint,
    point_footprint,
    step_along,
)
from distal.render.material import Surface, choose_surface, mix_surfaces
from distal.render.section import cut_surface
from distal.scene.lowering.part_functions import POINT
from distal.scene.lowering.parts.kinds import PartKind, materials_in, paths_to_leaves
from distal.scene.lowering.parts.table import RowsNode
from distal.scene.lowering.shapes import ShapeComposer, existing
from distal.scene.section import HATCH
from distal.scene.tree.calls import FACING, FOOTPRINT
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList
from distal.scene.tree.varying import ZERO_CELL, host_number


class Attribute(ABC):
    """An attribute of a place.

    Attributes:
        name: The name of functions that return it.
    """

    name: ClassVar[str]

    def __init__(self, composer: ShapeComposer) -> None:
        self.composer = composer

    @abstractmethod
    def leaf(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the attribute of the whole subtree, or None to descend into it.

        Args:
            body: The statements to add to.
            node: The root of the subtree.
            site: The place at which the attribute is evaluated.
        """

    @abstractmethod
    def blended(self, a: Expr, b: Expr, share: Expr) -> Expr:
        """Combine two attributes, with ``share`` (0 to 1) of ``b``."""

    @abstractmethod
    def chosen(self, a: Expr, b: Expr, is_second: Expr) -> Expr:
        """Return ``b`` if the condition holds, else ``a``."""

    @abstractmethod
    def cutter(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the attribute of faces cut by the subtree; None for that of the cut shape.

        Args:
            body: The statements to add to.
            node: The root of the subtree that cuts.
            site: The place at which the attribute is evaluated.
        """

    def sectioned(self, given: Mapping[str, Expr], of_solid: Expr) -> Expr:
        """Return the attribute where a section ends a solid.

        Args:
            given: The place ``p``, the solid's distance ``d`` there, and the plane, by name.
            of_solid: The solid's attribute.
        """
        return of_solid

    def averages(self, node: Node) -> bool:
        """Return whether the attribute of the subtree depends on the footprint of the pixel."""
        return False

    # Parts of a table. Most attributes depend on the numbers of the row alone.

    @property
    def result(self) -> Type:
        """The type of the attribute."""
        return FLOAT

    def in_row(self, kind: PartKind, ordinal: Expr, make: Callable[[], Expr]) -> Expr:
        """Return the attribute of one part of a kind.

        Args:
            kind: The kind.
            ordinal: The number of the part among those of the kind, as a float.
            make: Returns the attribute as the kind's tree gives it.
        """
        return make()


class AttributePoint:
    """The place at which an attribute is evaluated.

    Attributes:
        p: The point.
        cell: The index of the repetition.
        values: The numbers of the subtree.
        footprint: The footprint of the pixel; None for a point.
    """

    def __init__(
        self, p: Expr, cell: Expr, values: Sequence[Expr], footprint: Expr | None = None
    ) -> None:
        self.p = p
        self.cell = cell
        self.values = values
        self.footprint = footprint


def attribute(body: StatementList, kind: Attribute, node: Node, site: AttributePoint) -> Expr:
    """Return the attribute of the place of a subtree that is nearest to a point.

    Args:
        body: The statements to add to.
        kind: The attribute.
        node: The root of the subtree.
        site: The place at which the attribute is evaluated.
    """
    return _visit(body, kind, node, site, measured=False)[1]


def _visit(
    body: StatementList, kind: Attribute, node: Node, site: AttributePoint, *, measured: bool
) -> tuple[Expr | None, Expr]:
    """Return a subtree's attribute, and its distance if ``measured``."""
    with body.at(node.place):
        return _visit_here(body, kind, node, site, measured=measured)


def _visit_here(
    body: StatementList, kind: Attribute, node: Node, site: AttributePoint, *, measured: bool
) -> tuple[Expr | None, Expr]:
    composer = kind.composer
    whole = kind.leaf(body, node, site)
    if isinstance(node, RowsNode) and whole is None:
        d = composer.table(node).distance(site.p) if measured else None
        return d, _of_table(body, kind, node, site)
    if whole is not None:
        d = composer.distance(body, node, site.p, site.cell, site.values) if measured else None
        return d, whole
    rule = node.rule
    assert isinstance(rule, Operator)
    given, shares = composer.given(body, node, site.p, site.cell, site.values)
    if rule.around is not None:
        return _around(body, kind, node, site, given, measured=measured)
    if rule is SELECT:
        return _selected(body, kind, node, site, (given["second"], shares), measured=measured)
    p, cell = composer.moved(body, rule, given)
    moved = _footprint(body, kind, node, site, given, p, rule.point)
    sites = [AttributePoint(p, cell, share, moved) for share in shares]
    joins = rule.combine is not None and len(sites) > 1
    first = node.children[0]
    needed = measured or joins or rule is SECTION
    d, result = _visit(body, kind, first, sites[0], measured=needed)
    if joins:
        assert d is not None
        steps = composer.steps(body, node, given, shares)
        d, result = _joined(body, kind, node, sites, steps, (d, result))
    if rule is SECTION:
        assert d is not None
        result = body.let("shown", kind.sectioned({**given, "p": site.p, "d": d}, result))
    if measured and rule.finish is not None:
        assert d is not None
        d = body.let("d", composer.call(rule.finish, {**given, "d": d}))
    return d if d is None else existing(body, given, d), result


def _selected(
    body: StatementList,
    kind: Attribute,
    node: Node,
    site: AttributePoint,
    given: tuple[Expr, Sequence[Sequence[Expr]]],
    *,
    measured: bool,
) -> tuple[Expr | None, Expr]:
    """Return the attribute of one of two shapes; arguments as for ``_visit``.

    Args:
        body: The statements to add to.
        kind: The attribute.
        node: The node.
        site: The place at which the attribute is evaluated.
        given: Whether it is the second shape, and the numbers of each.
        measured: Whether the distance is needed.
    """
    second, shares = given
    found: list[Expr] = []
    for child, share in zip(node.children, shares, strict=True):
        there = AttributePoint(site.p, site.cell, share, site.footprint)
        found.append(_visit(body, kind, child, there, measured=False)[1])
    a, b = found
    result = a if a is b else body.let("shown", kind.chosen(a, b, second))
    composer = kind.composer
    d = composer.distance(body, node, site.p, site.cell, site.values) if measured else None
    return d, result


def _of_table(body: StatementList, kind: Attribute, node: RowsNode, site: AttributePoint) -> Expr:
    """Return the attribute of the part of a table that is nearest to a point."""
    part = kind.composer.table(node).nearest(body, site.p)
    return of_part(kind, node, site, part)


def of_part(kind: Attribute, node: RowsNode, site: AttributePoint, part: Expr) -> Expr:
    """Return the attribute of a part of a table.

    Args:
        kind: The attribute.
        node: The node of the table.
        site: The place at which the attribute is evaluated.
        part: The part.
    """
    composer = kind.composer
    functions = composer.table(node)
    given: dict[str, Expr] = {"p": site.p, "part": part}
    if site.footprint is not None:
        given["footprint"] = site.footprint
    if site.cell is not ZERO_CELL:
        given["cell"] = site.cell
    reads = {name: Read(name, value.type) for name, value in given.items()}

    def make(inner: StatementList, of: PartKind) -> Expr:
        values, cell = composer.values.all(of.node), reads.get("cell", ZERO_CELL)
        here = AttributePoint(POINT, cell, values, reads.get("footprint"))
        return kind.in_row(of, functions.ordinal, lambda: attribute(inner, kind, of.node, here))

    params = [(name, value.type) for name, value in given.items()]
    made = functions.of_part(kind.name, params, kind.result, make)
    return functions.attribute(kind.result, given, made)


def _around(
    body: StatementList,
    kind: Attribute,
    node: Node,
    site: AttributePoint,
    given: dict[str, Expr],
    *,
    measured: bool,
) -> tuple[Expr | None, Expr]:
    composer, rule, child = kind.composer, node.rule, node.children[0]
    assert isinstance(rule, Operator) and rule.around is not None
    _, (values,) = composer.values.split(node, site.values)
    given["field"] = composer.field_around(node, child, values, site.cell)
    p, cell = site.p, site.cell
    if rule.site is not None:
        p, cell = composer.site(body, composer.call(rule.site, given), site.cell)
    moved = _footprint(body, kind, node, site, given, p, rule.site)
    inner = AttributePoint(p, cell, values, moved)
    _, result = _visit(body, kind, child, inner, measured=False)
    if not measured:
        return None, result
    return existing(body, given, body.let("d", composer.call(rule.around, given))), result


def _footprint(
    body: StatementList,
    kind: Attribute,
    node: Node,
    site: AttributePoint,
    given: Mapping[str, Expr],
    q: Expr,
    point: Func | None,
) -> Expr | None:
    """Return the footprint in the coordinates of a node's children; None if nothing needs it.

    Args:
        body: The statements to add to.
        kind: The attribute.
        node: The node.
        site: The place at which the attribute is evaluated.
        given: The values for the node's functions, by name.
        q: The point in the coordinates of the children.
        point: The function that returns it; None if it is the same point.
    """
    if site.footprint is None or point is None or not kind.averages(node):
        return site.footprint
    composer = kind.composer
    found: dict[str, Expr] = {"footprint": site.footprint, "q": q}
    if q.type is not VEC3:
        return body.let("footprint", composer.call(flat_footprint, found))
    for name in ("across", "along"):
        side = field(site.footprint, name)
        for end, sign in (("ahead", 1.0), ("behind", -1.0)):
            step = {"p": site.p, "side": side, "sign": number(sign)}
            place = body.let("beside", composer.call(step_along, step))
            there, _ = composer.site(body, composer.call(point, {**given, "p": place}), site.cell)
            found[f"{name}_{end}"] = there
    return body.let("footprint", composer.call(moved_footprint, found))


def _joined(
    body: StatementList,
    kind: Attribute,
    node: Node,
    sites: Sequence[AttributePoint],
    steps: Sequence[Mapping[str, Expr]],
    first: tuple[Expr, Expr],
) -> tuple[Expr, Expr]:
    rule, composer = node.rule, kind.composer
    assert isinstance(rule, Operator) and rule.combine is not None
    a, result = first
    for child, site, given in zip(node.children[1:], sites[1:], steps, strict=True):
        if rule.cuts:
            b = composer.distance(body, child, site.p, site.cell, site.values)
            other = kind.cutter(body, child, site)
        else:
            found, other = _visit(body, kind, child, site, measured=True)
            assert found is not None
            b = found
        pair = {**given, "a": a, "b": b}
        if other is not None and other is not result:
            if rule.mix is None:
                is_second = body.let("is_nearer", compare(CompareOp.LT, b, a))
                shown = kind.chosen(result, other, is_second)
            else:
                share = body.let("share", composer.call(rule.mix, pair))
                shown = kind.blended(result, other, share)
            result = body.let("shown", shown)
        a = composer.joined(body, rule, pair)
    return a, result


def _more_shown(a: Expr, b: Expr, share: Expr) -> Expr:
    return select(compare(CompareOp.GT, share, number(0.5)), b, a)


def paints(node: Node) -> bool:
    """Return whether any node of a subtree has a material, or the look of a cut."""
    return any(
        n.material is not None or n.cut_material is not None or n.rule is SECTION
        for n in node.walk()
    )


class SurfaceAttribute(Attribute):
    """The appearance of a place: a ``Surface``."""

    name: ClassVar[str] = "part_surface"

    def __init__(self, composer: ShapeComposer, default: Any) -> None:
        super().__init__(composer)
        self._default = default
        self._painted: dict[int, bool] = {}
        self._averaged: dict[int, bool] = {}

    def leaf(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the material of a subtree; the default if nothing in it has one."""
        material = node.material
        if material is None and (isinstance(node.rule, Primitive) or not self._paints(node)):
            material = self._default
        return None if material is None else self._shown(body, material, node, site)

    @property
    def result(self) -> Type:
        """The type of the attribute."""
        return self.composer.assembly.struct(Surface)

    def blended(self, a: Expr, b: Expr, share: Expr) -> Expr:
        """Interpolate every number of both surfaces."""
        return self.composer.call(mix_surfaces, {"a": a, "b": b, "t": share})

    def chosen(self, a: Expr, b: Expr, is_second: Expr) -> Expr:
        """Choose one of two surfaces."""
        return self.composer.call(choose_surface, {"a": a, "b": b, "is_second": is_second})

    def sectioned(self, given: Mapping[str, Expr], of_solid: Expr) -> Expr:
        """Return the surface of a cut face, or that of the solid."""
        hatch = host_number(self.composer.assembly, HATCH)
        return self.composer.call(cut_surface, {**given, "surface": of_solid, "hatch": hatch})

    def cutter(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the cutter's ``cut_material``."""
        material = node.cut_material
        return None if material is None else self._shown(body, material, node, site)

    def averages(self, node: Node) -> bool:
        """Return whether a material of the subtree depends on the footprint of the pixel."""
        found = self._averaged.get(id(node))
        if found is None:
            nodes = list(node.walk())
            materials = [self._default, *(n.material for n in nodes)]
            materials += [n.cut_material for n in nodes]
            found = any(m is not None and FOOTPRINT in m.uses for m in materials)
            self._averaged[id(node)] = found
        return found

    def _paints(self, node: Node) -> bool:
        found = self._painted.get(id(node))
        if found is None:
            found = self._painted[id(node)] = paints(node)
        return found

    def _shown(self, body: StatementList, material: Any, node: Node, site: AttributePoint) -> Expr:
        given = {"p": site.p, "cell": site.cell}
        if FOOTPRINT in material.uses:
            given[FOOTPRINT] = site.footprint or self.composer.call(point_footprint, {})
        if FACING in material.uses:
            footprint = site.footprint or self.composer.call(point_footprint, {})
            given[FACING] = self.composer.call(facing_of, {"footprint": footprint})
        if "n" in material.uses:
            field = self.composer.field(node, site.values, site.cell)
            slope = Gradient(field, site.p, False, site.p.type)
            given["n"] = body.let("n", builtin("normalize", slope))
        surface: Expr = material.emit(self.composer, given)
        return body.let("shown", surface)


def _listed_for_each(
    listed: list[Any],
    make: Callable[[], Expr],
    of_kind: Sequence[Any],
    of_parts: Iterable[Sequence[Any]],
    ordinal: Expr,
    key: Callable[[Any], int] = id,
) -> Expr:
    """Return the place in a list, where what a kind's tree adds stands once for each part.

    Args:
        listed: The list.
        make: Adds what the kind's tree shows, and returns its place.
        of_kind: What the kind's tree consists of.
        of_parts: What the trees of the parts consist of, in the same order.
        ordinal: The number of the part among those of the kind, as a float.
        key: By what they are compared.
    """
    first = len(listed)
    found = make()
    shown = listed[first:]
    del listed[first:]
    places = {key(each): i for i, each in enumerate(of_kind)}
    for own in of_parts:
        # The default material is in no tree.
        listed += [own[places[key(e)]] if key(e) in places else e for e in shown]
    return add(found, multiply(ordinal, number(float(len(shown)))))


class ListedMaterial(SurfaceAttribute):
    """The material of a place, as its number in a list of all materials that are shown somewhere.

    Attributes:
        materials: The list. A material may be in it several times.
    """

    name: ClassVar[str] = "part_material"

    def __init__(self, composer: ShapeComposer, default: Any) -> None:
        super().__init__(composer, default)
        self.materials: list[Any] = []

    @property
    def result(self) -> Type:
        """The type of the attribute."""
        return FLOAT

    def sectioned(self, given: Mapping[str, Expr], of_solid: Expr) -> Expr:
        """Return the number of the solid's material."""
        return of_solid

    def blended(self, a: Expr, b: Expr, share: Expr) -> Expr:
        """Return the number with the larger share."""
        return _more_shown(a, b, share)

    def chosen(self, a: Expr, b: Expr, is_second: Expr) -> Expr:
        """Choose one of two numbers."""
        return select(is_second, b, a)

    def _shown(self, body: StatementList, material: Any, node: Node, site: AttributePoint) -> Expr:
        self.materials.append(material)
        return number(float(len(self.materials) - 1))

    def in_row(self, kind: PartKind, ordinal: Expr, make: Callable[[], Expr]) -> Expr:
        """Return the number of the part's own material."""
        own = (list(materials_in(member.part)) for member in kind.members)
        return _listed_for_each(self.materials, make, list(materials_in(kind.node)), own, ordinal)


class MaterialNumber(ListedMaterial):
    """The material of a place, as a number from 1 on, in the order of the author's tree."""

    def found(self, place: Expr) -> Expr:
        """Return the number of a material, given its place in the list."""
        known: dict[int, int] = {}
        numbers = [float(known.setdefault(id(m), len(known) + 1)) for m in self.materials]
        table = self.composer.assembly.resource(Buffer(numbers), "material_numbers")
        return index(table, cast(place, Kind.INT))


class Part(Attribute):
    """The leaf of the tree that a place belongs to, as a number.

    Attributes:
        paths: By number: the leaf, after the nodes of the lowered tree above it, outermost first.
    """

    name: ClassVar[str] = "part_leaf"

    def __init__(self, composer: ShapeComposer) -> None:
        super().__init__(composer)
        self.paths: list[tuple[Node, ...]] = []
        self._above: list[Node] = []

    def leaf(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the next number for a library shape."""
        # Nodes come parents first: what does not hold this one is done.
        while self._above and all(child is not node for child in self._above[-1].children):
            self._above.pop()
        self._above.append(node)
        if not isinstance(node.rule, Primitive):
            return None
        self.paths.append(tuple(self._above))
        return number(float(len(self.paths) - 1))

    def blended(self, a: Expr, b: Expr, share: Expr) -> Expr:
        """Return the number with the larger share."""
        return _more_shown(a, b, share)

    def chosen(self, a: Expr, b: Expr, is_second: Expr) -> Expr:
        """Choose one of two numbers."""
        return select(is_second, b, a)

    def cutter(self, body: StatementList, node: Node, site: AttributePoint) -> Expr | None:
        """Return the cutter's own part: it made the face."""
        return attribute(body, self, node, site)

    def in_row(self, kind: PartKind, ordinal: Expr, make: Callable[[], Expr]) -> Expr:
        """Return the number of the part's own leaf."""
        above, self._above = tuple(self._above), []
        own = (list(paths_to_leaves(member.source, above)) for member in kind.members)
        of_kind = list(paths_to_leaves(kind.node))
        found = _listed_for_each(self.paths, make, of_kind, own, ordinal, _leaf_of)
        self._above = list(above)
        return found


def _leaf_of(path: tuple[Node, ...]) -> int:
    return id(path[-1])
