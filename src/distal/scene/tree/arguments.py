"""Conversion of Python arguments to values for a scene function's parameters.

Input: scene functions (of ``fields``, ``render`` or the author), positional and keyword arguments,
limits. Output: checked ``Number``s, choices, textures and buffers by name. Every mistake is
reported at the author's line with a hint. Does not depend on what the functions compute.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import ModuleType
from typing import Any, Final, NoReturn, TypeAlias
from weakref import WeakKeyDictionary

from distal.diagnostics import CompileError, Span
from distal.error_codes import ErrorCode
from distal.fields.guarantees import BOUNDS_OF_CHILDREN, FIXED_CHOICES, Limit, Requirement
from distal.frontend.problems import did_you_mean
from distal.frontend.signatures.annotations import AnnotationError, UnboundVariableError, to_type
from distal.frontend.signatures.signatures import MISSING, read_signature
from distal.ir.nodes import Uniform
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    Buffer,
    Kind,
    Struct,
    Texture,
    Type,
    Vector,
)
from distal.lang.expressions import Expression, Symbolic
from distal.lang.functions import Func
from distal.lang.resources import Buffer as LangBuffer
from distal.lang.resources import TextureValue
from distal.lang.runtime_access import executor
from distal.scene.tree.conversion import (
    Asked,
    Number,
    Plain,
    choice,
    is_plain_scalar,
    is_scalar,
    number,
    plain_float,
    plain_floats,
    plain_number,
    resource,
    type_name,
    unwrapped,
)
from distal.scene.tree.errors import refuse, refuse_kind
from distal.scene.tree.former_names import FORMERLY_FIRST, hints_by_name, renamed, solid_of
from distal.scene.tree.varying import VaryingNumber, varying_or_same
from distal.scene.tree.whole_numbers import whole_ends
from distal.session import SESSION

# The value of a parameter; may be another object, such as a pattern, if the caller accepts it.
Given: TypeAlias = "Number | int | bool | TextureValue | LangBuffer | Any"
# Converts a value for the requested parameter, or returns None to treat it as a number.
Accept: TypeAlias = Callable[[Any, Asked], Any]

# Parameter names with a fixed meaning (``fields.guarantees``): they are not numbers of a shape.
RESERVED: Final = BOUNDS_OF_CHILDREN | {"p", "d", "a", "b", "field", "cell", "copies"}
# The reserved names of an author's own shape: it has no children, so ``a`` or ``d`` are free.
RESERVED_OF_SHAPES: Final = RESERVED - {"a", "b", "d", "copies"}
# For these parameters one number sets all components.
SPLATTED: Final = frozenset(
    ("size", "half_size", "spacing", "factor", "scale", "radii", "sizes", "margin")
)
_LETTERS: Final = "xyzw"
_SCALARS: Final = (float, int)
_SEQUENCES: Final = (tuple, list)


@dataclass(frozen=True, slots=True)
class FunctionParameter:
    """A parameter of a scene function; ``type`` is None if each call decides it."""

    name: str
    type: Type | None
    default: Any
    by_name: bool = False  # whether it is passed by name only
    is_vector: bool = field(init=False)  # whether several scalars may be passed for it
    is_named_color: bool = field(init=False)  # whether its name is that of a color
    size: int = field(init=False)  # its number of floats; 0 for what needs other conversions
    plain_default: Any = field(init=False)  # the default as numbers; MISSING if there is none

    def __post_init__(self) -> None:
        is_vector = isinstance(self.type, Vector) and self.type.kind is Kind.FLOAT
        is_named_color = self.name == "color" or self.name.endswith("_color")
        size = int(self.type is FLOAT)
        if isinstance(self.type, Vector) and is_vector:
            size = self.type.size
        if is_named_color and size == 1:
            size = 0  # not converted quickly
        object.__setattr__(self, "is_vector", is_vector)
        object.__setattr__(self, "is_named_color", is_named_color)
        object.__setattr__(self, "size", size)
        object.__setattr__(self, "plain_default", unwrapped(self.default) if size else MISSING)

    @property
    def is_number(self) -> bool:
        """Whether the parameter is a float or a vector of floats."""
        return self.type is FLOAT or self.is_vector


_slots: WeakKeyDictionary[Func, tuple[FunctionParameter, ...]] = SESSION.keep(
    "parameters", WeakKeyDictionary()
)


def slots_of(func: Func) -> tuple[FunctionParameter, ...]:
    """Return the parameters of a function's first overload.

    Raises:
        CompileError: The signature is not valid scene code.
    """
    found = _slots.get(func)
    if found is None:
        header = read_signature(func.overloads[0])
        if header.problems:
            raise CompileError(header.problems)
        made = []
        for slot in header.parameters:
            try:
                type: Type | None = to_type(slot.annotation)
            except UnboundVariableError:
                type = None
            except AnnotationError as error:
                raise CompileError.at(
                    ErrorCode.OBJECT, error.message, slot.span, error.hint
                ) from None
            made.append(FunctionParameter(slot.name, type, slot.default, not slot.positional))
        found = _slots[func] = tuple(made)
    return found


def arguments(
    functions: Func | Iterable[Func],
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    *,
    what: str,
    limits: Mapping[str, Limit] | None = None,
    requires: Requirement | None = None,
    place: Span | None = None,
    reserved: Collection[str] = RESERVED,
    colors: Collection[str] = (),
    accept: Accept | None = None,
    changing: bool = False,
    varies: frozenset[str] = frozenset(),
    endless: Collection[str] = (),
) -> dict[str, Given]:
    """Return the values of functions' parameters by name, in the order of the parameters.

    Parameters of the same name in several functions are one parameter.

    Args:
        functions: Scene functions.
        args: Arguments by position.
        kwargs: Arguments by name. ``x=``, ``y=``, ``z=`` set the components of a vector if only one
            parameter is a vector.
        what: The name in messages of the object that is made: "Sphere".
        limits: The limit of each number.
        requires: Returns why numbers contradict each other, or None. Called with plain values by
            name, and with the default of a parameter that can change; not called if one of its
            numbers is computed.
        place: The author's line.
        reserved: Names of parameters that the author does not set.
        colors: Parameters that accept "#rrggbb" and names; ``color`` and ``…_color`` always do.
        accept: Accepts objects that are not numbers.
        changing: Whether ints and bools may be parameters, but for those of ``FIXED_CHOICES``.
        varies: What numbers may depend on besides parameters and time: "cell", "p". Those that do
            become ``VaryingNumber``s.
        endless: Parameters whose components may be infinite.

    Raises:
        SceneTypeError: An argument is unknown, missing, passed twice, surplus, or of the wrong
            type.
        SceneValueError: A number is not finite, is beyond its limit, or contradicts others.
    """
    listed = (functions,) if isinstance(functions, Func) else tuple(functions)
    slots = _number_slots(listed, frozenset(reserved))
    first = FORMERLY_FIRST.get(what) if args else None
    if first is not None and first not in kwargs:
        binding = _ArgumentBinding(slots, what, place)
        binding.take_keywords(kwargs)
        binding.refuse_former_order(first)
    plain = _plain_values(slots, args, kwargs, limits or {}, colors)
    if plain is not None:
        if requires is not None:
            _check_together(requires, plain, what, place)
        return plain
    given = _bound_quickly(slots, args, kwargs)
    if given is None:
        binding = _ArgumentBinding(slots, what, place)
        binding.take_keywords(kwargs)
        binding.take_positional(args)
        given = {slot.name: binding.value_of(slot) for slot in slots}
    values: dict[str, Given] = {}
    for slot in slots:
        name = slot.name
        limit = limits.get(name, Limit.ANY) if limits else Limit.ANY
        is_color = takes_color(name, colors)
        value: Given | None = plain_number(given[name], slot.type, limit, is_color=is_color)
        if value is None:
            known = _known_type(slot, what, place)
            fixed = not changing or name in FIXED_CHOICES
            asked = Asked(
                name,
                what,
                known,
                limit,
                is_color,
                name in SPLATTED,
                place,
                fixed,
                varies,
                name in endless,
            )
            value = _value(given[name], asked, accept)
            if varies and isinstance(value, Number) and isinstance(value.value, Expression):
                value = varying_or_same(value, name)
        values[name] = value
    if requires is not None:
        _check_together(requires, values, what, place)
    return values


def _plain_values(
    slots: tuple[FunctionParameter, ...],
    args: Sequence[Any],
    kwargs: Mapping[str, Any],
    limits: Mapping[str, Limit],
    colors: Collection[str],
) -> dict[str, Given] | None:
    """Return the values if all arguments are plain floats, or tuples or lists of them.

    None for all others, including those that are wrong: ``arguments`` converts or reports them. A
    loop makes 10,000 parts of plain numbers; this takes half of the time.

    Args:
        slots: The parameters.
        args: Arguments by position.
        kwargs: Arguments by name.
        limits: The limit of each number.
        colors: Parameters that accept colors as text.
    """
    values: dict[str, Given] = {}
    at, count, left = 0, len(args), len(kwargs)
    for slot in slots:
        name, size, type_ = slot.name, slot.size, slot.type
        if at < count:
            value = args[at]
            if name in kwargs or slot.by_name:
                return None
            if size > 1 and is_plain_scalar(value):
                value = args[at : at + size]
                at += size
            else:
                at += 1
        elif name in kwargs:
            value = kwargs[name]
            left -= 1
        else:
            value = slot.plain_default
        limit = limits.get(name, Limit.ANY)
        found: Plain | None
        if size > 1:
            is_color = slot.is_named_color or name in colors
            found = plain_floats(value, size, limit, is_color=is_color)
        elif size == 1 and name not in colors:
            found = plain_float(value, limit)
        else:
            return None
        if found is None or type_ is None:
            return None
        values[name] = Number(type_, found)
    return None if left or at < count else values


def _bound_quickly(
    slots: tuple[FunctionParameter, ...], args: Sequence[Any], kwargs: Mapping[str, Any]
) -> dict[str, Any] | None:
    """Return the arguments by name if they are of the usual forms, which need no search.

    None for all others, including those that are wrong. A loop binds the arguments of 10,000
    parts; this takes a third of the time of ``_ArgumentBinding``.
    """
    given = dict(kwargs)
    at, count = 0, len(args)
    for slot in slots:
        name = slot.name
        if at == count:
            if name not in given:
                if slot.default is MISSING:
                    return None
                given[name] = slot.default
            continue
        value = args[at]
        if name in given or slot.by_name:
            return None
        if slot.is_vector and type(value) not in _SCALARS:
            value = unwrapped(value)
        if not slot.is_vector or type(value) in _SEQUENCES:
            given[name] = value
            at += 1
            continue
        size = _size(slot)
        given[name] = components = tuple(args[at : at + size])
        if len(components) < size or not all([is_plain_scalar(c) for c in components]):
            return None
        at += size
    return given if at == count and len(given) == len(slots) else None


def takes_color(name: str, colors: Collection[str]) -> bool:
    """Return whether a parameter accepts colors as text: by its name, or by ``colors``."""
    return name in colors or name == "color" or name.endswith("_color")


@lru_cache(maxsize=1024)
def _number_slots(
    functions: tuple[Func, ...], reserved: frozenset[str]
) -> tuple[FunctionParameter, ...]:
    """Return the parameters of all functions that are numbers or choices, each name once."""
    found: dict[str, FunctionParameter] = {}
    for func in functions:
        for slot in slots_of(func):
            if slot.name in reserved:
                continue
            known = found.setdefault(slot.name, slot)
            if known.default is MISSING and slot.default is not MISSING:
                found[slot.name] = replace(known, default=slot.default)
    return tuple(found.values())


def _known_type(slot: FunctionParameter, what: str, place: Span | None) -> Type:
    usable = slot.is_number or slot.type in (INT, BOOL)
    if not usable and not isinstance(slot.type, Texture | Buffer | Struct):
        kind = "no one type" if slot.type is None else f"the type {slot.type}"
        refuse_kind(
            f"'{slot.name}' of {what} has {kind}, which cannot be given from Python",
            "numbers are float, vec2, vec3 or vec4; choices int or bool",
            place,
        )
    assert slot.type is not None
    return slot.type


def _value(given: Any, asked: Asked, accept: Accept | None) -> Given:
    if accept is not None:
        accepted = accept(given, asked)
        if accepted is not None:
            return accepted
    match asked.type:
        case Texture() | Buffer():
            return resource(given, asked)
        case Struct(name):
            refuse_kind(
                f"'{asked.label}' takes a {name}, not {type_name(given)} {given!r:.40}",
                place=asked.place,
            )
        case _:
            whole = asked.type in (INT, BOOL)
            return choice(given, asked) if whole else number(given, asked)


@dataclass(slots=True)
class _ArgumentBinding:
    """The assignment of arguments to parameters."""

    slots: tuple[FunctionParameter, ...]
    what: str
    place: Span | None
    given: dict[str, Any] = field(default_factory=dict)

    def _wrong(self, message: str, hint: str | None = None) -> NoReturn:
        refuse_kind(message, hint, self.place)

    def _listed(self) -> str:
        first = next((i for i, s in enumerate(self.slots) if s.by_name), len(self.slots))
        names = [s.name for s in self.slots]
        return ", ".join([*names[:first], *["*"] * (first < len(names)), *names[first:]])

    def _refuse_modules(self, given: Iterable[Any]) -> None:
        for module in (arg for arg in given if isinstance(arg, ModuleType)):
            hint = "from distal import time" if module.__name__ == "time" else None
            self._wrong(f"{self.what} takes no module, and '{module.__name__}' is one", hint)

    # By name

    def take_keywords(self, kwargs: Mapping[str, Any]) -> None:
        """Assign the arguments by name."""
        self._refuse_modules(kwargs.values())
        names = {s.name for s in self.slots}
        vectors = [s for s in self.slots if s.is_vector]
        parts: dict[str, Any] = {}
        for name, value in kwargs.items():
            if name in names:
                self.given[name] = value
            elif len(vectors) == 1 and name in _LETTERS[: _size(vectors[0])]:
                parts[name] = value
            else:
                takes = f"it takes {self._listed()}" if names else "it takes no numbers"
                letters = _LETTERS[: _size(vectors[0])] if len(vectors) == 1 else ""
                if letters:
                    takes += f"; {', '.join(letters)} are parts of '{vectors[0].name}'"
                near = did_you_mean(name, {*names, *letters})
                hint = renamed(self.what, name) or near or solid_of(self.what) or takes
                self._wrong(f"{self.what} has no '{name}'", hint)
        if parts:
            self._take_parts(vectors[0], parts)

    def _take_parts(self, slot: FunctionParameter, parts: Mapping[str, Any]) -> None:
        if slot.name in self.given:
            self._wrong(f"{self.what} got '{slot.name}' and its part '{next(iter(parts))}' too")
        rest = _parts_of_default(slot)
        self.given[slot.name] = tuple(
            parts.get(letter, rest[i]) for i, letter in enumerate(_LETTERS[: len(rest)])
        )

    # By position

    def take_positional(self, args: Sequence[Any]) -> None:
        """Assign the arguments by position."""
        left = list(args)
        self._refuse_modules(args)
        slots = [slot for slot in self.slots if not slot.by_name]
        for slot in slots:
            if not left:
                return
            if slot.name in self.given:
                self._wrong(
                    f"{self.what} got '{slot.name}' twice, by its name and by its position",
                    "give what follows it by name too",
                )
            taken = self._gathered(slot, left) if slot.is_vector else 0
            if taken:
                self.given[slot.name] = tuple(left[:taken])
                del left[:taken]
            else:
                self.given[slot.name] = left.pop(0)
        if left:
            if not self.slots:
                self._wrong(f"{self.what} takes no numbers")
            if len(slots) < len(self.slots):
                self._wrong(*self._by_name_only(slots))
            last = slots[-1]
            message = f"{self.what} takes nothing after '{last.name}'"
            hint = solid_of(self.what) or f"it takes {self._listed()}"
            if last.is_vector and last.name in SPLATTED and is_scalar(left[0]):
                letters = ", ".join(_LETTERS[: _size(last)])
                hint = f"'{last.name}' is one number for all, or {letters}"
            self._wrong(message, hint)

    def _by_name_only(self, slots: Sequence[FunctionParameter]) -> tuple[str, str]:
        """Return the message and the hint for numbers by position that are passed by name."""
        after = f"after '{slots[-1].name}'" if slots else "by position"
        named = hints_by_name(self.what, [slot.name for slot in self.slots if slot.by_name])
        return f"{self.what} takes nothing {after}", f"by name: {', '.join(named)}"

    def refuse_former_order(self, first: str) -> NoReturn:
        """Refuse numbers by position that may be in the former order, which meant another shape.

        They are in the order of now if ``first``, which was first, is passed by its name.
        """
        message = f"{self.what} takes '{first}' by name if others are given by position"
        self._wrong(message, f"it takes {self._listed()}")

    def _gathered(self, slot: FunctionParameter, left: Sequence[Any]) -> int:
        """Return how many scalars make up a vector; 0 if it is passed as one value."""
        size = _size(slot)
        scalars = 0
        while scalars < min(size, len(left)) and is_scalar(left[scalars]):
            scalars += 1
        if scalars == size:
            return size
        if scalars == 0 or slot.name in SPLATTED or (scalars == 1 and len(left) > 1):
            return 0
        if "color" in slot.name:  # one number is a grey
            return 0
        letters = ", ".join(_LETTERS[:size])
        given = "one number" if scalars == 1 else f"{scalars} numbers"
        self._wrong(
            f"'{slot.name} of {self.what}' takes {letters}, not {given}",
            f"give {letters}, one vector, or parts by name: x=…",
        )

    def value_of(self, slot: FunctionParameter) -> Any:
        """Return the argument of a parameter, or its default."""
        if slot.name in self.given:
            return self.given[slot.name]
        if slot.default is MISSING:
            self._wrong(f"{self.what} needs '{slot.name}'", f"it takes {self._listed()}")
        return slot.default


def _size(slot: FunctionParameter) -> int:
    assert isinstance(slot.type, Vector)
    return slot.type.size


def _parts_of_default(slot: FunctionParameter) -> tuple[Any, ...]:
    """Return the components for those not passed: the default's, or neutral ones."""
    size = _size(slot)
    if slot.default is MISSING:
        return (1.0 if slot.name in ("factor", "factors", "scale") else 0.0,) * size
    default = unwrapped(slot.default)
    return tuple(default) if isinstance(default, Sequence) else (default,) * size


def _check_together(
    requires: Requirement, values: Mapping[str, Given], what: str, place: Span | None
) -> None:
    wanted, takes_all = _required(requires)
    known = {n: _plain(v) for n, v in values.items() if takes_all or n in wanted}
    plain = {n: v for n, v in known.items() if v is not None}
    if len(plain) < len(known) and not takes_all:
        return
    reason = requires(**plain)
    if reason is not None:
        refuse(f"{what}: {reason}", place=place)
    for name, value in values.items():
        if name in plain and isinstance(value, Number) and value.type is INT:
            _check_ends(requires, {**plain}, name, value, what, place)


def _check_ends(
    requires: Requirement,
    plain: dict[str, Any],
    name: str,
    value: Number,
    what: str,
    place: Span | None,
) -> None:
    """Refuse a whole number that contradicts others at an end of its range.

    Args:
        requires: Returns why numbers contradict each other, or None.
        plain: The values by name.
        name: The name of the whole number.
        value: The whole number, which a parameter changes.
        what: The name in messages.
        place: The author's line.
    """
    assert isinstance(value.value, Expression)
    ends = whole_ends(value.value)
    assert ends is not None, "checked on conversion"
    for word, end in zip(("down", "up"), ends, strict=True):
        reason = requires(**{**plain, name: end})
        if reason is not None:
            side = "low" if word == "down" else "high"
            hint = f"give the parameter another {side}, or use clamp"
            refuse(f"{what}: {reason}; '{name}' goes {word} to {end}", hint, place)


@lru_cache(maxsize=1024)
def _required(requires: Requirement) -> tuple[frozenset[str], bool]:
    """Return the names that a requirement takes, and whether it takes all names."""
    wanted = inspect.signature(requires).parameters
    takes_all = any(p.kind is inspect.Parameter.VAR_KEYWORD for p in wanted.values())
    return frozenset(wanted), takes_all


def _plain(value: Given) -> Any:
    """Return the value for a requirement: a parameter's default, or None if it is computed."""
    if isinstance(value, VaryingNumber):
        return None
    if not isinstance(value, Number):
        return value
    if value.plain is not None:
        return value.plain
    held = value.value
    assert isinstance(held, Symbolic)
    expression = held.as_expression()
    if isinstance(expression.node, Uniform) and len(expression.parameters) == 1:
        return expression.parameters[0].default
    if expression.type is INT:
        return executor().value(expression, {}, 0.0)
    return None


__all__ = [
    "RESERVED",
    "RESERVED_OF_SHAPES",
    "Accept",
    "Asked",
    "FunctionParameter",
    "Given",
    "Number",
    "arguments",
    "number",
    "slots_of",
    "takes_color",
]
