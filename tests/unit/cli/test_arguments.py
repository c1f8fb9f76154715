"""The words of the command line: what they mean, and how nonsense is refused."""

import pytest

from distal.cli.arguments import (
    UsageError,
    read_assignments,
    read_pixel,
    read_plane,
    read_scene,
    read_size,
    read_steering,
    read_time,
)
from distal.lang.parameters import choice, color, slider

PARAMETERS = [slider("Blend softness", 0.3), choice("Mode", ["flat", "lit"]), color("Sky")]


@pytest.mark.parametrize(
    ("text", "path", "name"),
    [
        ("scene.py", "scene.py", None),
        ("a/scene.py:picture", "a/scene.py", "picture"),
        ("C:\\scene.py", "C:\\scene.py", None),
        ("C:\\scene.py:picture", "C:\\scene.py", "picture"),
        ("example:melting", "example:melting", None),
        ("example:melting:picture", "example:melting", "picture"),
    ],
)
def test_scene_is_taken_apart(text, path, name):
    assert read_scene(text) == (path, name)


def test_colon_of_an_existing_file_belongs_to_its_name(tmp_path):
    odd = tmp_path / "odd:name"
    odd.touch()
    assert read_scene(str(odd)) == (str(odd), None)


@pytest.mark.parametrize("text", ["", "example:", ":name"])
def test_no_file_is_refused(text):
    with pytest.raises(UsageError, match="names no"):
        read_scene(text)


@pytest.mark.parametrize(
    ("text", "size"), [("640x480", (640, 480)), ("1X1", (1, 1)), (" 17x16384 ", (17, 16384))]
)
def test_size(text, size):
    assert read_size(text, 16384) == size


@pytest.mark.parametrize(
    "text",
    (
        *("", "640", "640x", "x480", "640x480x3", "-1x5", "6.5x2"),
        *("0x0", "0x5", "16385x1", "9" * 5000, "٣x٣"),
    ),
)
def test_bad_size_is_one_short_message(text):
    with pytest.raises(UsageError) as caught:
        read_size(text, 16384)
    assert len(str(caught.value)) < 120


def test_time():
    assert read_time("-1.5e1") == -15.0
    assert read_time("1048576") == 2.0**20
    for text in ("", "soon", "nan", "inf", "1048577", "-1e6000", "-2e6"):
        with pytest.raises(UsageError, match="a time is"):
            read_time(text)


def test_assignments_are_read_by_kind():
    texts = ["blend_softness=0.5", " mode = lit", "sky=#000"]
    assert read_assignments(texts, PARAMETERS) == {
        "blend_softness": 0.5,
        "mode": 1,
        "sky": (0.0, 0.0, 0.0),
    }


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("blend_softness", "--set takes name=value"),
        ("=3", "--set takes name=value"),
        ("blend_softnes=1", "did you mean 'blend_softness'?"),
        ("blend_softness=9", "--set blend_softness: 'Blend softness' lies between 0 and 1, not 9"),
        ("mode=dark", "'Mode' takes one of flat, lit, not 'dark'"),
    ],
)
def test_bad_assignment_lists_the_parameters(text, words):
    with pytest.raises(UsageError) as caught:
        read_assignments([text], PARAMETERS)
    assert words in str(caught.value)
    assert "  blend_softness  a number from 0 to 1 (default 0.3)" in str(caught.value)


def test_setting_twice_and_setting_nothing():
    with pytest.raises(UsageError, match="twice"):
        read_assignments(["mode=lit", "mode=flat"], PARAMETERS)
    with pytest.raises(UsageError, match="this scene has no parameters"):
        read_assignments(["mode=lit"], [])


def test_a_steering_is_names_and_numbers():
    found = read_steering("yaw=0.3, zoom=0.8,pan_y=-1")
    assert found.numbers == (0.3, 0.0, 0.8, 0.0, -1.0)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("0.3", "--steering takes names and numbers, like yaw=0.3,zoom=0.8, not '0.3'"),
        ("yaw=x", "--steering takes names and numbers"),
        ("yaw=nan", "--steering takes names and numbers"),
        ("yaw=1,yaw=2", "--steering takes names and numbers"),
        (
            "yow=1",
            "--steering: a camera is moved by yaw, pitch, zoom, pan_x, pan_y, not by 'yow'",
        ),
        ("zoom=0", "--steering: zoom is a factor above 0, not 0"),
    ],
)
def test_a_bad_steering_is_named(text, reason):
    with pytest.raises(UsageError) as caught:
        read_steering(text)
    assert str(caught.value).startswith(reason)


def test_a_slice_is_an_axis_and_an_offset():
    assert read_plane("y=0.5") == ((0.0, 1.0, 0.0), 0.5)
    assert read_plane(" z = -2") == ((0.0, 0.0, 1.0), -2.0)
    for text in ("", "y", "w=1", "y=", "y=nan", "y=inf", "y=1e300", "=1"):
        with pytest.raises(UsageError, match="a slice is AXIS=OFFSET"):
            read_plane(text)


def test_a_pixel_is_within_the_picture():
    assert read_pixel("0,3", (4, 4)) == (0, 3)
    assert read_pixel(" 3 , 0 ", (4, 4)) == (3, 0)
    for text in ("", "1", "1,", "-1,0", "1.5,0", "1,2,3"):
        with pytest.raises(UsageError, match="a pixel is X,Y"):
            read_pixel(text, (4, 4))
    with pytest.raises(UsageError, match="a picture of 4x5 ends at 3,4"):
        read_pixel("0,5", (4, 5))
