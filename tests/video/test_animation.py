"""gif, apng and webp, read again by Pillow: frames, durations, loops, texts."""

import json
from fractions import Fraction

import numpy as np
import pytest
from PIL import Image, features

import distal
from distal.video import video
from distal.video.formats import VideoError
from tests.video.moving import psnr, scene_file, still

pytest.importorskip("av", reason="PyAV writes them: pip install 'distal[video]'")

SIZE = (96, 64)
KINDS = ["gif", "apng", "webp"]

CLEAR = """
from distal.lang import Frame, image, vec4


@image
def picture(frame: Frame) -> vec4:
    x = frame.coord.x / frame.resolution.x
    return vec4(x, frame.time, 1.0, 0.0 if x < 0.5 else 1.0)
"""


def read(path):
    """Frames in RGBA, the milliseconds each is shown, and what else the file says."""
    frames, lasts = [], []
    with Image.open(path) as picture:
        information = dict(picture.info)
        for i in range(picture.n_frames):
            picture.seek(i)
            frames.append(np.asarray(picture.convert("RGBA")))
            lasts.append(picture.info["duration"])
        exif = dict(picture.getexif())
    return frames, lasts, information, exif


@pytest.fixture(autouse=True)
def readable(request):
    if "webp" in request.node.name and not features.check("webp"):
        pytest.skip("this Pillow reads no WebP")


@pytest.mark.parametrize("kind", KINDS)
def test_frames_are_the_stills(moving, tmp_path, kind):
    out = tmp_path / f"out.{kind}"
    made = video(moving, out, duration=1, fps=12, size=SIZE)
    frames, _, _, _ = read(out)
    assert made.frames == len(frames) == 12
    for i in (0, 5, 11):
        shown = still(moving, SIZE, i / 12)
        assert psnr(frames[i][..., :3], shown) > 35.0
        # Far more than dither or compression changes.
        assert psnr(frames[i][..., :3], still(moving, SIZE, (i + 2) / 12)) < 30.0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["moving.py", f"out.{kind}"]


FADING = """
from distal.lang import Frame, image, vec3


@image
def picture(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    return vec3(0.7 - 0.2 * frame.time, 0.4 * uv.x, 0.1 + 0.05 * frame.time)
"""


@pytest.mark.parametrize("kind", KINDS)
def test_what_changes_slowly_leaves_no_ghosts(tmp_path, kind):
    fading = distal.load(str(scene_file(tmp_path, FADING)))
    out = tmp_path / f"out.{kind}"
    video(fading, out, duration=2, fps=12, size=SIZE)
    frames, _, _, _ = read(out)
    for i, frame in enumerate(frames):
        off = frame[..., :3].astype(float) - still(fading, SIZE, i / 12)
        assert abs(off.mean(axis=(0, 1))).max() < 2.5, i


WANDERING = """
from distal.lang import Frame, image, vec4


@image
def picture(frame: Frame) -> vec4:
    x = frame.coord.x / frame.resolution.x - frame.time
    alpha = 0.0
    if x > 0.0 and x < 0.2:
        alpha = 1.0
    return vec4(1.0, 0.5, 0.1, alpha)
"""


@pytest.mark.parametrize("kind", ["apng", "webp"])
@pytest.mark.parametrize("quality", ["high", "lossless"])
def test_what_was_clear_is_clear_again(tmp_path, kind, quality):
    wandering = distal.load(str(scene_file(tmp_path, WANDERING)))
    out = tmp_path / f"out.{kind}"
    video(wandering, out, duration=0.8, fps=5, size=SIZE, quality=quality)
    frames, _, _, _ = read(out)
    for i, frame in enumerate(frames):
        expected = wandering.render(size=SIZE, time=i / 5).array[..., 3] * 255
        assert (frame[..., 3] == expected).all()


@pytest.mark.parametrize("kind", ["apng", "webp"])
def test_lossless_is_exact_also_where_it_is_clear(tmp_path, kind):
    clear = distal.load(str(scene_file(tmp_path, CLEAR)))
    out = tmp_path / f"out.{kind}"
    video(clear, out, duration=0.5, fps=10, size=SIZE, quality="lossless")
    frames, _, _, _ = read(out)
    assert len(frames) == 5
    for i, frame in enumerate(frames):
        array = clear.render(size=SIZE, time=i / 10).array
        expected = np.floor(array * 255.0 + 0.5).astype(int)
        assert set(np.unique(frame[..., 3])) == {0, 255}
        seen = expected[..., 3] == 255
        assert (frame[seen] == expected[seen]).all()
        assert (frame[..., 3] == expected[..., 3]).all()


@pytest.mark.parametrize(
    ("kind", "ticks"),
    [("gif", 100), ("webp", 1000), ("apng", None)],
    ids=["gif", "webp", "apng"],
)
@pytest.mark.parametrize("fps", [30, "30000/1001", 12, 50])
def test_durations_add_up_exactly(moving, tmp_path, kind, ticks, fps):
    out = tmp_path / f"out.{kind}"
    count = video(moving, out, duration=1, fps=fps, size=(32, 24)).frames
    _, lasts, _, _ = read(out)
    rate = Fraction(fps)
    if ticks is None:
        np.testing.assert_allclose(lasts, float(1000 / rate), rtol=1e-12)
        return
    # Each frame begins at the tick nearest to its time: off by half a tick, never by more.
    begins = np.cumsum([0, *lasts]) * ticks / 1000
    exact = [float(i * ticks / rate) for i in range(count + 1)]
    np.testing.assert_allclose(begins, exact, atol=0.5 + 1e-9)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("loop", [True, False])
def test_the_mark_for_loops(moving, tmp_path, kind, loop):
    out = tmp_path / f"out.{kind}"
    video(moving, out, duration=1, fps=4, size=(32, 24), loop=loop)
    _, _, information, _ = read(out)
    once = {"gif": None, "apng": 1, "webp": 1}  # a GIF without the mark is shown once
    assert information.get("loop") == (0 if loop else once[kind])


@pytest.mark.parametrize("kind", KINDS)
def test_the_file_says_where_it_comes_from(moving, tmp_path, kind):
    out = tmp_path / f"out.{kind}"
    video(moving, out, duration=1, fps=4, size=(32, 24), params={"glow": 0.25})
    _, _, information, exif = read(out)
    text = exif[0x010E] if kind == "webp" else information["comment"]
    comment = json.loads(text)
    assert comment["source"] == "picture"
    assert comment["parameters"] == {"glow": 0.25}
    assert comment["frames"] == 4


def test_apng_says_that_it_is_srgb(moving, tmp_path):
    out = tmp_path / "out.apng"
    video(moving, out, duration=0.5, fps=4, size=(32, 24))
    assert read(out)[2]["srgb"] == 0


def test_what_stands_still_in_a_gif_keeps_its_colour(tmp_path):
    text = """
from distal.lang import Frame, image, vec3


@image
def picture(frame: Frame) -> vec3:
    uv = frame.coord / frame.resolution
    if uv.x < 0.5:
        return vec3(uv.x, uv.y, 0.3)
    return vec3(frame.time, uv.y, uv.x)
"""
    picture = distal.load(str(scene_file(tmp_path, text)))
    out = tmp_path / "out.gif"
    video(picture, out, duration=1, fps=8, size=SIZE)
    frames, _, _, _ = read(out)
    left = [frame[:, : SIZE[0] // 2] for frame in frames]
    assert all((part == left[0]).all() for part in left)


def test_what_a_kind_of_file_cannot_have(moving, tmp_path):
    cases = {
        ("o.gif", 60, "high"): "a gif counts in hundredths of a second and has at most 50 frames "
        "in one, not 60; webp and apng have more",
        ("o.gif", 10, "lossless"): "a gif has 256 colors: it is never lossless; choose webp or "
        "apng",
        ("o.apng", Fraction(65537, 3000), "high"): "apng cannot count 65537/3000 frames a second "
        "exactly; round it",
    }
    for (name, fps, quality), message in cases.items():
        with pytest.raises(VideoError) as caught:
            video(moving, tmp_path / name, duration=1, fps=fps, quality=quality, size=SIZE)
        assert str(caught.value) == message
    with pytest.raises(VideoError, match="webp has at most 16383 pixels a side, not 16384"):
        video(moving, tmp_path / "o.webp", duration=1, size=(16384, 2))
