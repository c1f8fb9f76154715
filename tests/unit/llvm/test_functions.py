"""Functions that the LLVM backend does not inline: how many vectors they compute, and when."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import numpy as np
import pytest

from distal.backends.llvm import TARGET, Lanes, emit_for
from distal.backends.llvm.chains import Chains
from distal.backends.llvm.costs import LaneCosts
from distal.backends.llvm.program import FEW_ROUNDS
from distal.compiler.driver import run_passes
from distal.devices import cpu, reference
from distal.frontend import lower
from distal.ir.nodes import Module
from tests.unit.frontend.evaluation import from_text

SPHERES = 60
LANES = Lanes(8, 2)


@cache
def scene(combine: str, count: int = SPHERES) -> Any:
    """A function that calls a field twice, once where only some lanes do.

    The field is made of spheres; ``combine`` is an expression of ``total`` and of a sphere's value.
    """
    lines = ["@func", "def field(p: vec3) -> float:", "    total = length(p) - 0.25"]
    for i in range(count):
        sphere = f"length(p - vec3({0.3 * i}, {-0.2 * i}, 1)) - 0.2"
        lines.append(f"    total = {combine.replace('SPHERE', sphere)}")
    lines += [
        "    return total",
        "@func",
        "def scene(p: vec3) -> float:",
        "    near = field(p)",
        "    if near < 2.0:",
        "        near = near + field(p + vec3(0.5))",
        "    return near",
    ]
    return from_text("\n".join(lines) + "\n")


INDEPENDENT = "min(total, SPHERE)"
CHAINED = "length(vec3(total + p.x, SPHERE, 1))"


def module_of(combine: str, count: int = SPHERES) -> Module:
    return run_passes(lower(scene(combine, count)), TARGET, 32)


def definitions(text: str) -> list[str]:
    """The names of the functions that are not kernels, with what follows the author's name."""
    return re.findall(r'^define internal [^@]*@"([^"]+)"', text, re.M)


def test_a_function_of_independent_parts_computes_one_vector() -> None:
    text = emit_for(module_of(INDEPENDENT), LANES).text
    assert set(definitions(text)) == {"field.v.1", "field.vm.1"}
    assert text.count('@"field.v.1"(') == 1 + LANES.chunks
    assert text.count('@"field.vm.1"(') == 1 + LANES.chunks


def test_a_vector_without_active_lanes_is_skipped() -> None:
    text = emit_for(module_of(INDEPENDENT), LANES).text
    for before in text.split('call { <8 x float> } @"field.vm.1"(')[:-1]:
        label = re.findall(r"^(\w+):$", before, re.M)[-1]
        assert re.search(rf"br i1 %\w+, label %{label}, label %\w+", before)


def test_a_function_of_one_chain_computes_all_vectors() -> None:
    text = emit_for(module_of(CHAINED), LANES).text
    assert set(definitions(text)) == {"field.v", "field.vm"}


def test_a_short_function_is_inlined() -> None:
    assert not definitions(emit_for(module_of(INDEPENDENT, 3), LANES).text)


def test_the_longest_chain_of_a_function() -> None:
    """A chain of minima waits once for the first distance, then one instruction for each."""
    chains = {}
    for count in (10, 40):
        module = module_of(INDEPENDENT, count)
        field = next(f for f in module.functions if f.name == "field")
        chains[count] = Chains(module.functions, LaneCosts(module.functions)).of(field.name)
    assert chains[40] - chains[10] == 30


@pytest.mark.parametrize("combine", [INDEPENDENT, CHAINED])
@pytest.mark.parametrize("level", ["avx512", "avx2", "sse4.2"])
def test_calls_of_vectors_give_the_values_of_the_reference(combine: str, level: str) -> None:
    module = lower(scene(combine))
    try:
        kernel = cpu.prepare(module, features=level)
    except ValueError as error:
        pytest.skip(f"this processor lacks {level}: {error}")
    points = np.random.default_rng(3).uniform(-6.0, 18.0, (999, 3)).astype(np.float32)
    (found,) = (kernel.evaluate([points], {}, {}),)
    wanted = reference.prepare(module, precision=64).evaluate([points.astype(float)], {}, {})
    assert np.allclose(found, wanted, rtol=2e-5, atol=2e-5)


def test_a_large_function_with_a_short_loop_computes_one_vector() -> None:
    def text(rounds: int) -> str:
        source = from_text(
            "@func\n"
            f"def field(p: vec3) -> float:\n    total = length(p)\n    for i in range({rounds}):\n"
            "        total = min(total, length(p - float(i)))\n"
            + "".join(
                f"    total = min(total, length(sqrt(abs(p * {i}.5)) + sqrt(abs(p - {i}.25))))\n"
                for i in range(SPHERES)
            )
            + "    return total\n"
            "@func\ndef scene(p: vec3) -> float:\n    return field(p) + field(p + vec3(0.5))\n"
        )
        return emit_for(run_passes(lower(source), TARGET, 32), LANES).text

    assert definitions(text(8)) == ["field.v.1"]
    assert definitions(text(FEW_ROUNDS + 1)) == ["field.v"]
