"""Find the literals of a source that a dial, a picker or a switch can change; write new ones.

Input: Python text. Output: ``SourceLiteral`` records by position, and the text of a new value in
the notation of the old one. Reads the source by ``ast``; nothing is run.
"""

from __future__ import annotations

import ast
import inspect
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from functools import cache, lru_cache
from typing import Any, Final, Literal, TypeAlias, cast

import distal
from distal import lang
from distal.editor.messages import LiteralValue, SourceLiteral
from distal.fields.guarantees import USUAL_LIMITS, Limit
from distal.frontend.parsing import parse
from distal.lang.resources import WRAPS, TextureValue
from distal.render.declarations import BACKGROUNDS, CAMERAS, LIGHTS, MATERIALS
from distal.scene.scene import WORDS, Scene

Type: TypeAlias = Literal["number", "vector", "color", "switch", "choice"]
Way: TypeAlias = Literal["numbers", "hold", "compile"]

_FAMILIES: Final = {
    f"distal.scene.objects.{name}": family
    for name, family in {
        "backgrounds": BACKGROUNDS,
        "cameras": CAMERAS,
        "lights": LIGHTS,
        "materials": MATERIALS,
    }.items()
}
_HEX: Final = re.compile(r"#(?:[0-9a-fA-F]{3}|[0-9a-fA-F]{6})")
_PLACES: Final = 12  # the most decimal places of a number that is written


class LiteralError(ValueError):
    """There is no such literal, or a value does not belong in it."""


class Positions:
    """Offsets of a text in UTF-16 units, as browsers count, for the positions of ``ast``."""

    def __init__(self, text: str) -> None:
        self._lines = text.split("\n")
        self._plain = text.isascii()
        self._starts = [0]
        for line in self._lines:
            self._starts.append(self._starts[-1] + utf16_length(line) + 1)

    def offset(self, line: int, column: int) -> int:
        """Return the offset of a line, from 1, and a column in bytes of UTF-8."""
        return self._starts[line - 1] + self.column(line, column)

    def column(self, line: int, column: int) -> int:
        """Return a column in bytes of UTF-8 as one in UTF-16 units."""
        if self._plain:
            return column
        before = self._lines[line - 1].encode("utf-8")[:column].decode("utf-8", "replace")
        return utf16_length(before)

    def span(self, node: ast.expr) -> tuple[int, int]:
        """Return the offsets of a node's ends."""
        assert node.end_lineno is not None and node.end_col_offset is not None
        return (
            self.offset(node.lineno, node.col_offset),
            self.offset(node.end_lineno, node.end_col_offset),
        )


def utf16_length(text: str) -> int:
    """Return the number of UTF-16 units of a text."""
    return len(text) if text.isascii() else len(text.encode("utf-16-le", "surrogatepass")) // 2


def spliced(text: str, start: int, end: int, new: str) -> str:
    """Return a text with a piece replaced; offsets in UTF-16 units."""
    if text.isascii():
        return text[:start] + new + text[end:]
    units = text.encode("utf-16-le", "surrogatepass")
    piece = new.encode("utf-16-le", "surrogatepass")
    joined = units[: 2 * start] + piece + units[2 * end :]
    return joined.decode("utf-16-le", "surrogatepass")


def piece(text: str, start: int, end: int) -> str:
    """Return a piece of a text; offsets in UTF-16 units."""
    if text.isascii():
        return text[start:end]
    units = text.encode("utf-16-le", "surrogatepass")
    return units[2 * start : 2 * end].decode("utf-16-le", "surrogatepass")


# A drag sends one text many times.
@lru_cache(maxsize=4)
def find_literals(file: str, text: str) -> tuple[SourceLiteral, ...]:
    """Return the literals of a file in the order of the text; none if it is not Python."""
    try:
        tree = parse(text)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ()
    return tuple(sorted(_Finder(file, text).found(tree), key=lambda found: found.start))


@dataclass(frozen=True, slots=True)
class _Around:
    """What is around an expression.

    Attributes:
        call: The nearest call, or "".
        slot: The argument or variable that it is in, or "".
        way: What a change needs.
        parent: The node that it is a part of.
    """

    call: str = ""
    slot: str = ""
    way: Way = "numbers"
    parent: ast.AST | None = None


class _Finder:
    """Walks the tree of one file."""

    def __init__(self, file: str, text: str) -> None:
        self._file = file
        self._text = text
        self._positions = Positions(text)

    def found(self, tree: ast.Module) -> Iterator[SourceLiteral]:
        """Yield the literals of a module."""
        yield from self._body(tree.body, _Around())

    def _body(self, body: Sequence[ast.stmt], around: _Around) -> Iterator[SourceLiteral]:
        for stmt in body:
            yield from self._statement(stmt, around)

    def _statement(self, stmt: ast.stmt, around: _Around) -> Iterator[SourceLiteral]:
        match stmt:
            case ast.FunctionDef(decorator_list=decorators, args=args, body=body):
                # Functions of scene code are compiled; others run when the scene is built.
                inside = _Around(way="hold" if decorators else around.way, parent=stmt)
                for default in [*args.defaults, *filter(None, args.kw_defaults)]:
                    yield from self._expression(default, _Around(way="compile", parent=stmt))
                yield from self._body(body, inside)
            case ast.ClassDef(body=body):
                yield from self._body(body, _Around(way="compile", parent=stmt))
            case ast.Assign([ast.Name(name)], value) | ast.AnnAssign(ast.Name(name), value=value):
                if value is not None:
                    inside = _Around("", name, around.way, stmt)
                    yield from self._expression(value, inside)
            case ast.Expr(ast.Constant(str())):  # a docstring
                return
            case _:
                here = _Around("", "", around.way, stmt)
                for child in ast.iter_child_nodes(stmt):
                    if isinstance(child, ast.expr):
                        yield from self._expression(child, here)
                    elif isinstance(child, ast.stmt):
                        yield from self._statement(child, around)
                    elif hasattr(child, "body"):  # handlers and cases
                        yield from self._body(cast(Any, child).body, around)

    def _expression(self, node: ast.expr, around: _Around) -> Iterator[SourceLiteral]:
        literal = self._literal(node, around)
        if literal is not None:
            yield literal
            return
        match node:
            case ast.Call(function, args, keywords):
                yield from self._expression(function, _Around("", "", around.way, node))
                yield from self._arguments(node, args, keywords, around)
            case ast.Subscript(value, index):
                yield from self._expression(value, _Around("", "", around.way, node))
                yield from self._expression(index, _Around("", "", "compile", node))
            case ast.JoinedStr() | ast.Lambda() | ast.Constant():
                return
            case ast.ListComp() | ast.SetComp() | ast.GeneratorExp() | ast.DictComp():
                for part in node.generators:
                    for within in (part.iter, *part.ifs):
                        yield from self._expression(within, _Around("", "", "compile", part))
                for name in ("key", "elt", "value"):
                    result = getattr(node, name, None)
                    if result is not None:
                        yield from self._expression(result, _Around("", "", "compile", node))
            case _:
                for child in ast.iter_child_nodes(node):
                    if isinstance(child, ast.expr):
                        inside = _Around(around.call, around.slot, around.way, node)
                        yield from self._expression(child, inside)

    def _arguments(
        self,
        node: ast.Call,
        args: Sequence[ast.expr],
        keywords: Sequence[ast.keyword],
        around: _Around,
    ) -> Iterator[SourceLiteral]:
        called = node.func
        name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
        slots = _slots(name) if around.way != "hold" else ()
        # A count of a loop steers what is compiled.
        way: Way = "compile" if name == "range" else around.way
        for position, arg in enumerate(args):
            slot = slots[position] if position < len(slots) else ""
            yield from self._expression(arg, _Around(name, slot, way, node))
        for keyword in keywords:
            yield from self._expression(keyword.value, _Around(name, keyword.arg or "", way, node))

    def _literal(self, node: ast.expr, around: _Around) -> SourceLiteral | None:
        match node:
            case ast.Constant(bool(value)):
                return self._made(node, around, "switch", value, way="compile")
            case ast.Constant(str(value)):
                return self._word(node, value, around)
            case ast.Tuple(elements) if 2 <= len(elements) <= 4 and around.way != "hold":
                values = [_number(e) for e in elements]
                if None in values:
                    return None
                parts = tuple(self._positions.span(e) for e in elements)
                texts = [piece(self._text, *part) for part in parts]
                return self._made(
                    node,
                    around,
                    "vector",
                    tuple(float(v) for v in values if v is not None),
                    parts=parts,
                    step=min(map(step_of, texts)),
                    whole=all(map(_is_whole, texts)),
                )
            case _:
                number = _number(node)
                if number is None:
                    return None
                start, end = self._positions.span(node)
                text = piece(self._text, start, end)
                return self._made(
                    node, around, "number", float(number), step=step_of(text), whole=_is_whole(text)
                )

    def _word(self, node: ast.expr, value: str, around: _Around) -> SourceLiteral | None:
        """Return a color or a choice; None for other texts, and for those with a prefix."""
        own = piece(self._text, *self._positions.span(node))
        if own not in (f'"{value}"', f"'{value}'"):
            return None
        if _HEX.fullmatch(value):
            return self._made(node, around, "color", value)
        options = _options(node, around)
        if value not in options:
            return None
        return self._made(node, around, "choice", value, options=options, way="compile")

    def _made(
        self, node: ast.expr, around: _Around, type: Type, value: LiteralValue, **more: Any
    ) -> SourceLiteral:
        start, end = self._positions.span(node)
        if type in ("number", "vector") and isinstance(around.parent, ast.Call):
            low, high = _range(_limit(around.call, around.slot), more["step"])
            more |= {"low": low, "high": high}
        way = more.pop("way", around.way)
        if way == "hold" and (type != "number" or more.get("whole")):
            way = "compile"
        return SourceLiteral(
            file=self._file,
            line=node.lineno,
            start=start,
            end=end,
            text=piece(self._text, start, end),
            type=type,
            value=value,
            call=around.call,
            slot=around.slot,
            way=way,
            **more,
        )


def _number(node: ast.expr) -> int | float | None:
    """Return the value of a literal number, with its minus; None for everything else."""
    match node:
        case ast.UnaryOp(ast.USub(), ast.Constant(value)) if _is_number(value):
            return -cast(float, value)
        case ast.Constant(value) if _is_number(value):
            return cast(float, value)
        case _:
            return None


def _is_number(value: object) -> bool:
    plain = isinstance(value, int | float) and not isinstance(value, bool)
    return plain and abs(cast(float, value)) < 1e300


@cache
def _public(name: str) -> Any:
    """Return a public name of the library or of scene code; None if there is none."""
    # Asking ``distal`` for another name makes it search for similar ones.
    return getattr(distal, name) if name in distal.__all__ else getattr(lang, name, None)


@cache
def _slots(name: str) -> tuple[str, ...]:
    """Return the names of the arguments of a public function, class or method of shapes."""
    found = getattr(distal, name) if name in distal.__all__ else None
    if found is None:
        found = getattr(distal.Shape, name, None) or getattr(distal.Shape2D, name, None)
    try:
        parameters = inspect.signature(found).parameters if callable(found) else {}
    except (TypeError, ValueError):
        return ()
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return tuple(n for n, p in parameters.items() if p.kind in positional and n != "self")


def _options(node: ast.expr, around: _Around) -> tuple[str, ...]:
    """Return the words that an argument takes: those of the library, or of a declared choice."""
    called = _public(around.call)
    if called is Scene or around.call == "with_display":
        return WORDS.get(around.slot, ())
    if around.slot == "wrap" and isinstance(called, type) and issubclass(called, TextureValue):
        return WRAPS
    if called is lang.choice and isinstance(around.parent, ast.Call):
        return _declared(node, around.parent)
    return ()


def _declared(node: ast.expr, call: ast.Call) -> tuple[str, ...]:
    """Return the options written in a ``choice(...)``, if a node is its default."""
    given = dict(zip(inspect.signature(lang.choice).parameters, call.args, strict=False))
    given |= {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    match given if given.get("default") is node else {}:
        case {"options": ast.List(elements) | ast.Tuple(elements)}:
            words = [e.value for e in elements if isinstance(e, ast.Constant)]
            return tuple(word for word in words if isinstance(word, str))
        case _:
            return ()


@cache
def _limit(call: str, slot: str) -> Limit:
    """Return the limit of an argument of a public function, class or method of shapes."""
    if slot not in _slots(call) and call not in distal.__all__:
        return Limit.ANY
    family = _FAMILIES.get(getattr(getattr(distal, call, None), "__module__", ""))
    limits = USUAL_LIMITS if family is None else family.limits
    return limits.get(slot, Limit.ANY)


def _range(limit: Limit, step: float) -> tuple[float | None, float | None]:
    """Return the least and the greatest value that a dial offers."""
    match limit:
        case Limit.POSITIVE:
            return step, None
        case Limit.NOT_NEGATIVE:
            return 0.0, None
        case Limit.FRACTION:
            return 0.0, 1.0
        case _:
            return None, None


# Notation


def _is_whole(text: str) -> bool:
    return (
        re.fullmatch(r"-?\s*(?:0[xX][0-9a-fA-F_]+|0[oO][0-7_]+|0[bB][01_]+|[0-9_]+)", text)
        is not None
    )


def step_of(text: str) -> float:
    """Return how much the last written digit of a number counts."""
    if _is_whole(text):
        return 1.0
    mantissa, _, exponent = text.lower().replace("_", "").partition("e")
    places = len(mantissa.partition(".")[2])
    return float(f"1e{int(exponent or 0) - places}")


def written(literal: SourceLiteral, text: str, value: LiteralValue) -> str:
    """Return the text of a literal with another value, in its own notation.

    Args:
        literal: The literal.
        text: The text of its file.
        value: The value: of the literal's type; of a color "#rrggbb".

    Raises:
        LiteralError: The value does not belong there.
    """
    own = piece(text, literal.start, literal.end)
    match literal.type, value:
        case "switch", bool():
            return str(value)
        case "color" | "choice", str():
            if literal.type == "color" and not _HEX.fullmatch(value):
                raise LiteralError(f"a color is '#rrggbb', not {value[:20]!r}")
            if not value.isprintable() or set(value) & {'"', "'", "\\"}:
                raise LiteralError(f"{value[:20]!r} cannot stand in a text")
            return f"{own[0]}{value}{own[0]}"
        case "number", int() | float() if not isinstance(value, bool):
            made = number_text(own, float(value))
            if made.startswith("-") and _is_base(text, literal):
                return f"({made})"
            return made
        case "vector", tuple() if len(value) == len(literal.parts):
            made = own
            for (start, end), part in reversed(list(zip(literal.parts, value, strict=True))):
                old = piece(text, start, end)
                new = number_text(old, part)
                made = spliced(made, start - literal.start, end - literal.start, new)
            return made
    raise LiteralError(f"{value!r} does not belong in a literal that is a {literal.type}")


def number_text(old: str, value: float) -> str:
    """Return a number in the notation of another one: its places, exponent, underscores.

    A value between two steps gets as many places as it needs.

    Raises:
        LiteralError: The value is not finite, or not whole where only whole numbers are written.
    """
    if not math.isfinite(value):
        raise LiteralError("a number is finite")
    if _is_whole(old):
        return _whole_text(old, value)
    mantissa, letter, exponent = re.fullmatch(r"-?\s*([^eE]*)(?:([eE])(.*))?", old).groups()  # type: ignore[union-attr]
    power = int((exponent or "0").replace("_", ""))
    scaled = Decimal(repr(value)).scaleb(-power)
    places = len(mantissa.replace("_", "").partition(".")[2])
    most = max(places, min(_PLACES, -int(scaled.normalize().as_tuple().exponent)))
    rounded = scaled.quantize(Decimal(1).scaleb(-places))
    near = abs(rounded - scaled) <= abs(scaled) * Decimal("1e-9")
    made = f"{rounded if near else scaled.quantize(Decimal(1).scaleb(-most)):f}"
    if "." in mantissa and "." not in made:
        made += "."  # written as ``1.``
    if mantissa.startswith(".") and made.lstrip("-").startswith("0."):
        made = made.replace("0.", ".", 1)
    if "_" in mantissa.partition(".")[0]:
        sign, digits, rest = re.fullmatch(r"(-?)(\d+)(.*)", made).groups()  # type: ignore[union-attr]
        made = f"{sign}{int(digits):_}{rest}"
    if float(made) == 0.0:
        made = made.removeprefix("-")
    return made if letter is None else f"{made}{letter}{exponent}"


def _whole_text(old: str, value: float) -> str:
    if value != round(value):
        raise LiteralError(f"only whole numbers belong there, not {value}")
    digits = old.lstrip("- ")
    number = int(value)
    for prefix, form in (("0x", "x"), ("0o", "o"), ("0b", "b")):
        if digits.lower().startswith(prefix):
            return f"{'-' if number < 0 else ''}{digits[:2]}{abs(number):{form}}"
    return f"{number:_}" if "_" in digits else str(number)


def _is_base(text: str, literal: SourceLiteral) -> bool:
    """Return whether a minus needs parentheses: ``-2 ** x`` is ``-(2 ** x)``."""
    after = piece(text, literal.end, literal.end + 40).lstrip(" ")
    return after.startswith("**") and not literal.text.startswith("-")


def literal_at(literals: Sequence[SourceLiteral], start: int, end: int) -> SourceLiteral:
    """Return the literal at these offsets.

    Raises:
        LiteralError: There is none.
    """
    for literal in literals:
        if (literal.start, literal.end) == (start, end):
            return literal
    raise LiteralError(f"there is no literal from {start} to {end}")
