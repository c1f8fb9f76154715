"""Decompose: what a target lacks is said otherwise, and means the same on the reference."""

import numpy as np
import pytest

from distal.diagnostics import CompileError
from distal.ir.nodes import Binary, BinaryOp, Builtin, Cast, Const, Index, Sample
from distal.ir.printer import print_module
from distal.ir.target import FramePlace, Target
from distal.ir.walk import expressions_in
from distal.lang import (
    Frame,
    Texture2D,
    abs,
    clamp,
    func,
    image,
    integer,
    ivec2,
    ivec3,
    max,
    min,
    mod,
    pcg,
    sample,
    sin,
    texel,
    uint,
    vec2,
    vec3,
    vec4,
)
from tests.unit.passes.evaluation import evaluate, passed, points

PLAIN = Target("plain", "llvm", FramePlace.NONE, samples=False)
ABLE = Target(
    "able", "llvm", FramePlace.NONE, integer_floor=True, saturating_cast=True, samples=False
)
OLD = Target(
    "old",
    "glsl100",
    FramePlace.PIXEL,
    unsigned=False,
    dynamic_loops=False,
    dynamic_index=False,
    texel_fetch=False,
)
INTS = np.random.default_rng(2).integers(-(2**31), 2**31, 400).astype(np.int32)
SMALL = np.random.default_rng(3).integers(-9, 9, 400).astype(np.int32)
EDGES = np.array([-(2**31), -(2**31), -1, 0, 1, 2**31 - 1] * 2, np.int32)


def nodes(module):
    return [e for f in module.functions for e in expressions_in(f.body)]


def same_as_reference(function, target, *args):
    """The decomposed function gives what the reference defines."""
    expected = evaluate(passed(function, precision=32), *args, precision=32)
    module = passed(function, target=target, precision=32)
    found = evaluate(module, *args, precision=32)
    assert np.array_equal(expected, found, equal_nan=True)
    return module


def test_floored_division_of_ints():
    @func
    def both(a: int, b: int) -> int:
        return (a // b) * 7 + a % b

    module = same_as_reference(both, PLAIN, INTS, SMALL)
    same_as_reference(both, PLAIN, EDGES, EDGES[::-1].copy())
    used = {e.op for e in nodes(module) if isinstance(e, Binary)}
    assert not used & {BinaryOp.FLOOR_DIV, BinaryOp.MOD}
    assert "integers" not in print_module(passed(both, target=ABLE, precision=32))


def test_a_scalar_prelude_function_is_applied_to_each_component():
    @func
    def both(a: int, b: int) -> ivec3:
        return ivec3(a, b, a + b) // ivec3(b, 3, a)

    module = same_as_reference(both, PLAIN, INTS, SMALL)
    assert "fn floor_quotient_ivec3(a: ivec3, b: ivec3) -> ivec3" in print_module(module)


def test_powers_of_two_shift_and_mask():
    @func
    def both(a: int) -> int:
        return (a // 8) ^ (a % 16) + a // 1

    module = same_as_reference(both, PLAIN, INTS)
    assert not any("floor" in f.name for f in module.functions)


def test_floored_floats():
    @func
    def both(a: float, b: float) -> float:
        return a // b + mod(a, b) * 3.0 + a % b

    a, b = points(2, 300).astype(np.float32)
    module = same_as_reference(both, PLAIN, a, b)
    assert not any(isinstance(e, Binary) and e.op is BinaryOp.MOD for e in nodes(module))


def test_shift_counts_are_masked_unless_plain():
    @func
    def both(a: int, n: int) -> int:
        return (a << n) ^ (a >> 3) ^ (a >> (n + 1))

    text = print_module(same_as_reference(both, PLAIN, INTS, INTS))
    assert "(and n 31)" in text and "(shr a 3)" in text


def test_float_to_int_saturates():
    @func
    def whole(x: float) -> int:
        return int(x) + int(1e20) - int(-2.9)

    x = np.array([1e20, -1e20, np.nan, np.inf, -np.inf, 2.5, -2.5, 2147483520.0], np.float32)
    module = same_as_reference(whole, PLAIN, x)
    assert not any(isinstance(e, Cast) for e in nodes(module))
    assert "2147483647" in print_module(module)


def test_elementary_functions_are_the_prelude_s_in_32_bits_only():
    @func
    def wave(p: vec3) -> vec3:
        return sin(p)

    text = print_module(passed(wave, target=PLAIN, precision=32))
    assert "sine_vec3((min (max p " in text
    assert "sine" not in print_module(passed(wave, target=PLAIN, precision=64))


def test_textures_are_filtered_by_the_prelude_with_their_wrap():
    photo = Texture2D([[[0.0, 0.0, 0.0, 1.0]]], wrap="clamp")

    @func
    def fetch(uv: vec2) -> vec4:
        return sample(photo, uv)

    module = passed(fetch, target=PLAIN, precision=32)
    assert "sample_2d_photo(uv, 1)" in print_module(module)
    assert not any(isinstance(e, Sample) for e in nodes(module))


def test_a_target_without_int_functions_gets_them():
    @func
    def held(a: int, b: int) -> int:
        v = max(ivec2(a, b), ivec2(1, 2))
        return min(a, b) + clamp(a, 0, 9) + abs(b) + v.x - v.y

    module = same_as_reference(held, OLD, SMALL, SMALL[::-1].copy())
    for e in nodes(module):
        if isinstance(e, Builtin):
            assert e.name not in ("min", "max", "clamp", "abs"), e


def test_dynamic_indices_become_choices():
    @func
    def pick(a: int, b: int) -> float:
        values = [1.0, 2.0, 4.0]
        grid = [[1.0, 2.0], [3.0, 4.0]]
        v = vec3(5.0, 6.0, 7.0)
        values[a] = 9.0
        values[b] += 0.5
        grid[a][b] = 8.0
        v[b] = 11.0
        total = 0.0
        for i in range(3):
            total += values[i] * float(i + 1)
        return total + values[a + b] + v[a] * 100.0 + grid[b][a] * 1000.0

    module = same_as_reference(pick, OLD, SMALL, SMALL[::-1].copy())
    for e in nodes(module):
        if isinstance(e, Index):
            assert isinstance(e.index, Const), e


def test_loops_get_constant_bounds():
    @func
    def count(n: int, m: int) -> int:
        steps = 4
        total = 0
        for i in range(clamp(n, 0, 7)):
            total += i
        for i in range(max(m, 0), steps * 2):
            if i == 5:
                continue
            total += 100 * i
        for i in range(6, max(n, 1), -2):
            total += 1000 * i
        return total

    text = print_module(same_as_reference(count, OLD, SMALL, SMALL[::-1].copy()))
    assert "for i step 1 from 0 to 7" in text
    assert "to 1\n" in text


def test_a_parameter_s_range_bounds_a_loop_but_not_an_index():
    steps = integer("Max steps", 64, low=1, high=96)

    @func
    def march(x: float) -> float:
        values = [0.1 * x, 0.2 * x]
        total = values[steps - 1]
        for _ in range(steps):
            total += x
        return total

    module = passed(march, target=OLD, precision=32)
    assert "step 1 from 0 to 96" in print_module(module)
    text = print_module(passed(march, target=ABLE, precision=32))
    assert "values[(min (max (sub @max_steps 1) 0) 1)]" in text


@pytest.mark.parametrize("name", ["loop", "spin", "hashed", "bits", "random", "texels"])
def test_what_cannot_be_said_is_refused_with_a_mend(name):
    @func
    def loop(n: int) -> int:
        total = 0
        for i in range(n):
            total += i
        return total

    @func
    def spin(x: float) -> float:
        y = x
        while y < 10.0:
            y += 1.0
        return y

    @func
    def hashed(n: int) -> int:
        return int(pcg(uint(n)))

    @func
    def bits(n: int) -> int:
        return n & 7

    @image
    def random(frame: Frame) -> vec3:
        return vec3(float(frame.seed))

    photo = Texture2D([[[0.0, 0.0, 0.0, 1.0]]])

    @func
    def texels(n: int) -> float:
        return texel(photo, ivec2(n, 0)).x

    messages = {
        "loop": "old needs loop bounds that are known when compiling",
        "spin": "old has no while loops",
        "hashed": "old has no unsigned integers",
        "bits": "old has no bit operations",
        "random": "old has no unsigned integers",
        "texels": "old has no single texels",
    }
    with pytest.raises(CompileError) as caught:
        passed(locals()[name], target=OLD, precision=32)
    diagnostic = caught.value.diagnostics[0]
    assert diagnostic.message.startswith(messages[name])
    assert diagnostic.hint and diagnostic.span
    assert diagnostic.span.file.endswith("test_decompose.py")
