"""Declarations of the intrinsics on matrices."""

from __future__ import annotations

from typing import Final

from distal.ir.intrinsics import derivatives, folding, meanings
from distal.ir.intrinsics.declaration import SCENE, TWO, UNIT, Intrinsic, R
from distal.ir.signatures import MATRICES, VECTORS, Follows, Signature, T, componentwise
from distal.ir.types import FLOAT

MATRIX_FUNCTIONS: Final = (
    Intrinsic("transpose", "Rows become columns.", ("m",), (componentwise(1, MATRICES),), (R,),
        meaning=lambda xp, m: xp.swapaxes(m, 0, 1), scene="matrices.transposed", cost=1,
        fold=folding.not_folded, derivative=derivatives.transposed, python=(), glsl100=SCENE),
    Intrinsic("determinant", "Determinant.", ("m",), (Signature((T,), FLOAT, MATRICES),), (UNIT,),
        scene="matrices.determinant_of", cost=5, fold=folding.not_folded,
        derivative=derivatives.determinant, python=(), glsl100=SCENE, llvm=SCENE, rtol=1e-5,
        atol=2e-6, reach=2.0**30),
    Intrinsic("inverse", "Inverse.", ("m",), (componentwise(1, MATRICES),), (UNIT,),
        scene="matrices.inverse_of", cost=16, fold=folding.not_folded,
        derivative=derivatives.inverse, python=(), glsl=SCENE, wgsl=SCENE, llvm=SCENE, rtol=1e-4,
        atol=1e-5, reach=256.0,
        edges="0 where the determinant's magnitude is below 2^-100: of a singular matrix."),
    Intrinsic("outer", "The matrix whose column i is a * b[i].", TWO,
        (Signature((T, T), Follows.SQUARE, VECTORS),), (R, R), meaning=meanings.outer,
        scene="matrices.outer_product", cost=3, fold=folding.not_folded,
        derivative=derivatives.outer, python=(), glsl="outerProduct({0}, {1})", glsl100=SCENE,
        wgsl=SCENE, llvm=SCENE),
)  # fmt: skip
