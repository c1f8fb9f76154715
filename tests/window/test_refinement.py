"""A still gets smooth edges step by step, and anything that changes begins again at one sample."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from distal import Box, Camera, Scene, Sphere, matte
from distal.devices.adapters import chosen, opened
from distal.diagnostics import DeviceError
from distal.lang import Frame, image, slider, vec3
from distal.lang.render_options import RenderOptions
from distal.scene.viewing.viewable import Viewable, viewable
from distal.window import frame_scheduler
from distal.window.frame_renderers import (
    FrameRenderer,
    PixelRenderer,
    RenderedFrame,
    TextureRenderer,
)
from distal.window.frame_scheduler import FrameRequest, FrameScheduler
from distal.window.session import Session
from distal.window.shot import Shot
from tests.pictures.comparison import difference

SIZE = (96, 72)
side = slider("Side", 1.0, 0.5, 2.0)
shape = Box(side).rotate(y=0.4).paint(matte("white")) | Sphere(0.8).translate(1.1, 0.5, 0.4)
SCENE = viewable(Scene(shape, camera=Camera((3.0, 2.0, 5.0)), background="black"))


@image
def picture_of_two_colors(frame: Frame) -> vec3:
    return vec3(1.0 if frame.coord.x > frame.coord.y else 0.0)


def shot_of(scene: Viewable) -> Shot:
    return Session(scene, paused=True).shot(0.0)


def turned(shot: Shot) -> Shot:
    assert shot.steering is not None
    return replace(shot, steering=replace(shot.steering, yaw=0.5))


class SteppedWorker:
    """Runs a job when a test says so."""

    def __init__(self) -> None:
        self.event = threading.Event()
        self._jobs: list[tuple[Callable[[threading.Event], Any], Callable[[Any], None]]] = []

    def submit(self, job: Callable[[threading.Event], Any], done: Callable[[Any], None]) -> None:
        self._jobs.append((job, done))

    def cancel(self) -> None:
        self.event.set()

    def step(self) -> bool:
        """Run the first job; whether there was one."""
        if not self._jobs:
            return False
        job, done = self._jobs.pop(0)
        done(job(self.event))
        self.event.clear()
        return True


class Stub:
    """A renderer that only looks whether it should stop."""

    device = "stub"
    samples: tuple[int | None, ...] = (1, None)

    def prepare(self, viewable: Viewable, shot: Shot) -> None:
        pass

    def render(
        self,
        viewable: Viewable,
        shot: Shot,
        size: tuple[int, int],
        cancel: threading.Event,
        *,
        samples: int | None = 1,
    ) -> RenderedFrame:
        return RenderedFrame(seconds=1e-3, share=0.5 if cancel.is_set() else 1.0)


class Frames:
    """A scheduler, and what it finished."""

    def __init__(self, renderer: FrameRenderer, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(frame_scheduler, "_LEAST_GAP_S", 0.0)
        monkeypatch.setattr(frame_scheduler, "_LEAST_REST_S", 0.0)
        self.worker = SteppedWorker()
        self.finished: list[tuple[FrameRequest, RenderedFrame]] = []
        self.failed: list[BaseException] = []
        self.scheduler = FrameScheduler(
            renderer,
            self.worker,  # type: ignore[arg-type]
            lambda request, made: self.finished.append((request, made)),
            lambda _, error: self.failed.append(error),
        )

    def ask(self, scene: Viewable, shot: Shot, *, is_moving: bool = False) -> None:
        self.scheduler.request_frame(scene, shot, SIZE, is_moving=is_moving)

    def rest(self, scene: Viewable, shot: Shot, *, is_moving: bool = False) -> list[FrameRequest]:
        """Run frames until none is wanted; those that were finished."""
        before = len(self.finished)
        for _ in range(9):
            self.ask(scene, shot, is_moving=is_moving)
            if not self.worker.step():
                assert not self.failed
                return [request for request, _ in self.finished[before:]]
        raise AssertionError("it does not come to rest")


@pytest.fixture(scope="module")
def gpu_renderer() -> TextureRenderer:
    try:
        gpu = opened(chosen())
    except DeviceError as error:
        pytest.skip(str(error))
    return TextureRenderer("gpu-fragment", gpu.device, None)


def pixels_of(texture: Any) -> NDArray[np.uint8]:
    width, height = texture.size[:2]
    gpu = opened(chosen())
    data = gpu.device.queue.read_texture(
        {"texture": texture}, {"bytes_per_row": width * 4}, (width, height, 1)
    )
    return np.frombuffer(data, np.uint8).reshape(height, width, 4)


def on_cpu(shot: Shot, samples: int) -> NDArray[np.float32]:
    options = RenderOptions(size=SIZE, samples=samples, params=dict(shot.parameters))
    return SCENE.render(replace(options, steering=shot.steering)).array


def test_edges_approach_those_of_many_samples(gpu_renderer: TextureRenderer) -> None:
    many, shot = on_cpu(shot_of(SCENE), 256), shot_of(SCENE)
    found = []
    for samples in gpu_renderer.samples:
        made = gpu_renderer.render(SCENE, shot, SIZE, threading.Event(), samples=samples)
        found.append(pixels_of(made.texture))
        if samples > 1:
            assert difference(found[-1], on_cpu(shot, samples)).is_agreement, samples
    errors = [np.abs(pixels / np.float32(255) - many)[..., :3].max(axis=2) for pixels in found]
    is_edge = errors[0] > 0.1
    assert is_edge.sum() > 100
    one, four, sixteen = (error[is_edge].mean() for error in errors)
    assert four < one / 2
    assert sixteen < one / 5


def test_a_still_is_refined_and_a_change_begins_again(
    gpu_renderer: TextureRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, shot = Frames(gpu_renderer, monkeypatch), shot_of(SCENE)
    frames.rest(SCENE, shot)
    assert [request.quality for request, _ in frames.finished[-3:]] == [
        (1.0, 0),
        (1.0, 1),
        (1.0, 2),
    ]
    assert all(request.refinement == 0 for request, _ in frames.finished[:-2])
    assert frames.scheduler.is_final(frames.finished[-1][0])
    set_anew = replace(shot, parameters=(("side", 1.5),))
    for changed in (replace(shot, time=1.0), set_anew, turned(shot)):
        assert [request.refinement for request in frames.rest(SCENE, changed)][-3:] == [0, 1, 2]
    other = frames.rest(SCENE, replace(shot, view="normal"))
    assert {request.refinement for request in other} == {0}
    assert frames.scheduler.is_final(other[-1])


def test_a_change_stops_a_refinement_and_spoils_nothing_on_the_screen(
    gpu_renderer: TextureRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, shot = Frames(gpu_renderer, monkeypatch), shot_of(SCENE)
    draw = gpu_renderer._draw

    def draw_while_the_camera_moves(
        scene: Viewable, shot: Shot, texture: Any, options: RenderOptions
    ) -> None:
        if options.samples == 16:
            frames.ask(SCENE, turned(shot), is_moving=True)
        draw(scene, shot, texture, options)

    monkeypatch.setattr(gpu_renderer, "_draw", draw_while_the_camera_moves)
    for _ in range(9):
        frames.ask(SCENE, shot)
        frames.worker.step()
        if frames.finished[-1][1].share < 1.0:
            break
    stopped = [made for _, made in frames.finished if made.share < 1.0]
    assert len(stopped) == 1
    request, _ = frames.finished[-2]
    assert request.refinement == 1
    assert frames.scheduler.shown == request
    moved = frames.rest(SCENE, turned(shot), is_moving=True)
    assert {request.refinement for request in moved} == {0}
    assert moved[0].shot == turned(shot)
    # While a frame is on the screen, others are drawn into another texture.
    kept = gpu_renderer.render(SCENE, shot, SIZE, threading.Event(), samples=4)
    before = pixels_of(kept.texture)
    gpu_renderer.render(SCENE, turned(shot), SIZE, threading.Event())
    assert np.array_equal(pixels_of(kept.texture), before)


def test_what_moves_is_never_refined(
    gpu_renderer: TextureRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    frames, shot = Frames(gpu_renderer, monkeypatch), shot_of(SCENE)
    for time in range(4):
        frames.rest(SCENE, replace(shot, time=float(time)), is_moving=True)
    frames.rest(SCENE, replace(shot, time=3.0), is_moving=True)
    assert len(frames.finished) >= 4
    assert {request.refinement for request, _ in frames.finished} == {0}


@pytest.mark.parametrize("device", ["cpu", "gpu"])
def test_an_image_has_one_sample(
    device: str, gpu_renderer: TextureRenderer, monkeypatch: pytest.MonkeyPatch
) -> None:
    renderer = gpu_renderer if device == "gpu" else PixelRenderer("cpu")
    shown = viewable(picture_of_two_colors)
    frames = Frames(renderer, monkeypatch)
    finished = frames.rest(shown, shot_of(shown))
    assert finished[-1].quality == (1.0, 0)
    assert frames.scheduler.is_final(finished[-1])


def test_another_job_does_not_wait_for_a_refinement(monkeypatch: pytest.MonkeyPatch) -> None:
    frames, shot = Frames(Stub(), monkeypatch), shot_of(SCENE)
    while not (frames.scheduler.shown and frames.scheduler.shown.share == 1.0):
        frames.ask(SCENE, shot)
        frames.scheduler.postpone_refinement()
        assert not frames.worker.event.is_set()  # a frame of one sample is finished
        frames.worker.step()
    frames.ask(SCENE, shot)
    frames.scheduler.postpone_refinement()
    assert frames.worker.step()
    assert frames.finished[-1][0].refinement == 1
    assert frames.finished[-1][1].share < 1.0
    assert [request.refinement for request in frames.rest(SCENE, shot)] == [1]
