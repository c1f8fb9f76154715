"""What a driver says about emitted text names the author's lines."""

from __future__ import annotations

import pytest

from distal.backends.base import Artifact
from distal.backends.messages import map_message

ARTIFACT = Artifact("", {}, lines=(None, ("scene.py", 7), ("/home/a/scene.py", 9)))


@pytest.mark.parametrize(
    ("said", "mapped"),
    [
        ("ERROR: 0:2: 'x' : undeclared", "ERROR: scene.py:7: 'x' : undeclared"),
        ("WARNING: 0:2: slow", "WARNING: scene.py:7: slow"),
        ("0:3(5): error: syntax", "/home/a/scene.py:9: error: syntax"),
        ("0(2) : error C1008: x", "scene.py:7 : error C1008: x"),
        ("  ┌─ wgsl:3:12\n", "  ┌─ /home/a/scene.py:9\n"),
        (":2:14 error: no matching call", "scene.py:7 error: no matching call"),
        ("ERROR: 0:1: 'x'", "ERROR: 0:1: 'x'"),
        ("ERROR: 0:99: 'x'", "ERROR: 0:99: 'x'"),
        ("nothing at all 12:30", "nothing at all 12:30"),
    ],
)
def test_message(said: str, mapped: str) -> None:
    assert map_message(ARTIFACT, said) == mapped


def test_vertex_stage_has_its_own_lines() -> None:
    artifact = Artifact("", {}, "", (("a.py", 1),), (("b.py", 2),))
    assert map_message(artifact, "ERROR: 0:1: x", vertex=True) == "ERROR: b.py:2: x"
