"""Declarations of the intrinsics on vectors and on vectors of bools."""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics import derivatives, folding, meanings
from distal.ir.intrinsics.declaration import NOT_NEGATIVE, ONE, SCENE, TWO, UNIT, Intrinsic, R
from distal.ir.signatures import BOOL_VECTORS, FLOATS, VECTORS, Follows, Signature, T, componentwise
from distal.ir.types import BOOL, FLOAT, VEC3

_PAIR_TO_FLOAT = Signature((T, T), FLOAT, VECTORS)
_VECTOR_PAIR = componentwise(2, VECTORS)

VECTOR_FUNCTIONS: Final = (
    Intrinsic("length", "Euclidean length.", ("v",), (Signature((T,), FLOAT, VECTORS),), (R,),
        meaning=meanings.length, cost=4, fold=folding.stepwise(folding.length),
        derivative=derivatives.length, python=(), rtol=1e-6, results=NOT_NEGATIVE),
    Intrinsic("distance", "length(a - b).", TWO, (_PAIR_TO_FLOAT,), (R, R),
        scene="vectors.distance_between", cost=4, fold=folding.stepwise(folding.distance),
        derivative=derivatives.distance, python=(), llvm=SCENE, rtol=1e-6, results=NOT_NEGATIVE),
    Intrinsic("dot", "Inner product.", TWO, (_PAIR_TO_FLOAT,), (R, R), meaning=meanings.dot,
        cost=2, fold=folding.stepwise(folding.dot), derivative=derivatives.dot, python=(),
        rtol=1e-6, atol=2e-5),
    Intrinsic("cross", "Vector product, right-handed.", TWO,
        (Signature((VEC3, VEC3), VEC3, (VEC3,)),), (R, R), meaning=meanings.cross, cost=4,
        fold=folding.stepwise(folding.cross), derivative=derivatives.cross, python=(), rtol=1e-6,
        atol=2e-5),
    Intrinsic("normalize", "The vector of length 1 in the direction of v.", ("v",),
        (componentwise(1, VECTORS),), ((0.1, 10.0),), scene="vectors.normalized", cost=5,
        fold=folding.stepwise(folding.normalized), derivative=derivatives.normalized, python=(),
        llvm=SCENE, rtol=1e-6, atol=1e-6, guarded=True,
        edges="normalize(0) = 0; a vector shorter than 2^-63 (2^-511 in 64 bits) stays shorter "
        "than 1."),
    Intrinsic("reflect", "Direction ``incident`` mirrored at the unit ``normal``.",
        ("incident", "normal"), (_VECTOR_PAIR,), (UNIT, UNIT), scene="vectors.reflected", cost=4,
        fold=folding.not_folded, derivative=derivatives.reflected, python=(), llvm=SCENE, rtol=1e-6,
        atol=2e-6, reach=2.0**40),
    Intrinsic("refract",
        "Unit ``incident`` refracted at unit ``normal``, eta = n1 / n2; zero when all is "
        "reflected.", ("incident", "normal", "eta"), (Signature((T, T, FLOAT), T, VECTORS),),
        (UNIT, UNIT, (0.5, 1.5)), scene="vectors.refracted", cost=8, fold=folding.not_folded,
        derivative=derivatives.refracted, python=(), llvm=SCENE, rtol=1e-5, atol=2e-6,
        reach=2.0**20),
    Intrinsic("faceforward", "n if dot(incident, reference) < 0 else -n.",
        ("n", "incident", "reference"), (componentwise(3, VECTORS),), (R, R, R),
        scene="vectors.facing_forward", cost=4, fold=folding.not_folded,
        derivative=derivatives.facing_forward, python=(), wgsl="faceForward({0}, {1}, {2})",
        llvm=SCENE),
    Intrinsic("any", "True if a component is.", ("v",), (Signature((T,), BOOL, BOOL_VECTORS),),
        ((0.0, 1.0),), meaning=lambda xp, v: xp.any(v, axis=0), cost=1, fold=folding.any_true,
        derivative=None, python=("any",)),
    Intrinsic("all", "True if every component is.", ("v",), (Signature((T,), BOOL, BOOL_VECTORS),),
        ((0.0, 1.0),), meaning=lambda xp, v: xp.all(v, axis=0), cost=1, fold=folding.all_true,
        derivative=None, python=("all",)),
    Intrinsic("anywhere", "True if a condition holds; may be true for a neighboring pixel's sake.",
        ("condition",), (Signature((T,), BOOL, (BOOL,)),), ((0.0, 1.0),),
        meaning=lambda xp, condition: condition, cost=1,
        fold=folding.unchanged, derivative=None, python=(), glsl="{0}", wgsl="{0}", hidden=True,
        edges="On the CPU it is one value for all pixels that are computed together."),
    Intrinsic("isnan", "True for not-a-number; promised on CPU and reference only.", ONE,
        (Signature((T,), Follows.AS_BOOL, FLOATS),), (R,), meaning=lambda xp, x: xp.isnan(x),
        scene="bits.is_nan", cost=1, fold=folding.never, derivative=None, python=("math.isnan",),
        glsl100="@bits.is_unordered", wgsl=SCENE),
    Intrinsic("isinf", "True for an infinity; promised on CPU and reference only.", ONE,
        (Signature((T,), Follows.AS_BOOL, FLOATS),), (R,), meaning=lambda xp, x: xp.isinf(x),
        scene="bits.is_infinite", cost=1, fold=folding.never, derivative=None,
        python=("math.isinf",), glsl100="@bits.is_beyond_range", wgsl=SCENE),
)  # fmt: skip
