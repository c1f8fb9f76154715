"""Running scene functions on the reference, for tests of passes."""

import numpy as np

from distal.backends.numpy import interpreter as reference
from distal.compiler.prelude_library import PreludeLibrary
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.target import Target
from distal.ir.verify import verify
from distal.passes import bounds, entry
from distal.passes.context import Context
from distal.passes.decompose import decompose
from distal.passes.gradient import gradient
from distal.passes.specialise import specialise

PASSES = (
    ("entry", entry),
    ("specialise", specialise),
    ("gradient", gradient),
    ("decompose", decompose),
    ("specialise-prelude", specialise),
    ("bounds", bounds),
)


def passed(func, after="bounds", target: Target = reference.TARGET, precision=64) -> Module:
    """A function lowered and taken through the passes, each verified."""
    module = lower(func)
    verify(module)
    context = Context(target, PreludeLibrary(), precision)
    for name, one in PASSES:
        module = one.run(module, context)
        verify(module, name)
        if name == after:
            break
    return module


def evaluate(module: Module, *args, precision=64):
    """The entry's value; a point is (components, lanes)."""
    return reference.evaluate(module, args, {}, {}, precision)


def points(size: int, count: int = 200, reach: float = 2.0, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-reach, reach, (size, count))
