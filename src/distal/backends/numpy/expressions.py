"""The reference's expressions: the value of each node, in all lanes of a scope at once.

Input: an expression, and the scope of the lanes that need it. Output: its value, in the layouts of
``operations``. The subclass defines how a called function runs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from distal.backends.numpy import operations
from distal.backends.numpy.operations import Leaf, Value
from distal.backends.numpy.scopes import ActiveCall, Scope
from distal.ir.intrinsics import INTRINSICS
from distal.ir.nodes import (
    Apply,
    Binary,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Expr,
    Field,
    FunctionRef,
    Gradient,
    Index,
    Logical,
    LogicalOp,
    MatMul,
    Module,
    PerFrame,
    Read,
    Resource,
    Sample,
    Select,
    Size,
    Splat,
    Swizzle,
    Texel,
    Unary,
    Uniform,
)
from distal.ir.types import Buffer, Kind, Struct, Texture, TextureShape, kind_of
from distal.ir.walk import children

Memo = dict[Expr, Value]
Step = Callable[[Scope, Memo], Value]


class ReferenceExpressions:
    """Computes expressions of one module with one set of uniforms and resources.

    Args:
        module: The module.
        uniforms: A value for every uniform, by name.
        resources: An array for every texture (texels in the order of their indices: (height,
            width, 4), depth or face first) and buffer, by name.
        precision: Bits of a float.
        poll: Called in every iteration of a loop; raises an exception to stop the work.
    """

    def __init__(
        self,
        module: Module,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        precision: int = 32,
        poll: Callable[[], None] | None = None,
    ) -> None:
        self._functions = {f.name: f for f in module.functions}
        self.precision = precision
        self._poll = poll or (lambda: None)
        self._resources = {r.name: self._array(resources[r.name], r.type) for r in module.resources}
        self._uniforms = {
            u.name: operations.as_value(uniforms[u.name], u.type, precision)
            for u in module.uniforms
        }
        self._calls: dict[Expr, bool] = {}
        self._steps: dict[Expr, Step] = {}
        self._per_frame: dict[str, Value] = {}
        nowhere = Scope(ActiveCall(1), 1)
        with np.errstate(all="ignore"):
            for name, value in module.frame:
                self._per_frame[name] = self._evaluate(value, nowhere, {})

    def _array(self, data: Any, type: Any) -> Leaf:
        kind = Kind.FLOAT if isinstance(type, Texture) else kind_of(type.element)
        assert kind is not None
        return np.asarray(data).astype(operations.dtype_of(kind, self.precision))

    def _call(self, name: str, args: Sequence[Value]) -> Value:
        """Return the value of a function; the subclass runs its statements."""
        raise NotImplementedError

    # Expressions. The memo contains the values of parts that a statement shares.

    def _leaf(self, e: Expr, scope: Scope, memo: Memo) -> Leaf:
        value = self._evaluate(e, scope, memo)
        assert isinstance(value, np.ndarray)
        return value

    def _evaluate(self, e: Expr, scope: Scope, memo: Memo) -> Value:
        value = memo.get(e)
        if value is None:
            step = self._steps.get(e)
            if step is None:
                step = self._steps[e] = self._step(e)
            value = memo[e] = step(scope, memo)
        return value

    def _step(self, e: Expr) -> Step:
        """Return the function that computes a node. It is found once and called many times."""
        match e:
            case Const(value, type):
                known = operations.as_value(value, type, self.precision)
                return lambda scope, memo: known
            case Read(name):
                return lambda scope, memo: scope.read(name)
            case Uniform(name):
                known = self._uniforms[name]
                return lambda scope, memo: known
            case PerFrame(name):
                known = self._per_frame[name]
                return lambda scope, memo: known
            case Logical(op, lhs, rhs):
                return lambda scope, memo: self._logical(op, lhs, rhs, scope, memo)
            case Select(condition, yes, no):
                return lambda scope, memo: self._select(
                    self._leaf(condition, scope, memo), yes, no, scope, memo
                )
            case Construct(parts):
                return lambda scope, memo: tuple([self._evaluate(p, scope, memo) for p in parts])
            case Field(base, name):
                assert isinstance(base.type, Struct)
                place = [n for n, _ in base.type.fields].index(name)
                return lambda scope, memo: self._evaluate(base, scope, memo)[place]
            case Index(base, index):
                return lambda scope, memo: self._index(
                    base, self._leaf(index, scope, memo), scope, memo
                )
            case Call(name, args):
                return lambda scope, memo: self._call(
                    name, [self._evaluate(a, scope, memo) for a in args]
                )
            case Texel(Resource(name, Texture(shape)), index):
                data = self._resources[name]
                return lambda scope, memo: self._texel(data, shape, self._leaf(index, scope, memo))
            case Size(Resource(name, type)):
                known = self._size(self._resources[name], type)
                return lambda scope, memo: known
            case Resource() | FunctionRef() | Apply() | Gradient() | Sample() | Texel() | Size():
                raise AssertionError(f"passes leave no such expression: {e}")
            case _:
                return self._componentwise(e)

    def _componentwise(self, e: Expr) -> Step:
        """Return the step of a node that depends only on the values of its operands."""
        meaning, operands, evaluate = self._meaning(e), children(e), self._evaluate
        if len(operands) == 1:
            (a,) = operands
            return lambda scope, memo: meaning(evaluate(a, scope, memo))
        if len(operands) == 2:
            a, b = operands
            return lambda scope, memo: meaning(evaluate(a, scope, memo), evaluate(b, scope, memo))
        return lambda scope, memo: meaning(*[evaluate(o, scope, memo) for o in operands])

    def _meaning(self, e: Expr) -> Callable[..., Leaf]:
        match e:
            case Unary(op):
                return operations.UNARY[op]
            case Binary(op):
                return operations.BINARY[op]
            case Compare(op):
                return operations.COMPARISONS[op]
            case MatMul():
                return operations.matrix_product
            case Splat(_, type):
                return lambda value: operations.splat(value, type)
            case Compose(_, type):
                return lambda *parts: operations.compose(parts, type)
            case Swizzle(_, lanes):
                positions = ["xyzw".index(lane) for lane in lanes]
                key = positions if len(positions) > 1 else positions[0]
                return lambda base: base[key]
            case Cast(_, type):
                kind = kind_of(type)
                assert kind is not None
                return lambda value: operations.convert(value, kind, self.precision)
            case Builtin(name):
                return self._builtin(name)
            case _:
                raise AssertionError(f"not an expression of components: {e}")

    def _builtin(self, name: str) -> Callable[..., Leaf]:
        meaning = INTRINSICS[name].meaning
        assert meaning is not None, f"decompose leaves no {name} here"
        dtype = operations.dtype_of(Kind.FLOAT, self.precision)

        def computed(*operands: Leaf) -> Leaf:
            result: Leaf = meaning(np, *operands)
            return result.astype(dtype, copy=False) if result.dtype.kind == "f" else result

        if not name.startswith("float_bits"):
            return computed
        # In either precision, the bits are those of a 32-bit float.
        return lambda *operands: computed(*[a.astype(np.float32) for a in operands])

    def _logical(self, op: LogicalOp, lhs: Expr, rhs: Expr, scope: Scope, memo: Memo) -> Value:
        first = self._leaf(lhs, scope, memo)
        decided = first if op is LogicalOp.OR else ~first
        if decided.all():
            return first
        if not self._has_call(rhs):
            second = self._leaf(rhs, scope, memo)
            return first | second if op is LogicalOp.OR else first & second
        return self._select(decided, lhs, rhs, scope, memo)

    def _select(self, condition: Leaf, yes: Expr, no: Expr, scope: Scope, memo: Memo) -> Value:
        if condition.ndim == 1:
            if condition.all():
                return self._evaluate(yes, scope, memo)
            if not condition.any():
                return self._evaluate(no, scope, memo)
            if self._has_call(yes) or self._has_call(no):
                return self._select_lanes(condition, yes, no, scope)
        picked = (self._evaluate(e, scope, memo) for e in (yes, no))
        return operations.choose(condition, *picked)

    def _select_lanes(self, condition: Leaf, yes: Expr, no: Expr, scope: Scope) -> Value:
        """Compute each side only in its lanes: in other lanes a loop in it may not end."""
        result: Value | None = None
        for e, taken in ((yes, condition), (no, ~condition)):
            lanes = taken.nonzero()[0]
            value = self._evaluate(e, scope.narrowed(lanes), {})
            base = operations.blank(value) if result is None else result
            result = operations.scatter(base, lanes, value, scope.lanes)
        assert result is not None
        return result

    def _has_call(self, e: Expr) -> bool:
        known = self._calls.get(e)
        if known is None:
            known = isinstance(e, Call) or any(self._has_call(c) for c in children(e))
            self._calls[e] = known
        return known

    def _index(self, base: Expr, index: Leaf, scope: Scope, memo: Memo) -> Value:
        if isinstance(base, Resource):
            data = self._resources[base.name]
            elements: Leaf = data[np.clip(index, 0, len(data) - 1)]
            return np.moveaxis(elements, 0, -1)
        return operations.pick(self._evaluate(base, scope, memo), index)

    @staticmethod
    def _texel(data: Leaf, shape: TextureShape, index: Leaf) -> Leaf:
        extents = data.shape[:-1][::-1]
        held = [np.clip(i, 0, extent - 1) for i, extent in zip(index, extents, strict=True)]
        assert len(held) == (2 if shape is TextureShape.FLAT else 3)
        return np.moveaxis(data[tuple(reversed(held))], -1, 0)

    @staticmethod
    def _size(data: Leaf, type: Any) -> Leaf:
        if isinstance(type, Buffer):
            return np.array([len(data)], np.int32)
        extents = data.shape[:-1][::-1]
        if type.shape is TextureShape.CUBE:
            extents = extents[:2]
        return np.array(extents, np.int32)[:, None]
