"""What objects say of themselves in a notebook or a debugger: how they are made."""

from __future__ import annotations

import math
import re

import numpy as np

from distal import (
    Bolt,
    Box,
    Camera,
    Circle,
    Material,
    PointLight,
    Scene,
    Shape,
    Sky,
    Sphere,
    cell,
    checker,
    copies,
    glass,
    matte,
    night,
    time,
    union,
)
from distal.lang import (
    Buffer,
    Frame,
    Texture2D,
    buffer,
    choice,
    func,
    integer,
    keyboard,
    length,
    microphone,
    slider,
    toggle,
    vec3,
    vec4,
)


def test_shapes_say_how_they_are_made():
    for shape, text in {
        Sphere(2): "Sphere(radius=2.0)",
        Sphere(2.0).named("ball"): "Sphere(radius=2.0).named('ball')",
        Box(1, math.inf, 1) - Sphere(): 'Box(size=(1.0, float("inf"), 1.0)) - Sphere(radius=1.0)',
        (Sphere() | Circle().extrude(2)).translate(1, 2.5, 3): (
            "(Sphere(radius=1.0) | Circle(radius=1.0).apply('extrude', height=2.0))"
            ".translate((1.0, 2.5, 3.0))"
        ),
        Sphere().union(Sphere(2), smooth=0.1).paint("red"): (
            "Sphere(radius=1.0).apply('union quadratic', others=[Sphere(radius=2.0)], smooth=0.1)"
            ".paint(matte(color=(1.0, 0.0, 0.0)))"
        ),
        Sphere(slider("Size", 1.0, 0.5, 2.0)): "Sphere(radius=slider('Size', 1.0, 0.5, 2.0))",
        Circle(1.0 + time): "Circle(radius=1.0 + time)",
        Bolt("M6", 25.0): "Bolt(size='M6', length=25.0)",
    }.items():
        assert repr(shape) == text


def test_what_has_no_text_says_what_it_is():
    assert repr(Circle(1.0 + 0.1 * cell.x)).startswith("Circle(radius=<expression float: ")
    assert repr(Shape.from_function(ball, r=2.0)) == (
        "Shape.from_function(function=<func ball>, r=2.0)"
    )
    rows = np.zeros((4, 3))
    rows[:, 0] = range(4)
    assert repr(copies(Sphere(), rows)).endswith("positions=<array (4, 3)>)")
    assert repr(Scene(Sphere()).camera) == "<camera of the scene>"


def test_large_objects_have_short_texts():
    many = union([Sphere(0.1).translate(i, 0, 0) for i in range(10_000)])
    assert " | <9,988 more> | " in repr(many) and len(repr(many)) < 800
    deep = Sphere(1.0)
    for _ in range(50):
        deep = deep.translate(1, 0, 0).rotate(y=0.1)
    assert re.search(r"<\d+ operators>", repr(deep)) and len(repr(deep)) < 800
    wide = Sphere(1.0)
    for _ in range(12):
        wide = (wide - wide.translate(1, 0, 0)).round(0.1)
    assert " of 2 shapes>" in repr(wide) and len(repr(wide)) < 3000
    assert len(repr(Scene(many))) < 900


def test_scenes_lights_and_materials():
    for made, text in {
        Scene(Sphere(), exposure=2.0, floor=False): (
            "Scene(shape=Sphere(radius=1.0), floor=False, exposure=2.0)"
        ),
        PointLight((1, 2, 3), intensity=2): "PointLight(position=(1.0, 2.0, 3.0), intensity=2.0)",
        Sky(): "Sky()",
        Camera((0, 1, 4)): "Camera(position=(0.0, 1.0, 4.0))",
        Material("red", diffuse=0.5): "Material(color=(1.0, 0.0, 0.0), diffuse=0.5)",
        glass(1.4).replace(priority=2): "glass(ior=1.4).replace(priority=2)",
        matte("red").mix("blue", 0.25): (
            "matte(color=(1.0, 0.0, 0.0)).mix(matte(color=(0.0, 0.0, 1.0)), 0.25)"
        ),
        checker("red", "blue"): "checker(a=(1.0, 0.0, 0.0), b=(0.0, 0.0, 1.0))",
        night(exposure=2): "night(exposure=2.0)",
    }.items():
        assert repr(made) == text


@func
def ball(p: vec3, r: float) -> float:
    return length(p) - r


def test_a_shape_alone_is_rendered():
    picture = Sphere(1.0).render((24, 18))
    assert (picture.width, picture.height) == (24, 18)
    array = picture.array[..., :3]
    assert abs(array[9, 12] - array[0, 0]).max() > 0.05
    assert Circle(1.0).render((8, 8), view="distance").width == 8


@buffer
def trail(frame: Frame) -> vec4:
    return vec4(0.5)


def test_parameters_and_textures_say_what_they_are():
    shown = {
        slider("Size", 0.7, 0.1, 2.0): "slider('Size', 0.7, 0.1, 2.0)",
        integer("Count", 3, 1, 8): "integer('Count', 3, 1, 8)",
        toggle("Lid", True): "toggle('Lid', True)",
        choice("Kind", ["a", "b"]): "choice('Kind', ['a', 'b'], 'a')",
        slider("Größe", 1, 0, 3, 0.5, help="How large", name="large"): (
            "slider('Größe', 1.0, 0.0, 3.0, 0.5, help='How large', name='large')"
        ),
        Texture2D("folder/photo.png"): "<Texture2D of 'photo.png', wrap='repeat'>",
        Texture2D([[1.0], [0.0]], "clamp"): "<Texture2D of 2 rows, wrap='clamp'>",
        Buffer([1.0, 2.0]): "<Buffer of 2 float>",
        keyboard: "<keyboard>",
        microphone: "<microphone>",
        trail.last_frame: "<earlier frames of 'trail'>",
    }
    for made, text in shown.items():
        assert repr(made) == text
