"""The examples that keep frames: on every target, as texts for Shadertoy, and by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import distal
from distal.example_files import frame_examples
from distal.lang import Key, Keys
from tests import egl, gpu
from tests.frames.hosts import COUNT, SIZE, shown
from tests.frames.test_frames import HOSTS, buffers_of, ours

NAMES = sorted(frame_examples())
# A random path that meets a corner, or a whirl of zero length, goes another way where the last
# digit differs: few pixels, and never many.
CLOSE = 2e-3
MOST_APART = 0.02


def picture_of(name: str) -> Any:
    return distal.load(f"example:{name}")


def test_there_is_one_for_each_thing_that_a_frame_reads() -> None:
    assert NAMES == ["coral", "ink", "lamps", "pilot", "spectrum"]


@pytest.mark.sample(3, each="name")  # each piece of test_frames.py is drawn by every host
@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("name", NAMES)
def test_each_example_is_the_same_on_every_target(name: str, host: str) -> None:
    piece = picture_of(name)
    try:
        found = shown(buffers_of(piece), piece, HOSTS[host])
    except (egl.EglUnavailableError, gpu.GpuUnavailableError) as missing:
        pytest.skip(f"frames are not drawn on {host}: {missing}")
    mine = ours(piece)
    apart = np.abs(found - mine)[..., :3].max(axis=-1)
    assert float((apart > CLOSE).mean()) <= MOST_APART, (float(apart.max()), name)
    assert float(mine[..., :3].std()) > 0.01


@pytest.mark.parametrize("name", NAMES)
def test_each_example_is_exported_for_shadertoy(name: str, tmp_path: Any) -> None:
    made = picture_of(name).export(tmp_path / f"{name}.json", target="shadertoy")
    # The JSON of the whole, the tab Image, and one for each buffer.
    assert made.path.exists()
    assert len(made.beside) == len(buffers_of(picture_of(name))) + 1


def test_the_glider_is_steered_by_keys() -> None:
    glider = picture_of("pilot")
    state = next(b for b in buffers_of(glider) if b.name == "state")
    still = {"size": SIZE, "index": COUNT, "time": COUNT / 60.0}

    def body(*held: int, pressed: tuple[int, ...] = ()) -> Any:
        keys = Keys(frozenset(held), frozenset(pressed), frozenset())
        return state.shown.render(**still, keys=keys).array[-1, :2]

    left = body(Key.LEFT, pressed=(Key.LEFT,))[1, 0]
    right = body(Key.RIGHT, pressed=(Key.RIGHT,))[1, 0]
    assert left - right == pytest.approx(2.0 * 3.5 * COUNT / 60.0, rel=1e-4)
    ahead, back = (body(k, pressed=(Key.UP,))[0, 2:] for k in (Key.UP, Key.DOWN))
    forwards = np.array([np.cos(1.2), np.sin(1.2)])
    assert float((ahead - back) @ forwards) > 0.1


def test_the_mean_of_paths_has_less_noise_with_each_frame() -> None:
    lamps = picture_of("lamps")
    few, more, many = (
        lamps.render(size=(48, 36), index=i, time=i / 60.0).array[..., :3] for i in (0, 3, 63)
    )
    noise = [float(np.abs(each - many).mean()) for each in (few, more)]
    # Four times as many paths have half of the noise, if the 16 times better one is the truth.
    assert 0.4 < noise[1] / noise[0] < 0.65


def test_the_reaction_keeps_its_limits_and_grows() -> None:
    coral = picture_of("coral")
    last = buffers_of(coral)[-1]
    early, late = (last.shown.render(size=(64, 48), index=i).array for i in (5, 300))
    for cells in (early, late):
        assert float(cells[..., :2].min()) >= 0.0
        assert float(cells[..., :2].max()) <= 1.0
    assert float(late[..., 1].sum()) > 1.5 * float(early[..., 1].sum())
