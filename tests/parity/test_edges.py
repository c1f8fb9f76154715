"""Built-ins at their edges: ordinary numbers give finite numbers, and the same on every target.

Decision 17. What a driver makes of large angles with a function of its own is its affair. One
picture for each target holds all of it, since compiling is what takes time here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from distal.backends import get_target
from distal.backends.numpy import interpreter as reference_backend
from distal.compiler.driver import run_passes
from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import host_levels
from distal.ir.build import multiply, number
from distal.ir.intrinsics import INTRINSICS
from distal.ir.types import Scalar, kind_of
from tests.parity import targets
from tests.parity.edges import constant_cases, edge_cases, gradient_cases
from tests.parity.programs import Case, Numbers, Program, program
from tests.parity.sampling import SAMPLES

ANGLES = ("sin", "cos", "tan")
LEVELS = tuple(f"llvm {level.name}" for level in host_levels())  # the best first
OWN = ("reference", "reference 64", "llvm 64", *LEVELS)
# glsl-es300 has careful functions, the others their drivers'.
DRIVERS = ("glsl-es300", "glsl-330", "wgsl-compute")
DOWN = 2.0**-900  # brings what 64 bits hold into a picture of 32; infinities and NaN stay


@dataclass(frozen=True)
class Edges:
    """Cases, the picture of them, and what the first samples (of constants: components) give."""

    cases: tuple[Case, ...]
    known: tuple[Numbers, ...]
    packed: Program


@cache
def edges(precision: int) -> Edges:
    told = [*edge_cases(), *constant_cases()]
    cases = [case for case, _ in told]
    packed = program([_small(c) for c in cases] if precision == 64 else cases)
    return Edges(tuple(cases), tuple(values for _, values in told), packed)


@cache
def scalars(precision: int) -> Edges:
    """Of numbers alone and without constants: what another CPU level may change."""
    told = [(c, v) for c, v in edge_cases() if all(isinstance(t, Scalar) for t in c.args)]
    cases = tuple(case for case, _ in told)
    return Edges(cases, tuple(values for _, values in told), program(cases))


@cache
def slopes(precision: int) -> Edges:
    cases, functions = gradient_cases()
    packed = program([_small(c) for c in cases] if precision == 64 else cases)
    module = replace(packed.module, functions=(*functions, *packed.module.functions))
    return Edges(tuple(cases), (), replace(packed, module=module))


def _small(case: Case) -> Case:
    def scaled(args, original=case.expression):
        return multiply(original(args), number(DOWN))

    return replace(case, expression=scaled)


@cache
def results(target: str, made=edges) -> list[Numbers]:
    """What each case gives: (components, samples)."""
    name, _, rest = target.partition(" ")
    precision = 64 if rest == "64" else 32
    packed = made(precision).packed
    module, width, buffers = packed.module, packed.width, packed.buffers
    if name == "reference":
        shaped = run_passes(module, get_target("numpy"), precision)
        picture = reference_backend.render(shaped, width, SAMPLES, {}, buffers, precision)
    elif name == "llvm":
        level = rest if precision == 32 else None
        kernel = cpu.prepare(module, precision=precision, features=level, cache=Cache(None))
        picture = kernel.render(width, SAMPLES, {}, buffers)
    else:
        try:
            picture = targets.TARGETS[name](module, width, SAMPLES, buffers)
        except targets.Unavailable as reason:
            pytest.skip(f"{target} does not run here: {reason}")
    return [found for _, found in packed.results(picture)]


def _row(case: Case) -> str:
    return case.name.removeprefix("gradient of ").split("(")[0]


def _promised(target: str, case: Case) -> Numbers:
    """In which samples: a driver's own sine is asked for angles to 100 only."""
    if _row(case) in ANGLES and target in DRIVERS[1:] and case.samples:
        return np.asarray(np.all(np.abs(case.inputs()[0]) <= 100.0, axis=0))
    return np.ones(SAMPLES, bool)


def _no_numbers(target: str, made) -> list[str]:
    messages = []
    for case, found in zip(made(32).cases, results(target, made), strict=True):
        promised = _promised(target, case)
        for i in np.flatnonzero(~np.all(np.isfinite(found), axis=0) & promised)[:2]:
            arguments = [a[:, i].tolist() for a in case.inputs()]
            messages.append(f"{case.name} of {arguments} is {found[:, i].tolist()}")
    return messages


@pytest.mark.parametrize("target", [*OWN, *DRIVERS])
def test_ordinary_numbers_give_finite_numbers(target: str) -> None:
    made = scalars if target in LEVELS[1:] else edges
    messages = _no_numbers(target, made)
    assert not messages, "\n".join(messages)
    for case, found in zip(made(32).cases, results(target, made), strict=True):
        if _row(case) in ("sin", "cos"):
            most = 1.0 if target in OWN else 1.0 + 1e-6
            assert np.max(np.abs(found[:, _promised(target, case)])) <= most, case.name


# The rules become scene code before any target is thought of: a few targets tell.
@pytest.mark.parametrize("target", ["reference", "reference 64", LEVELS[0], "glsl-330"])
def test_ordinary_numbers_have_finite_slopes(target: str) -> None:
    assert len(slopes(32).cases) > 20
    messages = _no_numbers(target, slopes)
    assert not messages, "\n".join(messages)


@pytest.mark.parametrize("target", [t for t in (*OWN, *DRIVERS) if not t.endswith("64")])
def test_known_numbers(target: str) -> None:
    """Of arguments that are read, and of the same as constants of the text."""
    messages = []
    made = scalars if target in LEVELS[1:] else edges
    everything = made(32)
    for case, known, found in zip(
        everything.cases, everything.known, results(target, made), strict=True
    ):
        actual = found[:, : len(known)] if case.args else found[:, 0]
        atol = 1e-9 if _row(case) == "normalize" else max(case.atol, 1e-6 * (not case.args))
        off = ~(np.abs(actual - known) <= atol + max(case.rtol, 5e-6) * np.abs(known))
        for place in np.argwhere(off)[:2]:
            given = [a[:, place[-1]].tolist() for a in case.inputs()]
            value, wanted = actual[tuple(place)], known[place[-1]]
            messages.append(f"{case.name} of {given} is {value}, not {wanted}")
    assert not messages, "\n".join(messages)


def test_every_row_of_floats_is_asked() -> None:
    asked = {_row(case) for case, _ in edge_cases()}
    left = {
        row.name
        for row in INTRINSICS.values()
        if not row.hidden and not any(kind_of(t) is None for s in row.signatures for t in s.over)
    } - asked
    assert left == {"any", "all", "isnan", "isinf", "pcg", *BITS}


BITS = {f"{a}_bits_to_{b}" for a, b in (("float", "int"), ("float", "uint"))} | {
    "int_bits_to_float",
    "uint_bits_to_float",
}
