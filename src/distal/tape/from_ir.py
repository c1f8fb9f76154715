"""Turn a function of the IR into a tape.

Input: a module whose entry is a function of a point, after the CPU's passes up to ``LAST_PASS`` in
64 bits (there, elementary functions are still built-ins), and values of its uniforms and buffers.
Output: a tape. Calls are followed, loops with constant bounds are unrolled, and both branches of a
condition are computed. What depends on uniforms only is computed now, so that other values of
uniforms need a new tape.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, assert_never

import numpy as np

from distal.backends.llvm.lanes import field_offset, leaf_count, leaf_kinds
from distal.ir.nodes import (
    Assign,
    Break,
    Continue,
    Expr,
    Field,
    For,
    Function,
    If,
    Index,
    Let,
    Module,
    Read,
    Return,
    Stmt,
    Swizzle,
    Var,
    While,
)
from distal.ir.types import Kind, Struct, Type, component_count
from distal.ir.walk import statements_in
from distal.tape.expressions import Environment, ExpressionFollower, Scalars_
from distal.tape.layout import MOST_OPERATIONS
from distal.tape.scalars import Scalar, Scalars, Varying
from distal.tape.tape import Tape, TapeError

LAST_PASS: Final = "predicate"
PRECISION: Final = 64
_MOST_STEPS: Final = 4 * MOST_OPERATIONS  # statements and calls that are followed


def tape_of(
    module: Module,
    uniforms: Mapping[str, Any] | None = None,
    resources: Mapping[str, Any] | None = None,
    precision: int = 32,
) -> Tape:
    """Return the tape of a function of a point.

    Args:
        module: The module; its entry takes a vec2 or vec3 and returns a float.
        uniforms: Values of uniforms by name; the others have their defaults.
        resources: Buffers by name: arrays with one row for each element.
        precision: The bits of constants: 32, or 64 for ``box_tape``.

    Raises:
        TapeError: The function cannot be a tape: it has loops whose length differs from point to
            point, textures, whole numbers that differ from point to point, or is too long.
    """
    scalars = Scalars(precision)
    walker = _CallFollower(module, uniforms or {}, resources or {}, scalars)
    entry = module.function(module.entry)
    size = component_count(entry.params[0].type)
    point = tuple(walker.scalars.operation(axis) for axis in "xyz"[:size])
    (result,) = walker.function(entry, [point])
    return walker.scalars.builder.tape(walker.scalars.value(result))


def followed(
    module: Module,
    args: Sequence[Scalars_],
    uniforms: Mapping[str, Scalars_],
    resources: Mapping[str, Any],
    scalars: Scalars,
) -> Scalars_:
    """Return the scalars of a function's result.

    Args:
        module: The module.
        args: The scalars of each parameter of its entry.
        uniforms: The scalars of uniforms by name; the others have their defaults.
        resources: Buffers by name: arrays with one row for each element.
        scalars: Computes with scalars.

    Raises:
        TapeError: The function has something that cannot be followed; see ``tape_of``.
    """
    walker = _CallFollower(module, {}, resources, scalars, uniforms)
    return walker.function(module.function(module.entry), args)


class _CallFollower:
    """Follows a function from its entry."""

    def __init__(
        self,
        module: Module,
        uniforms: Mapping[str, Any],
        resources: Mapping[str, Any],
        scalars: Scalars | None = None,
        known: Mapping[str, Scalars_] | None = None,
    ) -> None:
        self.scalars = scalars or Scalars()
        self._functions = {f.name: f for f in module.functions}
        self._uniforms = {
            u.name: _flat(uniforms.get(u.name, u.default), u.type) for u in module.uniforms
        }
        self._uniforms |= known or {}
        self._resources = resources
        self._constant_resources = {r.name: r.values for r in module.resources if r.values}
        self._frame: Environment = {}
        self._steps = 0
        for name, value in module.frame:
            self._frame[name] = _BodyFollower(self, {}).expression(value)

    def function(self, function: Function, args: Sequence[Scalars_]) -> Scalars_:
        """Return the result of a call."""
        names = (p.name for p in function.params)
        body = _BodyFollower(self, dict(zip(names, args, strict=True)))
        result = body.block(function.body)
        assert result is not None, function.name
        return result

    def step(self) -> None:
        """Count a statement or a call."""
        self._steps += 1
        if self._steps > _MOST_STEPS:
            raise TapeError(f"it takes more than {_MOST_STEPS} steps")

    def call(self, name: str, args: Sequence[Scalars_]) -> Scalars_:
        """Return the result of a call by name."""
        self.step()
        return self.function(self._functions[name], args)

    def uniform(self, name: str) -> Scalars_:
        """Return the value of a uniform."""
        return self._uniforms[name]

    def per_frame(self, name: str) -> Scalars_:
        """Return a value of the per-frame part."""
        return self._frame[name]

    def element(self, name: str, index: int, type: Type) -> Scalars_:
        """Return an element of a buffer."""
        rows = self._constant_resources.get(name)
        if rows is None:
            rows = self._resources.get(name)
        if rows is None:
            raise TapeError(f"it reads '{name}', whose numbers are not known")
        return _flat(rows[min(max(index, 0), len(rows) - 1)], type)

    def size(self, name: str) -> int:
        """Return the number of elements of a buffer."""
        rows = self._constant_resources.get(name, self._resources.get(name))
        if rows is None:
            raise TapeError(f"it reads the size of '{name}', which is not known")
        return len(rows)


def _flat(value: Any, type: Type) -> Scalars_:
    """Return the scalars of a value from outside."""
    numbers = np.asarray(value).reshape(-1).tolist()
    convert: dict[Kind, Callable[[Any], Scalar]]
    convert = {Kind.FLOAT: float, Kind.INT: int, Kind.UINT: int, Kind.BOOL: bool}
    return tuple(convert[k](n) for k, n in zip(leaf_kinds(type), numbers, strict=True))


class _BodyFollower(ExpressionFollower):
    """Follows the statements of one function."""

    def __init__(self, walker: _CallFollower, locals: Environment) -> None:
        super().__init__(walker, locals)
        self._calls = walker

    def block(self, body: Sequence[Stmt]) -> Scalars_ | None:
        """Follow statements; return the function's result if they end with it."""
        for i, stmt in enumerate(body):
            self._calls.step()
            match stmt:
                case Let(name, value) | Var(name, value):
                    self._locals[name] = self.expression(value)
                case Assign(target, value):
                    self._assign(target, self.expression(value))
                case Return(value):
                    return self.expression(value)
                case If():
                    if (result := self._if(stmt, body[i + 1 :])) is not None:
                        return result[0]
                case For():
                    self._for(stmt)
                case While():
                    raise TapeError("it has a loop whose length differs from point to point")
                case Break() | Continue():
                    raise TapeError("it leaves a loop early")
                case _:
                    assert_never(stmt)
        return None

    def _if(self, stmt: If, rest: Sequence[Stmt]) -> tuple[Scalars_ | None] | None:
        """Follow a condition; return the result of the function if ``rest`` is followed too."""
        (condition,) = self.expression(stmt.condition)
        if not isinstance(condition, Varying):
            return (self.block((*(stmt.then if condition else stmt.otherwise), *rest)),)
        if any(isinstance(s, Return) for s in statements_in((stmt,))):
            results = []
            for branch in (stmt.then, stmt.otherwise):
                result = self._copy().block((*branch, *rest))
                assert result is not None
                results.append(result)
            return (self._either(condition, results[0], results[1]),)
        copies = self._copy(), self._copy()
        for branch, copy in zip((stmt.then, stmt.otherwise), copies, strict=True):
            copy.block(branch)
        for name in self._locals:
            yes, no = (copy._locals[name] for copy in copies)
            if yes is not no:
                self._locals[name] = self._either(condition, yes, no)
        self._known.clear()
        return None

    def _copy(self) -> _BodyFollower:
        copy = _BodyFollower(self._calls, dict(self._locals))
        copy._known = dict(self._known)
        return copy

    def _either(self, condition: Scalar, yes: Scalars_, no: Scalars_) -> Scalars_:
        pairs = zip(yes, no, strict=True)
        return tuple(self._scalars.select(condition, a, b) for a, b in pairs)

    def _for(self, loop: For) -> None:
        (start,), (stop,) = self.expression(loop.start), self.expression(loop.stop)
        if isinstance(start, Varying) or isinstance(stop, Varying):
            raise TapeError("it has a loop whose length differs from point to point")
        for index in range(int(start), int(stop), loop.step):
            self._calls.step()
            self._locals[loop.name] = (index,)
            self._known.clear()
            self.block(loop.body)
        self._known.clear()

    def _assign(self, target: Expr, value: Scalars_) -> None:
        name, places = self._places(target)
        scalars = list(self._locals[name])
        for place, scalar in zip(places, value, strict=True):
            scalars[place] = scalar
        self._locals[name] = tuple(scalars)
        self._known.clear()

    def _places(self, target: Expr) -> tuple[str, Sequence[int]]:
        """Return the local that a target is a part of, and the positions of its scalars."""
        match target:
            case Read(name, type):
                return name, range(leaf_count(type))
            case Swizzle(base, lanes):
                name, places = self._places(base)
                return name, [places["xyzw".index(lane)] for lane in lanes]
            case Field(base, field):
                name, places = self._places(base)
                assert isinstance(base.type, Struct)
                first = field_offset(base.type, field)
                return name, places[first : first + leaf_count(target.type)]
            case Index(base, index):
                name, places = self._places(base)
                size = leaf_count(target.type)
                first = self._position(index) * size
                return name, places[first : first + size]
            case _:
                raise AssertionError(f"{target} is no target")
