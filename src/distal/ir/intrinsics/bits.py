"""Declarations of the intrinsics for bits, integer quotients, conversions and hashes."""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics import derivatives, folding, meanings
from distal.ir.intrinsics.declaration import ONE, SCENE, TWO, Intrinsic, R
from distal.ir.signatures import FLOATS, INTS, UINTS, Follows, Signature, T, componentwise

BITS: Final = (
    Intrinsic("float_bits_to_int", "The bits of a float as an int.", ONE,
        (Signature((T,), Follows.AS_INT, FLOATS),), (R,), meaning=lambda xp, x: x.view(xp.int32),
        cost=1, fold=folding.reinterpreted, derivative=None, python=(), glsl="floatBitsToInt({0})",
        wgsl="bitcast<{result}>({0})"),
    Intrinsic("float_bits_to_uint", "The bits of a float as a uint.", ONE,
        (Signature((T,), Follows.AS_UINT, FLOATS),), (R,), meaning=lambda xp, x: x.view(xp.uint32),
        cost=1, fold=folding.reinterpreted, derivative=None, python=(), glsl="floatBitsToUint({0})",
        wgsl="bitcast<{result}>({0})"),
    Intrinsic("int_bits_to_float", "The float with the bits of an int.", ONE,
        (Signature((T,), Follows.AS_FLOAT, INTS),), ((1e9, 1.1e9),),
        meaning=lambda xp, x: x.view(xp.float32), cost=1, fold=folding.reinterpreted,
        derivative=derivatives.constant, python=(), glsl="intBitsToFloat({0})",
        wgsl="bitcast<{result}>({0})"),
    Intrinsic("uint_bits_to_float", "The float with the bits of a uint.", ONE,
        (Signature((T,), Follows.AS_FLOAT, UINTS),), ((1e9, 1.1e9),),
        meaning=lambda xp, x: x.view(xp.float32), cost=1, fold=folding.reinterpreted,
        derivative=derivatives.constant, python=(), glsl="uintBitsToFloat({0})",
        wgsl="bitcast<{result}>({0})"),
    Intrinsic("truncated_quotient", "Quotient toward zero; b is not 0 and the result in range.",
        TWO, (componentwise(2, INTS + UINTS),), (R, (1.0, 9.0)),
        meaning=meanings.truncated_quotient, cost=8,
        fold=folding.by_component(folding.truncated_quotient), derivative=None, python=(),
        glsl="({0} / {1})", wgsl="({0} / {1})", hidden=True),
    Intrinsic("saturated_int", "float to int as the target does it, of a value in range.", ONE,
        (Signature((T,), Follows.AS_INT, FLOATS),), (R,), meaning=lambda xp, x: x.astype(xp.int32),
        cost=1, fold=folding.in_range, derivative=None, python=(), glsl="{result}({0})",
        wgsl="{result}({0})", hidden=True),
    Intrinsic("saturated_uint", "float to uint as the target does it, of a value in range.", ONE,
        (Signature((T,), Follows.AS_UINT, FLOATS),), ((0.0, 10.0),),
        meaning=lambda xp, x: x.astype(xp.uint32), cost=1, fold=folding.in_range, derivative=None,
        python=(), glsl="{result}({0})", wgsl="{result}({0})", hidden=True),
    Intrinsic("pcg", "A well mixed hash (PCG) of a uint, or of 2 to 4 uints at once.", ONE,
        (componentwise(1, UINTS),), ((0.0, 4e9),), scene="hashes.pcg", cost=8,
        fold=folding.not_folded, derivative=None, python=(), glsl=SCENE, wgsl=SCENE, llvm=SCENE),
)  # fmt: skip
