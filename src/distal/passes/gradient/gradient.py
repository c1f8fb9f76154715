"""Replace each ``Gradient`` by a call of a derivative function generated from the function's code.

Input: a module whose functions have no unbound static parameters. Output: a module without
Gradient. The derivative is exact (forward mode): for each value that depends on the point, the
derivative function also computes its tangents along the point's axes, all in one evaluation
(``dual``). Functions are processed callees first, so the gradient of a function that itself
contains a Gradient is taken from the output of this pass for that function.

A derivative function is generated once for each combination of the ways its arguments change: a
parameter has a zero tangent, a constant tangent (the seeds: most primitives are called with the
point shifted), or a tangent that is passed as an argument.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from typing import TypeAlias, assert_never

from distal.ir.contents import contents
from distal.ir.nodes import (
    Call,
    Compose,
    Construct,
    Expr,
    Function,
    FunctionRef,
    Gradient,
    Module,
    Param,
    Read,
)
from distal.ir.tangents import (
    LETTERS,
    Lanes,
    Tangent,
    filled,
    from_lanes,
    is_constant,
    lanes_of,
    seeds,
)
from distal.ir.types import FLOAT, Kind, Type, tuple_type, vector_of
from distal.ir.walk import map_expressions, rewrite, roots_in
from distal.passes.call_order import in_call_order
from distal.passes.context import Context
from distal.passes.gradient.activity import Activity, FunctionActivity
from distal.passes.gradient.dual import DualBody, Returned, Version, tangent_name
from distal.passes.naming import FreshNames, local_names


class _Form(Enum):
    """The result of a derivative function; the value of a member is the suffix of its name."""

    DUAL = "dual"  # a tuple: the value, then the nonzero tangents
    GRADIENT = "gradient"  # the gradient at the point
    BOTH = "value_and_gradient"  # the tuple (value, gradient)


class _Anything(Enum):
    """Marks a tangent that is passed as an argument."""

    ANYTHING = "anything"


# For each parameter and direction: None (zero), a constant tangent, or ANYTHING (passed as an
# argument); if some components are zero, a tuple with None or ANYTHING for each component.
_Change: TypeAlias = Expr | _Anything | tuple[_Anything | None, ...] | None
_Key: TypeAlias = tuple[str, _Form, tuple[tuple[_Change, ...], ...]]


def run(module: Module, context: Context) -> Module:
    """Replace every Gradient in the module."""
    if not any(Gradient in contents(e).kinds for f in module.functions for e in roots_in(f.body)):
        return module
    derived = _Derived(module)
    for function in module.functions:
        derived.add(_without_gradients(function, derived))
    functions = in_call_order(derived.functions.values(), module.entry)
    return replace(module, functions=functions)


def _without_gradients(function: Function, derived: _Derived) -> Function:
    memo: dict[Expr, Expr] = {}

    def replaced(e: Expr) -> Expr:
        if not isinstance(e, Gradient):
            return e
        assert isinstance(e.function, FunctionRef)
        name = derived.gradient(e.function.name, e.point.type, with_value=e.with_value)
        return Call(name, (e.point, *e.function.captures), e.type, span=e.span)

    def without(e: Expr) -> Expr:
        return rewrite(e, replaced, memo) if Gradient in contents(e).kinds else e

    body = map_expressions(function.body, without)
    return replace(function, body=body)


@dataclass(slots=True)
class _DerivativeFunction:
    """A finished derivative function.

    Attributes:
        name: Its name; that of the function itself if all its tangents are constant.
        directions: The directions whose tangents it returns.
        constants: The tangents that are constant, for each direction; it does not return them.
    """

    name: str
    directions: int
    constants: Lanes


@dataclass(slots=True)
class _Differentiated:
    """A derivative function, and the tangents at each of its Returns."""

    function: Function
    returned: list[Lanes]


class _Derived:
    """The functions processed so far, without Gradient, and their derivative functions."""

    def __init__(self, module: Module) -> None:
        self.functions: dict[str, Function] = {}
        self._names = FreshNames(f.name for f in module.functions)
        self._activity = Activity(self.functions)
        self._made: dict[_Key, _DerivativeFunction] = {}

    def add(self, function: Function) -> None:
        """Add a function whose callees were already added."""
        self.functions[function.name] = function

    def gradient(self, name: str, point: Type, *, with_value: bool) -> str:
        """Return the function that computes the gradient of ``name`` along its first parameter.

        Args:
            name: The function to differentiate.
            point: The type of its first parameter.
            with_value: Whether the function also returns the value.
        """
        axes = seeds(point)
        still = (None,) * len(axes)
        others = self.functions[name].params[1:]
        form = _Form.BOTH if with_value else _Form.GRADIENT
        return self._version(name, form, (axes, *(still for _ in others))).name

    def dual(self, name: str, tangents: tuple[Lanes, ...]) -> Version:
        """Return the derivative function for a call: name, directions and tangents to pass."""
        key = tuple(tuple(map(_change, along)) for along in tangents)
        made = self._version(name, _Form.DUAL, key)
        passed = [
            part
            for along, changes in zip(tangents, key, strict=True)
            for tangent, change in zip(along, changes, strict=True)
            for part in _passed(tangent, change)
        ]
        return Version(made.name, made.directions, made.constants, tuple(passed))

    def _version(
        self, name: str, form: _Form, changes: tuple[tuple[_Change, ...], ...]
    ) -> _DerivativeFunction:
        key = (name, form, changes)
        found = self._made.get(key)
        if found is None:
            found = self._made[key] = self._make(name, form, changes)
        return found

    def _make(
        self, name: str, form: _Form, changes: tuple[tuple[_Change, ...], ...]
    ) -> _DerivativeFunction:
        original = self.functions[name]
        masks = tuple(
            sum(1 << k for k, change in enumerate(along) if change is not None) for along in changes
        )
        activity = self._activity.of(name, masks)
        count = len(changes[0])
        directions = activity.result
        known: Lanes = (None,) * count
        made = self._differentiated(original, form, changes, activity, directions)
        if form is _Form.DUAL:
            known = _constants(made.returned, directions)
        if any(known):
            # A shifted point changes as the point does: its tangents are known to the callers.
            directions = sum(1 << k for k in range(count) if directions >> k & 1 and not known[k])
            if not directions:
                return _DerivativeFunction(name, 0, known)
            made = self._differentiated(original, form, changes, activity, directions)
        new = self._names.fresh(f"{name}_{form.value}")
        self.functions[new] = replace(made.function, name=new)
        return _DerivativeFunction(new, directions, known)

    def _differentiated(
        self,
        original: Function,
        form: _Form,
        changes: tuple[tuple[_Change, ...], ...],
        activity: FunctionActivity,
        directions: int,
    ) -> _Differentiated:
        """Return a derivative function that is not named yet.

        Args:
            original: The function to differentiate.
            form: The form of the result.
            changes: How each parameter changes along each direction.
            activity: The locals that change.
            directions: The directions whose tangents are returned.
        """
        names = FreshNames(local_names(original))
        extra: list[Param] = []
        tangents = {
            param.name: _parameter_tangents(param, along, names, extra)
            for param, along in zip(original.params, changes, strict=True)
        }
        count = len(changes[0])
        result, pack = _returned(original.result, form, directions, count)
        returned: list[Lanes] = []

        def noted(value: Expr, along: Lanes) -> Expr:
            returned.append(along)
            return pack(value, along)

        body = DualBody(self.dual, names, activity, tangents, count)
        function = replace(
            original,
            params=(*original.params, *extra),
            result=result,
            body=body.function_body(original.body, noted),
        )
        return _Differentiated(function, returned)


def _constants(returns: list[Lanes], directions: int) -> Lanes:
    """Return the tangents that are the same constant at every Return; None for the others."""
    return tuple(
        along[0]
        if directions >> k & 1
        and along[0] is not None
        and is_constant(along[0])
        and all(t is along[0] for t in along)
        else None
        for k, along in enumerate(zip(*returns, strict=True))
    )


def _change(tangent: Tangent) -> _Change:
    if tangent is None or is_constant(tangent):
        return tangent
    lanes = lanes_of(tangent)
    if lanes is None:
        return _Anything.ANYTHING
    return tuple(None if lane is None else _Anything.ANYTHING for lane in lanes)


def _passed(tangent: Tangent, change: _Change) -> tuple[Expr, ...]:
    """Return the parts of a tangent that a call passes.

    The parts that are built into the derivative function (zero or constant) are left out.
    """
    if tangent is None or not isinstance(change, _Anything | tuple):
        return ()
    if isinstance(change, tuple):
        return tuple(lane for lane in lanes_of(tangent) or () if lane is not None)
    return (tangent,)


def _parameter_tangents(
    param: Param, along: tuple[_Change, ...], names: FreshNames, extra: list[Param]
) -> Lanes:
    """Return a parameter's tangents; append a parameter to ``extra`` for each that is passed."""
    found: list[Tangent] = []
    for k, change in enumerate(along):
        wanted = tangent_name(param.name, k, len(along))
        if isinstance(change, _Anything):
            found.append(_parameter(wanted, param.type, names, extra))
        elif isinstance(change, tuple):
            lanes = (
                None if lane is None else _parameter(f"{wanted}_{letter}", FLOAT, names, extra)
                for lane, letter in zip(change, LETTERS, strict=False)
            )
            found.append(from_lanes(tuple(lanes), param.type))
        else:
            found.append(change)
    return tuple(found)


def _parameter(wanted: str, type: Type, names: FreshNames, extra: list[Param]) -> Expr:
    name = names.fresh(wanted)
    extra.append(Param(name, type))
    return Read(name, type)


def _returned(value_type: Type, form: _Form, directions: int, count: int) -> tuple[Type, Returned]:
    """Return the result type of a derivative function, and how to build the result at a Return."""
    point = vector_of(Kind.FLOAT, count)

    def gradient(tangents: Lanes) -> Expr:
        parts = tuple(filled(t, FLOAT) for t in tangents)
        return parts[0] if count == 1 else Compose(parts, point)

    match form:
        case _Form.DUAL:
            kept = [k for k in range(count) if directions >> k & 1]
            items = tuple_type((value_type,) * (1 + len(kept)))
            return items, lambda value, tangents: Construct(
                (value, *(filled(tangents[k], value_type) for k in kept)), items
            )
        case _Form.GRADIENT:
            return point, lambda _, tangents: gradient(tangents)
        case _Form.BOTH:
            both = tuple_type((FLOAT, point))
            return both, lambda value, tangents: Construct((value, gradient(tangents)), both)
        case _:
            assert_never(form)
