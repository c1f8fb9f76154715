"""Pages to inspect, in a real browser: the cut is the CPU's, the ruler says the box's sizes."""

from __future__ import annotations

import base64
import io
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from typer.testing import CliRunner

import distal
from distal import Box, Camera, Scene
from distal.cli.application import application
from distal.export.page import page, write
from distal.export.page_options import PageOptions
from distal.file_writer import SaveError
from distal.lang.render_options import RenderOptions
from distal.scene.section import CutPlane
from distal.scene.viewing.viewable import viewable
from tests.browser import SWIFTSHADER, offline_page

SIZE = (320, 240)
# A bored box with a wall that a slider moves.
PART = """
from distal import Box, Camera, Scene
from distal.lang import slider

wide = slider("Wide", 4.0, 2.0, 8.0)
part = (Box((wide, 2, 3)) - Box((3.0, 1.0, 2.0))).paint("#c04020")
scene = Scene(part, camera=Camera((0.0, 0.0, 9.0), (0, 0, 0)), floor=False)
"""
STATE = ", ".join(
    f"document.querySelector('[data-distal]').distal.inspection.{name}"
    for name in ("hint", "ends.length")
)
PLAYER = "document.querySelector('[data-distal]').distal"


pytestmark = pytest.mark.usefixtures("chromium")


@pytest.fixture(scope="module")
def page_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("inspect")
    (folder / "part.py").write_text(PART)
    seen = viewable(distal.load(folder / "part.py"))
    options = PageOptions(inspect=True, unit="cm", poster=False, views=["color", "normal"])
    write(seen, folder / "part.html", options)
    return folder / "part.html"


class Inspected:
    """A page to inspect."""

    def __init__(self, page: Any, scale: float) -> None:
        self.page = page
        page.locator(".choices").first.wait_for(state="attached")
        page.evaluate(f"{PLAYER}.togglePanel()")  # the picture is the frame of the author
        page.evaluate(f"{PLAYER}.setResolution({scale})")

    def press(self, name: str) -> None:
        self.page.evaluate(
            """(name) => [...document.querySelector("[data-distal]").shadowRoot
              .querySelectorAll(".choices button")].find((b) => b.textContent === name).click()""",
            name,
        )

    def settled(self) -> None:
        self.page.wait_for_timeout(50)
        assert self.page.evaluate(f"{PLAYER}.settled()")

    def picture(self) -> NDArray[np.float64]:
        """The picture at rest, at the size of the author's frame."""
        self.settled()
        code = f"""async () => {{
          const blob = await {PLAYER}.screenshot(16);
          const bytes = new Uint8Array(await blob.arrayBuffer());
          return btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(""));
        }}"""
        image = Image.open(io.BytesIO(base64.b64decode(self.page.evaluate(code))))
        assert image.size == SIZE
        return np.asarray(image.convert("RGB"), np.float64) / 255

    def inspection(self, code: str) -> Any:
        return self.page.evaluate(f"{PLAYER}.inspection.{code}")

    def until(self, code: str) -> None:
        """Wait until something holds of the inspection."""
        for _ in range(400):
            if self.inspection(code):
                return
            self.page.wait_for_timeout(25)
        raise AssertionError(f"it never held: {code}")

    def cut(self, name: str) -> None:
        """Press a button of the plane, and wait for the plane and the picture."""
        self.press(name)
        self.until(f"plane?.axis === '{name.lower()}'")
        self.settled()

    def frame(self) -> tuple[float, float, float, float]:
        """Left, top, width and height of the author's frame on the page."""
        style = "document.querySelector('[data-distal]').shadowRoot.querySelector('.player').style"
        left, bottom, width, height = (
            float(self.page.evaluate(f"parseFloat({style}.getPropertyValue('--{name}'))"))
            for name in ("left", "bottom", "width", "height")
        )
        return left, self.page.viewport_size["height"] - bottom - height, width, height

    def click(self, x: float, y: float) -> None:
        """Click at a place of the frame, in fractions from its upper left, and wait."""
        left, top, width, height = self.frame()
        self.page.evaluate(f"window.before = [{STATE}].join()")
        self.page.mouse.click(left + x * width, top + y * height)
        self.until(f"hint !== 'Finding the place …' && [{STATE}].join() !== window.before")

    def lines(self) -> list[str]:
        """The lines of the ruler's label."""
        code = f"async () => (await {PLAYER}.inspection.seen())?.lines ?? []"
        found: list[str] = self.page.evaluate(code)
        return found


def opened(file: Path, width: int, height: int, scale: float) -> Iterator[Inspected]:
    viewport = {"width": width, "height": height}
    with offline_page(file, flags=SWIFTSHADER, viewport=viewport) as watched:
        yield Inspected(watched.page, scale)
        assert watched.complaints == []
        assert watched.requests == []


@pytest.fixture
def pictured(page_file: Path) -> Iterator[Inspected]:
    """A page whose pictures have the size of the author's."""
    yield from opened(page_file, *SIZE, 1.0)


@pytest.fixture
def inspected(page_file: Path) -> Iterator[Inspected]:
    """A page that is large enough for a pointer, with coarse pictures."""
    yield from opened(page_file, 700, 600, 0.25)


def of_cpu(file: Path, section: CutPlane, view: str = "color") -> NDArray[np.float64]:
    """The same picture by the CPU, of the shape that is cut by the plane."""
    seen = viewable(distal.load(file.with_name("part.py")))
    options = RenderOptions(size=SIZE, samples=16 if view == "color" else 1)
    return np.asarray(
        seen.render(replace(options, view=view, section=section)).array[..., :3], np.float64
    )


def test_a_cut_picture_is_that_of_the_cpu(pictured: Inspected, page_file: Path) -> None:
    whole = pictured.picture()
    pictured.cut("X")
    cut = pictured.picture()
    plane = pictured.inspection("plane")
    assert (plane["normal"], plane["low"], plane["high"]) == ([1, 0, 0], -2, 2)
    lines = 0.02 * math.hypot(4, 2, 3)
    expected = of_cpu(page_file, CutPlane((1.0, 0.0, 0.0), 0.0, lines))
    assert np.abs(cut - expected).mean() < 2e-3
    assert np.abs(cut - whole).mean() > 0.02
    # Elsewhere, on the other side, in another view.
    pictured.inspection("move({share: 0.75, isFlipped: true})")
    moved = pictured.picture()
    expected = of_cpu(page_file, CutPlane((-1.0, 0.0, 0.0), -1.0, lines))
    assert np.abs(moved - expected).mean() < 2e-3
    pictured.page.evaluate(f"{PLAYER}.setView('normal')")
    view = pictured.picture()
    expected = of_cpu(page_file, CutPlane((-1.0, 0.0, 0.0), -1.0, lines), "normal")
    assert np.abs(view - expected).mean() < 2e-3
    pictured.page.evaluate(f"{PLAYER}.setView('color')")
    pictured.press("Off")
    assert np.abs(pictured.picture() - whole).max() < 1e-9


def test_the_view_is_cut_across_and_the_plane_follows_sliders(inspected: Inspected) -> None:
    inspected.settled()
    inspected.cut("View")
    plane = inspected.inspection("plane")
    assert plane["normal"] == pytest.approx([0, 0, 1], abs=1e-6)
    assert (plane["low"], plane["high"]) == pytest.approx((-1.5, 1.5), abs=1e-5)
    inspected.cut("X")
    inspected.page.evaluate(f"{PLAYER}.setParameter('wide', 6)")
    inspected.until("plane.high === 3")
    assert inspected.inspection("plane.low") == -3


def test_the_ruler_says_the_sizes_of_the_box(inspected: Inspected) -> None:
    inspected.settled()
    inspected.page.keyboard.press("d")
    assert inspected.inspection("isMeasuring")
    inspected.click(0.02, 0.02)
    assert inspected.inspection("hint").startswith("Nothing is there.")
    # The corners of the front face, whose half is 2 x 1 at the distance 7.5.
    scale = 0.5 / (7.5 * math.tan(math.radians(20.0)))
    _, _, width, height = inspected.frame()
    right, up = 2.0 * scale * height / width, scale
    inspected.click(0.5 - right + 0.006, 0.5 - up + 0.008)
    inspected.click(0.5 + right - 0.006, 0.5 + up - 0.008)
    found = inspected.lines()
    assert float(found[0].removesuffix(" cm")) == pytest.approx(math.hypot(4, 2), abs=1e-4)
    assert found[1] == "Δx 4   Δy \N{MINUS SIGN}2   Δz 0"
    assert found[2:] == [
        "from (\N{MINUS SIGN}2, 1, 1.5), corner",
        "to (2, \N{MINUS SIGN}1, 1.5), corner",
    ]
    # It is seen where it was clicked, and on the panel.
    seen = inspected.page.evaluate(f"{PLAYER}.inspection.seen()")
    x, y = seen["points"][0]
    wide, high = inspected.page.evaluate(f"{PLAYER}.frameSize")
    assert (x / wide, y / high) == pytest.approx((0.5 - right, 0.5 + up), abs=2e-3)
    inspected.page.wait_for_timeout(100)
    said = inspected.page.evaluate(
        """() => [...document.querySelector("[data-distal]").shadowRoot
          .querySelectorAll(".group [role=status] p")].map((p) => p.textContent)"""
    )
    assert said == found
    # It stays on the shape while the camera turns.
    inspected.page.evaluate(f"{PLAYER}.setSteering({{yaw: 0.4}})")
    inspected.settled()
    turned = inspected.page.evaluate(f"{PLAYER}.inspection.seen()")
    assert turned["lines"] == found
    assert abs(turned["points"][0][0] - x) > 5
    inspected.page.keyboard.press("Escape")
    assert not inspected.inspection("isMeasuring")
    assert inspected.lines() == []


def test_the_ruler_measures_through_the_cut_and_by_the_keyboard(inspected: Inspected) -> None:
    inspected.settled()
    for axis in "xyz":
        inspected.page.keyboard.press("x")
        inspected.until(f"plane?.axis === '{axis}'")
    inspected.settled()
    inspected.page.keyboard.press("d")
    inspected.page.locator("canvas").first.focus()
    inspected.page.keyboard.press("Enter")
    inspected.until("ends.length")
    inspected.click(0.5, 0.5)  # the same place
    (first, second) = inspected.inspection("ends")
    assert first["point"] == pytest.approx([0.0, 0.0, -1.0], abs=1e-4)  # the bottom of the bore
    assert inspected.lines()[0] == "0 cm"
    assert first["kind"] == second["kind"] == "surface"


def test_saved_pictures_hold_the_ruler(inspected: Inspected) -> None:
    page = inspected.page
    inspected.settled()
    page.evaluate(
        """() => { const make = URL.createObjectURL; window.saved = [];
        URL.createObjectURL = (blob) => {
          window.saved.push(blob); return make.call(URL, blob); } }"""
    )
    page.keyboard.press("d")
    inspected.click(0.4, 0.5)
    inspected.click(0.6, 0.5)
    page.evaluate(f"{PLAYER}.saveScreenshot()")
    for _ in range(200):
        if page.evaluate("window.saved.length"):
            break
        page.wait_for_timeout(25)
    text = page.evaluate(
        """async () => btoa(Array.from(new Uint8Array(await window.saved[0].arrayBuffer()),
        (b) => String.fromCharCode(b)).join(""))"""
    )
    found = np.asarray(Image.open(io.BytesIO(base64.b64decode(text))).convert("RGB"), float) / 255
    middle = found.shape[0] // 2
    column = found[middle - 5 : middle + 5, found.shape[1] // 2]
    assert (column[:, 0] - column[:, 2]).max() > 0.5  # the yellow line
    assert column.min() < 0.15  # and its dark border


def test_other_pages_are_as_before_and_refusals_say_why(tmp_path: Path) -> None:
    part = Scene(Box(2), camera=Camera((0, 0, 5)))
    made = page(viewable(part), PageOptions(poster=False, views=["color"]), b"").text
    assert "Ruler_pointer" not in made
    assert '"inspect"' not in made
    with pytest.raises(SaveError, match="a unit is one of um, mm, cm, m, inch, ft, not 'mile'"):
        page(viewable(part), PageOptions(inspect=True, unit="mile"), b"")
    runner = CliRunner()

    def refusal(*arguments: str) -> str:
        target = str(tmp_path / "page.html")
        found = runner.invoke(application, ["export", *arguments, "-o", target, "--no-poster"])
        assert found.exit_code != 0
        return re.sub(r"\s+", " ", found.output)

    said = refusal("example:raymarcher", "--inspect")
    assert "is an image: only scenes and shapes can be inspected" in said
    said = refusal("example:enclosure", "--inspect", "--embed")
    assert "--inspect has its buttons in the panel, which --embed leaves out" in said
    said = refusal("example:enclosure", "--unit", "cm")
    assert "--unit is for --printable and --inspect" in said


def test_a_page_prints_and_inspects_at_once(tmp_path: Path) -> None:
    (tmp_path / "part.py").write_text(PART)
    seen = viewable(distal.load(tmp_path / "part.py"))
    options = PageOptions(inspect=True, printable=True, poster=False, views=["color"])
    write(seen, tmp_path / "part.html", options)
    with offline_page(tmp_path / "part.html", flags=SWIFTSHADER) as watched:
        watched.page.get_by_role("button", name="Save 3MF").wait_for()
        watched.page.get_by_role("button", name="Measure a distance").wait_for()
        assert watched.complaints == []
