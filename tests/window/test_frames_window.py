"""A window of a picture that keeps frames: one after the other, at one size, with keys."""

from __future__ import annotations

import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from distal.lang import Key, Keys
from distal.scene.viewing.viewable import viewable
from distal.window.frame_renderers import PixelRenderer
from distal.window.keys import code_of_key
from distal.window.session import Session
from tests.frames import pieces
from tests.frames.hosts import SIZE
from tests.window.test_refinement import Frames

NEVER = threading.Event()


def shown(renderer: PixelRenderer, seen: Any, shot: Any) -> Any:
    made = renderer.render(seen, shot, SIZE, NEVER)
    assert made.pixels is not None
    return made.pixels


def test_each_later_time_is_the_next_frame() -> None:
    seen, renderer = viewable(pieces.mean), PixelRenderer("cpu")
    shot = Session(seen, paused=True).shot(0.0)
    first = shown(renderer, seen, shot)
    assert np.array_equal(shown(renderer, seen, shot), first)  # the same time, the same frame
    later = shown(renderer, seen, replace(shot, time=2.5))
    assert np.array_equal(later, _bytes(pieces.mean.render(size=SIZE, index=1, time=1.0)))
    again = shown(renderer, seen, replace(shot, time=1.0))  # back in time: it begins again
    assert np.array_equal(again, first)


def _bytes(picture: Any) -> Any:
    return np.floor(np.clip(picture.array, 0.0, 1.0) * 255.0 + 0.5).astype(np.uint8)


def test_frames_have_the_size_of_the_window(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = viewable(pieces.waves)
    frames = Frames(PixelRenderer("cpu"), monkeypatch)
    shot = Session(seen, paused=True).shot(0.0)
    for time in (0.0, 0.1, 0.2):
        frames.ask(seen, replace(shot, time=time), is_moving=True)
        frames.worker.step()
    assert [request.share for request, _ in frames.finished] == [1.0] * len(frames.finished)
    assert frames.finished


def test_keys_reach_the_picture_once() -> None:
    seen = viewable(pieces.ball)
    assert seen.reads_keyboard and not viewable(pieces.waves).reads_keyboard
    session = Session(seen, paused=True)
    session.key_changed(Key.RIGHT, down=True)
    session.key_changed(Key.RIGHT, down=True)  # repeated by the system
    keys = session.shot(0.0).keys
    right = frozenset({int(Key.RIGHT)})
    assert keys == Keys(right, right, right)
    assert keys.settled() == Keys(right, frozenset(), right)
    session.key_changed(Key.RIGHT, down=False)
    assert session.keys.held == frozenset()
    assert session.keys.toggled == right


@pytest.mark.parametrize(
    ("key", "code"),
    [
        ("ArrowLeft", 37),
        ("a", 65),
        ("Z", 90),
        ("7", 55),
        (" ", 32),
        ("Shift", 16),
        ("Escape", None),
        ("F11", None),
        ("ä", None),
    ],
)
def test_codes_are_those_of_browsers(key: str, code: int | None) -> None:
    assert code_of_key(key) == code
    assert code_of_key(key, modified=True) is None
