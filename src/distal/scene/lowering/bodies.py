"""The bodies of a scene: solids that merge where they overlap, because they have one priority.

Input: the tree of a scene, and for each body the functions that follow rays through it. Output: the
bodies' trees; functions of the whole scene for rays that know in which bodies they run
(``render.media``). Most scenes are one body.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, Final

from distal.diagnostics import CompileError
from distal.error_codes import ErrorCode
from distal.fields.combine.joins import UNION
from distal.ir.build import add, compare, field, integer, number, select
from distal.ir.nodes import Call, CompareOp, Expr, FunctionRef, If, Return
from distal.ir.types import FLOAT, INT, VEC3, FunctionType
from distal.lang.functions import Func
from distal.render import media, settings
from distal.render.camera import Ray
from distal.render.footprint import Footprint
from distal.render.march import Hit
from distal.scene.lowering.captures import capturing
from distal.scene.lowering.parts.flatten import member_count
from distal.scene.lowering.ray_functions import Define, Params, RayFunctions
from distal.scene.lowering.shapes import ZERO_CELL, ShapeComposer
from distal.scene.lowering.union_parts import united
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

# A set of bodies is a sum of powers of two, which the loops over bodies ask one by one.
MOST: Final = 8


def bodies_of(root: Node, material: Any, *, apart: bool) -> list[Node]:
    """Return the tree of each body, from the lowest priority up.

    Args:
        root: The tree of the scene.
        material: The material of shapes that have none.
        apart: Whether opaque solids and those of glass are different bodies. Then a solid inside of
            glass is seen, and glass that stands on a floor has a lower face.

    Raises:
        CompileError: There are too many priorities, or a blend or cut joins several.
    """
    members: dict[tuple[int, bool], list[Node]] = {}
    for member in members_of(root):
        is_opaque = apart and not is_clear(member, material)
        members.setdefault((_priority(member), is_opaque), []).append(member)
    priorities = {priority for priority, _ in members}
    if len(priorities) > MOST:
        raise CompileError.at(
            ErrorCode.OBJECT,
            f"the shapes have {len(priorities)} different priorities; {MOST} are possible",
            root.place,
            "give the same priority to shapes that do not overlap",
        )
    for (priority, _), nodes in members.items():
        for node in nodes:
            _check(node, priority)
    if len(members) == 1:
        return [root]
    return [united(root, members[key]) for key in sorted(members)]


def largest_of(bodies: Sequence[Node]) -> int:
    """Return which body has the most parts: the one that may have a table."""
    return max(range(len(bodies)), key=lambda k: member_count(bodies[k]))


def members_of(root: Node) -> Iterator[Node]:
    """Yield the members of the unions at the root; a union with a paint is one member."""
    stack = [root]
    while stack:
        node = stack.pop()
        if node.rule is UNION and node.material is None:
            stack.extend(reversed(node.children))
        else:
            yield node


def is_clear(member: Node, material: Any) -> bool:
    """Return whether light may pass through some shape of a member.

    Args:
        member: The member.
        material: The material of shapes that have none.
    """
    return any(found.refracts for found in materials_of(member, material))


def materials_of(member: Node, material: Any) -> Iterator[Any]:
    """Yield the materials of the shapes of a member; the outermost paint counts.

    Args:
        member: The member.
        material: The material of shapes that have none.
    """
    stack = [member]
    while stack:
        node = stack.pop()
        if node.material is None and node.children:
            stack.extend(node.children)
        else:
            yield node.material or material


def _priority(node: Node) -> int:
    while node.material is None and node.children:
        node = node.children[0]
    return 0 if node.material is None else int(node.material.priority)


def _check(member: Node, priority: int) -> None:
    """Refuse parts of a blend or a cut with priorities of their own.

    Args:
        member: A member of the scene's union.
        priority: Its priority.
    """
    stack = [member]
    while stack:
        node = stack.pop()
        if node.material is None:
            stack.extend(node.children)
        elif node.material.priority != priority:
            raise CompileError.at(
                ErrorCode.OBJECT,
                f"'{node.name}' has priority {node.material.priority} in a shape of priority "
                f"{priority}: {member.name} is one body",
                node.place,
                "paint the whole shape with a priority; parts of a | b may have their own",
            )


class BodyFunctions:
    """Makes the functions that follow rays through the bodies of a scene.

    Attributes:
        constants: What a library function has to know of the bodies, by name.

    Args:
        composer: Makes the functions of the program's shapes.
        bodies: The tree of each body, from the lowest priority up.
        common: The body that may have a table.
        define: Adds a function.
        closed: As for ``RayFunctions``.
    """

    def __init__(
        self,
        composer: ShapeComposer,
        bodies: Sequence[Node],
        common: int,
        define: Define,
        *,
        closed: bool = False,
    ) -> None:
        self._composer = composer
        self._nodes = bodies
        self._rays = [RayFunctions(composer, node, define, closed=closed) for node in bodies]
        self._common = common
        self._define = define
        self.constants: Mapping[str, Expr] = {
            "bodies": integer(len(bodies)),
            "common": integer(common),
        }

    @property
    def are_many(self) -> bool:
        """Whether there is more than one body."""
        return len(self._nodes) > 1

    def first_hit(self, body: StatementList, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function ``(ray) -> Hit`` for rays of the camera.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name.
        """
        params = [("ray", self._composer.assembly.struct(Ray))]
        own = [
            rays.first_hit(body, values, hybrid=False)
            for rays, values in zip(self._rays, self._given(body, given), strict=True)
        ]
        return self._joined("first_of_bodies", params, own, media.first_of_body)

    def first_within(self) -> FunctionRef:
        """Return the function ``(ray, hit) -> int``: the bodies in which a camera's ray starts."""
        composer = self._composer

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            if not self.are_many:
                return composer.call(media.in_air_or_body, given)
            within: Expr = integer(0)
            for k in range(len(self._nodes)):
                own = given[f"own_{k}"]
                assert isinstance(own, FunctionRef)
                d = Call(own.name, (field(given["ray"], "origin"), *own.captures), FLOAT)
                is_inside = compare(CompareOp.LT, d, number(0.0))
                within = add(within, select(is_inside, integer(1 << k), integer(0)))
            return within

        struct = composer.assembly.struct
        params: Params = [("ray", struct(Ray)), ("hit", struct(Hit))]
        fields = {
            f"own_{k}": composer.safe_field(node, composer.values.all(node), ZERO_CELL)
            for k, node in enumerate(self._nodes if self.are_many else ())
        }
        return capturing(self._define, "first_within", params, fields, make)

    def next_hit(self, body: StatementList, given: Mapping[str, Expr]) -> FunctionRef:
        """Return the function ``(ray, within, slope, part) -> Hit`` for rays from a surface.

        Args:
            body: The statements of the function that calls it.
            given: The values of the march, by name; rays begin at 0.
        """
        ray = self._composer.assembly.struct(Ray)
        params = [("ray", ray), ("within", INT), ("slope", FLOAT), ("part", INT)]
        own = [
            rays.next_hit(body, values)
            for rays, values in zip(self._rays, self._given(body, given), strict=True)
        ]
        return self._joined("next_of_bodies", params, own, media.next_of_body)

    def field_of(self) -> FunctionRef:
        """Return the function ``(p, part) -> float``: the field near a surface of a part."""
        fields = [rays.field_of(hybrid=False) for rays in self._rays]
        return self._chosen("field_of_body", [("p", VEC3), ("part", INT)], fields)

    def surface(self, of_node: Callable[[Node], FunctionRef]) -> FunctionRef:
        """Return the function ``(p, footprint, part) -> Surface``.

        Args:
            of_node: Returns this function of one tree.
        """
        footprint = self._composer.assembly.struct(Footprint)
        params: Params = [("p", VEC3), ("footprint", footprint), ("part", INT)]
        return self._chosen("surface_of_body", params, [of_node(node) for node in self._nodes])

    def _given(
        self, body: StatementList, given: Mapping[str, Expr]
    ) -> Iterator[Mapping[str, Expr]]:
        """Yield the values of the march in each body: its own box."""
        composer = self._composer
        for node in self._nodes:
            if not self.are_many:
                yield given
                return
            own = composer.bounds.of(body, node, composer.values.all(node)).bounds
            box = body.let("bounds", composer.call(settings.grown_bounds, {"bounds": own}))
            yield {**given, "bounds": box}

    def _joined(
        self, name: str, params: Params, own: Sequence[FunctionRef], function: Func
    ) -> FunctionRef:
        """Return the nearest of the bodies' hits as one function.

        Args:
            name: Its name.
            params: Name and type of each parameter.
            own: The function of each body.
            function: The library function that calls it.
        """

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            found: Expr | None = None
            for k in range(len(own)):
                asked = {**given, **self.constants, "own": given[f"own_{k}"], "body": integer(k)}
                hit = body.let("hit", self._composer.call(function, asked))
                if found is not None:
                    two = {"first": found, "second": hit}
                    hit = body.let("hit", self._composer.call(media.nearer, two))
                found = hit
            assert found is not None
            return found

        functions = {f"own_{k}": each for k, each in enumerate(own)}
        return capturing(self._define, name, params, functions, make)

    def _chosen(self, name: str, params: Params, own: Sequence[FunctionRef]) -> FunctionRef:
        """Return the function of the body that a part belongs to.

        Args:
            name: Its name.
            params: Name and type of each parameter; one is ``part``.
            own: The function of each body.
        """
        if len(own) == 1:
            return own[0]
        signature = own[0].type
        assert isinstance(signature, FunctionType)
        result = signature.result

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            known = {n: given[n] for n, _ in params}
            known["common"] = integer(self._common)
            of = body.let("of", self._composer.call(media.body_of, known))
            for k in range(len(own)):
                each = given[f"own_{k}"]
                assert isinstance(each, FunctionRef)
                below = {"body": integer(k), "common": integer(self._common)}
                part = add(given["part"], self._composer.call(media.offset_of, below))
                args = tuple(part if n == "part" else given[n] for n, _ in params)
                call = Call(each.name, (*args, *each.captures), result)
                if k == len(own) - 1:
                    return call
                is_own = compare(CompareOp.EQ, of, integer(k))
                body.statements.append(If(is_own, (Return(call),), ()))
            raise AssertionError("there is no body")

        functions = {f"own_{k}": each for k, each in enumerate(own)}
        return capturing(self._define, name, params, functions, make)
