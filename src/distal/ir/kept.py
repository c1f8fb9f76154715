"""Keep what is computed of a function: an edited program has most functions of the one before.

Input: a pure computation of an IR function. Output: the same, which looks up what it computed last.
Long functions are left out: their size would not be worth the memory.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, Final, TypeVar, cast

from distal.ir.nodes import Function

FUNCTIONS_KEPT: Final = 1024
LONGEST_KEPT: Final = 256  # statements

Compute = TypeVar("Compute", bound=Callable[..., Any])


def kept(compute: Compute) -> Compute:
    """Wrap a computation whose first argument is a function, and whose others are hashable."""
    known = lru_cache(maxsize=FUNCTIONS_KEPT)(compute)

    @wraps(compute)
    def found(function: Function, *rest: Any) -> Any:
        is_short = len(function.body) <= LONGEST_KEPT
        return known(function, *rest) if is_short else compute(function, *rest)

    return cast(Compute, found)
