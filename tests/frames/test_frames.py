"""Pictures that keep frames: the same on every target, by hosts that share nothing with ours."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image as PillowImage

import distal
from distal.backends import emit, get_target
from distal.backends.numpy import interpreter
from distal.compiler.driver import run_passes
from distal.diagnostics import CompileError, LoadError
from distal.frontend import lower
from distal.lang import Frame, Key, Keys, buffer, gradient, image, ivec2, texel, vec2, vec3, vec4
from distal.lang.functions import FrameBuffer
from distal.lang.render_options import RenderOptions
from distal.lang.runtime_access import executor
from distal.runtime.frame_history import LiveFrames
from tests import egl, gpu
from tests.frames import pieces
from tests.frames.hosts import COUNT, KEYS, MOUSE, SIZE, STEP, keyboard, shown
from tests.glsl import run_glsl

BY_NAME = {piece.name: piece for piece in pieces.PIECES}
# Feedback of floats that are added in another order; whole numbers and choices are equal.
CLOSE = 2e-5


def ours(piece: Any, count: int = COUNT, device: str = "cpu") -> NDArray[np.float32]:
    index = count - 1
    return piece.render(
        size=SIZE,
        index=index,
        time=index * STEP,
        delta=STEP,
        mouse=MOUSE,
        buttons=1,
        keys=KEYS,
        device=device,
    ).array


def buffers_of(piece: Any) -> tuple[FrameBuffer, ...]:
    return executor().parts(piece).read.buffers


def by_reference(image: Any, texels: Any, values: Any) -> NDArray[np.float32]:
    module = run_passes(lower(image), get_target("numpy"))
    read = {r.name: texels(r.source) for r in module.resources}
    known = {u.name: values.get(u.name, u.default) for u in module.uniforms}
    return interpreter.render(module, *SIZE, known, read)


def by_glsl(image: Any, texels: Any, values: Any) -> NDArray[np.float32]:
    module = run_passes(lower(image), get_target("glsl-es300"))
    artifact = emit(module, get_target("glsl-es300"))
    read = {r.name: texels(r.source) for r in module.resources}
    return run_glsl(artifact, SIZE, uniforms_of(artifact, values), textures=read)


def by_wgsl(image: Any, texels: Any, values: Any) -> NDArray[np.float32]:
    module = run_passes(lower(image), get_target("wgsl"))
    artifact = emit(module, get_target("wgsl"))
    read = {r.name: texels(r.source) for r in module.resources}
    return gpu.run_wgsl(artifact, SIZE, uniforms_of(artifact, values), textures=read)


def uniforms_of(artifact: Any, values: Any) -> dict[str, Any]:
    names = {u["name"] for u in artifact.interface["uniforms"] if u["origin"] == "frame"}
    return {name: value for name, value in values.items() if name in names}


HOSTS = {"reference": by_reference, "glsl": by_glsl, "wgsl": by_wgsl}


@pytest.mark.parametrize("host", HOSTS)
@pytest.mark.parametrize("name", BY_NAME)
def test_each_piece_is_the_same_on_every_target(name: str, host: str) -> None:
    piece = BY_NAME[name]
    try:
        found = shown(buffers_of(piece), piece, HOSTS[host])
    except (egl.EglUnavailableError, gpu.GpuUnavailableError) as missing:
        pytest.skip(f"frames are not drawn on {host}: {missing}")
    mine = ours(piece)
    assert float(np.abs(found - mine).max()) <= CLOSE
    assert float(mine[..., :3].std()) > 0.01, "a picture of one color shows nothing"


SHADERTOY = """#version 300 es
precision highp float;
precision highp int;
uniform vec3 iResolution;
uniform float iTime, iTimeDelta;
uniform vec4 iMouse, iDate;
uniform int iFrame;
// Shadertoy says nothing of it; drivers of desktops read every sampler so, Mesa only if told.
precision highp sampler2D;
uniform sampler2D iChannel0, iChannel1, iChannel2, iChannel3;
out vec4 shadertoy_out;
"""
CALL = "\nvoid main() { mainImage(shadertoy_out, gl_FragCoord.xy); }\n"


@pytest.mark.parametrize("name", BY_NAME)
def test_shadertoy_draws_what_is_exported(name: str, tmp_path: Path) -> None:
    piece = BY_NAME[name]
    piece.export(tmp_path / "piece.glsl")
    shader = json.loads((tmp_path / "piece.json").read_text())
    try:
        found = drawn_by_shadertoy(shader["renderpass"])
    except egl.EglUnavailableError as missing:
        pytest.skip(f"the exported texts are not drawn: {missing}")
    assert float(np.abs(found - ours(piece))[..., :3].max()) <= CLOSE
    # The tabs as files are those of the JSON.
    for each in shader["renderpass"]:
        tab = "" if each["name"] == "Image" else f".{each['name'].lower().replace(' ', '_')}"
        assert (tmp_path / f"piece{tab}.glsl").read_text().strip() == each["code"].strip()


def drawn_by_shadertoy(passes: list[dict[str, Any]]) -> NDArray[np.float32]:
    width, height = SIZE
    known = {p["outputs"][0]["id"]: np.zeros((height, width, 4), np.float32) for p in passes}
    context = egl.context()
    for index in range(COUNT):
        for each in passes:
            shader = egl.EglShader(SHADERTOY + each["code"] + CALL)
            values: dict[str, Any] = {
                "iResolution": (*SIZE, 1.0),
                "iTime": index * STEP,
                "iTimeDelta": STEP,
                "iFrame": index,
                "iMouse": MOUSE,
            }
            bound = []
            for given in each["inputs"]:
                data = keyboard(KEYS) if given["type"] == "keyboard" else known[given["id"]]
                data = np.ascontiguousarray(data)
                texture = context.texture(data.shape[1::-1], 4, data.tobytes(), dtype="f4")
                texture.repeat_x = texture.repeat_y = given["sampler"]["wrap"] == "repeat"
                texture.use(given["channel"])
                values[f"iChannel{given['channel']}"] = given["channel"]
                bound.append(texture)
            used = {name: v for name, v in values.items() if name in shader.uniforms}
            known[each["outputs"][0]["id"]] = shader.render(SIZE, used)[::-1]
            for texture in bound:
                texture.release()
            shader.release()
    return known[passes[-1]["outputs"][0]["id"]][::-1]


def test_frames_are_counted_by_the_time() -> None:
    whole = pieces.mean.render(size=SIZE, time=9 * STEP)
    assert whole.provenance.index == 9
    assert np.array_equal(whole.array, pieces.mean.render(size=SIZE, index=9, time=9 * STEP).array)
    slower = pieces.mean.render(size=SIZE, time=9 * STEP, delta=3 * STEP)
    assert slower.provenance.index == 3


def test_a_picture_does_not_depend_on_those_before_it() -> None:
    first = ours(pieces.waves, 9)
    ours(pieces.waves, 30)
    assert np.array_equal(ours(pieces.waves, 9), first)
    ours(pieces.waves, 8)
    assert np.array_equal(ours(pieces.waves, 9), first)


def test_parameters_of_buffers_are_those_of_the_picture() -> None:
    assert [p.name for p in pieces.comet.parameters()] == ["fading"]
    at = {"size": SIZE, "index": 12, "time": 12 * STEP}
    short = pieces.comet.render(**at, params={"fading": 0.2}).array
    long = pieces.comet.render(**at, params={"fading": 1.0}).array
    assert long[..., :3].sum() > 2.0 * short[..., :3].sum()


def test_a_buffer_shows_itself() -> None:
    # A buffer is a picture, too: its own last frame is what it drew.
    alone = pieces.cells.render(size=SIZE, index=3)
    assert np.array_equal(alone.array[..., 0], pieces.life.render(size=SIZE, index=3).array[..., 0])


def test_several_samples_are_of_the_picture_alone() -> None:
    one = pieces.mean.render(size=SIZE, index=4).array
    four = pieces.mean.render(size=SIZE, index=4, samples=4).array
    # Samples lie in the pixel and around it: its neighbors have a share.
    assert 0.0 < float(np.abs(one - four).max()) < 0.5
    assert float(four.mean()) == pytest.approx(float(one.mean()), abs=0.02)


def test_keys_are_codes() -> None:
    still = pieces.ball.render(size=SIZE, index=5).array
    moved = pieces.ball.render(size=SIZE, index=5, keys=[Key.RIGHT]).array
    assert moved[..., 0].argmax(axis=1)[9] > still[..., 0].argmax(axis=1)[9]
    pressed = pieces.pen.render(
        size=SIZE, index=2, mouse=MOUSE, keys=Keys(pressed=frozenset({ord("C")}))
    )
    assert float(pressed.array[..., :3].max()) == 0.0


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"keys": "abc"}, TypeError, "keys are codes such as Key.LEFT or ord('A'), not 'abc'"),
        ({"keys": ["a"]}, TypeError, "a key is a code such as Key.LEFT or ord('A'), not 'a'"),
        ({"keys": [300]}, ValueError, "the code of a key lies between 0 and 255, not 300"),
        ({"buttons": 1.5}, TypeError, "buttons is a whole number, not 1.5"),
        ({"delta": 0.0}, ValueError, "delta is the seconds between two frames, more than 0, not 0"),
    ],
)
def test_bad_options_are_named(options: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=re.escape(message)):
        pieces.ball.render(size=(2, 2), **options)


def test_live_frames_follow_one_another() -> None:
    live = LiveFrames()
    run, options = executor().parts(pieces.mean), {"size": SIZE, "history": live}
    seen = [
        executor().render(pieces.mean, RenderOptions(time=t, **options)).provenance.index
        for t in (0.0, 0.5, 0.5, 3.0, 1.0, 1.25)
    ]
    assert seen == [0, 1, 1, 2, 0, 1]
    assert run.read.buffers == (pieces.sums,)


def test_a_video_has_the_frames_of_stills(tmp_path: Path) -> None:
    pieces.blur.video(tmp_path / "b_%02d.png", duration=0.25, fps=24, size=SIZE)
    last = pieces.blur.render(size=SIZE, index=5, time=5 / 24, delta=1 / 24)
    last.save(tmp_path / "still.png")
    film = np.asarray(PillowImage.open(tmp_path / "b_05.png"))
    assert np.array_equal(film, np.asarray(PillowImage.open(tmp_path / "still.png")))


def five_buffers() -> Any:
    made: list[Any] = []
    for _ in range(5):

        @buffer
        def one(frame: Frame) -> vec4:
            return vec4(0.1)

        made.append(one)
    a, b, c, d, e = made

    @image
    def picture(frame: Frame) -> vec4:
        at = ivec2(0, 0)
        return texel(a, at) + texel(b, at) + texel(c, at) + texel(d, at) + texel(e, at)

    return picture


def test_five_buffers_are_too_many() -> None:
    with pytest.raises(CompileError, match="a picture has 4 buffers at most: one, one, one, one"):
        five_buffers().render(size=(2, 2))


@image
def other(frame: Frame) -> vec3:
    return texel(another, ivec2(0, 0)).rgb


@image
def another(frame: Frame) -> vec3:
    return texel(other, ivec2(0, 0)).rgb


def test_an_image_that_is_no_buffer_is_not_read() -> None:
    with pytest.raises(CompileError, match="are read, and neither is a buffer") as caught:
        other.render(size=(2, 2))
    assert "write @buffer above what another picture reads" in str(caught.value)


def test_what_has_no_frames_says_so() -> None:
    with pytest.raises(LoadError, match="which only the picture of an @image has"):
        _ = pieces.tail.last_frame.data


@image
def soft_circle(frame: Frame) -> vec3:
    def distance(p: vec2) -> float:
        return (p.x * p.x + p.y * p.y) ** 0.5 - 6.0

    p = frame.coord - 0.5 * frame.resolution
    slope = gradient(distance, p)
    width = (slope.x * slope.x + slope.y * slope.y) ** 0.5
    return vec3(distance(p) / width)


def test_a_gradient_by_the_pixel_is_a_derivative_on_screen() -> None:
    # The distance to a circle grows by 1 for each pixel: the division changes nothing.
    shown = soft_circle.render(size=(20, 20)).array[..., 0]
    y, x = np.mgrid[0:20, 0:20] + 0.5 - 10.0
    assert np.abs(shown - (np.hypot(x, y) - 6.0)).max() < 1e-4


def test_texts_for_hosts_without_frames_are_refused() -> None:
    for target, host in (("isf", "ISF 2"), ("glslcanvas", "glslCanvas")):
        with pytest.raises(CompileError, match=f"{host} has no earlier frames"):
            distal.compile(sampled, target)


@buffer
def grey(frame: Frame) -> vec4:
    return vec4(0.5)


@image
def sampled(frame: Frame) -> vec3:
    from_buffer = distal.lang.sample(grey, frame.coord / frame.resolution)
    return from_buffer.rgb


@pytest.mark.parametrize("device", ["gpu", "gpu-fragment"])
def test_a_gpu_keeps_the_same_frames(device: str) -> None:
    try:
        gpu.device()
    except gpu.GpuUnavailableError as missing:
        pytest.skip(f"frames are not kept on a GPU: {missing}")
    for piece in (pieces.chase, pieces.ball):
        assert float(np.abs(ours(piece, device=device) - ours(piece)).max()) <= CLOSE
