"""Pages with paths in a real browser: the light is that of the CPU, and begins anew with a move."""

from __future__ import annotations

import base64
import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import distal
from distal.export.page_options import PageOptions
from distal.export.payload import payload
from distal.lang.render_options import Refinement, RenderOptions
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import Viewable, viewable
from tests.browser import BrowserUnavailableError
from tests.browser import browser as running_browser
from tests.page.looking import Looked, looked_at

SIZE = (56, 40)
# Display values without a tone map are light, so means of pixels can be compared. No light is
# clipped: the lamp is large, and the picture dark.
GLASS = """
from distal import Box, Camera, PointLight, Scene, Sphere, glass, matte
from distal.lang import slider

size = slider("Size", 0.45, 0.2, 0.6)
ball = Sphere(size).translate(y=0.5).paint(glass())
room = Box((4.0, 0.2, 4.0)).translate(y=-0.1).paint(matte("#c0a080"))
scene = Scene(
    ball | room,
    lights=PointLight((1.0, 2.5, 1.0), color=(2.0, 2.0, 2.0), radius=0.6),
    background=(0.25, 0.3, 0.4),
    camera=Camera((0.5, 1.4, 2.6), (0.0, 0.4, 0.0)),
    tone_map="none",
    exposure=0.4,
    mode="path",
)
"""

_FRAMES = """() => {
  const player = document.querySelector("[data-distal]").distal;
  window.frames_seen = [];
  player.on("frame", (frame) => window.frames_seen.push(frame));
}"""
# A frame is told of after the picture of its samples was handed over, and before the next begins.
_PICTURE = """async (samples) => {
  const player = document.querySelector("[data-distal]").distal;
  const blob = await player.screenshot(samples);
  const bytes = new Uint8Array(await blob.slice().arrayBuffer());
  return btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(""));
}"""


@pytest.fixture(scope="module", autouse=True)
def browser():
    try:
        return running_browser()
    except BrowserUnavailableError as error:
        pytest.skip(f"no browser: {error}")


@pytest.fixture(scope="module")
def glass(tmp_path_factory: pytest.TempPathFactory) -> tuple[Viewable, Path]:
    folder = tmp_path_factory.mktemp("paths")
    (folder / "glass.py").write_text(GLASS)
    scene = distal.load(folder / "glass.py")
    page = folder / "glass.html"
    scene.export(page, size=SIZE, embed=True, poster=False, views=["color", "normal"])
    return viewable(scene), page


def options(**changes: Any) -> dict[str, Any]:
    return {"viewport": {"width": SIZE[0] + 16, "height": SIZE[1] + 16}, **changes}


def film_of(looked: Looked, samples: int) -> tuple[int, NDArray[np.float64]]:
    """The samples of the film's picture, and its light."""
    looked.page.evaluate(_FRAMES)
    looked.settle()
    data = base64.b64decode(looked.page.evaluate(_PICTURE, samples))
    count = looked.page.evaluate("window.frames_seen.findLast((f) => f.rate !== undefined).samples")
    return count, light_of(np.asarray(Image.open(io.BytesIO(data)).convert("RGB")) / 255.0)


def light_of(shown: NDArray[Any]) -> NDArray[np.float64]:
    """Linear light of display values."""
    low = shown <= 0.04045
    return np.where(low, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)


def on_cpu(seen: Viewable, samples: int, size: tuple[int, int], **changes: Any) -> NDArray[Any]:
    given = RenderOptions(
        size=size, refinement=Refinement(samples=samples), samples=samples, **changes
    )
    return light_of(seen.render(given).array[..., :3])


def tiles(light: NDArray[Any], side: int = 8) -> NDArray[np.float64]:
    height, width = (n - n % side for n in light.shape[:2])
    cut = light[:height, :width].reshape(height // side, side, width // side, side, 3)
    return cut.mean(axis=(1, 3))


def assert_same_light(seen: Viewable, count: int, shown: NDArray[Any], **changes: Any) -> None:
    """The tiles of a picture are those of the CPU: with its random numbers, and with others."""
    size = shown.shape[1], shown.shape[0]
    same = on_cpu(seen, count, size, **changes)
    # Nearly all paths are the same; a few turn off where floats differ in the last bit.
    assert np.median(np.abs(same - shown)) < 2e-3
    others = np.stack([tiles(on_cpu(seen, count, size, seed=s, **changes)) for s in range(1, 9)])
    # Bytes are a 255th apart: up to .009 of light, .0026 as a standard deviation.
    spread = np.sqrt(others.var(axis=0, ddof=1) * (1.0 + 1.0 / len(others)) + 2.6e-3**2)
    z = (tiles(shown) - others.mean(axis=0)) / spread
    # Of Student's distribution with 7 degrees of freedom: one in 10^5 is beyond 10.
    assert np.abs(z).max() < 12.0
    assert np.sqrt(np.mean(z**2)) < 1.6
    assert abs(z.mean()) < 5.0 / np.sqrt(z[..., 0].size)


def test_the_page_has_the_light_of_the_cpu(glass: tuple[Viewable, Path]) -> None:
    seen, page = glass
    with looked_at(page, **options()) as looked:
        count, shown = film_of(looked, 32)
        assert count >= 32
        assert_same_light(seen, count, shown)
        # A later picture of the same film is nearer to the truth.
        later, finer = film_of(looked, 3 * count)
        assert later >= 3 * count
        truth = on_cpu(seen, 1024, (shown.shape[1], shown.shape[0]), seed=5)
        errors = [np.sqrt(np.mean((picture - truth) ** 2)) for picture in (shown, finer)]
        assert errors[1] < 0.75 * errors[0]


def test_photons_find_the_caustics_of_a_small_lamp(glass: tuple[Viewable, Path]) -> None:
    folder = glass[1].parent
    text = GLASS.replace("radius=0.6", "radius=0.03").replace("(2.0, 2.0, 2.0)", "(1.0, 1.0, 1.0)")
    # From above and behind: else the ball hides its caustic.
    old, new = "(0.5, 1.4, 2.6), (0.0, 0.4, 0.0)", "(-1.6, 2.4, -1.0), (-0.2, 0.0, -0.2)"
    text = text.replace(old, new)
    (folder / "small_lamp.py").write_text(text)
    scene, page = distal.load(folder / "small_lamp.py"), folder / "small_lamp.html"
    scene.export(page, size=SIZE, embed=True, poster=False, views=["color"])
    seen = viewable(scene)
    with looked_at(page, **options()) as looked:
        count, shown = film_of(looked, 48)
        assert_same_light(seen, count, shown)
        plain = on_cpu(seen.in_mode(None, caustics=False), count, (shown.shape[1], shown.shape[0]))
        # Without them light is missing: .019 of .11 in the brightest tile.
        assert (tiles(shown) - tiles(plain)).max() > 0.008


def test_pages_trace_no_photons_where_they_are_switched_off(glass: tuple[Viewable, Path]) -> None:
    seen = glass[0]
    for caustics in (True, False):
        made = payload(seen.in_mode(None, caustics=caustics), PageOptions(views=["color"]))
        assert ("photons" in made["views"][0]["film"]) is caustics
        assert ("Photon_places" in made["resources"]) is caustics


def test_samples_begin_anew_when_something_moves(glass: tuple[Viewable, Path]) -> None:
    seen, page = glass
    with looked_at(page, **options()) as looked:
        film_of(looked, 16)
        looked.page.evaluate(
            """() => {
              const player = document.querySelector("[data-distal]").distal;
              window.since_moved = [];
              player.on("frame", (frame) => window.since_moved.push(frame));
              player.setSteering({ yaw: 0.6 });
              player.setParameter("size", 0.3);
            }"""
        )
        count, shown = film_of(looked, 32)
        rates = looked.page.evaluate("window.since_moved.map((f) => f.rate ?? null)")
        samples = looked.page.evaluate("window.since_moved.map((f) => f.samples ?? null)")
        # Direct light while it moves, then a new film.
        begin = rates.index(None)
        counts = [n for n, rate in zip(samples[begin:], rates[begin:], strict=True) if rate]
        assert counts[0] < 32 and counts == sorted(counts)
        steering = Steering(0.6, 0.0, 1.0, (0.0, 0.0))
        assert_same_light(seen, count, shown, steering=steering, params={"size": 0.3})


def test_a_key_shows_direct_light_and_paths_again(glass: tuple[Viewable, Path]) -> None:
    seen, page = glass
    with looked_at(page, **options()) as looked:
        film_of(looked, 16)
        assert looked.page.evaluate("document.querySelector('[data-distal]').distal.code()") == (
            'import distal; distal.load("glass.py").render((56, 40), params={}, mode="path")'
            '.save("glass.png")'
        )
        looked.page.locator("canvas").press("m")
        looked.settle()
        assert looked.beside(seen.in_mode("direct")).mean < 1.5
        looked.page.locator("canvas").press("m")
        count, shown = film_of(looked, 16)
        assert_same_light(seen, count, shown)


def test_other_views_have_no_film(glass: tuple[Viewable, Path]) -> None:
    seen, page = glass
    with looked_at(page, **options()) as looked:
        looked.page.evaluate("document.querySelector('[data-distal]').distal.setView('normal')")
        assert looked.beside(seen).mean < 1.5


def test_without_float_pictures_direct_light_is_shown(glass: tuple[Viewable, Path]) -> None:
    seen, page = glass
    script = """
      const ask = WebGL2RenderingContext.prototype.getExtension;
      WebGL2RenderingContext.prototype.getExtension = function (name) {
        return name === "EXT_color_buffer_float" ? null : ask.call(this, name);
      };
    """
    plain = page.with_name("plain.html")
    plain.write_text(f"<script>{script}</script>\n{page.read_text()}")
    with looked_at(plain, **options()) as looked:
        looked.settle()
        said = looked.page.evaluate(
            "document.querySelector('[data-distal]').shadowRoot.querySelector('[role=status]').textContent"
        )
        assert said == "This browser draws no float pictures: direct light is shown."
        assert looked.beside(seen.in_mode("direct")).mean < 1.5
