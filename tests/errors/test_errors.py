"""Every file in ``cases/`` fails to compile, with exactly the message kept beside it."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from distal.diagnostics import CompileError
from distal.frontend import lower

CASES = sorted((Path(__file__).parent / "cases").glob("*.py"))


def load(case: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location(f"case_{case.stem}", case)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("case", CASES, ids=lambda p: p.stem)
def test_message(case: Path, update_golden: bool) -> None:
    module = load(case)
    with pytest.raises(CompileError) as caught:
        lower(module.scene)
    text = str(caught.value).replace(str(case), case.name) + "\n"
    expected = case.with_suffix(".expected")
    if update_golden:
        expected.write_text(text)
    assert text == expected.read_text()


def test_there_are_many_cases() -> None:
    assert len(CASES) >= 60
    assert {c.stem for c in CASES} == {p.stem for p in CASES[0].parent.glob("*.expected")}
