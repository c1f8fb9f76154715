"""A small scene for each renderer, and the sea, as images that every target is given."""

from __future__ import annotations

from distal.fields.guarantees import Bounds
from distal.lang import Frame, exp, func, image, ivec4, length, min, sin, vec2, vec3, vec4
from distal.render import (
    bounce,
    heightfield_march,
    legend,
    lettering,
    march,
    material,
    media,
    patterns,
    segment,
    shade,
    shadows,
    sky,
    tonemap,
    views,
)
from distal.render.camera import Ray, look_at
from distal.render.footprint import Footprint
from distal.render.lights import LightSample, distant_light, point_light

STEPS = 96


@func
def balls(p: vec3) -> float:
    glass_ball = length(p - vec3(-0.9, 0.0, 0.3)) - 0.8
    mirror_ball = length(p - vec3(1.0, 0.0, -0.3)) - 0.8
    return min(glass_ball, mirror_ball)


@func
def field(p: vec3) -> float:
    return min(balls(p), p.y + 0.8)


@func
def field_of(p: vec3, part: int) -> float:
    return field(p)


@func
def surface(p: vec3, sides: Footprint, part: int) -> material.Surface:
    if p.y + 0.8 < balls(p):
        white = material.matte(vec3(0.8, 0.8, 0.75))
        return material.mix_surfaces(
            white, material.matte(vec3(0.1, 0.12, 0.2)), patterns.checker(p, 0.5, sides)
        )
    if p.x < 0.05:
        return material.glass(1.5, vec3(0.1, 0.02, 0.1))
    return material.metal(vec3(0.9, 0.7, 0.4), 0.1)


@func
def lights(i: int, p: vec3) -> LightSample:
    if i == 0:
        return point_light(p, vec3(2.0, 3.0, 2.0), 8.0, vec3(1.0), 0.2)
    return distant_light(p, vec3(-1.0, 2.0, 1.0), 0.5)


@func
def ambient(n: vec3) -> vec3:
    return vec3(0.1)


@func
def background(direction: vec3) -> vec3:
    return sky.gradient_background(direction)


@func
def haze(direction: vec3) -> vec3:
    return vec3(0.5)


@func
def ray_of(frame: Frame) -> Ray:
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    return look_at(uv, vec3(0.0, 1.2, 5.0), vec3(0.0, -0.1, 0.0), fov=0.7)


@func
def numbers() -> march.March:
    return march.March(1.0, 0.0, 60.0, 5e-4)


@func
def everywhere() -> Bounds:
    return Bounds(vec3(-1e18), vec3(1e18))


@func
def first_hit(ray: Ray) -> march.Hit:
    return segment.segment(field, ray, 0.0, 0.0, everywhere(), numbers(), STEPS)


@func
def next_hit(ray: Ray, within: int, slope: float, part: int) -> march.Hit:
    side = 1.0 if within == 0 else -1.0
    return segment.segment(field, ray, side, slope, everywhere(), numbers(), STEPS)


@func
def shadow(origin: vec3, light: LightSample, sample: int, samples: int) -> shadows.Opening:
    return shadows.soft_shadow(field, origin, light, everywhere(), numbers(), 48)


@func
def occlusion(p: vec3, n: vec3, slope: float) -> float:
    return shade.ambient_occlusion(field, p, n, 0.4, slope)


@image
def plain(frame: Frame) -> vec4:
    seen = bounce.seen_plain(
        ray_of(frame), first_hit, field_of, surface, occlusion, lights, ambient, background,
        haze, shadow, numbers(), shade.Shading(0.4, 0.02), 2,
    )  # fmt: skip
    return tonemap.display(vec4(seen.xyz, 1.0), 1.0, tonemap.AGX)


@image
def mirrored(frame: Frame) -> vec4:
    seen = bounce.seen_mirrored(
        ray_of(frame), first_hit, field_of, surface, occlusion, lights, ambient, background,
        haze, shadow, numbers(), shade.Shading(0.0, 0.0), 2, 4,
    )  # fmt: skip
    return tonemap.display(vec4(seen.xyz, 1.0), 1.0, tonemap.NEUTRAL)


@image
def refracted(frame: Frame) -> vec4:
    seen = bounce.seen_refracted(
        ray_of(frame), first_hit, media.in_air_or_body, next_hit, field_of, surface, occlusion,
        lights, ambient, background, haze, shadow, numbers(), shade.Shading(0.0, 0.0), 2, 6,
    )  # fmt: skip
    return tonemap.display(vec4(seen.xyz, 1.0), 1.0, tonemap.ACES)


@func
def sea_height(at: vec2) -> float:
    waves = 0.06 * sin(2.0 * at.x + 0.7 * at.y) + 0.04 * sin(1.3 * at.y - 3.1 * at.x + 1.0)
    return waves + 0.02 * sin(5.0 * at.x + 4.1 * at.y)


@func
def sea(p: vec3) -> float:
    return p.y - sea_height(p.xz)


@func
def sea_ray(frame: Frame) -> Ray:
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    return look_at(uv, vec3(0.0, 0.5, 5.0), vec3(0.0, 0.3, 0.0), fov=0.8)


@func
def sea_color(t: float, found: bool) -> vec3:
    return vec3(exp(-0.05 * t)) if found else vec3(0.0, 0.0, 1.0)


@func
def sea_numbers(threshold: float = 2e-4) -> march.March:
    # The slope's bound: 1 and the waves' steepest, 0.06 * 2.1 + 0.04 * 3.4 + 0.02 * 6.5.
    return march.March(1.08, 0.0, 60.0, threshold)


@image
def hybrid(frame: Frame) -> vec4:
    """Red: the way, as brightness; alpha: evaluations of the field."""
    stride = heightfield_march.Stride(0.13, 0.01, 1.05)
    hit = heightfield_march.march_heightfield(
        sea, sea_ray(frame), everywhere(), sea_numbers(), stride, 400
    )
    return vec4(sea_color(hit.t, hit.found), float(hit.steps))


@image
def traced(frame: Frame) -> vec4:
    """As ``hybrid``, by sphere tracing."""
    hit = segment.segment(sea, sea_ray(frame), 0.0, 0.0, everywhere(), sea_numbers(), 400)
    return vec4(sea_color(hit.t, hit.found), float(hit.steps))


@image
def true_sea(frame: Frame) -> vec4:
    """As ``traced``, as near to the surface as 32 bits get."""
    hit = segment.segment(sea, sea_ray(frame), 0.0, 0.0, everywhere(), sea_numbers(2e-6), 4000)
    return vec4(sea_color(hit.t, hit.found), 1.0)


@func
def first_wave(ray: Ray) -> march.Hit:
    stride = heightfield_march.Stride(0.13, 0.01, 1.05)
    return heightfield_march.march_heightfield(sea, ray, everywhere(), sea_numbers(), stride, 64)


COST = ivec4(*lettering.word("steps"))
LEGEND_SIZE = vec2(320.0, 240.0)
SLICE = vec3(0.0, 0.6, 0.8)


@func
def sliced_ray(uv: vec2) -> Ray:
    return look_at(uv, vec3(0.3, 0.5, 5.0), vec3(0.0, 0.3, 0.0), fov=0.8)


@image
def cost(frame: Frame) -> vec4:
    """The steps of the hybrid march, under a legend."""
    seen = views.view_steps(sea_ray(frame), first_wave, 64)
    return legend.with_steps(seen, frame.coord, LEGEND_SIZE, COST, 64)


@image
def sliced(frame: Frame) -> vec4:
    """Lines of equal distance with labels and a legend."""
    lines = views.lines_on(sliced_ray, frame.resolution, SLICE, 0.0)
    uv = (2.0 * frame.coord - frame.resolution) / frame.resolution.y
    seen = views.view_slice(sliced_ray(uv), field, SLICE, 0.0, 60.0, lines)
    # As in a picture that is large enough for a legend.
    large = LEGEND_SIZE.y / frame.resolution.y
    return legend.with_lines(
        seen,
        large * frame.coord,
        large * frame.resolution,
        COST,
        sliced_ray,
        field,
        SLICE,
        0.0,
        views.Lines(lines.spread, lines.step, 1.0),
    )
