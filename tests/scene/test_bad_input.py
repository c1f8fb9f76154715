"""What authors get wrong: each mistake is told at their own line, in these very words."""

from __future__ import annotations

import math
import time as clock
import warnings

import numpy as np
import pytest

from distal import (
    AmbientLight,
    Box,
    Camera,
    Circle,
    DistantLight,
    GradientBackground,
    HemisphereLight,
    Plane,
    PointLight,
    Scene,
    Shape,
    Sphere,
    Torus,
    choose,
    emissive,
    glass,
    matte,
)
from distal.diagnostics import CompileError
from distal.fields.repeat import polar
from distal.lang import (
    Frame,
    choice,
    func,
    image,
    integer,
    length,
    max,
    select,
    slider,
    toggle,
    vec3,
    vec4,
)

# The same light, whatever is in the scene.
PLAIN_LIGHT = {
    "lights": [DistantLight((0.6, 1.0, 0.7), 0.8, angle=0.05), HemisphereLight()],
    "background": GradientBackground(),
    "ambient_occlusion": 0.4,
    "tone_map": "none",
}
LOW = slider("Low", 0.5, -1.0, 1.0)
HALF = slider("Half", 0.5, 0.1, 1.0)
MANY = integer("Many", 3, 1, 100)
SWITCH = toggle("Switch")
FORM = choice("Form", ["ball", "cube"])
BESIDE = Sphere(0.5).translate(2, 0, 0)


@func
def ball(p: vec3) -> float:
    return length(p) - 1.0


@func
def steep(p: vec3) -> float:
    return 5.0 * (length(p) - 1.0)


@func
def nowhere(p: vec3) -> float:
    return (length(p) - 1.0) / (p.x - p.x)


@func
def rooted(p: vec3) -> float:
    inside = max(p.x, 0.0)
    return p.x * (inside / inside) - 0.5


@func
def pointless(x: float) -> float:
    return x


def grown(count):
    shape = Sphere(0.5)
    for _ in range(count):
        shape = shape | shape.translate(1, 0, 0)
    return shape


ERRORS = {
    # Numbers
    "negative radius": (
        lambda: Sphere(-1),
        "'radius of Sphere' must be above 0, not -1",
        None,
    ),
    "nan": (
        lambda: Sphere(math.nan),
        "'radius of Sphere' takes a finite 32-bit number, not nan",
        None,
    ),
    "infinite": (
        lambda: Box(math.inf),
        "'size of Box' is infinite along all axes, and nothing ends there",
        "leave one side finite",
    ),
    "nan place": (
        lambda: Sphere().translate(math.nan, 0, 0),
        "'offset of translate' takes a finite 32-bit number, not nan",
        None,
    ),
    "none": (lambda: Sphere(None), "'radius of Sphere' takes a number, not None", None),
    "text": (lambda: Sphere("1"), "'radius of Sphere' takes a number, not str '1'", None),
    "truth": (lambda: Sphere(True), "'radius of Sphere' takes a number, not bool True", None),
    "slider below 0": (
        lambda: Sphere(LOW),
        "'radius of Sphere' must be above 0; the slider 'Low' goes down to -1",
        "give it low=0.01",
    ),
    "unknown keyword": (
        lambda: Sphere(radios=1),
        "Sphere has no 'radios'",
        "did you mean 'radius'?",
    ),
    "given twice": (
        lambda: Sphere(1, radius=2),
        "Sphere got 'radius' twice, by its name and by its position",
        "give what follows it by name too",
    ),
    # Operators
    "zero scale": (lambda: Sphere().scale(0), "'factor of scale' must be above 0, not 0", None),
    "flat scale": (
        lambda: Sphere().scale(1, 0, 1),
        "'factors of scale axes' must be above 0, not (1, 0, 1)",
        None,
    ),
    "long axis": (
        lambda: Sphere().rotate(0.5, axis=(1, 1, 0)),
        "'axis of rotate' must be a vector of length 1, not (1, 1, 0)",
        "write (0.707107, 0.707107, 0)",
    ),
    "no rotation": (
        lambda: Sphere().rotate(matrix=[[1, 1, 0], [0, 1, 0], [0, 0, 1]]),
        "rotate matrix: the columns of a rotation must have length 1 and stand at right angles",
        None,
    ),
    "no copies": (
        lambda: Sphere().repeat_polar(0),
        "repeat polar: count must be 1 or more",
        None,
    ),
    "half a copy": (
        lambda: Sphere().repeat_polar(2.5),
        "'count of repeat polar' takes a whole number, not float 2.5",
        None,
    ),
    "moving count": (
        lambda: Sphere().repeat_polar(HALF),
        "'count of repeat polar' takes a whole number; the slider 'Half' is a float",
        "make it with integer(…)",
    ),
    "count that may be 0": (
        lambda: BESIDE.repeat_polar(integer("Count", 3)),
        "repeat polar: count must be 1 or more; 'count' goes down to 0",
        "give the parameter another low, or use clamp",
    ),
    "count without limits": (
        lambda: BESIDE.repeat_polar(MANY // (MANY - 5)),
        "'count of repeat polar' needs a largest value, and this expression has none that is known",
        "limit it: clamp(n, 1, 12) of distal.lang",
    ),
    "count too large to fit": (
        lambda: BESIDE.repeat_polar(MANY),
        "repeat polar gives this shape no bound on its slope where 'count' is 100",
        f"repeat polar needs {polar.POLAR_FITTING}; its box goes from (1.5, -0.5, -0.5) to "
        "(2.5, 0.5, 0.5)",
    ),
    "count by a toggle": (
        lambda: BESIDE.repeat_polar(SWITCH),
        "'count of repeat polar' takes a whole number; the toggle 'Switch' is a bool",
        "make it with integer(…)",
    ),
    "neighbors of a parameter": (
        lambda: BESIDE.repeat(9.0, neighbors=MANY),
        "'neighbors of repeat' is fixed when the scene is compiled; the integer 'Many' is not",
        "give a plain whole number",
    ),
    # Alternatives
    "select by a number": (
        lambda: select(HALF, Sphere(), BESIDE),
        "'condition of select' takes a condition; the slider 'Half' is a float",
        "make it with toggle(…), or compare: x > 0.5",
    ),
    "select of a number": (
        lambda: select(SWITCH, Sphere(), 2.0),
        "select takes shapes, not 2.0",
        "None shows nothing",
    ),
    "select of flat and solid": (
        lambda: select(SWITCH, Sphere(), Circle()),
        "select takes flat shapes or solids, not both",
        "make the flat one solid: .extrude(height) or .revolve()",
    ),
    "shown by a number": (
        lambda: Sphere().shown(0.5),
        "'condition of select' takes True or False, not float 0.5",
        None,
    ),
    "choose by a toggle": (
        lambda: choose(SWITCH, [Sphere(), BESIDE]),
        "'which of choose' takes a choice or a whole number, not a bool",
        "select(condition, a, b)",
    ),
    "choose of too few": (
        lambda: choose(FORM, [Sphere()]),
        "choose has 1 shapes, 0 to 0; 'which' goes from 0 to 1",
        "give as many shapes as there are values",
    ),
    "choose without an option": (
        lambda: choose(FORM, {"ball": Sphere()}),
        "choose has no shape for the option 'cube' of 'Form'",
        "'cube': None shows nothing",
    ),
    "choose with a wrong option": (
        lambda: choose(FORM, {"ball": Sphere(), "cubes": Sphere()}),
        "the choice 'Form' has no option 'cubes'",
        "did you mean 'cube'?",
    ),
    "choose by names of a number": (
        lambda: choose(MANY, {"ball": Sphere()}),
        "shapes by name need a choice, whose options are the names",
        "choose(number, [a, b, c]) for a whole number",
    ),
    "choose of no list": (
        lambda: choose(FORM, 3),
        "choose takes a list of shapes, or shapes by name, not 3",
        "choose(form, [a, b]) or choose(form, {'ball': a, 'cube': b})",
    ),
    "choose of nothing at all": (
        lambda: choose(FORM, [None, None]),
        "choose needs a shape: all of these are None",
        None,
    ),
    "choose beyond the list": (
        lambda: choose(2, [Sphere(), BESIDE]),
        "there is no shape 2: choose has shapes 0 to 1",
        None,
    ),
    "axis of no name": (
        lambda: Sphere().symmetry("w"),
        "symmetry takes letters of 'xyz', not 'w'",
        None,
    ),
    # Combinations
    "union with a number": (
        lambda: Sphere().union(3),
        "a union joins shapes, not 3",
        None,
    ),
    "flat and solid": (
        lambda: Circle() | Sphere(),
        "a union joins a flat shape and a solid one",
        "make the flat one solid: .extrude(height) or .revolve()",
    ),
    "negative smoothness": (
        lambda: Sphere().union(Box(), smooth=-0.1),
        "'smooth of union' must be 0 or more, not -0.1",
        None,
    ),
    "misspelled smoothness": (
        lambda: Sphere().union(Box(), smoth=0.1),
        "a quadratic union has no 'smoth'",
        "did you mean 'smooth'?",
    ),
    "too many": (
        lambda: grown(20),
        "this union is made of 1,048,576 shapes; "
        "more than 1,000,000 take too long to compile and to draw",
        "repeat, array and symmetry show many copies for the price of one",
    ),
    # Own functions
    "own function of no point": (
        lambda: Shape.from_function(pointless),
        "'pointless' is no field: it needs a parameter p: vec3 (or vec2)",
        "def pointless(p: vec3) -> float",
    ),
    "own slope of nothing": (
        lambda: Shape.from_function(ball, slope=0),
        "'slope of ball' must be above 0, not 0",
        None,
    ),
    "own box upside down": (
        lambda: Shape.from_function(ball, bounds=((1, 1, 1), (-1, -1, -1))),
        "ball: nothing lies between bounds (1, 1, 1) and (-1, -1, -1): the low corner comes first",
        None,
    ),
    "own box of one corner": (
        lambda: Shape.from_function(ball, bounds=3),
        "bounds are two corners, (low, high), not 3",
        "bounds=((-1, -1, -1), (1, 1, 1))",
    ),
    "own function without numbers": (
        lambda: Scene(Shape.from_function(nowhere)).render(size=(8, 8)),
        "'nowhere' gives no number at any of 512 places",
        "look at its values: Shape.from_function(nowhere, …)(points)",
    ),
    # Scenes
    "nothing": (
        lambda: Scene([]),
        "a scene without shapes shows nothing",
        "give it a shape: Scene(Sphere())",
    ),
    "none as a scene": (
        lambda: Scene(None),
        "a scene shows shapes, not None",
        "a function without return gives None",
    ),
    "flat scene": (
        lambda: Scene(Circle()),
        "'Circle' is a flat shape; a scene shows solids",
        "make it solid: .extrude(height) or .revolve()",
    ),
    "no light": (
        lambda: Scene(Sphere(), lights=[3]),
        "a light is wanted, not 3",
        "PointLight((2, 3, 4))",
    ),
    "no camera": (
        lambda: Scene(Sphere(), camera=(0, 0, 5)),
        "a camera is wanted, not (0, 0, 5)",
        "Camera(position=…)",
    ),
    "no background": (
        lambda: Scene(Sphere(), background="#12345"),
        "'color of Background' takes a color like #rrggbb or tomato, not '#12345'",
        None,
    ),
    "unknown tone map": (
        lambda: Scene(Sphere(), tone_map="filmic"),
        "there is no tone map 'filmic'",
        "none, reinhard, aces, agx, neutral",
    ),
    "negative exposure": (
        lambda: Scene(Sphere(), exposure=-1),
        "'exposure of Scene' must be 0 or more, not -1",
        None,
    ),
    "no steps": (lambda: Scene(Sphere(), steps=0), "'steps of Scene' must be above 0, not 0", None),
    "half a bounce": (
        lambda: Scene(Sphere(), bounces=1.5),
        "'bounces of Scene' takes a whole number, not float 1.5",
        None,
    ),
    "negative bounces": (
        lambda: Scene(Sphere(), bounces=-1),
        "'bounces of Scene' must be 0 or more, not -1",
        None,
    ),
    "ends before it begins": (
        lambda: Scene(Sphere(), near=10, far=1),
        "Scene: rays begin at near 10 and end before it, at far 1",
        None,
    ),
    "steep without end": (
        lambda: Scene(Plane().twist(1)),
        "twist gives this shape no bound on its slope",
        "twist needs a shape that ends around the y axis: "
        "the farther out, the steeper it would get",
    ),
    "camera in a solid": (
        lambda: Scene(Sphere(10), DistantLight(), Camera((3, 2, 5))).render(size=(8, 8)),
        "the camera is inside 'Sphere', and all around it is dark",
        "move the camera, or look at the shape with view='slice'",
    ),
    "inside everywhere": (
        lambda: Scene(Sphere() | ~Sphere(), DistantLight()).render(size=(8, 8)),
        "the camera is inside 'union', and no ray finds a way out",
        "move the camera, or look at the shape with view='slice'",
    ),
}


@pytest.mark.parametrize("case", ERRORS)
def test_a_mistake_is_told_at_the_authors_line(case):
    make, message, hint = ERRORS[case]
    with pytest.raises(CompileError) as caught:
        make()
    (found,) = caught.value.diagnostics
    assert (found.message, found.hint) == (message, hint)
    assert found.span is not None and found.span.file == __file__
    assert isinstance(caught.value, TypeError | ValueError)


PYTHON = {
    "union with a number": (lambda: Sphere() | 3, TypeError, "unsupported operand type(s) for |"),
    "sum": (lambda: sum([Sphere(), Box()]), TypeError, "unsupported operand type(s) for +"),
    "changed": (
        lambda: setattr(Sphere(), "radius", 3),
        AttributeError,
        "a Sphere does not change; make another",
    ),
    "no size": (
        lambda: Scene(Sphere()).render(size=(0, 5)),
        ValueError,
        "each side has 1 to 16384 pixels, not 0x5",
    ),
    "size of one": (
        lambda: Scene(Sphere()).render(size=5),
        TypeError,
        "size is (width, height) in pixels, not 5",
    ),
    "no samples": (
        lambda: Scene(Sphere()).render(samples=0),
        ValueError,
        "a pixel has 1 to 65536 samples, not 0",
    ),
    "unknown view": (
        lambda: Scene(Sphere()).render(view="norml"),
        ValueError,
        "there is no view 'norml'; views: color, ",
    ),
    "unknown device": (
        lambda: Scene(Sphere()).render(device="gqu"),
        ValueError,
        "there is no device 'gqu'; devices: auto, cpu, gpu, gpu-fragment, reference",
    ),
    "no time": (
        lambda: Scene(Sphere()).render(time=math.nan),
        ValueError,
        "time is finite, not nan",
    ),
    "parameter out of its range": (
        lambda: Scene(Sphere(HALF)).render(params={"half": -1}),
        ValueError,
        "'Half' lies between 0.1 and 1, not -1",
    ),
    "unknown parameter": (
        lambda: Scene(Sphere(HALF)).render(params={"hlf": 1}),
        ValueError,
        "there is no parameter 'hlf'; parameters: half",
    ),
    "points of another kind": (
        lambda: Sphere()(np.zeros((3, 2))),
        TypeError,
        "Sphere() does not take (an array of shape (3, 2)); it takes (p: vec3) -> float",
    ),
}


@pytest.mark.parametrize("case", PYTHON)
def test_a_mistake_in_a_call_is_pythons_own_error(case):
    make, kind, message = PYTHON[case]
    with pytest.raises(kind) as caught:
        make()
    assert message in str(caught.value)


def heard(make):
    """What is warned of, and where; not what the garbage collector finds of other tests."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        warnings.simplefilter("ignore", ResourceWarning)
        make()
    return [(str(w.message), w.filename) for w in found]


def test_an_own_function_that_is_steeper_than_it_says_is_told():
    scene = Scene(Shape.from_function(steep))
    ((message, file),) = heard(lambda: scene.render(size=(8, 8)))
    assert file == __file__
    assert message.startswith("'steep' changes by 5 per unit near (")
    assert message.endswith(
        "more than its declared slope 1: rays may pass through it; give slope=5.2 or more"
    )
    assert heard(lambda: scene.render(size=(8, 8))) == [], "once is enough"


def test_an_own_function_that_keeps_its_word_is_not_doubted():
    assert heard(lambda: Scene(Shape.from_function(ball)).render(size=(8, 8))) == []
    told = Shape.from_function(steep, slope=5.0)
    assert heard(lambda: Scene(told).render(size=(8, 8))) == []
    given = {"camera": Camera((3, 2, 5)), "floor": False}
    drawn = Scene(told, **given).render(size=(24, 24), view="normal").array
    exact = Scene(Sphere(1.0), **given).render(size=(24, 24), view="normal").array
    assert np.abs(drawn - exact).max() < 0.02


def test_an_own_function_without_numbers_in_places_is_told():
    message = heard(lambda: Scene(Shape.from_function(rooted, slope=99.0)).render(size=(8, 8)))[0][
        0
    ]
    assert message.startswith("'rooted' gives no number at (-")
    assert message.endswith("; rays that come there see nothing")


def test_a_black_picture_is_told():
    away = Camera((3, 2, 5), target=(30, 20, 50))
    black = Scene(Sphere(), camera=away, background="#000", floor=False)
    ((message, file),) = heard(lambda: black.render(size=(8, 8)))
    assert message == "the picture is black: no light comes from what the camera sees"
    assert file == __file__


def test_light_that_is_not_a_number_is_told():
    broken = matte("red").bump(nowhere)
    for mode in ("direct", "path"):
        scene = Scene(Box(9).paint(broken), camera=Camera((3, 2, 5)), floor=False, mode=mode)
        ((message, file),) = heard(lambda scene=scene: scene.render(size=(8, 8), samples=1))
        assert message.startswith("in 100.0% of the pixels the light is not a number: look for a ")
        assert file == __file__


@pytest.mark.parametrize("background", ["#000", "#fff"])
def test_a_scene_without_lights_is_told(background):
    dark = Scene(Sphere(), lights=[], background=background)
    ((message, file),) = heard(lambda: dark.render(size=(8, 8)))
    assert message == (
        "the scene has no lights: its shapes are black; leave out lights= for usual ones"
    )
    assert file == __file__


def test_a_lamp_needs_no_other_light():
    lamp = Sphere().paint(emissive((1.0, 1.0, 1.0)))
    assert heard(lambda: Scene(lamp, lights=[], background="#000").render(size=(8, 8))) == []


def same(a, b, size=(48, 36), **options):
    first, second = (s.render(size=size, **options).array for s in (a, b))
    assert np.isfinite(first).all()
    assert first.std() > 0.02, "nothing is seen"
    return float(np.abs(first - second).max())


# What is odd, but right


def test_a_shape_in_a_scene_twice_is_there_once():
    ball = Sphere()
    assert same(Scene(ball | ball), Scene(ball)) == 0.0
    assert same(Scene([ball, ball, ball]), Scene(ball)) == 0.0


def test_a_union_of_one_is_that_one():
    assert same(Scene(Sphere().union()), Scene(Sphere())) == 0.0


def test_what_is_cut_away_wholly_is_not_there():
    rest = Torus() - Torus().offset(0.05)
    ball, given = Sphere(0.2).translate(y=5), {"camera": Camera((3, 2, 5)), **PLAIN_LIGHT}
    picture = Scene(rest | ball, **given).render(size=(24, 18)).array
    empty = Scene(ball, **given).render(size=(24, 18)).array
    assert np.abs(picture - empty).max() == 0.0


def test_without_lights_only_what_is_behind_is_seen():
    picture = Scene(Sphere(), lights=[]).render(size=(24, 18)).array[..., :3]
    assert picture[9, 12].max() == 0.0
    assert picture[0, 0].min() > 0.1


def test_a_light_in_a_solid_is_hidden_by_it():
    lit = Scene(Sphere() | Plane(-1.0), lights=[PointLight((0, 0, 0), 9.0), AmbientLight(0.1)])
    dark = Scene(Sphere() | Plane(-1.0), lights=[AmbientLight(0.1)])
    assert same(lit, dark) < 2 / 255


def test_a_camera_in_glass_looks_out():
    picture = Scene(Sphere(8.0).paint(glass())).render(size=(24, 18)).array
    assert picture[9, 12, :3].min() > 0.1


@pytest.mark.parametrize("far", [1e3, 1e4])
def test_far_from_the_origin_the_picture_is_the_same(far):
    """32 bits leave 1e4 / 2^23, a thousandth, for places: more shows as noise."""
    there = Scene(Sphere().translate(far, 0, 0), camera=Camera((far, 0, 5), (far, 0, 0)))
    here = Scene(Sphere(), camera=Camera((0, 0, 5)))
    first, second = (s.render(size=(48, 36)).array for s in (there, here))
    assert np.abs(first - second).mean() < 0.01


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_small_and_large_scenes_look_alike(size):
    """Pictures do not depend on the unit, within what is given in units: the end of rays, lifts."""
    scaled = Scene(Sphere(size), camera=Camera((0, 0, 5 * size)), far=20 * size, near=1e-3 * size)
    first, second = (
        s.render(size=(48, 36), view="normal").array
        for s in (scaled, Scene(Sphere(), camera=Camera((0, 0, 5)), far=20))
    )
    assert np.abs(first - second).mean() < 0.01


def test_huge_ground_is_a_plane():
    ball, camera = Sphere(0.5).translate(y=0.5), Camera((0, 1.5, 5))
    given = {"camera": camera, "default_material": (0.8, 0.8, 0.8), **PLAIN_LIGHT}
    round_earth = Scene(ball | Sphere(1e4).translate(y=-1e4), **given)
    flat = Scene(ball | Plane(0.0), **given)
    first, second = (s.render(size=(48, 36)).array[20:] for s in (round_earth, flat))
    assert np.abs(first - second).mean() < 0.01


SCENE, SHAPE = Scene(Sphere()), Sphere()


@image
def whole_scene(frame: Frame) -> vec4:
    return SCENE(frame)


@image
def only_distance(frame: Frame) -> vec4:
    d = SHAPE(vec3(4.0 * frame.coord / frame.resolution - 2.0, 0.0))
    return vec4(d, -d, 0.0, 1.0)


def test_scenes_and_shapes_are_functions_of_images():
    light = whole_scene.render(size=(24, 18)).array
    assert np.abs(light - SCENE.render(size=(24, 18), samples=1).linear).max() < 1e-5
    shown = only_distance.render(size=(25, 25)).array
    assert shown[12, 12, 0] == pytest.approx(-1.0, abs=1e-5)


# Large trees


def test_a_hundred_shapes_of_one_union_compile():
    shape = Sphere(0.3)
    for i in range(100):
        shape = shape | Sphere(0.05).translate(0.5 * math.cos(i), 0.01 * i, 0.5 * math.sin(i))
    begin = clock.monotonic()
    picture = Scene(shape).render(size=(48, 36), view="normal").array
    assert picture.std() > 0.02
    assert clock.monotonic() - begin < 60.0


def test_trees_that_share_shapes_stay_small():
    """2^10 spheres of 10 functions: each calls the one before it twice."""
    shape = grown(10)
    assert shape.node.parts == 1024
    points = np.array([[3.25, 0.0, 0.0], [-2.0, 0.0, 0.0], [10.0, 1.5, 0.0], [14.0, 0.0, 0.0]])
    assert shape(points) == pytest.approx([-0.25, 1.5, 1.0, 3.5])
