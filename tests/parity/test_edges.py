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
from distal.backends import numpy as reference_backend
from distal.compiler import run_passes
from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import host_levels
from distal.ir.build import multiply, number
from distal.ir.intrinsics import INTRINSICS
from distal.ir.types import kind_of
from tests.parity import targets
from tests.parity.edges import constant_cases, edge_cases, gradient_cases, known_cases
from tests.parity.programs import Case, Numbers, Program, program
from tests.parity.sampling import SAMPLES

ANGLES = ("sin", "cos", "tan")
OWN = ("reference", "reference 64", "llvm 64", *(f"llvm {level.name}" for level in host_levels()))
# glsl-es300 has careful functions, the others their drivers'.
DRIVERS = ("glsl-es300", "glsl-330", "wgsl-compute")
DOWN = 2.0**-900  # brings what 64 bits hold into a picture of 32; infinities and NaN stay


@dataclass(frozen=True)
class Edges:
    """All cases, and the picture of them; ``known`` has what some of them give."""

    cases: tuple[Case, ...]
    known: dict[int, Numbers]
    packed: Program


@cache
def edges(precision: int) -> Edges:
    slopes, functions = gradient_cases()
    told = [*known_cases(), *constant_cases()]
    cases = [*edge_cases(), *slopes]
    known = {len(cases) + i: values for i, (_, values) in enumerate(told)}
    cases += [case for case, _ in told]
    packed = program([_small(c) for c in cases] if precision == 64 else cases)
    module = replace(packed.module, functions=(*functions, *packed.module.functions))
    return Edges(tuple(cases), known, replace(packed, module=module))


def _small(case: Case) -> Case:
    def scaled(args, original=case.expression):
        return multiply(original(args), number(DOWN))

    return replace(case, expression=scaled)


@cache
def results(target: str) -> list[Numbers]:
    """What each case gives: (components, samples)."""
    name, _, rest = target.partition(" ")
    precision = 64 if rest == "64" else 32
    packed = edges(precision).packed
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


@pytest.mark.parametrize("target", [*OWN, *DRIVERS])
def test_ordinary_numbers_give_finite_numbers_and_slopes(target: str) -> None:
    messages = []
    for case, found in zip(edges(32).cases, results(target), strict=True):
        promised = _promised(target, case)
        for i in np.flatnonzero(~np.all(np.isfinite(found), axis=0) & promised)[:2]:
            arguments = [a[:, i].tolist() for a in case.inputs()]
            messages.append(f"{case.name} of {arguments} is {found[:, i].tolist()}")
        if _row(case) in ("sin", "cos"):
            most = 1.0 if target in OWN else 1.0 + 1e-6
            assert np.max(np.abs(found[:, promised])) <= most, case.name
    assert not messages, "\n".join(messages)


@pytest.mark.parametrize("target", [t for t in (*OWN, *DRIVERS) if not t.endswith("64")])
def test_known_numbers(target: str) -> None:
    everything, found = edges(32), results(target)
    messages = []
    for i, expected in everything.known.items():
        case, actual = everything.cases[i], found[i][:, : len(everything.known[i])]
        atol = 1e-9 if _row(case) == "normalize" else case.atol
        off = ~(np.abs(actual - expected) <= atol + max(case.rtol, 5e-6) * np.abs(expected))
        for component, sample in np.argwhere(off)[:2]:
            given = [a[:, sample].tolist() for a in case.inputs()]
            value = actual[component, sample]
            messages.append(f"{case.name} of {given} is {value}, not {expected[sample]}")
    assert not messages, "\n".join(messages)


def test_every_row_of_floats_is_asked() -> None:
    asked = {_row(case) for case in edge_cases()}
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
