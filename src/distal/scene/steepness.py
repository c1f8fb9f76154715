"""Refusing shapes that no ray can be marched to: fields without a bound on their slope.

What flows in: a shape's tree. What flows out: an error at the place where the bound was lost: a
twist of something that has no end, say.
"""

from __future__ import annotations

from distal.executor_hook import executor
from distal.fields.claims import ENDLESS, Operator
from distal.frontend import Assembly
from distal.ir.build import number
from distal.ir.nodes import Construct, Return
from distal.ir.types import FLOAT, tuple_type
from distal.lang.composed import Composed
from distal.lang.functions import Func
from distal.scene.derived import PromiseOf
from distal.scene.node import Node
from distal.scene.promises import RememberedPromises
from distal.scene.refusals import refuse
from distal.scene.values import Body, Values


class _Slopes(Composed):
    """The slopes of some nodes, for the parameters' defaults."""

    def __init__(self, nodes: list[Node]) -> None:
        self._nodes = nodes
        self.name, self.signature = "slopes", ()
        self.result = tuple_type((FLOAT,) * (len(nodes) + 1))

    def compose(self, assembly: Assembly) -> str:
        """A function of nothing that gives them."""
        body, values = Body(), Values(assembly)
        promises = RememberedPromises(values)
        found = tuple(promises.of(body, n, values.all(n)).slope for n in self._nodes)
        whole = Construct((*found, number(0.0)), self.result)
        body.statements.append(Return(whole))
        return assembly.define("slopes", (), self.result, body.statements)


def check_slopes(root: Node) -> None:
    """Refuse a tree in which an operator's slope has no bound.

    Raises:
        CompileError: At the innermost such operator.
    """
    risky = [
        n for n in root.walk() if isinstance(n.rule, Operator) and isinstance(n.rule.slope, Func)
    ]
    if not risky:
        return
    try:
        slopes = executor().call(_Slopes(risky), (), {})
    except ModuleNotFoundError:  # without NumPy nothing is marched here, only compiled to text
        return
    # Parents come first: the last one is the innermost.
    for node, slope in reversed(list(zip(risky, slopes, strict=False))):
        if not slope < ENDLESS:
            assert isinstance(node.rule, Operator)
            message = f"{node.rule.name} gives this shape no bound on its slope"
            hint = f"{node.rule.name} needs {node.rule.needs}{_boxed(node.children)}"
            refuse(message, hint, node.place)


def _boxed(children: tuple[Node, ...]) -> str:
    """The box that the rule judged, in words; none where it has no end, as the rule says that."""
    if len(children) != 1:
        return ""
    low, high = (tuple(corner) for corner in executor().call(PromiseOf(children[0]), (), {})[2:])
    if any(abs(c) >= ENDLESS for c in low + high):
        return ""
    return f"; its box goes from {_corner(low)} to {_corner(high)}"


def _corner(place: tuple[float, ...]) -> str:
    return f"({', '.join(f'{c:.3g}' for c in place)})"
