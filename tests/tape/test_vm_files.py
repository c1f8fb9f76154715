"""Shapes from ``.vm`` files: the same on every way, and errors with their line."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

from distal import Shape, compile
from distal.scene.objects.shape import Shape2D
from distal.scene.tree.errors import SceneTypeError, SceneValueError
from distal.tape.runtime import TapeProgram
from distal.tape.vm_file import MOST_OPERATIONS, VM_OPERATIONS, VmFileError, read_vm
from distal.tape.vm_function import point_function

DISK = """# a disk of radius 0.75
_0 var-x
_1 square _0
_2 var-y
_3 square _2
_4 add _1 _3
_5 sqrt _4
radius const 7.5e-1
_7 sub _5 radius
"""
# The meaning of each operation, as Fidget documents it, by the C library's functions.
MEANINGS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "min": min,
    "max": max,
    "mod": lambda a, b: a - b * math.floor(a / b),
    "atan2": math.atan2,
    "compare": lambda a, b: (a > b) - (a < b),
    "and": lambda a, b: b if a != 0 else a,
    "or": lambda a, b: a if a != 0 else b,
    "not": lambda a: float(a == 0),
    "neg": lambda a: -a,
    "abs": abs,
    "square": lambda a: a * a,
    "sqrt": lambda a: math.sqrt(max(a, 0.0)),
    "recip": lambda a: 1 / a if a else math.inf,
    "floor": math.floor,
    "ceil": math.ceil,
    "round": round,
    "sin": math.sin,
    "cos": math.cos,
    "tan": math.tan,
    "asin": lambda a: math.asin(min(max(a, -1.0), 1.0)),
    "acos": lambda a: math.acos(min(max(a, -1.0), 1.0)),
    "atan": math.atan,
    "exp": math.exp,
    "ln": lambda a: math.log(max(a, 2.0**-126)),
}


def grid(size: int = 3, count: int = 200) -> np.ndarray:
    points = np.random.default_rng(7).uniform(-2, 2, (count, size)).astype(np.float32)
    points[:20, 0] = 0.0
    return points


def test_a_disk():
    disk = Shape.from_vm(DISK)
    assert isinstance(disk, Shape2D)
    points = grid(2)
    expected = np.hypot(*points.T.astype(np.float64)) - 0.75
    assert np.abs(disk(points) - expected).max() < 1e-6


def test_a_file(tmp_path):
    path = tmp_path / "my disk-2.vm"
    path.write_text(DISK, encoding="utf-8")
    for source in (path, str(path)):
        disk = Shape.from_vm(source)
        assert disk.node.name == "my_disk_2"
        assert disk(np.array([[0.75, 0.0]], np.float32))[0] == 0.0


@pytest.mark.parametrize("name", ["vec2", "abs", "for", "3d", "é", "p", "v1", "float"])
def test_any_name_of_a_file(tmp_path, name):
    path = tmp_path / f"{name}.vm"
    path.write_text(DISK, encoding="utf-8")
    assert np.allclose(Shape.from_vm(path)(np.zeros((1, 2), np.float32)), -0.75)


def test_a_third_coordinate_makes_it_solid():
    ball = Shape.from_vm(DISK + "_8 var-z\n_9 abs _8\n_a const 0.1\n_b sub _9 _a\n_c max _7 _b\n")
    assert isinstance(ball, Shape)
    assert np.allclose(ball(np.zeros((1, 3), np.float32)), -0.1)


def test_the_meanings_cover_the_table():
    assert set(MEANINGS) == set(VM_OPERATIONS)


@pytest.mark.parametrize("name", VM_OPERATIONS)
def test_every_operation_means_the_same_on_a_tape_and_in_a_kernel(name):
    count = VM_OPERATIONS[name][0]
    text = f"x var-x\ny var-y\nr {name} {'x y'[: 2 * count - 1]}\n"
    program = read_vm(text, "text")
    points = grid(2)
    expected = np.array([MEANINGS[name](*map(float, row[:count])) for row in points])
    near = np.abs(expected) < 50
    for found in (
        TapeProgram(program.tape()).values(points),
        point_function(program)(points),
    ):
        error = np.abs(found[near] - expected[near]) / np.maximum(1.0, np.abs(expected[near]))
        assert error.max() < 2e-5


@pytest.mark.parametrize("target", ["glsl-es300", "wgsl", "llvm"])
def test_it_compiles_to_every_target(target):
    assert (
        "0.75" in compile(Shape.from_vm(DISK).extrude(0.2), target=target).text or target == "llvm"
    )


def test_it_is_an_ordinary_shape():
    moved = Shape.from_vm(DISK).translate(1.0, 0.0) | Shape.from_vm(DISK)
    points = grid(2)
    one = np.hypot(*(points - [1.0, 0.0]).T.astype(np.float64)) - 0.75
    other = np.hypot(*points.T.astype(np.float64)) - 0.75
    assert np.abs(moved(points) - np.minimum(one, other)).max() < 1e-6
    assert np.allclose(moved.gradient(np.array([[0.0, 1.0]], np.float32)), [[0.0, 1.0]], atol=1e-5)


def test_slope_and_bounds_are_declared():
    disk = Shape.from_vm(DISK, slope=2.0, bounds=((-0.75, -0.75), (0.75, 0.75)))
    assert disk.slope == 2.0
    assert disk.bounds() == ((-0.75, -0.75), (0.75, 0.75))
    assert not math.isfinite(Shape.from_vm(DISK).bounds()[0][0])


def test_reading_needs_no_numpy():
    code = (
        "import sys; sys.modules['numpy'] = None\n"
        "from distal import Shape, compile\n"
        f"shape = Shape.from_vm({DISK!r})\n"
        "print(len(compile(shape.extrude(1.0), target='glsl-es300').text) > 100)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "True", done.stderr


WRONG = [
    ("_0 var-x\n_1 sinus _0\n", "there is no operation 'sinus'", 2, "sinus"),
    ("_0 var-x\n_1 add _0\n", "'add' takes two operands, not 1", 2, "add"),
    ("_0 var-x\n_1 neg _0 _0\n", "'neg' takes one operand, not 2", 2, "neg"),
    ("_0 var-x _0\n_1 neg _0\n", "'var-x' takes nothing, not 1", 1, "var-x"),
    ("_0 var-x\n# note\n_1 neg _2\n", "'_2' is not the result of an earlier line", 3, "_2"),
    ("_0 const one\n_1 neg _0", "'one' is not a finite number of 32 bits", 1, "one"),
    ("_0 const inf\n_1 neg _0", "'inf' is not a finite number of 32 bits", 1, "inf"),
    ("_0 const 1e39\n_1 neg _0", "'1e39' is not a finite number of 32 bits", 1, "1e39"),
    ("_0 var-x\n_1\n", "this line has no operation", 2, "_1"),
]


@pytest.mark.parametrize("text, message, line, word", WRONG, ids=[w[1][:20] for w in WRONG])
def test_errors_show_the_line(text, message, line, word):
    with pytest.raises(VmFileError) as error:
        Shape.from_vm(text)
    (found,) = error.value.diagnostics
    assert found.message == message
    assert found.span is not None
    assert (found.span.file, found.span.line) == ("text", line)
    assert found.span.text[found.span.col : found.span.end_col] == word
    assert isinstance(error.value, ValueError)


def test_the_whole_text_of_an_error():
    with pytest.raises(VmFileError) as error:
        Shape.from_vm("_0 var-x\n_1 sqr _0\n")
    assert str(error.value) == (
        "error: there is no operation 'sqr'\n"
        "  --> text:2:4\n"
        "   |\n"
        " 2 | _1 sqr _0\n"
        "   |    ^^^\n"
        "   = hint: did you mean 'sqrt'?"
    )


def test_a_file_that_cannot_be_read(tmp_path):
    with pytest.raises(SceneValueError, match=r"cannot read '.*none.vm': No such file"):
        Shape.from_vm(tmp_path / "none.vm")
    binary = tmp_path / "binary.vm"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(SceneValueError, match=r"cannot read '.*binary.vm': it is no text"):
        Shape.from_vm(binary)
    with pytest.raises(VmFileError, match="'text' has no operations"):
        Shape.from_vm("# nothing\n\n# here")
    with pytest.raises(SceneTypeError, match=r"a \.vm file is a path or a text, not 3"):
        Shape.from_vm(3)


def test_a_file_that_is_too_long():
    text = "_0 var-x\n" + "\n".join(f"_{i} neg _{i - 1}" for i in range(1, MOST_OPERATIONS + 1))
    with pytest.raises(VmFileError, match="a file has at most 20000 operations"):
        Shape.from_vm(text)
    assert len(read_vm(text.rpartition("\n")[0], "text").rows) == MOST_OPERATIONS
