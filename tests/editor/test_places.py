"""Lines of an emitted text point to the shapes that they compute, not to the scene."""

from __future__ import annotations

import distal

SCENE = """\
from distal import Box, Camera, Plane, Scene, Sphere

ball = Sphere(0.5).translate(0.0, 0.5, 0.0)
block = Box(0.4, 0.3, 0.2)
block = block.rotate(y=0.3)
both = ball.union(
    block, smooth=0.1
)
scene = Scene(both | Plane(y=0.0), camera=Camera((0.0, 1.0, 4.0)))
"""


def test_each_shape_has_lines_of_its_own(tmp_path) -> None:
    file = tmp_path / "scene.py"
    file.write_text(SCENE)
    made = distal.compile(distal.load(file))
    lines = {place[1] for place in made.lines if place is not None and place[0] == str(file)}
    assert {3, 4, 5, 6, 9} <= lines
    text = [
        line
        for line, place in zip(made.text.splitlines(), made.lines, strict=True)
        if place == (str(file), 4)
    ]
    assert any(" box(" in line for line in text), text
