"""A program as several LLVM modules: each function is defined once, and the values are the same."""

from __future__ import annotations

import re

import numpy as np
import pytest

from distal.backends import llvm
from distal.backends.llvm import emit_for, emit_modules
from distal.devices import cpu
from distal.devices.cache import Cache
from distal.devices.features import chosen_level
from distal.devices.jit import compile_object, compile_objects
from distal.frontend import lower
from tests.unit.llvm.test_functions import INDEPENDENT, LANES, module_of, scene

DEFINED = re.compile(r'^define (?:internal |hidden )?[^@]*(@"?[\w.]+"?)\(', re.M)
DECLARED = re.compile(r'^declare hidden [^@]*(@"?[\w.]+"?)\(', re.M)


@pytest.fixture
def short_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    """Programs of any length are divided."""
    monkeypatch.setattr(llvm, "LEAST_LENGTH", 1000)


def test_each_function_is_defined_in_one_module(short_modules: None) -> None:
    whole = emit_for(module_of(INDEPENDENT), LANES).text
    texts, _ = emit_modules(module_of(INDEPENDENT), LANES, most=3)
    assert len(texts) == 3
    defined = [set(DEFINED.findall(text)) for text in texts]
    assert set.union(*defined) == set(DEFINED.findall(whole))
    assert sum(map(len, defined)) == len(DEFINED.findall(whole))
    for own, text in zip(defined, texts, strict=True):
        assert set(DECLARED.findall(text)) == set(DEFINED.findall(whole)) - own
    # The two variants of the field are the longest functions: they are apart.
    assert sum('define hidden { <8 x float> } @"field.v' in text for text in texts) == 2


def test_a_short_program_is_one_module() -> None:
    texts, _ = emit_modules(module_of(INDEPENDENT), LANES, most=8)
    assert texts == [emit_for(module_of(INDEPENDENT), LANES).text]


def test_values_and_the_stored_kernel_are_those_of_one_module(
    short_modules: None, monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    points = np.random.default_rng(1).uniform(-3, 3, (500, 3)).astype(np.float32)
    found = []
    for most in (1, 2):
        monkeypatch.setattr("distal.devices.threads.usable_threads", lambda most=most: most)
        cache = Cache(tmp_path_factory.mktemp("cache"))
        for hit in (False, True):
            kernel = cpu.prepare(lower(scene(INDEPENDENT)), cache=cache)
            assert kernel.stats["cache_hit"] is hit
            found.append(np.asarray(kernel.evaluate([points], {}, {})).tobytes())
    assert len(set(found)) == 1


def test_a_mistake_in_one_module_is_raised() -> None:
    good = "define void @f() { ret void }"
    with pytest.raises(RuntimeError, match="parsing error"):
        compile_objects([good, "define void @g() {"], chosen_level(), 2)
    assert compile_objects([good], chosen_level(), 2) == [compile_object(good, chosen_level())]
