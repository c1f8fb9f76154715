"""Random scene code, well typed, whose every operation is exact in 32 bits.

Input: hypothesis's choices. Output: the text of functions. Since nothing is
rounded, all targets must give the same bits, whatever they reorder, contract or fold.

Integers wrap, so any operation on them is exact. Floats are multiples of powers of two: each
expression knows a bound of its magnitude and how many binary places it may have, and variables,
arguments and results are brought back to ``VARIABLE`` before they are stored.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeVar

from hypothesis import strategies as st

Choice = TypeVar("Choice")

FLOATS: Final = ("float", "vec2", "vec3")
INTS: Final = ("int", "ivec2", "ivec3")
UINTS: Final = ("uint", "uvec2")
VALUES: Final = (*FLOATS, *INTS, *UINTS, "bool")
SIZES: Final = {"vec2": 2, "vec3": 3, "ivec2": 2, "ivec3": 3, "uvec2": 2}
SCALAR_OF: Final = {
    **dict.fromkeys(FLOATS, "float"),
    **dict.fromkeys(INTS, "int"),
    **dict.fromkeys(UINTS, "uint"),
}
# Arrays and structs as types of locals: how to name, make and take apart a value.
ARRAYS: Final = {"ints": ("int", 3), "floats": ("float", 4), "points": ("vec2", 2)}
STRUCTS: Final = {
    "Pair": (("amount", "float"), ("cell", "ivec2")),
    "Nest": (("pair", "Pair"), ("flag", "bool"), ("ints", "ints"), ("mask", "uint")),
}
PREAMBLE: Final = """from distal.lang import *


@struct
class Pair:
    amount: float
    cell: ivec2

    @func
    def shifted(self, by: int) -> int:
        return self.cell.x * by + self.cell.y

    @func
    def turned(self) -> "Pair":
        result = self
        result.cell = self.cell.yx
        return result


@struct
class Nest:
    pair: Pair
    flag: bool
    ints: array[int, 3]
    mask: uint


@func
def joined(first: int, *rest: int) -> int:
    for i, value in enumerate(rest, start=1):
        first = first * 31 + value * i
    return first
"""

INT_LITERALS: Final = (
    *("0", "1", "2", "3", "-1", "-2", "5", "7", "10", "31", "32", "100", "-100", "65535"),
    *("2147483647", "-2147483647", "1000000007"),
)
UINT_LITERALS: Final = (
    "0",
    "1",
    "2",
    "3",
    "7",
    "31",
    "32",
    "255",
    "65535",
    "2147483648",
    "4294967295",
)
NAME: Final = re.compile(r"\b[pvi]\d")
MOST_BITS = 22  # of 24 that a float's fraction holds


@dataclass(frozen=True)
class Bound:
    """At most ``magnitude``, and a multiple of 2^-places."""

    magnitude: float
    places: int

    @property
    def exact(self) -> bool:
        """Whether every such number is a 32 bit float, with room to spare."""
        return self.magnitude * 2.0**self.places <= 2.0**MOST_BITS

    def joined(self, other: Bound) -> Bound:
        """The bound of either."""
        return Bound(max(self.magnitude, other.magnitude), max(self.places, other.places))


VARIABLE: Final = Bound(64.0, 3)
NONE: Final = Bound(0.0, 0)


@dataclass(frozen=True)
class Piece:
    """An expression's text and, for floats, its bound."""

    text: str
    bound: Bound = NONE


@dataclass(frozen=True)
class Signature:
    """A function made so far: what calls of it look like and roughly cost."""

    name: str
    params: tuple[str, ...]
    results: tuple[str, ...]
    cost: int


@dataclass
class Local:
    """A name in scope."""

    name: str
    type: str
    writable: bool = True


@dataclass
class Maker:
    """Makes one function after another.

    Attributes:
        draw: Hypothesis's.
        functions: Those made so far; later ones call them.
        locals: In scope at this place.
        cost: Rough number of operations of the function being made.
        rounds: How often the place being made is run in one call.
    """

    draw: Callable[[st.SearchStrategy[Any]], Any]
    functions: list[Signature] = field(default_factory=list)
    locals: list[Local] = field(default_factory=list)
    cost: int = 0
    rounds: int = 1
    budget: int = 0
    names: int = 0
    results: tuple[str, ...] = ()

    # Choices.

    def pick(self, options: Sequence[Choice]) -> Choice:
        """One of the options; shrinks toward the first."""
        return options[self.draw(st.integers(0, len(options) - 1))]

    def chance(self, percent: int) -> bool:
        """True that often; shrinks toward False."""
        return bool(self.draw(st.integers(0, 99)) >= 100 - percent)

    def fresh(self, stem: str) -> str:
        """A name not used in this function."""
        self.names += 1
        return f"{stem}{self.names}"

    # Expressions.

    def expression(self, type: str, depth: int) -> Piece:
        """An expression of a type; ``depth`` operations deep at most."""
        self.cost += self.rounds
        self.budget -= 1
        if depth <= 0 or self.budget <= 0:
            return self.leaf(type)
        if self.chance(15):
            return self.leaf(type)
        if self.chance(12):
            called = self.call(type, depth)
            if called is not None:
                return called
        if self.chance(10):
            return self.conditional(type, depth)
        if type in FLOATS:
            return self.float_operation(type, depth)
        if type in INTS:
            return Piece(self.int_operation(type, depth))
        if type in UINTS:
            return Piece(self.uint_operation(type, depth))
        assert type == "bool", type
        return Piece(self.condition(depth))

    def leaf(self, type: str) -> Piece:
        """A variable or a literal."""
        places = self.places(type)
        if places and self.chance(75):
            return Piece(self.pick(places), VARIABLE)
        if not places and self.chance(50):
            return Piece(self.varying("", type), VARIABLE)
        return self.literal(type)

    def places(self, type: str, *, writable: bool = False) -> list[str]:
        """Every variable or part of one that has the type, as text."""
        found: list[str] = []
        for local in self.locals:
            if local.writable or not writable:
                found += self.parts(local.name, local.type, type)
        return found

    def parts(self, text: str, type: str, wanted: str) -> list[str]:
        """Ways into a value of ``type`` that give ``wanted``."""
        if type == wanted:
            return [text]
        if type in SIZES and SCALAR_OF[type] == wanted:
            return [f"{text}.{lane}" for lane in "xyz"[: SIZES[type]]]
        if type == "vec3" and wanted == "vec2":
            return [f"{text}.xy", f"{text}.zx"]
        if type in ARRAYS:
            element = ARRAYS[type][0]
            return [p for i in ("0", "1") for p in self.parts(f"{text}[{i}]", element, wanted)]
        if type in STRUCTS:
            return [p for n, t in STRUCTS[type] for p in self.parts(f"{text}.{n}", t, wanted)]
        return []

    def literal(self, type: str) -> Piece:
        """A constant."""
        if type == "float":
            eighths = self.draw(st.integers(-64, 64))
            return Piece(f"({eighths / 8!r})", Bound(8.0, 3))
        if type == "int":
            return Piece(f"({self.pick(INT_LITERALS)})")
        if type == "uint":
            return Piece(f"uint({self.pick(UINT_LITERALS)})")
        if type == "bool":
            return Piece(self.pick(("(p0 > 0)", "(p0 % 2 == 0)", "(p0 < -3)", "False", "True")))
        parts = [self.literal(SCALAR_OF[type]).text for _ in range(SIZES[type])]
        return Piece(f"{type}({', '.join(parts)})", Bound(8.0, 3))

    def stored(self, type: str, depth: int) -> str:
        """An expression fit to be stored: floats brought back to a variable's bound."""
        if type in ARRAYS:
            element, length = ARRAYS[type]
            return "[" + ", ".join(self.stored(element, depth - 1) for _ in range(length)) + "]"
        if type in STRUCTS:
            fields = [self.stored(t, depth - 1) for _, t in STRUCTS[type]]
            return f"{type}({', '.join(fields)})"
        return self.reduced(self.expression(type, depth), type).text

    def reduced(self, piece: Piece, type: str) -> Piece:
        """The piece within ``VARIABLE``."""
        bound = piece.bound
        if type not in FLOATS:
            return piece
        if bound.magnitude <= VARIABLE.magnitude and bound.places <= VARIABLE.places:
            return piece
        text = f"floor({piece.text} * 8.0) * 0.125" if bound.places > 3 else piece.text
        return Piece(f"clamp({text}, {self.same(type, -64.0)}, {self.same(type, 64.0)})", VARIABLE)

    @staticmethod
    def same(type: str, value: float) -> str:
        """A literal in every component."""
        return repr(value) if type == "float" else f"{type}({value!r})"

    def varying(self, text: str, type: str) -> str:
        """The text, or a variable where it is made of literals alone.

        The compiler computes those, and refuses what overflows, as an author's mistake.
        """
        if NAME.search(text):
            return text
        places = self.places(type)
        if places:
            return self.pick(places)
        # Every function's first parameter is an int.
        if type in SIZES:
            part = self.varying("", SCALAR_OF[type])
            return f"{type}({', '.join([part] * SIZES[type])})"
        return {"int": "p0", "uint": "uint(p0)", "float": "float(p0 & 31)", "bool": "(p0 > 0)"}[
            type
        ]

    def operands(self, kind: str, type: str, depth: int) -> tuple[str, str]:
        """Two operands that an integer operation takes without a complaint."""
        a = self.expression(type, depth - 1).text
        b = self.expression(type, depth - 1).text
        if NAME.search(b):
            return a, b
        if kind in ("//", "%", "<<", ">>"):
            # Literals that no compiler can object to: neither 0 nor more than 31.
            scalar = self.pick(("1", "3", "7", "31"))
            literal = f"uint({scalar})" if type in UINTS else scalar
            size = SIZES.get(type, 1)
            b = f"{type}({', '.join([literal] * size)})" if size > 1 else literal
        return self.varying(a, type), b

    def conditional(self, type: str, depth: int) -> Piece:
        """One of two values by a condition."""
        condition = self.condition(depth - 1)
        yes, no = self.expression(type, depth - 1), self.expression(type, depth - 1)
        form = self.pick(("({1} if {0} else {2})", "select({0}, {1}, {2})"))
        return Piece(form.format(condition, yes.text, no.text), yes.bound.joined(no.bound))

    def call(self, type: str, depth: int) -> Piece | None:
        """A call of an earlier function, where one fits and is not too dear here."""
        fitting = [f for f in self.functions if f.results == (type,) and self.affordable(f)]
        if not fitting:
            return None
        return Piece(self.call_text(self.pick(fitting), depth), VARIABLE)

    def affordable(self, function: Signature) -> bool:
        return self.cost + function.cost * self.rounds < 3000

    def call_text(self, function: Signature, depth: int) -> str:
        self.cost += function.cost * self.rounds
        args = [self.stored(t, min(depth, 2) - 1) for t in function.params]
        return f"{function.name}({', '.join(args)})"

    def float_operation(self, type: str, depth: int) -> Piece:
        """One operation that gives floats."""
        kinds = ["sum", "product", "function", "scaled", "remainder", "converted", "step", "mixed"]
        kinds += ["dot", "element"] if type == "float" else ["composed", "by scalar"]
        kind = self.pick(kinds)
        if kind == "element":
            found = self.element("float", depth)
            return Piece(found, VARIABLE) if found else self.literal("float")
        if kind == "converted":
            return self.converted_float(type, depth)
        if kind == "composed":
            parts = [self.expression("float", depth - 1) for _ in range(SIZES[type])]
            bound = parts[0].bound
            for part in parts[1:]:
                bound = bound.joined(part.bound)
            return Piece(f"{type}({', '.join(p.text for p in parts)})", bound)
        if kind in ("dot", "by scalar"):
            return self.vector_product(type, kind, depth)
        a = self.expression(type, depth - 1)
        if kind in ("scaled", "remainder"):
            return self.scaled(a, kind)
        if kind == "function":
            return self.rounded(a, type)
        b = self.expression(type, depth - 1)
        if kind == "step":
            return Piece(f"step({a.text}, {b.text})", Bound(1.0, 0))
        if kind == "mixed":
            t = self.reduced(self.expression(type, depth - 1), type)
            a, b = self.reduced(a, type), self.reduced(b, type)
            return Piece(f"mix({a.text}, {b.text}, {t.text})", Bound(64.0 + 128.0 * 64.0, 6))
        return self.arithmetic(a, b, type, product=kind == "product")

    def arithmetic(self, a: Piece, b: Piece, type: str, *, product: bool) -> Piece:
        """A sum, difference, product, minimum or maximum."""
        op = "*" if product else self.pick(("{} + {}", "{} - {}", "min({}, {})", "max({}, {})"))
        for _ in range(2):
            if product:
                magnitude = a.bound.magnitude * b.bound.magnitude
                bound = Bound(magnitude, a.bound.places + b.bound.places)
            else:
                magnitude = a.bound.magnitude + b.bound.magnitude
                bound = Bound(magnitude, max(a.bound.places, b.bound.places))
            if bound.exact:
                break
            a, b = self.reduced(a, type), self.reduced(b, type)
        form = "{} * {}" if product else op
        return Piece(f"({form.format(a.text, b.text)})", bound)

    def scaled(self, a: Piece, kind: str) -> Piece:
        """A quotient or floored remainder by a power of two."""
        power = self.pick((1, 2, 0, -1, 3))
        divisor = 2.0**power
        sign = self.pick(("", "-"))
        if kind == "remainder":
            bound = Bound(max(divisor, 1.0), max(a.bound.places, -power, 0))
            return Piece(f"({a.text} % ({sign}{divisor!r}))", bound)
        if self.chance(50):
            bound = Bound(a.bound.magnitude / divisor + 1.0, 0)
            return Piece(f"({a.text} // ({sign}{divisor!r}))", bound)
        bound = Bound(a.bound.magnitude / divisor, max(a.bound.places + power, 0))
        return Piece(f"({a.text} / ({sign}{divisor!r}))", bound) if bound.exact else a

    def rounded(self, a: Piece, type: str) -> Piece:
        """A function of one argument."""
        name = self.pick(("-", "abs", "floor", "ceil", "round", "trunc", "fract", "sign", "clamp"))
        if name == "-":
            return Piece(f"(-{a.text})", a.bound)
        if name == "clamp":
            held = f"clamp({a.text}, {self.same(type, -2.5)}, {self.same(type, 3.25)})"
            return Piece(held, Bound(3.25, max(a.bound.places, 2)))
        if name in ("abs", "fract"):
            bound = Bound(max(a.bound.magnitude, 1.0), a.bound.places)
        else:
            bound = Bound(a.bound.magnitude + 1.0, 0)
        return Piece(f"{name}({a.text})", bound)

    def vector_product(self, type: str, kind: str, depth: int) -> Piece:
        if kind == "dot":
            vector = self.pick(("vec2", "vec3"))
            a, b = (self.reduced(self.expression(vector, depth - 1), vector) for _ in range(2))
            return Piece(f"dot({a.text}, {b.text})", Bound(3.0 * 4096.0, 6))
        a = self.reduced(self.expression(type, depth - 1), type)
        b = self.reduced(self.expression("float", depth - 1), "float")
        order = self.pick(((a, b), (b, a)))
        return Piece(f"({order[0].text} * {order[1].text})", Bound(4096.0, 6))

    def converted_float(self, type: str, depth: int) -> Piece:
        """A float from small integers or a truth value."""
        if type == "vec3":
            return Piece(f"vec3({self.expression('ivec3', depth - 1).text} & 31)", Bound(31.0, 0))
        if type == "vec2":
            source, mask = self.pick((("ivec2", "31"), ("uvec2", "uint(31)")))
            return Piece(
                f"vec2({self.expression(source, depth - 1).text} & {mask})", Bound(31.0, 0)
            )
        source = self.pick(("int", "uint", "bool"))
        inner = self.expression(source, depth - 1).text
        if source == "bool":
            return Piece(f"float({inner})", Bound(1.0, 0))
        mask = "& 63" if source == "int" else "& uint(63)"
        return Piece(f"float({inner} {mask})", Bound(63.0, 0))

    def int_operation(self, type: str, depth: int) -> str:
        kinds = ["+", "-", "*", "//", "%", "&", "|", "^", "<<", ">>", "function", "unary"]
        kinds += ["converted", "composed" if type != "int" else "element"]
        if type == "int":
            kinds += ["star", *(["method"] if self.places("Pair") else [])]
        kind = self.pick(kinds)
        if kind == "composed":
            parts = [self.expression("int", depth - 1).text for _ in range(SIZES[type])]
            return f"{type}({', '.join(parts)})"
        if kind == "element":
            return self.element("int", depth) or self.literal("int").text
        if kind == "converted":
            return self.converted_int(type, depth)
        if kind == "method":
            turned = self.pick(("", ".turned()", ".turned()"))
            by = self.expression("int", depth - 1).text
            return f"{self.pick(self.places('Pair'))}{turned}.shifted({by})"
        if kind == "star":
            first = self.expression("int", depth - 1).text
            rest = self.varying(self.expression("ivec2", depth - 1).text, "ivec2")
            return self.pick((f"joined({first}, *{rest})", f"joined(*{rest}, {first}, {first})"))
        if kind == "unary":
            a = self.varying(self.expression(type, depth - 1).text, type)
            return self.pick(("(-{})", "(~{})", "abs({})", "sign({})")).format(a)
        a, b = self.operands(kind, type, depth)
        if kind == "function":
            form = self.pick(("min({0}, {1})", "max({0}, {1})", "clamp({0}, {2}, {1})"))
            return form.format(a, b, self.literal(type).text)
        return f"({a} {kind} {b})"

    def converted_int(self, type: str, depth: int) -> str:
        if type == "int":
            source = self.pick(("float", "uint", "bool"))
        else:
            source = self.pick(("vec2", "uvec2") if type == "ivec2" else ("vec3",))
        return f"{type}({self.varying(self.expression(source, depth - 1).text, source)})"

    def uint_operation(self, type: str, depth: int) -> str:
        kinds = ["+", "-", "*", "//", "%", "&", "|", "^", "<<", ">>", "function", "~", "pcg"]
        kinds += ["converted", *(["composed"] if type != "uint" else [])]
        kind = self.pick(kinds)
        if kind == "composed":
            parts = [self.expression("uint", depth - 1).text for _ in range(SIZES[type])]
            return f"{type}({', '.join(parts)})"
        if kind == "converted":
            source = self.pick(("int", "float", "bool") if type == "uint" else ("ivec2", "vec2"))
            return f"{type}({self.varying(self.expression(source, depth - 1).text, source)})"
        if kind in ("~", "pcg"):
            a = self.varying(self.expression(type, depth - 1).text, type)
            return f"(~{a})" if kind == "~" else f"pcg({a})"
        a, b = self.operands(kind, type, depth)
        if kind == "function":
            return self.pick(("min({}, {})", "max({}, {})")).format(a, b)
        return f"({a} {kind} {b})"

    def element(self, type: str, depth: int) -> str | None:
        """An element at a computed index, which may be out of range and is then clamped."""
        arrays = [n for n in ARRAYS if ARRAYS[n][0] == type]
        vectors = [n for n in SIZES if SCALAR_OF[n] == type]
        places = [p for t in (*arrays, *vectors) for p in self.places(t)]
        places = [p for p in places if not p.endswith((".xy", ".zx"))]
        if not places:
            return None
        return f"{self.pick(places)}[{self.index(min(depth, 2) - 1)}]"

    def index(self, depth: int) -> str:
        """Any int but a literal."""
        return self.varying(self.expression("int", depth).text, "int")

    def condition(self, depth: int) -> str:
        """A truth value."""
        kind = self.pick(("compare", "chain", "and", "or", "not", "vector", "variable", "same"))
        if kind == "variable" or depth <= 0:
            return self.leaf("bool").text
        if kind in ("and", "or"):
            return f"({self.condition(depth - 1)} {kind} {self.condition(depth - 1)})"
        if kind == "not":
            return f"(not {self.condition(depth - 1)})"
        if kind == "same":
            op = self.pick(("==", "!="))
            return f"({self.condition(depth - 1)} {op} {self.condition(depth - 1)})"
        if kind == "vector":
            type = self.pick(tuple(SIZES))
            a, b = (self.expression(type, depth - 1).text for _ in range(2))
            return f"{self.pick(('any', 'all'))}({a} {self.comparison()} {b})"
        type = self.pick(("int", "float", "uint"))
        a, b = (self.expression(type, depth - 1).text for _ in range(2))
        a = self.varying(a, type)
        if kind == "chain":
            c = self.expression(type, depth - 1).text
            return f"({a} {self.comparison()} {b} {self.comparison()} {c})"
        return f"({a} {self.comparison()} {b})"

    def comparison(self) -> str:
        return self.pick(("<", "<=", ">", ">=", "==", "!="))
