"""Pieces also for trees that are drawn faster without."""

from __future__ import annotations

import pytest

from distal.scene.lowering.pieces import brick_table, table


@pytest.fixture
def always_pieces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few shapes, and shapes that are everywhere, have pieces, too."""
    monkeypatch.setattr(table, "LEAST_HARD", table.LEAST_PARTS)
    for module in (table, brick_table):
        monkeypatch.setattr(module, "LARGEST_SHARE", 1.0)
