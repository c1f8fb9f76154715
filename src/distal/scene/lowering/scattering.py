"""How a scene's materials scatter the light of paths: the library's way, and authors' functions.

Input: the materials of a scene. Output: the functions of a program that respond to light and choose
directions (``scatter.respond_to``, ``scatter.sample_from``, or both with the authors' functions).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, Final, cast

from distal.ir.build import compare, field
from distal.ir.nodes import Apply, CompareOp, Expr, FunctionRef, If, Return
from distal.ir.types import VEC3, FunctionType, Type
from distal.render import own_scattering, scatter
from distal.render.material import Surface
from distal.scene.lowering.ray_functions import Define
from distal.scene.lowering.shapes import ShapeComposer
from distal.scene.tree.calls import FunctionCall
from distal.scene.tree.own_functions import BsdfInProgram, OwnBsdf
from distal.scene.tree.values import StatementList

_FUNCTIONS: Final = "scattering functions"


def own_bsdfs_in(value: Any) -> Iterator[OwnBsdf]:
    """Yield the scattering functions of authors in a material, those of its parts included."""
    if isinstance(value, OwnBsdf):
        yield value
    call = value if isinstance(value, FunctionCall) else getattr(value, "call", None)
    if isinstance(call, FunctionCall):
        for inner in call.values.values():
            yield from own_bsdfs_in(inner)


def number_bsdfs(composer: ShapeComposer, materials: Iterable[Any]) -> None:
    """Give the scattering functions of a scene's materials their numbers, in order."""
    for material in materials:
        for bsdf in own_bsdfs_in(material):
            bsdf.number(composer)


def scattering_functions(composer: ShapeComposer, define: Define) -> dict[str, Expr]:
    """Return ``respond`` and ``scatter``, by name of ``paths.path_light``.

    Args:
        composer: Adds values to the program; the scene's functions have numbers.
        define: Adds a function.
    """
    made = composer.assembly.made
    if _FUNCTIONS not in made:
        known = list(OwnBsdf.known(composer).values())
        made[_FUNCTIONS] = _with_own(composer, define, known) if known else _plain(composer)
    return cast("dict[str, Expr]", made[_FUNCTIONS])


def _plain(composer: ShapeComposer) -> dict[str, Expr]:
    """Return the library's own functions."""
    struct = composer.assembly.struct
    params = (struct(scatter.Meeting), VEC3)
    respond = FunctionType(params, struct(scatter.Response))
    onward = FunctionType(params, struct(scatter.Scattering))
    return {
        "respond": composer.assembly.reference(scatter.respond_to, respond),
        "scatter": composer.assembly.reference(scatter.sample_from, onward),
    }


def _with_own(
    composer: ShapeComposer, define: Define, known: Sequence[BsdfInProgram]
) -> dict[str, Expr]:
    """Return the functions that choose between the library's way and the authors'."""
    struct = composer.assembly.struct
    surface = struct(Surface)
    place: list[tuple[str, Type]] = [("surface", surface), ("n", VEC3), ("view", VEC3)]

    def chosen(name: str, last: str, result: Callable[..., Expr]) -> FunctionRef:
        """Return a function that calls that of the surface's number."""

        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            at = field(given["surface"], "bsdf")
            for own in known[:-1]:
                is_this = compare(CompareOp.EQ, at, own.number)
                body.statements.append(If(is_this, (Return(result(own, given)),), ()))
            return result(known[-1], given)

        return define(name, [*place, (last, VEC3)], make, [])

    def response(own: BsdfInProgram, given: Mapping[str, Expr]) -> Expr:
        functions = {"evaluate": own.evaluate, "density": own.density}
        return composer.call(own_scattering.own_response, {**given, **functions})

    def direction(own: BsdfInProgram, given: Mapping[str, Expr]) -> Expr:
        return Apply(own.sample, tuple(given.values()), VEC3)

    functions = {
        "respond_own": chosen("own_response", "light", response),
        "sample_own": chosen("own_direction", "u", direction),
    }

    def both(name: str, function: Any, last: str) -> FunctionRef:
        def make(body: StatementList, given: Mapping[str, Expr]) -> Expr:
            return composer.call(function, {**given, **functions})

        return define(name, [("meeting", struct(scatter.Meeting)), (last, VEC3)], make, [])

    return {
        "respond": both("respond", own_scattering.respond_with_own, "light"),
        "scatter": both("scatter", own_scattering.scatter_with_own, "u"),
    }
