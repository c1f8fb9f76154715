"""Gradients against closed forms and against finite differences in 64 bits."""

import numpy as np
import pytest

from distal.diagnostics import CompileError
from distal.ir.intrinsics import INTRINSICS
from distal.ir.printer import print_module
from distal.ir.types import Kind, kind_of
from distal.lang import (
    Texture2D,
    abs,
    atan2,
    clamp,
    cos,
    cross,
    determinant,
    distance,
    dot,
    exp,
    faceforward,
    floor,
    fract,
    func,
    gradient,
    inverse,
    length,
    log,
    mat2,
    mat3,
    max,
    min,
    mix,
    normalize,
    outer,
    pow,
    reflect,
    refract,
    sample,
    select,
    sin,
    smoothstep,
    sqrt,
    struct,
    tanh,
    transpose,
    value_and_gradient,
    vec2,
    vec3,
    vec4,
)
from tests.unit.passes.evaluation import evaluate, passed, points

# Fields, each made to need something else of the pass.


@func
def sphere(p: vec3) -> float:
    return length(p) - 1.0


@func
def sd_box(p: vec3, b: vec3) -> float:
    q = abs(p) - b
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0)


@func
def scene(p: vec3) -> float:
    ball = length(p - vec3(0.5, 0.1, 0.0)) - 0.8
    turned = vec3(cos(0.3) * p.x - sin(0.3) * p.z, p.y, sin(0.3) * p.x + cos(0.3) * p.z)
    return min(ball, sd_box(turned, vec3(0.6, 0.5, 0.4)))


@func
def smooth_min(a: float, b: float, k: float) -> float:
    h = clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0)
    return mix(b, a, h) - k * h * (1.0 - h)


@func
def blended(p: vec3) -> float:
    return smooth_min(sphere(p), sd_box(p - vec3(0.7, 0.2, 0.1), vec3(0.5, 0.4, 0.3)), 0.4)


@func
def fractal(p: vec3) -> float:
    z = p
    scale = 1.0
    for _ in range(4):
        z = abs(z) - vec3(0.6, 0.5, 0.4)
        if z.x < z.y:
            z.xy = z.yx
        z *= 1.3
        scale *= 1.3
        if length(z) > 3.0:
            break
    return (length(z) - 0.3) / scale


@func
def bulb(p: vec3) -> float:
    z = p
    slope = 1.0
    r = length(z)
    i = 0
    while i < 4:
        r = length(z)
        if r > 2.0:
            return 0.5 * log(r) * r / slope
        slope = pow(r, 3.0) * 4.0 * slope + 1.0
        angle = atan2(z.y, z.x) * 4.0
        z = pow(r, 4.0) * vec3(cos(angle), sin(angle), z.z / r) + p
        i += 1
    return 0.5 * log(r) * r / slope


@func
def nearest(p: vec3) -> float:
    sizes = [0.3, 0.5, 0.2]
    distances = [0.0, 0.0, 0.0]
    for i in range(3):
        distances[i] = length(p - vec3(float(i) - 1.0, 0.2, 0.0)) - sizes[i]
    best = distances[0]
    for d in distances:
        best = min(best, d)
    return best


@struct
class Hit:
    distance: float
    material: int
    place: vec3


@func
def hit(p: vec3) -> Hit:
    d = length(p) - 1.0
    if p.y < -0.3:
        return Hit(distance=p.y + 1.0, material=2, place=p * p.x)
    return Hit(distance=d, material=1, place=vec3(d, p.x, p.y * p.z))


@func
def by_struct(p: vec3) -> float:
    found = hit(p)
    kept = hit(p.yzx)
    if found.material == 1:
        kept.place.y = found.distance * 2.0
    return found.distance * kept.place.y + dot(found.place, kept.place) + float(found.material)


@func
def pair(p: vec3) -> tuple[float, vec2]:
    return dot(p, p), p.xz * p.y


@func
def by_tuple(p: vec3) -> float:
    square, flat = pair(p)
    return square * flat.x - flat.y / (1.0 + square)


@func
def by_matrix(p: vec3) -> float:
    turn = mat2(cos(p.y), sin(p.y), -sin(p.y), cos(p.y))
    q = turn @ p.xz
    r = p.xz @ turn
    m = mat3(vec3(2.0, p.x, 0.1), vec3(p.y, 3.0, 0.2), vec3(0.3, p.z, 2.5))
    n = inverse(m) @ p + transpose(m) @ p * 0.1
    return q.x * r.y + determinant(m) * 0.2 + dot(n, outer(p, p)[1]) + (m * p.x / 2.0)[0].y


@func
def by_choice(p: vec3) -> float:
    d = sphere(p) if p.x > 0.2 else scene(p.zxy) * 2.0
    v = select(p > 0.1, p * p, sin(p))
    return d + v.x * v.y - v.z


@func
def rules(p: vec3) -> float:
    n = normalize(p + vec3(3.0, 0.0, 0.0))
    i = normalize(vec3(0.3, -1.0, 0.2) + 0.1 * p)
    bent = refract(i, n, 0.8 + 0.05 * p.x) + reflect(i, n) + faceforward(n, i, p)
    waves = sin(p.x * 2.0) * exp(-p.y) + tanh(p.z) * sqrt(1.1 + p.x * p.x)
    steps = smoothstep(-0.5, 0.9 + 0.1 * p.y, p.z) + fract(p.x) + floor(p.y)
    steps += p.x % (2.0 + p.z * 0.1)
    return dot(bent, cross(p, n)) + waves + steps + distance(p, p.yzx * 2.0) + 1.5**p.y


@func
def warped(p: vec3) -> float:
    # abs keeps its tangents sparse through a call
    return sd_box(abs(p) - vec3(0.3, 0.0, 0.2), vec3(0.3, 0.5, 0.2)) * abs(p.x)


@func
def steepest(p: vec3) -> float:
    return length(gradient(lambda q: dot(q, q) * q.x + sin(q.y), p))


FIELDS = [
    sphere, scene, blended, fractal, bulb, nearest, by_struct, by_tuple, by_matrix, by_choice,
    rules, warped, steepest,
]  # fmt: skip


def entry_of(field):
    @func
    def both(p: vec3) -> tuple[float, vec3]:
        return value_and_gradient(field, p)

    return both


@pytest.mark.parametrize("field", FIELDS, ids=lambda f: f.name)
def test_gradients_agree_with_finite_differences(field):
    p = points(3)
    plain = passed(field)
    value, slopes = evaluate(passed(entry_of(field)), p)
    assert np.allclose(value, evaluate(plain, p), rtol=1e-12, atol=1e-12)
    h = 1e-6
    for k in range(3):
        step = np.zeros((3, 1))
        step[k] = h
        there = evaluate(plain, p + step)
        here = evaluate(plain, p - step)
        # A step straddles a crease or jump at few points; there the two sides disagree.
        off = np.abs((there - here) / (2 * h) - slopes[k]) > 1e-6 * (1 + np.abs(slopes[k]))
        assert off.mean() < 0.02, (field.name, k, p[:, off][:, :3])


def test_the_gradient_of_a_sphere_is_its_direction():
    @func
    def normal(p: vec3) -> vec3:
        return gradient(sphere, p)

    p = points(3)
    assert np.allclose(evaluate(passed(normal), p), p / np.linalg.norm(p, axis=0), atol=1e-14)


def test_gradients_of_other_point_sizes():
    @func
    def one(x: float) -> float:
        return gradient(lambda t: t * t * t, x)

    @func
    def two(p: vec2) -> vec2:
        return gradient(lambda q: q.x * q.y, p)

    @func
    def four(p: vec4) -> vec4:
        return gradient(lambda q: q.x * q.w + q.z, p)

    x = points(1)[0]
    assert np.allclose(evaluate(passed(one), x), 3 * x * x)
    q = points(2)
    assert np.allclose(evaluate(passed(two), q), q[::-1])
    r = points(4)
    ones = np.ones_like(x)
    assert np.allclose(evaluate(passed(four), r), [r[3], 0 * ones, ones, r[0]])


def test_captures_do_not_change():
    @func
    def slope(p: vec3, k: float) -> vec3:
        return gradient(lambda q: dot(q, p) * k, p)

    p = points(3)
    assert np.allclose(evaluate(passed(slope), p, np.full(200, 3.0)), 3 * p)


@func
def corner_root(p: vec3) -> float:
    return sqrt(dot(p, p))


@func
def corner_angle(p: vec3) -> float:
    return atan2(p.x, p.y) + pow(p.x, 0.5)


@func
def corner_distance(p: vec3) -> float:
    return distance(p, p * 2.0) + abs(p.x)


@func
def corner_step(p: vec3) -> float:
    return smoothstep(p.x, p.x, p.y + 1.0)


@func
def corner_box(p: vec3) -> float:
    return sd_box(p, vec3(0.0, 0.0, 0.0))


CORNERS = [sphere, corner_root, corner_angle, corner_distance, corner_step, corner_box]


@pytest.mark.parametrize("field", CORNERS, ids=lambda f: f.name)
@pytest.mark.parametrize("precision", [32, 64])
def test_no_gradient_is_nan_at_the_origin(field, precision):
    @func
    def slope(p: vec3) -> vec3:
        return gradient(field, p)

    dtype = np.float32 if precision == 32 else np.float64
    module = passed(slope, precision=precision)
    origin = np.zeros((3, 1), dtype)
    assert np.isfinite(evaluate(module, origin, precision=precision)).all()


def test_ties_follow_the_first_operand():
    @func
    def low(p: vec2) -> vec2:
        return gradient(lambda q: min(q.x, q.y) + 10.0 * max(q.x, q.y), p)

    assert evaluate(passed(low), np.ones((2, 1))).ravel().tolist() == [11.0, 0.0]


def test_a_still_part_costs_nothing():
    @func
    def still(p: vec3) -> vec3:
        return gradient(lambda q: length(p) + q.x, p)

    text = print_module(passed(still, after="gradient"))
    assert "return (vec3 1.0 0.0 0.0)" in text and "length" not in text


def test_a_shifted_point_changes_as_the_point_does():
    """The tangents of the shifted point are known: no product with them is left."""

    @func
    def moved(p: vec3, offset: vec3) -> vec3:
        return p - offset

    @func
    def ball(p: vec3, radius: float) -> float:
        return length(p) - radius

    @func
    def field(p: vec3) -> float:
        return min(ball(moved(p, vec3(1, 2, 3)), 0.5), ball(moved(p, vec3(-1, 0, 2)), 0.75))

    @func
    def slope(p: vec3) -> vec3:
        return gradient(field, p)

    module = passed(slope, after="gradient")
    text = print_module(module)
    assert "moved_dual" not in text and text.count("fn ball_dual") == 1
    assert "dot" not in text
    at = points(3, reach=4.0)
    centers = np.array([[1.0, 2.0, 3.0], [-1.0, 0.0, 2.0]])[:, :, None]
    away = at - centers
    distances = np.linalg.norm(away, axis=1) - np.array([[0.5], [0.75]])
    nearer = distances.argmin(0)
    found = evaluate(passed(slope), at)
    wanted = np.take_along_axis(away, nearer[None, None], 0)[0]
    assert np.allclose(found, wanted / np.linalg.norm(wanted, axis=0), atol=1e-12)


def test_tangents_that_differ_between_returns_are_passed():
    @func
    def moved(p: vec3) -> vec3:
        if p.x > 0.0:
            return p.zyx
        return p

    @func
    def slope(p: vec3) -> vec3:
        return gradient(lambda q: dot(moved(q), vec3(1, 2, 3)), p)

    found = evaluate(passed(slope), np.array([[1.0, -1.0], [0.5, 0.5], [0.25, 0.25]]))
    assert found.T.tolist() == [[3.0, 2.0, 1.0], [1.0, 2.0, 3.0]]


def test_the_gradient_of_a_texture_is_refused():
    photo = Texture2D([[[0.0, 0.0, 0.0, 1.0]]])

    @func
    def relief(p: vec2) -> vec2:
        return gradient(lambda q: sample(photo, q).x, p)

    with pytest.raises(CompileError, match="the gradient of a texture is not defined"):
        passed(relief)


def test_every_row_of_floats_has_a_rule():
    for row in INTRINSICS.values():
        for signature in row.signatures:
            for _, result in signature.instances():
                smooth = kind_of(result) is Kind.FLOAT
                if smooth:
                    assert row.derivative is not None, row.name
