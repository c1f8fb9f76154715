"""Views of an ``@image`` that show one of its local variables: its coordinate, its signal.

Input: an author's image and the name of a local. Output: an image whose function is the author's,
changed to return the last value of the local as a color, on every path.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Final

from distal.diagnostics import Span
from distal.frontend import Assembly, lower
from distal.frontend.signatures.signatures import read_signature
from distal.ir.build import boolean, cast, field, number, swizzle
from distal.ir.nodes import (
    Assign,
    Call,
    EntryKind,
    Expr,
    Field,
    Function,
    Let,
    Module,
    Param,
    Read,
    Return,
    Stmt,
    Var,
)
from distal.ir.types import (
    BOOL,
    FLOAT,
    FRAME,
    INT,
    IVEC4,
    UINT,
    VEC2,
    VEC3,
    VEC4,
    Kind,
    Struct,
    Type,
)
from distal.ir.walk import expressions, map_statement, nodes_in, root_of, statements_in
from distal.lang.composed import Composed
from distal.lang.functions import Func, Image
from distal.loading import copy_loaded_from
from distal.passes.naming import FreshNames
from distal.render import lettering, ranges
from distal.render import local_views as library
from distal.scene.lowering.picture import RANGE

PREFIX: Final = "local:"
VIEWS: Final = ("coordinate", "signal")
_NUMBERS: Final = (FLOAT, INT, UINT, BOOL)
SHOWN: Final[Mapping[Type, Func]] = {
    **dict.fromkeys(_NUMBERS, library.local_number),
    VEC2: library.local_coordinate,
    VEC3: library.local_direction,
}


@dataclass(frozen=True, slots=True)
class Local:
    """A local variable of an image's function that can be shown.

    Attributes:
        name: The name that the author wrote; a second local of the same name ends in ``_2``. A
            field of a struct has the names of both: "hit.distance".
        type: The type, one that can be shown.
        varies: Whether the value differs from pixel to pixel.
        of: The name of the local itself.
        place: Where it is first given a value.
    """

    name: str
    type: Type
    varies: bool
    of: str
    place: Span | None = None

    def read(self, whole: Type) -> Expr:
        """Return the value, read from the local of type ``whole``."""
        value: Expr = Read(self.of, whole)
        for part in self.name.split(".")[1:]:
            value = field(value, part)
        return value


def view_of_image(image: Image, view: str) -> Composed:
    """Return another view of an image.

    Args:
        image: An author's image.
        view: "coordinate": the first vec2, or the pixel's own coordinate. "signal": the first
            number that differs from pixel to pixel, or the picture's brightness. "local:NAME":
            any local.

    Raises:
        ValueError: There is no such local; the message lists those that can be shown.
        CompileError: The image has mistakes.
    """
    found = locals_of(image)
    if view == "coordinate":
        vectors = [x for x in found if x.type is VEC2 and x.varies]
        return LocalView(image, vectors[0]) if vectors else PixelCoordinate(image)
    if view == "signal":
        numbers = [x for x in found if x.type is FLOAT and x.varies]
        return LocalView(image, numbers[0]) if numbers else PictureBrightness(image)
    if not view.startswith(PREFIX):
        known = ", ".join(("color", *VIEWS, f"{PREFIX}NAME"))
        raise ValueError(f"an @image has no view '{view}'; views: {known}\n{_listed(found)}")
    name = view.removeprefix(PREFIX)
    named = [x for x in found if x.name == name]
    if not named:
        message = f"'{image.name}' has no local '{name}' that can be shown"
        raise ValueError(f"{message}\n{_listed(found)}")
    return LocalView(image, named[0])


def locals_of(
    image: Image, shown: Container[Type] = SHOWN, module: Module | None = None
) -> list[Local]:
    """Return the locals of an image's function that can be shown, in source order.

    Args:
        image: An author's image.
        shown: The types that can be shown.
        module: The lowered image, if it is known.
    """
    module = lower(image) if module is None else module
    function = module.function(module.entry)
    written = set(image.python_function.__code__.co_varnames)
    varying = _varying(function)
    found: dict[str, Local] = {}
    for stmt in statements_in(function.body):
        if isinstance(stmt, Let | Var) and _is_own(stmt.name, written):
            for name, type in _parts(stmt.name, stmt.value.type, shown):
                found[name] = Local(name, type, stmt.name in varying, stmt.name, stmt.span)
    return list(found.values())


def _parts(name: str, type: Type, shown: Container[Type]) -> Iterator[tuple[str, Type]]:
    """Yield a local that can be shown, or the fields of a struct that can."""
    if type in shown:
        yield name, type
    elif isinstance(type, Struct):
        for part, its in type.fields:
            yield from _parts(f"{name}.{part}", its, shown)


def _is_own(name: str, written: set[str]) -> bool:
    """Return whether the author wrote a local; others are made by the compiler."""
    plain = {w.strip("_") for w in written}
    return name in plain or re.sub(r"_\d+$", "", name) in plain


def _varying(function: Function) -> set[str]:
    """Return the locals that depend on the frame's coordinate."""
    varying: set[str] = set()
    size = -1
    while len(varying) > size:  # values that flow through a loop need another iteration
        size = len(varying)
        for stmt in statements_in(function.body):
            if isinstance(stmt, Let | Var | Assign):
                name = root_of(stmt.target).name if isinstance(stmt, Assign) else stmt.name
                if any(_is_varying(e, varying) for x in expressions(stmt) for e in nodes_in(x)):
                    varying.add(name)
    return varying


def _is_varying(e: Expr, varying: set[str]) -> bool:
    if isinstance(e, Field) and e.base.type is FRAME:
        return e.name == "coord"
    if isinstance(e, Call):
        return any(argument.type is FRAME for argument in e.args)
    return isinstance(e, Read) and e.name in varying


def _listed(found: Iterable[Local]) -> str:
    rows = [f"  {PREFIX}{x.name}  {x.type}" for x in found]
    if not rows:
        return "it has no locals that can be shown: numbers, vec2, vec3"
    return "\n".join(("what it can show:", *rows))


class _ImageView(Composed):
    """Base class of the views of an image."""

    kind: ClassVar[EntryKind] = EntryKind.IMAGE
    signature = (("frame", FRAME),)
    result = VEC4
    ranged: ClassVar[bool] = True  # shows values in a range (``scene/view_ranges.py``)

    def __init__(self, image: Image, what: str) -> None:
        copy_loaded_from(image, self)
        self.name = f"{image.name} ({what})"
        self._image = image
        self._title = what

    def functions(self) -> Iterable[Func]:
        """Yield the scene functions that the image calls."""
        return (self._image,)

    def _shown(self, assembly: Assembly, frame: Read, value: Expr, reached: Expr) -> Expr:
        """Return a value as a color with a legend."""
        asked = {f"view_{n}": assembly.number(f"View_{n}", FLOAT, 0.0) for n in RANGE}
        given = {
            "value": cast(value, Kind.FLOAT) if value.type in _NUMBERS else value,
            "whole": boolean(value.type is not FLOAT),
            "reached": reached,
            "shown": assembly.call(ranges.range_of_host, asked),
            "coord": field(frame, "coord"),
            "resolution": field(frame, "resolution"),
            "title": assembly.constant(lettering.word(self._title), IVEC4),
        }
        return assembly.call(SHOWN[value.type], given)


class PixelCoordinate(_ImageView):
    """The coordinate of a pixel, as a color."""

    def __init__(self, image: Image) -> None:
        super().__init__(image, "coordinate")

    def compose(self, assembly: Assembly) -> str:
        """Add the function of the frame, and return its name."""
        frame = Read("frame", FRAME)
        given = {n: field(frame, n) for n in ("coord", "resolution")}
        place = assembly.call(library.pixel_place, given)
        color = self._shown(assembly, frame, place, boolean(True))
        return assembly.define("coordinate", (Param("frame", FRAME),), VEC4, (Return(color),))


class PictureBrightness(_ImageView):
    """The brightness of a pixel, as a color."""

    def __init__(self, image: Image) -> None:
        super().__init__(image, "brightness")

    def compose(self, assembly: Assembly) -> str:
        """Add the function of the frame, and return its name."""
        frame = Read("frame", FRAME)
        slot = read_signature(self._image.overloads[0]).parameters[0].name
        color = assembly.call(self._image, {slot: frame})
        light = assembly.call(library.brightness, {"color": swizzle(color, "xyz")})
        shown = self._shown(assembly, frame, light, boolean(True))
        return assembly.define("brightness", (Param("frame", FRAME),), VEC4, (Return(shown),))


class LocalView(_ImageView):
    """A local variable of an image, as a color."""

    def __init__(self, image: Image, local: Local) -> None:
        super().__init__(image, local.name)
        self._local = local

    def compose(self, assembly: Assembly) -> str:
        """Add the image's own function with changed returns, and return its name."""
        slot = read_signature(self._image.overloads[0]).parameters[0].name
        frame = Read(slot, FRAME)
        call: Any = assembly.call(self._image, {slot: frame})
        function = assembly.function(call.function)
        local = self._local
        (kept,) = kept_values(function, (local,))
        color = self._shown(assembly, frame, kept.value, kept.reached)
        body = watched(function, (kept,), lambda _: color)
        name = f"{function.name}_{local.of}"
        return assembly.define(name, function.params, VEC4, body, function.span)


@dataclass(frozen=True, slots=True)
class Kept:
    """The variables that keep the last value of a local, and whether it has one."""

    local: Local
    value: Read
    reached: Read


def kept_values(function: Function, of: Iterable[Local]) -> list[Kept]:
    """Return variables for the values of locals, with names that the function does not have."""
    taken = {p.name for p in function.params}
    taken |= {s.name for s in statements_in(function.body) if hasattr(s, "name")}
    names = FreshNames(taken)
    return [
        Kept(x, Read(names.fresh("shown"), x.type), Read(names.fresh("reached"), BOOL)) for x in of
    ]


def watched(
    function: Function, kept: Sequence[Kept], returned: Callable[[Expr], Expr]
) -> tuple[Stmt, ...]:
    """Return the body of a function that keeps the values of locals.

    Args:
        function: The function.
        kept: The locals, and the variables that keep their values.
        returned: The value to return in place of another one.
    """
    declared: list[Stmt] = []
    for each in kept:
        declared.append(Var(each.value.name, number(0, each.local.type)))
        declared.append(Var(each.reached.name, boolean(False)))
    return (*declared, *_watched(function.body, kept, returned))


def _watched(
    body: tuple[Stmt, ...], kept: Sequence[Kept], returned: Callable[[Expr], Expr]
) -> Iterator[Stmt]:
    ahead = {
        (name, id(s.span))
        for s in statements_in(body)
        if isinstance(s, Assign)
        for name in (root_of(s.target).name,)
    }
    for stmt in body:
        if isinstance(stmt, Return):
            yield Return(returned(stmt.value), span=stmt.span)
            continue
        yield map_statement(stmt, lambda e: e, lambda inner: tuple(_watched(inner, kept, returned)))
        for each in kept:
            name = each.local.of
            # A local that is first assigned in an inner block is declared before it, as zero.
            hoisted = isinstance(stmt, Var) and stmt.name == name and (name, id(stmt.span)) in ahead
            if _gives(stmt, name) and not hoisted:
                yield Assign(each.value, each.local.read(_type_of(stmt)), span=stmt.span)
                yield Assign(each.reached, boolean(True), span=stmt.span)


def _gives(stmt: Stmt, name: str) -> bool:
    match stmt:
        case Let(found) | Var(found):
            return found == name
        case Assign(target):
            return root_of(target).name == name
        case _:
            return False


def _type_of(stmt: Stmt) -> Type:
    """Return the type of the local that a statement gives a value."""
    match stmt:
        case Let(value=value) | Var(value=value):
            return value.type
        case Assign(target):
            return root_of(target).type
        case _:
            raise AssertionError(stmt)
