"""A per-frame value that nothing reads is neither computed nor declared, on no target."""

from __future__ import annotations

import pytest

from distal.ir.nodes import Module
from tests.names.programs import FAMILIES, artifacts, lowered

# ``deep`` reads a per-frame value, and the one call of it is an argument that nothing reads.
UNREAD = """
import distal.lang as zq_lang
glow = zq_lang.slider("Glow", 0.5)
@zq_lang.func
def deep(x: float) -> float:
    s = x
    for i in range(9):
        s = s * 1.5 + zq_lang.exp(glow)
    return s
@zq_lang.func
def first(x: float, unread: float) -> float:
    return x * 2.0
@zq_lang.image
def picture(f: zq_lang.Frame) -> zq_lang.vec4:
    return zq_lang.vec4(first(f.coord.x, deep(f.coord.y)))
"""


@pytest.fixture(scope="module")
def module() -> Module:
    return lowered(UNREAD)


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family[0])
def test_an_unread_value_leaves_nothing_behind(module: Module, family: tuple[str, ...]) -> None:
    for artifact in artifacts(module, family).values():
        assert not (artifact.interface.get("frame") or {}).get("values")
        text = artifact.text + (artifact.vertex or "")
        assert "exp(" not in text
        assert "Frame" not in text
        assert "frame_main" not in text
