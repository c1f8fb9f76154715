"""What a shape and a scene say of themselves in a notebook or a debugger."""

from __future__ import annotations

import re

import pytest

from distal import (
    Box,
    Camera,
    Circle,
    Material,
    PointLight,
    Scene,
    Sky,
    Sphere,
    checker,
    glass,
    time,
    union,
)
from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    buffer,
    choice,
    integer,
    keyboard,
    microphone,
    slider,
    toggle,
    vec4,
)


def test_numbers_children_and_place():
    assert re.fullmatch(r"<Sphere\(radius=2\), test_described\.py:\d+>", repr(Sphere(2.0)))
    named = Sphere(2.0).named("ball")
    assert repr(named).startswith("<Sphere(radius=2) 'ball', ")
    joined = (Sphere(1.0) | Box(1.0, 2.0, slider("w", 1.0, 0.0, 3.0))).translate(1, 2.5, 3)
    assert repr(joined).startswith(
        "<Shape translate(offset=(1, 2.5, 3)) of union of Sphere(radius=1), Box(size=w), "
    )
    assert repr(Circle(1.0 + time)).startswith("<Circle(radius=time), ")


def test_a_large_shape_stays_one_line():
    many = union([Sphere(0.1).translate(i, 0, 0) for i in range(100)])
    assert repr(many).startswith("<Shape union of 100 shapes, ")
    deep = Sphere(1.0)
    for _ in range(50):
        deep = deep.translate(1, 0, 0) - Box(0.1)
    assert len(repr(deep)) < 400


def test_a_scene():
    scene = Scene(Sphere(1.0) | Box(1.0), lights=[PointLight((1, 2, 3))], floor=False, name="two")
    assert re.fullmatch(
        r"<Scene 'two': 2 parts, 1 light, FramingCamera, test_described\.py:\d+>", repr(scene)
    )


def test_a_shape_alone_is_rendered():
    picture = Sphere(1.0).render((24, 18))
    assert (picture.width, picture.height) == (24, 18)
    array = picture.array[..., :3]
    assert abs(array[9, 12] - array[0, 0]).max() > 0.05
    assert Circle(1.0).render((8, 8), view="distance").width == 8


HERE = r", test_described\.py:\d+>"


@pytest.mark.parametrize(
    ("made", "text"),
    [
        (PointLight((1, 2, 3), intensity=2), r"<light PointLight\(position=\(1, 2, 3\), .*" + HERE),
        (Sky(), r"<light Sky\(.*\)" + HERE),
        (Camera((0, 1, 4)), r"<camera Camera\(position=\(0, 1, 4\), .*" + HERE),
        (Material("red", diffuse=0.5), r"<material Material\(color=\(1, 0, 0\), .*" + HERE),
        (glass(ior=1.4), r"<material glass\(ior=1\.4, .*" + HERE),
        (checker("red", "blue"), r"<pattern checker\(a=\(1, 0, 0\), b=\(0, 0, 1\)\)" + HERE),
    ],
    ids=lambda value: value[:12] if isinstance(value, str) else "",
)
def test_lights_cameras_and_materials_say_their_numbers(made, text):
    assert re.fullmatch(text, repr(made)), repr(made)


@buffer
def trail(frame: Frame) -> vec4:
    return vec4(0.5)


def test_parameters_and_textures_say_what_they_are():
    shown = {
        slider("Size", 0.7, 0.1, 2.0): "<slider 'Size': 0.7, 0.1 to 2.0>",
        integer("Count", 3, 1, 8): "<integer 'Count': 3, 1 to 8>",
        toggle("Lid", True): "<toggle 'Lid': True>",
        choice("Kind", ["a", "b"]): "<choice 'Kind': 'a' of a, b>",
        Texture2D("folder/photo.png"): "<Texture2D of 'photo.png', wrap='repeat'>",
        Texture2D([[1.0], [0.0]], "clamp"): "<Texture2D of 2 rows, wrap='clamp'>",
        Buffer([1.0, 2.0]): "<Buffer of 2 float>",
        keyboard: "<keyboard>",
        microphone: "<microphone>",
        trail.last_frame: "<earlier frames of 'trail'>",
    }
    for made, text in shown.items():
        assert repr(made) == text
