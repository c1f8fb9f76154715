"""Fuse products with sums: ``a * b + c`` becomes a call of ``llvm.fma``, which rounds once.

Input: the lines of a function. Output: lines with the calls. LLVM's flag ``contract`` would let it
fuse them itself, but its levels of optimization choose differently, so that pictures would depend
on the level. As LLVM does, a product is fused if its only use is a sum or difference in the same
block: if it has more uses, as in ``x - floor(x)``, all must see the same value.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from typing import Final

_OPERATION: Final = re.compile(r"  (%v\d+) = f(mul|add|sub) (<[^>]*>|float|double) (.+), (.+)")
_NAME: Final = re.compile(r"%v\d+")
_BITS: Final = {"float": "f32", "double": "f64"}


def fused(lines: Sequence[str], declarations: set[str]) -> list[str]:
    """Return the lines of a function with fused products.

    Args:
        lines: Instructions, labels and empty lines; an entry may have several lines.
        declarations: The declarations of the module; those of the called functions are added.
    """
    names = Counter(_NAME.findall("\n".join(lines)))
    products: dict[str, tuple[int, str, str]] = {}  # of this block: the line and both factors
    result = list(lines)
    for i, line in enumerate(lines):
        if line.endswith(":"):
            products.clear()
        operation = _OPERATION.fullmatch(line)
        if operation is None:
            continue
        name, op, type, lhs, rhs = operation.groups()
        if op == "mul":
            if names[name] == 2:  # its definition and one use
                products[name] = i, lhs, rhs
        elif lhs in products or rhs in products:
            product, c = (lhs, rhs) if lhs in products else (rhs, lhs)
            at, a, b = products[product]
            result[at] = result[i] = ""
            if op == "sub":  # a * b - c, or c - a * b
                negated = f"{name}.negated"
                result[i] = f"  {negated} = fneg {type} {c if product == lhs else a}\n"
                a, c = (a, negated) if product == lhs else (negated, c)
            result[i] += f"  {name} = {fused_product(type, a, b, c, declarations)}"
    return result


def fused_product(type: str, a: str, b: str, c: str, declarations: set[str]) -> str:
    """Return the instruction for ``a * b + c``, rounded once.

    Args:
        type: The type of the operands, a float or a vector of floats.
        a: The first factor.
        b: The second factor.
        c: The summand.
        declarations: The declarations of the module; that of the called function is added.
    """
    *count, scalar = type.strip("<>").split(" x ")
    function = f"@llvm.fma.{''.join(f'v{n}' for n in count)}{_BITS[scalar]}"
    declarations.add(f"declare {type} {function}({type}, {type}, {type})")
    return f"call {type} {function}({type} {a}, {type} {b}, {type} {c})"
