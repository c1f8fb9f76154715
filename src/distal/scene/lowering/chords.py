"""Chords of subtrees: where a line is inside of a convex solid, in closed form.

Input: a subtree of one primitive that declares its chord, under rigid moves and uniform scales, or
of several of which conditions select one.
Output: an expression, the distances along the line at which it enters and leaves the solid.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING

from distal.fields.combine.alternatives import SELECT
from distal.fields.guarantees import Primitive
from distal.ir.build import swizzle
from distal.ir.nodes import Compose, Expr
from distal.ir.types import VEC2
from distal.scene.lowering.selection import selected
from distal.scene.tree.node import Node
from distal.scene.tree.values import StatementList

if TYPE_CHECKING:
    from distal.scene.lowering.shapes import ShapeComposer


def has_chord(node: Node) -> bool:
    """Return whether the chord of a subtree is known in closed form."""
    rule = node.rule
    if isinstance(rule, Primitive):
        return rule.chord is not None
    if rule is SELECT:
        return all(map(has_chord, node.children))
    return rule.turn is not None and has_chord(node.children[0])


def chord_of(
    composer: ShapeComposer,
    body: StatementList,
    node: Node,
    line: tuple[Expr, Expr],
    cell: Expr,
    values: Sequence[Expr],
) -> Expr:
    """Return where a line enters and leaves a subtree; a vec2.

    Args:
        composer: Makes the functions of the program's shapes.
        body: The statements to add to.
        node: The root of the subtree, which has a chord.
        line: A point of the line and its unit direction.
        cell: The index of the repetition.
        values: The numbers of the subtree.
    """
    p, direction = line
    given, shares = composer.given(body, node, p, cell, values)
    rule = node.rule
    if isinstance(rule, Primitive):
        assert rule.chord is not None
        return body.let("chord", composer.call(rule.chord, {**given, "direction": direction}))
    if rule is SELECT:
        first, second = (
            partial(chord_of, composer, node=child, line=line, cell=cell, values=share)
            for child, share in zip(node.children, shares, strict=True)
        )
        return selected(body, given["second"], first, second, type=VEC2)
    assert rule.turn is not None
    turned = body.let("way", composer.call(rule.turn, {**given, "p": direction}))
    moved, _ = composer.moved(body, rule, given)
    found = chord_of(composer, body, node.children[0], (moved, turned), cell, shares[0])
    if rule.finish is None:
        return found
    ends = (composer.call(rule.finish, {**given, "d": swizzle(found, end)}) for end in "xy")
    return body.let("chord", Compose(tuple(ends), VEC2))
