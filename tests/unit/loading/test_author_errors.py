"""What is said of errors that Python raises in a scene's file: the exact texts."""

from __future__ import annotations

import pytest

import distal

CASES = {
    "a misspelled name": (
        "from distal import *\nscene = Scene(Sphere(1.0) - Bx(0.5))\n",
        """\
NameError: name 'Bx' is not defined
  --> scene.py:2:29
   |
 2 | scene = Scene(Sphere(1.0) - Bx(0.5))
   |                             ^^
   = hint: did you mean 'Box'?""",
    ),
    "a name that was not imported": (
        "from distal import Scene\nscene = Scene(Sphere(1.0))\n",
        """\
NameError: name 'Sphere' is not defined
  --> scene.py:2:15
   |
 2 | scene = Scene(Sphere(1.0))
   |               ^^^^^^
   = hint: from distal import Sphere""",
    ),
    "a usual module": (
        "from distal import *\nscene = Scene(Sphere(np.pi))\n",
        """\
NameError: name 'np' is not defined
  --> scene.py:2:22
   |
 2 | scene = Scene(Sphere(np.pi))
   |                      ^^
   = hint: import numpy as np""",
    ),
    "the time, which * leaves out": (
        "from distal import *\nscene = Scene(Sphere(1.0 + time))\n",
        """\
NameError: name 'time' is not defined
  --> scene.py:2:28
   |
 2 | scene = Scene(Sphere(1.0 + time))
   |                            ^^^^
   = hint: from distal import time""",
    ),
    "the module time": (
        "import math, time\nfrom distal import *\nsize = math.sin(time)\n",
        """\
TypeError: 'time' is Python's module here
  --> scene.py:3:8
   |
 3 | size = math.sin(time)
   |        ^^^^^^^^^^^^^^
   = hint: from distal import time, and np.sin(time)""",
    ),
    "the time as a number": (
        "import math\nfrom distal import time\nsize = math.sin(time)\n",
        """\
TypeError: a parameter or the time has no value yet, so its number is not known here
  --> scene.py:3:8
   |
 3 | size = math.sin(time)
   |        ^^^^^^^^^^^^^^
   = hint: np.sin(time), or sin of distal.lang, instead of math.sin and float""",
    ),
    "a parameter as a count": (
        "from distal.lang import integer\nn = integer('n', 3, 1, 8)\nfor i in range(n): pass\n",
        """\
TypeError: a parameter or the time has no value yet, so its number is not known here
  --> scene.py:3:10
   |
 3 | for i in range(n): pass
   |          ^^^^^^^^
   = hint: range takes a plain int; a live count: shape.shown(i < n) for i in range(8)""",
    ),
    "a misspelled method": (
        "from distal import *\nball = Sphere(1.0).rotat(x=1)\n",
        """\
AttributeError: 'Sphere' has no 'rotat'
  --> scene.py:2:8
   |
 2 | ball = Sphere(1.0).rotat(x=1)
   |        ^^^^^^^^^^^^^^^^^
   = hint: did you mean 'rotate'?""",
    ),
    "another library's method": (
        "from distal import *\nball = Sphere(1.0).move(1, 2, 3)\n",
        """\
AttributeError: 'Sphere' has no 'move'
  --> scene.py:2:8
   |
 2 | ball = Sphere(1.0).move(1, 2, 3)
   |        ^^^^^^^^^^^^^^^^
   = hint: there is translate(x, y, z)""",
    ),
    "a name of the language in the package": (
        "import distal\nn = distal.slider('n', 1.0)\n",
        """\
AttributeError: module 'distal' has no attribute 'slider'
  --> scene.py:2:5
   |
 2 | n = distal.slider('n', 1.0)
   |     ^^^^^^^^^^^^^
   = hint: from distal.lang import slider""",
    ),
    "a wrong keyword": (
        "from distal import *\nscene = Scene(Sphere(1.0), light=[])\n",
        """\
TypeError: Scene has no 'light'
  --> scene.py:2:28
   |
 2 | scene = Scene(Sphere(1.0), light=[])
   |                            ^^^^^
   = hint: did you mean 'lights'?""",
    ),
    "a wrong keyword of an own function": (
        "def part(size): return size\npart(width=1)\n",
        """\
TypeError: part has no 'width'
  --> scene.py:2:6
   |
 2 | part(width=1)
   |      ^^^^^
   = hint: it takes size""",
    ),
    "a misspelled import": (
        "from distal import Spher\n",
        """\
ImportError: 'distal' has no 'Spher'
  --> scene.py:1:1
   |
 1 | from distal import Spher
   | ^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: did you mean 'Sphere'?""",
    ),
    "an import from the wrong module": (
        "from distal import smoothstep\n",
        """\
ImportError: 'distal' has no 'smoothstep'
  --> scene.py:1:1
   |
 1 | from distal import smoothstep
   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: from distal.lang import smoothstep""",
    ),
    "a misspelled module": (
        "import nunpy\n",
        """\
ModuleNotFoundError: there is no module 'nunpy'
  --> scene.py:1:1
   |
 1 | import nunpy
   | ^^^^^^^^^^^^
   = hint: did you mean 'numpy'?""",
    ),
    "the module time in NumPy": (
        "import time\nimport numpy as np\nsize = np.sin(time)\n",
        """\
TypeError: 'time' is Python's module here
  --> scene.py:3:8
   |
 3 | size = np.sin(time)
   |        ^^^^^^^^^^^^
   = hint: from distal import time, and np.sin(time)""",
    ),
    "the module time in a sum": (
        "import time\nsize = 1 + time\n",
        """\
TypeError: 'time' is Python's module here
  --> scene.py:2:8
   |
 2 | size = 1 + time
   |        ^^^^^^^^
   = hint: from distal import time, and np.sin(time)""",
    ),
    "the module time of a shape": (
        "import time\nfrom distal import *\nball = Sphere(1.0).translate(time, 0, 0)\n",
        """\
error: translate takes no module, and 'time' is one
  --> scene.py:3:8
   |
 3 | ball = Sphere(1.0).translate(time, 0, 0)
   |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: from distal import time""",
    ),
    "the module time by name": (
        "import time\nfrom distal import *\nball = Sphere(1.0).translate(y=time)\n",
        """\
error: translate takes no module, and 'time' is one
  --> scene.py:3:8
   |
 3 | ball = Sphere(1.0).translate(y=time)
   |        ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: from distal import time""",
    ),
    "a slider as a count": (
        "from distal.lang import slider\nn = slider('n', 3, 1, 8)\nfor i in range(n): pass\n",
        """\
TypeError: a parameter or the time has no value yet, so its number is not known here
  --> scene.py:3:10
   |
 3 | for i in range(n): pass
   |          ^^^^^^^^
   = hint: range takes a plain int; a live count: shape.shown(i < n) for i in range(8)""",
    ),
    "a parameter as a condition": (
        "from distal.lang import slider\nn = slider('n', 3, 1, 8)\nif n > 2: pass\n",
        """\
TypeError: a parameter or the time has no value yet, so whether it is true is not known here
  --> scene.py:3:4
   |
 3 | if n > 2: pass
   |    ^^^^^
   = hint: select(condition, a, b) of distal.lang, or if in a @func""",
    ),
    "atan of two numbers": (
        "from distal.lang import atan\nangle = atan(1.0, 2.0)\n",
        """\
TypeError: atan() does not take (1.0, 2.0); atan2(y, x) does
  --> scene.py:2:9
   |
 2 | angle = atan(1.0, 2.0)
   |         ^^^^^^^^^^^^^^""",
    ),
    "atan of two values": (
        "from distal import time\nfrom distal.lang import atan\nangle = atan(1.0, time)\n",
        """\
TypeError: 'atan' takes 1 argument, got 2; atan2(y, x)
  --> scene.py:3:9
   |
 3 | angle = atan(1.0, time)
   |         ^^^^^^^^^^^^^^^""",
    ),
    "a name of GLSL": (
        "from distal.lang import vec3\nx = lerp(1, 2, 0.5)\n",
        """\
NameError: name 'lerp' is not defined
  --> scene.py:2:5
   |
 2 | x = lerp(1, 2, 0.5)
   |     ^^^^
   = hint: mix(a, b, share)""",
    ),
    "a derivative of GLSL": (
        "from distal.lang import dFdx\n",
        """\
ImportError: 'distal.lang' has no 'dFdx'
  --> scene.py:1:1
   |
 1 | from distal.lang import dFdx
   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: gradient(f, frame.coord) is exact; differences of pixels vary with the device""",
    ),
    "a derivative of GLSL by its module": (
        "import distal.lang as L\nx = L.fwidth(1)\n",
        """\
AttributeError: 'distal.lang' has no 'fwidth'
  --> scene.py:2:5
   |
 2 | x = L.fwidth(1)
   |     ^^^^^^^^
   = hint: gradient(f, frame.coord) is exact; differences of pixels vary with the device""",
    ),
    "a misspelled module of the package": (
        "from distal.lnag import vec3\n",
        """\
ModuleNotFoundError: there is no module 'distal.lnag'
  --> scene.py:1:1
   |
 1 | from distal.lnag import vec3
   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: did you mean 'distal.lang'?""",
    ),
    "a wrong keyword of a method": (
        "from distal import *\nball = Sphere(1.0).paint('red', prioriti=3)\n",
        """\
TypeError: paint has no 'prioriti'
  --> scene.py:2:33
   |
 2 | ball = Sphere(1.0).paint('red', prioriti=3)
   |                                 ^^^^^^^^
   = hint: did you mean 'priority'?""",
    ),
    "a wrong keyword of a shape": (
        "from distal import *\nball = Sphere(radios=1.0)\n",
        """\
error: Sphere has no 'radios'
  --> scene.py:2:8
   |
 2 | ball = Sphere(radios=1.0)
   |        ^^^^^^^^^^^^^^^^^^
   = hint: did you mean 'radius'?""",
    ),
    "a wrong keyword of three letters": (
        "from distal import *\nview = Camera((0, 0, 3), fow=1.0)\n",
        """\
error: Camera has no 'fow'
  --> scene.py:2:8
   |
 2 | view = Camera((0, 0, 3), fow=1.0)
   |        ^^^^^^^^^^^^^^^^^^^^^^^^^^
   = hint: did you mean 'fov'?""",
    ),
    "a missing argument": (
        "from distal import *\nball = Sphere(1.0).twist()\n",
        """\
TypeError: Shape.twist needs 'rate'
  --> scene.py:2:8
   |
 2 | ball = Sphere(1.0).twist()
   |        ^^^^^^^^^^^^^^^^^^^""",
    ),
    "a call that a shape lacks": (
        "from distal import *\nSphere(1.0).rendr()\n",
        """\
AttributeError: 'Sphere' has no 'rendr'
  --> scene.py:2:1
   |
 2 | Sphere(1.0).rendr()
   | ^^^^^^^^^^^^^^^^^
   = hint: did you mean 'render'?""",
    ),
    "no hint is invented": (
        "raise ValueError('of the author; as it is')\n",
        """\
ValueError: of the author; as it is
  --> scene.py:1:1
   |
 1 | raise ValueError('of the author; as it is')
   | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^""",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_the_text(case, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, expected = CASES[case]
    (tmp_path / "scene.py").write_text(text)
    with pytest.raises((distal.LoadError, distal.CompileError)) as caught:
        distal.load("scene.py")
    assert str(caught.value) == expected


def test_a_scene_without_lights_warns():
    with pytest.warns(UserWarning) as caught:
        distal.Scene(distal.Sphere(1.0), lights=[]).render((2, 2))
    assert [str(w.message) for w in caught] == [
        "the scene has no lights: its shapes are black; leave out lights= for usual ones"
    ]


def test_a_module_beside_the_scene_is_shown(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "parts.py").write_text("import math\nsize = math.floo(1.5)\n")
    (tmp_path / "scene.py").write_text("from parts import size\n")
    with pytest.raises(distal.LoadError) as caught:
        distal.load("scene.py")
    assert str(caught.value).splitlines()[:2] == [
        "AttributeError: 'math' has no 'floo'",
        "  --> parts.py:2:8",
    ]
    assert caught.value.hint == "did you mean 'floor'?"


def test_an_error_of_the_author_that_has_no_text(tmp_path):
    file = tmp_path / "scene.py"
    file.write_text(
        "class Odd(AttributeError):\n    def __str__(self): raise ValueError\nraise Odd()\n"
    )
    with pytest.raises(distal.LoadError, match="Odd: its text cannot be made"):
        distal.load(str(file))


def test_a_file_and_a_name_in_one_text(tmp_path):
    file = tmp_path / "scene.py"
    file.write_text("from distal import *\na = Sphere(1.0)\nb = Box(1.0)\n")
    assert distal.load(f"{file}:b").name == "Box"
    with pytest.raises(distal.LoadError, match="has no scene, @image or @func 'c'"):
        distal.load(f"{file}:c")
