"""The derivative rules of the intrinsics.

Input: a ``Builtin`` and, for one direction, the tangent of each argument (None where an argument
does not change). Output: the tangent of the result, an expression over the same arguments. The
``Builtin`` node itself is the function's value, for rules that need it.

Where a function has no derivative, a value is chosen: 0 for length, abs and sqrt at 0 and wherever
the true derivative is infinite; at a tie, min and max use the first argument. For ordinary numbers
no rule gives NaN or an infinity (``distal.ir.limits``).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

from distal.ir.limits import SMALLEST, SMALLEST_DIVISOR
from distal.ir.nodes import (
    BinaryOp,
    Builtin,
    CompareOp,
    Compose,
    Const,
    Expr,
    Index,
    Select,
    Unary,
    UnaryOp,
)
from distal.ir.tangents import (
    Lanes,
    Tangent,
    binary,
    compared,
    inner,
    matrix_product,
    minus,
    negative,
    number,
    over,
    picked,
    plus,
    product,
    scaled,
    splatted,
    where_above,
    where_positive,
)
from distal.ir.types import FLOAT, INT, Kind, Matrix, Type, Vector

Rule: TypeAlias = Callable[[Builtin, Lanes], Tangent]


def _call(name: str, *args: Expr, type: Type | None = None) -> Expr:
    return Builtin(name, args, args[0].type if type is None else type)


def _difference(lhs: Expr, rhs: Expr) -> Expr:
    return binary(BinaryOp.SUB, lhs, rhs)


def _sum(lhs: Expr, rhs: Expr) -> Expr:
    return binary(BinaryOp.ADD, lhs, rhs)


def _quotient(lhs: Expr, rhs: Expr) -> Expr:
    return binary(BinaryOp.DIV, lhs, rhs)


def _negated(e: Expr) -> Expr:
    return Unary(UnaryOp.NEGATE, e, e.type)


def _less(lhs: Expr, rhs: Expr) -> Expr:
    return compared(CompareOp.LT, lhs, rhs)


def _dot(lhs: Expr, rhs: Expr) -> Expr:
    return _call("dot", lhs, rhs, type=FLOAT)


def _where_normal(x: Expr, slope: Expr) -> Expr:
    """Return ``slope`` where ``x`` is above the smallest normal number, else 0."""
    none = number(0.0, slope.type)
    above = compared(CompareOp.GT, x, _call("smallest_normal", x))
    return Select(above, slope, none, slope.type)


def _finite(slope: Expr) -> Expr:
    """Clamp a derivative that may overflow to what powers are clamped to."""
    end = _call("largest_power", slope)
    return _call("min", _call("max", slope, _negated(end)), end)


def constant(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate a step function, or a function whose result is not a float: zero."""
    return None


# Rules for one argument, component by component.


def absolute(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate abs: the sign of the argument, 0 at 0."""
    return scaled(d[0], _call("sign", e.args[0]))


def same(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate fract, the argument minus a step function: the tangent is unchanged."""
    return d[0]


def to_radians(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate radians: a constant factor."""
    return scaled(d[0], number(math.pi / 180.0, e.type))


def to_degrees(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate degrees: a constant factor."""
    return scaled(d[0], number(180.0 / math.pi, e.type))


def square_root(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate sqrt: 1 / (2 sqrt(x)); 0 at 0."""
    return scaled(d[0], where_positive(e.args[0], _quotient(number(0.5, e.type), e)))


def inverse_square_root(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate inversesqrt: -1 / (2 x sqrt(x)); 0 where the argument is clamped."""
    x = e.args[0]
    slope = _quotient(product(number(-0.5, e.type), e), x)
    return scaled(d[0], _where_normal(x, _finite(slope)))


def exponential(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate exp: the function itself."""
    return scaled(d[0], e)


def exponential_base_2(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate exp2: the function itself times log 2."""
    return scaled(d[0], product(e, number(math.log(2.0), e.type)))


def logarithm(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate log: 1 / x; 0 where the argument is clamped."""
    x = e.args[0]
    return scaled(d[0], _where_normal(x, _quotient(number(1.0, e.type), x)))


def logarithm_base_2(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate log2: 1 / (x log 2); 0 where the argument is clamped."""
    x = e.args[0]
    slope = _quotient(number(1.0 / math.log(2.0), e.type), x)
    return scaled(d[0], _where_normal(x, slope))


def sine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate sin: the cosine."""
    return scaled(d[0], _call("cos", e.args[0]))


def cosine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate cos: minus the sine."""
    return scaled(d[0], _negated(_call("sin", e.args[0])))


def tangent(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate tan: 1 + tan^2."""
    return scaled(d[0], _sum(number(1.0, e.type), product(e, e)))


def _arc_slope(x: Expr) -> Expr:
    # The square of an x near 1 would lose digits of the rest.
    one = number(1.0, x.type)
    rest = product(_difference(one, x), _sum(one, x))
    return where_positive(rest, _call("inversesqrt", rest))


def arc_sine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate asin: 1 / sqrt(1 - x^2); 0 at -1 and 1."""
    return scaled(d[0], _arc_slope(e.args[0]))


def arc_cosine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate acos: -1 / sqrt(1 - x^2); 0 at -1 and 1."""
    return scaled(d[0], _negated(_arc_slope(e.args[0])))


def arc_tangent(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate atan: 1 / (1 + x^2)."""
    x = e.args[0]
    return over(d[0], _sum(number(1.0, e.type), product(x, x)))


def hyperbolic_sine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate sinh: the hyperbolic cosine."""
    return scaled(d[0], _call("cosh", e.args[0]))


def hyperbolic_cosine(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate cosh: the hyperbolic sine."""
    return scaled(d[0], _call("sinh", e.args[0]))


def hyperbolic_tangent(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate tanh: 1 / cosh^2; 1 - tanh^2 has no digits where tanh is near 1."""
    root = _quotient(number(1.0, e.type), _call("cosh", e.args[0]))
    return scaled(d[0], product(root, root))


# Rules for several arguments, component by component.


def minimum(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate min: the tangent of the smaller argument; at a tie, of the first."""
    a, b = e.args
    return picked(_less(b, a), d[1], d[0], e.type)


def maximum(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate max: the tangent of the larger argument; at a tie, of the first."""
    a, b = e.args
    return picked(_less(a, b), d[1], d[0], e.type)


def clamped(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate clamp, min(max(x, low), high)."""
    x, low, high = e.args
    raised = picked(_less(x, low), d[1], d[0], e.type)
    return picked(_less(high, _call("max", x, low)), d[2], raised, e.type)


def remainder(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate a - b * floor(a / b), with floor as a step; along b, 0 where b counts as 0."""
    a, b = e.args
    whole = _call("floor", _quotient(a, b))
    return minus(d[0], scaled(d[1], where_above(_call("abs", b), SMALLEST_DIVISOR, whole)))


def mixed(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate mix, a + (b - a) * t."""
    a, b, t = e.args
    across = plus(scaled(minus(d[1], d[0]), t), scaled(d[2], _difference(b, a)))
    return plus(d[0], across)


def smoothstepped(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate smoothstep: 6 t (1 - t) times the tangent of t = (x - low) / (high - low)."""
    low, high, x = e.args
    between = _difference(high, low)
    is_step = _less(_call("abs", between), number(SMALLEST, e.type))
    extent = Select(is_step, number(1.0, e.type), between, e.type)
    place = _quotient(_difference(x, low), extent)
    t = _call("clamp", place, number(0.0, e.type), number(1.0, e.type))
    moved = over(minus(minus(d[2], d[0]), scaled(minus(d[1], d[0]), t)), extent)
    slope = product(product(number(6.0, e.type), t), _difference(number(1.0, e.type), t))
    return picked(is_step, None, scaled(moved, slope), e.type)


def power(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate pow: along x, y x^(y-1); along y, x^y log x; 0 for x <= 0."""
    x, y = e.args
    lower = _call("pow", x, _difference(y, number(1.0, e.type)))
    along_x = scaled(d[0], _where_normal(x, _finite(product(y, lower))))
    along_y = scaled(d[1], _where_normal(x, _finite(product(e, _call("log", x)))))
    return plus(along_x, along_y)


def arc_tangent_2(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate atan2: (x dy - y dx) / (x^2 + y^2); 0 at the origin."""
    y, x = e.args
    square = _sum(product(x, x), product(y, y))
    around = minus(scaled(d[0], x), scaled(d[1], y))
    return scaled(around, _where_normal(square, _quotient(number(1.0, e.type), square)))


# Rules for vectors.


def _unit(v: Expr, length: Expr) -> tuple[Expr, Expr]:
    """Return the unit vector ``v / length`` and 1 / length; both are zero for a zero vector."""
    inverse = where_positive(length, _quotient(number(1.0, FLOAT), length))
    return product(v, inverse), inverse


def length(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate length: the component of the tangent along v; 0 for a zero vector."""
    direction, _ = _unit(e.args[0], e)
    return inner(direction, d[0])


def distance(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate length(a - b)."""
    direction, _ = _unit(_difference(e.args[0], e.args[1]), e)
    return inner(direction, minus(d[0], d[1]))


def normalized(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate normalize: the part of the tangent perpendicular to v, over the length of v."""
    v = e.args[0]
    direction, inverse = _unit(v, _call("length", v, type=FLOAT))
    along = splatted(inner(direction, d[0]), e.type)
    return scaled(minus(d[0], scaled(along, direction)), inverse)


def dot(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate dot: the product rule."""
    return plus(inner(e.args[1], d[0]), inner(e.args[0], d[1]))


def _bilinear(e: Builtin, d: Lanes) -> Tangent:
    first = None if d[0] is None else Builtin(e.name, (d[0], e.args[1]), e.type)
    second = None if d[1] is None else Builtin(e.name, (e.args[0], d[1]), e.type)
    return plus(first, second)


def cross(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate cross: the product rule."""
    return _bilinear(e, d)


def reflected(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate reflect, i - 2 dot(n, i) n."""
    incident, normal = e.args
    facing = product(number(2.0, FLOAT), _dot(normal, incident))
    turned = scaled(plus(inner(incident, d[1]), inner(normal, d[0])), number(2.0, FLOAT))
    along = plus(scaled(splatted(turned, e.type), normal), scaled(d[1], facing))
    return minus(d[0], along)


def refracted(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate refract; 0 for k < 0 (total reflection).

    The value is eta i - (eta c + sqrt(k)) n, with c = dot(n, i) and k = 1 - eta^2 (1 - c^2).
    """
    incident, normal, eta = e.args
    facing = _dot(normal, incident)
    d_facing = plus(inner(incident, d[1]), inner(normal, d[0]))
    across = _difference(number(1.0, FLOAT), product(facing, facing))
    k = _difference(number(1.0, FLOAT), product(product(eta, eta), across))
    d_k = scaled(
        minus(
            scaled(d_facing, product(product(eta, eta), facing)),
            scaled(d[2], product(eta, across)),
        ),
        number(2.0, FLOAT),
    )
    root = _call("sqrt", k)
    d_root = scaled(d_k, where_positive(k, _quotient(number(0.5, FLOAT), root)))
    along = _sum(product(eta, facing), root)
    d_along = plus(plus(scaled(d[2], facing), scaled(d_facing, eta)), d_root)
    bent = plus(scaled(splatted(d[2], e.type), incident), scaled(d[0], eta))
    change = minus(bent, plus(scaled(splatted(d_along, e.type), normal), scaled(d[1], along)))
    return picked(_less(k, number(0.0, FLOAT)), None, change, e.type)


def facing_forward(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate faceforward: plus or minus the tangent of the normal."""
    _, incident, reference = e.args
    return picked(
        _less(_dot(incident, reference), number(0.0, FLOAT)), d[0], negative(d[0]), e.type
    )


# Rules for matrices.


def transposed(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate transpose, which is linear: the transpose of the tangent."""
    return None if d[0] is None else _call("transpose", d[0])


def outer(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate the outer product: the product rule."""
    return _bilinear(e, d)


def determinant(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate determinant: sum the determinants with one column replaced by its tangent."""
    m, dm = e.args[0], d[0]
    if dm is None:
        return None
    assert isinstance(m.type, Matrix)
    size = m.type.size
    column = Vector(Kind.FLOAT, size)
    total: Tangent = None
    for k in range(size):
        columns = (Index(dm if i == k else m, Const(i, INT), column) for i in range(size))
        total = plus(total, _call("determinant", Compose(tuple(columns), m.type), type=FLOAT))
    return total


def inverse(e: Builtin, d: Lanes) -> Tangent:
    """Differentiate inverse: -m^-1 dm m^-1."""
    if d[0] is None:
        return None
    return negative(matrix_product(matrix_product(e, d[0], e.type), e, e.type))
