"""Random functions: statements around the expressions of ``grammar``.

Input: hypothesis's choices. Output: ``Sources``, a module of functions that call
one another and an ``@image`` that runs each in columns of its own, every row with other arguments.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

from hypothesis import strategies as st

from tests.random_programs.grammar import (
    ARRAYS,
    PREAMBLE,
    SCALAR_OF,
    SIZES,
    STRUCTS,
    VALUES,
    Bound,
    Local,
    Maker,
    Piece,
    Signature,
)

ROWS: Final = 32
LOCAL_TYPES: Final = (*VALUES, *ARRAYS, *STRUCTS)
MOST_STATEMENTS: Final = 14
ANNOTATIONS: Final = {
    name: f"array[{element}, {length}]" for name, (element, length) in ARRAYS.items()
}


@dataclass(frozen=True)
class Sources:
    """A module's text.

    Attributes:
        text: The whole module.
        functions: The functions that the picture runs.
        width: The picture's width; its height is ``ROWS``.
    """

    text: str
    functions: tuple[Signature, ...]
    width: int


class FunctionMaker(Maker):
    """Makes whole functions.

    Attributes:
        left: Statements still to be made in this function.
        loops: How many loops stand around this place.
    """

    left: int = 0
    loops: int = 0

    def function(self, name: str) -> str:
        """A function's text; it may be called by the next ones."""
        others = self.draw(st.integers(0, 2))
        params = ("int", *(self.pick(VALUES) for _ in range(others)))
        count = 2 if self.chance(15) else 1
        self.results = tuple(self.pick(VALUES) for _ in range(count))
        self.locals = [Local(f"p{i}", t, writable=False) for i, t in enumerate(params)]
        self.cost, self.rounds, self.loops, self.names = 0, 1, 0, 0
        self.left, self.budget = MOST_STATEMENTS, 120
        lines = ["v0 = p0"]
        self.locals.append(Local("v0", "int", writable=False))
        lines += self.block(2, may_leave=False)
        lines.append(self.returned())
        heading = ", ".join(f"p{i}: {t}" for i, t in enumerate(params))
        result = self.results[0] if count == 1 else f"tuple[{', '.join(self.results)}]"
        self.functions.append(Signature(name, params, self.results, self.cost))
        body = "\n".join(f"    {line}" for line in lines)
        return f"@func\ndef {name}({heading}) -> {result}:\n{body}\n"

    def returned(self) -> str:
        return "return " + ", ".join(self.gathered(t) for t in self.results)

    def gathered(self, type: str) -> str:
        """A value to return that everything told by ``mixed_in`` has a part in."""
        value = self.reduced(self.expression(type, 2), type)
        scalar, size = SCALAR_OF.get(type, type), SIZES.get(type, 1)
        if scalar == "float":
            part = "float(v0 & 63)" if size == 1 else f"{type}({', '.join(['v0 & 63'] * size)})"
            return self.reduced(Piece(f"({value.text} + {part})", Bound(127.0, 3)), type).text
        if scalar == "bool":
            return f"{value.text} != ((v0 & 1) == 1)"
        part = "v0" if type == "int" else f"{type}({', '.join(['v0'] * size)})"
        return f"{value.text} ^ {part}"

    def mixed_in(self, known: int) -> list[str]:
        """Take a value bound or changed here into ``v0``, which every result depends on."""
        hashes = {"int": "{}", "uint": "int({})", "float": "int({} * 8.0)", "bool": "int({})"}
        recent = self.locals[max(known - 2, 0) :]
        places = [
            hashes[type].format(place)
            for local in recent
            if local.name != "v0"
            for type in hashes
            for place in self.parts(local.name, local.type, type)
        ]
        return [f"v0 = v0 * 31 + {self.pick(places)}"] if places else []

    def block(self, depth: int, *, may_leave: bool) -> list[str]:
        """Some statements; what they bind is forgotten after them."""
        known = len(self.locals)
        lines: list[str] = []
        for _ in range(self.draw(st.integers(1, 4 if depth < 2 else 7))):
            if self.left <= 0:
                break
            lines += self.statement(depth)
            if self.chance(70):
                lines += self.mixed_in(known)
        if may_leave and self.chance(30):
            lines.append(self.leaving())
        if depth < 2:
            del self.locals[known:]
        return lines or ["pass"]

    def leaving(self) -> str:
        """A way out of the loop or the function."""
        if self.loops and self.chance(75):
            return self.pick(("break", "continue"))
        return self.returned()

    def statement(self, depth: int) -> list[str]:
        self.left -= 1
        kinds = ["local", "assign", "assign", "part", "part", "unpack"]
        if depth > 0:
            kinds += ["if", "if", "for", "while", "each"]
        kind = self.pick(kinds)
        match kind:
            case "assign":
                return self.assignment() or self.local()
            case "part":
                return self.part_assignment() or self.local()
            case "unpack":
                return self.unpacking() or self.local()
            case "if":
                return self.branches(depth)
            case "for" | "while" | "each" if self.loops < 2:
                return self.loop(kind, depth)
            case _:
                return self.local()

    def local(self) -> list[str]:
        type = self.pick(LOCAL_TYPES)
        value = self.stored(type, 3)
        name = self.fresh("v")
        note = f": {ANNOTATIONS.get(type, type)}" if self.chance(20) else ""
        self.locals.append(Local(name, type))
        return [f"{name}{note} = {value}"]

    def assignment(self) -> list[str]:
        """A whole variable, or an operation on one in place."""
        found = [local for local in self.locals if local.writable]
        if not found:
            return []
        local = self.pick(found)
        if local.type in SCALAR_OF and SCALAR_OF[local.type] != "float" and self.chance(40):
            op = self.pick(("+=", "-=", "*=", "//=", "%=", "^=", "|=", "&=", "<<=", ">>="))
            value = self.operands(op[:-1], local.type, 2)[1]
            return [f"{local.name} {op} {value}"]
        return [f"{local.name} = {self.stored(local.type, 3)}"]

    def part_assignment(self) -> list[str]:
        """A component, swizzle, field or element, the index perhaps out of range."""
        type = self.pick(VALUES)
        places = [p for p in self.places(type, writable=True) if not p.endswith(".zx")]
        places = [p for p in places if p.endswith("]") or "." in p]
        if not places:
            return []
        place = self.pick(places)
        if place.endswith("]") and self.chance(60):
            place = f"{place[: place.rindex('[')]}[{self.index(1)}]"
        return [f"{place} = {self.stored(type, 2)}"]

    def unpacking(self) -> list[str]:
        """Both results of a function that returns a tuple."""
        fitting = [f for f in self.functions if len(f.results) == 2 and self.affordable(f)]
        if not fitting:
            return []
        function = self.pick(fitting)
        names = [self.fresh("v"), self.fresh("v")]
        line = f"{', '.join(names)} = {self.call_text(function, 2)}"
        self.locals += [Local(n, t) for n, t in zip(names, function.results, strict=True)]
        return [line]

    def branches(self, depth: int) -> list[str]:
        lines = [f"if {self.condition(2)}:", *self.indented(depth)]
        if self.chance(25):
            lines += [f"elif {self.condition(2)}:", *self.indented(depth)]
        if self.chance(50):
            lines += ["else:", *self.indented(depth)]
        return lines

    def indented(self, depth: int) -> list[str]:
        return [f"    {line}" for line in self.block(depth - 1, may_leave=True)]

    def loop(self, kind: str, depth: int) -> list[str]:
        before: list[str] = []
        after: list[str] = []
        name = self.fresh("i")
        known = len(self.locals)
        rounds = self.draw(st.integers(1, 4))
        if kind == "while":
            # The counter goes up first, so that no continue can skip it.
            before = [f"{name} = 0"]
            head = f"while {name} < {rounds} and {self.condition(2)}:"
            after = [f"    {name} += 1"]
            self.locals.append(Local(name, "int", writable=False))
        elif kind == "each":
            head, element = self.each(name)
            self.locals.append(Local(name, element, writable=False))
        else:
            head = f"for {name} in range({self.range_of(rounds)}):"
            self.locals.append(Local(name, "int", writable=False))
        self.loops, self.rounds = self.loops + 1, self.rounds * rounds
        body = self.indented(depth)
        self.loops, self.rounds = self.loops - 1, self.rounds // rounds
        del self.locals[known:]
        return [*before, head, *after, *body]

    def range_of(self, rounds: int) -> str:
        """Bounds of a loop of about so many rounds, known before or not."""
        if self.chance(40):
            return f"{self.index(1)} % {rounds + 1}"
        if self.chance(50):
            return str(rounds)
        start, step = self.pick((-3, 0, 5)), self.pick((1, 2, -1, -3))
        return f"{start}, {start + step * rounds}, {step}"

    def each(self, name: str) -> tuple[str, str]:
        found = [local for local in self.locals if local.type in ARRAYS]
        others = [local for local in found if ARRAYS[local.type][0] == "int"]
        if others and self.chance(50):
            # The element is the one that the name stands for; the other name goes unread.
            pair, array = f"{name}, {name}_b", self.pick(others).name
            return self.pick(
                (
                    (f"for {pair} in enumerate({array}):", "int"),
                    (f"for {name}_b, {name} in enumerate({array}, {self.index(1)}):", "int"),
                    (f"for {pair} in zip({array}, {self.pick(found).name}):", "int"),
                    (
                        f"for {name}_b, ({pair}_b) in enumerate(zip({array}, range(9, 0, -2))):",
                        "int",
                    ),
                )
            )
        if found:
            local = self.pick(found)
            return f"for {name} in {local.name}:", ARRAYS[local.type][0]
        return f"for {name} in [{self.stored('int', 1)}, {self.stored('int', 1)}]:", "int"


def argument(type: str, number: int) -> str:
    """An argument made from the row: small numbers of both signs, and some large ones."""
    if type in SIZES:
        scalar = SCALAR_OF[type]
        parts = (argument(scalar, 5 * number + i) for i in range(SIZES[type]))
        return f"{type}({', '.join(parts)})"
    step, offset = 2 * number + 7, 3 * number + 1
    match type:
        case "int":
            small = f"((row * {step} + {offset}) % 23 - 11)"
            return f"({small} * 195225786 if row % 8 == 7 else {small})"
        case "uint":
            return f"uint((row * {step} + {offset}) % 37 * (1 if row % 4 < 3 else 116080197))"
        case "float":
            return f"(float((row * {step} + {offset}) % 129 - 64) * 0.125)"
        case _:
            return f"((row * {step} + {offset}) % 3 == 0)"


def channels(name: str, type: str) -> list[str]:
    """A value as floats that hold it exactly."""
    if type in SIZES:
        lanes = "xyz"[: SIZES[type]]
        return [c for lane in lanes for c in channels(f"{name}.{lane}", SCALAR_OF[type])]
    if type in ("float", "bool"):
        return [f"float({name})"]
    bits = f"uint({name})"
    return [f"float({bits} & uint(65535))", f"float({bits} >> uint(16))"]


def column(number: int, function: Signature) -> tuple[str, int]:
    """The text that shows a function's results, and how many columns it takes."""
    args = ", ".join(argument(t, 3 * number + i) for i, t in enumerate(function.params))
    names = [f"r{i}" for i in range(len(function.results))]
    shown = [c for n, t in zip(names, function.results, strict=True) for c in channels(n, t)]
    shown += ["0.0"] * (-len(shown) % 4)
    pixels = [f"vec4({', '.join(shown[i : i + 4])})" for i in range(0, len(shown), 4)]
    lines = ["@func", f"def show{number}(row: int, part: int) -> vec4:"]
    lines.append(f"    {', '.join(names)} = {function.name}({args})")
    for i, pixel in enumerate(pixels[:-1]):
        lines += [f"    if part == {i}:", f"        return {pixel}"]
    lines.append(f"    return {pixels[-1]}")
    return "\n".join(lines) + "\n", len(pixels)


@st.composite
def sources(draw: Any, functions: int = 8) -> Sources:
    """A module of random functions and the picture that runs them."""
    maker = FunctionMaker(draw)
    texts = [PREAMBLE, *(maker.function(f"f{i}") for i in range(functions))]
    picture = ["@image", "def picture(frame: Frame) -> vec4:"]
    picture += ["    column = int(frame.coord.x)", "    row = int(frame.coord.y)"]
    width = 0
    for number, function in enumerate(maker.functions):
        text, pixels = column(number, function)
        texts.append(text)
        picture.append(f"    if column < {width + pixels}:")
        picture.append(f"        return show{number}(row, column - {width})")
        width += pixels
    texts.append("\n".join([*picture, "    return vec4(0.0)"]) + "\n")
    return Sources("\n\n".join(texts), tuple(maker.functions), width)
