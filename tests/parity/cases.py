"""Every row of the table and every operator, on every type it takes.

Input: the table. Output: cases. Which samples a promise covers is told here: off
the jumps of functions that jump, and within what the language defines.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from distal.ir import build
from distal.ir.build import builtin
from distal.ir.intrinsics import INTRINSICS, Intrinsic
from distal.ir.nodes import (
    BinaryOp,
    CompareOp,
    Construct,
    Expr,
    Field,
    LogicalOp,
    Splat,
    Unary,
    UnaryOp,
)
from distal.ir.nodes import Logical as LogicalNode
from distal.ir.signatures import BOOL_VECTORS, FLOATS, INTS, MATRICES, UINTS
from distal.ir.types import (
    BOOL,
    FLOAT,
    INT,
    UINT,
    VEC2,
    VEC3,
    VEC4,
    Array,
    Kind,
    Scalar,
    Struct,
    Type,
    Vector,
    component_count,
    kind_of,
    vector_of,
)
from tests.parity.programs import Case, Numbers
from tests.parity.sampling import samples

BOOLS: Final[tuple[Type, ...]] = (BOOL, *BOOL_VECTORS)
NUMBER_TYPES: Final = FLOATS + INTS + UINTS
Where = NDArray[np.bool_]


def kinds_of(types: Sequence[Type]) -> list[Kind]:
    """The kinds of the components of scalars, vectors and matrices."""
    kinds = [kind_of(type) for type in types]
    return [kind for kind in kinds if kind is not None]


# Where a row promises something. The arguments are (components, samples) each.


def _finite_off_cpu(args: Sequence[Numbers], on_cpu: bool) -> Where:
    return np.all(np.isfinite(args[0]), axis=0) | on_cpu


def _off_whole_quotients(args: Sequence[Numbers], on_cpu: bool) -> Where:
    """Where a last-bit difference in a / b does not change its floor."""
    a, b = args
    quotient = a / np.where(b == 0.0, 1.0, b)
    exact = np.isin(np.abs(b), (0.25, 0.5, 1.0, 2.0, 4.0, 8.0))
    near = np.abs(quotient - np.round(quotient)) < 1e-4
    return np.all((exact | ~near) & (b != 0.0), axis=0)


def _divisible(args: Sequence[Numbers], on_cpu: bool) -> Where:
    return np.all(args[1] != 0.0, axis=0)


def _well_conditioned(args: Sequence[Numbers], on_cpu: bool) -> Where:
    size = round(len(args[0]) ** 0.5)
    matrices = args[0].reshape(size, size, -1).transpose(2, 1, 0)
    return np.asarray(np.linalg.cond(matrices) < 20.0)


def _off_cuts(args: Sequence[Numbers], on_cpu: bool) -> Where:
    """Away from the negative x axis, where a zero's sign would turn the angle by 2 pi."""
    y, x = args
    return np.all((y != 0.0) | (x >= 0.0) | ~np.signbit(y), axis=0)


def _off_total_reflection(args: Sequence[Numbers], on_cpu: bool) -> Where:
    incident, normal, eta = args
    cosine = np.sum(incident * normal, axis=0)
    return np.abs(1.0 - eta[0] ** 2 * (1.0 - cosine**2)) > 0.02


def _off_right_angles(args: Sequence[Numbers], on_cpu: bool) -> Where:
    return np.abs(np.sum(args[1] * args[2], axis=0)) > 1e-3


def _within_quotients(args: Sequence[Numbers], on_cpu: bool) -> Where:
    a, b = args
    return np.all((b != 0) & ~((a == -(2.0**31)) & (b == -1)), axis=0)


def _not_zero(args: Sequence[Numbers], on_cpu: bool) -> Where:
    return np.any(args[0] != 0.0, axis=0)


def _true_or_off_cpu(args: Sequence[Numbers], on_cpu: bool) -> Where:
    """Where no neighbor's condition counts: on the CPU it may be true for theirs."""
    return np.all(args[0] != 0.0, axis=0) | (not on_cpu)


DEFINED: Final[dict[str, Callable[[Sequence[Numbers], bool], Where]]] = {
    "isnan": _finite_off_cpu,
    "isinf": _finite_off_cpu,
    "mod": _off_whole_quotients,
    "inverse": _well_conditioned,
    "atan2": _off_cuts,
    "refract": _off_total_reflection,
    "faceforward": _off_right_angles,
    "truncated_quotient": _within_quotients,
    "normalize": _not_zero,
    "anywhere": _true_or_off_cpu,
}


def table_cases() -> Iterator[Case]:
    """Each row on each of its signatures."""
    for row in INTRINSICS.values():
        for signature in row.signatures:
            for params, _ in signature.instances():
                yield _row_case(row, params)


def _row_case(row: Intrinsic, params: tuple[Type, ...]) -> Case:
    kinds = kinds_of(params)
    # Integer functions that are exact take the whole range; the rest keeps to the domain.
    whole = row.name in ("abs", "sign", "min", "max", "clamp", "pcg") and Kind.FLOAT not in kinds
    domain = None if whole else row.domain
    return Case(
        f"{row.name}({', '.join(map(str, params))})",
        params,
        lambda args: builtin(row.name, *args),
        samples(row.name, kinds, domain),
        row.rtol,
        row.atol,
        DEFINED.get(row.name),
    )


def _case(
    name: str,
    args: tuple[Type, ...],
    expression: Callable[[Sequence[Expr]], Expr],
    **tolerance: object,
) -> Case:
    """A case on whole ranges of ints and on floats from -100 to 100."""
    kinds = kinds_of(args)
    title = f"{name} ({', '.join(map(str, args))})"
    return Case(title, args, expression, samples(name, kinds, None), **tolerance)  # type: ignore[arg-type]


def operator_cases() -> Iterator[Case]:
    """Each operator, conversion and access on each type."""
    yield from _arithmetic()
    yield from _by_constants()
    yield from _matrices()
    yield from _bits()
    yield from _comparisons()
    yield from _conversions()
    yield from _access()


def _binary(op: BinaryOp, type: Type, **tolerance: object) -> Case:
    return _case(op.value, (type, type), lambda a: build.binary(op, a[0], a[1]), **tolerance)


def _arithmetic() -> Iterator[Case]:
    for type in NUMBER_TYPES:
        for op in (BinaryOp.ADD, BinaryOp.SUB, BinaryOp.MUL):
            yield _binary(op, type)
        yield _case("negate", (type,), lambda a: build.negate(a[0]))
    for type in INTS + UINTS:
        yield _binary(BinaryOp.FLOOR_DIV, type)
        yield _binary(BinaryOp.MOD, type)
    for type in FLOATS:
        yield _binary(BinaryOp.DIV, type, rtol=1e-6, defined=_divisible)
        yield _binary(BinaryOp.FLOOR_DIV, type, defined=_off_whole_quotients)
        yield _binary(BinaryOp.MOD, type, rtol=2e-6, atol=1e-5, defined=_off_whole_quotients)


def _by_constants() -> Iterator[Case]:
    """What targets treat apart: division, remainder and shifts by numbers known beforehand."""
    for type, constants in ((INT, (0, 1, -1, 2, 8, -8, 3, -7)), (UINT, (0, 1, 2, 8, 7))):
        for op in (BinaryOp.FLOOR_DIV, BinaryOp.MOD, BinaryOp.SHL, BinaryOp.SHR):
            for constant in constants:

                def applied(
                    a: Sequence[Expr], op: BinaryOp = op, type: Type = type, by: int = constant
                ) -> Expr:
                    return build.binary(op, a[0], build.number(by, type))

                yield _case(f"{op.value} {constant}", (type,), applied)


def _matrices() -> Iterator[Case]:
    for size, type in enumerate(MATRICES, start=2):
        vector = vector_of(Kind.FLOAT, size)
        for op in (BinaryOp.ADD, BinaryOp.SUB):
            yield _binary(op, type)
        for op, tolerance in ((BinaryOp.MUL, 0.0), (BinaryOp.DIV, 1e-6)):

            def scaled(a: Sequence[Expr], op: BinaryOp = op, type: Type = type) -> Expr:
                return build.binary(op, a[0], Splat(a[1], type))

            defined = _divisible if op is BinaryOp.DIV else None
            yield _case(f"{op.value} splat", (type, FLOAT), scaled, rtol=tolerance, defined=defined)
        yield _case("negate", (type,), lambda a: build.negate(a[0]))
        for args in ((type, type), (type, vector), (vector, type)):
            yield _case("@", args, lambda a: build.matmul(a[0], a[1]), rtol=1e-6, atol=5e-3)

        def column(a: Sequence[Expr], size: int = size) -> Expr:
            return build.index(a[0], _within(a[1], size))

        yield _case("column", (type, INT), column)


def _bits() -> Iterator[Case]:
    for type in INTS + UINTS:
        for op in (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR, BinaryOp.SHL, BinaryOp.SHR):
            yield _binary(op, type)
        yield _case("invert", (type,), lambda a: Unary(UnaryOp.INVERT, a[0], a[0].type))
    for type in BOOLS:
        for op in (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR):
            yield _binary(op, type)
        yield _case("not", (type,), lambda a: build.negation(a[0]))


def _comparisons() -> Iterator[Case]:
    for type in NUMBER_TYPES + BOOLS:
        for op in CompareOp:
            if kind_of(type) is Kind.BOOL and op not in (CompareOp.EQ, CompareOp.NE):
                continue

            def compared(a: Sequence[Expr], op: CompareOp = op) -> Expr:
                return build.compare(op, a[0], a[1])

            yield _case(op.value, (type, type), compared)
    for logical in LogicalOp:

        def joined(a: Sequence[Expr], op: LogicalOp = logical) -> Expr:
            return LogicalNode(op, a[0], a[1], BOOL)

        yield _case(logical.value, (BOOL, BOOL), joined)
    for type in NUMBER_TYPES + BOOLS + MATRICES:
        yield _case("select", (BOOL, type, type), lambda a: build.select(*a))
        if isinstance(type, Vector):
            mask = Vector(Kind.BOOL, type.size)
            yield _case("select each", (mask, type, type), lambda a: build.select(*a))


def _conversions() -> Iterator[Case]:
    for count in (1, 2, 3, 4):
        for before in Kind:
            for after in Kind:
                if before is after:
                    continue

                def converted(a: Sequence[Expr], kind: Kind = after) -> Expr:
                    return build.cast(a[0], kind)

                type = vector_of(before, count)
                # An int rounds to a float in the target's own way.
                rounding = 1e-7 if after is Kind.FLOAT else 0.0
                yield _case(f"to {after.value}", (type,), converted, rtol=rounding)
    for kind, edges in ((Kind.INT, _INT_ENDS), (Kind.UINT, _UINT_ENDS)):
        bits = np.resize(np.array(edges, np.float32).view(np.uint32), 64)

        def held(a: Sequence[Expr], kind: Kind = kind) -> Expr:
            return build.cast(a[0], kind)

        for type in FLOATS:
            yield Case(f"saturating to {kind.value} ({type})", (type,), held, [bits])


_INT_ENDS: Final = (
    *(2147483520.0, 2147483648.0, 3e9, -2147483648.0, -2147483904.0, -3e9, 1e30, -1e30),
    *(0.99, -0.99, 1.99, -1.99, 16777215.0, float("inf"), -float("inf"), float("nan")),
)
_UINT_ENDS: Final = (
    *(4294967040.0, 4294967296.0, 5e9, 2147483648.0, 3e9, -1.0, -0.5, -3e9, 1e30, -1e30),
    *(0.99, 1.99, 16777215.0, float("inf"), -float("inf"), float("nan")),
)


def _within(index: Expr, length: int) -> Expr:
    """A sampled int as an index that is out of range in part: -1 to ``length``."""
    wide = build.binary(BinaryOp.MOD, index, build.integer(length + 2))
    return build.subtract(wide, build.integer(1))


def _access() -> Iterator[Case]:
    for type in NUMBER_TYPES + BOOLS:
        if isinstance(type, Scalar):
            for size in (2, 3, 4):

                def splatted(a: Sequence[Expr], size: int = size) -> Expr:
                    kind = kind_of(a[0].type)
                    assert kind is not None
                    return build.splat(a[0], Vector(kind, size))

                yield _case(f"splat {size}", (type,), splatted)
            continue
        assert isinstance(type, Vector)
        for lanes in ("yx", "xxy", "yyxx"):
            yield _case(f".{lanes}", (type,), lambda a, lanes=lanes: build.swizzle(a[0], lanes))
        last = "xyzw"[type.size - 1]
        yield _case(f".{last}", (type,), lambda a, lane=last: build.swizzle(a[0], lane))

        def element(a: Sequence[Expr], size: int = type.size) -> Expr:
            return build.index(a[0], _within(a[1], size))

        yield _case("[i]", (type, INT), element)
        for outside in (-1, type.size):
            # What folds to a constant is clamped as well.
            yield _case(
                f"[{outside}]",
                (type,),
                lambda a, outside=outside: build.index(a[0], build.integer(outside)),
            )
    yield from _compositions()
    yield from _aggregates()


def _compositions() -> Iterator[Case]:
    shapes = ((FLOAT, VEC2), (VEC2, FLOAT), (VEC2, VEC2), (FLOAT, VEC2, FLOAT), (VEC3, FLOAT))
    for parts in shapes:
        result = vector_of(Kind.FLOAT, sum(component_count(p) for p in parts))

        def composed(a: Sequence[Expr], result: Type = result) -> Expr:
            return build.compose(result, *a)

        yield _case("compose", parts, composed)


def _aggregates() -> Iterator[Case]:
    pair = Struct("Pair", (("first", VEC3), ("second", INT)), False)
    for name, type in pair.fields:
        yield _case(f"select struct .{name}", (BOOL, VEC3, INT), _doubled(pair, name, type))
    for element in (FLOAT, INT, UINT, VEC2, VEC4):
        row = Array(element, 3)

        def item(a: Sequence[Expr], row: Type = row) -> Expr:
            return build.index(Construct((a[0], a[1], a[2]), row), _within(a[3], 3))

        yield _case("array[i]", (element, element, element, INT), item)


def _doubled(pair: Struct, name: str, type: Type) -> Callable[[Sequence[Expr]], Expr]:
    """One field of a struct that a condition picks whole."""

    def expression(a: Sequence[Expr]) -> Expr:
        plain = Construct((a[1], a[2]), pair)
        other = Construct((build.negate(a[1]), build.negate(a[2])), pair)
        return Field(build.select(a[0], plain, other), name, type)

    return expression
