"""The table of built-ins is complete by its types alone."""

import builtins
import math

import numpy as np
import pytest

from distal.ir.intrinsics import INTRINSICS, Intrinsic, python_functions
from distal.ir.intrinsics.folding import not_folded
from distal.ir.signatures import UNARY


def test_a_declaration_says_its_cost_folding_derivative_and_python_names() -> None:
    columns = {"cost": 1, "fold": not_folded, "derivative": None, "python": ()}
    Intrinsic("f", "A function.", ("x",), (UNARY,), ((0.0, 1.0),), **columns)  # type: ignore[arg-type]
    for name in columns:
        rest = {n: v for n, v in columns.items() if n != name}
        with pytest.raises(TypeError, match=name):
            Intrinsic("f", "A function.", ("x",), (UNARY,), ((0.0, 1.0),), **rest)  # type: ignore[arg-type]


def test_python_names_exist_and_mean_one_intrinsic() -> None:
    names = [name for intrinsic in INTRINSICS.values() for name in intrinsic.python]
    assert len(names) == len(set(names))
    for module, prefix in ((builtins, ""), (math, "math"), (np, "numpy")):
        for function, intrinsic in python_functions(prefix).items():
            assert callable(getattr(module, function)), function
            assert intrinsic in INTRINSICS
