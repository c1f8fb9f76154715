"""Numbered pictures: whole files, kept when they would come out alike."""

import numpy as np
import pytest
from PIL import Image

import distal
from distal import Camera, DistantLight, Scene, Sphere, Steering, time
from distal.file_writer import SaveError
from distal.video import video
from distal.video.formats import VideoError
from tests.video.moving import SCENE, scene_file, still

SIZE = (48, 32)


def stamps(folder):
    return {path.name: path.stat().st_mtime_ns for path in folder.iterdir()}


def test_every_frame_is_a_picture_of_its_time(moving, tmp_path):
    pattern = tmp_path / "deep" / "frames" / "shot-%03d.png"
    made = video(moving, pattern, duration=0.7, fps=10, start=0.5, size=SIZE)
    names = [f"shot-{i:03d}.png" for i in range(7)]
    assert sorted(path.name for path in pattern.parent.iterdir()) == names
    assert made.frames == made.rendered == 7
    for i, name in enumerate(names):
        with Image.open(pattern.parent / name) as picture:
            pixels = np.asarray(picture.convert("RGB"))
            assert float(picture.info["distal:time"]) == 0.5 + i / 10
            assert picture.info["srgb"] == 0
        assert (pixels == still(moving, SIZE, 0.5 + i / 10)).all()


def test_frames_that_are_there_are_kept(moving, tmp_path):
    pattern, told = tmp_path / "frames" / "%05d.png", []
    video(moving, pattern, duration=1, fps=10, size=SIZE)
    before = stamps(pattern.parent)
    (pattern.parent / "00003.png").unlink()
    (pattern.parent / "00005.png").write_bytes(b"\x89PNG\r\n\x1a\nhalf a picture")
    made = video(moving, pattern, duration=1.2, fps=10, size=SIZE, tell=told.append)
    assert made.rendered == 4  # two mended, two more than before
    assert told == ["continues: 8 of 12 frames are there"]
    after = stamps(pattern.parent)
    assert {n for n in before if after[n] == before[n]} == before.keys() - {
        "00003.png",
        "00005.png",
    }
    whole = tmp_path / "whole" / "%05d.png"
    video(moving, whole, duration=1.2, fps=10, size=SIZE)
    for name in after:
        assert (pattern.parent / name).read_bytes() == (whole.parent / name).read_bytes()


@pytest.mark.parametrize(
    "change",
    [
        {"params": {"glow": 0.9}},
        {"size": (32, 32)},
        {"start": 0.25},
        {"view": "coordinate"},
        {"fresh": True},
    ],
)
def test_other_frames_are_rendered_anew(moving, tmp_path, change):
    pattern = tmp_path / "frames" / "%05d.png"
    wishes = {"duration": 0.3, "fps": 10, "size": SIZE}
    video(moving, pattern, **wishes)
    assert video(moving, pattern, **wishes).rendered == 0
    assert video(moving, pattern, **{**wishes, **change}).rendered == 3


def test_a_changed_scene_is_rendered_anew_a_changed_comment_is_not(moving, tmp_path):
    pattern = tmp_path / "frames" / "%05d.png"
    wishes = {"duration": 0.3, "fps": 10, "size": SIZE}
    video(moving, pattern, **wishes)
    commented = distal.load(
        str(scene_file(tmp_path, SCENE.replace("    spot", "    # round\n    spot")))
    )
    assert video(commented, pattern, **wishes).rendered == 0
    changed = distal.load(str(scene_file(tmp_path, SCENE.replace("0.3, length", "0.4, length"))))
    assert video(changed, pattern, **wishes).rendered == 3


def test_a_scene_of_objects_whose_number_changed_is_rendered_anew(tmp_path):
    pattern = tmp_path / "frames" / "%05d.png"
    wishes = {"duration": 0.2, "fps": 10, "size": (16, 12)}
    video(distal.Scene(distal.Sphere(1.0)), pattern, **wishes)
    assert video(distal.Scene(distal.Sphere(1.0)), pattern, **wishes).rendered == 0
    assert video(distal.Scene(distal.Sphere(1.1)), pattern, **wishes).rendered == 2


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("a.png", "every frame needs its number in the name: {folder}/a-%05d.png"),
        ("%05d-%05d.png", "a name has one number, like %05d.png"),
        ("%s.png", "a name has one number, like %05d.png"),
        ("a.avi", "it has the suffix '.avi'; videos end in .mp4, .webm, .gif, .apng, .webp, or "
         "pictures named like frames/%05d.png"),
        ("a", "it has no suffix; videos end in .mp4, .webm, .gif, .apng, .webp, or pictures named "
         "like frames/%05d.png"),
    ],
)  # fmt: skip
def test_names_that_cannot_be(moving, tmp_path, name, message):
    with pytest.raises(SaveError) as caught:
        video(moving, tmp_path / name, duration=1, size=SIZE)
    path = tmp_path / name
    assert str(caught.value) == f"cannot write {path}: {message.format(folder=tmp_path)}"


def test_a_folder_that_cannot_be_made(moving, tmp_path):
    (tmp_path / "frames").write_bytes(b"a file")
    with pytest.raises(SaveError, match=r"cannot make the folder .*frames: File exists"):
        video(moving, tmp_path / "frames" / "%05d.png", duration=1, size=SIZE)


def test_a_video_can_leave_its_frames_behind(moving, tmp_path):
    pytest.importorskip("av")
    folder = tmp_path / "kept"
    for name in ("out.mp4", "out.gif"):
        made = video(moving, tmp_path / name, duration=0.5, fps=10, size=SIZE, keep_frames=folder)
        assert sorted(p.name for p in folder.iterdir()) == [f"{i:05d}.png" for i in range(5)]
        # A gif is made of the frames; mp4 encodes what was rendered.
        assert made.rendered == (5 if name == "out.mp4" else 0)
    with Image.open(folder / "00003.png") as picture:
        assert (np.asarray(picture.convert("RGB")) == still(moving, SIZE, 0.3)).all()
    with pytest.raises(VideoError, match="keep_frames is for videos"):
        video(moving, folder / "%05d.png", duration=1, keep_frames=folder, size=SIZE)


def test_frames_of_a_moved_camera_are_pictures_of_it(moving, tmp_path):
    moved = Steering(yaw=0.5, zoom=0.8)
    scene = Scene(Sphere(0.5 + time), camera=Camera((1.0, 1.0, 4.0)), lights=DistantLight())
    pattern = tmp_path / "%02d.png"
    video(scene, pattern, duration=0.2, fps=10, size=SIZE, steering=moved)
    scene.render(size=SIZE, time=0.1, steering=moved).save(tmp_path / "still.png")
    with Image.open(tmp_path / "01.png") as frame, Image.open(tmp_path / "still.png") as picture:
        off = np.asarray(frame.convert("RGB")).astype(int) - np.asarray(picture.convert("RGB"))
        assert abs(off).max() <= 1  # encoded in the program, or after it
        assert frame.info["distal:steering"] == picture.info["distal:steering"]
    video(scene, pattern, duration=0.2, fps=10, size=SIZE, tell=(told := []).append)
    assert told == []  # frames of another camera are not kept
    with pytest.raises(VideoError, match="is an @image: it has no camera to move"):
        video(moving, tmp_path / "a-%d.png", duration=0.2, fps=10, size=SIZE, steering=moved)
