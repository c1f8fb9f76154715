"""Work that is broken off: killed, interrupted, out of space; and continued."""

import os
import resource
import signal
import subprocess
import sys
import time

import pytest

import distal
from distal.file_writer import SaveError
from distal.video import encoding, video
from distal.video.moving_picture import MovingPicture
from tests.video.moving import decode, scene_file

pytest.importorskip("av", reason="PyAV writes videos: pip install 'distal[video]'")

SIZE = (96, 64)
WISHES = {"duration": 9, "fps": 20, "size": SIZE}
# Stops for good when frame 130 has been handed on: three pieces of 40 are whole by then.
STOPPING = """
import sys, time
import distal
from distal.video import video

def progress(done, total, what):
    if done == 130:
        time.sleep(120)

video(distal.load(sys.argv[1]), sys.argv[2], duration=9, fps=20, size=(96, 64), progress=progress)
"""


PICTURES = MovingPicture.pictures


def break_frame(monkeypatch, broken, pause=0.0):
    """Let a frame fail as if its scene did, after a pause in seconds."""

    def pictures(self, moments, size=None):
        if broken in [index for index, _ in moments]:
            time.sleep(pause)
            raise distal.LoadError("the author's message")
        return PICTURES(self, moments, size)

    monkeypatch.setattr(MovingPicture, "pictures", pictures)


def wait_for(seen, process):
    end = time.monotonic() + 60.0
    while not seen():
        assert process.poll() is None, process.communicate()
        assert time.monotonic() < end, "nothing came"
        time.sleep(0.01)


@pytest.mark.parametrize("suffix", ["mp4", "webm"])
def test_killed_and_started_again_it_goes_on_from_whole_pieces(tmp_path, suffix):
    scene, out = scene_file(tmp_path), tmp_path / f"out.{suffix}"
    folder = tmp_path / f".out.{suffix}.distal"
    process = subprocess.Popen([sys.executable, "-c", STOPPING, str(scene), str(out)])
    try:
        wait_for(lambda: (folder / "000080-000119.mp4").exists(), process)
        time.sleep(0.2)
    finally:
        process.kill()
        process.wait()
    assert not out.exists()
    pieces = sorted(folder.glob("0*-0*[0-9].mp4"))
    assert [path.name for path in pieces] == [
        "000000-000039.mp4",
        "000040-000079.mp4",
        "000080-000119.mp4",
    ]
    before = {path: (path.stat().st_mtime_ns, path.stat().st_ino) for path in pieces}
    seen, told = {}, []

    def progress(done, total, what):
        if done == 121:  # the first frame of this run: the pieces of the first are as they were
            seen.update({p: (p.stat().st_mtime_ns, p.stat().st_ino) for p in pieces})

    picture = distal.load(str(scene))
    made = video(picture, out, **WISHES, progress=progress, tell=told.append)
    assert told == ["continues: 120 of 180 frames are there"]
    assert made.rendered == 60
    assert seen == before
    assert not folder.exists()
    whole = tmp_path / f"whole.{suffix}"
    video(picture, whole, **WISHES)
    continued, uninterrupted = decode(out), decode(whole)
    assert len(continued.frames) == 180
    assert continued.times == uninterrupted.times
    assert all((a == b).all() for a, b in zip(continued.frames, uninterrupted.frames, strict=True))


def test_ctrl_c_leaves_the_pieces_and_says_how_to_go_on(tmp_path):
    out = tmp_path / "out.mp4"
    folder = tmp_path / ".out.mp4.distal"
    words = ["video", "example:raymarcher", "-o", str(out), "--duration", "400", "--fps", "5"]
    process = subprocess.Popen(
        [sys.executable, "-m", "distal.cli", *words, "--size", "320x240"],
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        wait_for(lambda: (folder / "000000-000009.mp4").exists(), process)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=20)
    finally:
        process.kill()
    assert process.returncode == 130
    assert not out.exists()
    assert not list(folder.glob("*.partial*"))
    kept = sum(10 for _ in folder.glob("0*.mp4"))
    assert errors.splitlines() == [
        f"{kept} of 2000 frames are kept in {folder}; continue with the same command"
    ]


def test_a_failure_before_anything_is_whole_leaves_nothing(moving, tmp_path):
    class StoppedError(Exception):
        pass

    def progress(done, total, what):
        if done == 3:
            raise StoppedError

    with pytest.raises(StoppedError):
        video(moving, tmp_path / "out.mp4", **WISHES, progress=progress)
    assert [path.name for path in tmp_path.iterdir()] == ["moving.py"]


def test_a_scene_that_fails_in_the_middle_keeps_the_pieces(moving, tmp_path, monkeypatch):
    told = []
    break_frame(monkeypatch, 50)
    out = tmp_path / "out.mp4"
    with pytest.raises(distal.LoadError, match="the author's message"):
        video(moving, out, **WISHES, tell=told.append)
    folder = tmp_path / ".out.mp4.distal"
    assert told == [f"40 of 180 frames are kept in {folder}; continue with the same command"]
    assert (folder / "000000-000039.mp4").exists()
    monkeypatch.undo()
    assert video(moving, out, **WISHES).rendered == 140


@pytest.mark.parametrize("quality", ["high", "lossless"])
def test_frames_of_a_slow_segment_are_kept(moving, tmp_path, monkeypatch, quality):
    monkeypatch.setattr(encoding, "KEEP_AFTER_S", 0.0)
    wishes = {**WISHES, "quality": quality}
    told = []
    break_frame(monkeypatch, 70, pause=0.3)  # the frames before it are written
    out = tmp_path / "out.mp4"
    with pytest.raises(distal.LoadError, match="the author's message"):
        video(moving, out, **wishes, tell=told.append)
    folder = tmp_path / ".out.mp4.distal"
    singles = sorted(path.name for path in folder.glob("*.png"))
    assert len(singles) >= 25
    assert singles == [f"frame-{i:05d}.png" for i in range(40, 40 + len(singles))]
    kept = 40 + len(singles)
    assert told == [f"{kept} of 180 frames are kept in {folder}; continue with the same command"]

    monkeypatch.setattr(MovingPicture, "pictures", PICTURES)
    (folder / singles[3]).write_bytes(b"")  # a damaged one is rendered again
    told.clear()
    assert video(moving, out, **wishes, tell=told.append).rendered == 181 - kept
    assert told == [f"continues: {kept - 1} of 180 frames are there"]
    assert not folder.exists()
    uninterrupted = tmp_path / "whole.mp4"
    video(moving, uninterrupted, **wishes)
    continued = decode(out).frames
    expected = decode(uninterrupted).frames
    assert len(continued) == 180
    assert all((a == b).all() for a, b in zip(continued, expected, strict=True))


def test_frames_of_a_quick_segment_are_not_written(moving, tmp_path):
    seen = set()
    folder = tmp_path / ".out.mp4.distal"
    video(
        moving,
        tmp_path / "out.mp4",
        **WISHES,
        progress=lambda *_: seen.update(path.suffix for path in folder.iterdir()),
    )
    assert ".png" not in seen


@pytest.mark.parametrize("suffix", ["mp4", "webm", "gif", "apng", "webp"])
def test_a_full_disk_is_one_line(moving, tmp_path, suffix):
    out = tmp_path / f"out.{suffix}"
    wishes = {"duration": 1, "fps": 20, "size": (160, 120)}
    size = video(moving, out, **wishes).bytes
    out.unlink()
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    # The kernel refuses what goes beyond, as a full disk does; frames of a gif still fit.
    resource.setrlimit(resource.RLIMIT_FSIZE, (size // 2, old[1]))
    try:
        with pytest.raises(SaveError) as caught:
            video(moving, out, **wishes)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert "File too large" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not out.exists()
    # Half a file would fill a full disk for good.
    assert not [*(tmp_path / f".{out.name}.distal").glob("*.partial*")]
    assert video(moving, out, **wishes).bytes == size


@pytest.mark.parametrize("damage", ["", "half"])
def test_a_damaged_piece_is_made_again(moving, tmp_path, monkeypatch, damage):
    out = tmp_path / "out.mp4"
    break_frame(monkeypatch, 130)
    with pytest.raises(distal.LoadError, match="the author's message"):
        video(moving, out, **WISHES)
    monkeypatch.undo()
    piece = tmp_path / ".out.mp4.distal" / "000040-000079.mp4"
    content = piece.read_bytes()
    piece.write_bytes(content[: len(content) // 2] if damage else b"")
    with pytest.raises(SaveError) as caught:
        video(moving, out, **WISHES)
    words = "was damaged: 0 frames, not 40; the same command makes it again"
    assert str(caught.value) == f"{piece} {words}"
    assert video(moving, out, **WISHES).rendered == 40
    assert len(decode(out).frames) == 180


@pytest.mark.parametrize("suffix", ["mp4", "webm", "gif", "apng", "webp"])
def test_one_video_is_one_file(moving, tmp_path, suffix):
    one, other = tmp_path / f"one.{suffix}", tmp_path / f"other.{suffix}"
    for path in (one, other):
        video(moving, path, duration=1, fps=10, size=(96, 64))
    assert one.read_bytes() == other.read_bytes()


def test_a_folder_that_is_not_writable(moving, tmp_path):
    if os.geteuid() == 0:
        pytest.skip("root writes everywhere")
    closed = tmp_path / "closed"
    closed.mkdir(mode=0o500)
    with pytest.raises(SaveError, match=r"the folder .*closed is not writable"):
        video(moving, closed / "out.mp4", **WISHES)


def test_an_unknown_folder(moving, tmp_path):
    with pytest.raises(SaveError, match="there is no folder"):
        video(moving, tmp_path / "nowhere" / "out.mp4", **WISHES)


def test_memory_stays_flat(tmp_path):
    pages = "/proc/self/statm"
    if not os.path.exists(pages):
        pytest.skip("no /proc here")
    code = """
import os, sys
import distal
from distal.video import video

sizes = []

def progress(done, total, what):
    if done in (150, 600):
        with open("/proc/self/statm") as file:
            sizes.append(int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6)

video(
    distal.load(sys.argv[1]), sys.argv[2], duration=10, fps=60, size=(320, 240), progress=progress
)
print(sizes[1] - sizes[0])
"""
    words = [sys.executable, "-c", code, str(scene_file(tmp_path)), str(tmp_path / "out.mp4")]
    grown = float(subprocess.run(words, capture_output=True, text=True, check=True).stdout)
    # 450 frames would be 138 MB as pixels; what fluctuates is encoders and what waits.
    assert grown < 12.0
