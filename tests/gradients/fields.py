"""Random fields as modules of scene code.

Input: a seed and the size of the point. Output: the text of a module with ``field``
(a float function of the point) and ``both`` (its value and gradient). A field is made of locals,
branches, loops, arrays, structs, matrices, functions and captured locals around the expressions of
``grammar``.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from tests.gradients.grammar import LETTERS, Grammar

POINT_SIZES: Final = (3, 2, 3, 2, 3, 4, 2, 1)

HEADER: Final = """\
from __future__ import annotations

from collections.abc import Callable

from distal.lang import *

TABLE = (0.4, -0.7, 1.1)


@struct
class Part:
    distance: float
    index: int
    place: vec3
    sizes: array[float, 2]


@func
def twice(plane: Callable[[vec2], float], q: vec2) -> float:
    return plane(q) - 0.5 * plane(q.yx + 0.3)


@func
def halved(v: Vectors) -> Vectors:
    return 0.5 * v
"""


@dataclass(frozen=True, slots=True)
class Field:
    """The text of one random field, and how its point is typed."""

    text: str
    size: int

    @property
    def point(self) -> str:
        """The point's type."""
        return _type(self.size)


def _type(size: int) -> str:
    return "float" if size == 1 else f"vec{size}"


def make_field(seed: int, leave_out: frozenset[str] = frozenset()) -> Field:
    """The field of a seed, without rules that use the words left out."""
    size = POINT_SIZES[seed % len(POINT_SIZES)]
    writer = Writer(random.Random(f"field {seed}"), leave_out)
    text = HEADER + writer.functions() + writer.field(size)
    both = f"""

@func
def both(p: {_type(size)}) -> tuple[float, {_type(size)}]:
    return value_and_gradient(field, p)
"""
    return Field(text + both, size)


class Writer:
    """Writes the functions of one module."""

    def __init__(self, source: random.Random, leave_out: frozenset[str]) -> None:
        self.source = source
        self.grammar = Grammar(source, leave_out)
        self.lines: list[str] = []
        self._made = 0
        self._depth = 0

    def functions(self) -> str:
        """A plain helper, one that gives a struct, one that gives a tuple."""
        texts = [
            self._function("shaped(v: vec3, k: float) -> float", "float"),
            self._function("part(v: vec3) -> Part", "Part"),
            self._function("pair(v: vec2, w: vec3) -> tuple[float, vec3]", "pair"),
        ]
        return "".join(texts)

    def field(self, size: int) -> str:
        """The field itself: several statements and a return."""
        self.grammar.names = [("p", _type(size))]
        self.lines = ["", "", "@func", f"def field(p: {_type(size)}) -> float:"]
        self._depth = 1
        shapes = list(self._shapes())
        for shape in self.source.sample(shapes, 4):
            shape()
        floats = self.grammar.named("float")[-4:]
        vectors = [f"{v}.x * {v}.y" for v in self.grammar.named("vec3")[-3:]]
        total = " + ".join(f"atan({name})" for name in floats + vectors)
        self._write(f"return {self.grammar.float(3)}{total and ' + '}{total}")
        return "\n".join(self.lines) + "\n"

    def _shapes(self) -> tuple[Callable[[], None], ...]:
        return (
            self._local,
            self._swizzle,
            self._branch,
            self._loop,
            self._while,
            self._array,
            self._vectors_array,
            self._struct,
            self._tuple,
            self._matrix,
            self._helper,
            self._lambda,
            self._nested,
            self._slope,
            self._early,
        )

    def _write(self, line: str) -> None:
        self.lines.append("    " * self._depth + line)

    def _new(self, type: str, value: str | None = None, depth: int = 2) -> str:
        """A local of a type, assigned."""
        value = self.grammar.expression(type, depth) if value is None else value
        name = f"{type[0]}{self._made}"
        self._made += 1
        self._write(f"{name} = {value}")
        self.grammar.names.append((name, type))
        return name

    def _fresh(self, letter: str) -> str:
        self._made += 1
        return f"{letter}{self._made - 1}"

    def _f(self, depth: int = 2) -> str:
        return self.grammar.float(depth)

    def _v(self, size: int = 3, depth: int = 2) -> str:
        return self.grammar.vector(size, depth)

    def _function(self, header: str, result: str) -> str:
        self.lines = ["", "", "@func", f"def {header}:"]
        self.grammar.names = [("v", "vec3"), ("k", "float")]
        if result == "pair":
            self.grammar.names = [("v", "vec2"), ("w", "vec3")]
        elif result == "Part":
            self.grammar.names = [("v", "vec3")]
        self._depth = 1
        self._local()
        if self.source.random() < 0.5:
            self._write(f"if {self.grammar.condition(1)}:")
            self._write(f"    return {self._result(result)}")
        self._write(f"return {self._result(result)}")
        return "\n".join(self.lines) + "\n"

    def _result(self, result: str) -> str:
        match result:
            case "float":
                return self._f()
            case "pair":
                return f"{self._f()}, {self._v()}"
            case _:
                index = self.source.randrange(4)
                return f"Part({self._f()}, {index}, {self._v()}, [{self._f(1)}, {self._f(1)}])"

    # Statements. Each leaves at least one name behind that the next may use.

    def _local(self) -> None:
        name = self._new("float")
        self._new(_type(self.source.choice((2, 3, 4))))
        self._write(f"{name} {self.source.choice('+-*')}= {self._f()}")

    def _swizzle(self) -> None:
        size = self.source.choice((2, 3, 4))
        name = self._new(_type(size))
        count = self.source.randint(1, size)
        letters = "".join(self.source.sample(LETTERS[:size], count))
        self._write(f"{name}.{letters} = {self.grammar.expression(_type(count), 2)}")
        self._write(f"{name} = halved({name})")
        self._write(f"{name} *= {self._f(1)}")

    def _branch(self) -> None:
        name, other = self._new("float"), self._new("vec3")
        self._write(f"if {self.grammar.condition(2)}:")
        self._indented(lambda: self._assign(name, "float"))
        if self.source.random() < 0.4:
            self._write(f"elif {self.grammar.condition(1)}:")
            self._indented(lambda: self._assign(other, "vec3"))
        self._write("else:")
        self._indented(lambda: (self._assign(name, "float"), self._assign(other, "vec3")))

    def _indented(self, write: Callable[[], object]) -> None:
        self._depth += 1
        with self.grammar.block():
            write()
        self._depth -= 1

    def _assign(self, name: str, type: str) -> None:
        if self.source.random() < 0.3:
            self._new(self.source.choice(("float", "vec2", "vec3")))
        self._write(f"{name} = {self.grammar.expression(type, 2)}")

    def _loop(self) -> None:
        name, vector, i = self._new("float"), self._new("vec3"), self._fresh("i")
        bounds = self.source.choice(("3", "1, 5", "4, 0, -1", "0, 6, 2"))
        self._write(f"for {i} in range({bounds}):")

        def body() -> None:
            self.grammar.names.append((f"(0.3 * float({i}))", "float"))
            self._write(f"{vector} = 0.7 * {vector}.yzx + sin({self._v()})")
            if self.source.random() < 0.3:
                self._write(f"if {self.grammar.condition(1)}:")
                self._write("    continue")
            self._write(f"{name} = 0.6 * {name} + {self._f()}")
            self._write(f"if {name} > {self.grammar.positive()}:")
            self._write("    break")

        self._indented(body)

    def _while(self) -> None:
        name, i = self._new("float"), self._fresh("i")
        self._write(f"{i} = 0")
        self._write(f"while {i} < 4 and {name} < {self.grammar.positive()}:")

        def body() -> None:
            self._write(f"{name} = 0.5 * {name} + abs({self.grammar.small(2)}) + 0.2")
            self._write(f"{i} += 1")

        self._indented(body)

    def _array(self) -> None:
        name, i, each = self._fresh("r"), self._fresh("i"), self._fresh("e")
        self._write(f"{name} = [{self._f()}, {self._f()}, {self._f(1)}]")
        total = self._new("float", f"{name}[1]")
        self._write(f"for {i} in range(3):")
        self._indented(
            lambda: self._write(f"{name}[{i}] = 0.5 * {name}[{i}] + TABLE[{i}] * {self._f(1)}")
        )
        self._write(f"for {each} in {name}:")
        how = self.source.choice(("min({0}, {1})", "max({0}, {1})", "0.5 * {0} + {1} * {1}"))
        self._indented(lambda: self._write(f"{total} = {how.format(total, each)}"))
        self._write(f"{name}[int(3.0 * abs({self.grammar.small(1)}))] += {self._f(1)}")
        self.grammar.names += [(f"{name}[{k}]", "float") for k in range(3)]

    def _vectors_array(self) -> None:
        name, i = self._fresh("r"), self._fresh("i")
        self._write(f"{name} = [{self._v()}, {self._v(3, 1)}]")
        self._write(f"for {i} in range(2):")
        letter = self.source.choice("xyz")
        self._indented(lambda: self._write(f"{name}[{i}].{letter} = {self._f()} * TABLE[{i}]"))
        self.grammar.names += [(f"{name}[0]", "vec3"), (f"{name}[1]", "vec3")]

    def _struct(self) -> None:
        name = self._fresh("h")
        self._write(f"{name} = part({self._v()})")
        self._write(f"{name}.place.{self.source.choice(('y', 'xz', 'zyx'))} *= {self._f(1)}")
        self._write(f"{name}.sizes[{self.source.randrange(2)}] += {self._f(1)}")
        copy = self._fresh("h")
        self._write(f"{copy} = {name} if {self.grammar.condition(1)} else part({self._v(3, 1)})")
        self._write(f"{name}.distance = {copy}.distance * {copy}.sizes[1]")
        for part in (name, copy):
            self.grammar.names += [(f"{part}.distance", "float"), (f"{part}.place", "vec3")]
            self.grammar.names += [(f"{part}.sizes[0]", "float")]
        self._new("float", f"{self._f(1)} if {copy}.index > 1 else {name}.distance")

    def _tuple(self) -> None:
        first, second = self._fresh("f"), self._fresh("v")
        self._write(f"{first}, {second} = pair({self._v(2)}, {self._v(3)})")
        self.grammar.names += [(first, "float"), (second, "vec3")]
        other = self._new("float")
        self._write(f"{first}, {other} = {other}, 0.5 * {first}")

    def _matrix(self) -> None:
        size = self.source.choice((2, 3, 3, 4))
        name = self._new(f"mat{size}")
        self._write(f"{name}[{self.source.randrange(size)}] = {self._v(size)}")
        self._new(_type(size), f"{name} @ {self._v(size, 1)}")
        self._new("float", f"0.3 * determinant({name} + mat{size}(1.3))")

    def _helper(self) -> None:
        self._new("float", f"shaped({self._v()}, {self._f(1)}) - shaped({self._v(3, 1)}, 0.4)")

    def _lambda(self) -> None:
        kept = self._new("float")
        with self.grammar.block():
            self.grammar.names.append(("q", "vec2"))
            body = f"{self._f()} * {kept} + {self._f(1)}"
        self._new("float", f"twice(lambda q: {body}, {self._v(2)})")

    def _nested(self) -> None:
        kept, name = self._new("vec3"), self._fresh("g")
        self._write(f"def {name}(q: vec2) -> float:")

        def body() -> None:
            self.grammar.names.append(("q", "vec2"))
            self._new("float", f"dot({kept}.xy, q)")
            self._write(f"return {self._f()}")

        self._indented(body)
        self._new("float", f"twice({name}, {self._v(2)})")

    def _slope(self) -> None:
        with self.grammar.block():
            self.grammar.names.append(("q", "vec3"))
            body = self._f(2)
        place = self._v(3, 1)
        self._new("vec3", f"gradient(lambda q: {body}, {place})")

    def _early(self) -> None:
        self._write(f"if {self.grammar.condition(2)}:")
        self._write(f"    return {self._f()}")
        self._new("float")
