"""Long functions are cut into pieces of the same meaning; work grows with length only."""

from __future__ import annotations

import cProfile
import pstats
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from distal.backends import emit, get_target
from distal.backends.numpy.interpreter import evaluate
from distal.compiler.driver import run_passes
from distal.frontend import lower
from distal.ir.target import FramePlace, Target
from distal.passes import outline
from distal.passes.cost import size
from tests.unit.frontend.evaluation import from_text
from tests.unit.passes.random_modules import Generator, check, context

CUT = Target("llvm", "llvm", FramePlace.HOST, outlined=True)


def scene(lines: int) -> Any:
    """A chain of values, with choices, loops and an array between."""
    body = ["x = p.x", "row = [p.x, p.y, p.z]", "n = 0"]
    for i in range(lines // 5):
        body += [
            f"a{i} = x * 0.5 + {i}.25",
            f"if p.y > {i}.0:",
            f"    x = a{i} + p.z",
            f"for k{i} in range({i % 3}):",
            f"    row[k{i}] = row[k{i}] * 0.5 + a{max(0, i - 9)}",
        ]
    text = "@func\ndef scene(p: vec3) -> float:\n    " + "\n    ".join(body)
    return from_text(text + "\n    return x + row[0] + row[1] + row[2]\n")


@pytest.mark.parametrize("seed", range(40))
def test_pieces_mean_the_same(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(outline, "LARGE", 4)
    monkeypatch.setattr(outline, "PIECE", 5)
    monkeypatch.setattr(outline, "LARGE_ARRAY", 2 + seed % 2)
    module = Generator(seed).module()
    check(module, outline.run(module, context(CUT)), "outline")


@pytest.fixture
def small_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """As for functions ten times as long."""
    monkeypatch.setattr(outline, "LARGE", 500)
    monkeypatch.setattr(outline, "PIECE", 120)


def test_a_long_function_is_cut_and_a_common_one_is_not(small_pieces: None) -> None:
    llvm = get_target("llvm")
    function = scene(300)
    module = run_passes(lower(function), llvm)
    pieces = [f for f in module.functions if f.apart]
    assert len(pieces) > 4
    assert max(size(f.body) for f in module.functions) < 2 * outline.PIECE
    # The backend does not put them together again.
    assert emit(module, llvm).text.count("define internal {") >= len(pieces)
    assert not any(f.apart for f in run_passes(lower(scene(50)), llvm).functions)
    points = np.random.default_rng(1).uniform(-9.0, 60.0, (50, 3)).astype(np.float32)
    given = [np.ascontiguousarray(points.T)]
    whole = run_passes(lower(function), replace(llvm, outlined=False))
    wanted = evaluate(whole, given, {}, {})
    assert np.array_equal(evaluate(module, given, {}, {}), wanted)
    assert np.allclose(function(points), wanted, rtol=1e-5)


@pytest.mark.parametrize("target", ["llvm", "wgsl"])
def test_work_grows_with_length_and_not_with_its_square(target: str, small_pieces: None) -> None:
    description = get_target(target)

    def calls(lines: int) -> int:
        function = scene(lines)
        profile = cProfile.Profile()
        profile.runcall(lambda: emit(run_passes(lower(function), description), description))
        return int(pstats.Stats(profile).total_calls)  # type: ignore[attr-defined]

    calls(10)  # what is lowered once
    assert calls(240) < 6 * calls(60)
