"""A page that was exported, looked at in a real browser, beside what the CPU shows.

Input: an HTML file. Output: its picture as the player saves it, the player's state,
and how far the picture is from the CPU's. The player is asked through ``host.distal``; hands use
the real controls.
"""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from distal.lang.render_options import RenderOptions
from distal.scene.steering import Steering
from distal.scene.viewing.viewable import Viewable
from tests.browser import Watched, offline_page
from tests.pictures.comparison import Difference, difference

# Wide enough for the panel beside the picture; drivers in software are slow.
VIEWPORT = {"width": 660, "height": 190}

_SETTLE = """async (number) => {
  const player = document.querySelectorAll("[data-distal]")[number].distal;
  if (!player.playing) await player.settled();
}"""
_PICTURE = """async (number) => {
  const blob = await document.querySelectorAll("[data-distal]")[number].distal.screenshot(1);
  const bytes = new Uint8Array(await blob.arrayBuffer());
  return btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join(""));
}"""
_ASPECT = """(number) => {
  const [width, height] =
    document.querySelectorAll("[data-distal]")[number].distal.payload.size;
  return width / height;
}"""
_STATE = """(number) => {
  const player = document.querySelectorAll("[data-distal]")[number].distal;
  return {
    parameters: player.parameters(),
    time: player.time,
    playing: player.playing,
    view: player.view,
    steering: player.steering(),
  };
}"""


@dataclass
class Looked:
    """A page under watch; ``number`` counts the pictures on it."""

    watched: Watched
    number: int = 0

    @property
    def page(self) -> Any:
        return self.watched.page

    def settle(self) -> None:
        """Wait until the sharp picture stands."""
        self.page.evaluate(_SETTLE, self.number)

    def picture(self) -> NDArray[np.uint8]:
        """(height, width, 4), top row first, at the canvas's size."""
        self.settle()
        data = base64.b64decode(self.page.evaluate(_PICTURE, self.number))
        return np.asarray(Image.open(io.BytesIO(data)).convert("RGBA"))

    def state(self) -> dict[str, Any]:
        """Values, time, view and camera."""
        state: dict[str, Any] = self.page.evaluate(_STATE, self.number)
        return state

    def beside(self, seen: Viewable) -> Difference:
        """How far the picture is from what the CPU shows of the page's own state."""
        shown, state = self.picture(), self.state()
        moved = state["steering"]
        options: dict[str, Any] = {}
        if moved is not None:
            options["steering"] = Steering(
                moved["yaw"], moved["pitch"], moved["zoom"], tuple(moved["pan"])
            )
        # On a canvas narrower than the author's picture, the frame is as wide, in the middle.
        aspect = self.page.evaluate(_ASPECT, self.number)
        height, width = shown.shape[:2]
        kept = min(height, round(width / aspect))
        low = (height - kept + 1) // 2
        shown = shown[height - low - kept : height - low]
        height = kept
        # The picture is asked for with one sample a pixel.
        rendering = RenderOptions(
            size=(width, height), time=state["time"], params=state["parameters"], samples=1
        )
        expected = seen.render(replace(rendering, view=state["view"], **options))
        return difference(expected.array, shown)


@contextmanager
def looked_at(path: Path, number: int = 0, **options: Any) -> Iterator[Looked]:
    """A page opened from disk; at the end it must have asked for nothing and complained of nothing.

    Time stands where people asked for less motion, as these do unless a test says otherwise.
    """
    context = {"viewport": VIEWPORT, "reduced_motion": "reduce", **options}
    with offline_page(path, **context) as watched:
        watched.page.wait_for_function(
            "() => [...document.querySelectorAll('[data-distal]')].every((host) => host.distal)"
        )
        yield Looked(watched, number)
        watched.settle()
        assert watched.complaints == []
        assert watched.requests == []
