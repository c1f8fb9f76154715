"""The one table of built-in functions.

A row is everything the system knows about a built-in: its types, its one-sentence meaning, its
definition, how each target spells it, how far targets may differ, where tests sample it. Type
checks, error hints, every backend, the generated stub, the parity tests and the reference page
read it here. To add a built-in, add a row.

A row's definition is either ``meaning`` (NumPy, taking the array module as its first argument) or
``scene``: the name of a function in ``distal.lang.prelude``, scene code, which then is the
meaning on every target. Spellings for a target family:

- ``None``: the target has it under the row's own name, meaning the same;
- a template: ``{0}`` is the first argument; arguments arrive bracketed where needed;
- ``SCENE``: the target calls the row's ``scene`` function;
- ``"@name"``: the target calls that other prelude function (the CPU's elementary functions).

The target families are glsl (ES 3.00, 3.30, Shadertoy), glsl100 (ES 1.00; ``None`` there means
"as glsl"), wgsl and llvm (``None`` there: the LLVM backend makes it itself). The NumPy reference
runs ``meaning``, or the scene function.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from distal.ir import derivatives, limits, meanings
from distal.ir.limits import Held
from distal.ir.signatures import (
    BINARY,
    BOOL_VECTORS,
    FLOATS,
    INTS,
    MATRICES,
    NUMBERS,
    SIGNED,
    TERNARY,
    UINTS,
    UNARY,
    VECTORS,
    Follows,
    Signature,
    T,
    componentwise,
)
from distal.ir.types import BOOL, FLOAT, VEC3

SCENE: Final = "@"


@dataclass(frozen=True, slots=True)
class Intrinsic:
    """One row.

    Attributes:
        name: How an author writes it.
        doc: One sentence; angles in radians.
        args: The names of the arguments.
        signatures: The types it takes; tried in order.
        domain: For each argument, the closed interval that tests sample (floats; ints likewise).
        meaning: NumPy definition, or None when ``scene`` is the definition.
        scene: The prelude function that defines it or can stand for it.
        rtol: Relative disagreement allowed between any two targets; 0 means equal bits.
        atol: Absolute disagreement allowed.
        glsl: Spelling; see the module's text.
        glsl100: Spelling for GLSL ES 1.00 where it differs from ``glsl``.
        wgsl: Spelling.
        llvm: Spelling.
        careful: The prelude function that stands in on targets whose drivers are rough
            (``Target.rough``); else, and where a host trusts its driver, they spell the row as
            their family does.
        derivative: The rule in ``distal.ir.derivatives``; every row that gives floats has one.
        held: Between which numbers the only argument is held before anything else; ``meaning``
            and the prelude's functions need to mean something only there.
        guarded: Targets that spell it themselves do so only where that is seen to mean the same
            (``passes.decompose_edges``); elsewhere they call the ``scene`` function too.
        edges: What it gives where mathematics has no answer or many, in a sentence. Elsewhere, and
            wherever this is empty, ordinary numbers (``limits.ORDINARY``) give a finite number.
        reach: Up to which magnitude of its arguments that holds.
        hidden: Not a name of the language: only prelude code and passes use it.
    """

    name: str
    doc: str
    args: tuple[str, ...]
    signatures: tuple[Signature, ...]
    domain: tuple[tuple[float, float], ...]
    meaning: Callable[..., Any] | None = None
    scene: str | None = None
    rtol: float = 0.0
    atol: float = 0.0
    glsl: str | None = None
    glsl100: str | None = None
    wgsl: str | None = None
    llvm: str | None = None
    careful: str | None = None
    hidden: bool = False
    derivative: derivatives.Rule | None = None
    held: Held | None = None
    guarded: bool = False
    edges: str = ""
    reach: float = limits.ORDINARY

    def spelling(self, family: str) -> str | None:
        """The spelling for a target family, with ``SCENE`` filled in as ``@name``."""
        column: str | None
        match family:
            case "glsl":
                column = self.glsl
            case "glsl100":
                column = self.glsl if self.glsl100 is None else self.glsl100
            case "wgsl":
                column = self.wgsl
            case "llvm":
                column = self.llvm
            case "numpy":
                column = SCENE if self.meaning is None else None
            case _:
                raise KeyError(family)
        return f"@{self.scene}" if column == SCENE else column


_R = (-10.0, 10.0)
_UNIT = (-1.0, 1.0)
_ONE = ("x",)
_TWO = ("a", "b")

# Tolerances are what the parity tests measure between the reference, our vector code and Mesa's
# drivers (``DISTAL_PARITY_REPORT``), times 2 to 4. The loosest are Mesa's: asin and acos are off
# by 4e-4, atan by 2e-5 of its value. exp, log, sin and the like are off by at most 8e-7 of the
# value and 5e-7 beside it; ours alone by 1.6e-7 (``tests/parity/test_elementary.py``).
_CLOSE: Final[dict[str, Any]] = {"rtol": 2e-6, "atol": 1e-6}


def _row(name: str, doc: str, *rest: Any, **columns: Any) -> Intrinsic:
    return Intrinsic(name, doc, *rest, **columns)


_COMPONENTS = (
    _row("abs", "Magnitude; the most negative int stays itself.", _ONE, (componentwise(1, SIGNED),),
         (_R,), lambda xp, x: xp.abs(x), scene="choosing.magnitude_int",
         derivative=derivatives.absolute),
    _row("sign", "-1, 0 or 1.", _ONE, (componentwise(1, SIGNED),), (_R,), meanings.sign,
         scene="choosing.sign_int", derivative=derivatives.constant),
    _row("floor", "The largest whole number not above x.", _ONE, (UNARY,), (_R,),
         lambda xp, x: xp.floor(x), derivative=derivatives.constant),
    _row("ceil", "The smallest whole number not below x.", _ONE, (UNARY,), (_R,),
         lambda xp, x: xp.ceil(x), derivative=derivatives.constant),
    _row("round", "The nearest whole number, halves to even.", _ONE, (UNARY,), (_R,),
         lambda xp, x: xp.rint(x), scene="rounding.round_half_even",
         glsl="roundEven({0})", glsl100=SCENE, derivative=derivatives.constant),
    _row("trunc", "The whole part, toward zero.", _ONE, (UNARY,), (_R,),
         lambda xp, x: xp.trunc(x), scene="rounding.truncate", glsl100=SCENE,
         derivative=derivatives.constant),
    _row("fract", "x - floor(x).", _ONE, (UNARY,), (_R,), scene="rounding.fraction", llvm=SCENE,
         derivative=derivatives.same,
         edges="From 0 to 1; 1 itself only by rounding, for negative x above -2^-24."),
    _row("min", "The smaller: b if b < a else a.", _TWO, (componentwise(2, NUMBERS),), (_R, _R),
         meanings.minimum, scene="choosing.smaller_int", glsl100="min({0}, {1})",
         derivative=derivatives.minimum),
    _row("max", "The larger: b if a < b else a.", _TWO, (componentwise(2, NUMBERS),), (_R, _R),
         meanings.maximum, scene="choosing.larger_int", glsl100="max({0}, {1})",
         derivative=derivatives.maximum),
    _row("clamp", "x held between low and high: min(max(x, low), high).", ("x", "low", "high"),
         (componentwise(3, NUMBERS),), (_R, (-5.0, 0.0), (0.0, 5.0)), scene="choosing.clamped",
         llvm=SCENE, derivative=derivatives.clamped, edges="Where low > high it is high."),
    _row("mod", "a - b * floor(a / b), the sign of b; the same as a % b.", _TWO, (BINARY,),
         (_R, (0.5, 4.0)), scene="rounding.remainder", glsl=SCENE, wgsl=SCENE, llvm=SCENE,
         rtol=2e-6, atol=2e-6, derivative=derivatives.remainder,
         edges="0 for a b below 2^-60 in magnitude: mod(a, 0) = 0."),
    _row("mix", "a + (b - a) * t.", ("a", "b", "t"), (TERNARY,), (_R, _R, (0.0, 1.0)),
         scene="choosing.mixed", llvm=SCENE, rtol=1e-6, atol=2e-6, derivative=derivatives.mixed),
    _row("step", "0 where x < edge, else 1.", ("edge", "x"), (BINARY,), (_R, _R),
         scene="choosing.stepped", llvm=SCENE, derivative=derivatives.constant),
    _row("smoothstep", "0 below low, 1 above high, 3t^2 - 2t^3 between.", ("low", "high", "x"),
         (TERNARY,), ((-5.0, -1.0), (1.0, 5.0), _R), scene="choosing.smoothstepped",
         llvm=SCENE, rtol=1e-6, atol=1e-6, guarded=True, derivative=derivatives.smoothstepped,
         edges="smoothstep(e, e, x) = step(e, x); where low > high it falls, from 1 at high to 0 "
         "at low."),
    _row("radians", "Degrees to radians.", _ONE, (UNARY,), ((-360.0, 360.0),),
         scene="choosing.to_radians", llvm=SCENE, rtol=1e-6, derivative=derivatives.to_radians),
    _row("degrees", "Radians to degrees.", _ONE, (UNARY,), (_R,), scene="choosing.to_degrees",
         llvm=SCENE, rtol=1e-6, derivative=derivatives.to_degrees),
)  # fmt: skip

_ANGLES: Final = (
    "Off by 1e-6 at most for angles to 1e4, by what the angle itself is known to beyond; beyond "
    "2^22 it is as at 2^22 (2^51 in 64 bits). Where the target's own function stands in the text, "
    "large angles are as good as its driver."
)

_ELEMENTARY = (
    _row("sqrt", "Square root.", _ONE, (UNARY,), ((0.0, 100.0),), lambda xp, x: xp.sqrt(x),
         rtol=2e-7, derivative=derivatives.square_root, held=limits.NOT_NEGATIVE,
         edges="0 below 0."),
    _row("inversesqrt", "1 / sqrt(x).", _ONE, (UNARY,), ((0.01, 100.0),),
         lambda xp, x: (1.0 / xp.sqrt(x)).astype(x.dtype), wgsl="inverseSqrt({0})", rtol=5e-7,
         derivative=derivatives.inverse_square_root, held=limits.POSITIVE,
         edges="At and below 0 that of the smallest normal number, 2^63 (2^511 in 64 bits)."),
    _row("exp", "e to the power x.", _ONE, (UNARY,), ((-20.0, 20.0),), lambda xp, x: xp.exp(x),
         llvm="@elementary.exponential", **_CLOSE, derivative=derivatives.exponential,
         held=limits.EXPONENT, edges="Above x = 87 (708 in 64 bits) it stays as large as there."),
    _row("exp2", "2 to the power x.", _ONE, (UNARY,), ((-20.0, 20.0),), lambda xp, x: xp.exp2(x),
         llvm="@elementary.exponential_base_2", **_CLOSE,
         derivative=derivatives.exponential_base_2, held=limits.EXPONENT_OF_2,
         edges="Above x = 126 (1022 in 64 bits) it stays as large as there."),
    _row("log", "Natural logarithm.", _ONE, (UNARY,), ((0.001, 100.0),), lambda xp, x: xp.log(x),
         llvm="@elementary.logarithm", **_CLOSE, derivative=derivatives.logarithm,
         held=limits.POSITIVE,
         edges="At and below 0 that of the smallest normal number, -87.3 (-708.4 in 64 bits)."),
    _row("log2", "Logarithm to base 2.", _ONE, (UNARY,), ((0.001, 100.0),),
         lambda xp, x: xp.log2(x), llvm="@elementary.logarithm_base_2", **_CLOSE,
         derivative=derivatives.logarithm_base_2, held=limits.POSITIVE,
         edges="At and below 0 that of the smallest normal number, -126 (-1022 in 64 bits)."),
    _row("pow", "max(x, 0) to the power y; 0 ** 0 = 1.", ("x", "y"), (BINARY,),
         ((-1.0, 8.0), (0.0, 8.0)), meanings.power, scene="elementary.power",
         glsl="@elementary.guarded_power", wgsl="@elementary.guarded_power", llvm=SCENE,
         rtol=4e-6, atol=1e-6, derivative=derivatives.power,
         edges="At most 2^126 (2^1022 in 64 bits), which 0 to a negative power is; what is below "
         "the smallest normal number counts as 0. A constant whole y is a product, of negative x "
         "too, and may overflow as one."),
    _row("raw_power", "x to the power y for x > 0, as the target computes it.", ("x", "y"),
         (BINARY,), ((0.01, 8.0), (0.0, 8.0)), lambda xp, x, y: xp.power(x, y),
         glsl="pow({0}, {1})", wgsl="pow({0}, {1})", scene="elementary.power", llvm=SCENE,
         rtol=4e-6, atol=1e-6, hidden=True, derivative=derivatives.power),
    _row("sin", "Sine.", _ONE, (UNARY,), (_R,), lambda xp, x: xp.sin(x),
         llvm="@elementary.sine", careful="careful.sine",
         **_CLOSE, derivative=derivatives.sine, held=limits.ANGLE, edges=_ANGLES),
    _row("cos", "Cosine.", _ONE, (UNARY,), (_R,), lambda xp, x: xp.cos(x),
         llvm="@elementary.cosine", careful="careful.cosine",
         **_CLOSE, derivative=derivatives.cosine, held=limits.ANGLE, edges=_ANGLES),
    _row("tan", "Tangent.", _ONE, (UNARY,), ((-1.4, 1.4),), lambda xp, x: xp.tan(x),
         llvm="@elementary.tangent", careful="careful.tangent",
         rtol=1e-6, atol=1e-6, derivative=derivatives.tangent, held=limits.ANGLE,
         edges=f"At a pole some large number. {_ANGLES}"),
    _row("asin", "Arc sine, from -pi/2 to pi/2.", _ONE, (UNARY,), (_UNIT,),
         lambda xp, x: xp.arcsin(x), llvm="@elementary.arc_sine", careful="elementary.arc_sine",
         rtol=5e-4, atol=5e-4,
         derivative=derivatives.arc_sine, held=limits.UNIT,
         edges="Below -1 as at -1, above 1 as at 1."),
    _row("acos", "Arc cosine, from 0 to pi.", _ONE, (UNARY,), (_UNIT,),
         lambda xp, x: xp.arccos(x), llvm="@elementary.arc_cosine", careful="elementary.arc_cosine",
         rtol=5e-4, atol=5e-4,
         derivative=derivatives.arc_cosine, held=limits.UNIT,
         edges="Below -1 as at -1, above 1 as at 1."),
    _row("atan", "Arc tangent, from -pi/2 to pi/2.", _ONE, (UNARY,), (_R,),
         lambda xp, x: xp.arctan(x), llvm="@elementary.arc_tangent", rtol=3e-5, atol=5e-6,
         derivative=derivatives.arc_tangent),
    _row("atan2", "Angle of the point (x, y), from -pi to pi; atan2(0, 0) = 0.", ("y", "x"),
         (BINARY,), (_R, _R), meanings.angle,
         scene="elementary.arc_tangent_2", glsl="@elementary.guarded_arc_tangent_2",
         wgsl="@elementary.guarded_arc_tangent_2", llvm=SCENE, rtol=3e-5, atol=5e-6,
         derivative=derivatives.arc_tangent_2),
    _row("raw_atan2", "Angle of a point that is not (0, 0), as the target computes it.", ("y", "x"),
         (BINARY,), ((0.1, 10.0), (0.1, 10.0)), lambda xp, y, x: xp.arctan2(y, x),
         scene="elementary.arc_tangent_2", glsl="atan({0}, {1})", wgsl="atan2({0}, {1})",
         llvm=SCENE, rtol=3e-5, atol=5e-6, hidden=True, derivative=derivatives.arc_tangent_2),
    _row("sinh", "Hyperbolic sine.", _ONE, (UNARY,), ((-5.0, 5.0),), lambda xp, x: xp.sinh(x),
         scene="elementary.hyperbolic_sine", glsl100=SCENE, llvm=SCENE, rtol=5e-6, atol=1e-6,
         derivative=derivatives.hyperbolic_sine, held=limits.HYPERBOLIC,
         edges="Beyond -87 and 87 (708 in 64 bits) as there."),
    _row("cosh", "Hyperbolic cosine.", _ONE, (UNARY,), ((-5.0, 5.0),), lambda xp, x: xp.cosh(x),
         scene="elementary.hyperbolic_cosine", glsl100=SCENE, llvm=SCENE, rtol=1e-6,
         derivative=derivatives.hyperbolic_cosine, held=limits.HYPERBOLIC,
         edges="Beyond -87 and 87 (708 in 64 bits) as there."),
    _row("tanh", "Hyperbolic tangent.", _ONE, (UNARY,), (_R,), lambda xp, x: xp.tanh(x),
         scene="elementary.hyperbolic_tangent", glsl100=SCENE, llvm=SCENE, rtol=1e-6, atol=1e-6,
         derivative=derivatives.hyperbolic_tangent, held=limits.LEVEL),
)  # fmt: skip

_PAIR_TO_FLOAT = Signature((T, T), FLOAT, VECTORS)
_VECTOR_PAIR = componentwise(2, VECTORS)

_GEOMETRY = (
    _row("length", "Euclidean length.", ("v",), (Signature((T,), FLOAT, VECTORS),), (_R,),
         meanings.length, rtol=1e-6, derivative=derivatives.length),
    _row("distance", "length(a - b).", _TWO, (_PAIR_TO_FLOAT,), (_R, _R),
         scene="vectors.distance_between", llvm=SCENE, rtol=1e-6, derivative=derivatives.distance),
    _row("dot", "Inner product.", _TWO, (_PAIR_TO_FLOAT,), (_R, _R), meanings.dot, rtol=1e-6,
         atol=2e-5, derivative=derivatives.dot),
    _row("cross", "Vector product, right-handed.", _TWO, (Signature((VEC3, VEC3), VEC3, (VEC3,)),),
         (_R, _R), meanings.cross, rtol=1e-6, atol=2e-5, derivative=derivatives.cross),
    _row("normalize", "The vector of length 1 in the direction of v.", ("v",),
         (componentwise(1, VECTORS),), ((0.1, 10.0),), scene="vectors.normalized",
         llvm=SCENE, rtol=1e-6, atol=1e-6, guarded=True, derivative=derivatives.normalized,
         edges="normalize(0) = 0; a vector shorter than 2^-63 (2^-511 in 64 bits) stays shorter "
         "than 1."),
    _row("reflect", "Direction ``incident`` mirrored at the unit ``normal``.",
         ("incident", "normal"), (_VECTOR_PAIR,), (_UNIT, _UNIT), scene="vectors.reflected",
         llvm=SCENE, rtol=1e-6, atol=2e-6, derivative=derivatives.reflected, reach=2.0**40),
    _row("refract", "Unit ``incident`` refracted at unit ``normal``, eta = n1 / n2; zero when all "
         "is reflected.", ("incident", "normal", "eta"), (Signature((T, T, FLOAT), T, VECTORS),),
         (_UNIT, _UNIT, (0.5, 1.5)), scene="vectors.refracted", llvm=SCENE, rtol=1e-5, atol=2e-6,
         derivative=derivatives.refracted, reach=2.0**20),
    _row("faceforward", "n if dot(incident, reference) < 0 else -n.",
         ("n", "incident", "reference"), (componentwise(3, VECTORS),), (_R, _R, _R),
         scene="vectors.facing_forward", wgsl="faceForward({0}, {1}, {2})", llvm=SCENE,
         derivative=derivatives.facing_forward),
    _row("any", "True if a component is.", ("v",), (Signature((T,), BOOL, BOOL_VECTORS),),
         ((0.0, 1.0),), lambda xp, v: xp.any(v, axis=0)),
    _row("all", "True if every component is.", ("v",), (Signature((T,), BOOL, BOOL_VECTORS),),
         ((0.0, 1.0),), lambda xp, v: xp.all(v, axis=0)),
    _row("isnan", "True for not-a-number; promised on CPU and reference only.", _ONE,
         (Signature((T,), Follows.AS_BOOL, FLOATS),), (_R,), lambda xp, x: xp.isnan(x),
         scene="bits.is_nan", glsl100="@bits.is_unordered", wgsl=SCENE),
    _row("isinf", "True for an infinity; promised on CPU and reference only.", _ONE,
         (Signature((T,), Follows.AS_BOOL, FLOATS),), (_R,), lambda xp, x: xp.isinf(x),
         scene="bits.is_infinite", glsl100="@bits.is_beyond_range", wgsl=SCENE),
)  # fmt: skip

_MATRIX = (
    _row("transpose", "Rows become columns.", ("m",), (componentwise(1, MATRICES),), (_R,),
         lambda xp, m: xp.swapaxes(m, 0, 1), scene="matrices.transposed", glsl100=SCENE,
         derivative=derivatives.transposed),
    _row("determinant", "Determinant.", ("m",), (Signature((T,), FLOAT, MATRICES),), (_UNIT,),
         scene="matrices.determinant_of", glsl100=SCENE, llvm=SCENE, rtol=1e-5, atol=2e-6,
         derivative=derivatives.determinant, reach=2.0**30),
    _row("inverse", "Inverse.", ("m",),
         (componentwise(1, MATRICES),), (_UNIT,), scene="matrices.inverse_of", glsl=SCENE,
         wgsl=SCENE, llvm=SCENE, rtol=1e-4, atol=1e-5, derivative=derivatives.inverse, reach=256.0,
         edges="0 where the determinant's magnitude is below 2^-100: of a singular matrix."),
    _row("outer", "The matrix whose column i is a * b[i].", _TWO,
         (Signature((T, T), Follows.SQUARE, VECTORS),), (_R, _R), meanings.outer,
         scene="matrices.outer_product", glsl="outerProduct({0}, {1})", glsl100=SCENE, wgsl=SCENE,
         llvm=SCENE, derivative=derivatives.outer),
)  # fmt: skip

_BITS = (
    _row("float_bits_to_int", "The bits of a float as an int.", _ONE,
         (Signature((T,), Follows.AS_INT, FLOATS),), (_R,), lambda xp, x: x.view(xp.int32),
         glsl="floatBitsToInt({0})", wgsl="bitcast<{result}>({0})"),
    _row("float_bits_to_uint", "The bits of a float as a uint.", _ONE,
         (Signature((T,), Follows.AS_UINT, FLOATS),), (_R,), lambda xp, x: x.view(xp.uint32),
         glsl="floatBitsToUint({0})", wgsl="bitcast<{result}>({0})"),
    _row("int_bits_to_float", "The float with the bits of an int.", _ONE,
         (Signature((T,), Follows.AS_FLOAT, INTS),), ((1e9, 1.1e9),),
         lambda xp, x: x.view(xp.float32), glsl="intBitsToFloat({0})",
         wgsl="bitcast<{result}>({0})", derivative=derivatives.constant),
    _row("uint_bits_to_float", "The float with the bits of a uint.", _ONE,
         (Signature((T,), Follows.AS_FLOAT, UINTS),), ((1e9, 1.1e9),),
         lambda xp, x: x.view(xp.float32), glsl="uintBitsToFloat({0})",
         wgsl="bitcast<{result}>({0})", derivative=derivatives.constant),
    _row("truncated_quotient", "Quotient toward zero; b is not 0 and the result in range.", _TWO,
         (componentwise(2, INTS + UINTS),), (_R, (1.0, 9.0)), meanings.truncated_quotient,
         glsl="({0} / {1})", wgsl="({0} / {1})", hidden=True),
    _row("saturated_int", "float to int as the target does it, of a value in range.", _ONE,
         (Signature((T,), Follows.AS_INT, FLOATS),), (_R,), lambda xp, x: x.astype(xp.int32),
         glsl="{result}({0})", wgsl="{result}({0})", hidden=True),
    _row("saturated_uint", "float to uint as the target does it, of a value in range.", _ONE,
         (Signature((T,), Follows.AS_UINT, FLOATS),), ((0.0, 10.0),),
         lambda xp, x: x.astype(xp.uint32), glsl="{result}({0})", wgsl="{result}({0})",
         hidden=True),
    _row("pcg", "A well mixed hash (PCG) of a uint, or of 2 to 4 uints at once.", _ONE,
         (componentwise(1, UINTS),), ((0.0, 4e9),), scene="hashes.pcg", glsl=SCENE, wgsl=SCENE,
         llvm=SCENE),
)  # fmt: skip

INTRINSICS: Final[dict[str, Intrinsic]] = {
    row.name: row for row in (*_COMPONENTS, *_ELEMENTARY, *_GEOMETRY, *_MATRIX, *_BITS)
}
