"""Add the computation of tangents to a function's statements.

Input: the body of a function, the tangents of its parameters along each direction, and the locals
that change. Output: a body that computes the same values and, for each value that changes, its
tangents: ``q`` gets ``q_dx``, ``q_dy``, ``q_dz``. A call becomes a call of the callee's derivative
function, which returns the value and the tangents together. Conditions, indices and loop bounds are
kept. Does not depend on how derivative functions are found and named.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias, assert_never

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.ir.nodes import (
    Apply,
    Assign,
    Binary,
    BinaryOp,
    Break,
    Builtin,
    Call,
    Cast,
    Compare,
    Compose,
    Const,
    Construct,
    Continue,
    Expr,
    Field,
    For,
    FunctionRef,
    Gradient,
    If,
    Index,
    Let,
    Logical,
    MatMul,
    PerFrame,
    Read,
    Resource,
    Return,
    Sample,
    Select,
    Size,
    Splat,
    Stmt,
    Swizzle,
    Texel,
    Unary,
    Uniform,
    Var,
    While,
    span_in,
)
from distal.ir.tangents import (
    LETTERS,
    Lanes,
    Tangent,
    filled,
    from_lanes,
    has_floats,
    is_constant,
    lanes_of,
    zero,
)
from distal.ir.types import BOOL, tuple_type
from distal.ir.walk import children, rebuild, root_of, substitute
from distal.passes.gradient.activity import FunctionActivity
from distal.passes.gradient.dual_rules import node_tangent
from distal.passes.naming import FreshNames

# Deeper expressions are bound to locals: rules use their arguments several times, and the text must
# stay small.
_DEEP_TANGENT = 8
_DEEP_VALUE = 24
_DEEP_ARGUMENT = 3


@dataclass(frozen=True, slots=True)
class Version:
    """A derivative function, as needed to call it.

    Attributes:
        function: Its name. It returns a tuple: the value, then a tangent for each direction.
        directions: The directions whose tangents it returns, one bit for each.
        constants: The constant tangents, for each direction; it does not return them.
        passed: The tangents to pass after the arguments.
    """

    function: str
    directions: int
    constants: Lanes
    passed: tuple[Expr, ...]


Derive: TypeAlias = Callable[[str, tuple[Lanes, ...]], Version]
Returned: TypeAlias = Callable[[Expr, Lanes], Expr]


@dataclass(frozen=True, slots=True)
class _Pair:
    """A value and its tangents, one for each direction."""

    value: Expr
    tangents: Lanes

    @property
    def changes(self) -> bool:
        return any(t is not None for t in self.tangents)


def tangent_name(name: str, direction: int, count: int) -> str:
    """Return the name for the tangent of a local.

    Args:
        name: The local.
        direction: The index of the direction.
        count: The number of directions.
    """
    return f"{name}_d" if count == 1 else f"{name}_d{LETTERS[direction]}"


class DualBody:
    """The body of one function during differentiation."""

    def __init__(
        self,
        derive: Derive,
        names: FreshNames,
        activity: FunctionActivity,
        tangents: dict[str, Lanes],
        count: int,
    ) -> None:
        self._derive = derive
        self._names = names
        self._activity = activity
        self._tangents = tangents  # the tangents of the locals bound so far
        self._count = count
        self._still: Lanes = (None,) * count
        self._returned: Returned = lambda value, _: value
        self._memo: dict[Expr, _Pair] = {}  # for the current statement
        self._vars: set[str] = set()  # the tangents that are themselves Vars
        self._depths: dict[Expr, int] = {}
        self._span: Span | None = None

    def function_body(self, body: tuple[Stmt, ...], returned: Returned) -> tuple[Stmt, ...]:
        """Differentiate the body; ``returned`` combines a returned value with its tangents."""
        self._returned = returned
        return self._block(body)

    # Statements.

    def _block(self, body: tuple[Stmt, ...]) -> tuple[Stmt, ...]:
        out: list[Stmt] = []
        for stmt in body:
            self._memo = {}
            self._span = stmt.span
            self._statement(stmt, out)
        return tuple(out)

    def _statement(self, stmt: Stmt, out: list[Stmt]) -> None:
        span = stmt.span
        match stmt:
            case Let(name, value):
                self._let(name, value, out)
            case Var(name, value):
                self._var(name, value, out)
            case Assign(target, value):
                self._assign(target, value, out)
            case Return(value):
                pair = self._dual(value, out)
                out.append(Return(self._returned(pair.value, pair.tangents), span=span))
            case If(condition, then, otherwise):
                out.append(If(condition, self._block(then), self._block(otherwise), span=span))
            case While(condition, body):
                out.append(While(condition, self._block(body), span=span))
            case For(name, start, stop, step, body):
                out.append(For(name, start, stop, step, self._block(body), span=span))
            case Break() | Continue():
                out.append(stmt)
            case _:
                assert_never(stmt)

    def _let(self, name: str, value: Expr, out: list[Stmt]) -> None:
        pair = self._dual(value, out)
        out.append(Let(name, pair.value, span=self._span))
        # Rules also use the value: they read it from its local.
        known = {pair.value: Read(name, value.type)} if children(pair.value) else {}
        memo: dict[Expr, Expr] = {}
        bound: list[Tangent] = []
        for k, tangent in enumerate(pair.tangents):
            wanted = tangent_name(name, k, self._count)
            if tangent is not None:
                tangent = self._named(substitute(tangent, dict(known), memo), 0, wanted, out)
            bound.append(tangent)
        self._tangents[name] = tuple(bound)

    def _directions(self, name: str) -> list[int]:
        mask = self._activity.locals.get(name, 0)
        return [k for k in range(self._count) if mask >> k & 1]

    def _var(self, name: str, value: Expr, out: list[Stmt]) -> None:
        pair = self._dual(value, out)
        out.append(Var(name, pair.value, span=self._span))
        bound = list(self._still)
        for k in self._directions(name):
            local = self._names.fresh(tangent_name(name, k, self._count))
            self._vars.add(local)
            out.append(Var(local, filled(pair.tangents[k], value.type), span=self._span))
            bound[k] = Read(local, value.type)
        self._tangents[name] = tuple(bound)

    def _assign(self, target: Expr, value: Expr, out: list[Stmt]) -> None:
        pair = self._dual(value, out)
        root = root_of(target)
        # Tangents first: they are computed from the values before the assignment. The tangent for a
        # direction depends only on tangents for the same direction.
        for k in self._directions(root.name):
            local = self._tangents[root.name][k]
            assert local is not None
            place = _replaced_root(target, local)
            tangent = filled(pair.tangents[k], target.type)
            out.append(Assign(place, tangent, span=self._span))
        out.append(Assign(target, pair.value, span=self._span))

    # Expressions.

    def _dual(self, e: Expr, out: list[Stmt]) -> _Pair:
        """Return the value and tangents of an expression; append needed statements to ``out``."""
        found = self._memo.get(e)
        if found is None:
            found = self._memo[e] = self._settled(self._made(e, out), out)
        return found

    def _made(self, e: Expr, out: list[Stmt]) -> _Pair:
        if not has_floats(e.type):
            return _Pair(e, self._still)
        match e:
            case Read(name):
                return _Pair(e, self._tangents.get(name, self._still))
            case Const() | Uniform() | PerFrame() | Resource() | Texel() | Size():
                return _Pair(e, self._still)
            case Compare() | Logical() | Cast():
                return _Pair(e, self._still)
            case Index(base, index):
                return self._combined(e, [self._dual(base, out), _Pair(index, self._still)])
            case Select():
                return self._select(e, out)
            case Call(name, args):
                return self._call(e, name, [self._dual(a, out) for a in args], out)
            case Builtin(_, args):
                return self._combined(e, [self._argument(a, out) for a in args])
            case Binary(BinaryOp.DIV | BinaryOp.MOD, lhs, rhs):
                return self._combined(e, [self._argument(lhs, out), self._argument(rhs, out)])
            case Sample(texture, coord):
                pair = self._dual(coord, out)
                if pair.changes:
                    raise CompileError.at(
                        ErrorCode.LANGUAGE,
                        "the gradient of a texture is not defined",
                        span_in(self._span, e),
                        "compare samples at neighboring places, outside the differentiated "
                        "function",
                    )
                return _Pair(rebuild(e, (texture, pair.value)), self._still)
            case Apply() | FunctionRef() | Gradient():
                raise AssertionError(f"{e} is gone before gradients are taken")
            case Unary() | Binary() | MatMul() | Splat() | Compose() | Swizzle():
                return self._combined(e, [self._dual(c, out) for c in children(e)])
            case Field() | Construct():
                return self._combined(e, [self._dual(c, out) for c in children(e)])
            case _:
                assert_never(e)

    def _combined(self, e: Expr, operands: list[_Pair]) -> _Pair:
        value = rebuild(e, tuple(p.value for p in operands))
        if not any(p.changes for p in operands):
            return _Pair(value, self._still)
        along = zip(*(p.tangents for p in operands), strict=True)
        return _Pair(value, tuple(node_tangent(value, d) for d in along))

    def _argument(self, e: Expr, out: list[Stmt]) -> _Pair:
        """Return an operand that a rule uses more than once, bound to a local if it is deep."""
        pair = self._dual(e, out)
        if not pair.changes:
            return pair
        value = self._named(pair.value, _DEEP_ARGUMENT, "part", out)
        pair = _Pair(value, self._named_tangents(pair.tangents, _DEEP_ARGUMENT, out))
        self._memo[e] = pair
        return pair

    def _call(self, e: Call, name: str, args: list[_Pair], out: list[Stmt]) -> _Pair:
        values = tuple(a.value for a in args)
        plain = _Pair(rebuild(e, values), self._still)
        if not any(a.changes for a in args):
            return plain
        version = self._derive(name, tuple(a.tangents for a in args))
        if not version.directions:
            return _Pair(plain.value, version.constants)
        items = tuple_type((e.type,) * (1 + version.directions.bit_count()))
        call = Call(version.function, (*values, *version.passed), items, span=e.span)
        result = Read(self._names.fresh(f"{name}_result"), items)
        out.append(Let(result.name, call, span=self._span))
        tangents = list(version.constants)
        item = 1
        for k in range(self._count):
            if version.directions >> k & 1:
                tangents[k] = Field(result, f"item{item}", e.type)
                item += 1
        return _Pair(Field(result, "item0", e.type), tuple(tangents))

    def _select(self, e: Select, out: list[Stmt]) -> _Pair:
        """Differentiate a Select; if its branches need statements, it becomes an If."""
        before = dict(self._memo)
        then: list[Stmt] = []
        yes = self._dual(e.yes, then)
        self._memo = dict(before)
        otherwise: list[Stmt] = []
        no = self._dual(e.no, otherwise)
        self._memo = before
        if not then and not otherwise:
            return self._combined(e, [_Pair(e.condition, self._still), yes, no])
        return self._branches(e, (yes, then), (no, otherwise), out)

    def _branches(
        self,
        e: Select,
        yes: tuple[_Pair, list[Stmt]],
        no: tuple[_Pair, list[Stmt]],
        out: list[Stmt],
    ) -> _Pair:
        def chosen(name: str, one: Tangent, other: Tangent) -> Expr:
            local = Read(self._names.fresh(name), e.type)
            out.append(Var(local.name, zero(e.type), span=self._span))
            for block, given in ((then, one), (otherwise, other)):
                if given is not None:
                    block.append(Assign(local, given, span=self._span))
            return local

        (yes_pair, then), (no_pair, otherwise) = yes, no
        if e.condition.type is not BOOL:
            # A Select with a bvec condition computes both sides.
            out.extend((*then, *otherwise))
            pairs = [_Pair(e.condition, self._still), yes_pair, no_pair]
            return self._combined(e, pairs)
        value = chosen("choice", yes_pair.value, no_pair.value)
        tangents = list(self._still)
        for k in range(self._count):
            one, other = yes_pair.tangents[k], no_pair.tangents[k]
            if one is not None or other is not None:
                tangents[k] = chosen(tangent_name("choice", k, self._count), one, other)
        out.append(If(e.condition, tuple(then), tuple(otherwise), span=self._span))
        return _Pair(value, tuple(tangents))

    # Locals for deep expressions.

    def _settled(self, pair: _Pair, out: list[Stmt]) -> _Pair:
        if not pair.changes:
            return pair
        value = self._named(pair.value, _DEEP_VALUE, "part", out)
        return _Pair(value, self._named_tangents(pair.tangents, _DEEP_TANGENT, out))

    def _named_tangents(self, tangents: Lanes, deepest: int, out: list[Stmt]) -> Lanes:
        return tuple(None if t is None else self._named(t, deepest, "slope", out) for t in tangents)

    def _named(self, e: Expr, deepest: int, name: str, out: list[Stmt]) -> Expr:
        """Bind the expression to a local unless it is shallow; return its replacement."""
        if is_constant(e) or (self._depth(e) <= deepest and not self._may_change(e)):
            return e
        if isinstance(e, Splat):
            # A matrix can be scaled by a Splat only, so the Splat must be kept.
            return rebuild(e, (self._named(e.value, deepest, name, out),))
        lanes = lanes_of(e)
        if lanes is None:
            local = Read(self._names.fresh(name), e.type)
            out.append(Let(local.name, e, span=self._span))
            return local
        # Only the components that change get names, so that zeros remain visible.
        whole = from_lanes(
            tuple(
                None if part is None else self._named(part, deepest, f"{name}_{letter}", out)
                for part, letter in zip(lanes, LETTERS, strict=False)
            ),
            e.type,
        )
        assert whole is not None
        return whole

    def _may_change(self, e: Expr) -> bool:
        """Return whether ``e`` is a read of a Var, which is valid in the current statement only."""
        return isinstance(e, Read) and e.name in self._vars

    def _depth(self, e: Expr) -> int:
        found = self._depths.get(e)
        if found is None:
            found = 1 + max((self._depth(c) for c in children(e)), default=-1)
            self._depths[e] = found
        return found


def _replaced_root(target: Expr, root: Expr) -> Expr:
    match target:
        case Read():
            return root
        case Swizzle(base) | Field(base):
            return rebuild(target, (_replaced_root(base, root),))
        case Index(base, index):
            return rebuild(target, (_replaced_root(base, root), index))
        case _:
            raise AssertionError(f"{target} as a target")
