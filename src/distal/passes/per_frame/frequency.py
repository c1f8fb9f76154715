"""Frequency: compute once per frame what is the same in every pixel.

Input: a module without function values. Output: the same functions, which read values of
``Module.frame`` in place of computations that depend on uniforms and constants only.

The pass works across functions, and keeps them:

- a parameter that is the same per-frame value at every call is replaced by that value;
- in a function, work on parameters that are per frame at every call becomes a new parameter, which
  the callers compute, and so on up to the entry: ``turn(p, 0.8 * time)``, which takes a sine and a
  cosine, becomes ``turn(p, c, s)`` when other calls turn by another angle;
- what then depends on uniforms and constants only becomes a value of ``Module.frame``. Values
  that no function reads are intermediate steps of later values.

Work is moved out of branches too: once per frame it costs next to nothing, and no operation traps.

The vertex stage can pass 15 vectors of four components. If that is not enough, the values that save
most work for each component are passed, and the others are computed at the start of each function
that reads them. ``Module.frame`` lists the values that are passed.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Final

from distal.ir.contents import contents
from distal.ir.kept import kept
from distal.ir.nodes import Call, Construct, Expr, Field, Function, Module, Param, Read, Uniform
from distal.ir.target import FramePlace
from distal.ir.types import Struct, Type
from distal.ir.walk import children, rebuild, roots_in
from distal.passes.context import Context
from distal.passes.cost import Costs, function_costs
from distal.passes.naming import FreshNames, local_names
from distal.passes.per_frame.choice import Picking
from distal.passes.per_frame.expand import Expansion
from distal.passes.per_frame.finish import finished
from distal.passes.per_frame.forms import FlowWalk, Forming, Here, hoistable_calls
from distal.passes.per_frame.values import (
    LEAST_COST,
    FrameValues,
    NameHint,
    is_carried,
    is_exploded,
    suggestion,
)

VERTEX_LIMIT: Final = 60  # components; WebGL 2 guarantees 15 vectors between the stages


def run(module: Module, context: Context) -> Module:
    """Move per-frame work into the per-frame part, if the target has one."""
    place = context.target.frame
    if place is FramePlace.NONE:
        return module
    hoisting = _Hoisting(module, context)
    functions = hoisting.functions()
    limit = VERTEX_LIMIT if place is FramePlace.VERTEX else None
    return finished(module, functions, hoisting.frame_values, limit, context.precision)


@dataclass(slots=True)
class _Calls:
    """The arguments that the calls of a function in pixel code pass."""

    # The forms of each parameter's arguments in the callers; None if a caller's argument has none.
    args: list[list[Expr] | None]
    rate: int = 0  # approximate number of calls for one pixel
    # Parameters added for work that the callers do: form over the parameters -> name.
    added: dict[Expr, str] = field(default_factory=dict)

    def forms(self, params: tuple[Param, ...]) -> dict[str, Expr]:
        """Return the form of each parameter that is per frame at every call."""
        found: dict[str, Expr] = {}
        for param, forms in zip(params, self.args, strict=True):
            if forms and _may_travel(param.type):
                agreed = len(set(forms)) == 1 and not _leaves(forms[0], Read)
                found[param.name] = forms[0] if agreed else Read(param.name, param.type)
        return found


def _leaves(form: Expr, *classes: type) -> bool:
    return not contents(form).kinds.isdisjoint(classes)


def _may_travel(type: Type) -> bool:
    return is_carried(type) or is_exploded(type)


@dataclass(frozen=True, slots=True)
class _Learned:
    """What the pass finds in a function.

    Attributes:
        calls: The calls that stay in pixel code: callee, rate, the forms of its arguments.
        picks: Whether anything in it is computed once per frame.
    """

    calls: tuple[tuple[str, int, tuple[Expr | None, ...]], ...]
    picks: bool


@kept
def _learn(
    function: Function,
    params: tuple[tuple[str, Expr], ...],
    costs: tuple[tuple[str, int], ...],
    callable: frozenset[str],
    precision: int,
) -> _Learned:
    """Find the calls in a function that pixels make, and whether it has per-frame work.

    Args:
        function: The function.
        params: The forms of its parameters.
        costs: The costs of the functions that it, or a form, calls.
        callable: Those of them that may run once per frame.
        precision: As for ``Forming``.
    """
    picking = Picking(function, Costs(dict(costs)))
    found: list[tuple[str, int, tuple[Expr | None, ...]]] = []

    def visit(e: Expr, here: Here) -> Expr:
        for call in picking.calls(e, here):
            found.append((call.function, here.rate, tuple(here.form(a) for a in call.args)))
        return e

    FlowWalk(function, dict(params), Forming(precision, callable), visit).run()
    return _Learned(tuple(found), picking.has_picked)


class _Hoisting:
    """Runs the pass on one module: callers first to collect, callees first to rewrite."""

    def __init__(self, module: Module, context: Context) -> None:
        self._module = module
        self.costs = Costs(function_costs(module.functions))
        self._hoistable = hoistable_calls(module.functions)
        self.forming = Forming(context.precision, self._hoistable)
        self._learned: dict[str, _Learned] = {}
        self.expansion = Expansion(module.functions, self.forming, self.costs)
        self.frame_values = FrameValues(self.costs, self.expansion.names)
        self.keeps_constants = not context.target.inline
        self.params = {f.name: f.params for f in module.functions}
        self.calls: dict[str, _Calls] = {}
        self._pickings: dict[str, Picking] = {}

    def picking(self, function: Function) -> Picking:
        """Return the decisions for a function of the module."""
        found = self._pickings.get(function.name)
        if found is None:
            found = self._pickings[function.name] = Picking(function, self.costs)
        return found

    def functions(self) -> tuple[Function, ...]:
        """Return the functions that pixels run, rewritten."""
        entry = self._module.function(self._module.entry)
        self.calls[entry.name] = _Calls([None] * len(entry.params), 1)
        for function in reversed(self._module.functions):
            if function.name in self.calls:
                self._learn(function)
        return tuple(self._rewritten(f) for f in self._module.functions if f.name in self.calls)

    def _rewritten(self, function: Function) -> Function:
        """Return a function without its per-frame work; most functions of the library have none."""
        learned = self.learned(function)
        is_plain = not learned.picks and not any(self.calls[c].added for c, _, _ in learned.calls)
        if is_plain and not any(
            self._is_replaced(n, e) for n, e in self.forms_of(function).items()
        ):
            return function
        return _Rewriting(self, function).function()

    def _is_replaced(self, name: str, form: Expr) -> bool:
        """Whether reads of a parameter with this form become something else."""
        if isinstance(form, Read) and form.name == name:
            return False
        return is_carried(form.type) and not (self.keeps_constants and not _leaves(form, Uniform))

    def _learn(self, function: Function) -> None:
        """Record the arguments of the calls that stay in a function's pixel code."""
        heat = self.calls[function.name].rate
        learned = self.learned(function)
        for callee, rate, args in learned.calls:
            known = self.calls.setdefault(callee, _Calls([[] for _ in args]))
            known.rate += heat * rate
            for i, form in enumerate(args):
                forms = known.args[i]
                if form is None or forms is None:
                    known.args[i] = None
                else:
                    forms.append(form)

    def learned(self, function: Function) -> _Learned:
        """Return what the pass finds in a function, which it may have found in another program."""
        found = self._learned.get(function.name)
        if found is None:
            forms = tuple(self.forms_of(function).items())
            asked = dict.fromkeys(
                name
                for e in (*roots_in(function.body), *(form for _, form in forms))
                for name in contents(e).callees
            )
            calls = tuple((n, self.costs.calls[n]) for n in asked if n in self.costs.calls)
            callable = frozenset(n for n in asked if n in self._hoistable)
            found = _learn(function, forms, calls, callable, self.forming.precision)
            self._learned[function.name] = found
        return found

    def forms_of(self, function: Function) -> dict[str, Expr]:
        """Return the forms of a function's parameters."""
        return self.calls[function.name].forms(function.params)


class _Rewriting:
    """Rewrites the pixel code of one function without its per-frame work."""

    def __init__(self, hoisting: _Hoisting, function: Function) -> None:
        self._hoisting = hoisting
        self._function = function
        self._picking = hoisting.picking(function)
        self._calls = hoisting.calls[function.name]
        self._params = hoisting.forms_of(function)
        self._names = FreshNames(local_names(function))
        self._memo: dict[Expr, Expr] = {}

    def function(self) -> Function:
        """Return the rewritten function with the parameters that were added for its work."""
        walk = FlowWalk(self._function, self._params, self._hoisting.forming, self._visit)
        rewritten = walk.run()
        added = tuple(Param(name, form.type) for form, name in self._calls.added.items())
        return replace(rewritten, params=(*rewritten.params, *added))

    def _visit(self, root: Expr, here: Here) -> Expr:
        self._memo = {}
        if here.name is not None and self._picking.picks(root, here):
            return self._computed(root, here, NameHint(here.name, 2))
        return self._rewritten(root, here)

    def _computed(self, e: Expr, here: Here, hint: NameHint | None = None) -> Expr:
        form = here.form(e)
        assert form is not None
        return self._carried(form, hint or suggestion(form), here.rate * self._calls.rate)

    def _rewritten(self, e: Expr, here: Here) -> Expr:
        done = self._memo.get(e)
        if done is None:
            done = self._memo[e] = self._node(e, here)
        return done

    def _node(self, e: Expr, here: Here) -> Expr:
        if self._picking.picks(e, here):
            if isinstance(e, Read):
                return self._computed(e, here, NameHint(e.name, 1 if e.name in self._params else 2))
            return self._computed(e, here)
        if isinstance(e, Read):
            return self._param(e)
        changed = rebuild(e, tuple([self._rewritten(c, here) for c in children(e)]))
        if isinstance(e, Call) and isinstance(changed, Call):
            return self._call(e, changed.args, here)
        return changed

    def _param(self, e: Read) -> Expr:
        """Replace a parameter by its value if that is per frame, cheap and equal at every call."""
        form = self._params.get(e.name)
        if form is None or form is e or not is_carried(e.type):
            return e
        if self._hoisting.keeps_constants and not _leaves(form, Uniform):
            # A number that the author passes is easier to read as an argument.
            return e
        # The value is never a call, whose callee could come after this function.
        return self._carried(form, NameHint(e.name, 1), self._calls.rate)

    def _call(self, call: Call, args: tuple[Expr, ...], here: Here) -> Expr:
        """Return a call that stays, with arguments for the parameters that its callee added."""
        callee = self._hoisting.calls[call.function]
        if not callee.added:
            return Call(call.function, args, call.type, span=call.span)
        forms: dict[str, Expr] = {}
        for param, arg in zip(self._hoisting.params[call.function], call.args, strict=True):
            form = here.form(arg)
            if form is not None:
                forms[param.name] = form
        rate = here.rate * self._calls.rate
        work = tuple(
            self._carried(self._hoisting.forming.replaced(form, forms), NameHint(name, 1), rate)
            for form, name in callee.added.items()
        )
        return Call(call.function, (*args, *work), call.type, span=call.span)

    def _carried(self, form: Expr, hint: NameHint, rate: int) -> Expr:
        """Return an expression for a form: read from the frame, passed by callers, or computed."""
        if not _leaves(form, Read):
            form = self._hoisting.expansion.expanded(form)
        if isinstance(form.type, Struct):
            parts = []
            for field_name, type in form.type.fields:
                part = self._hoisting.forming.simplified(Field(form, field_name, type))
                parts.append(self._carried(part, hint.part(field_name), rate))
            return Construct(tuple(parts), form.type)
        if self._hoisting.costs.of(form) < LEAST_COST and not _leaves(form, Call):
            return form
        if not _leaves(form, Read):
            return self._hoisting.frame_values.read(form, hint, rate)
        name = self._calls.added.get(form)
        if name is None:
            name = self._calls.added[form] = self._names.fresh(hint.name or "per_frame")
        return Read(name, form.type)
