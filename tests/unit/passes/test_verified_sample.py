"""Which outputs of passes are verified: each, those of a sample of modules, or none."""

from __future__ import annotations

from dataclasses import replace

import pytest

from distal.backends import get_target
from distal.compiler import driver
from distal.frontend import lower
from distal.ir.nodes import Module
from distal.ir.verify import Verifier
from distal.lang import func
from distal.passes.pipeline import PASS_NAMES

EACH = [None, *PASS_NAMES]


@func
def doubled(x: float) -> float:
    return x + x


def named(name: str) -> Module:
    module = lower(doubled)
    (function,) = module.functions
    return replace(module, functions=(replace(function, name=name),), entry=name)


@pytest.fixture
def verified(monkeypatch: pytest.MonkeyPatch):
    """The stages that are verified of a module, for a value of the variable."""
    seen: list[str | None] = []
    verify = Verifier.verify

    def watched(self: Verifier, module: Module, stage: str | None = None) -> None:
        seen.append(stage)
        verify(self, module, stage)

    def stages(module: Module, variable: str, after: str | None = None) -> list[str | None]:
        seen.clear()
        monkeypatch.setattr(driver, "VERIFY", variable)
        driver.run_passes(module, get_target("llvm"), after=after)
        return list(seen)

    monkeypatch.setattr(Verifier, "verify", watched)
    return stages


def test_all_or_nothing(verified):
    assert verified(named("doubled"), "1") == EACH
    assert verified(named("doubled"), "") == []


def test_of_a_sample_each_pass_and_of_all_the_last(verified):
    found = [verified(named(f"doubled_{i}"), "sample") for i in range(60)]
    assert [stages for stages in found if stages not in (EACH, [PASS_NAMES[-1]])] == []
    assert 5 <= found.count(EACH) <= 25  # 15 are expected; the checksums of names are no lot
    assert found == [verified(named(f"doubled_{i}"), "sample") for i in range(60)]


def test_the_last_is_the_one_after_which_passes_end(verified):
    found = [verified(named(f"doubled_{i}"), "sample", after="fold") for i in range(20)]
    whole = EACH[: EACH.index("fold") + 1]
    assert [stages for stages in found if stages not in (whole, ["fold"])] == []
    assert ["fold"] in found
