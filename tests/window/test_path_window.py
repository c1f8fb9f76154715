"""A window shows direct light while things move, and paths at rest: more samples each frame."""

from __future__ import annotations

import threading
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from distal import Box, Camera, PointLight, Scene, Sphere, glass, matte
from distal.images.png import quantise
from distal.lang import slider
from distal.lang.render_options import RenderOptions
from distal.scene.viewing.viewable import Viewable, viewable
from distal.window import film_renderer
from distal.window.film_renderer import FilmRenderer
from distal.window.frame_renderers import PixelRenderer
from distal.window.keys import Action
from distal.window.session import Session
from distal.window.shot import Shot
from tests.window.test_refinement import SIZE, Frames

side = slider("Side", 1.0, 0.5, 2.0)
SCENE = Scene(
    Box(side).paint(matte("white")) | Sphere(0.8).translate(1.1, 0.5, 0.4).paint(glass()),
    lights=PointLight((2.0, 4.0, 3.0), color=(9.0, 9.0, 9.0), radius=0.5),
    camera=Camera((3.0, 2.0, 5.0)),
    background=(0.2, 0.3, 0.4),
    mode="path",
)
SEEN = viewable(SCENE)


def shot_of(scene: Viewable, **changes: object) -> Shot:
    return Session(scene, paused=True, **changes).shot(0.0)  # type: ignore[arg-type]


def finished(
    frames: Frames, shot: Shot, count: int, *, is_moving: bool = False, seen: Viewable = SEEN
) -> list[int]:
    """The samples of the next frames that are finished; 0 for direct light."""
    begin = len(frames.finished)
    for _ in range(4 * count):
        frames.ask(seen, shot, is_moving=is_moving)
        if not frames.worker.step() or len(frames.finished) >= begin + count:
            break
    assert not frames.failed
    return [made.samples for _, made in frames.finished[begin:]]


@pytest.fixture(autouse=True)
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Frames of one pass, whatever the machine takes for it."""
    monkeypatch.setattr(film_renderer, "_FRAME_S", 0.0)


def test_direct_light_comes_first_and_then_more_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    # Without photons, whose maps are those of passes: a window's passes are others.
    plain = SEEN.in_mode("path", caustics=False)
    frames, shot = Frames(PixelRenderer("cpu"), monkeypatch), shot_of(plain)
    assert shot.mode == "path"
    counts = finished(frames, shot, 7, seen=plain)
    assert counts[:2] == [0, 0]  # the coarsest frame measures; then the sharp one
    rising = [count for count in counts if count]
    assert rising[0] >= 4
    assert rising == sorted(set(rising))
    request, made = frames.finished[-1]
    assert not frames.scheduler.is_final(request)
    # The film has the light that `render` gives for these samples.
    exact = SCENE.render(size=SIZE, spp=made.samples, steering=shot.steering, caustics=False)
    assert made.pixels is not None
    off = np.abs(made.pixels.astype(int) - quantise(exact.array))
    assert off.max() <= 1


def test_a_window_has_caustics_unless_they_are_switched_off() -> None:
    lamp = PointLight((2.0, 4.0, 3.0), color=(9.0, 9.0, 9.0), radius=0.01)
    floor = Box((8.0, 0.2, 8.0)).translate(y=-0.6).paint(matte("white"))
    ball = Sphere(0.5).translate(0.0, 0.4, 0.0).paint(glass())
    seen = viewable(Scene(ball | floor, lights=lamp, camera=Camera((3.0, 2.0, 5.0)), mode="path"))
    shot, light = shot_of(seen), {}
    for caustics in (True, False):
        renderer, chosen = FilmRenderer("cpu"), seen.in_mode(None, caustics=caustics)
        for _ in range(4):
            made = renderer.render(chosen, shot, SIZE, threading.Event())
        light[caustics] = tiles(renderer._film.light)
    asked = {"size": SIZE, "steering": shot.steering, "spp": made.samples}
    assert seen.scene is not None
    stills = {
        caustics: np.stack(
            [
                tiles(seen.scene.render(seed=s, caustics=caustics, **asked).linear)
                for s in (1, 2, 3, 4)
            ]
        ).mean(axis=0)
        for caustics in (True, False)
    }
    # Where stills say that the caustic is: paths alone hardly ever meet so small a lamp.
    spot = np.unravel_index((stills[True] - stills[False]).argmax(), stills[True].shape)
    assert stills[True][spot] > 1.1 * stills[False][spot]
    for caustics in (True, False):
        assert light[caustics][spot] == pytest.approx(stills[caustics][spot], rel=0.04)
    assert light[True].mean() == pytest.approx(stills[True].mean(), rel=0.01)


def tiles(light: NDArray[np.float32]) -> NDArray[np.float64]:
    """The mean light of tiles of 8x8 pixels."""
    width, height = SIZE
    rows = light[..., :3].astype(float).reshape(height // 8, 8, width // 8, 8, 3)
    return rows.mean(axis=(1, 3, 4))


def test_a_change_begins_with_direct_light_again(monkeypatch: pytest.MonkeyPatch) -> None:
    frames, shot = Frames(PixelRenderer("cpu"), monkeypatch), shot_of(SEEN)
    finished(frames, shot, 5)
    turned = replace(shot, steering=replace(shot.steering, yaw=0.5))  # type: ignore[type-var]
    # Nothing more while it moves.
    assert set(finished(frames, turned, 6, is_moving=True)) == {0}
    first, second, *_ = (count for count in finished(frames, turned, 4) if count)
    assert 4 <= first < second


def test_a_film_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("film_renderer", "frame_scheduler"):
        monkeypatch.setattr(f"distal.window.{module}.MOST_SAMPLES", 6)
    frames, shot = Frames(PixelRenderer("cpu"), monkeypatch), shot_of(SEEN)
    counts = finished(frames, shot, 12)
    assert counts[-1] == 6
    assert frames.scheduler.is_final(frames.finished[-1][0])
    assert not frames.worker.step()


def test_a_broken_off_pass_changes_nothing() -> None:
    film, shot, cancel = FilmRenderer("cpu"), shot_of(SEEN), threading.Event()
    before = film.render(SEEN, shot, SIZE, cancel)
    cancel.set()
    assert film.render(SEEN, shot, SIZE, cancel).share < 1.0
    cancel.clear()
    assert film.render(SEEN, shot, SIZE, cancel).samples == before.samples + 1


def test_a_key_switches_between_direct_light_and_paths() -> None:
    session = Session(SEEN, paused=True)
    modes = [session.shot(0.0).mode]
    for _ in range(2):
        session.act(Action.MODE, 0.0)
        modes.append(session.shot(0.0).mode)
    assert modes == ["path", "direct", "path"]
    # Other views show no light; the choice stays.
    session.act(Action.NEXT_VIEW, 0.0)
    session.act(Action.MODE, 0.0)
    assert session.shot(0.0).mode == "direct"
    session.act(Action.LAST_VIEW, 0.0)
    assert session.shot(0.0).mode == "path"
    # Of any scene, and as the command line says.
    plain = viewable(Scene(Sphere(1.0)))
    assert shot_of(plain).mode == "direct"
    assert shot_of(plain, mode="path").mode == "path"


def test_a_saved_picture_has_the_film_and_says_how_it_was_made() -> None:
    film, shot = FilmRenderer("cpu"), shot_of(SEEN)
    shown = film.render(SEEN, shot, SIZE, threading.Event())
    saved = film.picture(SEEN, shot, SIZE)
    assert saved.provenance.mode == "path"
    assert saved.provenance.samples == saved.stats["samples"] >= 16 > shown.samples
    assert saved.metadata["distal:mode"] == "path"


@pytest.mark.parametrize("device", ["gpu-fragment", "gpu"])
def test_a_gpu_has_the_same_light(device: str) -> None:
    from distal.devices.adapters import adapters  # noqa: PLC0415

    if not adapters():
        pytest.skip("no adapter")
    shot, small = shot_of(SEEN), (32, 24)
    made = FilmRenderer(device).render(SEEN, shot, small, threading.Event())
    exact = SEEN.render(RenderOptions(size=small, samples=made.samples, steering=shot.steering))
    assert made.pixels is not None
    off = np.abs(made.pixels.astype(int) - quantise(exact.array))[..., :3]
    # The same random numbers; few paths turn off where floats differ in the last bit.
    assert np.median(off) <= 1
    assert off.mean() < 4
