"""mp4 and webm, decoded again: counts, times, pixels, colors, what the file says of itself."""

import json
from fractions import Fraction

import numpy as np
import pytest

import distal
from distal.video import video
from tests.video.moving import (
    PATCHES,
    PATCHES_SCENE,
    decode,
    psnr,
    scene_file,
    still,
)

pytest.importorskip("av", reason="PyAV writes and reads videos: pip install 'distal[video]'")

SIZE = (96, 64)


@pytest.mark.parametrize("fps", [30, "30000/1001", 60, 24, 12.5])
def test_mp4_has_exactly_the_frames_and_times_that_were_asked_for(moving, tmp_path, fps):
    out = tmp_path / "out.mp4"
    made = video(moving, out, duration=4.5, fps=fps, size=SIZE)
    rate = Fraction(fps)
    found = decode(out)
    assert made.frames == len(found.frames) == round(4.5 * rate)
    assert found.times == [i / rate for i in range(made.frames)]
    assert found.rate == rate
    assert found.size == SIZE
    assert [p.name for p in tmp_path.iterdir() if p.name != "moving.py"] == ["out.mp4"]


@pytest.mark.parametrize("fps", [30, "30000/1001"])
def test_webm_counts_milliseconds_each_time_is_the_nearest(moving, tmp_path, fps):
    out = tmp_path / "out.webm"
    video(moving, out, duration=4.5, fps=fps, size=SIZE)
    rate = Fraction(fps)
    found = decode(out)
    exact = [i / rate for i in range(round(4.5 * rate))]
    assert len(found.times) == len(exact)
    assert max(abs(a - b) for a, b in zip(found.times, exact, strict=True)) <= Fraction(1, 2000)
    assert found.rate == rate


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_every_frame_is_the_still_of_its_time(moving, tmp_path, suffix):
    out = tmp_path / f"out.{suffix}"
    video(moving, out, duration=2.2, fps=20, start=0.35, size=SIZE, params={"glow": 0.9})
    found = decode(out)
    assert len(found.frames) == 44
    for i in (0, 1, 20, 39, 40, 43):  # the first and last, and both sides of where pieces meet
        shown = still(moving, SIZE, 0.35 + i / 20, params={"glow": 0.9})
        assert psnr(found.frames[i], shown) > 35.0
    # The bound tells frames apart: the picture one frame later is another.
    assert psnr(found.frames[0], still(moving, SIZE, 0.4, params={"glow": 0.9})) < 35.0


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_colours_survive(tmp_path, suffix):
    patches = distal.load(str(scene_file(tmp_path, PATCHES_SCENE)))
    out = tmp_path / f"out.{suffix}"
    video(patches, out, duration=0.5, fps=10, size=(16 * len(PATCHES), 32))
    found = decode(out)
    colors, pixels = found.context
    assert colors == (1, 1, 1, 1)  # BT.709's primaries, transfer and matrix; 16 to 235
    assert pixels == "yuv420p"
    for frame in (found.frames[0], found.frames[-1]):
        for i, color in enumerate(PATCHES):
            middle = frame[8:24, 16 * i + 4 : 16 * i + 12].reshape(-1, 3).mean(axis=0)
            # 8 bits of Y'CbCr are off by half a step, which is 1.1 of 255 in blue; by the matrix
            # of BT.601, the usual mistake, green would be off by 16 and more.
            np.testing.assert_allclose(middle, np.array(color) * 255.0, atol=3.0)


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_lossless_is_exact_and_takes_odd_sizes(moving, tmp_path, suffix):
    out = tmp_path / f"out.{suffix}"
    video(moving, out, duration=2.5, fps=10, size=(63, 41), quality="lossless")
    found = decode(out)
    assert found.context == ((1, 13, 0, 2), "gbrp")  # sRGB, 0 to 255
    assert len(found.frames) == 25
    for i, frame in enumerate(found.frames):
        assert (frame == still(moving, (63, 41), i / 10)).all()


def test_quality_is_size(moving, tmp_path):
    sizes = [
        video(
            moving, tmp_path / "o.mp4", duration=1, fps=20, size=(192, 128), quality=quality
        ).bytes
        for quality in ("low", "medium", "high", 100)
    ]
    assert sizes == sorted(sizes)
    assert sizes[0] * 1.5 < sizes[3]


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_the_file_says_where_it_comes_from(moving, tmp_path, suffix):
    out = tmp_path / f"out.{suffix}"
    video(moving, out, duration=0.5, fps=10, size=SIZE, params={"glow": 0.25})
    tags = decode(out).metadata
    comment = json.loads(tags["comment"])
    assert tags["title"] == comment["source"] == "picture"
    assert comment["parameters"] == {"glow": 0.25}
    assert (comment["fps"], comment["frames"], comment["size"]) == ("10", 5, "96x64")
    still_hash = moving.render(size=(8, 8)).metadata["distal:source-hash"]
    assert comment["source_hash"] == still_hash


def test_mp4_can_be_played_before_all_of_it_has_come(moving, tmp_path):
    out = tmp_path / "out.mp4"
    video(moving, out, duration=0.5, fps=10, size=SIZE)
    data = out.read_bytes()
    assert 0 < data.index(b"moov") < data.index(b"mdat")


def test_seeking_finds_a_key_frame_every_two_seconds(moving, tmp_path):
    av = pytest.importorskip("av")
    out = tmp_path / "out.mp4"
    video(moving, out, duration=5, fps=10, size=SIZE)
    with av.open(str(out)) as file:
        keys = [p.pts * p.time_base for p in file.demux(video=0) if p.size and p.is_keyframe]
    assert keys == [0, 2, 4]


def test_samples_and_views_are_of_scenes(tmp_path):
    out = tmp_path / "out.mp4"
    scene = distal.Scene(distal.Sphere(1.0))
    video(scene, out, duration=0.2, fps=10, size=(32, 24), samples=4, quality="lossless")
    soft = decode(out).frames[0]
    expected = scene.render((32, 24), samples=4).array[..., :3]
    expected = np.floor(np.clip(expected, 0.0, 1.0) * 255.0 + 0.5).astype(int)
    assert np.abs(soft - expected).max() <= 1
    plain = np.floor(np.clip(scene.render((32, 24)).array[..., :3], 0, 1) * 255.0 + 0.5)
    assert np.abs(soft - plain).max() > 8
    video(scene, out, duration=0.2, fps=10, size=(32, 24), view="normal", quality="lossless")
    normal = scene.render((32, 24), view="normal").array[..., :3]
    normal = np.floor(np.clip(normal, 0.0, 1.0) * 255.0 + 0.5).astype(int)
    assert np.abs(decode(out).frames[0] - normal).max() <= 1


def test_a_shape_alone_is_shown_on_its_stage(tmp_path):
    out = tmp_path / "out.mp4"
    made = distal.Sphere(1.0).video(out, duration=0.2, fps=10, size=(32, 24))
    assert made.frames == 2
    assert decode(out).frames[0].std() > 5.0


@pytest.mark.parametrize(
    ("wishes", "message"),
    [
        ({"size": (33, 24)}, "mp4 has even sides, 33x24 has not; the nearest is 34x24, or the"),
        ({"quality": "best"}, "a quality is low, medium, high, lossless or a number from 0 to 100"),
        ({"quality": 101}, "a quality is low, medium, high, lossless or a number from 0 to 100"),
        ({"quality": float("nan")}, "a quality is low, medium, high, lossless or a number"),
        ({"samples": 0}, "a pixel has 1 to 65536 samples, not 0"),
        ({"view": "depth"}, "view 'depth'"),
        ({"params": {"glew": 1.0}}, "there is no parameter 'glew'; parameters: glow"),
        ({"params": {"glow": 2.0}}, "glow"),
        ({"duration": 0}, "a duration is more than 0 seconds, not 0"),
    ],
)
def test_a_wish_without_sense_is_refused_before_anything_is_written(
    moving,
    tmp_path,
    wishes,
    message,
):
    given = {"duration": 1, "size": SIZE, **wishes}
    with pytest.raises(ValueError) as caught:
        video(moving, tmp_path / "out.mp4", **given)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value) or "view" in message
    assert [p.name for p in tmp_path.iterdir()] == ["moving.py"]


def test_a_loop_that_jumps_is_told(moving, tmp_path):
    told = []
    out = tmp_path / "out.gif"
    video(moving, out, duration=1, fps=5, size=SIZE, loop=True, tell=told.append)
    assert told == []  # the spot goes round once in a second
    video(moving, out, duration=1.5, fps=5, size=SIZE, loop=True, tell=told.append)
    assert told == ["the picture at 1.5 s is not that at 0 s: the loop will jump"]


def test_progress_counts_frames(moving, tmp_path):
    told = []
    video(
        moving,
        tmp_path / "out.mp4",
        duration=0.5,
        fps=10,
        size=SIZE,
        progress=lambda *words: told.append(words),
    )
    assert told == [(i + 1, 5, "rendering") for i in range(5)]
