"""Random expressions of scene code that are smooth almost everywhere.

Input: a source of chance, names in scope by type. Output: Python text of a wanted
type. Knows nothing of statements. Values stay in a range where finite differences in 64 bits mean
something: divisors are at least 1, arguments of exp and the like are bounded first. Every visible
row of the table that has a derivative has a rule here; a test counts them.
"""

from __future__ import annotations

import random
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

# {f} a float, {v} a vector of one size in the whole rule, {w} a small float in [-1, 1], {c} a
# positive constant, {k} any constant, {n} the size, {b} a condition, {u} a unit vector like {v}.
FLOATS: Final = (
    "({f} + {f})",
    "({f} - {f})",
    "({f} * {f})",
    "({f} / (1.5 + {f} ** 2))",
    "(-{f})",
    "({w} ** 3)",
    "({c} ** {w})",
    "({f} % {c})",
    "({f} % (2.5 + {w}))",
    "(0.2 * ({f} // {c}))",
    "({f} if {b} else {f})",
    "select({b}, {f}, {f})",
    "abs({f})",
    "(sign({f}) * {f})",
    "(floor({f}) * {w})",
    "(ceil({f}) * {w})",
    "(round({f}) + {f})",
    "(trunc({f}) + {f})",
    "fract({f})",
    "min({f}, {f})",
    "max({f}, {f}, {f})",
    "clamp({f}, {w} - 1.2, {w} + 1.2)",
    "mod({f}, {c})",
    "mix({f}, {f}, {f})",
    "(step({w}, {f}) * {f})",
    "smoothstep({w} - 1.3, {w} + 1.3, {f})",
    "radians(40.0 * {f})",
    "(0.02 * degrees({f}))",
    "sqrt({f} ** 2 + 1.0)",
    "inversesqrt(0.5 + {f} ** 2)",
    "exp({w})",
    "exp(-({f} ** 2))",
    "exp2({w})",
    "log(1.0 + {f} ** 2)",
    "log2(1.5 + {w})",
    "pow(abs({f}) + 0.5, {c})",
    "pow(1.5 + {w}, {w})",
    "sin({k} * {f})",
    "cos({k} * {f})",
    "tan({w})",
    "asin(0.9 * {w})",
    "acos(0.9 * {w})",
    "atan({f})",
    "atan2({f}, 1.5 + {w})",
    "atan2({f} + 0.37, {f})",
    "sinh({w})",
    "cosh({w})",
    "tanh({f})",
    "length({v})",
    "length({v} - {v})",
    "distance({v}, {v})",
    "dot({v}, {v})",
    "dot({v}, sin({v}))",
    "determinant({m} + mat{n}(1.9))",
    "{m}[{i}][{i}]",
    "{v}[{i}]",
    "{v}[int({f})]",
)
VECTORS: Final = (
    "({v} + {v})",
    "({v} - {f})",
    "({v} * {v})",
    "({f} * {v})",
    "({v} / (1.5 + {f} ** 2))",
    "(-{v})",
    "({v} % {c})",
    "({v} if {b} else {v})",
    "select({v} < {v}, {v}, {v})",
    "abs({v})",
    "min({v}, {f})",
    "max({v}, {v})",
    "clamp({v}, -{c}, {c})",
    "mix({v}, {v}, {f})",
    "smoothstep(-1.5, {c}, {v})",
    "fract({v})",
    "sqrt({v} ** 2 + 1.0)",
    "exp(sin({v}))",
    "sin({k} * {v})",
    "cos({v})",
    "tanh({v})",
    "pow(abs({v}) + 0.5, vec{n}({c}))",
    "log(1.0 + {v} ** 2)",
    "(1.3 * {u})",
    "reflect({v}, {u})",
    "refract({u}, {u}, 0.8 + 0.2 * {w})",
    "faceforward({v}, {v}, {v})",
    "({m} @ {v})",
    "({v} @ {m})",
    "{m}[{i}]",
)
# Nothing here is zero by design, such as the cross product of a vector with itself: contraction
# leaves 1e-17 in its place, and a floor or a sign of that may be anything.
ONLY_VEC3: Final = (
    "cross({v} + vec3(0.4, -0.9, 1.3), {v} * vec3(0.7, 1.2, -0.9))",
    "cross(vec3(-0.8, 0.5, 1.1) - {v}, {v} * vec3(-1.1, 0.6, 0.8))",
)
MATRICES: Final = (
    "({m} @ {m})",
    "({m} + {m})",
    "({f} * {m})",
    "transpose({m})",
    "outer({v}, {v})",
    "inverse(mat{n}(3.5) + {s})",
    "mat{n}(1.0 + {w})",
)
_MARK: Final = re.compile(r"\{(\w)\}")
LETTERS: Final = "xyzw"


class Grammar:
    """Makes expressions; ``names`` is what is in scope, by type, one list for each block."""

    def __init__(self, source: random.Random, leave_out: frozenset[str] = frozenset()) -> None:
        self.source = source
        self.names: list[tuple[str, str]] = []
        self._floats = _without(FLOATS, leave_out)
        self._vectors = _without(VECTORS, leave_out)

    @contextmanager
    def block(self) -> Iterator[None]:
        """Names made inside are gone afterwards."""
        count = len(self.names)
        yield
        del self.names[count:]

    def named(self, type: str) -> list[str]:
        """The names of a type in scope."""
        return [name for name, t in self.names if t == type]

    def expression(self, type: str, depth: int) -> str:
        """An expression of float, vec2 to vec4 or mat2 to mat4."""
        if type == "float":
            return self.float(depth)
        size = int(type[-1])
        return self.vector(size, depth) if type[0] == "v" else self.matrix(size, depth)

    def constant(self) -> str:
        """A number, bracketed if negative."""
        value = round(self.source.uniform(-1.8, 1.8), 2) or 0.5
        return f"({value})" if value < 0 else str(value)

    def positive(self) -> str:
        """A number from 0.6 to 2.4."""
        return str(round(self.source.uniform(0.6, 2.4), 2))

    def float(self, depth: int) -> str:
        """A float."""
        if depth <= 0 or self.source.random() < 0.12:
            return self._float_leaf()
        return self._filled(self.source.choice(self._floats), self._size(), depth)

    def vector(self, size: int, depth: int) -> str:
        """A vector."""
        if depth <= 0 or self.source.random() < 0.15:
            return self._vector_leaf(size, depth)
        rules = self._vectors + ONLY_VEC3 if size == 3 else self._vectors
        return self._filled(self.source.choice(rules), size, depth)

    def matrix(self, size: int, depth: int) -> str:
        """A matrix."""
        known = self.named(f"mat{size}")
        if known and self.source.random() < 0.5:
            return self.source.choice(known)
        if depth <= 0 or self.source.random() < 0.3:
            parts = (self.float(depth - 2) for _ in range(size * size))
            return f"mat{size}({', '.join(parts)})"
        return self._filled(self.source.choice(MATRICES), size, depth)

    def condition(self, depth: int) -> str:
        """A truth value that changes with the point."""
        kind = self.source.random()
        simple = f"{self.float(depth)} {self.source.choice('<>')} {self.float(depth - 1)}"
        if kind < 0.7:
            return f"({simple})"
        if kind < 0.85:
            return f"({simple} {self.source.choice(('and', 'or'))} {self.float(depth - 1)} < 0.4)"
        size = self._size()
        return f"{self.source.choice(('any', 'all'))}({self.vector(size, 0)} < {self.constant()})"

    def small(self, depth: int) -> str:
        """A float in [-1, 1]."""
        inner = self.float(depth - 1)
        return f"sin({inner})" if self.source.random() < 0.6 else f"tanh({inner})"

    def _size(self) -> int:
        return self.source.choice((2, 3, 3, 4))

    def _filled(self, rule: str, size: int, depth: int) -> str:
        return _MARK.sub(lambda mark: self._part(mark[1], size, depth - 1), rule)

    def _part(self, mark: str, size: int, depth: int) -> str:
        match mark:
            case "f":
                return self.float(depth)
            case "w":
                return self.small(depth)
            case "v":
                return self.vector(size, depth)
            case "u":
                # Long enough that its length is not near 0.
                return f"normalize(sin({self.vector(size, depth)}) + vec{size}(1.7))"
            case "m":
                return self.matrix(size, depth - 1)
            case "s":
                return f"mat{size}({', '.join(f'0.4 * {self.small(1)}' for _ in range(size**2))})"
            case "b":
                return self.condition(depth)
            case "c":
                return self.positive()
            case "k":
                return self.constant()
            case "i":
                return str(self.source.randrange(size))
            case "n":
                return str(size)
            case _:
                raise AssertionError(mark)

    def _float_leaf(self) -> str:
        if self.source.random() < 0.1:
            return self.constant()
        found = [(name, t) for name, t in self.names if t[0] != "m"]
        # What was made last is the likeliest, so that little of a field is dead code.
        name, type = self.source.choice(found[-5:] if self.source.random() < 0.6 else found)
        if type == "float":
            return name
        return f"{name}.{self.source.choice(LETTERS[: int(type[-1])])}"

    def _vector_leaf(self, size: int, depth: int) -> str:
        known = self.named(f"vec{size}")
        if known and self.source.random() < 0.5:
            return self.source.choice(known)
        others = [(v, n) for n in (2, 3, 4) for v in self.named(f"vec{n}")]
        if others and self.source.random() < 0.7:
            name, count = self.source.choice(others)
            return f"{name}.{''.join(self.source.choices(LETTERS[:count], k=size))}"
        return f"vec{size}({', '.join(self.float(depth - 1) for _ in range(size))})"


def _without(rules: tuple[str, ...], words: frozenset[str]) -> tuple[str, ...]:
    return tuple(r for r in rules if not words & set(re.findall(r"\w+", r)))
