"""Sheets have no inside, and are seen through glass and by paths as other shapes are."""

from __future__ import annotations

import pytest

from distal import AmbientLight, Camera, Disc, Quad, Scene, Sphere, TriangleSheet, glass, matte

SHEETS = [
    Quad((-1, -1, -1.5), (1, -1, -1.5), (1, 1, -1.5), (-1, 1, -1.5)),
    TriangleSheet((-2, -1, -1.5), (2, -1, -1.5), (0, 2, -1.5)),
    Disc(1.0).rotate(x=1.5708).translate(z=-1.5),
]


@pytest.mark.parametrize("mode", ["direct", "path"])
@pytest.mark.parametrize("sheet", SHEETS, ids=lambda s: s.name)
def test_a_sheet_is_seen_through_glass(sheet, mode):
    scene = Scene(
        sheet.paint(matte((1.0, 0.0, 0.0))) | Sphere(0.5).paint(glass()),
        camera=Camera((0.0, 0.0, 4.0)),
        lights=AmbientLight(1.0),
        background="#ffffff",
        floor=False,
        ambient_occlusion=0.0,
    )
    middle = scene.render(size=(9, 9), mode=mode, samples=16).linear[4, 4, :3]
    # The front mirrors 4 % of the white background, the back some of that again.
    assert middle[0] == pytest.approx(1.0, abs=0.03)
    assert middle[1] == pytest.approx(0.08, abs=0.08)
