"""The poster of triangles in Chromium: WebGL draws what the reference decoder says."""

from __future__ import annotations

import base64
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from distal import load
from distal.export import page as pages
from distal.export.page_options import PageOptions
from distal.export.payload import description_of
from distal.scene.viewing.viewable import viewable
from distal.triangles.decoding import decode
from distal.triangles.encoding import encode
from tests.browser import SWIFTSHADER, offline_page

pytestmark = pytest.mark.usefixtures("chromium")

# Where a page's picture is read back.
READ = """(canvas) => {
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
    copy.drawImage(canvas, 0, 0);
    const { data } = copy.getImageData(0, 0, canvas.width, canvas.height);
    const letters = Array.from(data, (byte) => String.fromCharCode(byte));
    return [canvas.width, canvas.height, btoa(letters.join(""))];
}"""


def painted(height: int, width: int) -> np.ndarray:
    """A picture with a gradient, edges, a disc and some texture."""
    y, x = np.mgrid[:height, :width]
    picture = np.stack([x * 200 // width, y * 220 // height, 60 + 0 * x], -1)
    picture[np.hypot(x - 0.4 * width, y - 0.5 * height) < 0.25 * height] = (240, 30, 20)
    picture[3 * x - y > 2.2 * width] = (20, 230, 120)
    noise = np.random.default_rng(1).integers(0, 40, (height, width // 4, 1))
    picture[:, : width // 4] += noise
    return np.clip(picture, 0, 255).astype(np.uint8)


def pixels(canvas: Any) -> np.ndarray:
    """The levels of an opaque canvas."""
    width, height, data = canvas.evaluate(READ)
    found = np.frombuffer(base64.b64decode(data), np.uint8).reshape(height, width, 4)
    assert (found[..., 3] == 255).all()
    return found[..., :3]


def document(file: bytes, width: int, height: int) -> str:
    script = pages.TRIANGLES.read_text(encoding="utf-8")
    data = base64.b64encode(file).decode("ascii")
    return (
        f'<!doctype html><canvas data-triangles="{data}" width="{width}" height="{height}"'
        f' style="width:{width}px;height:{height}px"></canvas>'
        f'<script type="module">{script}</script>'
    )


@pytest.mark.parametrize(("height", "width"), [(60, 90), (33, 70), (1, 1), (100, 7)])
def test_webgl_draws_what_the_reference_decodes(tmp_path: Path, height: int, width: int) -> None:
    file = encode(painted(height, width), price=60.0)
    path = tmp_path / "p.html"
    path.write_text(document(file, width, height), encoding="utf-8")
    with offline_page(path, flags=SWIFTSHADER) as watched:
        canvas = watched.page.locator("canvas:not([data-triangles])")
        canvas.wait_for()
        found = pixels(canvas)
        assert watched.complaints == []
    # 8 bits of the canvas, and the rasterizer's fixed point on cuts of one pixel's width.
    assert found.shape == (height, width, 3)
    assert np.abs(found.astype(int) - decode(file)).max() <= 2


def test_broken_data_leaves_a_warning_and_no_error(tmp_path: Path) -> None:
    file = encode(painted(40, 40))
    path = tmp_path / "p.html"
    path.write_text(document(file[: len(file) // 2], 40, 40), encoding="utf-8")
    with offline_page(path, flags=SWIFTSHADER) as watched:
        watched.page.wait_for_timeout(200)
        assert watched.complaints == [
            "warning: The still picture cannot be drawn: The picture's data ends too early."
        ]


def test_a_page_shows_the_triangles_before_its_first_frame(tmp_path: Path) -> None:
    seen = viewable(load("example:raymarcher"))
    options = PageOptions(poster="triangles", views=["color"], size=(160, 120))
    path = tmp_path / "page.html"
    made = pages.write(seen, path, options)
    assert 0 < made.parts["poster"] < 9_000
    (data,) = re.findall(r'data-triangles="([^"]*)"', path.read_text(encoding="utf-8"))
    still = decode(base64.b64decode(data))
    assert still.shape == (120, 160, 3)
    with offline_page(path, flags=SWIFTSHADER) as watched:
        poster = watched.page.locator("[data-distal] > canvas:not([data-triangles])")
        poster.wait_for(state="attached")
        assert poster.get_attribute("aria-label") == description_of(seen, "raymarcher")
        drawn = pixels(poster)
        watched.settle()
        assert watched.complaints == []
        assert watched.requests == []
    assert drawn.shape[1] > 160 and drawn.shape[1] / drawn.shape[0] == pytest.approx(
        4 / 3, rel=0.01
    )
    small = Image.fromarray(drawn).resize((160, 120), Image.Resampling.BOX)
    # Edges of the larger picture are sharper; all else is the same.
    assert np.abs(np.asarray(small).astype(int) - still).mean() < 1.0
