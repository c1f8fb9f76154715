"""What is said of usual mistakes of beginners in a scene's file: the exact texts."""

from __future__ import annotations

import sys

import pytest

import distal

# Python 3.11 gives a condition the place of its whole statement.
CONDITION = ("3:4", "   ^^^^") if sys.version_info >= (3, 12) else ("3:1", "^^^^^^^^^^^^^")

CASES = {
    "and instead of an operator": (
        "from distal import *\nscene = Scene(Sphere(1.0) and Box(1.0))\n",
        """\
error: a shape is neither true nor false
  --> scene.py:2:15
   |
 2 | scene = Scene(Sphere(1.0) and Box(1.0))
   |               ^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: a & b, a | b or a - b; and shape is None asks whether there is one""",
    ),
    "a shape as a condition": (
        "from distal import *\nball = Sphere(1.0)\nif ball: pass\n",
        f"""\
error: a shape is neither true nor false
  --> scene.py:{CONDITION[0]}
   |
 3 | if ball: pass
   | {CONDITION[1]}
   = hint: a & b, a | b or a - b; and shape is None asks whether there is one""",
    ),
    "a shape times a number": (
        "from distal import *\nscene = Scene(2 * Sphere(1.0))\n",
        """\
error: a shape is not multiplied
  --> scene.py:2:15
   |
 2 | scene = Scene(2 * Sphere(1.0))
   |               ^^^^^^^^^^^^^^^
   = hint: shape.scale(2)""",
    ),
    "a shape divided by a number": (
        "from distal import *\nscene = Scene(Sphere(1.0) / 2)\n",
        """\
error: a shape is not multiplied
  --> scene.py:2:15
   |
 2 | scene = Scene(Sphere(1.0) / 2)
   |               ^^^^^^^^^^^^^^^
   = hint: shape.scale(2)""",
    ),
    "a class instead of a shape": (
        "from distal import *\nscene = Scene(Sphere)\n",
        """\
error: a scene shows shapes, not the class Sphere
  --> scene.py:2:9
   |
 2 | scene = Scene(Sphere)
   |         ^^^^^^^^^^^^^
   = hint: call it: Sphere(…)""",
    ),
    "classes joined": (
        "from distal import *\nscene = Scene(Sphere | Box)\n",
        """\
error: a scene shows shapes, not distal.scene.objects.shapes.Sphere | distal.scene.objects.sh
  --> scene.py:2:9
   |
 2 | scene = Scene(Sphere | Box)
   |         ^^^^^^^^^^^^^^^^^^^
   = hint: call the classes: Sphere(1.0) | Box(1.0)""",
    ),
    "a shape and a class": (
        "from distal import *\nscene = Scene(Sphere(1.0) | Box)\n",
        """\
TypeError: unsupported operand type(s) for |: 'Sphere' and 'ABCMeta'
  --> scene.py:2:15
   |
 2 | scene = Scene(Sphere(1.0) | Box)
   |               ^^^^^^^^^^^^^^^^^
   = hint: a class is no shape; call it: Box(…)""",
    ),
    "nothing as a shape": (
        "from distal import *\ndef part(): Sphere(1.0)\nscene = Scene(part())\n",
        """\
error: a scene shows shapes, not None
  --> scene.py:3:9
   |
 3 | scene = Scene(part())
   |         ^^^^^^^^^^^^^
   = hint: a function without return gives None""",
    ),
    "numbers of 0 to 255 as a color": (
        "from distal import *\nscene = Scene(Sphere(1.0).paint((255, 128, 0)))\n",
        """\
error: 'color of matte' must be between 0 and 1, not (255, 128, 0)
  --> scene.py:2:15
   |
 2 | scene = Scene(Sphere(1.0).paint((255, 128, 0)))
   |               ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: write '#ff8000'""",
    ),
    "an angle without an axis": (
        "from distal import *\npart = Box(1.0).rotate(0.5)\n",
        """\
error: a rotation needs an angle and an axis
  --> scene.py:2:8
   |
 2 | part = Box(1.0).rotate(0.5)
   |        ^^^^^^^^^^^^^^^^^^^^
   = hint: rotate(y=0.5), or rotate(0.5, axis=(0, 1, 0))""",
    ),
    "a misspelled part of a vector": (
        "from distal import *\npart = Box(1.0).translate(z1=2)\n",
        """\
error: translate has no 'z1'
  --> scene.py:2:8
   |
 2 | part = Box(1.0).translate(z1=2)
   |        ^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: did you mean 'z'?""",
    ),
    "a function without @func": (
        "from distal import *\ndef f(p): return 1.0\nshape = Shape.from_function(f)\n",
        """\
error: a shape is made from a @func, not from the function 'f'
  --> scene.py:3:9
   |
 3 | shape = Shape.from_function(f)
   |         ^^^^^^^^^^^^^^^^^^^^^^
   = hint: write @func above it""",
    ),
    "a declaration of GLSL": (
        "from distal import *\nvec3 color = vec3(1.0)\n",
        """\
error: this is not Python: invalid syntax
  --> scene.py:2:6
   |
 2 | vec3 color = vec3(1.0)
   |      ^^^^^
   = hint: types are not written: color = …""",
    ),
    "an operator of C": (
        "from distal import *\nif True && False: pass\n",
        """\
error: this is not Python: invalid syntax
  --> scene.py:2:10
   |
 2 | if True && False: pass
   |          ^
   = hint: write and instead of &&""",
    ),
    "a step of C": (
        "from distal import *\ni = 0\ni++\n",
        """\
error: this is not Python: invalid syntax
  --> scene.py:3:4
   |
 3 | i++
   |    ^
   = hint: write i += 1""",
    ),
    "quotes of a text program": (
        "from distal import *\ncolor = “red”\n",
        """\
error: this is not Python: invalid character '“' (U+201C)
  --> scene.py:2:9
   |
 2 | color = “red”
   |         ^
   = hint: write " instead of “""",
    ),
    "a function without an end": (
        "from distal import *\ndef tree(n): return tree(n - 1)\nscene = Scene(tree(3))\n",
        """\
RecursionError: tree() calls itself again and again
  --> scene.py:2:21
   |
 2 | def tree(n): return tree(n - 1)
   |                     ^^^^^^^^^^^
   = hint: return something else when n == 0""",
    ),
    "a list of shapes": (
        "from distal import *\nparts = [Sphere(1.0), Box(1.0)]\n",
        """\
scene.py defines no scene and no @image; it has no scene code at all
  = hint: 'parts' is a list of shapes: scene = Scene(parts)""",
    ),
    "a class called scene": (
        "from distal import *\nscene = Sphere\n",
        """\
scene.py defines no scene and no @image; it has no scene code at all
  = hint: 'scene' is a class; call it: Sphere(…)""",
    ),
    "a scene in a function": (
        "from distal import *\ndef make():\n    scene = Scene(Sphere(1.0))\n    return scene\n",
        """\
scene.py defines no scene and no @image; it has no scene code at all
  = hint: make() is a function; give its result a name: scene = make()""",
    ),
    "no scene": (
        "size = 1.0\n",
        """\
scene.py defines no scene and no @image; it has no scene code at all
  = hint: scene = Scene(…)""",
    ),
    "a picture": (
        "from distal import *\nscene = Scene(Sphere(1.0)).render((2, 2))\n",
        """\
scene.py defines no scene and no @image; it has no scene code at all
  = hint: 'scene' is a Picture already: leave out .render()""",
    ),
    "a noise of another module": (
        "from distal.lang import *\nvalue = fbm(vec3(1.0))\n",
        """\
NameError: name 'fbm' is not defined
  --> scene.py:2:9
   |
 2 | value = fbm(vec3(1.0))
   |         ^^^
   = hint: from distal.fields.noise import fbm""",
    ),
    "a noise of GLSL": (
        "from distal.lang import snoise\n",
        """\
ImportError: 'distal.lang' has no 'snoise'
  --> scene.py:1:1
   |
 1 | from distal.lang import snoise
   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: from distal.fields.noise import gradient_noise""",
    ),
    "a noise of the package": (
        "from distal import worley\n",
        """\
ImportError: 'distal' has no 'worley'
  --> scene.py:1:1
   |
 1 | from distal import worley
   | ^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: from distal.fields.noise import worley""",
    ),
    "a texture that is not there": (
        "from distal import *\nlook = image_pattern('no.png')\n",
        """\
error: image_pattern: the texture 'no.png' cannot be read: No such file or directory
  --> scene.py:2:8
   |
 2 | look = image_pattern('no.png')
   |        ^^^^^^^^^^^^^^^^^^^^^^^""",
    ),
}


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("case", CASES)
def test_the_text(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, expected = CASES[case]
    (tmp_path / "scene.py").write_text(text, encoding="utf-8")
    with pytest.raises((distal.LoadError, distal.CompileError)) as caught:
        distal.load("scene.py")
    assert str(caught.value) == expected


def test_a_vector_that_is_too_short(tmp_path):
    file = tmp_path / "scene.py"
    lines = ["from distal.lang import *", "@image", "def picture(frame: Frame) -> vec3:"]
    file.write_text("\n".join([*lines, "    return vec3(frame.coord)"]))
    with pytest.raises(distal.CompileError) as caught:
        distal.compile(distal.load(str(file)), target="wgsl")
    assert str(caught.value).endswith("hint: give 1 more: vec3(…, 0.0)")
