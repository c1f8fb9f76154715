"""Pages of pictures that keep frames: what they show is what the CPU shows, frame by frame."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import distal
from distal.example_files import frame_examples
from distal.export.page import FRAME_PLAYER, PLAYER, player_of
from distal.lang import (
    Frame,
    ImageInput,
    Key,
    Keys,
    SoundFile,
    image,
    ivec2,
    microphone,
    sample,
    texel,
    vec4,
)
from distal.scene.viewing.viewable import viewable
from tests.browser import BrowserUnavailableError, Watched, offline_page
from tests.frames import pieces
from tests.frames.hosts import COUNT, SIZE, STEP
from tests.frames.test_sounds import bars_of, tone, written

# Numbers of 8 bits, and a driver of its own.
CLOSE = 1.01
_FRAMES = """async ([count, step]) => {
  const players = [...document.querySelectorAll("[data-distal]")].map((host) => host.distal);
  for (const player of players) player.pause();
  for (let i = 0; i < count; i++) {
    for (const player of players) {
      player.setTime(i * step);
      if (!(await player.settled())) throw new Error(`${player.payload.name} shows nothing`);
    }
  }
}"""
_PICTURES = """async () => {
  const texts = [];
  for (const host of document.querySelectorAll("[data-distal]")) {
    const blob = await host.distal.screenshot(1);
    const bytes = new Uint8Array(await blob.arrayBuffer());
    texts.push(btoa(Array.from(bytes, (b) => String.fromCharCode(b)).join("")));
  }
  return texts;
}"""
_READY = """() => [...document.querySelectorAll("[data-distal]")].every((host) => host.distal)"""
# Of those without keys and mouse, which a page gets from hands.
STILL = [p for p in pieces.PIECES if p.name not in ("pen", "ball")]


# Small enough for drivers in software, large enough for a hand beside the bar.
LARGE = (160, 120)


def page_of(folder: Path, *images: Any, size: tuple[int, int] = SIZE) -> Path:
    """A page of embedded pictures, each of this size."""
    parts = []
    for number, shown in enumerate(images):
        file = folder / f"{number}.html"
        shown.export(file, size=size, embed=True, poster=False)
        parts.append(file.read_text())
    style = f"width:{size[0]}px;height:{size[1]}px"
    held = "".join(f'<div style="{style}">{part}</div>' for part in parts)
    page = folder / "all.html"
    page.write_text(f"<!doctype html><meta charset=utf-8><body>{held}</body>")
    return page


def opened(path: Path) -> Any:
    try:
        return offline_page(path, reduced_motion="reduce")
    except BrowserUnavailableError as missing:
        pytest.skip(f"pages are not opened: {missing}")


def pictures(watched: Watched) -> list[NDArray[np.float64]]:
    found = watched.page.evaluate(_PICTURES)
    return [
        np.asarray(Image.open(io.BytesIO(base64.b64decode(text))).convert("RGB"), float)
        for text in found
    ]


def by_cpu(image: Any, size: tuple[int, int] = SIZE, **options: Any) -> NDArray[np.float64]:
    index = COUNT - 1
    shown = image.render(size=size, index=index, time=index * STEP, delta=STEP, **options)
    return np.clip(shown.array[..., :3].astype(float), 0.0, 1.0) * 255.0


def test_pages_draw_the_frames_of_the_cpu(tmp_path: Path) -> None:
    with opened(page_of(tmp_path, *STILL)) as watched:
        watched.page.wait_for_function(_READY)
        watched.page.evaluate(_FRAMES, [COUNT, STEP])
        for piece, found in zip(STILL, pictures(watched), strict=True):
            assert float(np.abs(found - by_cpu(piece)).max()) <= CLOSE, piece.name
        # Back at the start, they begin again; what was there is forgotten.
        watched.page.evaluate(_FRAMES, [COUNT, STEP])
        for piece, found in zip(STILL, pictures(watched), strict=True):
            assert float(np.abs(found - by_cpu(piece)).max()) <= CLOSE, f"{piece.name}, again"
        assert not watched.complaints
        assert not watched.requests


def test_pages_draw_the_examples(tmp_path: Path) -> None:
    examples = [distal.load(f"example:{name}") for name in frame_examples()]
    with opened(page_of(tmp_path, *examples)) as watched:
        watched.page.wait_for_function(_READY)
        watched.page.evaluate(_FRAMES, [COUNT, STEP])
        for shown, found in zip(examples, pictures(watched), strict=True):
            apart = np.abs(found - by_cpu(shown)).max(axis=-1)
            # As in ``tests/frames/test_examples.py``: few pixels go another way.
            assert float((apart > CLOSE).mean()) <= 0.02, (shown.name, float(apart.max()))
        assert not watched.complaints
        assert not watched.requests


def test_keys_and_buttons_are_those_of_the_page(tmp_path: Path) -> None:
    path = page_of(tmp_path, pieces.ball, pieces.pen, size=LARGE)
    with opened(path) as watched:
        page = watched.page
        page.wait_for_function(_READY)
        page.evaluate(_FRAMES, [1, STEP])
        ball, pen = page.locator("[data-distal]").all()
        ball.evaluate("(host) => host.shadowRoot.querySelector('canvas').focus()")
        page.keyboard.down("ArrowRight")
        page.keyboard.press("Space")
        page.evaluate(_LATER_FRAMES, [COUNT, STEP])
        page.keyboard.up("ArrowRight")
        keys = Keys(held=frozenset({Key.RIGHT}), toggled=frozenset({Key.RIGHT, Key.SPACE}))
        moved = pictures(watched)[0]
        # Frame 0 was drawn before the key went down, but it only sets the ball in the middle.
        first = STEP * 4.0 * LARGE[0]
        assert abs(_middle(moved) - _middle(by_cpu(pieces.ball, LARGE, keys=keys))) <= first + 1.0
        assert _middle(moved) > _middle(by_cpu(pieces.ball, LARGE)) + 4.0 * first
        assert float(moved[..., 2].min()) == 255.0  # toggled by the space bar
        box = pen.bounding_box()
        page.mouse.move(box["x"] + 40.5, box["y"] + 60.5)
        page.mouse.down()
        page.evaluate(_LATER_FRAMES, [COUNT, STEP])
        drawn = pictures(watched)[1]
        page.mouse.up()
        assert drawn[60, 40].tolist() == pytest.approx([255.0, 127.5, 0.0], abs=3.0)
        assert drawn[60, 80].tolist() == [0.0, 0.0, 0.0]
        page.keyboard.press("c")
        page.evaluate(_LATER_FRAMES, [2, 2.0])
        assert float(pictures(watched)[1].max()) == 0.0
        assert not watched.complaints


def _middle(shown: NDArray[np.float64]) -> float:
    """The column in which a ball is."""
    bright = shown[..., 0].sum(axis=0)
    return float((bright * np.arange(len(bright))).sum() / bright.sum())


_LATER_FRAMES = _FRAMES.replace("let i = 0;", "let i = 1;")


photo = ImageInput([[0.0, 0.0], [0.0, 0.0]])


@image
def dropped(frame: Frame) -> vec4:
    return sample(photo, frame.coord / frame.resolution)


@image
def heard(frame: Frame) -> vec4:
    column = int(frame.coord.x / frame.resolution.x * 512.0)
    wave = texel(microphone, ivec2(column, 1)).x
    return vec4(texel(microphone, ivec2(column, 0)).x, wave, 0.0, 1.0)


_DROP = """async ([host, bytes, name]) => {
  const files = new DataTransfer();
  files.items.add(new File([new Uint8Array(bytes)], name));
  const canvas = host.shadowRoot.querySelector("canvas");
  const options = {dataTransfer: files, bubbles: true, composed: true, cancelable: true};
  canvas.dispatchEvent(new DragEvent("drop", options));
  await new Promise((done) => setTimeout(done, 300));
}"""


def test_a_dropped_picture_takes_the_place_of_an_image(tmp_path: Path) -> None:
    assert float(dropped.render(size=SIZE).array[..., :3].max()) == 0.0
    bands = np.zeros((2, 2, 3), np.uint8)
    bands[0], bands[1] = (255, 0, 0), (0, 255, 0)  # red above green
    file = io.BytesIO()
    Image.fromarray(bands).save(file, "png")
    with opened(page_of(tmp_path, dropped, size=LARGE)) as watched:
        page = watched.page
        page.wait_for_function(_READY)
        page.evaluate(_FRAMES, [1, STEP])
        assert float(pictures(watched)[0].max()) == 0.0
        host = page.query_selector("[data-distal]")
        page.evaluate(_DROP, [host, [1, 2, 3], "notes.txt"])
        assert float(pictures(watched)[0].max()) == 0.0
        page.evaluate(_DROP, [host, list(file.getvalue()), "bands.png"])
        (shown,) = pictures(watched)
        assert shown[30, 80].tolist() == pytest.approx([255.0, 0.0, 0.0], abs=3.0)
        assert shown[89, 80].tolist() == pytest.approx([0.0, 255.0, 0.0], abs=3.0)
        assert not watched.complaints


_FAKE_SOUND = ("--use-fake-device-for-media-stream", "--use-fake-ui-for-media-stream")


def test_the_microphone_is_asked_for_after_a_gesture(tmp_path: Path) -> None:
    silent = heard.render(size=SIZE).array
    assert float(silent[..., 0].max()) == 0.0
    assert silent[..., 1] == pytest.approx(128.0 / 255.0, abs=1e-6)
    path = page_of(tmp_path, heard, size=LARGE)
    try:
        page_with_sound = offline_page(path, flags=_FAKE_SOUND, reduced_motion="reduce")
    except BrowserUnavailableError as missing:
        pytest.skip(f"pages are not opened: {missing}")
    with page_with_sound as watched:
        page = watched.page
        page.wait_for_function(_READY)
        page.evaluate(_FRAMES, [1, STEP])
        (before,) = pictures(watched)
        assert float(before[..., 0].max()) == 0.0
        assert before[..., 1] == pytest.approx(128.0, abs=3.0)
        page.locator("[data-distal]").click(position={"x": 80, "y": 40})
        # Chromium's false microphone beeps once a second.
        loudest = 0.0
        for step in range(1, 40):
            page.wait_for_timeout(60)
            page.evaluate("(t) => document.querySelector('[data-distal]').distal.setTime(t)", step)
            loudest = max(loudest, float(pictures(watched)[0][..., 0].max()))
            if loudest > 100.0:
                break
        assert loudest > 100.0
        assert not watched.complaints


_COUNT_STARTS = """() => {
  window.starts = [];
  const start = AudioBufferSourceNode.prototype.start;
  AudioBufferSourceNode.prototype.start = function (when, place) {
    window.starts.push([place, this.buffer.duration, this.loop]);
    return start.call(this, when, place);
  };
}"""


def test_a_page_hears_and_plays_a_sound_file(tmp_path: Path) -> None:
    bars = bars_of(SoundFile(written(tmp_path / "song.wav", [tone(1.0, 400.0, 0.1)])))
    path = page_of(tmp_path, bars, size=LARGE)
    with opened(path) as watched:
        page = watched.page
        page.wait_for_function(_READY)
        page.evaluate(_COUNT_STARTS)
        for time in (0.0, 0.4, 1.2):
            page.evaluate(_SHOWN_AT, time)
            (shown,) = pictures(watched)
            wanted = np.clip(bars.render(size=LARGE, time=time).array[..., :3], 0.0, 1.0) * 255.0
            assert float(np.abs(shown - wanted).max()) <= CLOSE, time
        # Nothing is heard before a person touches the picture.
        assert page.evaluate("window.starts") == []
        page.locator("[data-distal]").click(position={"x": 80, "y": 40})
        for time in (1.25, 1.3, 1.35, 1.4, 1.45, 1.5):
            page.evaluate(_SHOWN_AT, time)
            page.wait_for_timeout(50)
        starts = page.evaluate("window.starts")
        assert starts, "the sound is heard from a frame after the click on"
        place, seconds, loop = starts[0]
        assert 0.2 <= place <= 0.55
        assert seconds == pytest.approx(1.0, abs=0.01)
        assert loop is True
        assert not watched.complaints
        assert not watched.requests


_SHOWN_AT = """async (time) => {
  const player = document.querySelector("[data-distal]").distal;
  player.pause();
  player.setTime(time);
  await player.settled();
}"""


def test_only_pictures_that_keep_frames_have_this_player() -> None:
    assert player_of(viewable(pieces.comet)) == FRAME_PLAYER
    assert player_of(viewable(pieces.cells)) == FRAME_PLAYER
    names = re.findall(r"WIDTH=256|EXT_color_buffer_float", PLAYER.read_text())
    assert not names
